"""Explicit Runge-Kutta tableaus with embedded error estimates, in exact rationals.

A tableau is data: lowering/exact_step.py turns it into statements. To add one: a `Tableau` here;
tests check its order conditions and its convergence (docs/adding-a-stepper.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from . import dop853

Row = tuple[Fraction, ...]


def _row(text: str, total: str = "") -> Row:
    """Weights; with a total, `_` comes first and is what the others leave of it.

    Coefficients published as rounded numbers then satisfy at least the row sums exactly.
    """
    words = text.split()
    if not total:
        return tuple(Fraction(word) for word in words)
    others = tuple(Fraction(word) for word in words[1:])
    return (Fraction(total) - sum(others), *others)


@dataclass(frozen=True)
class Tableau:
    """An explicit method of `order` with an embedded one of `embedded_order`.

    `a` is lower triangular, row i the weights of stages 0..i-1. The last row of `a` equals `b`
    (first same as last): its stage is the first of the next step.
    """

    name: str
    order: int
    embedded_order: int
    a: tuple[Row, ...]
    embedded: Row  # weights of the embedded method, one a stage
    source: str
    dense: tuple[Row, ...] = ()  # the interpolant's coefficients beyond the cubic of Hermite
    extra: tuple[Row, ...] = ()  # further stages, for the interpolant alone
    second: Row = ()  # weights of a second, coarser embedded method that steadies the estimate
    rounding: float = 0.0  # how far published roundings may be from the order conditions

    @property
    def stages(self) -> int:
        return len(self.a)

    @property
    def rows(self) -> tuple[Row, ...]:
        """The weights of all stages, the interpolant's own included."""
        return (*self.a, *self.extra)

    @property
    def b(self) -> Row:
        """Weights of the method itself, with 0 for the last stage."""
        return (*self.a[-1], Fraction(0))

    @property
    def c(self) -> Row:
        return tuple(sum(row, Fraction(0)) for row in self.rows)

    @property
    def error(self) -> Row:
        """Weights of the difference between the method and the embedded one."""
        return tuple(b - e for b, e in zip(self.b, self.embedded, strict=True))

    @property
    def second_error(self) -> Row:
        """Weights of the difference between the method and the coarser embedded one."""
        return tuple(b - e for b, e in zip(self.b, self.second, strict=True)) if self.second else ()


MIDPOINT_21 = Tableau(
    "mid21",
    2,
    1,
    (
        _row(""),
        _row("1/2"),
        _row("0 1"),
    ),
    _row("1 0 0"),
    "midpoint rule (Runge, Math. Ann. 46 (1895) 167) with Euler embedded",
)

BOGACKI_SHAMPINE_32 = Tableau(
    "bs32",
    3,
    2,
    (_row(""), _row("1/2"), _row("0 3/4"), _row("2/9 1/3 4/9")),
    _row("7/24 1/4 1/3 1/8"),
    "Bogacki, Shampine, Appl. Math. Lett. 2 (1989) 321",
)

SOFRONIOU_SPALETTA_43 = Tableau(
    "ss43",
    4,
    3,
    (
        _row(""),
        _row("2/5"),
        _row("-3/20 3/4"),
        _row("19/44 -15/44 10/11"),
        _row("11/72 25/72 25/72 11/72"),
    ),
    _row("1251515/8970912 3710105/8970912 2519695/8970912 61105/8970912 119041/747576"),
    "Sofroniou, Spaletta, Math. Comput. Modelling 40 (2004) 1157",
)

