"""Lowering of the exact steppers: one adaptive Runge-Kutta step of the reduced system.

The normal impulse q (divided by M, in m/s) is the independent variable and the slips are the state;
SymPy gives their rates and, after the collision, the impulse sums. The tableau gives the stages.
Everything is printed in the lane vocabulary.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import sympy as sp

from generator.lowering.chains import unfolded
from generator.lowering.counts import OperationCounts
from generator.lowering.fixed_step import Part
from generator.lowering.printer import ExpressionPrinter, Fma, Plus
from generator.lowering.statements import Assign, lower
from generator.mechanics import symbols as s
from generator.mechanics.contact import ContactTerms
from generator.mechanics.masses import EQUAL, Masses, pressed_changes
from generator.steppers.tableaus import Tableau

# The slips that a step carries, in the order of struct Slips, and what they are in the mechanics.
SLIPS: dict[str, sp.Symbol] = {"c_x": s.C_X, "c_z": s.C_Z, "s_x": s.S2X, "s_y": s.S2Y}
CONTACT = ("c_x", "c_z")  # all that a step carries where there is no table friction
RATES = (*SLIPS, "t_y")  # rates also hold what table friction along y adds to that of v_n
KIND = "const Real"
H = sp.Symbol("h", real=True)
EMPTY = Part((), OperationCounts())


def _symbol(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


@dataclass(frozen=True)
class ExactStep:
    """The parts of one step, printed."""

    rates: Part  # rates of the slips from the slips and the inverse lengths i_c, i_s
    stages: tuple[Part, ...]
    error: Part
    step: Part  # table friction's share of v_n and of the work
    gains: Part  # what a step adds to the slips, where they are too coarse to be subtracted
    sums: Part  # impulse sums from the changes of the slips
    counts: OperationCounts  # of one step, without the roots and the control


class ExactLowering:
    """Prints the parts of a step for one contact model, pair of masses and tableau.

    Ball 2 is the pressed one: with sigma = -1 for a pressed ball 1, the slips s, the table
    increments t, c_z and d_z times sigma obey the same system, with the masses in each other's
    place. Without a table only the contact slip is carried. `gains`: slips are carried in float, so
    that what they have changed by is added up beside them.
    """

    def __init__(
        self,
        terms: ContactTerms,
        tableau: Tableau,
        place_fma: bool,
        masses: Masses = EQUAL,
        table: bool = True,
        gains: bool = False,
    ) -> None:
        self.terms = terms
        self.tableau = tableau
        self.place_fma = place_fma
        self.table = table
        self.gains = gains
        self.slips = SLIPS if table else {name: SLIPS[name] for name in CONTACT}
        self.printer = ExpressionPrinter(place_fma, fma_name="fma", number_format="real({})")
        self.changes = pressed_changes(terms, masses)

    def parts(self) -> ExactStep:
        rates = self._rates()
        stages = tuple(self._stage(i, rates.counts) for i in range(1, self.tableau.stages))
        error, step = self._error(), self._step()
        total = error.counts + step.counts
        for stage in stages:
            total = total + stage.counts
        gains = self._gains() if self.gains else Part((), OperationCounts())
        total = total + gains.counts + self._laid_out()
        return ExactStep(rates, stages, error, step, gains, self._sums(), total)

    def _laid_out(self) -> OperationCounts:
        """What templates/exact lays out around the printed parts of a step.

        Squares of slips, the pace and the first rates of a clustered step, the size of the error.
        """
        added = OperationCounts(fma=1) if self.place_fma else OperationCounts(add=1, mul=1)
        evaluations = self.tableau.stages - 1
        if self.table:
            total = (added * 4 + OperationCounts(mul=1)) * evaluations
            total = total + OperationCounts(add=2, mul=11, div=1)
        else:
            total = added * (2 * evaluations + 1) + OperationCounts(mul=4)
        if self.tableau.second:
            joint = OperationCounts(add=1, mul=2, div=1, sqrt=1) + added
            total = total + joint * (4 if self.table else 2)
        return total

    # -- rates --

    def _rates(self) -> Part:
        """Rates with the inverse lengths multiplied in last, which keeps the critical chain short.

        p = -u_b c is contact friction times |c|, z = -u_s p_z s table friction times |c| |s|.
        """
        p_x, p_z, z_x, z_y, i_c, i_cs = (
            _symbol(n) for n in ["p_x", "p_z", "z_x", "z_y", "i_c", "i_cs"]
        )
        u_b = _symbol("u_b" if self.table else "start.u_b")
        u_s = _symbol("start.u_s")
        slips = {name: _symbol(f"at.{name}") for name in self.slips}
        assigns = [
            Assign("p_x", -u_b * slips["c_x"], KIND),
            Assign("p_z", -u_b * slips["c_z"], KIND),
        ]
        if self.table:
            assigns += [
                Assign("g", -u_s * p_z, KIND),
                Assign("z_x", _symbol("g") * slips["s_x"], KIND),
                Assign("z_y", _symbol("g") * slips["s_y"], KIND),
                Assign("i_cs", i_c * _symbol("i_s"), KIND),
            ]
        for name, slip in self.slips.items():
            change = self.changes[slip]
            contact = change.coeff(s.D_X) * p_x + change.coeff(s.D_Z) * p_z
            table = change.coeff(s.T2X) * z_x + change.coeff(s.T2Y) * z_y
            fixed = change.coeff(s.DQ) * (_symbol("pace") if self.table else 1)
            value = self._add(i_c, contact, fixed) if fixed != 0 else i_c * contact
            if self.table:
                value = self._add(i_cs, table, value)
            assigns.append(Assign(f"r_{name}", value, KIND))
        if self.table:
            approach = self.changes[s.V_N].coeff(s.T2Y)
            assigns.append(Assign("r_t_y", approach * i_cs * z_y, KIND))
        return self._part(assigns)

    # -- stages --

    def _stage(self, i: int, rates: OperationCounts) -> Part:
        """Slips at stage i, and the rates there by `rates_at`."""
        row = self.tableau.rows[i]
        last = max(j for j, w in enumerate(row) if w != 0)
        reach = _symbol(f"h{i}")
        assigns = [Assign(reach.name, _rational(row[last]) * H, KIND)]
        for name in self.slips:
            early = [(w, _rate(j, name)) for j, w in enumerate(row[:last]) if w != 0]
            start = _symbol(f"at.{name}")
            ready = self._add(H, _ordered_sum(early, self.place_fma), start) if early else start
            assigns.append(Assign(f"{name}{i}", self._add(reach, _rate(last, name), ready), KIND))
        part = self._part(assigns)
        slips = ", ".join(f"{name}{i}" for name in self.slips)
        state = f"const Slips y{i} = {{{slips}}};"
        if not self.table:
            call = f"const Rates k{i} = rates_at(start, y{i});"
            return Part((*part.lines, state, call), part.counts + rates)
        pace = self._add(_symbol("cluster"), _rational(1 - 2 * self.tableau.c[i]), sp.Integer(1))
        paced = self._part([Assign(f"pace{i}", pace, KIND)])
        call = f"const Rates k{i} = rates_at(start, y{i}, pace{i});"
        speed = self._speed(i) if self._counts_power(i) else EMPTY
        lines = (*part.lines, state, *paced.lines, call, *speed.lines)
        return Part(lines, part.counts + rates + paced.counts + speed.counts)

    def _counts_power(self, i: int) -> bool:
        """Does the power of table friction at stage i enter the work or an interpolant?"""
        rows = (self.tableau.b, *self.tableau.dense)
        return i == self.tableau.stages - 1 or any(i < len(row) and row[i] != 0 for row in rows)

    def _speed(self, i: int) -> Part:
        """Approach velocity at stage i, and the power of table friction j = v t_y there."""
        weights = [(w, _rate(j, "t_y")) for j, w in enumerate(self.tableau.rows[i]) if w != 0]
        c = self.tableau.c
        driven = self._add(2 * _rational(c[i]), H, _symbol("v0"))
        bent = sum((w * (1 - 2 * c[j]) for j, w in enumerate(self.tableau.rows[i])), Fraction(0))
        if bent:
            driven = self._add(2 * _rational(bent), _symbol("h_cluster"), driven)
        value = self._add(H, _ordered_sum(weights, self.place_fma), driven)
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
        """Difference to the embedded method per unit of h, as impulse sums."""
        if not self.tableau.second:
            return self._difference(self.tableau.error, "e")
        fine, coarse = (
            self._difference(row, f"e{order}")
            for row, order in ((self.tableau.error, 5), (self.tableau.second_error, 3))
        )
        names = ("d_x", "d_z", "t_x", "t_y") if self.table else ("d_x", "d_z")
        joint = tuple(f"{KIND} e_{n} = joint_error(e5_{n}, e3_{n});" for n in names)
        return Part((*fine.lines, *coarse.lines, *joint), fine.counts + coarse.counts)

    def _difference(self, row: Sequence[Fraction], prefix: str) -> Part:
        """A weighted sum of the rates, as the impulse sums that would change the slips so."""
        assigns = []
        for name in self.slips:
            weights = [(w, _rate(j, name)) for j, w in enumerate(row) if w != 0]
            assigns.append(Assign(f"{prefix}_{name}", _ordered_sum(weights, self.place_fma), KIND))
        deltas = {name: _symbol(f"{prefix}_{name}") for name in self.slips}
        for name, form in self._solved(deltas, sp.Integer(0)).items():
            assigns.append(Assign(f"{prefix}_{name}", form, KIND))
        return self._part(assigns)

    def _step(self) -> Part:
        """Mean power of table friction over the step: it changes the square of v_n."""
        if not self.table:
            return Part((), OperationCounts())
        weights = [(w, _symbol(f"j{j}")) for j, w in enumerate(self.tableau.b) if w != 0]
        return self._part([Assign("j_mean", _ordered_sum(weights, self.place_fma), KIND)])

    def dense(self, names: Sequence[str]) -> Part:
        """Coefficients of the interpolant beyond the cubic, per h: r<n>_<name> for each name."""
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

    def _gains(self) -> Part:
        """What the step adds to each slip, made apart: a sum with the slip would round it."""
        assigns = []
        for name in self.slips:
            weights = [(w, _rate(j, name)) for j, w in enumerate(self.tableau.b) if w != 0]
            assigns.append(Assign(f"mean_{name}", _ordered_sum(weights, self.place_fma), KIND))
        return self._part(assigns)

    def _sums(self) -> Part:
        """Impulse sums of the whole collision from the changes of the slips."""
        assigns = [
            Assign(f"delta_{n}", _symbol(f"at.{n}") - _symbol(f"start.{n}"), KIND)
            for n in self.slips
            if not self.gains
        ]
        prefix = "at.gain_" if self.gains else "delta_"
        deltas = {name: _symbol(f"{prefix}{name}") for name in self.slips}
        for name, form in self._solved(deltas, _symbol("at.q")).items():
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
            number = self.printer.print(_rational(left))
            rates = f"tail_rates(start, from, z{i}, {number})"  # all are zero at the end
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
