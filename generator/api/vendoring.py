"""Kernels as a folder that builds alone in another project."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from ..evidence.timing.bench_tool import BenchTool
from ..registry.question import DEFAULT_IMPACT, Goal, find_impact
from ..targets.host import read_host
from ..targets.target import find_target
from ..vendoring.folder import require_replaceable, staged, write_files
from ..vendoring.job import Comparison, all_files, compare
from ..vendoring.kernels import Chosen, Places, TargetKernels, kernels_for, stored_kernels
from ..vendoring.manifest import read_manifest
from ..vendoring.request import VendorRequest, checked, checked_targets
from .session import Session, resolve_target


@dataclass(frozen=True)
class VendorOptions:
    """What to vendor, by name.

    `targets`: CPUs; several get a dispatcher. `scene`, `model`, `steps`, `max_error`: as in
    `Request`. `prefix`: what all names begin with. `single_header`: all in one header.
    `reproducible`: the same bits on every CPU. `force`: replace a folder that was edited by hand.
    `seconds`: for timing, where no choice is stored yet. `impact`: what collides, or several with
    commas; `model` is then one name that all have, or as many.
    """

    targets: tuple[str, ...]
    scene: str = "any"
    model: str | None = None
    steps: int | None = None
    max_error: float | None = None
    prefix: str = "carom"
    single_header: bool = False
    reproducible: bool = False
    force: bool = False
    seconds: float = 10.0
    impact: str = DEFAULT_IMPACT

    def checked(self) -> VendorRequest:
        """What the names stand for. Raises InputError naming the one that cannot be."""
        native = resolve_target("native")[0].name if "native" in self.targets else ""
        return checked(
            VendorRequest(
                checked_targets(",".join(self.targets), native),
                self.scene,
                self.model or "",
                Goal(self.steps, self.max_error),
                self.prefix,
                self.single_header,
                self.reproducible,
                self.impact,
            )
        )


@dataclass(frozen=True)
class Vendored:
    """The kernels that a folder holds, by impact and target, and how many files were written."""

    kernels: Chosen
    files: int


def vendor(options: VendorOptions, out: Path, session: Session | None = None) -> Vendored:
    """Write chosen kernels as a folder that builds alone.

    Raises InputError where the options cannot be or the folder may not be replaced, KernelError
    where no kernel passes verification.
    """
    session, request = session or Session(), options.checked()
    require_replaceable(out, edited_too=options.force)
    chosen = {
        part.impact: {t: _kernels(part, t, options.seconds, session) for t in part.targets}
        for part in request.parts
    }
    with _tools(request.impact, session) as tools:
        files = all_files(request, chosen, tools)
    with staged(out) as folder:
        write_files(folder, files)
    return Vendored(chosen, len(files))


def verify_vendored(folder: Path, session: Session | None = None) -> Comparison:
    """Is a vendored folder as it was written, and what vendoring it today would give?

    Raises InputError where it is no vendored folder.
    """
    session = session or Session()
    with _tools(read_manifest(folder).options.impact, session) as tools:
        return compare(folder, _places(session), tools)


@contextmanager
def _tools(impacts: str, session: Session) -> Iterator[dict[str, BenchTool]]:
    """What makes and answers cases of each impact."""
    with ExitStack() as benches:
        yield {
            name: benches.enter_context(session.workbench(impact=find_impact(name))).tool
            for name in impacts.split(",")
        }


def _places(session: Session) -> Places:
    return Places(session.generated, session.cache / "selections")


def _kernels(
    request: VendorRequest, target: str, seconds: float, session: Session
) -> TargetKernels:
    """The stored choice, else one made now, by the compilers of the target's architecture."""
    places = _places(session)
    if (stored := stored_kernels(places, request, target)) is not None:
        return stored
    row, own = find_target(target), request.reproducible
    with session.workbench(target=row, reproducible=own, impact=request.row) as bench:
        return kernels_for(places, request, target, bench, read_host(), seconds)
