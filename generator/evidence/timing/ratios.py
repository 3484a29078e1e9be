"""Ratios and intervals out of the rounds of a timing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field
from scipy.stats import binom

from ...errors import KernelError
from .plan import Array

CONFIDENCE = 0.95
LEAST_BAND = 0.005  # the A/A band is never narrower than this to either side
QUIET_ROUNDS = 8  # fewer than that tell less than all rounds do

Interval = tuple[float, float]
Flags = NDArray[np.bool_]


class Speed(BaseModel):
    """How fast a kernel was, for one collision: medians over the rounds."""

    model_config = ConfigDict(frozen=True)

    ns: float = Field(gt=0)
    ratio: float = Field(gt=0)  # of time to that of `paper-initial` in the same round
    ratio_ci: Interval  # 95 %, from order statistics

    def rounded(self, digits: int) -> dict[str, Any]:
        """The figures to so many digits."""
        low, high = self.ratio_ci
        ends = (to_digits(low, digits), to_digits(high, digits))
        ns, ratio = to_digits(self.ns, digits), to_digits(self.ratio, digits)
        return {"ns": ns, "ratio": ratio, "ratio_ci": ends}


def to_digits(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")


class TimingResult(Speed):
    """What a timing says of a kernel."""

    name: str
    cycles: float  # of the time stamp counter, which ticks at a constant rate
    latency_ns: float | None  # each collision fed by the last
    seed_ns: float | None = None  # on the seed cases


@dataclass(frozen=True)
class Measurement:
    """Per round and kernel: ns and ticks for one collision, and the baseline's second turn."""

    ns: Mapping[str, Array]
    ticks: Mapping[str, Array]
    control: Array  # ns


@dataclass(frozen=True)
class TimingRun:
    """What carom_bench measured, in the rounds that count."""

    baseline: str
    rounds: int
    throughput: Measurement
    latency: Measurement | None
    seed_cases: Measurement | None
    tsc_ghz: float
    cpu: int  # the CPU that the thread was kept on, or -1
    core_ghz: float = 0.0  # the core's clock after it; 0: not known
    quiet: float = 1.0  # share of rounds that count with the core alone: 1 where eight had it
    day: str = "an earlier day"  # UTC, where it was noted


def median_interval(values: Array, confidence: float = CONFIDENCE) -> Interval:
    """Where the median lies, from order statistics: no assumption but independent rounds.

    With too few values for the confidence, all of their range.
    """
    ordered = np.sort(np.asarray(values, dtype=float))
    # The least count below the median that is not too rare; leave out one less at either end.
    count = int(binom.ppf((1 - confidence) / 2, len(ordered), 0.5))
    left_out = max(count - 1, 0)
    return float(ordered[left_out]), float(ordered[len(ordered) - 1 - left_out])


def _counting(quiet: Flags) -> Flags:
    """The rounds that count: the quiet ones, or all where those are too few.

    Another thread of the core takes a fifth to a half more of a kernel's time, and not the same of
    each kernel, so that rounds beside one and the others have no common median.
    """
    enough = quiet.sum() >= min(QUIET_ROUNDS, len(quiet))
    return quiet if enough else np.full(len(quiet), True)


def _measurement(document: dict[str, Any] | None, counting: Flags) -> Measurement | None:
    if document is None:
        return None

    def rounds(series: dict[str, Any], key: str) -> Array:
        return np.array(series[key])[counting]

    kernels = document["kernels"]
    return Measurement(
        ns={k["name"]: rounds(k, "ns_per_collision") for k in kernels},
        ticks={k["name"]: rounds(k, "tsc_cycles_per_collision") for k in kernels},
        control=rounds(document["control"], "ns_per_collision"),
    )


def timing_run(document: dict[str, Any]) -> TimingRun:
    """carom_bench's result. Raises KernelError if it is not complete."""
    try:
        quiet = np.array(document.get("quiet", [True] * document["rounds"]))
        counting = _counting(quiet)
        throughput = _measurement(document["throughput"], counting)
        if throughput is None:
            raise KeyError("throughput")
        names = list(throughput.ns)
        return TimingRun(
            baseline=names[document["baseline"]],
            rounds=int(counting.sum()),
            throughput=throughput,
            latency=_measurement(document["latency"], counting),
            seed_cases=_measurement(document["seed_cases"], counting),
            tsc_ghz=document["tsc_ghz"],
            cpu=document["cpu"],
            core_ghz=document.get("core_ghz", 0.0),
            quiet=float(quiet[counting].mean()),
            day=document.get("day", TimingRun.day),
        )
    except (KeyError, IndexError, TypeError) as error:
        raise KernelError(f"the timing's result is not complete: {error}") from None


def control_band(run: TimingRun) -> Interval:
    """The A/A control: ratios that the baseline has to itself, at least 0.5 % to either side.

    What was seen to one side might as well have been to the other, so both are as wide.
    """
    low, high = median_interval(run.throughput.control / run.throughput.ns[run.baseline])
    width = max(high - 1, 1 / low - 1, LEAST_BAND)
    return 1 / (1 + width), 1 + width


def ratio_between(run: TimingRun, name: str, other: str) -> float:
    """The median ratio of two kernels' times in the same rounds."""
    return float(np.median(run.throughput.ns[name] / run.throughput.ns[other]))


def _median(measurement: Measurement | None, name: str) -> float | None:
    if measurement is None or name not in measurement.ns:
        return None
    return float(np.median(measurement.ns[name]))


def _result(run: TimingRun, name: str) -> TimingResult:
    ratios = run.throughput.ns[name] / run.throughput.ns[run.baseline]
    return TimingResult(
        name=name,
        ns=float(np.median(run.throughput.ns[name])),
        cycles=float(np.median(run.throughput.ticks[name])),
        ratio=float(np.median(ratios)),
        ratio_ci=median_interval(ratios),
        latency_ns=_median(run.latency, name),
        seed_ns=_median(run.seed_cases, name),
    )


def timing_results(run: TimingRun) -> tuple[TimingResult, ...]:
    """A result for each kernel, in the plan's order."""
    return tuple(_result(run, name) for name in run.throughput.ns)
