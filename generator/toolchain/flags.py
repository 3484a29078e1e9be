"""The flag sets of the axis `flags`, for compiling alone; linking takes none of them."""

from __future__ import annotations

from ..registry.variant import Variant
from ..targets.target import Target
from .compilers import Compiler, march_flags

# Both keep every value as IEEE 754 gives it: the first drops only the write to `errno` by sqrt (and
# so the call to the library), the second only the promise about when exception flags are raised,
# which allows an arithmetic operation on the side of a branch that is not taken.
STRICT = ("-O3", "-fno-math-errno", "-fno-trapping-math")

# The report's own. -Ofast stands for -O3 -ffast-math: NaN, infinities and signed zeros may be
# ignored and sums reordered. Guards against bad input in kernels must look at bits, not use isnan.
_REPORT = ("-Ofast", "-fno-math-errno", "-funroll-loops", "-ftree-vectorize")
_REPORT_SETS = {"avx2": "-mavx2", "fma": "-mfma"}  # as far as the target has them

# -Ofast given to the *linker* adds crtfastm.o, whose constructor makes denormals zero in the
# process that loads the library. So flags reach compilation only, and this is all the linker gets.
LINK_FLAGS = ("-shared",)


def compile_flags(variant: Variant, compiler: Compiler, target: Target) -> tuple[str, ...]:
    """The flags of a variant: set, CPU and contraction, which is last and so always holds.

    Contraction follows the axis `fma` in both sets: `autofma` leaves it to the compiler, as the
    report's flags do; `nofma` and `fma` turn it off.
    """
    if variant["flags"] == "report":
        x86 = target.row.arch == "x86_64"
        sets = [flag for has, flag in _REPORT_SETS.items() if x86 and target.has(has)]
        chosen = [*_REPORT, *sets]
    else:
        chosen = list(STRICT)
    contract = "fast" if variant["fma"] == "autofma" else "off"
    march = march_flags(compiler, target).flags
    return ("-std=c++17", *chosen, *march, f"-ffp-contract={contract}")
