"""Which loops a variant of the fixed-step scheme consists of, and which parts stand in each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from .....lowering.counts import OperationCounts
from .....lowering.statements import Part
from .....registry.variant import Variant
from ...terms import ContactTerms
from . import pairs, reduced, state
from .loop import EMPTY, Loop, join, text
from .parts import FixedStepLowering
from .state import TAGS, components


@dataclass(frozen=True)
class _Roots:
    """Where the square roots of an iteration are taken."""

    before_loop: Part = EMPTY
    top: Part = EMPTY
    in_branch: Mapping[int, Part] = field(default_factory=lambda: {1: EMPTY, 2: EMPTY})
    bottom: Part = EMPTY


class LoopBuilder:
    """Builds the loops of one variant."""

    def __init__(self, variant: Variant, terms: ContactTerms) -> None:
        self.variant = variant
        self.terms = terms
        self.low = FixedStepLowering(variant, terms)

    def loops(self, level: bool = False) -> list[Loop]:
        """`level`: no contact slips vertically, and a loop that chooses its ball needs none."""
        if self.variant["simd"] == "balls":
            return [self.balls()]
        if self.variant["branch"] != "chosen":
            masks = self.variant["branch"] in ("inverted", "bitmask")
            return [self.general("masked" if masks else "branching", "iterate")]
        if level:
            return [self.unpressed()]
        return [self.unpressed(), self.chosen_loop(1), self.chosen_loop(2), self._chattering()]

    def _chattering(self) -> Loop:
        """What the loops with a chosen ball fall back on."""
        plain = self.variant.with_options(
            state="full",
            reuse="precompute",
            rsqrt="inv",
            roots="two",
            branch="nested",
            order="paper",
            simd="scalar",
            store="named",
            loop="onestage",
        )
        return replace(
            LoopBuilder(plain, self.terms).general("branching", "iterate_general"),
            resumes=True,
            text="Contact that chatters: either ball may be pressed, anew in each iteration.",
        )

    # -- both balls may be pressed -------------------------------------------------------------

    def general(self, template: str, name: str) -> Loop:
        low, roots = self.low, self._roots(TAGS, in_branches=True)
        loop = Loop(
            name,
            "Either ball may be pressed.",
            f"ball_ball/fixed_step/{template}.j2",
            self.variant,
            c_z=low.printer.name_of("c_z"),
            no_slip=low.is_zero("c"),
            at_rest={1: low.is_zero("s1"), 2: low.is_zero("s2")},
            before_loop=roots.before_loop,
            top=roots.top,
            d_x=low.friction_part("d_x"),
            d_z=low.friction_part("d_z"),
            root_in_branch=roots.in_branch,
            table={1: low.table(1), 2: low.table(2)},
            lift={1: low.lift(1), 2: low.lift(2)},
            masked_lift=state.masked_lift(low),
            bottom=roots.bottom,
        )
        return self._reduced(loop) if self.variant["state"] == "reduced" else self._full(loop)

    def _reduced(self, loop: Loop) -> Loop:
        low = self.low
        back = reduced.recover_both(low), reduced.velocities_from_sums(low, 0)
        return replace(
            loop,
            declarations=state.reduced_state(low),
            update=reduced.update_both(low),
            after_loop=join(*back, state.vertical_back(low)),
        )

    def _full(self, loop: Loop) -> Loop:
        low = self.low
        slips = low.slips_of_state(only=("v_n",) if low.recomputes else None)
        return replace(
            loop,
            declarations=state.full_state(low),
            top=join(state.slips_anew(low), loop.top) if low.recomputes else loop.top,
            update=low.update(),
            slips=slips,
            after_loop=state.full_back(low),
        )

    # -- roots ---------------------------------------------------------------------------------

    def _roots(self, tags: tuple[str, ...], in_branches: bool) -> _Roots:
        """The square roots where the axis `roots` says; `in_branches`: the table's there if it may.

        A loop with a chosen ball needs all of them in each iteration.
        """
        low, where = self.low, self.variant["roots"]
        if low.refines:
            return _Roots(self._first_guesses(tags), join(*(self._refined(t) for t in tags)))
        if where == "three":
            before = join(*(low.root(tag, "double") for tag in tags))
            return _Roots(before, bottom=join(*(low.root(tag, "") for tag in tags)))
        if in_branches and where != "early":
            branches = {ball: low.root(f"s{ball}", "const double") for ball in (1, 2)}
            return _Roots(top=low.root("c", "const double"), in_branch=branches)
        return _Roots(top=join(*(low.root(tag, "const double") for tag in tags)))

    def _first_guesses(self, tags: tuple[str, ...]) -> Part:
        lines = []
        for tag in tags:
            x, y = (self.low.printer.name_of(name) for name in components(tag))
            # Slips that are made anew do not exist before the loop: 0 is a guess that is refused.
            first = "0.0" if self.low.recomputes else f"exact_rsqrt({x} * {x} + {y} * {y})"
            lines.append(f"double i_{tag} = {first};")
            if self.variant["rsqrt"] == "ahead":
                lines.append(f"double g_{tag} = i_{tag};")
        return text(*lines)

    def _refined(self, tag: str) -> Part:
        root = self.low.root(tag, "const double")
        if self.variant["rsqrt"] == "prev":
            return root
        before = f"const double i_{tag}_before = i_{tag};"
        if self.variant["fma"] == "fma":
            ahead, counts = f"std::fma(2.0, i_{tag}, -i_{tag}_before)", OperationCounts(fma=1)
        else:
            ahead = f"2.0 * i_{tag} - i_{tag}_before"
            counts = OperationCounts(mul=1, add=1)
        return Part((before, *root, f"g_{tag} = {ahead};"), root.counts + counts)

    # -- one pressed ball ----------------------------------------------------------------------

    def chosen_loop(self, pressed: int) -> Loop:
        low, tag = self.low, f"s{pressed}"
        c_z = low.printer.name_of("c_z")
        loop = Loop(
            f"iterate_pressed_{pressed}",
            f"Ball {pressed} is pressed onto the table, the other one is lifted.",
            "ball_ball/fixed_step/chosen.j2",
            self.variant,
            c_z=c_z,
            pressed=pressed,
            steady=_steady(c_z, pressed),
        )
        if self.variant["simd"] == "slips":
            return self._slip_lanes(loop)
        roots = self._roots(("c", tag), in_branches=False)
        loop = replace(
            loop,
            before_loop=roots.before_loop,
            top=roots.top,
            impulses=self._chosen_impulses(pressed),
            update=self._chosen_update(pressed),
            bottom=roots.bottom,
        )
        if self.variant["state"] == "reduced":
            declared = state.reduced_state(low, ("c", tag))
            return replace(loop, declarations=declared, after_loop=self._from_sums(pressed))
        carried = (*components("c"), *components(tag), "v_n")
        return replace(
            loop,
            declarations=state.full_state(low, carried),
            slips=low.slips_of_state(only=carried),
            after_loop=state.full_back(low),
        )

    def _from_sums(self, pressed: int) -> Part:
        sums = reduced.recover_pressed(self.low, pressed)
        return join(sums, reduced.velocities_from_sums(self.low, pressed))

    def _chosen_impulses(self, pressed: int) -> Part:
        low = self.low
        if self.variant["reuse"] == "factored":
            return reduced.factored_impulses(low, pressed)
        return join(
            low.friction_part("d_x", "const double"),
            low.friction_part("d_z", "const double"),
            low.table(pressed, "const double"),
        )

    def _chosen_update(self, pressed: int) -> Part:
        low, variant = self.low, self.variant
        if variant["reuse"] == "factored":
            return reduced.update_factored(low, pressed)
        if variant["state"] == "reduced":
            return reduced.update_pressed(low, pressed)
        return join(low.update((pressed,)), low.lift(pressed))

    def unpressed(self) -> Loop:
        """c_z = 0 exactly: nobody is pressed, and the contact slip keeps its line."""
        return Loop(
            "iterate_level",
            "No slip along z: neither ball is pressed and the slip stays on its line.",
            "ball_ball/fixed_step/level.j2",
            self.variant,
            steady="true",
            declarations=tuple(self.low.slips_of_contact("_0", ("c_x", "v_n"))),
            update=reduced.update_level(self.low),
            after_loop=reduced.velocities_from_sums(self.low, 0),
        )

    # -- lanes ---------------------------------------------------------------------------------

    def _slip_lanes(self, loop: Loop) -> Loop:
        low, pressed = self.low, loop.pressed
        slips = (*components("c"), *components(f"s{pressed}"), "v_n")
        update = pairs.slip_lanes(low, pressed)
        return replace(
            loop,
            template="ball_ball/fixed_step/slip_lanes.j2",
            steady=_steady("z_lane[0]", pressed),
            declarations=tuple(low.slips_of_contact("_0", slips)),
            update=update,
            after_loop=self._from_sums(pressed),
            pairs=pairs.pair_constants(update),
            in_lanes=pairs.lane_counts(low, "slips"),
        )

    def balls(self) -> Loop:
        update = pairs.ball_lanes(self.low)
        return Loop(
            "iterate",
            "Lane 0 is ball 1, lane 1 is ball 2; the table acts on the lane that is pressed.",
            "ball_ball/fixed_step/ball_lanes.j2",
            self.variant,
            top=pairs.ball_lane_slips(self.low),
            update=update,
            pairs=pairs.pair_constants(update),
            in_lanes=pairs.lane_counts(self.low, "balls"),
        )


def _steady(c_z: str, pressed: int) -> str:
    """While this holds the same ball stays pressed."""
    return f"{c_z} {'< -kNoSlip' if pressed == 2 else '> kNoSlip'}"
