"""A variant: everything that decides the text of one kernel and how it is compiled."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import MappingProxyType

from .axes import axes_of, axis


@dataclass(frozen=True)
class Stepper:
    """How the impulse is stepped: Euler with N steps, or an exact scheme with an error budget."""

    name: str  # "euler", or the registry name of an exact stepper
    steps: int | None = None
    budget: float | None = None

    @property
    def family(self) -> str:
        return "euler" if self.name == "euler" else "exact"

    @property
    def goal(self) -> str:
        """The name field that says what is held fixed: `n1000` or `e1m06`."""
        if self.steps is not None:
            return f"n{self.steps}"
        assert self.budget is not None
        return budget_field(self.budget)


def budget_field(budget: float) -> str:
    """A budget as a name field: 1e-6 is `e1m06`, 2.5e-6 is `e2p5m06`."""
    digits = next(text for n in range(17) if float(text := f"{budget:.{n}e}") == budget)
    mantissa, exponent = digits.split("e-")
    return f"e{mantissa.replace('.', 'p')}m{exponent}"


def budget_of(field: str) -> float:
    """The budget that a name field stands for."""
    return float(field[1:].replace("p", ".").replace("m", "e-"))


@dataclass(frozen=True)
class Variant:
    """One kernel. `options` holds a choice for each axis of its family, in axis order."""

    target: str
    scene: str
    model: str
    stepper: Stepper
    width: int
    options: tuple[tuple[str, str], ...]

    def __getitem__(self, key: str) -> str:
        return dict(self.options)[key]

    def get(self, key: str, otherwise: str = "") -> str:
        return dict(self.options).get(key, otherwise)

    def mapping(self) -> MappingProxyType[str, str]:
        return MappingProxyType(dict(self.options))

    def with_options(self, **changes: str) -> Variant:
        """The same kernel with other choices; ValueError names a choice that does not exist."""
        chosen = dict(self.options)
        for key, code in changes.items():
            chosen[key] = _checked(key, code)
        axes = axes_of(self.stepper.family, self.width)
        ordered = tuple((a.key, chosen[a.key]) for a in axes)
        return replace(self, options=ordered)

    def in_lanes(self, width: int, **changes: str) -> Variant:
        """The same kernel with batches in vectors of `width`; options of lanes default or given.

        With width 1 batches go one by one. ValueError names a choice that does not exist.
        """
        options = {key: code for key, code in self.options if not axis(key).lanes}
        head = (self.target, self.scene, self.model, self.stepper)
        return make_variant(*head, width, **{**options, **changes})

    @property
    def vectors(self) -> int:
        """Vectors that every operation of a batch is made for in turn."""
        code = self.get("interleave", "i1")
        return int(code[1:]) if code.startswith("i") else 1

    @property
    def paired(self) -> bool:
        """Are the stages of an exact step made for two vectors in turn?"""
        return self.get("interleave") == "s2"

    @property
    def rounds_as_written(self) -> bool:
        """Does its text decide how it rounds, and no compiler? Only such a kernel may be chosen."""
        return self.get("flags") == "strict" and self.get("fma") != "autofma"

    def distance_from_default(self) -> int:
        """How many options differ from the default; ties are broken by it."""
        return sum(code != axis(key).default for key, code in self.options)


def _checked(key: str, code: str) -> str:
    try:
        codes = axis(key).codes()
    except KeyError as error:
        raise ValueError(error.args[0]) from None
    if code not in codes:
        raise ValueError(f"option {key} has no value '{code}'; it has {', '.join(codes)}")
    return code


def make_variant(
    target: str,
    scene: str,
    model: str,
    stepper: Stepper,
    width: int = 1,
    /,
    **options: str,
) -> Variant:
    """A variant with defaults for every option that is not named.

    Lanes of an exact kernel make their roots as its single calls do, unless told otherwise.
    """
    if stepper.family == "exact" and width > 1 and "root" in options:
        options = {"lane_root": options["root"], **options}
    defaults = tuple((a.key, a.default) for a in axes_of(stepper.family, width))
    base = Variant(target, scene, model, stepper, width, defaults)
    return base.with_options(**options)
