"""Sweeps on a Dask cluster: workers that announce their CPU, some of them wrongly, some dying."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from threading import Timer

import pytest

pytest.importorskip("distributed", reason="the extra `cluster` is not installed")

from click.testing import CliRunner
from distributed import Client, Future, LocalCluster

from generator.choice.workbench import Workbench
from generator.cli.main import gen
from generator.errors import InputError
from generator.evidence.timing.bench_tool import build_bench_tool
from generator.places import cache_folder
from generator.registry.question import Contest, Goal
from generator.sweep.cluster import BUILD_SHARE, ClusterLab
from generator.sweep.store import opened
from generator.sweep.worker import resource_of
from generator.targets.host import read_host
from generator.toolchain.compilers import find_compilers
from tests.support.cluster_worker import told
from tests.support.kernels import ROOT
from tests.support.sweep_lab import ZEN3, plan, swept

CONTEST = Contest("ball-ball", "zen3", "any", "pooltool", Goal(steps=100), "scalar")
FEW = {
    "state": ("reduced",),
    "store": ("named",),
    "reuse": ("factored",),
    "order": ("paper",),
    "rsqrt": ("inv", "est1", "ahead"),
    "fma": ("fma",),
    "roots": ("early",),
    "loop": ("twostage",),
    "simd": ("scalar",),
    "compiler": ("gcc",),
    "flags": ("strict",),
}
ASKED = plan(CONTEST, only=FEW, exhaustive=True)


@dataclass
class Pool:
    """A scheduler, and workers as processes that a test may kill."""

    client: Client
    folder: Path
    started: list[subprocess.Popen[bytes]]

    def worker(self, name: str, announces: str, is_really: str) -> subprocess.Popen[bytes]:
        """One whose environment says what CPU it is; back when the scheduler knows it."""
        command = [sys.executable, "-P", "-m", "dask", "worker", self.address]
        options = ["--no-nanny", "--nthreads", "2", "--no-dashboard", "--name", name]
        process = subprocess.Popen(
            [*command, *options, "--resources", f"{resource_of(announces)}=1"],
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env={
                **os.environ,
                "PYTHONPATH": str(ROOT),
                "CAROM_CACHE": str(cache_folder()),
                "CAROM_TEST_CPU": is_really,
                "CAROM_TEST_LOG": str(self.log(name)),
            },
        )
        self.started.append(process)
        end = time.monotonic() + 600
        while name not in self.names() and time.monotonic() < end:
            time.sleep(0.1)
        assert name in self.names(), "the worker did not appear"
        return process

    @property
    def address(self) -> str:
        return self.client.scheduler.address  # type: ignore[union-attr, no-any-return]

    def names(self) -> set[str]:
        workers = self.client.scheduler_info()["workers"].values()
        return {str(worker["name"]) for worker in workers}

    def log(self, name: str) -> Path:
        return self.folder / f"{name}.log"

    def asked(self, name: str) -> int:
        """How often a worker was asked what it is: at first, and before every job."""
        log = self.log(name)
        return len(log.read_text("utf-8").splitlines()) if log.exists() else 0


@pytest.fixture
def pool(tmp_path: Path) -> Iterator[Pool]:
    with (
        LocalCluster(n_workers=0, dashboard_address=None, silence_logs=50) as cluster,
        Client(cluster) as client,
    ):
        made = Pool(client, tmp_path, [])
        try:
            yield made
        finally:
            for process in made.started:
                process.kill()
                process.wait()


def lab(pool: Pool, patience: float = 30.0) -> ClusterLab:
    folder, compilers = cache_folder(), {c.code: c for c in find_compilers()}
    bench = Workbench(build_bench_tool(folder), folder, compilers)
    return ClusterLab(pool.client, bench, ZEN3, patience, told)


def tried(path: Path) -> Counter[str]:
    with opened(path) as store:
        lowest = [t for t in store.trials() if t.rung == 0 and t.depends is not None]
    return Counter(t.subject.options["rsqrt"] for t in lowest)


def test_jobs_go_only_to_workers_whose_cpu_is_the_target(pool: Pool) -> None:
    pool.worker("amd", announces="zen3", is_really="zen3")
    pool.worker("intel", announces="sapphirerapids", is_really="sapphirerapids")
    path = pool.folder / "s.sqlite"
    with opened(path) as store:
        [outcome], ledger = swept(store, lab(pool), ASKED)  # type: ignore[arg-type]
    print(f"{ledger.made} trials; asked: amd {pool.asked('amd')}, intel {pool.asked('intel')}")
    assert tried(path) == Counter(FEW["rsqrt"])
    assert outcome.final is not None and outcome.final.chosen.startswith("ball-ball/zen3/")
    assert pool.asked("intel") == 0 and pool.asked("amd") > len(FEW["rsqrt"])


def test_a_worker_that_claims_a_cpu_it_is_not_gets_no_job_and_is_named(pool: Pool) -> None:
    pool.worker("liar", announces="zen3", is_really="zen5")
    with pytest.raises(InputError) as caught:
        lab(pool, patience=1.0)
    print(caught.value)
    assert "worker liar announces cpu-zen3 and is" in str(caught.value)
    assert "(zen5)" in str(caught.value) and pool.asked("liar") == 1
    pool.worker("honest", announces="zen3", is_really="zen3")
    with opened(pool.folder / "s.sqlite") as store:
        used = lab(pool)
        swept(store, used, ASKED)  # type: ignore[arg-type]
    assert list(used.jobs) == [a for a in used.jobs if a not in used.refused] != []
    assert pool.asked("liar") <= 3 < pool.asked("honest")


def test_a_cpu_that_no_worker_has_is_named_after_the_time_out(pool: Pool) -> None:
    pool.worker("intel", announces="sapphirerapids", is_really="sapphirerapids")
    start = time.monotonic()
    with pytest.raises(InputError) as caught:
        lab(pool, patience=1.5)
    spent = time.monotonic() - start
    print(f"after {spent:.1f} s: {caught.value}")
    assert "no worker for zen3 in 1.5 s; workers announce cpu-sapphirerapids" in str(caught.value)
    assert spent >= 1.5


def test_losing_workers_in_mid_job_loses_nothing(pool: Pool) -> None:
    """The first is killed while it has a job, and the next one starts when there is none."""
    first = pool.worker("first", announces="zen3", is_really="zen3")
    used, path = lab(pool, patience=60.0), pool.folder / "s.sqlite"
    killer = Timer(1.0, first.send_signal, [signal.SIGKILL])
    heir = Timer(2.0, pool.worker, ["heir", "zen3", "zen3"])
    with opened(path) as store:
        killer.start()
        heir.start()
        [outcome], _ = swept(store, used, ASKED)  # type: ignore[arg-type]
    heir.join()
    print(f"jobs by worker: {used.jobs}; asked: {pool.asked('first')}, {pool.asked('heir')}")
    assert first.poll() is not None and pool.asked("heir") > 0
    assert tried(path) == Counter(FEW["rsqrt"]) and outcome.final is not None


def test_workers_that_are_all_lost_end_a_sweep_that_keeps_what_it_has(pool: Pool) -> None:
    only = pool.worker("only", announces="zen3", is_really="zen3")
    used, path = lab(pool, patience=2.0), pool.folder / "s.sqlite"
    with opened(path) as store:
        pass
    with opened(path) as store, pytest.raises(InputError, match="no worker for zen3 in 2 s"):
        Timer(1.0, only.send_signal, [signal.SIGKILL]).start()
        swept(store, used, ASKED)  # type: ignore[arg-type]
    pool.worker("next", announces="zen3", is_really="zen3")
    with opened(path) as store:
        swept(store, lab(pool), ASKED)  # type: ignore[arg-type]
    assert tried(path) == Counter(FEW["rsqrt"])


def test_a_result_that_does_not_come_is_waited_for_again(
    pool: Pool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A worker may be lost between its job's end and the fetching of what it made."""
    pool.worker("only", announces="zen3", is_really="zen3")
    used, path, late = lab(pool), pool.folder / "s.sqlite", iter([True, True])
    fetch = used._result

    def slow(future: Future) -> object:
        if next(late, False):
            raise TimeoutError
        return fetch(future)

    monkeypatch.setattr(used, "_result", slow)
    with opened(path) as store:
        swept(store, used, ASKED)  # type: ignore[arg-type]
    assert next(late, None) is None and tried(path) == Counter(FEW["rsqrt"])


