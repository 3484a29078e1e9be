"""carom as functions: what the command line does, for Python users and tests.

Each function takes names and numbers, or a frozen request with them, and last a `Session` (where
files lie, who is told of progress). InputError and KernelError (`carom_gen.errors`) say in one line
what cannot be, and what failed. A function's module is loaded when it is first used.
"""

# mypy: implicit-reexport
# ruff: noqa: F401
from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .benching import Benched, bench
    from .case_files import CaseTable, outcome_text, read_cases
    from .challenging import Challenged, ChallengeRequest, challenge, keep
    from .cluster import work
    from .collisions import Collided, collide
    from .freshness import check, update
    from .generation import Generated, GenerateRequest, generate
    from .listing import impacts, models, scenes, targets, variants
    from .records import RefreshRequest, export, import_records, merge, refresh
    from .reporting import (
        Reported,
        ReportRequest,
        measure_plot,
        model_gaps,
        plot_models,
        plot_text,
        read_plot,
        report,
        scene_costs,
    )
    from .request import Request
    from .session import Listener, Session, Silent
    from .sweeping import SweepRequest, Swept, sweep, verify_choices
    from .texts import Explanation, emit, explain, header
    from .vendoring import Vendored, VendorOptions, vendor, verify_vendored

_HOMES = {
    "benching": ("Benched", "bench"),
    "case_files": ("CaseTable", "outcome_text", "read_cases"),
    "challenging": ("Challenged", "ChallengeRequest", "challenge", "keep"),
    "cluster": ("work",),
    "collisions": ("Collided", "collide"),
    "freshness": ("check", "update"),
    "generation": ("Generated", "GenerateRequest", "generate"),
    "listing": ("impacts", "models", "scenes", "targets", "variants"),
    "records": ("RefreshRequest", "export", "import_records", "merge", "refresh"),
    "reporting": (
        *("Reported", "ReportRequest", "measure_plot", "model_gaps", "plot_models", "plot_text"),
        *("read_plot", "report", "scene_costs"),
    ),
    "request": ("Request",),
    "session": ("Listener", "Session", "Silent"),
    "sweeping": ("Swept", "SweepRequest", "sweep", "verify_choices"),
    "texts": ("Explanation", "emit", "explain", "header"),
    "vendoring": ("VendorOptions", "Vendored", "vendor", "verify_vendored"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> object:
    """A name of the API, from its module. Raises AttributeError where there is none such."""
    if name not in _HOME_OF:
        raise AttributeError(f"{__name__} has no '{name}'; it has {', '.join(sorted(_HOME_OF))}")
    return getattr(import_module(f".{_HOME_OF[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted(_HOME_OF)
