"""What the templates of two balls may see of a kernel."""

from __future__ import annotations

from dataclasses import dataclass, field

from ....emission.context import KernelContext
from ....lowering import isa
from ....lowering.collision_ends import at_zero
from ....lowering.lanes import LaneContext
from ....steppers.exact.context import ExactContext
from ....steppers.fixed.batch import FixedStepBatch
from ....steppers.fixed.loops import Loop
from ..scene import Scene


@dataclass(frozen=True, kw_only=True)
class BallBallContext(KernelContext):
    """A kernel of two balls."""

    scene: Scene
    tilt_allowed: bool
    vector_frame: bool
    core_template: str
    project_template: str
    restore_template: str
    lift: bool
    helpers: tuple[str, ...] = ()
    functions: tuple[Loop, ...] = ()
    chosen: bool = False
    c_z_before: tuple[str, ...] = ()
    estimate: isa.Estimate | None = None
    pair_rsqrt: tuple[str, ...] = ()
    pair_fma: str = ""
    rsqrt_call: str = "exact_rsqrt"
    exact: ExactContext | None = None
    lanes: LaneContext | None = None  # the vocabulary of batches in lanes
    euler_batch: FixedStepBatch | None = None
    contact_slip: tuple[str, ...] = ()  # c_x and c_z, where friction depends on them
    lanes_slip: tuple[str, ...] = ()  # the same in lanes
    law: tuple[str, str, str] | None = None  # of friction, where the kernel makes it
    motions: tuple[str, ...] = ()  # velocities that are zero in the scene, as ball1[6]
    level_pairs: tuple[tuple[str, str], ...] = ()  # velocities that are equal in the scene
    quad_lanes: tuple[dict[str, str], ...] = field(
        default=tuple({"name": n, "index": str(i)} for i, n in enumerate(("v1", "o1", "v2", "o2")))
    )

    @property
    def scalar_estimate(self) -> bool:
        """Is a scalar root estimated? Lanes that are slips make all of theirs in pairs."""
        return self.variant.get("simd") != "slips"

    def fma(self, a: str, b: str, c: str) -> str:
        """a * b + c as this kernel rounds it."""
        return f"std::fma({a}, {b}, {c})" if self.places_fma else f"{a} * {b} + {c}"

    def sum_of_squares(self, a: str, b: str) -> str:
        return self.fma(a, a, f"{b} * {b}")

    def pair_sum_of_squares(self, a: str, b: str) -> str:
        if self.pair_fma:
            return f"fma_pair({a}, {a}, {b} * {b})"
        return f"{a} * {a} + {b} * {b}"

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

    def tilt_term(self, value: str) -> str:
        return f" + {value} * b.f_z" if self.tilt_allowed else ""
