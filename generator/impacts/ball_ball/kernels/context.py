"""What the templates of two balls may see of a kernel."""

from __future__ import annotations

from dataclasses import dataclass

from ....emission.context import KernelContext
from ..scene import Scene
from ..steppers.collision_ends import at_zero
from .parts import KernelParts
from .turning import Text, quads_back, quads_in, turned_back, turned_in


@dataclass(frozen=True, kw_only=True)
class BallBallContext(KernelContext):
    """A kernel of two balls."""

    scene: Scene
    parts: KernelParts  # of the stepper
    tilt_allowed: bool
    contact_slip: tuple[str, ...]  # c_x and c_z, where friction depends on them
    lanes_slip: tuple[str, ...]  # the same in lanes
    law: tuple[str, str, str] | None  # of friction, where the kernel makes it
    motions: tuple[str, ...]  # velocities that are zero in the scene, as ball1[6]
    level_pairs: tuple[tuple[str, str], ...]  # velocities that are equal in the scene

    @property
    def vector_frame(self) -> bool:
        return self.parts.vector_frame

    @property
    def turned_in(self) -> Text:
        return turned_in("p.R", self.tilt_allowed, self.projects)

    @property
    def lanes_turned_in(self) -> Text:
        return turned_in("R", self.tilt_allowed, lambda _name: True)

    @property
    def quads_turned_in(self) -> Text:
        return quads_in(self.tilt_allowed)

    @property
    def turned_back(self) -> Text:
        return turned_back(_out, self.tilt_allowed, self.level_ends)

    @property
    def lanes_turned_back(self) -> Text:
        return turned_back(_after, self.tilt_allowed)

    @property
    def quads_turned_back(self) -> Text:
        return quads_back(_out, self.tilt_allowed)

    @property
    def level_ends(self) -> bool:
        """Do the spins' level components stay zero, so that they need not be written?"""
        return self.scene.level and not self.tilt_allowed and not self.fixed_step

    def projects(self, name: str) -> bool:
        """Is a velocity of the contact read from the input, or known to be zero?"""
        zero = {symbol.name for symbol in at_zero(self.scene)}
        return self.vector_frame or self.tilt_allowed or name not in zero

    @property
    def spinning(self) -> tuple[int, ...]:
        """The balls that may spin before."""
        return tuple(ball for ball in (1, 2) if f"o{ball}z" in self.live)

    @property
    def live(self) -> tuple[str, ...]:
        """The velocities that are not known to be zero before."""
        names = (f"{kind}{ball}{axis}" for ball in "12" for kind in "vo" for axis in "xyz")
        return tuple(name for name in names if self.projects(name))


def _out(ball: int, i: int) -> str:
    return f"out{ball}[{i + 3}]"


def _after(ball: int, i: int) -> str:
    return f"after[{6 * ball - 6 + i}]"
