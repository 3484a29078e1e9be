"""The examples, built and run as their README says, in copies with a vendored folder inside."""

from __future__ import annotations

import re
import shutil
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from generator import __version__
from tests.support.kernels import ROOT, bench_tool
from tests.support.vendored import PAIRS, STRICT, ran, request_for, vendored

pytestmark = pytest.mark.skipif(not PAIRS, reason="no C and C++ compiler of one make")
EXAMPLES = ROOT / "examples"
FLAGS = " ".join(STRICT)
ANSWER = "the object ball leaves with 0.4558 1.2852 m/s"


def configured(source: Path, build: Path, *options: object) -> Path:
    """A CMake project, configured and built with warnings as errors."""
    flags = (f"-DCMAKE_CXX_FLAGS={FLAGS}", f"-DCMAKE_C_FLAGS={FLAGS}")
    ran(["cmake", "-S", source, "-B", build, "-G", "Ninja", *flags, *options])
    ran(["cmake", "--build", build])
    return build


def example(name: str, targets: str, folder: Path) -> Path:
    """An example with its kernel inside, in a place of its own; the folder of what was built."""
    source = Path(shutil.copytree(EXAMPLES / name, folder / name))
    vendored(source / "carom", request_for(targets))
    return configured(source, folder / "build")


def test_add_subdirectory_takes_five_lines_of_cmake(tmp_path) -> None:
    name = "cpp_add_subdirectory"
    lines = (EXAMPLES / name / "CMakeLists.txt").read_text("utf-8").splitlines()
    told = ran([example(name, "zen3,x86-64-v2", tmp_path) / "app"]).stdout
    print(f"{len(lines)} lines of CMake\n{told}")
    assert len(lines) <= 5
    assert ANSWER in told


def test_installed_it_serves_find_package_and_pkg_config(tmp_path) -> None:
    """Installed, then the installed tree moved: C, C++, and a compiler called by hand."""
    made = vendored(tmp_path / "carom", request_for("zen3,x86-64-v2"))
    build = configured(made, tmp_path / "build")
    assert "100% tests passed" in ran(["ctest", "--test-dir", build]).stdout
    ran(["cmake", "--install", build, "--prefix", tmp_path / "first"])
    place = (tmp_path / "first").rename(tmp_path / "place")
    for name in ("c_find_package", "cpp_find_package"):
        app = configured(EXAMPLES / name, tmp_path / name, f"-DCMAKE_PREFIX_PATH={place}") / "app"
        assert ANSWER in ran([app]).stdout
    found = next(place.rglob("carom.pc"))
    environment = {"PKG_CONFIG_PATH": str(found.parent)}
    flags = ran(["pkg-config", "--cflags", "--libs", "carom"], env=environment).stdout.split()
    version = ran(["pkg-config", "--modversion", "carom"], env=environment).stdout.strip()
    print(f"carom {version}: {' '.join(flags)}")
    assert version == __version__
    main = EXAMPLES / "c_find_package" / "main.c"
    ran([PAIRS[0][1], "-std=c99", *STRICT, main, *flags, "-o", tmp_path / "by_hand"])
    assert ANSWER in ran([tmp_path / "by_hand"]).stdout


def test_throw_map_draws_what_the_exact_solver_says(tmp_path) -> None:
    """A picture of 2400 collisions; its largest throw against the oracle."""
    build = example("throw_map", "x86-64-v2", tmp_path)
    told = ran([build / "throw_map", tmp_path / "map.svg"]).stdout
    print(told)
    root = ET.parse(tmp_path / "map.svg").getroot()
    assert len(root.findall("{http://www.w3.org/2000/svg}rect")) >= 2400
    match = re.search(
        r"most throw: ([\d.]+) degrees at a cut of ([\d.]+) degrees and ([\d.]+)", told
    )
    assert match is not None
    throw, cut, speed = float(match[1]), np.radians(float(match[2])), float(match[3])
    case = np.zeros((1, 24))
    u_b = 9.951e-3 + 0.108 * np.exp(-1.088 * speed * np.sin(cut))
    case[0, :6] = 0.028575, 0.17, 0.2, 0.2, u_b, 0.95
    case[0, 9:11] = speed * np.sin(cut), speed * np.cos(cut)
    case[0, 16] = 0.05715
    want = bench_tool().expect(case, "exact", "mathavan2014")[0]
    expected = np.degrees(np.arctan2(want[6], want[7]))
    print(f"the oracle: {expected:.3f} degrees")
    assert abs(throw - expected) < 0.006


def test_monte_carlo_of_a_million_shows_its_progress(tmp_path) -> None:
    build = example("monte_carlo", "x86-64-v2", tmp_path)
    potted = {}
    for degrees in ("0.3", "0.05"):
        done = ran([build / "monte_carlo", 1_000_000 if degrees == "0.3" else 50_000, degrees])
        print(done.stdout)
        potted[degrees] = float(re.search(r"potted: ([\d.]+) %", done.stdout)[1])
        if degrees == "0.3":
            assert "1000000 of 1000000" in done.stderr
            assert done.stderr.count(" of 1000000") == 100
    assert potted["0.3"] == pytest.approx(28.9, abs=0.3)  # 1 % of it, six standard errors
    assert potted["0.05"] > 90
