"""The tables of gen list: targets, scenes, variants, contact models."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from ..impacts.ball_ball.models import MODELS
from ..impacts.ball_ball.scene import scenes
from ..registry.axes import AXES
from ..registry.lanes import INSTRUCTION_SETS, Precision
from ..registry.presets import PRESETS
from ..registry.rules import RULES
from ..targets.host import read_host
from ..targets.target import Target, targets
from ..toolchain.compilers import compilers_for, emulator_for


def show_tables(what: str) -> None:
    """Print what there is of targets, scenes, variants or models."""
    tables = {"targets": _targets, "scenes": _scenes, "variants": _variants, "models": _models}
    console = Console()
    for table in tables[what]():
        console.print(table)


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left", show_edge=False)
    for column in columns:
        table.add_column(column)
    return table


def _targets() -> list[Table]:
    host = read_host()
    columns = ("name", "what", "vector bits", "registers", "llvm-mca", "tested here")
    table = _table("targets", *columns)
    for target in targets().values():
        bits = str(target.row.vector_bits)
        tested = how_tested(target, host.target.name, host.runs(target))
        registers, mca = str(target.row.vector_registers), target.row.mca_cpu
        table.add_row(target.name, target.row.text, bits, registers, mca, tested)
    if not host.exact:
        table.caption = (
            f"{host.cpu} is not known: native is its nearest ancestor, {host.target.name}"
        )
    return [table]


def how_tested(target: Target, host: str, runs: bool) -> str:
    """How kernels for a target can be tested on this machine."""
    if target.name == host:
        return "timed"
    if runs:
        return "run"
    if not compilers_for(target):
        return "not compiled"
    return "run under emulation" if emulator_for(target) else "compiled only"


def _scenes() -> list[Table]:
    table = _table("scenes", "name", "what", "fixed", "model", "max error")
    for scene in scenes().values():
        fixed = ", ".join(f"{k} = {v:g}" for k, v in scene.fixed.items()) or "-"
        table.add_row(scene.name, scene.text, fixed, scene.model, f"{scene.max_error:g}")
    return [table]


def _models() -> list[Table]:
    table = _table("contact models", "name", "table slip point", "lift", "what")
    for model in MODELS:
        lift = "yes" if model.terms.lift else "no"
        table.add_row(model.name, model.terms.table_slip_point, lift, model.text)
    return [table]


def _variants() -> list[Table]:
    axes = _table("option axes (the first choice is the default)", "axis", "choice", "what")
    for axis in AXES:
        axes.add_section()
        axes.add_row(axis.key, "", axis.text)
        for choice in axis.choices:
            axes.add_row("", choice.code, choice.text)
    rules = _table("combinations that are refused", "rule", "reason")
    for rule in RULES:
        rules.add_row(rule.name, rule.reason)
    presets = _table("presets", "name", "what", "options")
    for preset in PRESETS:
        options = " ".join(f"{k}={v}" for k, v in preset.options.items())
        presets.add_row(preset.name, preset.text, options)
    return [axes, _lanes(), rules, presets]


def _lanes() -> Table:
    table = _table("lanes of a vector, by the numbers in them", "set", "double", "float", "what")
    precisions: tuple[Precision, ...] = ("double", "float")
    for each in INSTRUCTION_SETS:
        counts = (f"x{each.lanes(precision)}" for precision in precisions)
        table.add_row(each.name, *counts, each.text)
    return table
