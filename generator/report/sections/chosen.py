"""What was chosen, against the report's kernels and fixed steps."""

from __future__ import annotations

from typing import Any

from ...evidence.timing.ratios import TimingResult
from ...sweep.record import Final, Times
from ..experiments.subjects import BASELINE, BEST, EULER, role_of_budget
from ..findings import KernelFindings, sources_hash
from ..known import Known
from ..layout import (
    Block,
    Code,
    Column,
    Details,
    Paragraph,
    Section,
    code,
    number,
    ratio,
    records,
    text,
)

_ERRORS = (
    "'What it reproduces': a budget's kernel the exact result; a fixed-step kernel the same "
    "scheme in long double, without cases that flip by a step or stick. Against the exact result "
    "a fixed-step kernel has the scheme's own error, which is large where the contact sticks and "
    "the steps chatter."
)


def section(known: Known) -> Section:
    rows = chosen(known)
    missing = _missing(known)
    notes: list[Block] = [Paragraph([reason], "note") for reason in missing.values()]
    if not rows:
        todo = "Nothing was chosen yet: run ./gen sweep, then ./gen report --measure."
        notes.append(Paragraph([todo], "note"))
        return _section(rows, notes, missing)
    head = [
        Column("kernel for", lambda _, row: [_role(row)]),
        number("time, ns", "ns", "ns"),
        ratio("of paper-initial (95 %)"),
        number("\u00d7 faster than paper-initial", "times", "times_faster"),
        number("than paper-best", "times", "than_best"),
        number("than Euler, chosen", "times", "than_euler"),
        number("error to the exact result", "error", "error"),
        number("error to what it reproduces", "error", "verified_error"),
    ]
    names = [
        text("kernel for", "role"),
        code("kernel", "kernel"),
        text("decided by", "by"),
        Column("ties", lambda _, row: [Code(f"{name} ") for name in row["ties"]] or ["none named"]),
    ]
    blocks = [
        *notes,
        records(("chosen",), rows, head),
        Paragraph([_ERRORS], "soft"),
        Details("Names, and who decided", [records(("chosen",), rows, names)]),
    ]
    return _section(rows, blocks, missing)


def _section(rows: list[dict[str, Any]], blocks: list[Block], missing: dict[str, str]) -> Section:
    title = "What was chosen, and how much faster at what error"
    return Section("chosen", "Chosen", title, {"chosen": rows}, blocks, missing)


def _role(row: Any) -> str:
    return f"{row['role']} ({row['width']} lanes)" if row["width"] > 1 else str(row["role"])


def _missing(known: Known) -> dict[str, str]:
    """What of the chosen kernels was not measured, or was measured of others."""
    findings = known.findings
    if findings is None:
        return {}
    missing = {}
    measured = {k.name for k in findings.kernels} | {row.kernel for row in findings.calls}
    if stale := sorted({final.chosen for final in known.stored.finals.values()} - measured):
        missing["measured"] = (
            f"{len(stale)} of the kernels that the sweep chose were not measured, as {stale[0]}: "
            "./gen report --measure"
        )
    if findings.sources != sources_hash():
        missing["age"] = (
            f"what was measured ({findings.made_at}) is of kernels as other sources of carom gave "
            "them: ./gen report --measure makes it anew"
        )
    return missing


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
        **_times(kernel.timed, final, by),
        "than_best": ratios[BEST] / own if own and BEST in ratios else None,
        "than_euler": ratios[EULER] / own if own and EULER in ratios else None,
        "error": kernel.error,
        "verified_error": kernel.verified_error,
    }


def _swept(final: Final) -> dict[str, Any]:
    entry = next(f for f in final.finalists if f.subject.name == final.chosen)
    subject = entry.subject
    role = EULER if subject.budget is None else role_of_budget(subject.budget)
    return {
        "role": f"{role} by the sweep" if subject.call == "scalar" else f"{role}, batch",
        "kernel": final.chosen,
        "call": subject.call,
        "width": subject.width,
        **_times(entry.times, final, ""),
        "than_best": None,
        "than_euler": None,
        "error": None if subject.budget is None else entry.max_rel_error,
        "verified_error": entry.max_rel_error,
    }


def _times(times: TimingResult | Times | None, final: Final | None, by: str) -> dict[str, Any]:
    """What decided, and how fast it is; as the store and what was measured have it."""
    names = ("ns", "cycles", "ratio", "ratio_ci")
    return {
        "by": f"a sweep's final ({final.purpose})" if final else by,
        "ties": [name for name in (final.ties if final else ()) if final and name != final.chosen],
        **{name: getattr(times, name, None) for name in names},
        "times_faster": 1 / times.ratio if times else None,
    }
