"""Which loops a variant of the fixed-step scheme consists of, and which parts stand in each."""

from __future__ import annotations

from dataclasses import dataclass, field

from ...impacts.ball_ball.terms import ContactTerms
from ...lowering.counts import OperationCounts
from ...lowering.statements import Part
from ...registry.variant import Variant
from .parts import FixedStepLowering

EMPTY = Part((), OperationCounts())
ALL_SLIPS = ("c_x", "c_z", "s1x", "s1y", "s2x", "s2y", "v_n")


def _join(*parts: Part) -> Part:
    total = sum((part.counts for part in parts), OperationCounts())
    return Part(tuple(line for part in parts for line in part), total)


def _text(*lines: str) -> Part:
    return Part(lines, OperationCounts())


@dataclass
class Loop:
    """One function of the generated file: what the templates need to lay it out."""

    name: str
    text: str
    template: str
    variant: Variant
    c_z: str = "c_z"
    no_slip: str = ""
    at_rest: dict[int, str] = field(default_factory=dict)
    declarations: tuple[str, ...] = ()
    before_loop: Part = EMPTY
    top: Part = EMPTY
    d_x: Part = EMPTY
    d_z: Part = EMPTY
    root_in_branch: dict[int, Part] = field(default_factory=lambda: {1: EMPTY, 2: EMPTY})
    table: dict[int, Part] = field(default_factory=dict)
    lift: dict[int, Part] = field(default_factory=dict)
    update: Part = EMPTY
    bottom: Part = EMPTY
    after_loop: Part = EMPTY
    steady: str = ""
    pressed: int = 0
    resumes: bool = False
    masked_lift: tuple[str, ...] = ()
    pairs: dict[str, tuple[str, str]] = field(default_factory=dict)
    in_lanes: OperationCounts = field(default_factory=OperationCounts)  # of the template's own

    @property
    def physical(self) -> bool:
        return self.variant["reuse"] in ("keep", "recompute")

    @property
    def blocks(self) -> bool:
        return self.variant["store"] == "blocks"

    @property
    def twostage(self) -> bool:
        return self.variant["loop"] == "twostage"

    @property
    def region(self) -> str:
        """What llvm-mca's markers call the loop: only the usual loops are modelled."""
        return "aside" if self.resumes or self.name == "iterate_level" else "loop"

    @property
    def chosen(self) -> bool:
        return bool(self.steady)

    def likely(self, condition: str) -> str:
        if self.variant["branch"] == "likely":
            return f"__builtin_expect({condition}, 1)"
        return condition

    def unlikely(self, condition: str) -> str:
        if self.variant["branch"] in ("likely", "chosen"):
            return f"__builtin_expect({condition}, 0)"
        return condition

    def mask(self, value: str, condition: str) -> str:
        """`value` where the condition holds, else 0: by ?: or by bits."""
        if self.variant["branch"] == "bitmask":
            return f"masked({value}, {condition})"
        return f"{condition} ? {value} : 0.0"

    def counts(self) -> OperationCounts:
        """Operations of one iteration with slip and one pressed ball (work and loop test too)."""
        ball = self.pressed or 2
        parts = [self.top, self.d_x, self.d_z, self.update, self.bottom]
        parts += [self.root_in_branch[ball]]
        parts += [part for key, part in self.table.items() if key == ball or self._masks]
        parts += [part for key, part in self.lift.items() if key == ball or self._masks]
        work = OperationCounts(add=2, mul=1, compare=2) + self.in_lanes
        return sum((part.counts for part in parts), work)

    @property
    def _masks(self) -> bool:
        return self.variant["branch"] in ("inverted", "bitmask")


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
        if level and self.variant["branch"] == "chosen":
            return [self.unpressed()]
        if self.variant["branch"] != "chosen":
            template = "masked" if self._masks else "branching"
            return [self.general(template, "iterate")]
        fallback = LoopBuilder(
            self.variant.with_options(
                state="full",
                reuse="precompute",
                rsqrt="inv",
                roots="two",
                branch="nested",
                order="paper",
                simd="scalar",
                store="named",
                loop="onestage",
            ),
            self.terms,
        ).general("branching", "iterate_general")
        fallback.resumes = True
        fallback.text = "Contact that chatters: either ball may be pressed, anew in each iteration."
        return [self.unpressed(), self.chosen_loop(1), self.chosen_loop(2), fallback]

    @property
    def _masks(self) -> bool:
        return self.variant["branch"] in ("inverted", "bitmask")

    # -- both balls may be pressed -------------------------------------------------------------

    def general(self, template: str, name: str) -> Loop:
        low, variant = self.low, self.variant
        reduced = variant["state"] == "reduced"
        loop = Loop(name, "Either ball may be pressed.", f"fixed_step/{template}.j2", variant)
        loop.c_z = low.printer.name_of("c_z")
        loop.no_slip = low.is_zero("c")
        loop.at_rest = {1: low.is_zero("s1"), 2: low.is_zero("s2")}
        loop.declarations = self._reduced_state() if reduced else self._full_state()
        self._place_roots(loop)
        loop.d_x, loop.d_z = low.friction_part("d_x"), low.friction_part("d_z")
        loop.table = {1: low.table(1), 2: low.table(2)}
        loop.lift = {1: low.lift(1), 2: low.lift(2)}
        loop.masked_lift = self._masked_lift()
        if reduced:
            loop.update = low.reduced_both()
            loop.after_loop = _join(low.recover_both(), low.velocities_from_sums(0), self._z_back())
            return loop
        loop.update = low.update()
        slips = low.slips_of_state(only=("v_n",) if self._recomputes else None)
        loop.bottom = _join(slips, loop.bottom)
        if self._recomputes:
            others = tuple(name for name in ALL_SLIPS if name != "v_n")
            loop.top = _join(self._slips_anew(others), loop.top)
        loop.after_loop = self._full_back()
        return loop

    @property
    def _recomputes(self) -> bool:
        return self.variant["reuse"] == "recompute"

    def _slips_anew(self, names: tuple[str, ...]) -> Part:
        """Slips that live for one iteration only."""
        if self.variant["store"] != "arrays":
            return self.low.slips_of_state("const double", names)
        tags = sorted({self.low.printer.name_of(n)[:-3] for n in names})
        declared = _text(*(f"double {tag}[2];" for tag in tags))
        return _join(declared, self.low.slips_of_state(only=names))

    def _masked_lift(self) -> tuple[str, ...]:
        if not self.terms.lift:
            return ()
        per_mass = " / p.M" if self.low.physical else ""
        one, two = self.low.printer.name_of("v1z"), self.low.printer.name_of("v2z")
        zero = "0.0"
        return (
            f"{one} += (d_z > 0.0 ? d_z : {zero}){per_mass};",
            f"{two} -= (d_z < 0.0 ? d_z : {zero}){per_mass};",
        )

    def _place_roots(self, loop: Loop) -> None:
        """Put the square roots where the axis `roots` says."""
        low, where = self.low, self.variant["roots"]
        tags = ("c", "s1", "s2")
        if low.refines:
            loop.before_loop = self._first_guesses(tags)
            loop.top = _join(*(self._refined_root(tag) for tag in tags))
        elif where == "three":
            loop.before_loop = _join(*(low.root(tag, "double") for tag in tags))
            loop.bottom = _join(*(low.root(tag, "") for tag in tags))
        elif where == "early":
            loop.top = _join(*(low.root(tag, "const double") for tag in tags))
        else:
            loop.top = low.root("c", "const double")
            loop.root_in_branch = {b: low.root(f"s{b}", "const double") for b in (1, 2)}

    def _first_guesses(self, tags: tuple[str, ...]) -> Part:
        lines = []
        for tag in tags:
            x, y = (self.low.printer.name_of(n) for n in _components(tag))
            # Slips that are made anew do not exist before the loop: 0 is a guess that is refused.
            first = "0.0" if self._recomputes else f"exact_rsqrt({x} * {x} + {y} * {y})"
            lines.append(f"double i_{tag} = {first};")
            if self.variant["rsqrt"] == "ahead":
                lines.append(f"double g_{tag} = i_{tag};")
        return _text(*lines)

    def _refined_root(self, tag: str) -> Part:
        root = self.low.root(tag, "const double")
        if self.variant["rsqrt"] == "prev":
            return root
        lines = [f"const double i_{tag}_before = i_{tag};", *root]
        if self.variant["fma"] == "fma":
            lines.append(f"g_{tag} = std::fma(2.0, i_{tag}, -i_{tag}_before);")
            return Part(tuple(lines), root.counts + OperationCounts(fma=1))
        lines.append(f"g_{tag} = 2.0 * i_{tag} - i_{tag}_before;")
        return Part(tuple(lines), root.counts + OperationCounts(mul=1, add=1))

    # -- state ---------------------------------------------------------------------------------

    def _full_state(self, slip_names: tuple[str, ...] = ALL_SLIPS) -> tuple[str, ...]:
        arrays = self.variant["store"] == "arrays"
        spin = "w" if self.low.physical else "o"
        scale = " / p.R" if self.low.physical else ""
        lines = []
        for ball in "12":
            names = [f"v{ball}x", f"v{ball}y"]
            if arrays or self.terms.lift:
                names.append(f"v{ball}z")
            values = [f"b.{name}" for name in names]
            lines += _declare(f"v{ball}", names, values, arrays)
            names = [f"{spin}{ball}{axis}" for axis in "xyz"]
            values = [f"b.o{ball}{axis}{scale}" for axis in "xyz"]
            lines += _declare(f"{spin}{ball}", names, values, arrays)
        only = ("v_n",) if self._recomputes else slip_names
        if arrays and not self._recomputes:
            tags = sorted({self.low.printer.name_of(n)[:-3] for n in only if n != "v_n"})
            lines += [f"double {tag}[2];" for tag in tags]
            lines += list(self.low.slips_of_state(only=tuple(n for n in only if n != "v_n")))
            return (*lines, *self.low.slips_of_state("double", ("v_n",)))
        return (*lines, *self.low.slips_of_state("double", only))

    def _reduced_state(self, tags: tuple[str, ...] = ("c", "s1", "s2")) -> tuple[str, ...]:
        arrays = self.variant["store"] == "arrays"
        names = tuple(n for tag in tags for n in _components(tag))
        lines = list(self.low.slips_of_contact("_0", (*names, "v_n")))
        for tag in tags:
            values = [f"{n}_0" for n in _components(tag)]
            lines += _declare(tag, list(_components(tag)), values, arrays)
        lines.append("double v_n = v_n_0;")
        lifts = self.terms.lift and tags == ("c", "s1", "s2")
        for ball in "12":
            axes = "xyz" if arrays else "yz" if lifts else "y"
            own = [f"v{ball}{axis}" for axis in axes]
            lines += _declare(f"v{ball}", own, [f"b.{name}" for name in own], arrays)
        return tuple(lines)

    def _full_back(self) -> Part:
        spin = "w" if self.low.physical else "o"
        scale = " * p.R" if self.low.physical else ""
        name = self.low.printer.name_of
        lines = []
        for ball in "12":
            axes = "xyz" if self.terms.lift else "xy"
            lines += [f"b.v{ball}{a} = {name(f'v{ball}{a}')};" for a in axes]
            for a in "xyz":
                held = name(f"{spin}{ball}{a}")
                lines.append(f"b.o{ball}{a} = {held}{scale};")
        return _text(*lines)

    def _z_back(self) -> Part:
        if not self.terms.lift:
            return EMPTY
        name = self.low.printer.name_of
        return _text(f"b.v1z = {name('v1z')};", f"b.v2z = {name('v2z')};")

    # -- one pressed ball ----------------------------------------------------------------------

    def chosen_loop(self, pressed: int) -> Loop:
        low, variant = self.low, self.variant
        name = f"iterate_pressed_{pressed}"
        text = f"Ball {pressed} is pressed onto the table, the other one is lifted."
        loop = Loop(name, text, "fixed_step/chosen.j2", variant, pressed=pressed)
        c_z = low.printer.name_of("c_z")
        loop.c_z = c_z
        loop.steady = f"{c_z} {'< -kNoSlip' if pressed == 2 else '> kNoSlip'}"
        if variant["simd"] == "slips":
            return self._slip_lanes(loop)
        tag = f"s{pressed}"
        if variant["state"] == "reduced":
            loop.declarations = self._reduced_state(("c", tag))
            loop.after_loop = _join(low.recover_pressed(pressed), low.velocities_from_sums(pressed))
        else:
            carried = ("c_x", "c_z", f"{tag}x", f"{tag}y", "v_n")
            loop.declarations = self._full_state(carried)
            loop.after_loop = self._full_back()
            loop.bottom = low.slips_of_state(only=carried)
        self._chosen_roots(loop, tag)
        loop.update = self._chosen_update(pressed)
        return loop

    def _chosen_roots(self, loop: Loop, tag: str) -> None:
        low = self.low
        tags = ("c", tag)
        if low.refines:
            loop.before_loop = self._first_guesses(tags)
            loop.top = _join(*(self._refined_root(t) for t in tags))
        elif self.variant["roots"] == "three":
            loop.before_loop = _join(*(low.root(t, "double") for t in tags))
            loop.bottom = _join(loop.bottom, *(low.root(t, "") for t in tags))
        else:
            loop.top = _join(*(low.root(t, "const double") for t in tags))

    def _chosen_update(self, pressed: int) -> Part:
        low, variant = self.low, self.variant
        if variant["reuse"] == "factored":
            return low.reduced_factored(pressed)
        impulses = _join(
            low.friction_part("d_x", "const double"),
            low.friction_part("d_z", "const double"),
            low.table(pressed, "const double"),
        )
        if variant["state"] == "reduced":
            return _join(impulses, low.reduced_update(pressed))
        return _join(impulses, low.update((pressed,)), low.lift(pressed))

    def unpressed(self) -> Loop:
        """c_z = 0 exactly: nobody is pressed, and the contact slip keeps its line."""
        loop = Loop(
            "iterate_level",
            "No slip along z: neither ball is pressed and the slip stays on its line.",
            "fixed_step/level.j2",
            self.variant,
        )
        loop.steady = "true"
        loop.declarations = tuple(self.low.slips_of_contact("_0", ("c_x", "v_n")))
        loop.update = self.low.level_update()
        loop.after_loop = self.low.velocities_from_sums(0)
        return loop

    # -- lanes ---------------------------------------------------------------------------------

    def _slip_lanes(self, loop: Loop) -> Loop:
        low, pressed = self.low, loop.pressed
        tag = f"s{pressed}"
        x, y = _components(tag)
        loop.template = "fixed_step/slip_lanes.j2"
        loop.steady = f"z_lane[0] {'< -kNoSlip' if pressed == 2 else '> kNoSlip'}"
        loop.declarations = tuple(low.slips_of_contact("_0", ("c_x", "c_z", x, y, "v_n")))
        loop.update = low.slip_lanes(pressed)
        loop.after_loop = _join(low.recover_pressed(pressed), low.velocities_from_sums(pressed))
        loop.pairs = low.pair_constants(loop.update)
        loop.in_lanes = low.lane_counts("slips")
        return loop

    def balls(self) -> Loop:
        low = self.low
        loop = Loop(
            "iterate",
            "Lane 0 is ball 1, lane 1 is ball 2; the table acts on the lane that is pressed.",
            "fixed_step/ball_lanes.j2",
            self.variant,
        )
        loop.top = low.ball_lane_slips()
        loop.update = low.ball_lanes()
        loop.pairs = low.pair_constants(loop.update)
        loop.in_lanes = low.lane_counts("balls")
        return loop


def _components(tag: str) -> tuple[str, str]:
    return ("c_x", "c_z") if tag == "c" else (f"{tag}x", f"{tag}y")


def _declare(array: str, names: list[str], values: list[str], arrays: bool) -> list[str]:
    if arrays:
        return [f"double {array}[{len(names)}] = {{{', '.join(values)}}};"]
    return [f"double {n} = {v};" for n, v in zip(names, values, strict=True)]
