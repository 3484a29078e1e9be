"""The lane vocabulary that a batch kernel is written in; templates/lanes/README.md describes it."""

from __future__ import annotations

from dataclasses import dataclass

from generator.targets.target import Target
from generator.variants.lanes import set_for


@dataclass(frozen=True)
class LaneContext:
    """What templates/lanes/*.j2 may see as `lanes`."""

    name: str  # the instruction set
    width: int  # lanes of one vector
    interleave: int  # vectors that are worked on in turn
    fma: bool  # is `fma` one instruction?
    rsqrt14: bool  # is there a double estimate to 2^-14?
    estimate_error: float  # relative, of rsqrt_estimate

    @property
    def vectors(self) -> range:
        return range(self.interleave)

    @property
    def vector_template(self) -> str:
        """The file of the instruction set."""
        return f"lanes/{self.name}.j2"

    @property
    def template(self) -> str:
        """What a kernel includes, inside a namespace of its own."""
        return self.vector_template if self.interleave == 1 else "lanes/interleaved.j2"

    @property
    def whole(self) -> int:
        """Lanes in flight: kLanes."""
        return self.width * self.interleave


def lane_context(target: Target, width: int, interleave: int = 1, fma: bool = True) -> LaneContext:
    """The vocabulary for vectors of `width` doubles. ValueError where the target has none.

    `fma`: place fused multiply-adds, where the target has them.
    """
    rsqrt14 = target.has("avx512vl") or (width == 8 and target.has("avx512f"))
    error = 2.0**-14 if rsqrt14 else 1.5 * 2.0**-12
    if target.has("neon"):
        error = 2.0**-8
    if target.has("simd128"):
        error = 2.0**-52  # the root itself
    return LaneContext(
        name=set_for(target, width).name,
        width=width,
        interleave=interleave,
        fma=fma and target.has("fma"),
        rsqrt14=rsqrt14,
        estimate_error=error,
    )
