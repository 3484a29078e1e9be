"""From what is known to the document of the page and its plots. Nothing is measured here."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..registry.question import DEFAULT_IMPACT, find_impact
from .findings import sources_hash
from .known import Known
from .plots import Plot
from .sections import chosen, contests, cpus, effects, growth, kernels, machine, published

SCHEMA = 1
NOT_MEASURED = "not measured yet: ./gen report --measure"
NO_SWEEP = "no sweep is stored for it: ./gen sweep"
NO_RECORDS = "no CPU has records of it in timings/: ./gen results refresh"
NO_LANES = (
    "no kernel with lanes was chosen by a stored sweep or lies in generated/; ./gen sweep --call "
    "batch looks for one"
)
NO_PAIRS = "no two timed variants of the store differ in it alone"


@dataclass(frozen=True)
class Report:
    """`document`: all numbers of the page and nothing else, as JSON holds it.

    Times are in ns for one collision, `ratio` is the time divided by that of `paper-initial` in the
    same rounds, errors are relative to |v1 - v2| before the collision. null: not known; `missing`
    says why, by the name of the section or of what is missing.
    """

    document: dict[str, Any]
    plots: Mapping[str, Sequence[Plot]]

    @property
    def missing(self) -> dict[str, str]:
        return dict(self.document["missing"])


def make_report(known: Known) -> Report:
    """All that is known; `missing` names what is not and the command that would make it known."""
    points = known.findings.growth if known.findings else ()
    swept, measured = contests.data(known), kernels.data(known)
    pairs = effects.effects_of(known.contests)
    impact = find_impact(DEFAULT_IMPACT)
    document = {
        "schema": SCHEMA,
        "title": f"Collision kernels for {known.target}",
        "scene": known.scene,
        "model": known.model,
        "collides": impact.text,
        "relative_to": impact.relative_to,
        "varied": impact.functions.varied,
        "made_at": known.made_at,
        "machine": machine.data(known),
        "commands": known.commands,
        "chosen": chosen.chosen(known),
        **swept,
        "effects": pairs,
        "compilers": [effect for effect in pairs if effect["axis"] == "compiler"],
        "growth": [point.model_dump() for point in points],
        "growth_fits": growth.growth_fits(points),
        **measured,
        "cpus": cpus.cpu_costs(known.timings, known.scene, known.model),
        "published": published.published_rows(known),
        "paper": impact.part("presets").PAPER,
    }
    document["missing"] = _missing(known, document)
    plots = {
        "contests": contests.contest_plots(known, swept["points"]),
        "effects": effects.effect_plots(pairs),
        "growth": growth.growth_plots(points),
        "sections": kernels.section_plots(measured["sections"]),
    }
    return Report(_plain(document), plots)


def _missing(known: Known, document: Mapping[str, Any]) -> dict[str, str]:
    """Reasons by the name of the page's section, of the tool that failed, or of what is stale."""
    found = {"published": published.NOT_KNOWN}
    for name in ("contests", "effects", "compilers"):
        if not document[name]:
            untimed = "no variant of the stored sweep was timed"
            timed = NO_PAIRS if known.contests else untimed
            found[name] = timed if known.stored.trials else NO_SWEEP
    for name in ("outputs", "worst", "kinds", "growth", "operations", "sections", "modelled"):
        if not document[name]:
            found[name] = NOT_MEASURED
    for name in ("misses", "calls"):
        if not document[name] and not known.findings:
            found[name] = NOT_MEASURED
    if not document["cpus"]:
        found["cpus"] = NO_RECORDS
    if known.findings:
        if not any(call.width > 1 for call in known.findings.calls):
            found["lanes"] = NO_LANES
        found |= _untold(known) | _stale(known)
    return found


def _untold(known: Known) -> dict[str, str]:
    """What a tool could not do, once for all kernels that it failed for the same reason."""
    roles: dict[tuple[str, str], list[str]] = {}
    for kernel in known.kernels:
        for what, reason in kernel.missing.items():
            roles.setdefault((what, reason), []).append(kernel.role)
    everyone = sum(bool(kernel.kinds) for kernel in known.kernels)
    return {
        f"{what} of {'all kernels' if len(own) == everyone else '; '.join(own)}": reason
        for (what, reason), own in roles.items()
    }


def _stale(known: Known) -> dict[str, str]:
    """What of the chosen kernels was not measured, or was measured of others."""
    findings = known.findings
    if findings is None:
        return {}
    found = {}
    measured = {k.name for k in findings.kernels} | {row.kernel for row in findings.calls}
    if stale := sorted({final.chosen for final in known.stored.finals.values()} - measured):
        found["measured"] = (
            f"{len(stale)} of the kernels that the sweep chose were not measured, as {stale[0]}: "
            "./gen report --measure"
        )
    if findings.sources != sources_hash():
        found["age"] = (
            f"what was measured ({findings.made_at}) is of kernels as other sources of carom gave "
            "them: ./gen report --measure makes it anew"
        )
    return found


def _plain(value: Any) -> Any:
    """As JSON can hold it: numbers that are not finite become null."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return float(f"{value:.6g}") if math.isfinite(value) else None
    return value
