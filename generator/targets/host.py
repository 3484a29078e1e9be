"""Which CPU this machine is, read from /proc/cpuinfo."""

from __future__ import annotations

import platform
from dataclasses import dataclass
from pathlib import Path

from .target import Target, find_target, targets

CPUINFO = Path("/proc/cpuinfo")
# Spellings of /proc/cpuinfo that differ from the compilers'.
_SPELLINGS = {
    "sse4_1": "sse4.1",
    "sse4_2": "sse4.2",
    "pni": "sse3",
    "bmi1": "bmi",
    "abm": "lzcnt",
    "asimd": "neon",
}


@dataclass(frozen=True)
class KnownCpu:
    """CPUs that are known by what cpuid calls them; /proc/cpuinfo shows the same numbers."""

    vendor: str
    family: int
    model: int | None  # None: any
    has: str  # an instruction set that tells it from the next row, or empty
    target: str
    models: tuple[range, ...] = ()  # of the family, those that are it beyond doubt; none: all


_ZEN4 = (range(0x10, 0x20), range(0x60, 0x80), range(0xA0, 0xB0))
# The first row that fits holds.
KNOWN_CPUS = (
    KnownCpu("AuthenticAMD", 23, None, "", "zen2", (range(0x30, 0x100),)),
    KnownCpu("AuthenticAMD", 25, None, "avx512f", "zen4", _ZEN4),
    KnownCpu("AuthenticAMD", 25, None, "", "zen3", (range(0x10), range(0x20, 0x60))),
    KnownCpu("AuthenticAMD", 26, None, "", "zen5"),
    KnownCpu("GenuineIntel", 6, 85, "", "skylake-avx512"),
    KnownCpu("GenuineIntel", 6, 143, "", "sapphirerapids"),
    KnownCpu("GenuineIntel", 6, 207, "", "sapphirerapids"),
)


@dataclass(frozen=True)
class Host:
    """This machine's CPU."""

    cpu: str
    features: frozenset[str]
    target: Target
    exact: bool  # is the target this CPU, or only its nearest ancestor?
    vendor: str = ""
    family: int = 0  # as cpuid counts; 0 where there is none
    model: int = 0

    @property
    def cpuid(self) -> tuple[str, int, int]:
        return self.vendor, self.family, self.model

    def is_a(self, target: Target) -> bool:
        """Is this machine's CPU the one that the target names? Only then its times are its own."""
        return self.exact and self.target.name == target.name

    def runs(self, target: Target) -> bool:
        return target.row.arch == platform.machine() and target.features <= self.features


def _fields(text: str) -> dict[str, str]:
    first = text.split("\n\n")[0]
    pairs = (line.split(":", 1) for line in first.splitlines() if ":" in line)
    return {key.strip(): value.strip() for key, value in pairs}


def _cpuid(fields: dict[str, str]) -> tuple[str, int, int]:
    family, model = (int(fields.get(key, 0)) for key in ("cpu family", "model"))
    return fields.get("vendor_id", ""), family, model


def _known(fields: dict[str, str]) -> KnownCpu | None:
    (vendor, family, model), flags = _cpuid(fields), fields.get("flags", "").split()
    for cpu in KNOWN_CPUS:
        same = (cpu.vendor, cpu.family) == (vendor, family) and cpu.model in (None, model)
        if same and (not cpu.has or cpu.has in flags):
            return cpu
    return None


def read_host(cpuinfo: str | None = None) -> Host:
    """This machine as a target; an unknown CPU becomes its nearest ancestor."""
    text = cpuinfo if cpuinfo is not None else CPUINFO.read_text(encoding="utf-8")
    fields = _fields(text)
    flags = fields.get("flags", fields.get("Features", "")).split()
    features = frozenset(_SPELLINGS.get(flag, flag) for flag in flags)
    if "neon" in features:
        features |= {"fma"}  # part of AArch64's NEON, without a flag of its own
    cpu = fields.get("model name", platform.machine())
    row, cpuid = _known(fields), _cpuid(fields)
    doubtful = row is not None and row.models and not any(cpuid[2] in r for r in row.models)
    if row is not None and not doubtful and targets()[row.target].features <= features:
        return Host(cpu, features, find_target(row.target), True, *cpuid)
    arch = platform.machine()
    fits = [t for t in targets().values() if t.row.arch == arch and t.features <= features]
    generic = [t for t in fits if t.generic] or fits
    best = max(generic, key=lambda t: len(t.features), default=None)
    if best is None:
        from ..errors import InputError

        raise InputError(f"--target native: {cpu} has no target here; name one with --target")
    return Host(cpu, features, best, False, *cpuid)
