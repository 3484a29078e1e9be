"""Operation counts of printed expressions."""

from __future__ import annotations

from dataclasses import dataclass, fields


@dataclass(frozen=True)
class OperationCounts:
    """How many operations of each kind straight-line code performs."""

    add: int = 0
    mul: int = 0
    fma: int = 0
    div: int = 0
    sqrt: int = 0
    estimate: int = 0  # hardware estimates of a reciprocal square root
    select: int = 0
    compare: int = 0

    def __add__(self, other: OperationCounts) -> OperationCounts:
        return OperationCounts(
            **{f.name: getattr(self, f.name) + getattr(other, f.name) for f in fields(self)}
        )

    def __mul__(self, times: int) -> OperationCounts:
        return OperationCounts(**{f.name: getattr(self, f.name) * times for f in fields(self)})

    @property
    def flops(self) -> int:
        """Floating-point operations, an FMA counted as two."""
        return self.add + self.mul + 2 * self.fma + self.div + self.sqrt

    def as_dict(self) -> dict[str, int]:
        return {f.name: getattr(self, f.name) for f in fields(self)}

    def describe(self) -> str:
        """Text such as `12 add, 20 mul, 3 sqrt`, kinds that do not occur left out."""
        parts = [f"{value} {name}" for name, value in self.as_dict().items() if value]
        return ", ".join(parts) if parts else "none"
