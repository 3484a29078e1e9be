"""`vendor --reproducible`: the same bits on every CPU that has the instructions."""

import json
import re
import shutil
import subprocess

import numpy as np
import pytest

from generator.choice.candidates import batch_candidates
from generator.emission.kernel_source import emit
from generator.errors import InputError
from generator.impacts.ball_ball.scene import parse_scene
from generator.lowering.isa import estimates_in
from generator.registry.question import DEFAULT_IMPACT, Goal, find_impact
from generator.registry.roots import is_reproducible
from generator.targets.target import find_target, targets
from generator.vendoring.job import compare
from generator.vendoring.kernels import Places
from tests.support.contests import exact_candidates
from tests.support.kernels import bench_tool
from tests.support.reference import load_reference
from tests.support.vendored import EXACT, PAIRS, compiled, ran, request_for, vendored

# Of three makers' kinds; both have AVX2 and FMA, and cpuid tells them apart.
CPUS = ("Haswell", "EPYC")
PROGRAM = """
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "carom.h"
int main(int argc, char** argv) {
  const size_t n = (size_t)atoi(argv[3]);
  double* rows = (double*)malloc(n * 24 * sizeof(double));
  double* out = (double*)calloc(n * 24, sizeof(double));
  double* soa = (double*)calloc(n * 31, sizeof(double));
  FILE* file = fopen(argv[1], "rb");
  if (argc != 4 || fread(rows, 192, n, file) != n) return 1;
  fclose(file);
  const double* in[18];
  double* batch[12];
  for (size_t k = 0; k < 18; ++k) in[k] = soa + k * n;
  for (size_t k = 0; k < 12; ++k) batch[k] = soa + (18 + k) * n;
  for (size_t i = 0; i < n; ++i) {
    carom_params p;
    memcpy(&p, rows + 24 * i, sizeof p);
    const double* b = rows + 24 * i + 6;
    carom_collide(&p, b, b + 9, out + 24 * i, out + 24 * i + 9);
    for (size_t k = 0; k < 18; ++k) soa[k * n + i] = b[k];
    soa[30 * n + i] = p.u_b;
  }
  carom_params p;
  memcpy(&p, rows, sizeof p);
  carom_collide_batch(&p, soa + 30 * n, n, in, batch, NULL);
  file = fopen(argv[2], "wb");
  fwrite(out, 192, n, file);
  fwrite(batch[0], 96, n, file);
  fclose(file);
  return 0;
}
"""


def _program(folder, into, pair):
    cxx, cc = pair
    objects = compiled(folder, into, cxx, "-O3" if cxx == "g++" else "-O1")
    (into / "main.c").write_text(PROGRAM)
    ran([cc, "-std=c99", f"-I{folder}", "-c", into / "main.c", "-o", into / "main.o"])
    ran([cxx, *objects, into / "main.o", "-lm", "-o", into / "run"])
    return into / "run"


@pytest.mark.skipif(shutil.which("qemu-x86_64") is None, reason="no qemu-x86_64")
@pytest.mark.parametrize("goal", [EXACT, Goal(steps=100)], ids=["exact", "steps"])
def test_two_makers_cpus_and_two_compilers_give_the_same_bits(goal, tmp_path):
    """All reference cases, calls and a batch; nor is an instruction there that could differ."""
    request = request_for("x86-64-v3", goal, reproducible=True)
    folder = vendored(tmp_path / "carom", request, lanes=True)
    rows = load_reference().cases
    rows.tofile(tmp_path / "rows")
    outcomes = {}
    for pair in PAIRS:
        run = _program(folder, tmp_path / pair[0], pair)
        code = ran(["objdump", "-d", "--no-show-raw-insn", run]).stdout
        shaky = re.findall(r"\bv?(?:rsqrt|rcp)\w*", code)
        assert not shaky, shaky[:3]
        assert "vfmadd" in code and "vsqrt" in code
        for cpu in CPUS:
            out = tmp_path / f"{pair[0]}-{cpu}"
            ran(["qemu-x86_64", "-cpu", cpu, run, tmp_path / "rows", out, len(rows)])
            outcomes[out.name] = out.read_bytes()
    first = next(iter(outcomes.values()))
    values = np.frombuffer(first)
    print(f"{list(outcomes)}: {len(first)} bytes each, {len(set(outcomes.values()))} different")
    assert len(values) == len(rows) * 36 and np.isfinite(values).all()
    assert np.count_nonzero(values[: 24 * len(rows)]) > 4 * len(rows)
    assert np.count_nonzero(values[24 * len(rows) :]) > 4 * len(rows)
    assert set(outcomes.values()) == {first}


def test_candidates_have_no_estimate_in_calls_nor_in_batches():
    for name in ("x86-64-v2", "x86-64-v4"):
        target = find_target(name)
        singles = exact_candidates(target, "any", "mathavan2014", 1e-6, ["gcc"], reproducible=True)
        batches = batch_candidates(singles[0], target, ["gcc"], reproducible=True)
        assert singles and batches
        assert all(is_reproducible(v) for v in (*singles, *batches))
        for variant in (singles[0], batches[0], batches[-1]):
            assert not estimates_in(emit(variant).source)
        usual = exact_candidates(target, "any", "mathavan2014", 1e-6, ["gcc"])
        assert usual and not any(is_reproducible(v) for v in usual)
        print(f"{name}: {len(singles)} single, {len(batches)} batches, none with an estimate")


def test_the_manifest_says_so_and_verify_finds_it_unchanged(tmp_path):
    request = request_for("x86-64-v3", reproducible=True)
    folder = vendored(tmp_path / "carom", request, lanes=True)
    document = json.loads((folder / "manifest.json").read_text())
    assert document["options"]["reproducible"] is True
    assert "--reproducible" in document["command"]
    places = Places(tmp_path / "generated", tmp_path / "cache")
    found = compare(folder, places, {DEFAULT_IMPACT: bench_tool()})
    assert found.unchanged, found
    usual = vendored(tmp_path / "usual", request_for("x86-64-v3"))
    assert "reproducible" not in (usual / "manifest.json").read_text()


def test_what_cannot_be_reproducible_is_refused_in_a_line(monkeypatch):
    with pytest.raises(InputError, match="round differently; expected one target") as refused:
        request_for("x86-64-v2,x86-64-v3", reproducible=True)
    assert "\n" not in str(refused.value)
    mixed = f"x86-64-v3,{next(t.name for t in targets().values() if t.has('neon'))}"
    assert request_for(mixed, reproducible=True).reproducible
    law = parse_scene('name = "law"\ntext = "x"\nfriction_law = "alciatore"\n', "law.toml")
    monkeypatch.setattr(type(find_impact(DEFAULT_IMPACT)), "find_scene", lambda *_: law)
    with pytest.raises(InputError, match="scene law makes u_b by the C library's exp"):
        request_for("x86-64-v3", reproducible=True)


def test_the_command_takes_the_option(tmp_path):
    words = ["./gen", "vendor", "--target", "x86-64-v2,zen3", "--reproducible", "--out", tmp_path]
    from generator.evidence.timing.bench_tool import ROOT

    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2 and "round differently" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
