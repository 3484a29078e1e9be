"""What headers, contracts and checks say of two balls: their parameters, motions and scenes."""

from __future__ import annotations

from .models import find_model
from .parameters import MASS_1, MASS_1_MEANING, MEANINGS, UNITS
from .parameters import case_value as case_value
from .scene import ALCIATORE, Scene
from .terms import MASS_RATIOS

SOURCE = "Source: Mathavan, Jackson, Parkin, Sports Engineering 17 (2014), Eqs. 3-14."
STATE = "Units: m, kg, s, rad. Balls: 9 doubles, row-major position, velocity, angular velocity."
NO_FIXED_STEPS = (
    "the fixed-step scheme is pooltool's, of equal balls and in double; expected a scene with "
    "mass_ratio = 1 and precision = 'double', or --max-error"
)


def meaning(key: str, scene: Scene) -> str:
    """Unit and meaning of a parameter, as a member of a struct is explained."""
    if key == MASS_1:
        return f"kg, {MASS_1_MEANING}"
    if key == "M" and scene.masses_given:
        return "kg, mass of ball 2"
    if key == "M" and not scene.equal_masses:
        return f"kg, mass of ball 2; that of ball 1 is {scene.mass_ratio:g} times as much"
    if key == "u_b" and scene.makes_varied:
        return "1, friction between the balls, made from their slip"
    return f"{UNITS[key]}, {MEANINGS[key]}"


def check(key: str, scene: Scene) -> str:
    """The C++ condition that a parameter given with the call is in its range."""
    if key == MASS_1:  # products with whole numbers: a ratio at either end is not rounded out
        low, high = MASS_RATIOS
        return f"p.M1 * {1 / low!r} >= p.M && p.M1 <= {high!r} * p.M"
    low, high = scene.range_of(key)
    return f"in_range(p.{key}, {low!r}, {high!r})"


def joint_checks(scene: Scene) -> tuple[str, ...]:
    """C++ conditions on several parameters at once."""
    return ("p.u_s1 == p.u_s2",) if scene.equal_table else ()


def motions(scene: Scene) -> tuple[tuple[str, ...], tuple[tuple[str, str], ...]]:
    """Inputs that a scene wants to be zero, and pairs of them that it wants to be equal."""
    zero: list[str] = []
    spins = {"none": (6, 7, 8), "side": (6, 7), "any": ()}[scene.spin]
    zero += [f"ball1[{i}]" for i in spins]
    still = range(3, 9) if scene.object_ball == "rest" else spins
    zero += [f"ball2[{i}]" for i in still]
    return tuple(zero), (("ball1[5]", "ball2[5]"),)


def law(scene: Scene) -> tuple[str, str, str] | None:
    """a, b, c of u_b = a + b exp(-c slip), where the kernel makes u_b."""
    if not scene.makes_varied:
        return None
    a, b, c = (repr(value) for value in ALCIATORE)
    return a, b, c


def varied_note(scene: Scene) -> str:
    """What a batch may be given instead of the one friction between the balls."""
    if scene.makes_varied:
        return "u_b must be NULL (the kernel makes it)"
    return "u_b may be NULL (then p decides)"


def contract(scene: Scene, model_name: str, method: tuple[str, ...]) -> tuple[str, ...]:
    """The sentences above a kernel; `method`: what is said of its stepper."""
    model = find_model(model_name)
    parameters = ", ".join(f"{key} {_range_text(key, scene)}" for key in scene.free)
    return (
        f"Frictional collision of {_balls(scene)}, contact model `{model.name}`: {model.text}.",
        method[0],
        f"Valid: {parameters or 'every parameter is fixed'}; speeds below 1e100 m/s.",
        *scene_lines(scene),
        STATE,
        *method[1:],
        SOURCE,
    )


def _balls(scene: Scene) -> str:
    if scene.masses_given:
        return "two balls of one radius, of masses M1 and M"
    if scene.equal_masses:
        return "two equal balls"
    return f"two balls of one radius, ball 1 {scene.mass_ratio:g} times as heavy as ball 2"


def _range_text(key: str, scene: Scene) -> str:
    if key == MASS_1:
        return "{:g} M to {:g} M".format(*MASS_RATIOS)
    return "{:g} to {:g}".format(*scene.range_of(key))


def scene_lines(scene: Scene) -> tuple[str, ...]:
    """What a scene says of the motions, for the contract and the header."""
    says = []
    if scene.object_ball == "rest":
        says.append("ball 2 at rest")
    if scene.spin == "none":
        says.append("no ball spins")
    if scene.spin == "side":
        says.append("spin about the vertical axis alone")
    if scene.speed is not None:
        says.append(f"|v1 - v2| {scene.speed[0]:g} to {scene.speed[1]:g} m/s")
    if scene.spin_speed is not None:
        says.append(f"R |w| at most {scene.spin_speed:g} m/s")
    if not scene.table_friction:
        says.append("no table friction")
    if scene.equal_table:
        says.append("u_s1 = u_s2")
    if scene.makes_varied:
        says.append("u_b by Alciatore's law from the contact slip before")
    return (f"Scene `{scene.name}`: {'; '.join(says)}.",) if says else ()