DORMAND_PRINCE_54 = Tableau(
    "dp54",
    5,
    4,
    (
        _row(""),
        _row("1/5"),
        _row("3/40 9/40"),
        _row("44/45 -56/15 32/9"),
        _row("19372/6561 -25360/2187 64448/6561 -212/729"),
        _row("9017/3168 -355/33 46732/5247 49/176 -5103/18656"),
        _row("35/384 0 500/1113 125/192 -2187/6784 11/84"),
    ),
    _row("5179/57600 0 7571/16695 393/640 -92097/339200 187/2100 1/40"),
    "Dormand, Prince, J. Comput. Appl. Math. 6 (1980) 19",
    (  # Shampine's quartic, as in Hairer, Norsett, Wanner, Solving ODEs I, DOPRI5
        _row(
            "-12715105075/11282082432 0 87487479700/32700410799 -10690763975/1880347072 "
            "701980252875/199316789632 -1453857185/822651844 69997945/29380423"
        ),
    ),
)

TSITOURAS_54 = Tableau(
    "ts54",
    5,
    4,
    (
        _row(""),
        _row("0.161"),
        _row("-0.00848065549235698854 0.33548065549235698854"),
        _row("2.89715305710549343213 -6.35944848997507484315 4.36229543286958141102"),
        _row(
            "5.32586482843925660444 -11.74888356406282787775 7.4955393428898362083 "
            "-0.09249506636175524926"
        ),
        _row(
            "5.86145544294642002866 -12.92096931784710929171 8.15936789857615864318 "
            "-0.07158497328140099722 -0.02826905039406838291"
        ),
        _row(
            "0.09646076681806522951 0.01 0.47988965041449957478 1.37900857410374189319 "
            "-3.2900695154360806799 2.32471052409977398242"
        ),
    ),
    _row(
        "_ 0.0091835655403432531 0.48777052842476157079 1.23429756693047898566 "
        "-2.70771234998352545488 1.86662841817058703575 1/66",
        "1",
    ),
    "Tsitouras, Comput. Math. Appl. 62 (2011) 770",
    rounding=1e-18,
)

VERNER_65 = Tableau(
    "vr65",
    6,
    5,
    (
        _row(""),
        _row("9/50"),
        _row("29/324 25/324"),
        _row("1/16 0 3/16"),
        _row("79129/250000 0 -261237/250000 19663/15625"),
        _row("1336883/4909125 0 -25476/30875 194159/185250 8225/78546"),
        _row("-2459386/14727375 0 19504/30875 2377474/13615875 -6157250/5773131 902/735"),
        _row("2699/7410 0 -252/1235 -1393253/3993990 236875/72618 -135/49 15/22"),
        _row("11/144 0 0 256/693 0 125/504 125/528 5/72"),
    ),
    _row("28/477 0 0 212/441 -312500/366177 2125/1764 0 -2105/35532 2995/17766"),
    "Verner, Numer. Algorithms 53 (2010) 383, the 'most robust' pair of 9 stages",
)

SHARP_VERNER_76 = Tableau(
    "sv76",
    7,
    6,
    (
        _row(""),
        _row("1/12"),
        _row("4/243 32/243"),
        _row("1/18 0 1/6"),
        _row("5/9 0 -25/12 25/12"),
        _row("1/15 0 0 1/3 4/15"),
        _row("319/3840 0 0 161/1536 -41/960 11/512"),
        _row("245/5184 0 0 1627/10368 151/1296 -445/10368 1/6"),
        _row(
            "-556349853/7539261440 0 0 -4356175383/3015704576 -814787343/1884815360 "
            "831004641/3015704576 355452237/235601920 107943759/117800960"
        ),
        _row(
            "-68998698967/1063035863040 0 0 -767387292485/425214345216 "
            "-205995991597/265758965760 -22181208863/141738115072 26226796959/15502606336 "
            "1614200643/1107329024 187/329"
        ),
        _row(
            "24511479161/17979371520 0 0 3889847115/217931776 22028391/3681280 "
            "614528179/217931776 -148401247/10215552 -3122234829/318384704 -4160/1221 "
            "15040/20757"
        ),
        _row("5519/110880 0 0 0 0 83/560 932/3675 282123/1047200 2624/24255 3008/19635 37/2100"),
    ),
    _row(
        "15509/341880 0 0 0 0 6827/15540 22138/81585 78003/387464 -64144/299145 623408/2179485 "
        "0 -15/518"
    ),
    "Sharp, Verner, SIAM J. Numer. Anal. 31 (1994) 1169",
)

