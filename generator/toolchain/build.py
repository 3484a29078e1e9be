"""Sources to a shared library, kept under the hash of everything that shapes it."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from ..errors import KernelError
from .compilers import Compiler
from .flags import LINK_FLAGS
from .process import require_space, run

TIMEOUT = 120.0  # seconds for one source file
_FIXED = ("-fPIC", "-fvisibility=default")
_SOURCES = (".cpp", ".cc", ".cxx", ".s")
_HEADERS = (".h", ".hpp", ".inc")


@dataclass(frozen=True)
class BuiltLibrary:
    """A library in the cache."""

    path: Path
    key: str
    seconds: float  # what compiling took when it was done
    log: Path
    hit: bool  # taken from the cache, no compiler was run


@dataclass(frozen=True)
class BuildJob:
    """One library to be made. `label` names it in messages; it is no part of the key."""

    label: str
    sources: Mapping[str, str]  # file name -> text; .cpp and .s are compiled, others included
    compiler: Compiler
    flags: tuple[str, ...]
    include_dirs: tuple[Path, ...] = ()


def _headers(folder: Path) -> list[Path]:
    return sorted(p for p in folder.rglob("*") if p.suffix in _HEADERS and p.is_file())


def cache_key(job: BuildJob) -> str:
    """The hash of texts, headers, compiler and flags; places of folders are not part of it."""
    headers = [
        [str(path.relative_to(folder)), path.read_text("utf-8")]
        for folder in job.include_dirs
        for path in _headers(folder)
    ]
    compiler = [job.compiler.path, job.compiler.version]
    parts = [sorted(job.sources.items()), headers, compiler, _FIXED, job.flags, LINK_FLAGS]
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()[:32]


def _cached(folder: Path, key: str) -> BuiltLibrary | None:
    library, log = folder / "kernel.so", folder / "build.log"
    try:
        seconds = float(json.loads((folder / "build.json").read_text("utf-8"))["seconds"])
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return BuiltLibrary(library, key, seconds, log, hit=True) if library.is_file() else None


def _run_logged(command: Sequence[str], folder: Path, log: list[str]) -> str | None:
    """Run a step; the reason where it failed."""
    log.append("$ " + " ".join(command))
    try:
        done = run(command, TIMEOUT, cwd=folder)
    except KernelError as error:
        log.append(str(error))
        return str(error)
    log.append(done.log)
    require_space(done, folder.parent.parent)
    return None if done.code == 0 else done.first_error


def _compile(job: BuildJob, folder: Path, log: list[str]) -> str | None:
    for name, text in job.sources.items():
        place = folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text, encoding="utf-8")
    includes = [f"-I{path.resolve()}" for path in job.include_dirs]
    units = [name for name in job.sources if name.endswith(_SOURCES)]
    if not units:
        return f"no source to compile among {', '.join(job.sources) or 'no files'}"
    for number, name in enumerate(units):
        flags = [*_FIXED, *job.flags, "-I.", *includes, "-c", name, "-o", f"{number}.o"]
        if (reason := _run_logged([job.compiler.path, *flags], folder, log)) is not None:
            return reason
    objects = [f"{number}.o" for number in range(len(units))]
    triple = [flag for flag in job.flags if flag.startswith("--target=")]
    link = [job.compiler.path, *triple, *LINK_FLAGS, *objects, "-o", "kernel.so"]
    return _run_logged(link, folder, log)


def _publish(folder: Path, final: Path) -> None:
    """Move a finished folder to its place; whoever came first with the same key stays."""
    for stray in folder.glob("*.o"):
        stray.unlink()
    try:
        folder.rename(final)
    except OSError:
        if _cached(final, final.name) is not None:
            return
        shutil.rmtree(final, ignore_errors=True)  # damaged: not complete, so never loaded
        folder.rename(final)


def build(job: BuildJob, cache: Path) -> BuiltLibrary:
    """The library of a job, from the cache or made now.

    Raises KernelError with the first error line and the place of the log.
    """
    key = cache_key(job)
    final = cache / key
    if (known := _cached(final, key)) is not None:
        return known
    cache.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".build-", dir=cache) as scratch:
        folder = Path(scratch) / key
        folder.mkdir()
        log: list[str] = []
        start = time.monotonic()
        reason = _compile(job, folder, log)
        seconds = time.monotonic() - start
        text = "\n".join(log) + "\n"
        if reason is not None:
            failed = cache / f"{key}.failed.log"
            failed.write_text(text, encoding="utf-8")
            raise KernelError(f"{job.label} ({job.compiler.code}): {reason} (log: {failed})")
        (folder / "build.log").write_text(text, encoding="utf-8")
        (folder / "build.json").write_text(json.dumps({"seconds": round(seconds, 3)}) + "\n")
        _publish(folder, final)
    return BuiltLibrary(final / "kernel.so", key, seconds, final / "build.log", hit=False)


def build_library(
    sources: Mapping[str, str],
    include_dirs: Iterable[Path],
    compiler: Compiler,
    flags: Iterable[str],
    cache: Path,
    label: str = "kernel",
) -> BuiltLibrary:
    """One library from file names and texts; see `build`."""
    return build(BuildJob(label, sources, compiler, tuple(flags), tuple(include_dirs)), cache)


def build_many(
    jobs: Sequence[BuildJob],
    cache: Path,
    workers: int | None = None,
    on_done: Callable[[BuildJob, BuiltLibrary | KernelError], None] | None = None,
) -> list[BuiltLibrary | KernelError]:
    """All jobs, side by side, in their order; a failure is a result and stops nothing.

    `on_done` is called in the caller's thread. An interruption drops what has not begun.
    """
    results: dict[int, BuiltLibrary | KernelError] = {}
    pool = ThreadPoolExecutor(workers or os.cpu_count() or 1)
    try:
        futures = {pool.submit(build, job, cache): n for n, job in enumerate(jobs)}
        for future in as_completed(futures):
            number = futures[future]
            error = future.exception()
            if error is not None and not isinstance(error, KernelError):
                raise error
            results[number] = error if error is not None else future.result()
            if on_done is not None:
                on_done(jobs[number], results[number])
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
    return [results[n] for n in range(len(jobs))]
