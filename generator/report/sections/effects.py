"""What each option does by itself, and one compiler against another: pairs of a sweep's trials."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ...evidence.timing.ratios import median_interval
from ...registry.axes import Axis, axis
from ..contests import ContestTable
from ..drawing import Note
from ..plots import Key, Plot, Row, Rows, ratio_rows

FEWEST_PAIRS = 6  # with fewer, no interval of order statistics holds the median in 95 %
FASTER, SLOWER, UNTOLD = 0, 5, 7  # colours
Effect = dict[str, Any]


def effects_of(contests: Iterable[ContestTable]) -> list[Effect]:
    """For each pair of codes of an axis: the ratio of times over variants equal in all else.

    Contests of a family are taken together, pairs never cross contests.
    """
    ratios: dict[tuple[str, str, str, str], list[float]] = defaultdict(list)
    for contest in contests:
        for index, key in enumerate(contest.axes):
            for code, other, found in _pairs(contest, index):
                ratios[contest.family, key, code, other].append(found)
    return [_effect(*key, values) for key, values in sorted(ratios.items(), key=_order)]


def _pairs(contest: ContestTable, index: int) -> list[tuple[str, str, float]]:
    groups: dict[object, dict[str, float]] = defaultdict(dict)
    for v in contest.variants:
        subject, options = v.trial.subject, v.options(contest.axes)
        rest = (subject.stepper, subject.asked.width, *options[:index], *options[index + 1 :])
        groups[rest][options[index]] = v.ratio
    order = _codes(contest.axes[index])
    found = []
    for times in groups.values():
        ranked = sorted(times, key=lambda code: order.get(code, len(order)))
        for n, other in enumerate(ranked):
            found += [(code, other, times[code] / times[other]) for code in ranked[n + 1 :]]
    return found


def _known_axis(key: str) -> Axis | None:
    """None where the registry has no such axis any more."""
    try:
        return axis(key)
    except KeyError:
        return None


def _codes(key: str) -> dict[str, int]:
    known = _known_axis(key)
    return {code: n for n, code in enumerate(known.codes())} if known else {}


def _order(item: tuple[tuple[str, str, str, str], list[float]]) -> tuple[object, ...]:
    (family, key, code, other), _ = item
    codes = _codes(key)
    return family, key, codes.get(other, 99), codes.get(code, 99)


def _effect(family: str, key: str, code: str, other: str, ratios: list[float]) -> Effect:
    known, words = _known_axis(key), "of an older registry"
    if known:
        texts = {choice.code: choice.text for choice in known.choices}
        words = f"{known.text}: {texts.get(code, code)}; instead of {texts.get(other, other)}"
    values = np.array(ratios)
    return {
        "family": family,
        "axis": key,
        "code": code,
        "other": other,
        "text": words,
        "pairs": len(ratios),
        "ratio": float(np.median(values)),
        "ratio_ci": median_interval(values),  # of the median, 95 %
    }


def one_each(effects: Iterable[Effect]) -> list[Effect]:
    """Each option against its axis' default or, where no pair has that, in the most pairs."""

    def rank(effect: Effect) -> tuple[bool, int]:
        known = _known_axis(effect["axis"])
        return effect["other"] == (known.default if known else ""), effect["pairs"]

    found: dict[tuple[str, str], Effect] = {}
    for effect in effects:
        last = found.setdefault((effect["axis"], effect["code"]), effect)
        if rank(effect) > rank(last):
            found[effect["axis"], effect["code"]] = effect
    return list(found.values())


def effect_plots(effects: Sequence[Effect]) -> list[Plot]:
    """A row for each option; all pairs are in the table."""
    legend = [
        Key("bar", FASTER, "faster"),
        Key("bar", SLOWER, "slower"),
        Key("bar", UNTOLD, f"cannot be told, or fewer than {FEWEST_PAIRS} pairs"),
        Key("line", None, "interval"),
    ]
    label = "time with the option / time without, median of pairs and 95 % interval"
    found = []
    for family in dict.fromkeys(effect["family"] for effect in effects):
        own = one_each(effect for effect in effects if effect["family"] == family)
        rows = [_row(effect, f"/effects/{effects.index(effect)}") for effect in own]
        title = f"What each option does by itself ({family} kernels)"
        asked = Rows(f"effects-{family}", title, label, rows, legend, ("ratio",))
        found.append(ratio_rows(asked))
    return found


def _row(effect: Effect, at: str) -> Row:
    low, high = effect["ratio_ci"]
    told = FASTER if high < 1 else SLOWER if low > 1 else UNTOLD
    ratio, pairs = f"{effect['ratio']:.4g} ({low:.4g} to {high:.4g})", f"{effect['pairs']} pairs"
    return Row(
        f"{effect['axis']}: {effect['code']}, not {effect['other']}",
        [effect["ratio"]],
        [Note(f"{effect['text']}\n{ratio}, {pairs}", at)],
        (low, high),
        told if effect["pairs"] >= FEWEST_PAIRS else UNTOLD,
    )
