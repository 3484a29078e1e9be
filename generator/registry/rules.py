"""Which combinations of options are legal, each refusal with its name and reason."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..targets.target import Target
from .lane_numbers import precision_of, steps_in_doubles
from .lanes import widths_of
from .recipe import SERIES
from .roots import EXACT_ROOTS, allows, allows_floats
from .stack import MOST_UNOPTIMISED, unoptimised_stack
from .variant import Variant


@dataclass(frozen=True)
class Rule:
    """A combination that cannot be: `breaks` tells whether a variant on a target is one."""

    name: str
    reason: str
    breaks: Callable[[Variant, Target], bool]


def _euler(test: Callable[[Variant], bool]) -> Callable[[Variant, Target], bool]:
    """Of fixed steps that have the report's axes."""
    return lambda v, _target: v.stepper.family == "fixed" and bool(v.get("state")) and test(v)


def _floats(v: Variant) -> bool:
    return v.get("numbers") == "float"


def _fixed(v: Variant, key: str) -> bool:
    """Are there fixed steps in front of the adaptive ones?"""
    return v.get(key, "adaptive") != "adaptive"


def _tiers(v: Variant) -> Any:
    """For which kernels of its impact fixed steps are known to do."""
    return v.question.row.part("tiers")


def _closed(v: Variant) -> bool:
    """Has its scene a closed form in place of steps?"""
    return bool(v.question.known_scene.closed_form)


def _roots_in_budget(v: Variant, target: Target) -> bool:
    """Are all roots of an exact kernel fine enough? A closed form has none."""
    asked, budget = v.question, v.stepper.budget
    scene, friction = asked.known_scene, asked.sensitivity
    if budget is None or scene.closed_form:
        return True
    one_float = scene.precision == "float"
    alone = allows(budget, friction, v.get("root", "inv"), target, one_float=one_float)
    if v.width == 1 or not alone:
        return alone
    return allows(budget, friction, v.get("lane_root", "inv"), target, in_floats=_floats(v))


