"""Hashes of kernels' texts, so that a move of code is proved to have changed none.

    .venv/bin/python tools/golden.py            compare with the kept hashes; 1 where one differs
    .venv/bin/python tools/golden.py --every 20 compare each 20th
    .venv/bin/python tools/golden.py --rewrite  keep the hashes of today's texts of the same kernels
                                                and of those with fixed tiers
    .venv/bin/python tools/golden.py --write    the same, of kernels that are drawn anew

A line holds what is wanted of a kernel (no name: the grammar of names may change) and the hashes of
its source, its header and its probe, without banners, names and what refuses other compilers.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import random
import re
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from generator.choice.selection import read_selection  # noqa: E402
from generator.emission.kernel_source import emit  # noqa: E402
from generator.errors import InputError, KernelError  # noqa: E402
from generator.impacts.ball_ball.presets import PRESETS  # noqa: E402
from generator.impacts.ball_ball.scene import find_scene, scenes  # noqa: E402
from generator.registry.axes import axes_of  # noqa: E402
from generator.registry.lane_numbers import widths_for  # noqa: E402
from generator.registry.rules import broken_rule  # noqa: E402
from generator.registry.variant import Stepper, Variant, fixed_steps, make_variant  # noqa: E402
from generator.steppers.budgets import tableaus_for  # noqa: E402
from generator.tableaus.tableaus import TABLEAUS  # noqa: E402
from generator.targets.target import target_or_port  # noqa: E402

KEPT = ROOT / "tests" / "data" / "golden.jsonl"
TARGETS = ("zen3", "zen4", "x86-64-v2", "x86-64-v3", "armv8", "wasm32")
BUDGETS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-9, 1e-12)
DRAWN = 500


def wanted(variant: Variant) -> dict[str, object]:
    """What is wanted of a kernel, as plain data."""
    stepper = variant.stepper
    return {
        "target": variant.target,
        "scene": variant.scene,
        "model": variant.model,
        "stepper": "euler" if stepper.steps else stepper.name,
        "steps": stepper.steps,
        "budget": stepper.budget,
        "width": variant.width,
        "options": dict(variant.options),
    }


def variant_of(want: dict) -> Variant:
    steps = want["steps"]
    stepper = fixed_steps(steps) if steps else Stepper(want["stepper"], budget=want["budget"])
    head = (want["target"], want["scene"], want["model"], stepper, want["width"])
    return make_variant(*head, **want["options"])


def hashes(want: dict) -> dict[str, str]:
    made = emit(variant_of(want))
    texts = {"source": made.source, "header": made.header, "probe": made.probe}
    return {key: _hash(text) for key, text in texts.items()}


# What `carom_kernel()` tells, on one line or several.
_TOLD = re.compile(r'_kernel\(void\) \{\s*return\s+(?:"[^"]*"\s*)+;\s*\}')


def _hash(text: str) -> str:
    lines = _TOLD.sub('_kernel(void) { return "NAME"; }', text).split("\n")
    while lines and lines[0].startswith(("//", "/*", " *")):
        del lines[0]
    if lines and lines[0].startswith("#if !(defined(__GNUC__)"):  # who may compile it
        del lines[: lines.index("") + 1]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]


def _draw(chance: random.Random) -> dict[str, object] | None:
    """A random kernel, or None where the one that was drawn is illegal or cannot be made."""
    target = target_or_port(chance.choice(TARGETS))
    scene = chance.choice(("any", *sorted(scenes())))
    model = chance.choice(("mathavan2014", "bottom_slip", "pooltool"))
    exact = chance.random() < 0.6
    if exact:
        stepper = Stepper(chance.choice(sorted(TABLEAUS)), budget=chance.choice(BUDGETS))
    else:
        stepper = fixed_steps(1000)
    width = chance.choice(widths_for(target, find_scene(scene), stepper.family))
    axes = axes_of(stepper.family, width)
    if not exact:  # of all options at once next to none would be legal
        axes = tuple(chance.sample(axes, chance.randint(1, 4)))
    options = {
        **(_base(chance) if not exact else {}),
        **{a.key: chance.choice(a.codes()) for a in axes},
    }
    try:
        variant = make_variant(target.name, scene, model, stepper, width, **options)
        if broken_rule(variant, target):
            return None
        want = wanted(variant)
        emit(variant)
    except (ValueError, InputError, KernelError):
        return None
    return want


def _base(chance: random.Random) -> dict[str, str]:
    """Options of a preset of fixed steps."""
    return dict(chance.choice(PRESETS).options)


def _draws(seed: int, count: int) -> list[dict[str, object]]:
    chance = random.Random(seed)
    found: list[dict[str, object]] = []
    while len(found) < count:
        if (want := _draw(chance)) is not None:
            found.append({**want, **hashes(want)})
    return found


def _write() -> None:
    folders = sorted((ROOT / "generated").glob("*/*/*"))
    selections = [read_selection(folder) for folder in folders]
    named = [entry.variant for s in selections if s is not None for entry in s.kernels]
    with ProcessPoolExecutor(2) as pool:
        drawn = [row for rows in pool.map(_draws, range(20), [DRAWN // 20] * 20) for row in rows]
        committed = [*map(wanted, named), *_tiered()]
        rows = [{**w, **h} for w, h in zip(committed, pool.map(hashes, committed), strict=True)]
    lines = sorted({json.dumps(row) for row in (*rows, *drawn)})
    KEPT.write_text("\n".join(lines) + "\n", "utf-8")
    print(f"{len(lines)} kernels, {len(named)} of them in generated/")


def _tiered() -> list[dict[str, object]]:
    """Kernels with fixed tiers, by call and in lanes of floats: hardly any draw has them."""
    found = []
    for model, budget in (("mathavan2014", 1e-6), ("bottom_slip", 1e-6), ("pooltool", 1e-4)):
        stepper = Stepper(tableaus_for(budget)[0], budget=budget)
        for target, width in (("x86-64-v2", 4), ("x86-64-v3", 8), ("zen4", 16)):
            known = target_or_port(target)
            ways = {"fma": "fma" if known.has("fma") else "nofma", "root": "cubic"}
            alone = make_variant(target, "any", model, stepper, 1, **ways)
            for kind in ("fixed", "sticking"):
                lanes = {"numbers": "float", "interleave": "s2", "lane_tiers": kind}
                made = (alone.with_options(tiers=kind), alone.in_lanes(width, **lanes))
                found += [wanted(v) for v in made if broken_rule(v, known) is None]
    return found


def _rewrite() -> None:
    rows, now = _kept_and_now(1)
    kept = [{key: row[key] for key in row if key not in now[0]} for row in rows]
    more = [want for want in _tiered() if want not in kept]
    rows, now = [*rows, *more], [*now, *map(hashes, more)]
    lines = sorted({json.dumps({**row, **h}) for row, h in zip(rows, now, strict=True)})
    KEPT.write_text("\n".join(lines) + "\n", "utf-8")
    changed = sum(any(row.get(k) != h[k] for k in h) for row, h in zip(rows, now, strict=True))
    print(f"{len(rows)} kernels: {changed} have new hashes")


def _kept_and_now(every: int) -> tuple[list[dict], list[dict[str, str]]]:
    rows = [json.loads(line) for line in KEPT.read_text("utf-8").splitlines()][::every]
    with ProcessPoolExecutor(2) as pool:
        return rows, list(pool.map(hashes, rows, chunksize=4))


def _compare(every: int) -> int:
    rows, now = _kept_and_now(every)
    differ = [row for row, h in zip(rows, now, strict=True) if any(row[k] != h[k] for k in h)]
    for row in differ[:10]:
        print(f"differs: {json.dumps(row)}")
    print(f"{len(rows)} kernels: {len(differ)} differ")
    return 1 if differ else 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--rewrite", action="store_true")
    parser.add_argument("--every", type=int, default=1)
    options = parser.parse_args()
    if options.write:
        _write()
        return 0
    if options.rewrite:
        _rewrite()
        return 0
    return _compare(options.every)


if __name__ == "__main__":
    sys.exit(main())
