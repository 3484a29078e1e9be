"""What looks at the CPU, on CPUs of several makers and generations, whatever this machine is."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from generator.api.session import resolve_target
from generator.choice.lookup import require_runs
from generator.cli.main import gen
from generator.errors import KernelError
from generator.targets.host import read_host
from generator.targets.target import find_target, targets
from tests.support.hosts import believe, names

# Of each machine: its target, and is that this very CPU?
TARGETS = {
    "nehalem": ("x86-64-v2", False),
    "haswell": ("x86-64-v3", False),
    "skylake-avx512": ("skylake-avx512", True),
    "sapphirerapids": ("sapphirerapids", True),
    "zen3": ("zen3", True),
    "zen4": ("zen4", True),
    "unknown": ("x86-64-v3", False),  # of a maker that no row has
    "neoverse-n1": ("armv8", False),
}
X86 = [name for name in TARGETS if name != "neoverse-n1"]


def call(*arguments: object) -> Result:
    return CliRunner().invoke(gen, [str(a) for a in arguments])


def test_every_machine_of_the_data_is_tried() -> None:
    assert sorted(TARGETS) == names()


@pytest.mark.parametrize("name", TARGETS)
def test_native_is_the_cpu_or_its_nearest_ancestor(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    believe(monkeypatch, name)
    host = read_host()
    print(f"{host.cpu}: {host.target.name}, {'exact' if host.exact else 'its nearest ancestor'}")
    assert (host.target.name, host.exact) == TARGETS[name]
    assert resolve_target("native")[0] == host.target
    assert host.runs(host.target) and host.target.features <= host.features


@pytest.mark.parametrize("name", TARGETS)
def test_a_machine_runs_what_it_has_the_instructions_of(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    believe(monkeypatch, name)
    host = read_host()
    runs = {target for target in targets() if host.runs(find_target(target))}
    print(f"{name} runs {sorted(runs)}")
    assert runs >= {host.target.name, *host.target.ancestors}
    for target in set(targets()) - runs:
        with pytest.raises(KernelError, match=f"{target} code cannot run here: this CPU lacks"):
            require_runs(host, find_target(target))


INPUTS = Path(__file__).parents[1] / "data" / "reference" / "inputs.csv"
COMMANDS = {
    "bench": ("--json", "x.json"),
    "collide": ("--cases", INPUTS, "--out", "x.csv"),
    "plot": ("--out", "x.svg"),
    "list": ("scenes", "--cost"),
}


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(("name", "lacks"), [("nehalem", "avx2"), ("haswell", ""), ("zen3", "")])
def test_what_cannot_run_is_refused_before_any_work(
    command: str, name: str, lacks: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Exit 1 in one line, and nothing written: the CPU is at fault, not the command."""
    believe(monkeypatch, name)
    monkeypatch.chdir(tmp_path)
    target = "zen3" if lacks else "zen5"
    result = call(command, *COMMANDS[command], "--target", target)
    print(result.stderr)
    assert result.exit_code == 1
    lines = result.stderr.splitlines()
    assert len(lines) == 1 and f"{target} code cannot run here: this CPU lacks" in lines[0]
    assert (lacks or "avx512f") in lines[0]
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["zen4", "sapphirerapids"])
def test_a_bench_of_what_was_not_generated_names_the_command(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Exit 2: these machines could run it."""
    believe(monkeypatch, name)
    result = call("bench", "--target", "zen5", "--json", "x.json")
    assert result.exit_code == 2
    assert "nothing generated; run ./gen --target zen5 --scene any" in result.stderr


@pytest.mark.parametrize("name", X86)
def test_the_list_of_targets_says_what_is_tested_here(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    believe(monkeypatch, name)
    monkeypatch.setenv("COLUMNS", "200")
    rows = {}
    told = call("list", "targets").stdout
    for line in told.splitlines():
        fields = re.split(r"\s{2,}", line.strip())
        if fields[0] in targets():
            rows[fields[0]] = fields[-1]
    host = read_host()
    print(name, rows)
    assert [target for target, tested in rows.items() if tested == "timed"] == [host.target.name]
    others = {target for target in targets() if host.runs(find_target(target))} - {host.target.name}
    assert {target for target, tested in rows.items() if tested == "run"} == others
    assert ("is not known: native is its nearest ancestor" in " ".join(told.split())) != host.exact
