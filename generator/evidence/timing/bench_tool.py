"""carom_bench from Python: built once for its sources, run as a process of its own.

A candidate kernel may crash or never end; it takes only that process with it.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import re
import shutil
import signal
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from ...errors import KernelCrash, KernelError
from ...files import require_cache, require_temporary
from ...impacts.columns import Columns
from ...impacts.impact import Impact
from ...impacts.registry import DEFAULT, find_impact
from ...places import sources
from ...toolchain.process import require_space, run, run_checked
from .plan import Array, TimingPlan
from .ratios import TimingRun, timing_run

ROOT = sources()
BUILD_TIMEOUT = 600.0  # seconds
RUN_TIMEOUT = 120.0
TIMES = ("batch", "clock", "core_watch", "kernel_library", "timing", "workload")
_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_SUFFIXES = (".h", ".cpp", ".txt")
Method = Literal["exact", "screen", "euler"]


@dataclass(frozen=True)
class CaseSet:
    """Cases in rows and the kind of each."""

    rows: Array
    kinds: tuple[str, ...]


def _reason(code: int, message: str) -> str:
    if code >= 0:
        return message or f"exit status {code}"
    try:
        name = signal.Signals(-code).name
    except ValueError:
        name = f"signal {-code}"
    return f"crashed with {name}"


def _write(path: Path, rows: Array) -> Path:
    np.ascontiguousarray(rows, dtype=np.float64).tofile(path)
    return path


def _read(path: Path, columns: int, rows: int) -> Array:
    values = np.fromfile(path, dtype=np.float64)
    if len(values) != rows * columns:
        raise KernelError(f"carom_bench wrote {len(values)} values, not {rows} rows of {columns}")
    return values.reshape(rows, columns)


@dataclass(frozen=True)
class Way:
    """How a run is not as usual.

    `in_place`: the outcome overwrites the input; `trace`: file for the blocks that ran (of
    toolchain.traces); `environment`: variables for the process that runs the kernel.
    """

    in_place: bool = False
    trace: Path | None = None
    environment: Mapping[str, str] | None = None


USUAL = Way()


@dataclass(frozen=True)
class BenchTool:
    """A carom_bench built for an impact. Every method raises KernelError with the reason.

    KernelCrash where a signal ended it, KernelTimeout where it took too long.
    """

    executable: Path
    impact: Impact
    timing: str  # hash of the sources that its timings depend on

    @property
    def columns(self) -> Columns:
        return self.impact.columns

    def _run(
        self,
        command: str,
        *arguments: object,
        timeout: float = RUN_TIMEOUT,
        environment: Mapping[str, str] | None = None,
    ) -> str:
        """What the command prints."""
        words = [str(self.executable), command, *map(str, arguments)]
        done = run(words, timeout, environment=environment)
        require_space(done, Path(tempfile.gettempdir()))
        if done.code != 0:
            message = done.first_error if done.errors or done.output else ""
            kind = KernelCrash if done.code < 0 else KernelError
            raise kind(f"carom_bench {command}: {_reason(done.code, message)}")
        return done.output

    def make_cases(
        self,
        seed: int,
        count: int,
        mixed: bool = True,
        fixed: Mapping[str, float] | None = None,
    ) -> CaseSet:
        """Random cases: the mixture of real shots and hard kinds, or all kinds in turn.

        `fixed`: parameters that are the same for all; a new R keeps every R w.
        """
        fixes = [f"--fix={key}={value!r}" for key, value in (fixed or {}).items()]
        with tempfile.TemporaryDirectory() as name:
            out, kinds = Path(name, "cases"), Path(name, "kinds")
            choice = "--mixed" if mixed else "--random"
            files = ("--out", out, "--kinds", kinds)
            self._run("cases", choice, "--seed", seed, "--count", count, *files, *fixes)
            rows = _read(out, len(self.columns.case), count)
            return CaseSet(rows, tuple(kinds.read_text("utf-8").split()))

    def expect(
        self,
        cases: Array,
        method: Method,
        model: str,
        steps: int = 1000,
        more: Sequence[str] = (),
        threads: int = 0,
    ) -> Array:
        """What must come out, and whether contact sticks; `steps`: of euler, in long double.

        `screen`: as exact, in double and in a sixth of the time. `more`: what a scene tells the
        oracle besides the cases, as `mass_ratio=2`. `threads`: 0 for one a core.
        """
        with tempfile.TemporaryDirectory() as name:
            files = ("--cases", _write(Path(name, "cases"), cases), "--out", Path(name, "out"))
            options = ["--method", method, "--model", model, "--steps", steps]
            options += [f"--set={text}" for text in more]
            options += [] if threads == 0 else ["--threads", threads]
            self._run("expect", *options, *files, timeout=RUN_TIMEOUT + 0.05 * len(cases))
            return _read(Path(name, "out"), self.columns.expected_width, len(cases))

    def run_kernel(
        self,
        library: Path,
        cases: Array,
        steps: int | None = None,
        batch: bool = False,
        timeout: float = RUN_TIMEOUT,
        way: Way = USUAL,
    ) -> Array:
        """What a kernel makes of the cases: velocities and a status.

        `steps`: instead of its own; `batch`: through its batch function.
        """
        flags = ["--batch"] * batch + ["--in-place"] * way.in_place
        flags += [] if way.trace is None else ["--trace", str(way.trace)]
        options = ["--kernel", library, *([] if steps is None else ["--steps", steps]), *flags]
        with tempfile.TemporaryDirectory() as name:
            files = ("--cases", _write(Path(name, "cases"), cases), "--out", Path(name, "out"))
            self._run("run", *options, *files, timeout=timeout, environment=way.environment)
            return _read(Path(name, "out"), self.columns.outcome_width, len(cases))

    def threads(
        self, library: Path, cases: Array, count: int = 32768, most: int = 0
    ) -> dict[int, float]:
        """ns a collision of a batch shared over 1, 2, ... threads, by their number.

        `most`: threads; 0: one a core. Raises KernelError too where the outcomes differ from those
        of one thread.
        """
        with tempfile.TemporaryDirectory() as name:
            path = _write(Path(name, "cases"), cases)
            words = ("--kernel", library, "--cases", path, "--count", count, "--most", most)
            told = self._run("threads", *words)
        rows = re.findall(r"^(\d+) threads: (\S+) ns", told, re.MULTILINE)
        return {int(threads): float(ns) for threads, ns in rows}

    def time(self, plan: TimingPlan) -> TimingRun:
        """Times the kernels of a plan, which must have passed verification."""
        return timing_run(self.timing_document(plan))

    def timing_document(self, plan: TimingPlan) -> dict[str, Any]:
        """What carom_bench writes when it times a plan."""
        with tempfile.TemporaryDirectory() as name:
            cases = _write(Path(name, "cases"), plan.cases)
            seeds = plan.seed_cases
            seed_path = None if seeds is None else _write(Path(name, "seeds"), seeds)
            file, out = Path(name, "plan.json"), Path(name, "result.json")
            file.write_text(json.dumps(plan.document(cases, seed_path)), encoding="utf-8")
            limit = plan.seconds + RUN_TIMEOUT
            self._run("time", "--plan", file, "--out", out, timeout=limit)
            document: dict[str, Any] = json.loads(out.read_text("utf-8"))
            return document


def _sources(impact: Impact, root: Path) -> list[Path]:
    """Everything that the carom_bench of an impact is built from."""
    bench, own = root / "bench", root / "bench" / "impacts" / impact.folder
    found = [*bench.glob("*"), *own.rglob("*"), *(root / "tests/oracle" / impact.folder).rglob("*")]
    return sorted([root / "CMakeLists.txt", *(p for p in found if p.suffix in _SUFFIXES)])


def source_hash(impact: Impact, root: Path = ROOT) -> str:
    """A hash of everything that the carom_bench of an impact is built from."""
    digest = hashlib.sha256()
    for path in _sources(impact, root):
        digest.update(f"{path.relative_to(root)}\0".encode() + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def timing_hash(impact: Impact, root: Path = ROOT) -> str:
    """A hash of what times: the code around a kernel's calls, without comments and layout.

    Neither oracles nor how cases are made, plans read and results written are in it: what a time
    depends on of these are the cases, which records name by a hash of their own.
    """
    own = root / "bench" / "impacts" / impact.folder / "columns.h"
    files = [p for name in TIMES for p in (root / "bench").glob(f"{name}.*")]
    texts = [plain_code(path.read_text("utf-8")) for path in sorted([own, *files]) if path.exists()]
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:16]


def plain_code(text: str) -> str:
    """C++ without comments and layout."""
    return " ".join(_COMMENT.sub(" ", text).split())


def _place_hash(root: Path) -> str:
    """Of a checkout's path: CMake ties a build folder to one, and a cache may serve several."""
    return hashlib.sha256(os.fsencode(root.resolve())).hexdigest()[:16]


