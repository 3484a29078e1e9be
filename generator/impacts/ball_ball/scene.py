"""A scene of two balls: what is fixed, what ranges and motions occur."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from importlib import resources
from typing import Annotated, ClassVar, Literal

from pydantic import BeforeValidator, Field

from ...errors import named
from ..scene import BaseScene, pair, scene_from, scenes_in
from .models import DEFAULT_MODEL, MODELS
from .parameters import CASE_M1, LIMITS, MASS_1, NAMES, TABLE_FRICTION
from .terms import MASS_RATIOS

NO_TABLE_FRICTION = dict.fromkeys(TABLE_FRICTION, 0.0)
SPEED_LIMITS = (1e-6, 1e6)  # m/s; where speeds are known to lie within, no square needs scaling
# Alciatore's ball-ball friction, u_b = a + b exp(-c slip), slip in m/s before the collision
# (Alciatore, TP A.14; a fit to Marlow's measurements).
ALCIATORE = (9.951e-3, 0.108, 1.088)

Speed = Annotated[float, Field(ge=SPEED_LIMITS[0], le=SPEED_LIMITS[1])]
SpeedRange = Annotated[tuple[Speed, Speed], BeforeValidator(pair)]
Ratio = Annotated[float, Field(ge=MASS_RATIOS[0], le=MASS_RATIOS[1])] | Literal["given"]


class Scene(BaseScene):
    """A scene file of two balls."""

    limits: ClassVar[Mapping[str, tuple[float, float]]] = LIMITS
    models: ClassVar[tuple[str, ...]] = tuple(model.name for model in MODELS)

    speed: SpeedRange | None = None  # |v1 - v2| before, m/s
    spin_speed: Speed | None = None  # R |w| of either ball before is at most this, m/s
    spin: Literal["any", "side", "none"] = "any"  # side: about the vertical axis alone
    object_ball: Literal["any", "rest"] = "any"  # ball 2
    table_friction: bool = True
    equal_table: bool = False  # u_s1 = u_s2
    friction_law: Literal["given", "alciatore"] = "given"
    mass_ratio: Ratio = 1.0  # ball 1 to ball 2; M is that of ball 2, M1 that of ball 1 if given
    model: str = DEFAULT_MODEL

    def checks(self) -> tuple[Callable[[], str], ...]:
        own = (self._table, self._friction, self._motions, self._masses)
        return self._parameters, *own, self._method

    def _table(self) -> str:
        stated = [k for part in (self.fixed, self.ranges) for k in TABLE_FRICTION if k in part]
        if not self.table_friction and stated:
            return f"table_friction: false leaves no {stated[0]} to state; remove one of the two"
        if not self.equal_table:
            return ""
        if not self.table_friction:
            return "equal_table: there is no table friction; remove it"
        if self.level:
            return f"equal_table: without effect, spin = '{self.spin}' presses no ball; remove it"
        if any(key in self.fixed for key in TABLE_FRICTION):
            return "equal_table: without effect where u_s1 or u_s2 is fixed; fix both to one value"
        if self.ranges.get("u_s1") != self.ranges.get("u_s2"):
            return "equal_table: ranges of u_s1 and u_s2 differ; expected the same or none"
        return ""

    def _friction(self) -> str:
        if self.friction_law == "alciatore":
            for part, table in (("fixed", self.fixed), ("ranges", self.ranges)):
                if "u_b" in table:
                    return f"friction_law: 'alciatore' makes u_b, so {part}.u_b has no effect"
        return ""

    def _motions(self) -> str:
        if self.speed is not None and not self.speed[0] < self.speed[1]:
            return f"speed: [{self.speed[0]:g}, {self.speed[1]:g}]; expected the lower speed first"
        if self.spin_speed is not None and self.spin == "none":
            return "spin_speed: without effect where spin = 'none'; remove it"
        return ""

    def _masses(self) -> str:
        if not self.equal_masses and not self.table_friction and not self.level:
            return "mass_ratio: only 1 without table friction; expected table_friction = true"
        if self.masses_given and ("M" in self.fixed or "M" in self.ranges):
            return "mass_ratio: 'given' gives both masses with the call; remove M from the scene"
        return ""

    # -- what follows from the statements --

    @property
    def level(self) -> bool:
        """Is there no vertical contact slip? Then no ball is pressed, and all is closed form."""
        return self.spin != "any"

    @property
    def closed_form(self) -> str:
        return f"spin = '{self.spin}'" if self.level else ""

    @property
    def one_table(self) -> bool:
        """Is table friction the same for both balls?"""
        same = self.fixed.get("u_s1", 1.0) == self.fixed.get("u_s2", 2.0)
        return self.equal_table or same

    @property
    def bounded(self) -> bool:
        """Are all speeds known to be such that their squares are ordinary numbers?"""
        return self.speed is not None and self.spin_speed is not None and self.object_ball == "rest"

    @property
    def masses_given(self) -> bool:
        """Do both masses come with the call, M1 and M?"""
        return self.mass_ratio == "given"

    @property
    def equal_masses(self) -> bool:
        return self.mass_ratio == 1

    @property
    def fixed_steps(self) -> bool:
        """Has it fixed-step kernels? That scheme is pooltool's: of equal balls and in double."""
        return self.equal_masses and super().fixed_steps

    @property
    def without_exact_lanes(self) -> str:
        if self.level:
            return ""  # a closed form, whatever else there is
        if not self.table_friction:
            return "no table friction"
        if not self.equal_masses:
            return "unequal masses"
        return ""

    @property
    def members(self) -> tuple[str, ...]:
        if not self.masses_given:
            return NAMES
        behind = NAMES.index("M") + 1
        return (*NAMES[:behind], MASS_1, *NAMES[behind:])

    @property
    def constants(self) -> Mapping[str, float]:
        return self.fixed if self.table_friction else {**self.fixed, **NO_TABLE_FRICTION}

    @property
    def free(self) -> tuple[str, ...]:
        return tuple(key for key in super().free if key != "u_b" or not self.makes_varied)

    @property
    def makes_varied(self) -> bool:
        return self.friction_law == "alciatore"

    @property
    def oracle_options(self) -> tuple[str, ...]:
        if self.masses_given:
            return (f"mass1={CASE_M1!r}",)
        return () if self.equal_masses else (f"mass_ratio={self.mass_ratio!r}",)


def parse_scene(text: str, source: str) -> Scene:
    """A scene from TOML text. Raises InputError that names the file and the key."""
    return scene_from(Scene, text, source)


@cache
def scenes() -> dict[str, Scene]:
    """The scenes that are shipped, by name."""
    folder = resources.files(__package__) / "scenes"
    return scenes_in(Scene, folder, "generator/impacts/ball_ball/scenes")


def find_scene(name: str) -> Scene:
    """A shipped scene by its name. Raises InputError naming the scenes there are."""
    return named("scene", name, scenes())
