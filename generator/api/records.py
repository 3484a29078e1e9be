"""Records of timings: in the stores of sweeps, and as text by CPU."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ..choice.job import STEPS
from ..errors import InputError
from ..evidence.records.files import read_records, timings_path, union, write_records
from ..files import require_place
from ..impacts.registry import DEFAULT, find_impact
from ..steppers.budgets import plan_for
from ..sweep.explore import Observer
from ..sweep.lab import Lab
from ..sweep.ledger import Ledger, new_run
from ..sweep.refresh import add_exported, contests_of
from ..sweep.refresh import refresh as refresh_plan
from ..sweep.store import default_store, opened, read_only
from ..sweep.store import merge as merge_stores
from ..sweep.sweep import Outcome, Plan
from ..targets.host import Host
from ..targets.target import Target, find_target
from .session import Session, resolve_target
from .sweeping import note_too_short

SCENE, SEED, FILE = "any", 1, "refresh.sqlite"


def merge(stores: Sequence[Path], out: Path, session: Session | None = None) -> dict[Path, int]:
    """Put records, each once, into one store, new or there already: how many each one added.

    `stores`: all of sweeps (SQLite), or all files of timings (.jsonl). A damaged line of a file is
    noted and left out. Raises InputError where they cannot be read or `out` cannot be written.
    """
    if out.resolve() in [path.resolve() for path in stores]:
        raise InputError(f"--out {out}: is one of the stores that are read; name another")
    if not out.parent.is_dir():
        raise InputError(f"--out {out}: there is no folder {out.parent}; make it first")
    texts = {path.suffix == ".jsonl" for path in (*stores, out)}
    if len(texts) > 1:
        raise InputError(f"--out {out}: stores and files of timings (.jsonl) do not mix")
    if texts == {False}:
        return merge_stores(stores, out)
    note = (session or Session()).listener.note
    return _merged_files(stores, out, note)


def _merged_files(files: Sequence[Path], out: Path, note: Callable[[str], None]) -> dict[Path, int]:
    found = {path: read_records(path) for path in files}
    known = read_records(out).records if out.exists() else ()
    for file in found.values():
        for line in file.damaged:
            note(line)
    added = {}
    for path, file in found.items():
        after = union(known, file.records)
        added[path], known = len(after) - len(union(known)), after
    write_records(out, known)
    return added


def export(
    cpu: str = "native",
    store: Path | None = None,
    out: Path | None = None,
    session: Session | None = None,
) -> str:
    """Add what a sweep's store has timed on a CPU to its file of records; in words, how many.

    `store`: None: that in the cache. `out`: None: `timings/CPU.jsonl`. Raises InputError where one
    of them cannot be read or written.
    """
    session = session or Session()
    target = resolve_target(cpu)[0].name
    place = out or timings_path(session.root, target)
    if out is not None:
        require_place(out)
    with read_only(store or default_store(session.cache)) as found:
        return add_exported(found, target, place, session.listener.note)


def import_records(file: Path, session: Session | None = None) -> dict[Path, tuple[int, int]]:
    """Add the records of a file to `timings/`, each to the file of its CPU: new ones, of how many.

    Damaged lines are noted. Raises InputError where a CPU is no target.
    """
    session = session or Session()
    found = read_records(file)
    for line in found.damaged:
        session.listener.note(line)
    cpus = sorted({record.cpu.target for record in found.records})
    for cpu in cpus:
        find_target(cpu)
    added = {}
    for cpu in cpus:
        path = timings_path(session.root, cpu)
        there = read_records(path).records if path.exists() else ()
        own = [record for record in found.records if record.cpu.target == cpu]
        after = write_records(path, (*there, *own))
        added[path] = after - len(there), len(own)
    return added


@dataclass(frozen=True)
class RefreshRequest:
    """Which contests of this machine's CPU to time, and where the records go.

    `cpu`: must be this machine's. `minutes`: for all. `budgets`: the error budgets. `models`: none:
    all contact models. `store`: keeps each timing at once; None: in the cache. `out`: None:
    `timings/CPU.jsonl`. `command`: what the records name as having made them.
    """

    cpu: str = "native"
    minutes: float = 30.0
    budgets: tuple[float, ...] = (1e-6,)
    models: tuple[str, ...] = ()
    store: Path | None = None
    out: Path | None = None
    command: str = "generator.api.refresh"


def refresh(
    asked: RefreshRequest,
    observe: Observer = lambda progress: None,
    say: Callable[[str], None] = lambda line: None,
    session: Session | None = None,
) -> tuple[Outcome, ...]:
    """Time the contests of this machine's CPU and add the records to its file.

    Stopped at any moment, nothing that was timed is lost, and the same request goes on from there.
    `say` is told of each model's records. Raises InputError where the CPU is another.
    """
    session = session or Session()
    target, host = resolve_target(asked.cpu)
    if not host.is_a(target):
        raise InputError(
            f"--cpu {asked.cpu}: this machine is {host.cpu} ({_near(host)}), and a time taken on "
            "another CPU is never the target's; run it on such a machine"
        )
    impact = find_impact(DEFAULT)
    every = [model.name for model in impact.model_table()]
    names = [impact.find_model(name).name for name in asked.models] or every
    for budget in asked.budgets:
        plan_for(budget)
    if asked.out is not None:
        require_place(asked.out)
    plan = _plan(target, asked, session)
    note_too_short(plan, session, len(names))

    place = asked.out or timings_path(session.root, target.name)
    with (
        opened(asked.store or session.cache / FILE) as store,
        session.without_steps().workbench() as bench,
    ):
        lab = Lab(bench, target)
        run = new_run(asked.command, SEED, lab.cpu, target.name, lab.compilers, host.cpuid)

        def after(model: str) -> None:
            say(f"{model}: {add_exported(store, target.name, place, say)}")

        plan = replace(plan, compilers=tuple(lab.compilers))
        return tuple(refresh_plan(plan, names, lab, Ledger(store, run), observe, after))


def _near(host: Host) -> str:
    return host.target.name if host.exact else f"no named CPU; it runs {host.target.name}"


def _plan(target: Target, asked: RefreshRequest, session: Session) -> Plan:
    contests = contests_of(target.name, SCENE, STEPS, asked.budgets)
    return Plan(target, contests, seed=SEED, minutes=asked.minutes, timings=session.timings())
