"""The form of the generator: how long, how many, and what is declared once."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from tests.support.kernels import ROOT

MODULE_LINES, FUNCTION_LINES, PARAMETERS = 300, 50, 6


def _modules() -> Iterator[tuple[str, str]]:
    folder = ROOT / "generator"
    for path in sorted(folder.rglob("*.py")):
        yield path.relative_to(folder).as_posix(), path.read_text("utf-8")


def _functions() -> Iterator[tuple[str, ast.FunctionDef | ast.AsyncFunctionDef]]:
    for name, text in _modules():
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                yield f"{name}: {node.name}", node


def _parameters(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    given = function.args
    names = [a.arg for a in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    own = names[:1] in (["self"], ["cls"])
    return len(names) - own + bool(given.vararg) + bool(given.kwarg)


def test_no_module_has_over_300_lines() -> None:
    lines = {name: len(text.splitlines()) for name, text in _modules()}
    assert not {name: n for name, n in lines.items() if n > MODULE_LINES}


def test_no_function_has_over_50_lines() -> None:
    lines = {name: (f.end_lineno or 0) - f.lineno + 1 for name, f in _functions()}
    assert not {name: n for name, n in lines.items() if n > FUNCTION_LINES}


def test_no_function_has_more_than_six_parameters() -> None:
    count = {name: _parameters(f) for name, f in _functions()}
    assert not {name: n for name, n in count.items() if n > PARAMETERS}


def test_nothing_is_asserted_to_be_there() -> None:
    """A type says what is there: `assert x is not None` says that it does not."""
    asserted = re.compile(r"^\s*assert .* is not None\b", re.MULTILINE)
    count = {name: len(asserted.findall(text)) for name, text in _modules()}
    assert not {name: n for name, n in count.items() if n}


def test_the_interval_of_a_ratio_is_declared_once() -> None:
    declared = re.compile(r"^\s+ratio_ci\s*:", re.MULTILINE)
    count = {name: len(declared.findall(text)) for name, text in _modules()}
    found = {name: n for name, n in count.items() if n}
    assert sum(found.values()) == 1, found
