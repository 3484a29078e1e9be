"""The machine, compilers, flags and seeds, as they were measured or swept; else this one's."""

from __future__ import annotations

import platform
from typing import Any

from ... import __version__
from ..known import Known


def data(known: Known) -> dict[str, Any]:
    findings, runs = known.findings, known.stored.runs
    compilers = findings.compilers if findings else runs[-1].compilers if runs else {}
    seeds = dict(findings.seeds) if findings else {}
    return {
        "cpu": known.cpu,
        "target": known.target,
        "system": runs[-1].system if runs else f"{platform.system()} {platform.release()}",
        "compilers": compilers,
        "flags": findings.flags if findings else {},
        "seeds": seeds | ({"sweep": runs[-1].seed} if runs else {}),
        "tsc_ghz": findings.tsc_ghz if findings else None,
        "control": findings.control if findings else None,  # that paper-initial has to itself
        "version": __version__,
        "measured_at": findings.made_at if findings else None,
    }
