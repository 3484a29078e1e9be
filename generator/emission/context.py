"""What a kernel's templates may see, and what an impact gives to it.

Emission knows what all kernels share: banner, pragmas, parameters, their checks and the C
interface. What stands between them is the impact's: its module `kernels` has a `KERNELS` that fills
in a context.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from ..impacts.impact import Functions, Impact
from ..impacts.scene import BaseScene
from ..lowering.counts import OperationCounts
from ..registry.variant import Variant
from ..targets.target import Target


@dataclass(frozen=True)
class Field:
    """One parameter as the templates show it."""

    name: str
    text: str
    value: str = ""
    check: str = ""


@dataclass(frozen=True)
class Naming:
    """What a kernel's types and functions are called; two kernels in one program differ in it."""

    prefix: str = "carom"  # of types, statuses and the header
    unit: str = ""  # one of several kernels behind a dispatcher: part of its functions' names
    enclosing: str = ""  # a namespace around everything, or empty: then only an unnamed one

    @property
    def symbol(self) -> str:
        """What the names of the functions begin with."""
        return f"{self.prefix}_{self.unit}" if self.unit else self.prefix


@dataclass(frozen=True, kw_only=True)
class KernelHead:
    """What is known of a kernel before its impact is asked."""

    name: str
    naming: Naming
    impact: Impact
    target: Target
    scene: BaseScene
    variant: Variant
    refusal: tuple[str, str]  # of a compiler or architecture: a condition, and the error's words
    includes: tuple[str, ...]
    pragmas_begin: str
    pragmas_end: str
    fixed: tuple[Field, ...]  # parameters that are constants
    free: tuple[Field, ...]  # members of Parameters
    fields: tuple[Field, ...]  # those of them that the caller gives
    checks: tuple[str, ...]  # conditions on the parameters
    varied_range: tuple[str, str]  # of the parameter of which a batch may have many

    @property
    def header(self) -> str:
        return f"{self.naming.prefix}.h"

    @property
    def prefix(self) -> str:
        """Of the types and statuses in the header."""
        return self.naming.prefix

    @property
    def symbol(self) -> str:
        """Of the functions: the prefix, and where there are several units the unit."""
        return self.naming.symbol

    @property
    def enclosing(self) -> str:
        """The namespace around everything, or empty."""
        return self.naming.enclosing

    @property
    def upper(self) -> str:
        return self.naming.prefix.upper()

    @property
    def abi(self) -> Functions:
        return self.impact.functions

    @property
    def fixed_step(self) -> bool:
        return self.variant.stepper.family == "fixed"

    @property
    def steps(self) -> int:
        """Of a fixed-step kernel; 0 for others."""
        return self.variant.stepper.steps or 0

    @property
    def places_fma(self) -> bool:
        return self.variant["fma"] == "fma"

    @property
    def varied(self) -> str:
        return self.abi.varied

    @property
    def varied_free(self) -> bool:
        return any(f.name == self.varied for f in self.fields)

    @property
    def varied_made(self) -> bool:
        """Does the kernel itself make the parameter of which a batch may have many?"""
        return self.scene.makes_varied


@dataclass(frozen=True, kw_only=True)
class KernelContext(KernelHead):
    """All that templates/kernel.cpp.j2 may see: typed, strict, decided.

    `body` and `one` are templates of the impact. `body` stands in an unnamed namespace behind
    `Parameters` and `valid(p)`. `one` defines there

        int collide_one(const Parameters& p, const double* BODY..., double* RESULT... [, int steps])

    with the bodies and results of the C ABI, which may be the same arrays, and returns a status.
    Fixed-step kernels define `kSteps`, `kMostSteps` and `keep`, which lets results be as they came.
    Kernels of lanes define `lanes::Batch` and `size_t lanes::collide_all(const Batch&, size_t n)`.
    """

    body: str
    one: str
    batch: bool  # are batches of collisions worked on in lanes?
    keep: str = "keep"  # the function that copies bodies to results
    method: tuple[str, ...]  # sentences of the contract on the stepper
    counts: OperationCounts  # of one iteration (fixed step), one step, or the closed form
    derived_members: tuple[str, ...] = ()  # of Parameters, made from others
    derived_values: tuple[str, ...] = ()  # what makes them, of `p`
    checks_template: str = ""  # defines functions that the checks call
    shown: Mapping[str, object] = field(default_factory=dict)  # to the impact's templates, by name
    contract: tuple[str, ...] = ()


class Kernels(Protocol):
    """What emission asks of an impact: `KERNELS` of its module `kernels`."""

    def context(self, head: KernelHead) -> KernelContext:
        """The whole of a kernel. Raises ValueError or InputError where it cannot be."""
        ...


def kernels_of(impact: Impact) -> Kernels:
    kernels: Kernels = impact.part("kernels").KERNELS
    return kernels
