"""The `gen` command."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import Any, TextIO

import click

from .. import __version__
from ..errors import InputError, KernelError
from ..files import line_of
from . import options
from .bench import bench
from .challenge import challenge
from .collide import collide
from .emit import emit
from .explain import explain
from .listing import list_rows
from .plot import plot
from .report import report
from .results import results
from .sweep import sweep, worker
from .vendor import vendor

_REINSTALL = "install carom anew (in a clone: remove .venv), on a disk that programs run from"


class OneLineGroup(click.Group):
    """Errors are one line and an exit status: 2 for wrong usage or input, 1 for a failed kernel."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        try:
            result = super().main(*args, **{**kwargs, "standalone_mode": False})
            sys.stdout.flush()
        except click.exceptions.Exit as stop:
            sys.exit(stop.exit_code)
        except click.Abort:
            sys.exit(130)
        except click.ClickException as error:
            _end(error.format_message() + _there_is(error), 2)
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

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and not args[0].startswith("-") and self.get_command(ctx, args[0]) is None:
            there = ", ".join(self.list_commands(ctx))
            raise click.UsageError(f"no command '{args[0]}'; there are {there}", ctx)
        return super().resolve_command(ctx, args)


def _there_is(error: click.ClickException) -> str:
    """The options that a command has, where it was given another."""
    if not isinstance(error, click.NoSuchOption) or error.ctx is None:
        return ""
    names = sorted(max(p.opts, key=len) for p in error.ctx.command.params if p.opts[0][0] == "-")
    return f" {error.ctx.command_path} has {', '.join(names)}"


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
@click.option("--target", help="CPU to generate for: native, zen3, ... (list targets)")
@options.IMPACT
@options.SCENE
@click.option("--model", help="contact model, or all; default: the scene's")
@click.option("--max-error", type=float, help="this error budget alone, and no fixed steps")
@click.option("--out", type=options.PLACE, help="folder instead of generated/")
@options.seconds(30.0, "each contest")
@click.option("--fresh", is_flag=True, help="verify and time anew what an earlier run did")
@click.option("--all", "everything", is_flag=True, help="print every candidate and every flip")
@click.option("--check", is_flag=True, help="is generated/ what the sources give?")
@click.option("--update", is_flag=True, help="make generated/ what the sources give")
@click.version_option(__version__)
@click.pass_context
def gen(
    context: click.Context, /, check: bool, update: bool, everything: bool, **asked: Any
) -> int | None:
    """Generate, verify, time and choose collision kernels for a CPU."""
    if (command := context.invoked_subcommand) is not None:
        if early := options.given(context):
            late = f"./gen {command} {early[0]}"
            raise click.UsageError(f"{early[0]}: write it after {command}, as {late}")
        return None
    if check or update:
        from .freshness import show_check, show_update

        return show_check(asked["out"]) if check else show_update(asked["out"])
    if asked["target"] is None:
        if options.given(context):
            raise click.UsageError("name a target, as ./gen --target native (or see ./gen --help)")
        click.echo(context.get_help())
        return 0
    from .generate import show_generated

    show_generated(everything, **asked)
    return None


for _command in (
    *(bench, challenge, collide, emit, explain, list_rows, plot, report, results),
    *(sweep, vendor, worker),
):
    gen.add_command(_command)


def main() -> None:
    """Entry point of the `gen` script."""
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]  # any path's name
    gen(prog_name="gen")
