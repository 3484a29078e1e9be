"""What the templates of a ball and a cushion may see of a kernel."""

from __future__ import annotations

from dataclasses import dataclass

from ....emission.context import KernelContext
from ..models import find_model
from ..scene import Scene
from .fixed import FixedStepParts


@dataclass(frozen=True, kw_only=True)
class CushionContext(KernelContext):
    """A kernel of a ball and a cushion."""

    scene: Scene
    scheme: FixedStepParts | None = None

    @property
    def clamped(self) -> bool:
        """Does the table only push?"""
        return find_model(self.variant.model).terms.clamped

    def fma(self, a: str, b: str, c: str) -> str:
        """a * b + c as this kernel rounds it."""
        return f"std::fma({a}, {b}, {c})" if self.places_fma else f"{a} * {b} + {c}"
