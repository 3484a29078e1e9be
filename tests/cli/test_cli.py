"""The commands as users call them: results, one line of complaint, exit status, nothing written."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

import generator.api.session as session
from generator.api import read_cases
from generator.choice.candidates import published_name
from generator.choice.folder import write_folder
from generator.choice.selection import Selected, Selection, read_selection
from generator.cli.main import gen
from generator.errors import InputError
from generator.evidence.verification.verdict import Verdict
from generator.impacts.ball_ball.evidence import PUBLISHED
from generator.impacts.ball_ball.evidence.fixed_steps import euler_verdict
from generator.impacts.ball_ball.evidence.measure import OUTCOME_COLUMNS, OUTCOME_NAMES, STICKS
from generator.impacts.ball_ball.presets import find_preset
from generator.impacts.ball_ball.row import BALL_BALL
from generator.impacts.ball_ball.scene import parse_scene
from generator.registry.lane_numbers import widths_for
from generator.registry.names import name_of, variant_of
from generator.registry.rules import broken_rule
from generator.registry.variant import Variant
from generator.targets.target import find_target, load_rows, targets
from generator.toolchain.compilers import find_compilers
from tests.support.contests import baseline, fixed_step_candidates
from tests.support.hosts import skip_unless_runs
from tests.support.kernels import ROOT, bench_tool, variant
from tests.support.reference import FOLDER, exact_verdict, load_reference

INPUTS = FOLDER / "inputs.csv"


def call(*arguments: object, root: Path | None = None) -> Result:
    where = None if root is None else session.Session(root=root)
    return CliRunner().invoke(gen, [str(a) for a in arguments], obj=where)


def refused(result: Result, *parts: str) -> None:
    """One line on standard error with all parts, nothing on standard output, exit status 2."""
    print(result.stderr)
    assert result.exit_code == 2, (result.exit_code, result.output, result.exception)
    lines = [line for line in result.stderr.splitlines() if not line.startswith("carom:")]
    assert len(lines) == 1 and lines[0].startswith("gen: "), result.stderr
    assert result.stdout == ""
    for part in parts:
        assert part in lines[0], lines[0]


@pytest.fixture
def lines() -> list[str]:
    return INPUTS.read_text("utf-8").splitlines()[:6]


def written(folder: Path, lines: list[str]) -> Path:
    path = folder / "cases.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def changed(lines: list[str], row: int, column: str, value: str) -> list[str]:
    names = lines[0].split(",")
    fields = lines[row].split(",")
    fields[names.index(column)] = value
    return [*lines[:row], ",".join(fields), *lines[row + 1 :]]


def outcomes(path: Path) -> tuple[list[str], np.ndarray]:
    with path.open(newline="", encoding="utf-8") as file:
        records = list(csv.DictReader(file))
    assert list(records[0]) == ["id", *OUTCOME_NAMES, "status"]
    rows = np.array([[float(r[n]) for n in (*OUTCOME_NAMES, "status")] for r in records])
    return [r["id"] for r in records], rows


# ---- collide ---------------------------------------------------------------------------------


@pytest.mark.parametrize("target", ["native", "zen3"])
@pytest.mark.parametrize("code", ["gcc", "clang"])
def test_collide_reproduces_pooltool(target, code, tmp_path, monkeypatch) -> None:
    skip_unless_runs(*{target} - {"native"})
    only = tuple(c for c in find_compilers() if c.code == code)
    if not only:
        pytest.skip(f"no {code} on this machine")
    monkeypatch.setattr(session, "find_compilers", lambda: only)
    out = tmp_path / "out.csv"
    options = ("--model", "pooltool", "--steps", 1000, "--target", target)
    result = call("collide", "--cases", INPUTS, "--out", out, *options)
    assert result.exit_code == 0, result.stderr
    reference, tool = load_reference(), bench_tool()
    ids, got = outcomes(out)
    assert tuple(map(int, ids)) == reference.ids
    marks = tool.expect(reference.cases, "euler", "pooltool")[:, STICKS:]
    want = np.hstack([reference.published[PUBLISHED][:, :OUTCOME_COLUMNS], marks])
    verdict = euler_verdict(reference.cases, got, want, reference.exact["pooltool"], 1000)
    print(
        f"{target} {code}: {verdict.reason}; largest difference {verdict.max_abs_error:.2g} m/s, "
        f"{len(verdict.flips)} flips of at most {verdict.max_flip_error:.2g} m/s"
    )
    assert verdict.passed, verdict.reason


def test_collide_takes_steps_and_ignores_extra_columns(lines, tmp_path) -> None:
    cases = written(tmp_path, [f"{line},{n}" for n, line in enumerate(lines)])
    results = {}
    for name, options in {"coarse": ("--steps", 1000), "fine": ("--steps", 5000)}.items():
        out = tmp_path / f"{name}.csv"
        result = call("collide", "--cases", cases, "--out", out, *options)
        assert result.exit_code == 0, result.stderr
        results[name] = outcomes(out)[1]
    assert 0 < np.abs(results["coarse"] - results["fine"]).max() < 0.5


GOALS = {
    "steps": ("--steps", 1000),
    "other steps": ("--steps", 500),
    "budget": ("--max-error", 1e-6),
    "scene's own budget": (),
}


@pytest.mark.parametrize(
    ("goal", "target"),
    [
        ("steps", "native"),
        ("budget", "native"),
        ("other steps", "x86-64-v2"),
        ("scene's own budget", "x86-64-v2"),
    ],
)
def test_collide_batch_goes_in_lanes_and_gives_what_single_calls_give(
    goal, target, tmp_path
) -> None:
    rows = INPUTS.read_text("utf-8").splitlines()[:401]
    cases = written(tmp_path, changed(rows, 3, "v1x", "nan"))
    resolved, _ = session.resolve_target(target)
    options = (*GOALS[goal], "--target", target, "--cases", cases)
    told, got = {}, {}
    for name, batch in (("single", ()), ("batch", ("--batch",))):
        out = tmp_path / f"{name}.csv"
        result = call("collide", *options, *batch, "--out", out)
        assert result.exit_code == 0, result.stderr
        kernel = re.search(r" by (.+); written", result.stdout)
        told[name], got[name] = variant_of(kernel[1]), outcomes(out)[1]
    assert told["single"].width == 1 and told["batch"].width > 1
    if target == "native":
        family = told["batch"].stepper.family
        assert told["batch"].width == max(widths_for(resolved, BALL_BALL.find_scene("any"), family))
    if "--steps" in GOALS[goal]:
        assert told["batch"].stepper.steps == GOALS[goal][1]
    assert np.array_equal(got["single"][:, 12], got["batch"][:, 12])
    assert got["batch"][2, 12] == 2 and np.isnan(got["batch"][2]).any()
    verdict = verdict_of_batch(goal, read_cases(cases).rows, got["batch"])
    print(f"{target}, {goal}, x{told['batch'].width}: {verdict.reason}")
    assert verdict.passed, verdict.reason


def verdict_of_batch(goal: str, rows: np.ndarray, got: np.ndarray) -> Verdict:
    """Against the oracles, by the rules that the main job has."""
    exact = bench_tool().expect(rows, "exact", "mathavan2014")
    if "--steps" not in GOALS[goal]:
        return exact_verdict(rows, got, exact, 1e-6)
    steps = GOALS[goal][1]
    euler = bench_tool().expect(rows, "euler", "mathavan2014", steps)
    return euler_verdict(rows, got, euler, exact, steps, 0.02)


def test_collide_batch_takes_the_stored_choice(tmp_path, lines) -> None:
    """And the fastest, where several widths were chosen."""
    skip_unless_runs("x86-64-v3")
    single = find_preset("reduced-ahead").options
    x2 = variant("x86-64-v3", **single).in_lanes(2, lane_root="inv", interleave="i2")
    x4 = variant("x86-64-v3", **single).in_lanes(4, lane_root="cubic", interleave="i4")
    entries = [stored(v, ratio) for v, ratio in ((x2, 0.2), (x4, 0.1))]
    folder = tmp_path / "generated" / "ball-ball" / "x86-64-v3" / "any"
    selection = Selection(
        impact="ball-ball", target="x86-64-v3", resolved="x86-64-v3", scene="any", kernels=entries
    )
    write_folder(folder, selection)
    options = ("--model", "pooltool", "--steps", 1000, "--target", "x86-64-v3", "--batch")
    places = ("--cases", written(tmp_path, lines), "--out", tmp_path / "out.csv")
    result = call("collide", *places, *options, root=tmp_path)
    assert result.exit_code == 0, result.stderr
    assert f"by {name_of(x4)}; written" in result.stdout


def stored(kernel: Variant, ratio: float) -> Selected:
    return Selected(
        question=str(kernel.question),
        recipe=str(kernel.recipe),
        chosen_by="timing",
        measured_on="x86-64-v3",
        ratio_to_baseline=ratio,
        ratio_ci=None,
        max_rel_error=None,
        error_against="euler",
        ties=[],
    )


def test_collide_says_what_a_row_with_nan_is(lines, tmp_path) -> None:
    cases = written(tmp_path, changed(lines, 2, "v1x", "nan"))
    result = call("collide", "--cases", cases, "--out", tmp_path / "out.csv")
    assert result.exit_code == 0, result.stderr
    status = outcomes(tmp_path / "out.csv")[1][:, 12]
    assert list(status) == [0, 2, 0, 0, 0]


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        (lambda t: changed(t, 0, "u_b", "friction"), ("row 1", "u_b", "expected id,")),
        (lambda t: changed(t, 3, "w2z", "fast"), ("row 4, column w2z", "'fast' is no number")),
        (lambda t: changed(t, 3, "w2z", ""), ("row 4, column w2z", "nothing is no number")),
        (lambda t: changed(t, 3, "v1x", "1_0"), ("row 4, column v1x", "no number")),
        (lambda t: changed(t, 1, "R", "0"), ("row 2, column R", "0 is out of range", "1e-09 to")),
        (lambda t: changed(t, 1, "R", "-0.03"), ("row 2, column R", "-0.03")),
        (lambda t: changed(t, 1, "M", "0"), ("row 2, column M",)),
        (lambda t: changed(t, 5, "e_b", "1.01"), ("row 6, column e_b", "expected 0 to 1")),
        (lambda t: changed(t, 2, "u_s1", "-0.1"), ("row 3, column u_s1",)),
        (lambda t: changed(t, 2, "u_b", "-1e-9"), ("row 3, column u_b",)),
        (lambda t: t[:1], ("only a header",)),
        (lambda t: [], ("no column id",)),
        (lambda t: [*t, t[1] + ",5"], ("row 7", "more values")),
        (lambda t: [line + "," + ("R", "1")[n > 0] for n, line in enumerate(t)], ("twice",)),
    ],
)
def test_collide_refuses_bad_cases(change, parts, lines, tmp_path) -> None:
    cases = written(tmp_path, change(lines))
    out = tmp_path / "out.csv"
    refused(call("collide", "--cases", cases, "--out", out), "cases.csv", *parts)
    assert not out.exists()


@pytest.mark.parametrize(
    ("options", "parts"),
    [
        (("--target", "zen9"), ("--target zen9", "native, x86-64-v2")),
        (("--model", "billiards"), ("--model billiards", "mathavan2014")),
        (("--steps", "0"), ("--steps", "1<=x")),
        (("--steps", "many"), ("--steps",)),
        (("--colour", "red"), ("--colour",)),
        (("--steps", "5", "--max-error", "1e-6"), ("--steps", "--max-error")),
        (("--cases", "none.csv"), ("none.csv", "No such file")),
        (("--cases", "/bin/true"), ("/bin/true",)),
        (("--out", "/no/such/folder/out.csv"), ("/no/such/folder", "make it first")),
        (("--out", "/"), ("is a folder",)),
        (("--out", "/etc/passwd/out.csv"), ("/etc/passwd",)),
    ],
)
def test_collide_refuses_bad_options(options, parts, tmp_path) -> None:
    out = tmp_path / "out.csv"
    refused(call("collide", "--cases", INPUTS, "--out", out, *options), *parts)
    assert list(tmp_path.iterdir()) == []


# ---- what starts fast loads little -------------------------------------------------------------

LOADED = """
import json, sys
import generator
slow = ("sympy", "numpy", "scipy", "matplotlib", "pydantic", "jinja2", "rich")
def loaded(): return [name for name in slow if name in sys.modules]
found = {"import generator": loaded()}
from click.testing import CliRunner
from generator.cli.main import gen
helps = [[name, "--help"] for name in gen.commands]
lists = [["list", what] for what in ("targets", "scenes", "variants", "models")]
for words in ([], ["--help"], ["--version"], *helps, *lists):
    CliRunner().invoke(gen, words)
    found["gen " + " ".join(words)] = loaded()
