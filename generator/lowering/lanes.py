"""The lane vocabulary that a batch kernel is written in; templates/lanes/README.md describes it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..registry.lanes import Precision, set_for
from ..targets.target import FRSQRTE_ERROR, RSQRT14_ERROR, RSQRTSS_ERROR, Target


@dataclass(frozen=True)
class NumberForm:
    """What a lane is: its C++ type, and what the templates of lanes do with its bits."""

    real: str  # the C++ type
    bits: int
    suffix: str  # of x86 intrinsics
    neon: str  # of NEON's
    sign: str  # the sign bit
    exponent: str  # the bits of the exponent
    step: str  # the lowest of them
    inverse: str  # twice the bits of 1: less those of a power of two, those of its inverse
    one: str  # the bits of 1, as a product of doubles


NUMBERS: dict[Precision, NumberForm] = {
    "double": NumberForm(
        real="double",
        bits=64,
        suffix="pd",
        neon="f64",
        sign="0x8000000000000000u",
        exponent="0x7ff0000000000000u",
        step="0x0010000000000000u",
        inverse="0x7fe0000000000000u",
        one="1023.0 * 4503599627370496.0",
    ),
    "float": NumberForm(
        real="float",
        bits=32,
        suffix="ps",
        neon="f32",
        sign="0x80000000u",
        exponent="0x7f800000u",
        step="0x00800000u",
        inverse="0x7f000000u",
        one="127.0 * 8388608.0",
    ),
}


@dataclass(frozen=True)
class LaneContext:
    """What templates/lanes/*.j2 may see as `lanes`."""

    name: str  # the instruction set
    number: NumberForm  # what a lane is
    width: int  # lanes of one vector
    interleave: int  # vectors that are worked on in turn
    fma: bool  # is `fma` one instruction?
    rsqrt14: bool  # is there an estimate to 2^-14?
    estimates: bool  # is rsqrt_estimate an instruction's? Else it is the root itself
    estimate_error: float  # relative, of rsqrt_estimate
    mask_type: str  # where masks are no vectors
    packed_bytes: int  # of a lane, as a shuffle takes them: 1 where it takes whole lanes
    frame: LaneContext | None = None  # of floats: the doubles that their frame is worked on in
    converts: bool = False  # of doubles: are they loaded from floats and stored to them too?

    @property
    def floats(self) -> bool:
        return self.number.real == "float"

    @property
    def vector_bytes(self) -> int:
        return self.width * self.number.bits // 8

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

    @property
    def bits_type(self) -> str:
        """What a bit for each lane in flight fits into."""
        return "unsigned" if self.whole <= 32 else "std::uint64_t"


def lane_context(
    target: Target,
    width: int,
    interleave: int = 1,
    fma: bool = True,
    precision: Precision = "double",
    estimates: bool = True,
) -> LaneContext:
    """The vocabulary for vectors of `width` numbers. ValueError where the target has none.

    `fma`: place fused multiply-adds, where the target has them; `estimates`: take the instructions
    that estimate roots, where it has them. Floats come with their frame: half
    as many doubles, which hold what must not be rounded to float (positions, speeds, statuses).
    """
    wide = 8 if precision == "double" else 16
    rsqrt14 = target.has("avx512vl") or (width == wide and target.has("avx512f"))
    error = RSQRT14_ERROR if rsqrt14 else RSQRTSS_ERROR
    if target.has("neon"):
        error = FRSQRTE_ERROR
    if target.has("simd128") or not estimates:
        error = 2.0**-52 if precision == "double" else 2.0**-23  # the root itself
    found = set_for(target, width, precision)
    frame = None
    if precision == "float" and width > 1:
        frame = replace(
            lane_context(target, width // 2, 1, fma, "double", estimates), converts=True
        )
    return LaneContext(
        name=found.name,
        number=NUMBERS[precision],
        width=width,
        interleave=interleave,
        fma=fma and target.has("fma"),
        rsqrt14=rsqrt14,
        estimates=estimates,
        estimate_error=error,
        mask_type=f"__mmask{width}" if found.name == "avx512" else "",
        packed_bytes=1 if found.name == "avx2" else 4,
        frame=frame,
    )
