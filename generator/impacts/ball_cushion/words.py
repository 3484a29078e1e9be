"""What headers, contracts and checks say of a ball and a cushion."""

from __future__ import annotations

from .models import find_model
from .parameters import MEANINGS, NAMES, UNITS
from .scene import Scene

SOURCE = "Source: Mathavan, Jackson, Parkin, Proc. IMechE C 224 (2010) 1863-1873, Eqs. 3-16."
STATE = (
    "Units: m, kg, s, rad. Ball: 6 doubles, velocity and angular velocity; normal: 2, level, into "
    "the cushion, of any length."
)
NO_FIXED_STEPS = (
    "the fixed-step scheme is pooltool's, in double; expected a scene with precision = 'double', "
    "or --max-error"
)


def meaning(key: str, scene: Scene) -> str:
    """Unit and meaning of a parameter, as a member of a struct is explained."""
    return f"{UNITS[key]}, {MEANINGS[key]}"


def check(key: str, scene: Scene) -> str:
    """The C++ condition that a parameter given with the call is in its range."""
    low, high = scene.range_of(key)
    return f"in_range(p.{key}, {low!r}, {high!r})"


def joint_checks(scene: Scene) -> tuple[str, ...]:
    """C++ conditions on several parameters at once."""
    return ("p.h >= p.R", "p.h < 2.0 * p.R", "!jams(p)")


def varied_note(scene: Scene) -> str:
    """What a batch may be given instead of the one friction of the cushion."""
    return "u_w may be NULL (then p decides)"


def contract(scene: Scene, model_name: str, method: tuple[str, ...]) -> tuple[str, ...]:
    """The sentences above a kernel; `method`: what is said of its stepper."""
    model = find_model(model_name)
    parameters = ", ".join(
        "{} {:g} to {:g}".format(key, *scene.range_of(key)) for key in scene.free
    )
    return (
        f"Frictional impact of a ball on a cushion, contact model `{model.name}`: {model.text}.",
        method[0],
        f"Valid: {parameters or 'every parameter is fixed'}; R <= h < 2 R, and "
        "asin(h/R - 1) + atan u_s + atan u_w below 90 degrees; speeds below 1e100 m/s.",
        *scene_lines(scene),
        STATE,
        *method[1:],
        SOURCE,
    )


def scene_lines(scene: Scene) -> tuple[str, ...]:
    """What a scene says of the motions, for the contract and the header: nothing so far."""
    return ()


def case_value(key: str, row: str) -> str:
    """A parameter of a case as C++ text, its six from the array `row`."""
    return f"{row}[{NAMES.index(key)}]"
