"""llvm-mca's pressure and bound on each target."""

from __future__ import annotations

from collections.abc import Callable

from ..known import Known
from ..layout import (
    Block,
    Cell,
    Column,
    Details,
    Number,
    Paragraph,
    Path,
    Piece,
    Section,
    Table,
    number,
    records,
    text,
)

_TEXT = (
    "One iteration of the loop as compiled for each target and simulated. Bound: cycles if "
    "nothing waited for a result. Where a kernel's loop only calls its step there is no such "
    "figure, but whole collisions are replayed."
)
_ONE = "Cycles (bound) of one iteration"
_WHOLE = (
    "Cycles of a mean collision: what ran here, replayed on the target (a few collisions; fixed "
    "steps with N = 100, times 10)"
)
_LOOP = (
    "The loop of an exact kernel is one adaptive step; cycles are of its longest way through, of "
    "which a collision takes about two."
)


def section(known: Known) -> Section:
    rows = [
        {"role": k.role, **m.model_dump(), "pressure": dict(m.pressure)}
        for k in known.kernels
        for m in k.modelled
    ]
    places = {(row["target"], row["role"]): n for n, row in enumerate(rows)}
    roles = list(dict.fromkeys(row["role"] for row in rows))
    bound = {n for n, row in enumerate(rows) if row["bound"]}

    def one(n: int) -> Cell:
        at: Path = ("modelled", n)
        found: list[Piece] = [Number("mean", (*at, "cycles"))]
        return [*found, " (", Number("mean", (*at, "bound")), ")"] if n in bound else found

    def whole(n: int) -> Cell:
        return [Number("cycles", ("modelled", n, "collision"))]

    def by_target(cell: Callable[[int], Cell], caption: str) -> Table:
        lines = [
            [[target], *(cell(places[target, r]) if (target, r) in places else [] for r in roles)]
            for target in dict.fromkeys(row["target"] for row in rows)
        ]
        return Table(["target", *roles], lines, frozenset(range(1, len(roles) + 1)), caption)

    details = records(("modelled",), rows, _columns())
    blocks: list[Block] = [
        Paragraph([_TEXT]),
        by_target(one, _ONE),
        by_target(whole, _WHOLE),
        Details("Pressure on each unit, bottlenecks, micro-operations", [details]),
        Paragraph([_LOOP], "soft"),
    ]
    title, missing = "llvm-mca: pressure and bound on each target", known.unmeasured("modelled")
    data, shown = {"modelled": rows}, blocks if rows else []
    return Section("modelled", "llvm-mca", title, data, shown, missing)


def _columns() -> list[Column]:
    return [
        text("kernel for", "role"),
        text("target", "target"),
        text("simulated CPU", "cpu"),
        number("micro-operations", "mean", "uops"),
        number("instructions a cycle", "mean", "ipc"),
        Column("bottleneck", lambda _, row: [row["bottleneck"] or row["note"]]),
        Column(
            "pressure: cycles that the busiest units are busy",
            lambda at, row: [
                piece
                for unit in row["pressure"]
                for piece in (f"{unit}\u00a0", Number("mean", (*at, "pressure", unit)), " ")
            ],
        ),
    ]
