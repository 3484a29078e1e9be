"""A target CPU: instruction sets, compiler flags, llvm-mca's name for it."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib import resources

from pydantic import BaseModel, ConfigDict, ValidationError

from ..errors import InputError

# Relative, of the instructions that estimate a reciprocal square root: AVX-512's, SSE's, NEON's.
RSQRT14_ERROR, RSQRTSS_ERROR, FRSQRTE_ERROR = 2.0**-14, 1.5 * 2.0**-12, 2.0**-8


class TargetRow(BaseModel):
    """One table of targets.toml, as written."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    text: str
    arch: str
    parent: str | None = None
    adds: tuple[str, ...] | list[str] = ()
    march: str
    march_gcc_fallback: str | None = None
    mca_cpu: str
    decoded: int = 0  # instructions that its cache of decoded ones holds; 0: that is not modelled
    vector_bits: int
    vector_registers: int


class Target(BaseModel):
    """A target with everything that it inherits."""

    model_config = ConfigDict(frozen=True)

    name: str
    row: TargetRow
    features: frozenset[str]
    ancestors: tuple[str, ...]

    def has(self, feature: str) -> bool:
        return feature in self.features

    @property
    def generic(self) -> bool:
        """Is it a level of instruction sets instead of one CPU?"""
        return self.name.startswith("x86-64-v") or self.parent_of_an_arch

    @property
    def parent_of_an_arch(self) -> bool:
        """Is it what every CPU of its architecture has?"""
        return not self.ancestors

    @property
    def has_rsqrt_estimate(self) -> bool:
        return self.has("sse2") or self.has("neon")

    def rsqrt_error(self, one_float: bool = False) -> float:
        """Relative, of the instruction that estimates a reciprocal square root; 0 without one.

        `one_float`: of a single float, which kernels leave to SSE with AVX-512 too.
        """
        if self.has("avx512f") and not one_float:
            return RSQRT14_ERROR
        if self.has("sse2"):
            return RSQRTSS_ERROR
        return FRSQRTE_ERROR if self.has("neon") else 0.0


def load_rows(text: str, source: str) -> dict[str, TargetRow]:
    """Parse a targets file. Raises InputError that names the file and the key."""
    try:
        return {name: TargetRow(**table) for name, table in tomllib.loads(text).items()}
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{source}: not valid TOML: {error}") from None
    except (ValidationError, TypeError) as error:
        first = error.errors()[0] if isinstance(error, ValidationError) else {"msg": str(error)}
        where = ".".join(str(part) for part in first.get("loc", ()))
        raise InputError(f"{source}: key {where}: {first['msg']}") from None


def _inherit(name: str, rows: dict[str, TargetRow]) -> Target:
    chain = [name]
    while (parent := rows[chain[-1]].parent) is not None:
        if parent not in rows or parent in chain:
            raise InputError(f"targets.toml: {chain[-1]}.parent: no target '{parent}' above it")
        chain.append(parent)
    features = frozenset(feature for link in chain for feature in rows[link].adds)
    return Target(name=name, row=rows[name], features=features, ancestors=tuple(chain[1:]))


def _shipped(name: str) -> dict[str, Target]:
    source = resources.files(__package__) / name
    rows = load_rows(source.read_text(encoding="utf-8"), f"generator/targets/{name}")
    return {name: _inherit(name, rows) for name in rows}


@cache
def targets() -> dict[str, Target]:
    """All targets by name, in the order of the file."""
    return _shipped("targets.toml")


@cache
def ports() -> dict[str, Target]:
    """What only a client makes kernels for, as wasm32: no command knows it."""
    return _shipped("ports.toml")


def find_target(name: str) -> Target:
    """A target by its name. Raises InputError naming the targets there are."""
    known = targets()
    if name not in known:
        raise InputError(f"--target {name}: no such target; there are native, {', '.join(known)}")
    return known[name]


def target_or_port(name: str) -> Target:
    """As find_target, and ports: whatever a kernel can be emitted for."""
    return ports().get(name) or find_target(name)
