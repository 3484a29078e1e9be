"""What was chosen, against the report's kernels and fixed steps."""

from __future__ import annotations

from collections.abc import Mapping

from ..sweep.record import Final
from .data import Chosen, PlainPoint
from .measured import KernelFigures, Measured
from .subjects import BASELINE, BEST, EULER, role_of_budget


def chosen_of(finals: Mapping[str, Final], measured: Measured | None) -> list[Chosen]:
    """The measured roles first, then what a sweep chose that was not measured."""
    found = []
    by_name = {f.chosen: f for f in finals.values()}
    for kernel in measured.kernels if measured else ():
        assert measured is not None
        featured = kernel.role in (BASELINE, BEST) or kernel.role.endswith("chosen")
        if featured:
            final = by_name.get(kernel.name)
            found.append(_measured_choice(kernel, measured, final))
    known = {choice.kernel for choice in found}
    for final in finals.values():
        if final.chosen not in known:
            found.append(_swept_choice(final))
    return found


def _measured_choice(kernel: KernelFigures, measured: Measured, final: Final | None) -> Chosen:
    timed = kernel.timed
    others = {role: measured.find(role) for role in (BEST, EULER)}
    own = timed.ratio if timed else None

    def than(role: str) -> float | None:
        other = others[role]
        return other.timed.ratio / own if own and other and other.timed else None

    by = "the report" if kernel.role in (BASELINE, BEST) else "generated/, or the default"
    if final is not None:
        by = f"a sweep's final ({final.purpose})"
    ties = final.ties if final else ()
    return Chosen(
        role=kernel.role,
        kernel=kernel.name,
        call="scalar",
        width=1,
        by=by,
        ns=timed.ns if timed else None,
        cycles=timed.cycles if timed else None,
        ratio=own,
        ratio_ci=timed.ratio_ci if timed else None,
        times_faster=1 / own if own else None,
        than_best=than(BEST),
        than_euler=than(EULER),
        error=kernel.error,
        verified_error=kernel.verified_error,
        ties=tuple(name for name in ties if name != kernel.name),
    )


def _swept_choice(final: Final) -> Chosen:
    entry = next(f for f in final.finalists if f.subject.name == final.chosen)
    subject, times = entry.subject, entry.times
    role = EULER if subject.budget is None else role_of_budget(subject.budget)
    return Chosen(
        role=f"{role} by the sweep" if subject.call == "scalar" else f"{role}, batch",
        kernel=final.chosen,
        call=subject.call,
        width=subject.width,
        by=f"a sweep's final ({final.purpose})",
        ns=times.ns,
        cycles=times.cycles,
        ratio=times.ratio,
        ratio_ci=times.ratio_ci,
        times_faster=1 / times.ratio,
        than_best=None,
        than_euler=None,
        error=None if subject.budget is None else entry.max_rel_error,
        verified_error=entry.max_rel_error,
        ties=tuple(name for name in final.ties if name != final.chosen),
    )


def points_of(measured: Measured | None) -> list[PlainPoint]:
    """The chosen kernels, the report's, and fixed steps with other N, by their exact errors."""
    if measured is None:
        return []
    first = measured.find(BASELINE)
    if first is None or first.timed is None:
        return []
    base = first.timed.ns / first.timed.ratio
    found = []
    for kernel in measured.kernels:
        if kernel.timed and kernel.error is not None:
            group = "report" if kernel.role in (BASELINE, BEST) else "chosen"
            found.append(
                PlainPoint(kernel.role, group, kernel.timed.ns, kernel.timed.ratio, kernel.error)
            )
    for point in measured.growth:
        if point.role == EULER:
            label = f"Euler, N = {point.steps}"
            found.append(PlainPoint(label, "euler", point.ns, point.ns / base, point.error))
    return found
