"""The `gen` command."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import TextIO

import click

from .. import __version__
from ..errors import InputError, KernelError
from ..files import line_of

_REINSTALL = "install carom anew (in a clone: remove .venv), on a disk that programs run from"


class OneLineGroup(click.Group):
    """Errors are one line and an exit status: 2 for wrong usage or input, 1 for a failed kernel."""

    def main(self, *args, **kwargs):  # type: ignore[no-untyped-def]
        kwargs["standalone_mode"] = False
        try:
            result = super().main(*args, **kwargs)
            sys.stdout.flush()
        except click.exceptions.Exit as stop:
            sys.exit(stop.exit_code)
        except click.Abort:
            sys.exit(130)
        except click.ClickException as error:
            _end(error.format_message(), 2)
        except InputError as error:
            _end(str(error), 2)
        except KernelError as error:
            _end(str(error), 1)
        except OSError as error:
            _end(line_of(error), 2)
        except ImportError as error:
            _end(f"a Python package cannot be loaded: {error}; {_REINSTALL}", 2)
        except KeyboardInterrupt:
            sys.exit(130)
        sys.exit(result if isinstance(result, int) else 0)


def _end(message: str, status: int) -> None:
    click.echo("gen: " + " ".join(message.split()), err=True)
    with suppress(OSError, ValueError):
        _drop_what_cannot_be_written(sys.stdout)
    sys.exit(status)


def _drop_what_cannot_be_written(stream: TextIO) -> None:
    """What is left of a stream that is full would be an error again when Python ends."""
    try:
        stream.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


@click.group(cls=OneLineGroup, invoke_without_command=True)
@click.option("--target", help="CPU to generate for: native, zen3, ... (see list targets)")
@click.option("--scene", default="any", show_default=True, help="what is known of a shot")
@click.option("--model", help="contact model, or all; default: the scene's")
@click.option("--max-error", type=float, help="error budget, relative to the relative speed")
@click.option("--out", type=click.Path(path_type=Path), help="folder instead of generated/")
@click.option(
    "--seconds",
    default=30.0,
    show_default=True,
    type=click.FloatRange(0.1, 3600),
    help="time for timing",
)
@click.option("--fresh", is_flag=True, help="verify and time anew what an earlier run did")
@click.option("--check", is_flag=True, help="is generated/ what the sources give?")
@click.option("--update", is_flag=True, help="make generated/ what the sources give")
@click.version_option(__version__)
@click.pass_context
def gen(
    context: click.Context,
    target: str | None,
    scene: str,
    model: str | None,
    max_error: float | None,
    out: Path | None,
    seconds: float,
    fresh: bool,
    check: bool,
    update: bool,
) -> int | None:
    """Generate, verify, time and choose kernels for a frictional ball-ball collision."""
    if context.invoked_subcommand is not None:
        return None
    if check or update:
        from .freshness import run_check, run_update

        return run_check(out) if check else run_update(out)
    if target is None:
        raise click.UsageError("name a target, as ./gen --target native (or see ./gen --help)")
    from .main_job import run_main_job

    run_main_job(target, scene, model, out, seconds, fresh, max_error)
    return None


def _register() -> None:
    from . import (
        bench,
        challenge,
        cluster,
        collide,
        emit,
        explain,
        listing,
        plot,
        report,
        results,
        sweep,
        vendor,
    )

    for command in (
        bench.bench,
        challenge.challenge,
        collide.collide,
        emit.emit,
        explain.explain,
        listing.list_rows,
        plot.plot,
        report.report,
        results.results,
        sweep.sweep,
        vendor.vendor,
        cluster.worker,
    ):
        gen.add_command(command)


_register()


def main() -> None:
    """Entry point of the `gen` script."""
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]  # any path's name
    gen(prog_name="gen")