print(json.dumps(found))
"""


def test_help_and_lists_load_no_library_that_is_slow_to_load() -> None:
    """SymPy takes a second to load, SciPy half of one: `gen --help` took 2.5 s with them."""
    done = subprocess.run(
        [sys.executable, "-P", "-c", LOADED],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    found = json.loads(done.stdout)
    print("\n".join(f"{command}: {libraries}" for command, libraries in found.items()))
    assert len(found) > 15
    for command, libraries in found.items():
        tables = " list " in command and "--help" not in command
        assert set(libraries) <= ({"pydantic", "rich"} if tables else set()), command


# ---- the main job, bench, explain, list ------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("--fresh",), ("--target native",)),
        (("--target", "zen9"), ("zen9", "zen3")),
        (("--target", "zen3", "--scene", "moon"), ("moon", "any", "pool")),
        (("--target", "zen3", "--model", "none"), ("none", "bottom_slip")),
        (("--target", "zen3", "--seconds", "0"), ("--seconds",)),
        (("--target", "zen3", "--out", "/etc/passwd"), ("/etc/passwd", "cannot be written")),
        (("--frobnicate",), ("--frobnicate", "gen has --all, --check", "--update")),
        (("collide", "--frobnicate"), ("gen collide has --batch", "--target")),
        (("frobnicate",), ("no command 'frobnicate'; there are bench, challenge", "worker")),
        (("list", "moons"), ("moons", "targets")),
        (("explain", "paper-worst"), ("paper-worst", "paper-best")),
        (("explain", "zen3.any.pooltool"), ("no preset or kernel",)),
        (("challenge", "zen3.any.pooltool"), ("no question", "MODEL-GOAL-WIDTH")),
        (("challenge", "generated/ball-ball/zen3/any/pooltool-n1000-x1.cpp"), ("has fixed steps",)),
        (("bench", "--target", "zen9", "--json", "x.json"), ("zen9",)),
        (("--target", "zen3", "bench"), ("--target", "write it after bench")),
        (("sweep", "--impact", "ball-cushion", "--scheduler", "x:1"), ("know ball-ball alone",)),
        (
            ("sweep", "--impact", "ball-cushion", "--model", "pooltool", "--max-error", "1e-6"),
            ("pooltool has fixed steps alone",),
        ),
        (("report", "--impact", "ball-cushion"), ("the page is of ball-ball alone", "gen sweep")),
        (("report", "--impact", "moon"), ("no such impact",)),
        (("list", "targets", "--impact", "ball-cushion"), ("not targets",)),
        (("plot", "--impact", "ball-cushion", "--out", "x.svg"), ("--impact", "add --models")),
        (("bench", "--impact", "ball-cushion"), ("--impact ball-cushion --scene any",)),
        (("emit", "ball-cushion/zen3/any/pooltool-e1m06-x1", "dp54"), ("fixed steps alone",)),
    ],
)
def test_wrong_usage_is_one_line(arguments, parts) -> None:
    refused(call(*arguments), *parts)


def test_explain_refuses_an_illegal_combination_by_rule() -> None:
    name = name_of(variant(state="reduced"))
    refused(call("explain", name), "illegal combination (reduced-needs-products)", "speeds")
    unknown = name.replace("mathavan2014", "x").replace("pooltool", "x")
    refused(call("explain", unknown), "x")


def test_explain_prints_derivation_options_and_counts() -> None:
    text = call("explain", "paper-best").stdout
    for part in ("Derivation", "dc_x = 7*d_x", "est1", "sqrt", "flops", "sum q"):
        assert part in text or part == "sum q", part


def test_explain_takes_the_names_that_kernels_and_files_have() -> None:
    question, recipe = "ball-ball/zen3/any/bottom_slip-e1m06-x1", "dp54 root=est1 fma=fma"
    told = f"{question} {recipe}"  # what carom_kernel() of that text tells
    chosen = selected_recipe(question)
    named = [(told,), (question, recipe), told.split(), (told, "flags=strict")]
    named = [(words, told) for words in named]
    files = (question, f"generated/{question}.cpp", str(ROOT / "generated" / f"{question}.cpp"))
    for words, name in [*named, *(((file,), f"{question} {chosen}") for file in files)]:
        result = call("explain", *words)
        assert result.exit_code == 0, result.output
        assert result.stdout.splitlines()[0] == name


def selected_recipe(question: str) -> str:
    selection = read_selection((ROOT / "generated" / question).parent)
    assert selection is not None
    [recipe] = [entry.recipe for entry in selection.kernels if entry.question == question]
    return recipe


QUESTION = "ball-ball/zen3/any/pooltool-e1m06-x1"


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ((), ("name a question", "--header")),
        ((QUESTION, "dp54", "--header", "any"), ("--header",)),
        ((QUESTION, "rk4"), ("rk4", "no stepper", "dop853")),
        ((QUESTION, "dp54", "root=est0", "fma=fma"), ("roots-within-budget",)),
        (
            (QUESTION, "dp54", "simd=balls"),
            ("no option 'simd'", "root, tiers, fma, compiler, flags"),
        ),
        ((QUESTION.replace("ball-ball", "ball-cue"), "dp54"), ("ball-cue", "there are ball-ball")),
        ((QUESTION.replace("zen3", "zen9"), "dp54"), ("zen9", "no such target", "zen4")),
        ((QUESTION.replace("any", "moon"), "dp54"), ("moon", "no such scene", "pool")),
        ((QUESTION.replace("pooltool", "glue"), "dp54"), ("glue", "no such model", "mathavan2014")),
        ((QUESTION.replace("e1m06", "e3m07"),), ("none was chosen", "recipe", "./gen --target")),
        (("pooltool",), ("no question", "IMPACT/TARGET/SCENE/MODEL-GOAL-WIDTH")),
        (("--header", "moon"), ("moon", "pool")),
        (("--header", "any", "--out", "/no/carom.h"), ("/no/carom.h", "no folder")),
    ],
)
def test_emit_refuses_in_one_line(arguments, parts) -> None:
    refused(call("emit", *arguments), *parts)


@pytest.mark.parametrize("what", ["targets", "scenes", "variants", "models"])
def test_list(what) -> None:
    """In a pipe a row is a line of plain text, nothing cut; --json holds the same rows."""
    result = call("list", what)
    assert result.exit_code == 0 and len(result.stdout.splitlines()) > 3
    assert "\x1b" not in result.stdout and "\u2026" not in result.stdout
    found = json.loads(call("list", what, "--json").stdout)
    rows = [row for table in found.values() for row in table] if what == "variants" else found
    lines = [line.split() for line in result.stdout.splitlines()]
    for row in rows:
        words = [word for value in row.values() if isinstance(value, str) for word in value.split()]
        assert any(set(words) <= set(line) for line in lines), row


def test_gen_alone_prints_the_help() -> None:
    result = call()
    assert result.exit_code == 0 and result.stdout == call("--help").stdout


KERNEL_TEXTS = (
    *("name", "impact", "question", "recipe", "target", "scene", "model", "stepper", "compiler"),
    *("flags", "cases"),
)


def test_bench_json_is_as_documented(tmp_path) -> None:
    path = tmp_path / "bench.json"
    options = ("--target", "x86-64-v2", "--scene", "any", "--model", "pooltool", "--seconds", 0.5)
    result = call("bench", *options, "--json", path)
    assert result.exit_code == 0, result.output + result.stderr
    document = json.loads(path.read_text("utf-8"))
    assert document["schema"] == 1
    assert {"cpu", "target", "compilers"} <= set(document["host"])
    for cases in ("mixed", "easy"):
        own = [k for k in document["kernels"] if k["cases"] == cases]
        chosen_in_lanes = [k["width"] > 1 for k in own if k["selected"]]
        each = "of fixed steps and of 1e-6 one for single calls and one for batches"
        assert sorted(chosen_in_lanes) == [False, False, True, True], each
    closed = {(row["name"], row["cases"]) for row in document["closed_forms"]}
    assert closed == {("no-table-friction", "mixed"), ("no-table-friction", "easy")}
    assert all(row["ns_per_collision"] > 0 for row in document["closed_forms"])
    types = {
        **dict.fromkeys(KERNEL_TEXTS, str),
        "width": int,
        **dict.fromkeys(("ns_per_collision", "ratio_to_baseline", "max_rel_error"), float),
        "ratio_ci": list,
        "options": dict,
        "error_against": str,
        "selected": bool,
    }
    for kernel in document["kernels"]:
        for key, kind in types.items():
            assert isinstance(kernel[key], kind), (key, kernel[key])
        low, high = kernel["ratio_ci"]
        assert low <= kernel["ratio_to_baseline"] <= high
        exact = kernel["budget"] is not None
        assert isinstance(kernel["steps"], int) is not exact
        assert kernel["error_against"] == ("exact" if exact else "euler_n1000")
        assert (kernel["stepper"] == "euler") is not exact
        assert kernel["name"] == f"{kernel['question']} {kernel['recipe']}"
        assert kernel["question"].startswith(f"{kernel['impact']}/x86-64-v2/any/pooltool-")


@pytest.mark.parametrize("target", targets())
def test_every_target_has_legal_candidates(target) -> None:
    made = fixed_step_candidates(find_target(target), "any", "pooltool", 1000, ["gcc", "clang"])
    names = [name_of(v) for v in made]
    assert len(set(names)) == len(names) > 20
    assert all(broken_rule(v, find_target(target)) is None for v in made)
    first = baseline(find_target(target), "any", "pooltool", ["gcc", "clang"])
    assert made[0] == first and published_name(first) == "paper-initial"


def test_report_rows_are_named() -> None:
    for name in ("paper-initial", "paper-best"):
        assert published_name(variant(**find_preset(name).options)) == name
    assert published_name(variant()) == ""


# ---- data files ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("name = ", ("some.toml", "not valid TOML")),
        ('name = "x"', ("some.toml", "text")),
        ('name = "x"\ntext = "t"\ncolour = 1', ("some.toml", "colour")),
        ('name = "x"\ntext = "t"\n[fixed]\nR = 0.0', ("some.toml", "fixed.R")),
        ('name = "x"\ntext = "t"\n[fixed]\ne_b = "much"', ("some.toml", "e_b")),
        ('name = "x"\ntext = "t"\n[ranges]\nu_b = [0.6, 0.1]', ("some.toml", "ranges.u_b")),
    ],
)
def test_broken_scenes_are_named(text, parts) -> None:
    with pytest.raises(InputError) as caught:
        parse_scene(text, "some.toml")
    assert all(part in str(caught.value) for part in parts), caught.value


@pytest.mark.parametrize(
    "text", ["[a", '[a]\ntext = "t"', '[a]\narch = 3\ntext = "t"\nmarch = "m"\nmca_cpu = "c"']
)
def test_broken_targets_are_named(text) -> None:
    with pytest.raises(InputError, match=r"some\.toml: "):
        load_rows(text, "some.toml")


# ---- check and update ------------------------------------------------------------------------


@pytest.fixture
def copy(tmp_path) -> Path:
    """A folder of its own with one target's scene."""
    place = tmp_path / "generated" / "ball-ball" / "zen3" / "any"
    shutil.copytree(ROOT / "generated" / "ball-ball" / "zen3" / "any", place)
    assert call("--update", "--out", tmp_path / "generated").exit_code == 0
    return place


