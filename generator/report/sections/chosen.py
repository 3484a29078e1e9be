"""What was chosen, against the report's kernels and fixed steps."""

from __future__ import annotations

from typing import Any

from ...choice.trials import Final, Times
from ...evidence.timing.ratios import TimingResult
from ..experiments.subjects import BASELINE, BEST, EULER, role_of_budget
from ..findings import KernelFindings
from ..known import Known
from .kernels import times_row


def chosen(known: Known) -> list[dict[str, Any]]:
    """The measured roles first, then what a sweep chose that was not measured."""
    finals = {final.chosen: final for final in known.stored.finals.values()}
    ratios = {k.role: k.timed.ratio for k in known.kernels if k.timed}
    rows = [
        _measured(kernel, ratios, finals.get(kernel.name))
        for kernel in known.kernels
        if kernel.role in (BASELINE, BEST) or kernel.role.endswith("chosen")
    ]
    names = {row["kernel"] for row in rows}
    return rows + [_swept(final) for name, final in finals.items() if name not in names]


def _measured(
    kernel: KernelFindings, ratios: dict[str, float], final: Final | None
) -> dict[str, Any]:
    own = ratios.get(kernel.role)
    by = "the report" if kernel.role in (BASELINE, BEST) else "generated/, or the default"
    return {
        "role": kernel.role,
        "kernel": kernel.name,
        "call": "scalar",
        "width": 1,
        **_decided(kernel.timed, final, by),
        "than_best": ratios[BEST] / own if own and BEST in ratios else None,
        "than_euler": ratios[EULER] / own if own and EULER in ratios else None,
        "error": kernel.error,  # against the exact result
        "verified_error": kernel.verified_error,  # against what it must reproduce
    }


def _swept(final: Final) -> dict[str, Any]:
    entry = next(f for f in final.finalists if f.subject.name == final.chosen)
    asked = entry.subject.asked
    budget, call = asked.goal.budget, asked.contest.call
    role = EULER if budget is None else role_of_budget(budget)
    return {
        "role": f"{role} by the sweep" if call == "scalar" else f"{role}, batch",
        "kernel": final.chosen,
        "call": call,
        "width": asked.width.lanes,
        **_decided(entry.times, final, ""),
        "than_best": None,
        "than_euler": None,
        "error": None if budget is None else entry.max_rel_error,
        "verified_error": entry.max_rel_error,
    }


def _decided(times: TimingResult | Times | None, final: Final | None, by: str) -> dict[str, Any]:
    """What decided, and how fast it is."""
    ties = [name for name in final.ties if name != final.chosen] if final else []
    by = f"a sweep's final ({final.purpose})" if final else by
    return {
        "by": by,
        "ties": ties,
        **times_row(times),
        "times_faster": 1 / times.ratio if times else None,
    }
