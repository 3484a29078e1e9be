"""What a fixed-step loop carries: its declarations, and how it comes back to the contact."""

from __future__ import annotations

from .....lowering.statements import Part
from .loop import EMPTY, join, text
from .parts import FixedStepLowering

BALLS = ("1", "2")
ALL_SLIPS = ("c_x", "c_z", "s1x", "s1y", "s2x", "s2y", "v_n")
TAGS = ("c", "s1", "s2")


def components(tag: str) -> tuple[str, str]:
    """The components of the contact slip, or of a ball's table slip."""
    return ("c_x", "c_z") if tag == "c" else (f"{tag}x", f"{tag}y")


def full_state(low: FixedStepLowering, slips: tuple[str, ...] = ALL_SLIPS) -> tuple[str, ...]:
    """All velocities, and those slips that last from one iteration to the next."""
    arrays = low.variant["store"] == "arrays"
    spin, scale = ("w", " / p.R") if low.physical else ("o", "")
    lines = []
    for ball in BALLS:
        axes = "xyz" if arrays or low.terms.lift else "xy"
        names = [f"v{ball}{axis}" for axis in axes]
        lines += _declared(f"v{ball}", names, [f"b.{name}" for name in names], arrays)
        names = [f"{spin}{ball}{axis}" for axis in "xyz"]
        values = [f"b.o{ball}{axis}{scale}" for axis in "xyz"]
        lines += _declared(f"{spin}{ball}", names, values, arrays)
    if low.recomputes:
        return (*lines, *low.slips_of_state("double", ("v_n",)))
    if not arrays:
        return (*lines, *low.slips_of_state("double", slips))
    others = tuple(name for name in slips if name != "v_n")
    lines += [*_slip_arrays(low, others), *low.slips_of_state(only=others)]
    return (*lines, *low.slips_of_state("double", ("v_n",)))


def slips_anew(low: FixedStepLowering) -> Part:
    """All slips but v_n, for one iteration only."""
    names = tuple(name for name in ALL_SLIPS if name != "v_n")
    if low.variant["store"] != "arrays":
        return low.slips_of_state("const double", names)
    return join(text(*_slip_arrays(low, names)), low.slips_of_state(only=names))


def _slip_arrays(low: FixedStepLowering, names: tuple[str, ...]) -> list[str]:
    tags = sorted({low.printer.name_of(name)[:-3] for name in names})
    return [f"double {tag}[2];" for tag in tags]


def reduced_state(low: FixedStepLowering, tags: tuple[str, ...] = TAGS) -> tuple[str, ...]:
    """Slips alone, and the velocities that v_n is made of."""
    arrays = low.variant["store"] == "arrays"
    names = tuple(name for tag in tags for name in components(tag))
    lines = list(low.slips_of_contact("_0", (*names, "v_n")))
    for tag in tags:
        values = [f"{name}_0" for name in components(tag)]
        lines += _declared(tag, list(components(tag)), values, arrays)
    lines.append("double v_n = v_n_0;")
    axes = "xyz" if arrays else "yz" if low.terms.lift and tags == TAGS else "y"
    for ball in BALLS:
        own = [f"v{ball}{axis}" for axis in axes]
        lines += _declared(f"v{ball}", own, [f"b.{name}" for name in own], arrays)
    return tuple(lines)


def _declared(array: str, names: list[str], values: list[str], arrays: bool) -> list[str]:
    if arrays:
        return [f"double {array}[{len(names)}] = {{{', '.join(values)}}};"]
    return [f"double {name} = {value};" for name, value in zip(names, values, strict=True)]


def full_back(low: FixedStepLowering) -> Part:
    """All velocities back to the contact."""
    spin, scale = ("w", " * p.R") if low.physical else ("o", "")
    name = low.printer.name_of
    lines = []
    for ball in BALLS:
        axes = "xyz" if low.terms.lift else "xy"
        lines += [f"b.v{ball}{a} = {name(f'v{ball}{a}')};" for a in axes]
        lines += [f"b.o{ball}{a} = {name(f'{spin}{ball}{a}')}{scale};" for a in "xyz"]
    return text(*lines)


def vertical_back(low: FixedStepLowering) -> Part:
    """The vertical velocities of models with lift."""
    if not low.terms.lift:
        return EMPTY
    return text(*(f"b.v{ball}z = {low.printer.name_of(f'v{ball}z')};" for ball in BALLS))


def masked_lift(low: FixedStepLowering) -> tuple[str, ...]:
    """Vertical velocities after one step, without a branch."""
    if not low.terms.lift:
        return ()
    per_mass = " / p.M" if low.physical else ""
    one, two = low.printer.name_of("v1z"), low.printer.name_of("v2z")
    return (
        f"{one} += (d_z > 0.0 ? d_z : 0.0){per_mass};",
        f"{two} -= (d_z < 0.0 ? d_z : 0.0){per_mass};",
    )
