"""The stages of a kernel: emitted, built, verified, timed or estimated; or rejected, and why.

Each stage is what the one before it is, and knows more. Nothing is unknown "until later".
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Literal

from ..emission.kernel_source import KernelSource
from ..evidence.records.code import digest, source_hash
from ..evidence.records.evidence import Found
from ..evidence.timing.ratios import TimingResult
from ..evidence.verification.verdict import Verdict
from ..registry.names import name_of
from ..registry.variant import Variant
from ..toolchain.build import BuildJob, BuiltLibrary
from ..toolchain.compilers import Compiler
from ..toolchain.mca import with_regions
from ..toolchain.replay import Modelled

# Why a kernel ended; the first five stand in stores.
Reason = Literal[
    "compile", "timeout", "crash", "wrong result", "constraint", "model", "search", "reproducible"
]


@dataclass(frozen=True)
class Code:
    """What the compiler is given: hash of the text without its name, version and flags."""

    source: str
    compiler: str
    flags: tuple[str, ...]

    @property
    def hash(self) -> str:
        """One hash for all of it."""
        return digest([self.source, [self.compiler, *self.flags]])


@dataclass(frozen=True, kw_only=True)
class Emitted:
    """A variant with its text, and how that is compiled."""

    variant: Variant
    source: KernelSource
    compiler: Compiler
    flags: tuple[str, ...]
    march_note: str = ""

    @property
    def name(self) -> str:
        return name_of(self.variant)

    @property
    def is_batch(self) -> bool:
        """Lanes are filled from a batch; what has one lane is called for one collision."""
        return self.variant.width > 1

    @property
    def sources(self) -> dict[str, str]:
        return self.source.files

    @property
    def with_regions(self) -> dict[str, str]:
        """The kernel alone, with the regions that llvm-mca knows."""
        return {"carom.h": self.source.header, "kernel.cpp": with_regions(self.source.marked)}

    @property
    def build_job(self) -> BuildJob:
        return BuildJob(self.name, self.sources, self.compiler, self.flags)

    @property
    def emitted(self) -> Emitted:
        """As `Rejected` has it."""
        return self

    @property
    def code(self) -> Code:
        return Code(source_hash(self.source), self.compiler.version, self.flags)

    def built(self, library: BuiltLibrary) -> Built:
        return Built(**_known(self, Emitted), library=library)


@dataclass(frozen=True, kw_only=True)
class Built(Emitted):
    """With its library."""

    library: BuiltLibrary

    def verified(self, verdict: Verdict, pooltool: Verdict | None = None) -> Verified:
        return Verified(**_known(self, Built), verdict=verdict, pooltool=pooltool)


@dataclass(frozen=True, kw_only=True)
class Verified(Built):
    """With its verdict: that it passed, unless it is the kernel of a `Rejected`."""

    verdict: Verdict
    pooltool: Verdict | None  # against pooltool's own doubles, where they exist

    def timed(self, timing: TimingResult) -> Timed:
        return Timed(**_known(self, Verified), timing=timing)

    def estimated(self, record: Found | None, model: Modelled | None) -> Estimated:
        return Estimated(**_known(self, Verified), record=record, model=model)


@dataclass(frozen=True, kw_only=True)
class Timed(Verified):
    """With its time on the target's CPU, which is this one."""

    timing: TimingResult


@dataclass(frozen=True, kw_only=True)
class Estimated(Verified):
    """With what is known of its time where the target's CPU is not here."""

    record: Found | None  # None: no such CPU has timed it
    model: Modelled | None  # None: nobody asked, or llvm-mca could not


@dataclass(frozen=True)
class Rejected:
    """A kernel that ended, as far as it came; `text` is one line that says why."""

    emitted: Emitted
    reason: Reason
    text: str

    @property
    def variant(self) -> Variant:
        return self.emitted.variant

    @property
    def name(self) -> str:
        return self.emitted.name

    @property
    def is_batch(self) -> bool:
        return self.emitted.is_batch


def verdict_of(kernel: Emitted | Rejected) -> Verdict | None:
    """The verdict on a kernel that came so far, passed or not."""
    return kernel.emitted.verdict if isinstance(kernel.emitted, Verified) else None


def _known(kernel: Emitted, stage: type[Emitted]) -> dict[str, Any]:
    return {field.name: getattr(kernel, field.name) for field in fields(stage)}
