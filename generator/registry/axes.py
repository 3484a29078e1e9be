"""The option axes of a kernel: one registry, from which names, checks, docs and tables derive.

To add an option: one `Choice` here, its rule (if not everything may be combined with it) in
rules.py, and the code that lays it out in lowering/ or templates/.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property


@dataclass(frozen=True)
class Choice:
    """One value of an axis; `code` is its field in kernel names."""

    code: str
    text: str


@dataclass(frozen=True, eq=False)  # each is itself alone, which is quick to hash
class Axis:
    """One independent decision about how a kernel is written or compiled."""

    key: str
    text: str
    choices: tuple[Choice, ...]  # the first one is the default
    family: str = "fixed"  # which steppers have it: "fixed", "exact" or "all"
    lanes: bool = False  # only kernels with more than one lane have it

    @property
    def default(self) -> str:
        return self.choices[0].code

    def codes(self) -> tuple[str, ...]:
        return self._codes

    @cached_property
    def _codes(self) -> tuple[str, ...]:
        return tuple(choice.code for choice in self.choices)


def _axis(key: str, text: str, family: str, lanes: bool = False, **choices: str) -> Axis:
    pairs = tuple(Choice(code.rstrip("_"), meaning) for code, meaning in choices.items())
    return Axis(key, text, pairs, family, lanes)


AXES: tuple[Axis, ...] = (
    _axis(
        "state",
        "what the loop carries",
        "fixed",
        full="the ten velocities (twelve with lift), slips made from them",
        reduced="the slips alone; velocities recovered after the loop",
    ),
    _axis(
        "store",
        "register scoping",
        "fixed",
        named="a named scalar each",
        arrays="small arrays, one a vector",
        blocks="scalars with temporaries confined to blocks",
    ),
    _axis(
        "reuse",
        "what is kept between uses",
        "fixed",
        keep="slips kept from one iteration to the next, as the report does",
        recompute="slips made again from the velocities in each iteration, and dropped",
        precompute="products of constants made before the loop; speeds instead of impulses",
        factored="as precompute, and 1/|c| multiplied in last, off the critical chain",
    ),
    _axis(
        "order",
        "order of statements",
        "fixed",
        paper="as the paper lists them",
        chain="the chain slip -> 1/|c| -> slip first",
    ),
    _axis(
        "rsqrt",
        "reciprocal of a slip's length",
        "fixed",
        div="sqrt, then a division for each component",
        inv="sqrt and one division",
        est1="hardware estimate and one Newton step",
        est2="hardware estimate and two Newton steps",
        prev="the last iteration's value and one Newton step, checked",
        ahead="the last two iterations' values extrapolated and one Newton step, checked",
    ),
    _axis(
        "roots",
        "square roots an iteration",
        "fixed",
        three="all three at the end of the iteration, as the report",
        two="two, each where it is used",
        early="two or three at the start, before any branch",
    ),
    _axis(
        "root",
        "reciprocal of a slip's length in an exact stepper",
        "exact",
        inv="sqrt and division",
        est0="hardware estimate alone",
        est1="hardware estimate and one Newton step",
        est2="hardware estimate and two Newton steps",
        cubic="hardware estimate and one step of third order",
        ieee="sqrt and division, in the control of steps too: no estimate, the same on every CPU",
    ),
    _axis(
        "tiers",
        "what comes before the adaptive steps of single calls of an exact stepper",
        "exact",
        adaptive="nothing",
        fixed="a few fixed steps, of those collisions that a certificate says they will do for",
        sticking="the same, and fixed steps to where contact sticks",
    ),
    _axis(
        "fma",
        "fused multiply-add",
        "all",
        nofma="none, contraction off",
        autofma="left to the compiler",
        fma="placed by the generator, contraction off",
    ),
    _axis(
        "branch",
        "branches of an iteration",
        "fixed",
        nested="nested as in the report",
        likely="nested, the usual side annotated",
        inverted="everything computed, then masked by ?:",
        bitmask="everything computed, then masked by bits",
        chosen="pressed ball chosen before the loop; nested loop as the fallback",
    ),
    _axis(
        "loop",
        "phases",
        "fixed",
        onestage="one loop for compression and restitution",
        twostage="a loop for each",
    ),
    _axis(
        "simd",
        "SIMD inside one collision",
        "fixed",
        scalar="none",
        prepost="before and after the loop",
        balls="lanes are the two balls",
        slips="lanes are the contact slip and the table slip",
    ),
    _axis(
        "lane_root",
        "reciprocal of a slip's length in lanes",
        "all",
        lanes=True,
        est1="hardware estimate and one Newton step",
        cubic="hardware estimate and one step of third order",
        est2="hardware estimate and two Newton steps",
        inv="sqrt and division",
        est0="hardware estimate alone, in an exact stepper",
        ieee="sqrt and division, wherever an estimate would do: the same on every CPU",
    ),
    _axis(
        "finished",
        "lanes whose collision is over, in fixed steps",
        "fixed",
        lanes=True,
        masked="stand still till their vector is over; contact that chatters comes last in it",
        aside="the same, but contact that chatters is set aside and done in a second pass",
        refilled="take the next collision that waits; contact that chatters in a second pass",
    ),
    _axis(
        "interleave",
        "vectors worked on in turn, to fill each other's latency",
        "all",
        lanes=True,
        i1="one",
        i2="two",
        i3="three",
        i4="four",
        s2="two, in the stages of an exact step alone",
    ),
    _axis(
        "numbers",
        "numbers in lanes of an exact stepper; the width says it",
        "exact",
        lanes=True,
        own="the scene's",
        float_="floats, twice as many; what is before and after the steps stays double",
    ),
    _axis(
        "lane_tiers",
        "what comes before the adaptive steps in lanes of an exact stepper",
        "exact",
        lanes=True,
        adaptive="nothing",
        fixed="a few fixed steps, of those collisions that a certificate says they will do for",
        sticking="the same, and fixed steps to where contact sticks",
    ),
    _axis(
        "compiler",
        "compiler",
        "all",
        gcc="GCC",
        clang="Clang, the newest found",
        clangold="Clang, the system's default when it is another",
    ),
    _axis(
        "flags",
        "compiler flags",
        "all",
        strict="-O3, IEEE arithmetic",
        report="the report's: -Ofast -fno-math-errno -funroll-loops -ftree-vectorize",
    ),
)


def axes_of(family: str, width: int = 1, among: frozenset[str] | None = None) -> tuple[Axis, ...]:
    """The axes that kernels of a stepper family and that many lanes have, in name order.

    `among`: those that kernels of an impact have; None: all.
    """
    return _fitting(AXES, family, width > 1, among)


@cache  # millions of times in a sweep; tests have axes of their own
def _fitting(
    axes: tuple[Axis, ...], family: str, wide: bool, among: frozenset[str] | None
) -> tuple[Axis, ...]:
    fitting = (axis for axis in axes if axis.family in (family, "all"))
    own = (axis for axis in fitting if among is None or axis.key in among)
    return tuple(axis for axis in own if wide or not axis.lanes)


def axis(key: str) -> Axis:
    """The axis of that name; KeyError names those there are."""
    for candidate in AXES:
        if candidate.key == key:
            return candidate
    raise KeyError(f"no option axis '{key}'; there are {', '.join(a.key for a in AXES)}")
