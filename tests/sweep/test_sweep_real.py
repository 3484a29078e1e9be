"""Sweeps of real kernels: what is broken is rejected and kept, the rest is timed and chosen."""

from __future__ import annotations

import os
import pty
import signal
import subprocess
import sys
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from click.testing import CliRunner

import generator.registry.axes as axes_module
from generator.choice.kernel import Code, Emitted
from generator.choice.selection import read_selection
from generator.choice.trials import Final
from generator.choice.verifier import A_STEP
from generator.choice.workbench import Workbench
from generator.cli.main import gen
from generator.emission.kernel_source import emit
from generator.errors import EmissionError
from generator.evidence.records.code import source_hash
from generator.evidence.timing.bench_tool import build_bench_tool
from generator.places import cache_folder
from generator.registry.question import Contest, Goal
from generator.registry.variant import Variant, fixed_steps, make_variant
from generator.sweep.lab import Lab
from generator.sweep.store import opened, read_only
from generator.targets.host import read_host
from generator.targets.target import find_target
from generator.toolchain.compilers import find_compilers
from tests.support.kernels import ROOT
from tests.support.sweep_lab import plan, swept
from tests.sweep.test_sweep import COLOUR

TARGET = find_target("x86-64-v3")
CONTEST = Contest("ball-ball", TARGET.name, "any", "pooltool", Goal(steps=100), "scalar")
ONE = {
    "state": "reduced",
    "store": "named",
    "reuse": "precompute",
    "order": "paper",
    "rsqrt": "inv",
    "fma": "fma",
    "roots": "early",
    "branch": "chosen",
    "loop": "twostage",
    "simd": "scalar",
    "compiler": "gcc",
    "flags": "strict",
}
STEP = "  step(p, b, steps);"
BROKEN = {
    "inv": ("compile", f"{STEP} no_such_function();"),
    "est1": ("crash", "  __builtin_trap();"),
    "est2": ("timeout", "  for (volatile int forever = 1; forever != 0;) {\n  }"),
    "prev": ("wrong result", f"{STEP} b.v1x += 1e-3;"),
}

needs_host = pytest.mark.skipif(
    not read_host().exact, reason="this CPU is none of the targets: nothing to sweep for"
)


class SabotagedLab(Lab):
    """Some kernels are made to fail, each in its way."""

    def code(self, variant: Variant) -> Code:
        return self.emit(variant).code

    def emit(self, variant: Variant) -> Emitted:
        if variant["rsqrt"] == "div" and variant["flags"] == "strict":
            raise EmissionError("a bug of the generator")
        candidate, bad = super().emit(variant), BROKEN.get(variant["rsqrt"])
        if bad is None or variant["flags"] != "strict":
            return candidate
        text = candidate.source.source
        assert STEP in text
        return replace(
            candidate, source=replace(candidate.source, source=text.replace(STEP, bad[1]))
        )


def test_a_kernel_that_crashes_or_hangs_or_errs_is_rejected_and_the_sweep_goes_on(
    tmp_path: Path,
) -> None:
    if not read_host().runs(TARGET):
        pytest.skip("x86-64-v3 does not run here")
    folder, compilers = cache_folder(), {c.code: c for c in find_compilers()}
    bench = Workbench(build_bench_tool(folder), folder, compilers, fresh=True)
    bench.cases.expected("any", "pooltool", 100)
    lab = SabotagedLab(bench, TARGET)
    bench.verifier.patience = 3.0 - 100 * A_STEP
    only = {key: (code,) for key, code in ONE.items()}
    only = {**only, "rsqrt": ("div", *BROKEN, "ahead"), "branch": ("chosen", "nested")}
    asked = replace(plan(CONTEST, only=only, exhaustive=True), target=TARGET)
    with opened(tmp_path / "s.sqlite") as store:
        [outcome], _ = swept(store, lab, asked)  # type: ignore[arg-type]
        everything = store.trials()
    chosen = [t for t in everything if t.subject.options["branch"] == "chosen"]
    trials = [t for t in chosen if t.depends is not None and t.rung == 0]
    unwritten = [t.rejection for t in everything if t.subject.options["rsqrt"] == "div"]
    reasons = {t.subject.options["rsqrt"]: t.rejection for t in trials}
    for code, rejection in reasons.items():
        print(f"{code}: {rejection.reason + ': ' + rejection.text if rejection else 'timed'}")
    want = {**{code: reason for code, (reason, _) in BROKEN.items()}, "ahead": None}
    assert {code: r.reason if r else None for code, r in reasons.items()} == want
    assert all("\n" not in r.text for r in reasons.values() if r)
    assert "a bug of the generator" in {r.text for r in unwritten if r and r.reason == "compile"}
    assert outcome.final is not None and "rsqrt=ahead" in outcome.final.chosen


