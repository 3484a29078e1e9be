"""A vendored folder of two impacts: one header, one dispatcher, a self-test each."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from generator.cli.main import gen
from generator.impacts.registry import IMPACTS
from generator.registry.question import Goal
from generator.vendoring.job import compare
from generator.vendoring.kernels import Places
from generator.vendoring.manifest import FILE, read_manifest
from tests.support.kernels import ROOT
from tests.support.vendored import (
    PAIRS,
    STRICT,
    compiled,
    files_for,
    ran,
    request_for,
    tools_for,
    vendored,
)

BOTH = ",".join(impact.name for impact in IMPACTS)
TARGETS = "zen3,x86-64-v2"
PROGRAMS = ROOT / "tests" / "vendor"
SELFTESTS = ("carom_selftest", "carom_cushion_selftest")


def refusal(tmp_path: Path, *arguments: str) -> str:
    words = ["vendor", "--target", "x86-64-v2", "--out", str(tmp_path / "out"), *arguments]
    result = CliRunner().invoke(gen, words)
    print(result.stderr)
    assert result.exit_code == 2 and len(result.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []
    return result.stderr


def test_names_that_cannot_be_are_refused_in_one_line(tmp_path) -> None:
    assert "ball-ball twice" in refusal(tmp_path, "--impact", "ball-ball,ball-ball")
    assert "there are ball-ball" in refusal(tmp_path, "--impact", "ball-ball,moon")
    both = ("--impact", BOTH)
    assert "--model mathavan2014" in refusal(tmp_path, *both, "--model", "mathavan2014")
    assert "3 models; expected one" in refusal(tmp_path, *both, "--model", "a,b,c")
    assert "no such scene" in refusal(tmp_path, *both, "--scene", "arcade")


def test_one_name_of_a_model_is_that_of_all_and_each_may_have_its_own() -> None:
    steps = Goal(steps=1000)
    assert request_for(TARGETS, steps, impact=BOTH, model="pooltool").model == "pooltool,pooltool"
    request = request_for(TARGETS, impact=BOTH)
    print(request.command)
    assert f"--impact {BOTH} " in request.command and request.model == "mathavan2014,clamped"
    own = request_for(TARGETS, impact="ball-cushion,ball-ball", model="printed,bottom_slip")
    assert [part.model for part in own.parts] == ["printed", "bottom_slip"]


@pytest.mark.skipif(not PAIRS, reason="no C and C++ compiler of one make")
@pytest.mark.parametrize("pair", PAIRS, ids=[cxx for cxx, _ in PAIRS])
def test_a_folder_of_two_impacts_builds_alone_in_c_and_cpp_and_passes_its_tests(
    pair, tmp_path
) -> None:
    cxx, cc = pair
    made = vendored(tmp_path / "made", request_for(TARGETS, impact=BOTH), lanes=True)
    folder = Path(shutil.copytree(made, tmp_path / "alone"))
    objects = compiled(folder, tmp_path / "objects", cxx, "-O1")
    programs = [folder / f"{name}.c" for name in SELFTESTS]
    for source in (*programs, PROGRAMS / "cushion.c", PROGRAMS / "cushion.cpp"):
        compiler, standard = (cc, "c99") if source.suffix == ".c" else (cxx, "c++17")
        test = tmp_path / f"{source.stem}{source.suffix[1:]}"
        words = [compiler, f"-std={standard}", *STRICT, f"-I{folder}", source]
        ran([*words, *objects, "-lm", "-o", test])
        told = ran([test]).stdout
        print(told)
        assert " 0 failures" in told or "\n0 failures" in told
        if source.stem in SELFTESTS:
            assert "2 kernels run" in told


@pytest.mark.skipif(not PAIRS, reason="no C and C++ compiler of one make")
def test_one_header_holds_both_and_each_self_test_its_implementation(tmp_path) -> None:
    request = request_for("x86-64-v2", impact=BOTH, single_header=True)
    made = vendored(tmp_path / "made", request)
    for name in SELFTESTS:
        test = tmp_path / name
        ran([PAIRS[0][0], "-std=c++17", *STRICT, made / f"{name}.cpp", "-lm", "-o", test])
        assert "0 failures" in ran([test]).stdout


@pytest.mark.skipif(shutil.which("cmake") is None, reason="no cmake")
def test_cmake_builds_it_and_ctest_runs_both_self_tests(tmp_path) -> None:
    made = vendored(tmp_path / "made", request_for("x86-64-v2", impact=BOTH))
    ran(["cmake", "-S", made, "-B", tmp_path / "build", "-DCMAKE_BUILD_TYPE=Debug"])
    ran(["cmake", "--build", tmp_path / "build"])
    told = ran(["ctest", "--test-dir", tmp_path / "build"]).stdout
    print(told)
    assert "tests failed out of 2" in told and "100% tests passed" in told


def test_the_cushion_alone_has_its_own_names_and_statuses() -> None:
    files = files_for(request_for("x86-64-v2", impact="ball-cushion"))
    header = files["carom.h"]
    assert "carom_cushion_collide(" in header and "carom_collide(" not in header
    assert "CAROM_BAD_INPUT" in header and "CAROM_TILTED" not in header
    assert {"carom_cushion_x86_64_v2.cpp", "carom_cushion_selftest.c"} <= set(files)


def test_the_manifest_holds_both_and_verify_remakes_it(tmp_path) -> None:
    request = request_for(TARGETS, impact=BOTH)
    made = vendored(tmp_path / "made", request)
    document = json.loads((made / FILE).read_text("utf-8"))
    assert document["options"]["impact"] == BOTH
    assert document["error"]["of"].count("|v") == len(IMPACTS)
    assert len(document["kernels"]) == 2 * len(IMPACTS)
    assert read_manifest(made).request() == request
    nowhere = Places(tmp_path / "generated", tmp_path / "selections")
    found = compare(made, nowhere, tools_for(request))
    assert found.unchanged, found
