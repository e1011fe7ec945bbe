"""The group of commands, loaded one at a time, and what happens when one fails."""

from __future__ import annotations

import importlib
import os
import sys
from typing import TYPE_CHECKING

import click

from octray.cli.exits import Exit, FailureError

if TYPE_CHECKING:
    from collections.abc import Sequence

COMMANDS = {
    "render": "Render a scene or mesh file to a picture.",
    "lab": "Compare the methods on a scene: time, memory, work per ray.",
    "bench": "Race the other ray tracers that are installed.",
    "query": "Answer where rays go: hits, intervals, counts, points inside.",
    "cluster": "Start, join and end clusters of machines.",
    "info": "Print what is in a scene or mesh file.",
    "doctor": "Check this installation and render a tiny scene.",
}


class _LazyGroup(click.Group):
    """Imports the module of a command when the command is run."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        del ctx
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        del ctx
        if cmd_name not in COMMANDS:
            return None
        module = importlib.import_module(f"octray.cli.{cmd_name}")
        command: click.Command = module.command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        del ctx
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


def _print_version(ctx: click.Context, _param: click.Parameter, value: bool) -> None:
    if not value or ctx.resilient_parsing:
        return
    from octray import __version__

    click.echo(f"octray {__version__}")
    ctx.exit()


@click.group(
    cls=_LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Example: octray render part.stl",
)
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_print_version,
    help="Print the version.",
)
def cli() -> None:
    """Ray tracing of exact CSG solids and triangle meshes on an octree."""


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit code."""
    try:
        code = cli.main(arguments, prog_name="octray", standalone_mode=False)
        sys.stdout.flush()
        return int(code or Exit.OK)
    except click.ClickException as error:
        error.show()
        return error.exit_code
    except FailureError as error:
        click.echo(f"octray: error: {error}", err=True)
        return error.code
    except (KeyboardInterrupt, click.Abort):
        click.echo("octray: interrupted; nothing was written", err=True)
        return Exit.INTERRUPTED
    except BrokenPipeError:
        # Whoever read our output has gone. Python would complain once more when it flushes
        # standard output at the end: give it a place that takes everything.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return Exit.FAILED
    except MemoryError:
        click.echo("octray: error: out of memory", err=True)
        return Exit.FAILED
