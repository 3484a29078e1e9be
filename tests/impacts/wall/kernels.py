from __future__ import annotations

from generator.emission.context import KernelContext, KernelHead
from generator.lowering.counts import OperationCounts


class WallKernels:
    def context(self, head: KernelHead) -> KernelContext:
        return KernelContext(
            **vars(head),
            body="wall/body.j2",
            one="wall/collide_one.j2",
            batch=False,
            method=("Closed form, exact but for rounding.",),
            counts=OperationCounts(add=4, mul=6),
        )


KERNELS = WallKernels()
