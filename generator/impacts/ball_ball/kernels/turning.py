"""Velocities on the axes of the contact and back on those of the table: one text for any width.

Spins are carried as speeds o = R w. A `b` holds f, the line of centres, and what is turned to it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ....lowering.lane_algebra import InLanes, Lines, Number, number, numbers
from ....lowering.printer import ExpressionPrinter, Group

Text = tuple[str, ...]
PRINTER = ExpressionPrinter(False)
F_X, F_Y, F_Z = numbers("b.f_x b.f_y b.f_z")
VECTORS = ("v1", "o1", "v2", "o2")  # in four lanes


def to_contact(x: Number, y: Number, z: Number, tilted: bool) -> tuple[Number, Number]:
    """Across the line of centres and along it; `tilted`: may it rise?"""
    along = x * F_X + y * F_Y
    return x * F_Y - y * F_X, along + z * F_Z if tilted else along


def to_table(x: Number, y: Number) -> tuple[Number, Number]:
    return x * F_Y + y * F_X, y * F_Y - x * F_X


def _of_b(name: str) -> tuple[Number, ...]:
    return tuple(number(f"b.{name}{axis}") for axis in "xyz")


def turned_in(radius: str, tilted: bool, reads: Callable[[str], bool]) -> Text:
    """Of balls in `ball1` and `ball2`: the velocities that `reads` does not know to be zero."""
    lines = Lines(PRINTER)
    for ball in "12":
        for kind, at in (("v", 3), ("o", 6)):
            x, y, z = (number(f"ball{ball}[{at + i}]") for i in range(3))
            values = (*to_contact(x, y, z, tilted), z)
            asked = "xxz" if kind == "o" else "xxx"  # what is known of the others, too
            for target, value, axis in zip(_of_b(f"{kind}{ball}"), values, asked, strict=True):
                if reads(f"{kind}{ball}{axis}"):
                    lines.set(target, number(radius) * value if kind == "o" else value)
    return lines.part()


def turned_back(to: Callable[[int, int], str], tilted: bool, level: bool = False) -> Text:
    """Of both balls; `to` names where the i-th velocity goes. `level`: where some stay zero."""
    lines = Lines(PRINTER)
    for ball in (1, 2):
        for i, value in enumerate(_back(ball, tilted)):
            if not (level and i in (2, 3, 4)):
                lines.set(number(to(ball, i)), value)
    return lines.part()


def _back(ball: int, tilted: bool) -> Iterator[Number]:
    """The six velocities of a ball on the axes of the table."""
    v_x, v_y, v_z = _of_b(f"v{ball}")
    o_x, o_y, o_z = _of_b(f"o{ball}")
    yield from (*to_table(v_x, v_y), v_z)
    upright = o_z + o_y * F_Z if tilted else o_z
    for value in (*to_table(o_x, o_y), upright):
        yield InLanes(Group(value.form)) * number("per_radius")


def quads_in(tilted: bool) -> Text:
    """As turned_in, of all four vectors at once: what is known to be zero is turned, too."""
    lines, scale = Lines(PRINTER, "Quad"), number("scale")
    for at, axis in enumerate("xyz", 3):
        read = (f"ball{ball}[{at + spin}]" for ball in "12" for spin in (0, 3))
        lines.extend((f"const Quad {axis} = {{{', '.join(read)}}};",))
    x, y, z = numbers("x y z")
    for axis, value in zip("xyz", (*to_contact(x, y, z, tilted), z), strict=True):
        lines.number(f"local_{axis}", value * scale)
    for lane, name in enumerate(VECTORS):
        for axis in "xyz":
            lines.set(number(f"b.{name}{axis}"), number(f"local_{axis}[{lane}]"))
    return lines.part()


def quads_back(to: Callable[[int, int], str], tilted: bool) -> Text:
    lines, scale = Lines(PRINTER, "Quad"), number("scale")
    for axis in "xy":
        lanes = ", ".join(f"b.{name}{axis}" for name in VECTORS)
        lines.extend((f"const Quad {axis} = Quad{{{lanes}}};",))
    for axis, value in zip("xy", to_table(*numbers("x y")), strict=True):
        lines.number(f"world_{axis}", value * scale)
    for ball in (1, 2):
        _, _, v_z, _, _, o_z = _back(ball, tilted)
        v_x, o_x, v_y, o_y = (
            number(f"world_{axis}[{2 * ball - 2 + spin}]") for axis in "xy" for spin in (0, 1)
        )
        for i, value in enumerate((v_x, v_y, v_z, o_x, o_y, o_z)):
            lines.set(number(to(ball, i)), value)
    return lines.part()