DORMAND_PRINCE_87 = Tableau(
    "dp87",
    8,
    7,
    (
        _row(""),
        _row("1/18"),
        _row("1/48 1/16"),
        _row("1/32 0 3/32"),
        _row("5/16 0 -75/64 75/64"),
        _row("3/80 0 0 3/16 3/20"),
        _row("_ 0 0 77736538/692538347 -28693883/1125000000 23124283/1800000000", "59/400"),
        _row(
            "_ 0 0 61564180/158732637 22789713/633445777 545815736/2771057229 "
            "-180193667/1043307555",
            "93/200",
        ),
        _row(
            "_ 0 0 -433636366/683701615 -421739975/2616292301 100302831/723423059 "
            "790204164/839813087 800635310/3783071287",
            "5490023248/9719169821",
        ),
        _row(
            "_ 0 0 -37695042795/15268766246 -309121744/1061227803 -12992083/490766935 "
            "6005943493/2108947869 393006217/1396673457 123872331/1001029789",
            "13/20",
        ),
        _row(
            "_ 0 0 8478235783/508512852 1311729495/1432422823 -10304129995/1701304382 "
            "-48777925059/3047939560 15336726248/1032824649 -45442868181/3398467696 "
            "3065993473/597172653",
            "1201146811/1299019798",
        ),
        _row(
            "_ 0 0 -3185094517/667107341 -477755414/1098053517 -703635378/230739211 "
            "5731566787/1027545527 5232866602/850066563 -4093664535/808688257 "
            "3962137247/1805957418 65686358/487910083",
            "1",
        ),
        _row(
            "_ 0 0 -5068492393/434740067 -411421997/543043805 652783627/914296604 "
            "11173962825/925320556 -13158990841/6184727034 3936647629/1978049680 "
            "-160528059/685178525 248638103/1413531060",
            "1",
        ),
        _row(
            "_ 0 0 0 0 -59238493/1068277825 181606767/758867731 561292985/797845732 "
            "-1041891430/1371343529 760417239/1151165299 118820643/751138087 "
            "-528747749/2220607170 1/4",
            "1",
        ),
    ),
    _row(
        "_ 0 0 0 0 -808719846/976000145 1757004468/5645159321 656045339/265891186 "
        "-3867574721/1518517206 465885868/322736535 53011238/667516719 2/45 0 0",
        "1",
    ),
    "Prince, Dormand, J. Comput. Appl. Math. 7 (1981) 67, RK8(7)13M",
    rounding=1e-16,
)


def _dop853() -> Tableau:
    rows = tuple(_row(text) for text in dop853.STAGES[:-2])
    ends = tuple(_row(text, "1") for text in dop853.STAGES[-2:])  # c = 1 exactly
    weights = (*ends[-1], Fraction(0))
    difference = (*_row(dop853.ERROR_5), Fraction(0))
    return Tableau(
        "dop853",
        8,
        5,
        (*rows, *ends),
        tuple(b - e for b, e in zip(weights, difference, strict=True)),
        "Dormand, Prince; Hairer, Norsett, Wanner, Solving ODEs I, DOP853",
        dense=tuple(_row(text) for text in dop853.DENSE),
        extra=tuple(_row(text) for text in dop853.EXTRA),
        second=(*_row(dop853.EMBEDDED_3), Fraction(0)),
        rounding=1e-25,
    )


DOP853 = _dop853()

TABLEAUS: dict[str, Tableau] = {
    t.name: t
    for t in (
        MIDPOINT_21,
        BOGACKI_SHAMPINE_32,
        SOFRONIOU_SPALETTA_43,
        DORMAND_PRINCE_54,
        TSITOURAS_54,
        VERNER_65,
        SHARP_VERNER_76,
        DORMAND_PRINCE_87,
        DOP853,
    )
}