def test_check_finds_what_is_not_fresh_and_update_cures_it(copy) -> None:
    root = copy.parents[2]
    before = {p.name: p.read_bytes() for p in copy.iterdir()}
    assert call("--check", "--out", root).exit_code == 0
    kernels = sorted(copy.glob("*.cpp"))
    kernels[0].write_text(kernels[0].read_text("utf-8").replace("0.5", "0.6"), encoding="utf-8")
    (copy / "carom.h").unlink()
    (copy / "old.cpp").write_text("int x;\n", encoding="utf-8")
    (copy / "old").mkdir()
    result = call("--check", "--out", root)
    print(result.stdout)
    assert result.exit_code == 1
    for name, kind in ((kernels[0].name, "differs"), ("carom.h", "missing"), ("old.cpp", "stray")):
        assert f"{name}: {kind}" in result.stdout
    assert "old: stray" in result.stdout
    assert "./gen --update" in result.stdout and "0.6" in result.stdout
    assert call("--update", "--out", root).exit_code == 0
    assert call("--check", "--out", root).exit_code == 0
    assert {p.name: p.read_bytes() for p in copy.iterdir()} == before


def test_check_sees_strays_beside_the_folders(copy) -> None:
    root = copy.parents[2]
    (root / "notes.txt").write_text("x", encoding="utf-8")
    (copy.parent / "carrom").mkdir()
    (copy.parent / "carrom" / "kernel.cpp").write_text("x", encoding="utf-8")
    result = call("--check", "--out", root)
    assert result.exit_code == 1
    assert "notes.txt: stray" in result.stdout and "carrom: stray" in result.stdout
    assert call("--update", "--out", root).exit_code == 0
    assert call("--check", "--out", root).exit_code == 0


@pytest.mark.parametrize(
    "change",
    [
        lambda t: t[:-20],
        lambda t: t.replace('"kernels"', '"kernel"'),
        lambda t: t.replace("-n1000-", "-many-", 1),
        lambda t: t.replace("fma=fma", "fma=somefma"),
        lambda t: t.replace('"target": "zen3"', '"target": "zen9"'),
        lambda t: "[]",
    ],
)
def test_a_broken_selection_is_one_line(change, copy) -> None:
    path = copy / "selection.json"
    path.write_text(change(path.read_text("utf-8")), encoding="utf-8")
    root = copy.parents[2]
    refused(call("--check", "--out", root), "selection.json")
    refused(call("--update", "--out", root), "selection.json")
    if '"zen9"' not in path.read_text("utf-8"):
        refused(call("--target", "zen3", "--scene", "any", "--out", root), "selection.json")


def test_check_of_nothing_is_refused(tmp_path) -> None:
    refused(call("--check", "--out", tmp_path), "selection.json", "./gen --target")