RULES: tuple[Rule, ...] = (
    Rule(
        "series-needs-equations",
        "this impact has no power series",
        lambda v, _t: v.stepper.name == SERIES and not v.question.row.has_series,
    ),
    Rule(
        "lanes-of-series-alone",
        "of an impact with power series these alone have lanes: use the stepper series, or width 1",
        lambda v, _t: v.width > 1 and v.question.row.has_series and v.stepper.name != SERIES,
    ),
    Rule(
        "fma-needs-hardware",
        "the target has no fused multiply-add, and a library call for each would be slow",
        lambda v, t: v.get("fma") in ("fma", "autofma") and not t.has("fma"),
    ),
    Rule(
        "estimate-needs-hardware",
        "the target has no instruction that estimates a reciprocal square root",
        lambda v, t: (
            (v.get("rsqrt") or v.get("root")) in ("est0", "est1", "est2", "cubic")
            and not t.has_rsqrt_estimate
        ),
    ),
    Rule(
        "recompute-needs-full-state",
        "the reduced state has no slips to make again from velocities",
        _euler(lambda v: v["reuse"] == "recompute" and v["state"] == "reduced"),
    ),
    Rule(
        "reduced-needs-products",
        "the reduced state is in speeds: use reuse=precompute or factored with it",
        _euler(lambda v: v["state"] == "reduced" and v["reuse"] not in ("precompute", "factored")),
    ),
    Rule(
        "recompute-needs-later-roots",
        "slips made at the start of an iteration have no roots at its end: use roots=two or early",
        _euler(lambda v: v["reuse"] == "recompute" and v["roots"] == "three"),
    ),
    Rule(
        "chosen-needs-products",
        "the loop for one pressed ball works in speeds: use reuse=precompute or factored with it",
        _euler(lambda v: v["branch"] == "chosen" and v["reuse"] not in ("precompute", "factored")),
    ),
    Rule(
        "chosen-needs-inverse",
        "without a branch for a table slip of zero the division by its length would be 0/0",
        _euler(lambda v: v["branch"] == "chosen" and v["rsqrt"] == "div"),
    ),
    Rule(
        "chosen-has-one-table-root",
        "the pressed ball is known: no branch is left to make a root in; use roots=early or three",
        _euler(lambda v: v["branch"] == "chosen" and v["roots"] == "two"),
    ),
    Rule(
        "balls-need-full-state",
        "lanes that are balls carry the balls' velocities: use state=full",
        _euler(lambda v: v["simd"] == "balls" and v["state"] != "full"),
    ),
    Rule(
        "factored-needs-reduced",
        "1/|c| can be multiplied in last only with state=reduced and branch=chosen",
        _euler(
            lambda v: (
                v["reuse"] == "factored" and (v["state"] != "reduced" or v["branch"] != "chosen")
            )
        ),
    ),
    Rule(
        "refine-needs-early-roots",
        "refining the last iteration's value needs the root to be made in every iteration",
        _euler(lambda v: v["rsqrt"] in ("prev", "ahead") and v["roots"] != "early"),
    ),
    Rule(
        "masks-need-early-roots",
        "with everything computed and masked there is no branch to make a root in or after",
        _euler(lambda v: v["branch"] in ("inverted", "bitmask") and v["roots"] == "two"),
    ),
    Rule(
        "balls-need-bitmask",
        "lanes that are balls are masked, not branched on",
        _euler(lambda v: v["simd"] == "balls" and v["branch"] != "bitmask"),
    ),
    Rule(
        "balls-need-plain-root",
        "lanes that are balls make their roots afresh each iteration, as the report does",
        _euler(
            lambda v: (
                v["simd"] == "balls"
                and (v["rsqrt"] in ("prev", "ahead", "div") or v["roots"] != "early")
            )
        ),
    ),
    Rule(
        "balls-need-products",
        "lanes that are balls work in speeds: use reuse=precompute with them",
        _euler(lambda v: v["simd"] == "balls" and v["reuse"] != "precompute"),
    ),
    Rule(
        "slips-need-chosen",
        "lanes that are slips need one pressed ball, the reduced state and its products",
        _euler(
            lambda v: (
                v["simd"] == "slips"
                and not (
                    v["branch"] == "chosen"
                    and v["state"] == "reduced"
                    and v["reuse"] == "precompute"
                    and v["roots"] == "early"
                    and v["rsqrt"] not in ("div", "prev", "ahead")
                )
            )
        ),
    ),
    Rule(
        "vectors-need-names",
        "a vector register is its own storage: use store=named with SIMD lanes",
        _euler(lambda v: v["simd"] in ("balls", "slips") and v["store"] != "named"),
    ),
    Rule(
        "chain-needs-early-roots",
        "the chain can come first only where its root is made at the start of the iteration",
        _euler(lambda v: v["order"] == "chain" and v["roots"] != "early"),
    ),
    Rule(
        "lanes-need-vectors",
        "the target has no vectors of so many of these numbers",
        lambda v, t: v.width not in widths_of(t, precision_of(v)),
    ),
    Rule(
        "lanes-need-ieee",
        "lanes are told apart by NaN, infinities and comparisons: use flags=strict with them",
        lambda v, _t: v.width > 1 and v["flags"] != "strict",
    ),
    Rule(
        "lanes-place-their-fma",
        "the same collision must be rounded alike in every lane: use fma=fma or nofma",
        lambda v, _t: v.width > 1 and v["fma"] == "autofma",
    ),
    Rule(
        "lane-estimate-needs-hardware",
        "the target has no instruction that estimates a reciprocal square root",
        lambda v, t: v.get("lane_root", "inv") not in EXACT_ROOTS and not t.has_rsqrt_estimate,
    ),
    Rule(
        "floats-in-place-of-doubles",
        "only steps in doubles can be made in floats instead: use numbers=own",
        lambda v, _t: _floats(v) and not steps_in_doubles(v.question.known_scene),
    ),
    Rule(
        "floats-within-budget",
        "floats round by more than the error budget allows: use numbers=own",
        lambda v, _t: (
            _floats(v) and not allows_floats(v.stepper.budget or 0.0, v.question.sensitivity)
        ),
    ),
    Rule(
        "roots-within-budget",
        "the root is off by more than the error budget allows: use a finer root or lane_root",
        lambda v, t: not _roots_in_budget(v, t),
    ),
    Rule(
        "lanes-of-steps-refine-roots",
        "a thousand steps add up what an estimate alone is off by: use a finer lane_root",
        _euler(lambda v: v.get("lane_root") == "est0"),
    ),
    Rule(
        "pairs-need-stages",
        "only the steps of an exact kernel have stages that two vectors can make in turn",
        lambda v, _t: v.paired and (v.stepper.family != "exact" or _closed(v)),
    ),
    Rule(
        "tiers-need-a-bound",
        "no certificate of fixed steps is known here: use tiers=adaptive and lane_tiers=adaptive",
        lambda v, _t: (
            (_fixed(v, "tiers") or _fixed(v, "lane_tiers"))
            and not _tiers(v).has_bound(v.model, v.stepper.budget or 0.0)
        ),
    ),
    Rule(
        "sticking-tiers-need-a-bound",
        "no certificate of steps to sticking is known here: use tiers=fixed and lane_tiers=fixed",
        lambda v, _t: (
            "sticking" in (v.get("tiers"), v.get("lane_tiers"))
            and not _tiers(v).has_sticking(v.model, v.stepper.budget or 0.0)
        ),
    ),
    Rule(
        "tiers-need-equal-balls",
        "fixed steps know equal masses in doubles, with table friction: use tiers=adaptive",
        lambda v, _t: _fixed(v, "tiers") and not _tiers(v).takes_fixed_steps(v.scene),
    ),
    Rule(
        "lane-tiers-need-a-plain-scene",
        "fixed steps in lanes ask nothing of speeds or motions: use lane_tiers=adaptive",
        lambda v, _t: _fixed(v, "lane_tiers") and not _tiers(v).takes_tiers(v.scene),
    ),
    Rule(
        "lane-tiers-are-in-floats",
        "the rounding that a certificate leaves room for is that of floats: use lanes of floats, "
        "or lane_tiers=adaptive",
        lambda v, _t: _fixed(v, "lane_tiers") and not (_floats(v) and v.vectors == 1),
    ),
    Rule(
        "lanes-fit-the-stack",
        "a step of so many lanes takes more than 128 KiB of stack unoptimised: use interleave=s2",
        lambda v, _t: unoptimised_stack(v) > MOST_UNOPTIMISED,
    ),
)


def broken_rule(variant: Variant, target: Target) -> Rule | None:
    """The first rule that a variant breaks on a target, or None where it is legal."""
    return next((rule for rule in RULES if rule.breaks(variant, target)), None)


def require_legal(variant: Variant, target: Target) -> None:
    """Raise ValueError with the rule's name and reason where a combination is illegal."""
    rule = broken_rule(variant, target)
    if rule is not None:
        raise ValueError(f"illegal combination ({rule.name}): {rule.reason}")
