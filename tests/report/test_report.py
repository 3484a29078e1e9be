"""The report: made from what is stored, page and data with the same numbers, seen in a browser."""

from __future__ import annotations

import itertools
import json
import re
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

import generator.api.session as session
import generator.places as places
from generator.api import read_cases
from generator.choice.trials import Final, Trial
from generator.cli.main import gen
from generator.impacts.ball_ball.evidence.measure import CASE_NAMES
from generator.impacts.ball_ball.presets import PAPER_PRESETS
from generator.registry.names import variant_of
from generator.registry.variant import Stepper, make_variant
from generator.report.contests import contests_of, latest, summary_of
from generator.report.experiments.accuracy import kinds_of
from generator.report.experiments.subjects import BASELINE, BEST, EULER, Subject, calls
from generator.report.findings import Findings, findings_path, read_findings, write_findings
from generator.report.known import Known, last_finals
from generator.report.page import render
from generator.report.plots import ASIDE, SIDE, Mark, side_by_side
from generator.report.report import make_report
from generator.report.sections.effects import Effect, effects_of, one_each
from generator.report.sections.published import NUMBA_CYCLES
from generator.sweep.store import read_only
from tests.support.browser import ask, picture, script
from tests.support.hosts import believe
from tests.support.reference import load_reference
from tests.support.stored_report import EFFECTS, MadeStore, make_findings, make_store

TARGET = "zen3"
VARIANTS = 1500  # about what a default sweep tries
SIZES = [(1280, False), (1280, True), (390, False), (390, True)]


@dataclass(frozen=True)
class Made:
    page: Path
    data: Path
    seconds: float
    store: MadeStore

    def document(self) -> dict:
        return json.loads(self.data.read_text("utf-8"))


def _run(*arguments: object) -> Result:
    return CliRunner().invoke(gen, [str(a) for a in arguments])


def _caches_in(folder: Path, patch: pytest.MonkeyPatch) -> None:
    for module in (places, session):
        patch.setattr(module, "cache_folder", lambda: folder)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Made]:
    """The page of a store as large as a default sweep's, with everything measured."""
    folder = tmp_path_factory.mktemp("report")
    store = make_store(folder / "s.sqlite", TARGET, VARIANTS)
    with pytest.MonkeyPatch.context() as patch:
        _caches_in(folder, patch)
        kept = findings_path(folder, TARGET, "any", "mathavan2014")
        write_findings(kept, make_findings(TARGET))
        page = folder / "report.html"
        start = time.process_time()  # other work on the machine is not in it
        result = _run("report", "--target", TARGET, "--store", store.path, "--out", page)
        seconds = time.process_time() - start
    assert result.exit_code == 0, result.output
    yield Made(page, page.with_suffix(".json"), seconds, store)


def test_a_report_of_a_stored_sweep_takes_under_30_s_and_3_mb(made: Made) -> None:
    size = made.page.stat().st_size / 1e6
    print(f"{made.store.trials} trials: {made.seconds:.1f} s, {size:.2f} MB")
    assert made.store.trials > 1000
    assert made.seconds < 30
    assert size < 3


def test_the_page_is_one_file_without_scripts_that_run_and_without_a_network(made: Made) -> None:
    text = made.page.read_text("utf-8")
    page, script, data = text.partition('<script type="application/json" id="data">')
    assert script
    assert text.count("<script") == 1  # which is data
    assert not re.search(r"<(link|img|iframe|object|embed|video|audio)\b", page)
    assert not re.search(r"""(?:src|href)\s*=\s*["'](?!#)|url\(|@import|\bon\w+\s*=""", page)
    embedded = json.loads(data.partition("</script>")[0].replace("<\\/", "</"))
    assert embedded == made.document()


def test_what_the_issue_lists_stands_in_its_order(made: Made) -> None:
    found = re.findall(r'<section id="(\w+)">', made.page.read_text("utf-8"))
    wanted = ["chosen", "contests", "outputs", "worst", "kinds", "effects", "growth", "operations"]
    wanted += ["sections", "modelled", "compilers", "misses", "calls", "cpus", "published"]
    wanted += ["machine"]
    assert found == wanted


def test_numbers_in_the_page_equal_those_in_the_data(made: Made) -> None:
    found = ask(made.page, script("numbers"))
    print(f"{found['count']} numbers, {found['empty']} that are not known")
    assert found["wrong"] == []
    assert found["count"] > 2000


