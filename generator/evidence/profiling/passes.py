"""How many steps collisions take: as many turns a lane has in the loop of an exact batch."""

from __future__ import annotations

from pathlib import Path

from ...emission.kernel_source import emit
from ...registry.variant import Variant
from ...targets.target import Target
from ...toolchain.compilers import Compiler
from ...toolchain.flags import compile_flags
from ..verification.errors import Array
from .counting import count_operations


def steps_a_collision(
    variant: Variant, compiler: Compiler, target: Target, cases: Array, cache_folder: Path
) -> float:
    """Steps of an exact kernel, the refused ones with them, as a mean over `cases`.

    Counted by its single calls, which make the same steps as its lanes. Raises KernelError.
    """
    single = emit(variant.in_lanes(1))
    flags = compile_flags(single.variant, compiler, target)
    counted = count_operations(single, compiler, flags, cases, cache_folder)
    return sum(passage.times for passage in counted.regions.get("step", ())) / len(cases)
