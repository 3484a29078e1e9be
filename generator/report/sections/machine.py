"""The machine, compilers, flags, seeds and commands; and what is not known."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from typing import Any

from ... import __version__
from ..known import Known
from ..layout import (
    Block,
    Cell,
    Code,
    Details,
    Heading,
    Lines,
    Number,
    Paragraph,
    Section,
    Table,
    interval,
)

_DATA = (
    "All of the page's numbers are in it as JSON too, in the element #data, and in the file "
    "beside it."
)


def section(known: Known) -> Section:
    machine = _machine(known)
    rows = _rows(machine)
    if trials := known.stored.trials:
        times = sorted(trial.made_at for trial in trials)
        rows.append([["swept"], [f"{times[0]} to {times[-1]}"]])
    blocks: list[Block] = [
        Table((), rows),
        Heading(["To repeat it"]),
        Lines(known.commands),
    ]
    if flags := machine["flags"]:
        table = Table(["kernel for", "flags"], [[[r], [Code(f)]] for r, f in flags.items()])
        blocks.append(Details("Flags of the measured kernels", [table]))
    if known.untold:
        blocks += [
            Heading(["What is not known, and why"]),
            Table((), [[[what], [reason]] for what, reason in known.untold.items()]),
        ]
    blocks.append(Paragraph([_DATA], "soft"))
    title = "Machine, compilers, flags, seeds, commands"
    data = {"machine": machine, "commands": known.commands}
    return Section("machine", "Machine", title, data, blocks, known.untold)


def _machine(known: Known) -> dict[str, Any]:
    findings, runs = known.findings, known.stored.runs
    seeds = dict(findings.seeds) if findings else {}
    return {
        "cpu": known.cpu,
        "target": known.target,
        "system": runs[-1].system if runs else f"{platform.system()} {platform.release()}",
        "compilers": known.compilers,
        "flags": dict(findings.flags) if findings else {},
        "seeds": seeds | ({"sweep": runs[-1].seed} if runs else {}),
        "tsc_ghz": findings.tsc_ghz if findings else None,
        # ratios that paper-initial has to itself
        "control": findings.control if findings else None,
        "version": __version__,
        "measured_at": findings.made_at if findings else None,
    }


def _rows(machine: dict[str, Any]) -> list[Sequence[Cell]]:
    rows: list[Sequence[Cell]] = [
        [["CPU"], [f"{machine['cpu']}, target {machine['target']}"]],
        [["system"], [machine["system"]]],
        [["carom"], [machine["version"]]],
    ]
    rows += [[[code], [version]] for code, version in machine["compilers"].items()]
    rows += [
        [[f"seed, {name}"], [Number("count", ("machine", "seeds", name))]]
        for name in machine["seeds"]
    ]
    if machine["tsc_ghz"]:
        clock = Number("times", ("machine", "tsc_ghz"))
        rows.append([["time stamp counter"], [clock, " GHz"]])
    if machine["control"]:
        band = interval(("machine", "control"))
        rows.append([["A/A control"], [*band, ": ratios that paper-initial has to itself"]])
    rows.append([["measured"], [machine["measured_at"] or "not yet"]])
    return rows