@pytest.mark.parametrize(("width", "dark"), SIZES)
def test_plots_are_there_with_labels_and_legends_and_nothing_overlaps(
    made: Made, width: int, dark: bool
) -> None:
    plots = {plot["name"]: plot for plot in ask(made.page, script("plots"), width, dark)}
    for plot in plots.values():
        print(f"{plot['name']}: {plot['marks']} marks, {plot['legend']} in the legend")
        assert plot["marks"] == plot["wanted"] > 0, plot["name"]
        assert plot["away"] == 0, plot["name"]
        assert plot["legend"] > 0
        assert plot["labels"] and all(plot["labels"])
        assert plot["away_from_data"] < 1.5, plot["name"]
        assert plot["ticks"] >= 4
        assert plot["colliding"] == []
        assert plot["outside"] == []
    data = made.document()
    timed = {c["name"]: len(c["variants"]) for c in data["contests"]}
    exact = sum(n for name, n in timed.items() if "-e" in name and name.endswith("scalar"))
    assert plots["exact-scalar"]["marks"] == exact + len(data["points"])
    question = f"ball-ball/{TARGET}/any/mathavan2014-n1000"
    assert plots["euler-scalar-N=1000"]["marks"] == timed[f"{question}-scalar"]
    assert plots["euler-batch-N=1000"]["marks"] == timed[f"{question}-batch"]
    assert plots["growth-time"]["marks"] == len(data["growth"])
    assert plots["sections"]["marks"] == len(data["sections"]) * 5
    assert {"effects-euler", "effects-exact", "growth-error"} <= set(plots)


# Machado, Oliveira and Fernandes (2009), severity 1, on linear RGB.
_BLIND = {
    "protanopia": [[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]],
    "deuteranopia": [[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]],
    "none": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
}


def _lab(colour: list[float], matrix: list[list[float]]) -> np.ndarray:
    """A colour of 0 to 255 as a reader with this vision sees it, in CIE Lab."""
    rgb = np.array(colour) / 255
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    seen = np.clip(np.array(matrix) @ linear, 0, 1)
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    xyz = (np.array(to_xyz) @ seen) / np.array([0.9505, 1.0, 1.089])
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize(("width", "dark"), SIZES)
def test_the_page_fits_and_its_colours_can_be_told_apart(
    made: Made, width: int, dark: bool
) -> None:
    found = ask(made.page, script("layout"), width, dark)
    assert (sum(found["paper"]) < 384) == dark
    assert found["wide"] == []
    assert found["scroll"] <= found["client"] + 1
    least = min(found["contrast"])
    for vision, matrix in _BLIND.items():
        seen = [_lab(colour, matrix) for colour in found["colours"]]
        pairs = itertools.combinations(range(len(seen)), 2)
        near = min((float(np.linalg.norm(seen[a] - seen[b])), a, b) for a, b in pairs)
        print(f"{vision}: the nearest two colours are {near[0]:.0f} apart in Lab: {near[1:]}")
        assert near[0] > 10, vision
    print(f"contrast: text {found['text']:.1f}, the faintest mark {least:.1f}")
    assert found["text"] > 7
    assert least > 2


def test_a_picture_can_be_taken(made: Made, tmp_path: Path) -> None:
    out = tmp_path / "page.png"
    picture(made.page, out, 1280, 900, dark=False)
    assert out.stat().st_size > 20_000


def test_the_effect_of_each_option_is_found_from_pairs(made: Made) -> None:
    with read_only(made.store.path) as store:
        effects = effects_of(contests_of(store.trials(), {}))
    checked = 0
    for effect in effects:
        wanted = EFFECTS.get(effect["code"], 1.0) / EFFECTS.get(effect["other"], 1.0)
        assert effect["ratio"] == pytest.approx(wanted), effect
        assert effect["ratio_ci"][0] <= effect["ratio"] <= effect["ratio_ci"][1]
        checked += effect["pairs"]
    print(f"{len(effects)} pairs of codes, {checked} pairs of variants")
    assert {"rsqrt", "branch", "compiler", "loop", "root"} <= {e["axis"] for e in effects}


