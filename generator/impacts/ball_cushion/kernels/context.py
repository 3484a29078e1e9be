"""What the templates of a ball and a cushion may see of a kernel."""

from __future__ import annotations

from dataclasses import dataclass

from ....emission.context import KernelContext
from ..scene import Scene
from .fixed import FixedStepParts


@dataclass(frozen=True, kw_only=True)
class CushionContext(KernelContext):
    """A kernel of a ball and a cushion."""

    scene: Scene
    scheme: FixedStepParts | None = None

    @property
    def radius_varies(self) -> bool:
        return any(f.name == "R" for f in self.fields)