def busy(name: str, seconds: float) -> tuple[str, float, float]:
    start = time.time()
    time.sleep(seconds)
    return name, start, time.time()


def test_a_timing_runs_alone_on_its_worker_while_builds_run_side_by_side(pool: Pool) -> None:
    pool.worker("amd", announces="zen3", is_really="zen3")
    name = resource_of("zen3")

    def sent(what: str, share: float):  # type: ignore[no-untyped-def]
        return pool.client.submit(busy, what, 0.4, resources={name: share}, pure=False)

    jobs = [sent("build", BUILD_SHARE) for _ in range(4)]
    jobs += [sent("time", 1.0) for _ in range(2)] + [sent("build", BUILD_SHARE) for _ in range(4)]
    spans = pool.client.gather(jobs)
    overlaps = Counter(
        tuple(sorted((a[0], b[0])))
        for n, a in enumerate(spans)
        for b in spans[:n]
        if a[1] < b[2] and b[1] < a[2]
    )
    print(f"at the same time: {dict(overlaps)}")
    assert set(overlaps) == {("build", "build")}


def test_a_scheduler_that_does_not_answer_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("generator.api.cluster._CONNECT", 0.5)
    result = CliRunner().invoke(
        gen, ["sweep", "--target", "zen3", "--scheduler", "tcp://127.0.0.1:9"]
    )
    print(result.stderr)
    assert result.exit_code == 2 and "no Dask scheduler answers there" in result.stderr


def test_gen_worker_announces_this_cpu_and_a_sweep_by_command_uses_it(pool: Pool) -> None:
    host = read_host()
    if not host.exact:
        pytest.skip("this CPU is none of the targets")
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "CAROM_CACHE": str(cache_folder())}
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", "generator", "worker", pool.address, "--threads", "2"],
        cwd=pool.folder,
        env=environment,
        start_new_session=True,
    )
    try:
        only = [word for key, codes in FEW.items() for word in ("--only", f"{key}={codes[0]}")]
        path = pool.folder / "s.sqlite"
        sweep = ["sweep", "--scheduler", pool.address, "--steps", "100", "--call", "scalar"]
        sweep += ["--exhaustive", *only]
        result = CliRunner().invoke(gen, [*sweep, "--store", str(path)])
        print(result.output)
        assert result.exit_code == 0
        assert tried(path) == Counter([FEW["rsqrt"][0]])
        workers = pool.client.scheduler_info()["workers"].values()
        assert [w["resources"] for w in workers] == [{resource_of(host.target.name): 1.0}]
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
