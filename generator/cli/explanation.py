"""What gen explain prints of a kernel."""

from __future__ import annotations

import click
import sympy as sp

from ..emission.kernel_source import emit
from ..errors import InputError
from ..impacts.ball_ball.contact import slips, velocity_changes
from ..impacts.ball_ball.models import find_model
from ..impacts.ball_ball.reduced import recovery, reduced_system
from ..registry.axes import axis
from ..registry.names import name_of, variant_named
from ..registry.presets import find_preset
from ..registry.variant import Stepper, Variant, make_variant
from ..targets.target import find_target


def print_explanation(kernel: str, target: str, model: str) -> None:
    """Name, options, derivation and counts of a kernel; InputError where there is none such."""
    variant = _find(kernel, target, model)
    try:
        source = emit(variant)
    except ValueError as error:
        raise InputError(f"{kernel}: {error}") from None
    click.echo(name_of(variant))
    _options(variant)
    _derivation(variant)
    click.echo("\nOperations of one iteration (one pressed ball):")
    click.echo(f"  {source.counts.describe()}; {source.counts.flops} flops, an FMA being two")


def _find(kernel: str, target: str, model: str) -> Variant:
    if "." in kernel:
        return variant_named(kernel)
    find_target(target)
    find_model(model)
    stepper = Stepper("euler", steps=1000)
    return make_variant(target, "any", model, stepper, **find_preset(kernel).options)


def _options(variant: Variant) -> None:
    click.echo("\nOptions:")
    for key, code in variant.options:
        meaning = next(c.text for c in axis(key).choices if c.code == code)
        click.echo(f"  {key:9} {code:11} {meaning}")


def _derivation(variant: Variant) -> None:
    terms = find_model(variant.model).terms
    click.echo("\nDerivation (o = R w; impulses divided by M; r, f, u = x, y, z):")
    click.echo("  slips, as v + w x r at the contact and table points:")
    for symbol, form in slips(terms).items():
        click.echo(f"    {symbol} = {form}")
    click.echo("  velocities, one increment dq of normal impulse:")
    for symbol, change in velocity_changes().items():
        equal = change.subs({sp.Symbol("beta1", positive=True): 1})
        equal = equal.subs({sp.Symbol("beta2", positive=True): 1})
        click.echo(f"    d{symbol} = {equal}")
    for pressed in (2, 1):
        click.echo(f"  reduced system with ball {pressed} pressed:")
        for symbol, change in reduced_system(terms, pressed).changes.items():
            click.echo(f"    d{symbol} = {change}")
        click.echo(f"  impulse sums from the changes of the slips, ball {pressed} pressed:")
        for symbol, form in recovery(terms, pressed).sums.items():
            click.echo(f"    sum {symbol} = {form}")