@contextmanager
def _locked(path: Path) -> Iterator[None]:
    with path.open("w", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def _build(root: Path, folder: Path, program: str) -> Path:
    if shutil.which("cmake") is None or shutil.which("ninja") is None:
        raise KernelError(
            "building carom_bench: no cmake or ninja: apt-get install cmake ninja-build"
        )
    options = ("-DCAROM_BUILD_TESTS=OFF", "-DCMAKE_BUILD_TYPE=Release")
    configure = ["cmake", "-S", str(root), "-B", str(folder), "-G", "Ninja", *options]
    log = folder.with_suffix(".failed.log")
    run_checked(configure, BUILD_TIMEOUT, "configuring carom_bench", log)
    build = ["ninja", "-C", str(folder), program]
    run_checked(build, BUILD_TIMEOUT, "building carom_bench", log)
    return folder / "bench" / program


def kept_tool(cache: Path, impact: Impact, root: Path = ROOT) -> Path:
    """Where a cache keeps the carom_bench of an impact for the sources as they are."""
    return cache / f"carom_bench_{impact.folder}-{source_hash(impact, root)}"


def keep_tool(built: Path, kept: Path) -> None:
    """Puts a program where it is kept, whole or not at all."""
    fresh = kept.with_name(f"{kept.name}.{os.getpid()}.tmp")
    shutil.copy2(built, fresh)
    fresh.replace(kept)


def build_bench_tool(cache: Path, root: Path = ROOT, impact: Impact | None = None) -> BenchTool:
    """carom_bench for the sources as they are and an impact, from the cache if it is there.

    Raises KernelError with the first error, InputError where the cache is no place for programs.
    """
    impact = impact or find_impact(DEFAULT)
    require_temporary()
    require_cache(cache)
    kept = kept_tool(cache, impact, root)
    with _locked(cache / "carom_bench.lock"):
        if not kept.exists():
            folder = cache / f"carom_bench-build-{_place_hash(root)}"
            keep_tool(_build(root, folder, f"carom_bench_{impact.folder}"), kept)
    return BenchTool(kept, impact, timing_hash(impact, root))
