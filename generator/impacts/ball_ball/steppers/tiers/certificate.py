"""Which fixed steps are exact enough for a collision, known before they are made."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from .....lowering.lane_algebra import (
    Fields,
    Lines,
    Number,
    absolute,
    both,
    constant,
    fma,
    given,
    larger,
    mask,
    number,
    rough_inverse,
    rough_rsqrt,
    select,
    smaller,
)
from ..exact.lengths import times
from ..exact.pressed import Pressed
from .bounds import Bound, ByPhase, Term, Tier
from .whole import PRINTER, Text

TINY = constant("kTinySquare")
RESTS = 2e-7  # of the approach velocity: a table slip that is none
LEAST_LEFT = 0.05  # of the way to sticking: beyond it no step of the second phase is tried
WORST_PHASE = 2  # its weights are those of a worst step over all of q
SETS_OFF = 1e-6  # of it: where the table slip is put that was none, on the way that it will go


def certificate(bound: Bound, pressed: Pressed) -> Text:
    """Whether one step does (`tier0`), a step h over all, and the slips to start from."""
    lines = Lines(PRINTER)
    v, u_b, u_s, end = number("approach_1"), number("u_b"), number("u_s"), Fields("end")
    per_c, n_z = _direction(lines)
    push = lines.number("push", u_b * n_z)
    phi = lines.number("phi", u_s * push, "table friction per unit of q")
    q = lines.number("q", end.half * v, "the normal impulse, but for table friction")
    b_x = lines.number("b_x", given(pressed.recoil) * u_b * (number("slips.c_x") * per_c))
    b_y = lines.number("b_y", fma(given(pressed.k_b), push, given(pressed.drive)))
    _set_off(lines, b_x, b_y)
    at = Fields("at")
    n_0 = lines.number("n_0", fma(at.s_x, at.s_x, fma(at.s_y, at.s_y, TINY)))
    e_x, e_y = lines.number("e_x", fma(q, b_x, at.s_x)), lines.number("e_y", fma(q, b_y, at.s_y))
    n_1 = lines.number("n_1", fma(e_x, e_x, fma(e_y, e_y, TINY)))
    per_0, per_1 = lines.number("per_0", rough_rsqrt(n_0)), lines.number("per_1", rough_rsqrt(n_1))
    lines.remark("Friction along the line of centres at both ends of the straight path")
    f_0, f_1 = (
        lines.number(f"f_{i}", -phi * (y * per))
        for i, y, per in ((0, at.s_y, per_0), (1, e_y, per_1))
    )
    mean = lines.number("mean", f_0 + f_1)
    share = fma(end.bend * mean, mean, fma(-end.first, f_0, fma(-end.last, f_1, end.half)))
    lines.number("h", share * v)
    lines.remark("How near sticking, and a passage of the table slip by zero, come to the step")
    part = _way(lines, pressed, per_c, n_z)
    lines.number("reach", part * rough_inverse(2 - part))
    n_b = lines.number("n_b", fma(b_x, b_x, b_y * b_y))
    per_b = lines.number("per_b", rough_rsqrt(n_b))
    whole = fma(n_0, per_0, n_1 * per_1)
    near_0 = lines.number("near_0", n_b * per_b * q * rough_inverse(whole))
    lines.number("near", select(mask("rests"), 0, near_0))
    _weighed_by(lines, bound, pressed)
    lines.number("rubs", push * q)
    _rubbed(lines, bound)
    lines.number("reach_3", _cube(number("reach")))
    lines.number("near_3", _cube(number("near")))
    _tier(lines, bound.whole, 0)
    return lines.part()


def _set_off(lines: Lines, b_x: Number, b_y: Number) -> None:
    """A table slip of zero is put a little way along the path that it is driven on."""
    v = number("approach_1")
    s_x, s_y = number("slips.s_x"), number("slips.s_y")
    size = fma(s_x, s_x, s_y * s_y)
    rests = lines.mask("rests", size <= RESTS**2 * v * v)
    little = lines.number("little", SETS_OFF * v)
    at = Fields("at")
    lines.set(at.s_x, select(rests, little * b_x, s_x))
    lines.set(at.s_y, select(rests, little * b_y, s_y))


def further(bound: Bound, pressed: Pressed) -> Text:
    """Of collisions that the first tier is not for: a mask for each of the others.

    From `slips`, `approach_1`, `u_b`, `u_s`, `near` and `relative`, as `certificate` has them.
    """
    lines = Lines(PRINTER)
    _, n_z = _direction(lines)
    lines.number("push", number("u_b") * n_z)
    lines.number("q", number("end.half") * number("approach_1"))
    _weighed_by(lines, bound, pressed)
    _phases(lines, bound, pressed)
    if any(isinstance(tier, Tier) for tier in bound.tiers[1:]):
        _rubbed(lines, bound)
    for i, tier in enumerate(bound.tiers[1:], 1):
        if isinstance(tier, ByPhase):
            _tier_by_phase(lines, tier, i)
        else:
            _in_steps(lines, tier, i)
    return lines.part()


def _direction(lines: Lines) -> tuple[Number, Number]:
    """1 / |c|, and the share of c that presses the ball."""
    c_x, c_z = number("slips.c_x"), number("slips.c_z")
    per_c = lines.number("per_c", rough_rsqrt(fma(c_x, c_x, fma(c_z, c_z, TINY))))
    return per_c, lines.number("n_z", -c_z * per_c)


def _way(lines: Lines, pressed: Pressed, per_c: Number, n_z: Number) -> Number:
    """How far the collision goes to sticking, at most to its end."""
    most = max(float(pressed.k_x), float(pressed.k_z))
    fall = fma(given(pressed.k_zt) * number("u_s"), n_z, most)
    way = lines.number("way", fall * number("u_b") * number("q") * per_c)
    return lines.number("part", smaller(way, 1))


def _weighed_by(lines: Lines, bound: Bound, pressed: Pressed) -> None:
    """What the certificates of all tiers are made of."""
    across = times(pressed.k_x - pressed.k_z, absolute(number("slips.c_x")))
    lines.number("n_x", across * number("per_c"))
    lines.number("room", bound.error * number("relative"))


def _rubbed(lines: Lines, bound: Bound) -> None:
    """Are frictions within what the weights were found in?"""
    u_b, u_s = number("u_b"), number("u_s")
    within = u_s * u_b <= bound.most_friction
    for friction, most in ((u_b, bound.most_u_b), (u_s, bound.most_u_s)):
        within = both(within, friction <= most) if most < 1 else within
    lines.mask("rubbed", within)


def _in_steps(lines: Lines, tier: Tier, i: int) -> None:
    """The mask `tier<i>` of many steps a phase, by reach and near of the worst of either phase's.

    Its last step ends where its way does. The passage counts as in the middle of a step, the worst
    place: 1/near^2 - 1 is the square of what it misses zero by, over half of the step.
    """
    missed = []
    for phase in "ab":
        name = f"{phase}{tier.steps}"
        part, near = number(f"part_{phase}"), number(f"near_{phase}")
        edge = lines.number(f"edge_{name}", Fraction(1, 2 * tier.steps) * part)
        lines.number(f"reach_{name}", edge * rough_inverse(edge + (1 - part)))
        square = lines.number(f"square_{name}", near * near)
        miss = fma(tier.steps**2, larger(1 - square, 0), square)
        lines.number(f"near_{name}", near * rough_rsqrt(miss))
        _powers(lines, f"reach_{name}", {t.reach for t in tier.terms})
        _powers(lines, f"near_{name}", {t.near for t in tier.terms})
        off = number(f"q_{phase}") * _weighed(lines, tier, f"_{name}", f"_{name}")
        missed.append(lines.number(f"off_{name}", off))
    total = lines.number(f"off{i}", WORST_PHASE * number("push") * (missed[0] + missed[1]))
    within = both(number("most_way") < tier.most_way, number("most_near") < tier.most_near)
    lines.mask(f"tier{i}", both(both(within, mask("rubbed")), total < number("room")))


def _tier(lines: Lines, tier: Tier, i: int) -> None:
    """A mask `tier<i>`: would it be exact enough?"""
    off = lines.number(f"off{i}", number("rubs") * _weighed(lines, tier, str(i), ""))
    within = both(number("way") < tier.most_way, number("near") < tier.most_near)
    lines.mask(f"tier{i}", both(both(within, mask("rubbed")), off < number("room")))


def _weighed(lines: Lines, tier: Tier, i: str, steps: str) -> Number:
    """What a way misses over the impulse of friction; `steps`: what names of its step end with."""
    rub = _total(lines, f"passes{i}", steps, [t for t in tier.terms if not t.turning])
    if tier.work:
        rub = fma(number("end.work") * number("near"), number("near_3"), rub)
    turn = _total(lines, f"turns{i}", steps, [t for t in tier.terms if t.turning])
    return fma(number("u_s"), rub, number("n_x") * turn)


def _phases(lines: Lines, bound: Bound, pressed: Pressed) -> None:
    """Normal impulse, reach and near of either phase: q_a, reach_a, ..., and powers."""
    tiers = [tier for tier in bound.tiers if isinstance(tier, ByPhase)]
    u_b, u_s, per_c, q = number("u_b"), number("u_s"), number("per_c"), number("q")
    n_c = lines.number("n_c", number("slips.c_x") * per_c)
    turned = fma(given(pressed.k_x - pressed.k_z) * n_c, n_c, pressed.k_z)
    fall = fma(given(pressed.k_zt) * u_s, number("n_z"), turned)
    pace = lines.number("pace", fall * u_b * per_c, "of the way to sticking, per unit of q")
    q_a = lines.number("q_a", number("end.w") * q)
    q_b = lines.number("q_b", q - q_a)
    way_a = lines.number("way_a", pace * q_a)
    way_b = lines.number("way_b", pace * q_b * rough_inverse(larger(1 - way_a, LEAST_LEFT)))
    for phase, way in (("a", way_a), ("b", way_b)):
        part = lines.number(f"part_{phase}", smaller(way, 1))
        lines.number(f"reach_{phase}", part * rough_inverse(2 - part))
    _near_phases(lines, pressed, q_a, q_b)
    for phase in "ab":
        terms = [term for tier in tiers for term in _of(tier, phase)]
        _powers(lines, f"reach_{phase}", {t.reach for t in terms})
        _powers(lines, f"near_{phase}", {t.near for t in terms})
    lines.number("most_way", larger(way_a, way_b))
    lines.number("most_near", larger(number("near_a"), number("near_b")))


def _near_phases(lines: Lines, pressed: Pressed, q_a: Number, q_b: Number) -> None:
    """near of either phase: the straight path is cut where v_n = 0."""
    slips, push, u_b = Fields("slips"), number("push"), number("u_b")
    b_x = lines.number("b_x", given(pressed.recoil) * u_b * number("n_c"))
    b_y = lines.number("b_y", fma(given(pressed.k_b), push, given(pressed.drive)))
    lengths = []
    for name, q in (("0", None), ("m", q_a), ("1", number("q"))):
        x = slips.s_x if q is None else lines.number(f"s_x{name}", fma(q, b_x, slips.s_x))
        y = slips.s_y if q is None else lines.number(f"s_y{name}", fma(q, b_y, slips.s_y))
        n = lines.number(f"n_{name}", fma(x, x, fma(y, y, TINY)))
        lengths.append(lines.number(f"l_{name}", n * rough_rsqrt(n)))
    n_b = lines.number("n_b", fma(b_x, b_x, b_y * b_y))
    l_b = lines.number("l_b", n_b * rough_rsqrt(n_b))
    rests = lines.mask("rests", number("near") <= 0)
    for phase, q, i in (("a", q_a, 0), ("b", q_b, 1)):
        passes = l_b * q * rough_inverse(lengths[i] + lengths[i + 1])
        lines.number(f"near_{phase}", select(rests, 0, lines.number(f"passes_{phase}", passes)))


def _tier_by_phase(lines: Lines, tier: ByPhase, i: int) -> None:
    """The mask `tier<i>` of steps whose certificate asks of either phase."""
    u_b, u_s, missed = number("u_b"), number("u_s"), []
    for phase in "ab":
        terms = _of(tier, phase)
        rub = _total(lines, f"passes{i}{phase}", f"_{phase}", [t for t in terms if not t.turning])
        turn = _total(lines, f"turns{i}{phase}", f"_{phase}", [t for t in terms if t.turning])
        missed.append(number(f"q_{phase}") * fma(u_s, rub, number("n_x") * turn))
    off = lines.number(f"off{i}", number("push") * (missed[0] + missed[1]))
    within = both(number("most_way") < tier.most_way, number("most_near") < tier.most_near)
    rubbed = both(u_b <= tier.most_u_b, u_s <= tier.most_u_s)
    rubbed = both(rubbed, u_s * u_b <= tier.most_friction)
    lines.mask(f"tier{i}", both(both(within, rubbed), off < number("room")))


def _of(tier: ByPhase, phase: str) -> tuple[Term, ...]:
    return tier.first if phase == "a" else tier.second


def _powers(lines: Lines, name: str, asked: set[int]) -> None:
    """The powers of a number that terms ask for, made once: reach_a_3, reach_a_6, ..."""
    x, cube = number(name), number(f"{name}_3")
    for cubes in _made_of(asked - {0}):
        half = number(f"{name}_{3 * (cubes // 2)}")
        value = _cube(x) if cubes == 1 else half * half * (cube if cubes % 2 else 1)
        lines.number(f"{name}_{3 * cubes}", value)


def _made_of(powers: set[int]) -> list[int]:
    """The powers, and those that they are made of: halves, and 1 for odd ones."""
    made, left = set(powers), set(powers)
    while left:
        power = left.pop()
        new = {power // 2, power % 2} - made - {0}
        made |= new
        left |= new
    return sorted(made)


def _cube(x: Number) -> Number:
    return x * x * x


def _total(lines: Lines, name: str, steps: str, terms: Sequence[Term]) -> Number:
    """A polynomial of reach^3 and near^3; small powers are made once."""
    total: Number | None = None
    for term in terms:
        product = _power(f"reach{steps}", term.reach)
        other = _power(f"near{steps}", term.near)
        factors = [f for f in (product, other) if f is not None]
        value = factors[0] if len(factors) == 1 else factors[0] * factors[1]
        total = term.weight * value if total is None else fma(term.weight, value, total)
    if total is None:
        raise ValueError(f"{name}: a certificate needs a term")
    return lines.number(name, total)


def _power(of: str, cubes: int) -> Number | None:
    """of^(3 cubes), from the names that are there."""
    if "_" in of:
        return number(f"{of}_{3 * cubes}") if cubes else None
    cube = number(f"{of}_3")
    known = {0: None, 1: cube, 2: cube * cube, 3: cube * cube * cube}
    return known.get(cubes, (cube * cube) * (cube * cube))
