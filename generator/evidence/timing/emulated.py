"""Kernels for another architecture, run under qemu-user: whether they are right, not how fast."""

from __future__ import annotations

import hashlib
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import KernelCrash, KernelError
from ...impacts.columns import Columns
from ...impacts.impact import Impact
from ...impacts.registry import DEFAULT, find_impact
from ...places import sources
from ...targets.target import Target
from ...toolchain.compilers import compilers_for, emulator_for
from ...toolchain.process import run, run_checked
from .bench_tool import USUAL, Way, source_hash
from .plan import Array

PROGRAM = "tests/cpp/run_rows.cpp"
WITH = ("bench/run.cpp", "bench/batch.cpp", "bench/case_rows.cpp", "bench/kernel_library.cpp")
BUILD_TIMEOUT = 300.0  # seconds


@dataclass(frozen=True)
class EmulatedRunner:
    """carom_bench's `run` for another architecture, and the emulator before it."""

    program: Path
    emulator: tuple[str, ...]
    columns: Columns

    def run_kernel(
        self,
        library: Path,
        cases: Array,
        steps: int | None = None,
        batch: bool = False,
        timeout: float = 300.0,
        way: Way = USUAL,
    ) -> Array:
        """As BenchTool.run_kernel, of `way` the trace alone. Raises KernelError with the reason."""
        with tempfile.TemporaryDirectory() as name:
            given, out = Path(name, "cases"), Path(name, "out")
            np.ascontiguousarray(cases, dtype=np.float64).tofile(given)
            words = [*self.emulator, str(self.program), str(library), str(given), str(out)]
            words += ["--batch"] * batch
            words += [] if steps is None else ["--steps", str(steps)]
            words += [] if way.trace is None else ["--trace", str(way.trace)]
            done = run(words, timeout)
            if done.code != 0:
                kind = KernelCrash if done.code < 0 else KernelError
                raise kind(f"under {self.emulator[0]}: {done.first_error or done.code}")
            return np.fromfile(out).reshape(len(cases), self.columns.outcome_width)


def emulated_runner(target: Target, cache: Path, impact: Impact | None = None) -> EmulatedRunner:
    """The runner for a target's architecture, built once. KernelError says what is missing."""
    impact = impact or find_impact(DEFAULT)
    arch, emulator = target.row.arch, emulator_for(target)
    gcc = next((c for c in compilers_for(target) if c.code == "gcc"), None)
    if gcc is None or not emulator:
        packages = "g++-aarch64-linux-gnu qemu-user"
        raise KernelError(f"{target.name}: nothing here builds and runs {arch}: install {packages}")
    root = sources()
    own = hashlib.sha256((root / PROGRAM).read_bytes()).hexdigest()[:8]
    program = cache / f"run_rows-{impact.folder}-{arch}-{source_hash(impact)}-{own}"
    if not program.exists():
        cache.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=cache) as folder:
            made = Path(folder, program.name)
            files = [str(root / name) for name in (PROGRAM, *WITH)]
            folders = (root / "bench", root / "bench" / "impacts" / impact.folder)
            include = [f"-I{folder}" for folder in folders]
            options = ["-std=c++17", "-O2", *include, *files, "-ldl", "-o", str(made)]
            log = program.with_name(f"{program.name}.failed.log")
            run_checked([gcc.path, *options], BUILD_TIMEOUT, f"building {PROGRAM} for {arch}", log)
            made.replace(program)
    return EmulatedRunner(program, emulator, impact.columns)