def test_the_front_holds_no_variant_that_another_beats(made: Made) -> None:
    for contest in made.document()["contests"]:
        points = contest["variants"]
        for point in points:
            beaten = any(
                (p["ratio"], p["error"]) != (point["ratio"], point["error"])
                and p["ratio"] <= point["ratio"]
                and p["error"] <= point["error"]
                for p in points
            )
            assert not (point["front"] and beaten), point["name"]
        assert any(p["front"] for p in points)
        assert sum(p["tie"] for p in points) == 2


def test_the_trial_that_counts_is_the_newest_and_of_the_same_the_longest(made: Made) -> None:
    with read_only(made.store.path) as store:
        first = next(t for t in store.trials() if t.times and t.depends)

    def again(rung: int, **changes: str) -> Trial:
        depends = first.depends.model_copy(update={"timing": f"rung {rung}", **changes})
        return first.model_copy(update={"depends": depends, "rung": rung, "id": ""}).sealed()

    longer, shorter, other = again(2), again(1), again(0, source="changed")
    assert list(latest([first, longer, shorter]).values()) == [longer]
    assert list(latest([first, longer, other]).values()) == [other]
    found = summary_of([first, longer, other])
    assert [found[k] for k in ("trials", "variants", "longer", "outdated")] == [3, 1, 0, 2]
    found = summary_of([first, longer])
    assert (found["longer"], found["outdated"]) == (1, 0)


def known(findings: Findings, *commands: str) -> Known:
    return Known(TARGET, "any", "mathavan2014", "cpu", findings=findings, commands=commands)


def test_measurements_of_other_sources_are_named(tmp_path: Path) -> None:
    findings = make_findings(TARGET)

    def missing(sources: str) -> dict[str, str]:
        told = findings.model_copy(update={"sources": sources})
        return make_report(known(told)).missing

    assert "age" not in missing(findings.sources)
    assert "other sources of carom" in missing("changed")["age"]


