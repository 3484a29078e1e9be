"""Lowering of the exact steppers: one adaptive Runge-Kutta step of the reduced system.

The normal impulse q (divided by M, in m/s) is the independent variable and the slips are the state.
A stage adds up the friction impulses of the earlier ones, which change the slips beside q: SymPy
gives the slips that follow from them, linearly, and after the collision the impulse sums. The
tableau gives the stages. Everything is printed in the lane vocabulary.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import sympy as sp

from .....lowering.chains import unfolded
from .....lowering.counts import OperationCounts
from .....lowering.printer import ExpressionPrinter, Fma, Plus, number
from .....lowering.statements import Assign, Part, lower
from .....tableaus.tableau import Tableau
from ... import symbols as s
from ...masses import EQUAL, Masses, pressed_changes
from ...terms import ContactTerms

# The slips that a step carries, in the order of struct Slips, and what they are in the mechanics;
# the friction impulses that change them, in the order of struct Rates.
SLIPS: dict[str, sp.Symbol] = {"c_x": s.C_X, "c_z": s.C_Z, "s_x": s.S2X, "s_y": s.S2Y}
IMPULSES: dict[str, sp.Symbol] = {"d_x": s.D_X, "d_z": s.D_Z, "t_x": s.T2X, "t_y": s.T2Y}
CONTACT, RUBBING = ("c_x", "c_z"), ("d_x", "d_z")  # all there is where there is no table friction
KIND = "const Real"
H = sp.Symbol("h", real=True)
EMPTY = Part((), OperationCounts())


def _symbol(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


@dataclass(frozen=True)
class Kept:
    """What a stage leaves for later, by type, and what it uses of what earlier ones left."""

    uses: tuple[str, ...]
    rates: tuple[str, ...]
    slips: tuple[str, ...]
    numbers: tuple[str, ...]


@dataclass(frozen=True)
class ExactStep:
    """The parts of one step, printed."""

    rates: Part  # impulses of friction for `pace` of q, from the slips and inverse lengths i_c, i_s
    stages: tuple[Part, ...]
    error: Part
    work: Part  # table friction's work over the step
    sums: Part  # impulse sums from the changes of the slips
    sums_of_slips: Part  # the same where the state is gone and its slips and q are left
    counts: OperationCounts  # of one step, without the roots and the control


class ExactLowering:
    """Prints the parts of a step for one contact model, pair of masses and tableau.

    Ball 2 is the pressed one: with sigma = -1 for a pressed ball 1, the slips s, the table
    increments t, c_z and d_z times sigma obey the same system, with the masses in each other's
    place. Without a table only the contact slip is carried. `gains`: impulses are added up beside
    the slips, whose own rounding counts (float, or a tight budget). `lanes`: as few operations as
    there can be; else the chain from a stage to the next is kept short, at the cost of a few more.
    `split_roots`: what the root of the table slip is multiplied by goes in before its last
    correction.
    """

    def __init__(
        self,
        terms: ContactTerms,
        tableau: Tableau,
        place_fma: bool,
        masses: Masses = EQUAL,
        table: bool = True,
        gains: bool = False,
        lanes: bool = False,
        split_roots: bool = False,
    ) -> None:
        self.terms = terms
        self.tableau = tableau
        self.place_fma = place_fma
        self.table = table
        self.gains = gains
        self.lanes = lanes
        self.split_roots = split_roots and table
        self.slips = SLIPS if table else {name: SLIPS[name] for name in CONTACT}
        self.impulses = IMPULSES if table else {name: IMPULSES[name] for name in RUBBING}
        self.printer = ExpressionPrinter(place_fma, fma_name="fma", number_format="real({})")
        self.changes = pressed_changes(terms, masses)

    @property
    def tail_bend(self) -> sp.Expr:
        """On the way into sticking c_x / c_z is as this power of 1 - t without table friction."""
        k_x, k_z = self.changes[s.C_X].coeff(s.D_X), self.changes[s.C_Z].coeff(s.D_Z)
        return sp.cancel(2 * (k_x / k_z - 1))

    def _bent(self, left: float) -> str:
        """That power of what is left; of masses that are given, in the kernel."""
        if self.tail_bend.is_number:
            return repr(left ** float(self.tail_bend))
        return f"std::pow({left!r}, start.bend)"

    def parts(self) -> ExactStep:
        rates = self._rates()
        stages = tuple(self._stage(i, rates.counts) for i in range(1, self.tableau.stages))
        error, work = self._error(), self._work()
        total = error.counts + work.counts
        for stage in stages:
            total = total + stage.counts
        total = total + self._laid_out()
        sums = self._sums("at.q"), self._sums("q")
        return ExactStep(rates, stages, error, work, *sums, total)

    def _laid_out(self) -> OperationCounts:
        """What templates/exact lays out around the printed parts of a step.

        Squares of slips, the pace, the first impulses, the size of the error.
        """
        added = OperationCounts(fma=1) if self.place_fma else OperationCounts(add=1, mul=1)
        evaluations = self.tableau.stages - 1
        if self.table:
            total = (added * 4 + OperationCounts(mul=1)) * evaluations
            total = total + added + OperationCounts(mul=11, div=1)
            weighed = self.changes[s.V_N].coeff(s.T2Y) != 1  # the work of the step
            total = total + OperationCounts(mul=1) * weighed
        else:
            total = (added * 2 + OperationCounts(mul=1)) * evaluations
            total = total + added + OperationCounts(mul=7, div=1)
        if self.tableau.second:
            joint = OperationCounts(add=1, mul=2, div=1, sqrt=1) + added
            total = total + joint + added * self.table
        return total

    # -- rates --

    def _rates(self) -> Part:
        """Rates with the inverse lengths multiplied in last, which keeps the critical chain short.

        p = -u_b c is contact friction times |c|, z = -u_s p_z s table friction times |c| |s|.
        """
        p_z, i_c = _symbol("p_z"), _symbol("i_c")
        slips = {name: _symbol(f"at.{name}") for name in self.slips}
        assigns = [
            Assign("p_x", -_symbol("u_b") * slips["c_x"], KIND),
            Assign("p_z", -_symbol("u_b") * slips["c_z"], KIND),
        ]
        if self.table:
            assigns += [
                Assign("g", -_symbol("start.u_s") * p_z, KIND),
                Assign("z_x", _symbol("g") * slips["s_x"], KIND),
                Assign("z_y", _symbol("g") * slips["s_y"], KIND),
            ]
        rubbed = [Assign(f"r_d_{axis}", i_c * _symbol(f"p_{axis}"), KIND) for axis in "xz"]
        if not self.table:
            return self._part([*assigns, *rubbed])
        if not self.split_roots:
            i_cs = _symbol("i_cs")
            assigns += [Assign("i_cs", i_c * _symbol("i_s"), KIND), *rubbed]
            assigns += [Assign(f"r_t_{axis}", i_cs * _symbol(f"z_{axis}"), KIND) for axis in "xy"]
            return self._part(assigns)
        over = tuple(f"{KIND} l_{axis} = root_s.of(z_{axis});" for axis in "xy")
        slid = [Assign(f"r_t_{axis}", i_c * _symbol(f"l_{axis}"), KIND) for axis in "xy"]
        before, after = self._part(assigns), self._part([*rubbed, *slid])
        return Part((*before.lines, *over, *after.lines), before.counts + after.counts)

    # -- what impulses change --

    def _moved(
        self, slip: str, base: sp.Expr, impulse: str, q: sp.Expr, share: int | sp.Expr = 1
    ) -> sp.Expr:
        """base + the change of a slip by the impulses `impulse` + name, and by a share of q."""
        change = self.changes[SLIPS[slip]]
        terms = [(change.coeff(s.DQ) * share, q)]
        terms += [(change.coeff(of), _symbol(impulse + name)) for name, of in self.impulses.items()]
        total = base
        for weight, value in terms:
            if weight == 0:
                continue
            total = weight * value if total == 0 else self._add(weight, value, total)
        return total

    def drift(self) -> Part:
        """b, the rate of change of the table slip at the start of a step."""
        names = (("b_x", "s_x"), ("b_y", "s_y"))
        forms = [(b, self._moved(slip, sp.Integer(0), "at.k.", sp.Integer(1))) for b, slip in names]
        return self._part([Assign(b, form, KIND) for b, form in forms])

    def landed(self) -> Part:
        """What the slips change by in a part of a step: from part_d_x, ..., and dq."""
        return self._part(
            [
                Assign(f"part_{n}", self._moved(n, sp.Integer(0), "part_", _symbol("dq")), KIND)
                for n in self.slips
            ]
        )

    # -- stages --

    def _stage(self, i: int, rates: OperationCounts) -> Part:
        """Slips at stage i, and the impulses there by `rates_at`."""
        row = self.tableau.rows[i]
        last = max(j for j, w in enumerate(row) if w != 0)
        needed = self.table or self.gains  # later, of the last stage's sums
        whole = self.lanes or (i == self.tableau.stages - 1 and needed)
        split = not self.lanes
        assigns: list[Assign] = []
        early = f"m{i}_" if split and last > 0 else ""
        if early:
            assigns += self._sums_of_rates(row[:last], early)
        if not split or whole or (self.table and self._counts_power(i)):
            names = tuple(self.impulses) if whole else ("t_y",)
            assigns += self._sums_of_rates(row, f"sum{i}_", names)
        share = _rational(self.tableau.c[i])
        for name in self.slips:
            start = _symbol(f"at.{name}")
            if split:
                base = self._moved_by_q(name, share)
                if early:
                    base = self._moved(name, start, early, H, share)
                value = self._moved_by_last(name, base, row[last], last)
            else:
                value = self._moved(name, start, f"sum{i}_", H, share)
            assigns.append(Assign(f"{name}{i}", value, KIND))
        part = self._part(assigns)
        state = f"const Slips y{i} = {{{', '.join(f'{name}{i}' for name in self.slips)}}};"
        call = f"const Rates k{i} = rates_at(start, y{i}, h);"
        speed = self._speed(i) if self.table and self._counts_power(i) else EMPTY
        return Part((*part.lines, state, call, *speed.lines), part.counts + rates + speed.counts)

    def _sums_of_rates(
        self, row: Sequence[Fraction], prefix: str, names: Sequence[str] = ()
    ) -> list[Assign]:
        """The impulses of a row of weights, as prefix + name."""
        return [
            Assign(
                prefix + name,
                _ordered_sum([(w, _rate(j, name)) for j, w in enumerate(row) if w], self.place_fma),
                KIND,
            )
            for name in names or self.impulses
        ]

    def _moved_by_q(self, slip: str, share: sp.Expr) -> sp.Expr:
        weight, start = self.changes[SLIPS[slip]].coeff(s.DQ) * share, _symbol(f"at.{slip}")
        return self._add(weight, H, start) if weight != 0 else start

    def _moved_by_last(self, slip: str, base: sp.Expr, weight: Fraction, stage: int) -> sp.Expr:
        """The latest impulses last, since they are known last."""
        change, total = self.changes[SLIPS[slip]], base
        for name, of in self.impulses.items():
            share = change.coeff(of) * _rational(weight)
            if share != 0:
                total = self._add(share, _rate(stage, name), total)
        return total

    def kept(self) -> tuple[Kept, ...]:
        """What each stage of a step with a table leaves, from that at its start on."""
        last = self.tableau.stages - 1
        stages = [Kept((), ("k0",), (), ("v0", "per_h", "j0"))]
        for i, row in enumerate(self.tableau.rows[1 : last + 1], 1):
            counts = self._counts_power(i)
            uses = [f"k{j}" for j, weight in enumerate(row) if weight] + ["v0"] * counts
            numbers = (f"j{i}",) if counts else ()
            stages.append(Kept(tuple(uses), (f"k{i}",), (), numbers))
        sums = tuple(f"sum{last}_{name}" for name in self.impulses)
        end = Kept(stages[-1].uses, (f"k{last}",), (f"y{last}",), (f"v{last}", f"j{last}", *sums))
        return (*stages[:-1], end)

    def _counts_power(self, i: int) -> bool:
        """Does the power of table friction at stage i enter the work or an interpolant?"""
        rows = (self.tableau.b, *self.tableau.dense)
        return i == self.tableau.stages - 1 or any(i < len(row) and row[i] != 0 for row in rows)

    def _speed(self, i: int) -> Part:
        """Approach velocity at stage i, and the work of table friction j = v t_y there."""
        driven = self._add(2 * _rational(self.tableau.c[i]), H, _symbol("v0"))
        approach = self.changes[s.V_N].coeff(s.T2Y)
        rubbed = _symbol(f"sum{i}_t_y")
        value = self._add(approach, rubbed, driven)
        power = _symbol(f"v{i}") * _rate(i, "t_y")
        return self._part([Assign(f"v{i}", value, KIND), Assign(f"j{i}", power, KIND)])

    def _add(self, a: sp.Expr, b: sp.Expr, c: sp.Expr) -> sp.Expr:
        """a * b + c in this order."""
        return Fma(a, b, c) if self.place_fma else Plus(c, a * b)

    # -- end of a step --

    def extra_stages(self) -> tuple[Part, ...]:
        """The stages that only the interpolant needs."""
        counts = self._rates().counts
        total = len(self.tableau.rows)
        return tuple(self._stage(i, counts) for i in range(self.tableau.stages, total))

    def _error(self) -> Part:
        """Differences to the embedded method in impulses, e_; to a coarser one, e3_."""
        sums = self._sums_of_rates(self.tableau.error, "e_")
        if self.tableau.second:
            sums += self._sums_of_rates(self.tableau.second_error, "e3_")
        return self._part(sums)

    def _work(self) -> Part:
        """Work of table friction over the step: it changes the square of v_n."""
        if not self.table:
            return EMPTY
        weights = [(w, _symbol(f"j{j}")) for j, w in enumerate(self.tableau.b) if w != 0]
        return self._part([Assign("j_sum", _ordered_sum(weights, self.place_fma), KIND)])

    def dense(self, names: Sequence[str]) -> Part:
        """Coefficients of the interpolant beyond the cubic: r<n>_<name> for each name."""
        assigns = []
        for n, row in enumerate(self.tableau.dense):
            for name in names:
                rates = [
                    (w, _symbol(f"j{i}") if name == "j" else _rate(i, name))
                    for i, w in enumerate(row)
                    if w != 0
                ]
                value = _ordered_sum(rates, self.place_fma)
                assigns.append(Assign(f"r{n}_{name}", value, KIND))
        return self._part(assigns)

    # -- after the collision --

    def _sums(self, q: str) -> Part:
        """Impulse sums of the whole collision: added up, or from the changes of the slips."""
        if self.gains:
            return self._part([Assign(n, _symbol(f"at.gain_{n}"), KIND) for n in self.impulses])
        assigns = [
            Assign(f"delta_{n}", _symbol(f"at.{n}") - _symbol(f"slips.{n}"), KIND)
            for n in self.slips
        ]
        deltas = {name: _symbol(f"delta_{name}") for name in self.slips}
        for name, form in self._solved(deltas, _symbol(q)).items():
            assigns.append(Assign(name, form, KIND))
        return self._part(assigns)

    def tail(self) -> Part:
        """The stages of the step into sticking: c_z falls as (1 - t)^2."""
        tableau, parts = self.tableau, ("x", "y", "q", "r")
        lines, counts = [], OperationCounts()
        for i in range(1, tableau.stages):
            row = tableau.a[i]
            moves = []
            for part in parts:
                weights = [
                    (w, _symbol(f"w{j}.k.{part}"))
                    for j, w in enumerate(row)
                    if w != 0 and tableau.c[j] < 1
                ]
                total = _ordered_sum(weights, self.place_fma)
                moves.append(
                    Assign(
                        f"z{i}_{part}", Plus(_symbol("r_0"), total) if part == "r" else total, KIND
                    )
                )
            block = self._part(moves)
            values = ", ".join(f"z{i}_{part}" for part in parts)
            left = 1 - tableau.c[i]
            # All are zero at the end.
            values_left = f"{number(_rational(left))}, {self._bent(float(left))}"
            rates = f"tail_rates(start, at, s_x0, s_y0, z{i}, {values_left})"
            if left > 0 or i == tableau.stages - 1:
                lines += [*block.lines, f"const Tail z{i} = {{{values}}};"]
            if left > 0:
                lines.append(f"const TailRates w{i} = {rates};")
            counts = counts + block.counts
        assigns = self._tail_errors(tableau.error, "e5" if tableau.second else "e", parts[:2])
        assigns += self._tail_errors(tableau.error, "e", parts[2:3])
        joint: tuple[str, ...] = ()
        if tableau.second:
            assigns += self._tail_errors(tableau.second_error, "e3", parts[:2])
            joint = tuple(f"{KIND} e_{n} = joint_error(e5_{n}, e3_{n});" for n in parts[:2])
        used = [j for j, w in enumerate(tableau.b) if w != 0 and tableau.c[j] < 1]
        power = [Assign(f"p{j}", _symbol(f"w{j}.v") * _symbol(f"w{j}.k.y"), KIND) for j in used]
        mean = _ordered_sum([(tableau.b[j], _symbol(f"p{j}")) for j in used], self.place_fma)
        end = self._part([*assigns, *power, Assign("dj", mean, KIND)])
        return Part((*lines, *end.lines, *joint), counts + end.counts)

    def _tail_errors(
        self, row: Sequence[Fraction], prefix: str, parts: Sequence[str]
    ) -> list[Assign]:
        used = [(w, j) for j, w in enumerate(row) if w != 0 and self.tableau.c[j] < 1]
        if not used:
            raise ValueError(
                f"tableau {self.tableau.name}: its error estimate weighs only stages at the end of "
                "a step, so it sees nothing of the step into sticking, whose rates are zero there; "
                "expected a weight for a stage before the end"
            )
        return [
            Assign(
                f"{prefix}_{part}",
                _ordered_sum([(w, _symbol(f"w{j}.k.{part}")) for w, j in used], self.place_fma),
                KIND,
            )
            for part in parts
        ]

    def _solved(self, deltas: dict[str, sp.Symbol], q: sp.Expr) -> dict[str, sp.Expr]:
        """d_x, d_z, t_x, t_y that change the slips by `deltas` while the normal impulse is q."""
        unknowns = (s.D_X, s.D_Z, s.T2X, s.T2Y) if self.table else (s.D_X, s.D_Z)
        rows = [self.changes[slip] for slip in self.slips.values()]
        matrix = sp.Matrix([[row.coeff(u) for u in unknowns] for row in rows])
        right = sp.Matrix(
            [deltas[n] - row.coeff(s.DQ) * q for n, row in zip(self.slips, rows, strict=True)]
        )
        solution = matrix.LUsolve(right)
        names = ("d_x", "d_z", "t_x", "t_y")[: len(unknowns)]
        return {n: sp.expand(sp.cancel(v)) for n, v in zip(names, solution, strict=True)}

    def _part(self, assigns: list[Assign]) -> Part:
        steps = [step for assign in assigns for step in unfolded(assign)]
        block = lower(steps, self.printer)
        return Part(tuple(block.lines), block.counts)


def _rate(stage: int, name: str) -> sp.Symbol:
    return _symbol(f"k{stage}.{name}")


def _rational(weight: Fraction) -> sp.Rational:
    return sp.Rational(weight.numerator, weight.denominator)


def _ordered_sum(weights: Sequence[tuple[Fraction, sp.Symbol]], place_fma: bool) -> sp.Expr:
    """w0 k0 + w1 k1 + ... in this order; zero where there is nothing to add."""
    if not weights:
        return sp.Integer(0)
    (first, rate), *rest = weights
    total: sp.Expr = _rational(first) * rate
    for weight, rate in rest:
        w = _rational(weight)
        total = Fma(w, rate, total) if place_fma else Plus(total, w * rate)
    return total
