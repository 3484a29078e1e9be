"""The API: its names, its page, and that the command line holds no work of its own."""

from __future__ import annotations

import ast
import sys
from pathlib import Path

import numpy as np
import pytest

from generator import api
from generator.choice.choose import Choice
from generator.choice.selection import Selected
from generator.errors import InputError
from tests.support.kernels import ROOT, variant
from tests.support.reference import FOLDER

sys.path.insert(0, str(ROOT / "tools"))


def imported_for_types() -> set[str]:
    """The names that a type checker sees in generator/api/__init__.py."""
    tree = ast.parse((ROOT / "generator" / "api" / "__init__.py").read_text("utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    return {name.name for each in block.body for name in each.names}


def test_every_name_of_the_api_is_where_it_is_said_to_be_and_has_a_docstring():
    assert set(dir(api)) == imported_for_types()
    for name in dir(api):
        assert getattr(api, name).__doc__, name
    with pytest.raises(AttributeError, match="collide"):
        api.collyde  # noqa: B018


def test_the_page_of_the_api_is_what_the_docstrings_give():
    import api_page

    cure = "run .venv/bin/python tools/api_page.py"
    assert api_page.PAGE.read_text("utf-8") == api_page.page(), cure


def test_the_command_line_works_through_the_api_alone():
    """It may name what it prints, and reads no kernel, store or machine by itself."""
    rooms = ("choice", "emission", "toolchain", "sweep", "vendoring", "steppers", "lowering")
    for path in sorted((ROOT / "generator" / "cli").glob("*.py")):
        tree = ast.parse(path.read_text("utf-8"))
        for node in ast.walk(tree):
            if not isinstance(node, ast.FunctionDef):
                continue
            for each in ast.walk(node):
                if isinstance(each, ast.ImportFrom) and each.level == 2:
                    room = (each.module or "").split(".")[0]
                    fine = each.module == "sweep.finals"  # how a final is read
                    assert fine or room not in rooms, f"{path.name}: {each.module}"


def test_collide_takes_rows_and_gives_outcomes():
    rows = api.read_cases(FOLDER / "inputs.csv").rows[:5]
    found = api.collide(rows, api.Request(model="pooltool", max_error=1e-6))
    assert found.outcomes.shape == (5, 13) and found.collided == 5
    assert "pooltool" in found.kernel and not np.array_equal(found.outcomes[:, 0], rows[:, 9])


@pytest.mark.parametrize(
    ("request_", "part"),
    [
        (api.Request(target="zen9"), "zen9"),
        (api.Request(model="none"), "none"),
        (api.Request(steps=5, max_error=1e-6), "exclude each other"),
        (api.Request(scene="arcade", steps=5), "no fixed-step scheme"),
    ],
)
def test_a_request_that_cannot_be_is_refused_in_one_line(request_, part):
    with pytest.raises(InputError, match=part) as caught:
        request_.resolved()
    assert "\n" not in str(caught.value)


def test_explain_says_step_of_exact_kernels_and_begins_with_its_symbols():
    found = api.explain("ball-ball/zen3/any/bottom_slip-e1m06-x1 dp54 root=est1")
    assert found.exact and found.flops > 50
    assert dict(found.legend)["dq"].startswith("one increment of the normal impulse")
    assert "dc_x" in [symbol for each in found.derivation for symbol, _ in each.formulas]


# ---- the main job's screen -----------------------------------------------------------------------


class Told:
    """A contest as the summary asks of it."""

    def __init__(self, model: str, fixed: bool, batch: bool) -> None:
        from generator.api.generation import Row

        self.model, self.fixed = model, fixed
        self.over, self.baseline_name = "|v1 - v2|", "paper-initial"
        self.title = f"{model}, {'N = 1000' if fixed else 'within 1e-06'}, {'ab'[batch]}"
        options = {"rsqrt": "ahead", "order": "chain", "state": "reduced", "reuse": "factored"}
        own = variant(**options, roots="early", branch="chosen", loop="twostage")
        self.recipe = str(own.recipe) if fixed else "dp54 root=est1"
        self.choice = Choice(None, (), "timing", "zen3", "timed on a CPU (zen3), 2026-01-01")
        goal, width = "n1000" if fixed else "e1m06", "x8" if batch else "x1"
        self.entry = Selected(
            question=f"ball-ball/zen3/any/{model}-{goal}-{width}",
            recipe=self.recipe,
            chosen_by="timing",
            measured_on="zen3",
            ratio_to_baseline=1 / 233.2,
            ratio_ci=None,
            max_rel_error=1.2e-7,
            error_against="euler" if fixed else "exact",
            ties=[],
        )
        self._rows = [
            Row(self.recipe, 100.0, None, None, 0.01 * n, None, 1e-7 / n, "") for n in range(1, 20)
        ]

    def front(self) -> list:
        return self._rows


@pytest.mark.parametrize("models", [1, 3])
def test_the_main_job_shows_choices_and_front_on_one_screen(models):
    from generator.api.generation import Generated
    from generator.cli.generate import COLUMNS, LINES, summary
    from generator.targets.host import read_host
    from generator.targets.target import find_target

    names = ("mathavan2014", "bottom_slip", "pooltool")[:models]
    contests = tuple(
        Told(name, fixed, batch)
        for name in names
        for fixed in (True, False)
        for batch in (False, True)
    )
    folder = Path("generated/zen3/any")
    made = Generated(find_target("zen3"), read_host(), "any", folder, contests, "", "")
    lines = summary(made)
    print("\n".join(lines))
    assert len(lines) <= LINES == 40 and max(map(len, lines)) <= COLUMNS == 80
    text = "\n".join(lines)
    for contest in contests:
        assert contest.entry.file in text
    chosen = [line for line in lines if ".cpp" in line]
    assert len(chosen) == len(contests) and all("233" in line for line in chosen)
    assert text.index("fixed steps: chosen") < text.index("exact kernels: chosen")
    assert sum(" times " in line and "e-0" in line for line in lines) >= (4 if models == 1 else 1)