@pytest.mark.parametrize(("host", "other"), [("zen4", "zen3"), ("sapphirerapids", "zen2")])
def test_times_of_another_cpu_are_not_measured_for_a_target(
    host: str, other: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    believe(monkeypatch, host)  # which runs the other's code
    page = tmp_path / "report.html"
    result = _run("report", "--target", other, "--out", page, "--measure")
    print(result.stderr)
    assert result.exit_code == 2
    assert "never the target's; expected --target native" in result.stderr
    assert not page.exists()


@pytest.mark.long
def test_what_no_sweep_keeps_is_measured(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _caches_in(tmp_path, monkeypatch)
    page = tmp_path / "report.html"
    result = _run("report", "--out", page, "--measure", "--seconds", 2)
    assert result.exit_code == 0, result.output
    document = json.loads(page.with_suffix(".json").read_text("utf-8"))
    roles = {row["role"] for row in document["chosen"]}
    assert {BASELINE, BEST, EULER, "E = 1e-06, chosen"} <= roles
    for name in ("outputs", "worst", "kinds", "growth", "operations", "sections", "calls"):
        assert document[name], name
    for row in document["operations"]:
        stated = dict(part.split()[::-1] for part in row["stated"].split(", "))
        for kind, count in row["per_step"].items():
            assert count == int(stated.get(kind, 0)), (row["role"], kind)
    exact = [row for row in document["chosen"] if row["role"].startswith("E = ")]
    assert all(row["error"] <= float(row["role"][4:9]) for row in exact)


def test_kernels_with_lanes_are_called_beside_the_scalar_one_of_their_goal(made: Made) -> None:
    measured = make_findings(TARGET)
    found = [Subject(k.role, variant_of(k.name), True) for k in measured.kernels]
    with read_only(made.store.path) as store:
        finals = last_finals(store.finals(), TARGET, "any", "mathavan2014")
    lanes = make_variant(TARGET, "any", "mathavan2014", Stepper("dp54", budget=1e-6), 4)
    called = calls(found, finals, [lanes])
    by_role = {
        s.role: [(c.variant.width, c.batch) for c in called if c.role == s.role] for s in found
    }
    print(by_role)
    assert by_role["E = 1e-06, chosen"] == [(1, False), (1, True), (4, True)]
    assert by_role["E = 1e-03, chosen"] == [(1, False), (1, True)]
    assert by_role[BASELINE] == [(1, False), (1, True)]
    assert by_role[EULER][2:] == [(finals_width(finals), True)]
    assert by_role[BEST] == []


def finals_width(finals: dict[str, Final]) -> int:
    final = next(f for name, f in finals.items() if name.endswith("n1000-batch"))
    return next(
        f.subject.asked.width.lanes for f in final.finalists if f.subject.name == final.chosen
    )


def test_the_runs_of_the_sweep_are_named_with_their_compilers(made: Made) -> None:
    document = made.document()
    print(document["commands"], document["machine"]["compilers"])
    assert document["commands"][0] == "./gen sweep --minutes 19"
    last = f"./gen report --target {TARGET} --store {made.store.path} --out report.html"
    assert document["commands"][-1] == last
    assert document["sweep"]["commands"] == ["./gen sweep --minutes 19"]
    assert document["machine"]["seeds"]["sweep"] == 1
    with read_only(made.store.path) as store:
        assert {t.run for t in store.trials()} == {run.id for run in store.runs()}


def test_the_tie_band_lies_about_the_mark_of_the_fastest(made: Made) -> None:
    """A final's ratios are of another time: the same kernel's mark may lie elsewhere."""
    with read_only(made.store.path) as store:
        [first, *_] = store.finals()
        trials = [t for t in store.trials() if t.subject.contest == first.contest]
    slower = [
        row.model_copy(update={"times": row.times.model_copy(update={"ratio": 9.0})})
        for row in first.finalists
    ]
    final = first.model_copy(update={"finalists": tuple(slower)})
    [contest] = contests_of(trials, {first.contest: final})
    mark = next(v for v in contest.variants if v.name == final.fastest)
    assert contest.band == tuple(mark.ratio * end for end in final.control)


def test_a_front_takes_no_step_for_the_last_digits_of_an_error(made: Made) -> None:
    with read_only(made.store.path) as store:
        first = next(t for t in store.trials() if t.times and t.errors)

    def like(name: str, ratio: float, error: float) -> Trial:
        return first.model_copy(
            update={
                "subject": first.subject.model_copy(update={"recipe": f"fixed {name}"}),
                "times": first.times.model_copy(update={"ratio": ratio}),
                "errors": first.errors.model_copy(update={"max_rel_error": error}),
            }
        )

    rows = [like("a", 0.5, 1e-6), like("b", 0.6, 0.999e-6), like("c", 0.7, 0.5e-6)]
    [contest] = contests_of(rows, {})
    assert {v.name[-1]: v.front for v in contest.variants} == {"a": True, "b": False, "c": True}


def test_marks_of_equal_kernels_do_not_hide_each_other(made: Made) -> None:
    marks = [Mark(1e-6, 0.5 + 1e-4 * n, "o", 0, str(n), "", front=n == 3) for n in range(11)]
    point = 0.001  # decades
    moved = side_by_side(marks, (1e-7, 1e-5), point, point)
    places = [np.log10([mark.x, mark.y]) / point / SIDE for mark in moved]
    apart = min(float(abs(a - b).max()) for a, b in itertools.combinations(places, 2))
    print(f"{len(places)} marks, the nearest two are {apart:.2f} of a mark apart")
    assert apart >= 1 - 1e-9
    assert next(mark.x for mark in moved if mark.text == "3") == 1e-6  # of the front
    assert max(abs(np.log10(mark.x / 1e-6)) for mark in moved) <= ASIDE
    wide = side_by_side(
        marks, (1e-7, 1e-5), 0.2 / SIDE, point
    )  # where a mark is as wide as 0.2 decades
    assert {mark.x for mark in wide} == {1e-6}


def test_each_option_has_a_row_even_if_none_was_timed_with_the_default(made: Made) -> None:
    def effect(code: str, other: str, pairs: int) -> Effect:
        return {"axis": "rsqrt", "code": code, "other": other, "pairs": pairs}

    rows = [effect("est1", "inv", 8), effect("ahead", "inv", 3), effect("ahead", "est1", 6)]
    shown = [(e["code"], e["other"]) for e in one_each(rows)]
    assert shown == [("est1", "inv"), ("ahead", "est1")]
    rows.append(effect("ahead", "div", 1))  # the axis' default
    assert [(e["code"], e["other"]) for e in one_each(rows)] == [("est1", "inv"), ("ahead", "div")]


def test_rejections_are_counted_by_reason(made: Made) -> None:
    assert made.document()["sweep"]["rejected"] == {"wrong result": made.store.rejected}


def test_the_report_s_own_figures_stand_beside_ours_and_none_is_invented(made: Made) -> None:
    rows = {row["preset"]: row for row in made.document()["published"] if row["preset"]}
    assert {p.name: p.report_cycles for p in PAPER_PRESETS} == {
        name: row["their_cycles"] for name, row in rows.items()
    }
    assert made.document()["published"][0]["their_cycles"] == NUMBA_CYCLES
    assert all(row["their_cycles"] or row["note"] for row in rows.values())
    assert rows["paper-initial"]["our_ratio"] == 1
    assert rows["paper-simd"]["our_cycles"] is None  # was not measured
    assert "not measured" in rows["paper-simd"]["note"]


def test_hexadecimal_floats_of_the_page_are_read_back_to_the_bit(made: Made) -> None:
    worst = made.document()["worst"][0]
    header, row = worst["commands"][0].split()[2:4]
    path = made.page.parent / "worst.csv"
    # R and M of the made-up case would be out of a table's range: the reference's are not.
    numbers = load_reference().cases[17]
    row = ",".join(("worst", *(float(x).hex() for x in numbers)))
    path.write_text(f"{header}\n{row}\n", encoding="utf-8")
    assert header == ",".join(("id", *CASE_NAMES))
    assert (read_cases(path).rows[0] == numbers).all()
    assert "./gen collide --cases worst.csv" in worst["commands"][1]


def test_what_is_not_known_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _caches_in(tmp_path, monkeypatch)
    page = tmp_path / "report.html"
    nothing = _run("report", "--target", TARGET, "--out", page)
    assert nothing.exit_code == 2
    assert "./gen sweep --target zen3" in nothing.stderr
    assert not page.exists()
    write_findings(findings_path(tmp_path, TARGET, "any", "mathavan2014"), make_findings(TARGET))
    assert _run("report", "--target", TARGET, "--out", page).exit_code == 0
    text = page.read_text("utf-8")
    assert "Not known: no sweep is stored for it: ./gen sweep" in text
    store = make_store(tmp_path / "sweep.sqlite", TARGET, 60)
    findings_path(tmp_path, TARGET, "any", "mathavan2014").unlink()
    assert _run("report", "--target", TARGET, "--out", page).exit_code == 0
    text = page.read_text("utf-8")
    page_text = text.partition('<script type="application/json"')[0]
    assert page_text.count("Not known: not measured yet: ./gen report --measure") == 1
    assert "Sections of the kernel" in page_text
    assert page_text.count("<section ") == 7
    assert store.trials > 60


def test_a_broken_file_of_measurements_is_named(tmp_path: Path) -> None:
    path = tmp_path / "m.json"
    document = json.loads(make_findings(TARGET).model_dump_json())
    document["kernels"][0]["role"] = 7
    path.write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(Exception, match=r"m\.json: kernels\.0\.role"):
        read_findings(path)
    write_findings(path, make_findings(TARGET))
    assert read_findings(path) == make_findings(TARGET)


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("--out", "report.pdf"), "expected the name of an HTML file"),
        (("--out", "no/such/report.html"), "there is no folder"),
        (("--out", "report.html", "--scene", "moon"), "no such scene"),
        (("--out", "report.html", "--store", "none.sqlite"), "no store of a sweep"),
    ],
)
def test_wrong_use_is_one_line_and_writes_nothing(
    arguments: tuple[str, ...], parts: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = _run("report", *arguments)
    print(result.stderr)
    assert result.exit_code == 2
    assert parts in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_kernels_with_markup_in_their_text_do_not_break_the_page() -> None:
    findings = make_findings(TARGET)
    kernels = (findings.kernels[0].model_copy(update={"missing": {"x": "</script><b>&"}}),)
    told = known(findings.model_copy(update={"kernels": kernels}), "<b>")
    report = make_report(told)
    text = render(report.document, report.plots)
    assert "</script><b>" not in text
    assert text.count("</script>") == 1


def test_kinds_are_found_from_the_labels_of_cases() -> None:
    kinds = kinds_of(("reference 3 (seed_case_1)", "reference 4 (seed_case_2)", "random 0 (flip)"))
    assert {kind: list(rows) for kind, rows in kinds.items()} == {"seed_case": [0, 1], "flip": [2]}