def test_the_hash_of_a_kernels_code_is_not_of_its_name_or_comments(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A new axis makes every name longer, and with it lines that hold the name."""

    def hashes() -> list[str]:
        stepper = fixed_steps(100)
        options = [{**ONE, "rsqrt": rsqrt} for rsqrt in ("inv", "est1")]
        made = [make_variant("x86-64-v3", "any", "pooltool", stepper, **o) for o in options]
        return [source_hash(emit(variant)) for variant in made]

    before = hashes()
    monkeypatch.setattr(axes_module, "AXES", (*axes_module.AXES, COLOUR))
    assert hashes() == before and before[0] != before[1]


def options() -> list[str]:
    return [word for key, code in ONE.items() for word in ("--only", f"{key}={code}")]


def gen_sweep(*arguments: object) -> tuple[int, str, str]:
    result = CliRunner().invoke(gen, ["sweep", *map(str, arguments)])
    print(result.output)
    return result.exit_code, result.stdout, result.stderr


@needs_host
def test_a_sweep_by_command_chooses_writes_and_verifies_its_choice(tmp_path: Path) -> None:
    path, out = tmp_path / "s.sqlite", tmp_path / "out"
    common = [
        "--steps",
        100,
        "--call",
        "scalar",
        "--store",
        path,
        *options(),
        "--only",
        "rsqrt=inv,est1",
    ]
    code, said, _ = gen_sweep(*common, "--exhaustive", "--write", "--out", out)
    assert code == 0 and "chosen: " in said
    selection = read_selection(out / "ball-ball" / "native" / "any")
    assert selection is not None
    [entry] = selection.kernels
    with read_only(path) as store:
        [final] = store.finals()
        assert final.chosen == entry.kernel and entry.chosen_by == "timing"
    code, said, _ = gen_sweep(*common, "--verify-choice")
    with read_only(path) as store:
        finals = store.finals()
    assert [final.purpose for final in finals] == ["choice", "verify-choice"]
    assert finals[1].chosen == entry.kernel and len(finals[1].finalists) == 2
    assert code == (0 if "the choice holds" in said else 1)
    assert isinstance(finals[1], Final) and finals[1].processes > 1


@needs_host
def test_wrong_use_is_one_line_and_writes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "s.sqlite"
    other = "zen2" if read_host().target.name != "zen2" else "zen3"
    for arguments, parts in (
        (["--target", other], ["--target", "another CPU", "--scheduler"]),
        (["--only", "colour=red"], ["--only colour=red", "no axis"]),
        (["--model", "none"], ["--model none"]),
        (["--max-error", "7"], ["--max-error 7", "out of range"]),
        (["--verify-choice", "--steps", "100"], [str(path), "no store of a sweep"]),
        (["--only", "branch=chosen", "--only", "rsqrt=div"], ["--only", "no legal variant"]),
        (["--out", tmp_path], ["--out", "--write"]),
        (["--rivals", path], ["--rivals", "--verify-choice"]),
    ):
        code, said, complaint = gen_sweep(*arguments, "--store", path)
        assert code == 2 and said == ""
        assert all(part in complaint for part in parts), complaint
        assert complaint.count("gen: ") == 1
        assert list(tmp_path.iterdir()) == []


@needs_host
def test_ctrl_c_at_a_terminal_ends_a_sweep_cleanly(tmp_path: Path) -> None:
    """On a pseudo-terminal: the display is live, and the interrupt leaves a whole store."""
    path = tmp_path / "s.sqlite"
    main, sub = pty.openpty()
    command = [sys.executable, "-P", "-m", "generator", "sweep", "--steps", "100"]
    process = subprocess.Popen(
        [*command, "--store", str(path)],
        stdin=sub,
        stdout=sub,
        stderr=sub,
        env={**os.environ, "PYTHONPATH": str(ROOT), "TERM": "xterm", "COLUMNS": "120"},
        start_new_session=True,
        # What was started in the background ignores it.
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )
    os.close(sub)
    shown = b""
    end = time.monotonic() + 1200
    while b"best so far" not in shown and time.monotonic() < end:
        shown += os.read(main, 65536)
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    while True:
        try:
            more = os.read(main, 65536)
        except OSError:
            break  # the other end is closed
        if not more:
            break
        shown += more
    text = shown.decode(errors="replace")
    print(text[-600:])
    assert process.wait(timeout=600) == 130
    for title in ("contest", "doing", "done", "best so far", "time", "left at most"):
        assert title in text
    assert "stopped; all that was measured is kept in" in text and "Traceback" not in text
    with read_only(path) as store:
        assert len(store.runs()) == 1
        store.trials()
