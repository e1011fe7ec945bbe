"""``octray bench``: whole renders by octray and by its peers, in turns."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from octray.cli.exits import Exit, FailureError
from octray.cli.options import budget_option, progress_option, quiet_option, repeat_option
from octray.cli.progress import Progress

if TYPE_CHECKING:
    from octray.bench import Report
    from octray.cli.progress import Style


def _list(ctx: click.Context, _param: click.Parameter, value: bool) -> None:
    if not value or ctx.resilient_parsing:
        return
    from octray import bench

    rows = bench.describe_scenes()
    width = max(len(name) for name, _ in rows)
    click.echo("\n".join(f"{name:{width}}  {what}" for name, what in rows))
    ctx.exit()


@click.command("bench", epilog="Example: octray bench balls4 csg10 -j 1 -j 4 --repeat 5")
@click.argument("scenes", nargs=-1)
@click.option("--all", "everything", is_flag=True, help="Run the full set, which takes long.")
@click.option(
    "--list",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_list,
    help="List the scenes.",
)
@click.option(
    "--only",
    metavar="PROGRAM",
    multiple=True,
    help="Run octray and this program; repeat it for more. By default all that are here.",
)
@click.option(
    "--mitsuba",
    metavar="PYTHON",
    help="A Python that has Mitsuba; by default OCTRAY_MITSUBA, or the one that runs octray.",
)
@click.option(
    "-j",
    "--threads",
    type=click.IntRange(min=1),
    multiple=True,
    metavar="N",
    help="Threads; repeat it for several numbers. By default one for each processor.",
)
@repeat_option
@click.option(
    "--timeout",
    type=click.FloatRange(min=0, min_open=True),
    default=300,
    show_default=True,
    metavar="S",
    help="Most seconds of one command.",
)
@budget_option
@click.option("--keep", metavar="DIR", help="Leave the scenes and the pictures in DIR.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@progress_option
@quiet_option
def command(scenes: tuple[str, ...], **options: Any) -> int:
    """Render SCENES by octray and by the programs that are installed, and compare what they cost.

    Without SCENES a small set is run, which takes about a minute. The programs are POV-Ray (with
    its own choice of structure, and with +BM2), Tachyon and Mitsuba; they take turns, and ratios
    are medians over the rounds. Exit code 4 says that something is missing: failed, out of time,
    or cut off by the budget.
    """
    if scenes and options["everything"]:
        raise click.UsageError("--all and names of scenes: either one or the other")
    report = _run(scenes, options)
    from octray.bench import table

    click.echo(report.to_json() if options["as_json"] else table(report))
    if report.interrupted:
        return Exit.INTERRUPTED
    return Exit.PARTIAL if report.missing or report.not_begun else Exit.OK


def _run(scenes: tuple[str, ...], options: dict[str, Any]) -> Report:
    from octray import bench

    style: Style = "none" if options["quiet"] else options["progress"]
    keep = options["keep"]
    if keep is not None and Path(keep).exists() and not Path(keep).is_dir():
        raise FailureError(f"{keep} is not a directory")
    names = ("everything", "only", "threads", "repeat", "timeout", "budget", "mitsuba")
    with Progress("bench", style) as progress:
        try:
            return bench.run(
                scenes,
                folder=keep,
                progress=progress,
                **{name: options[name] for name in names},
            )
        except ValueError as error:
            raise click.UsageError(str(error)) from error
        except OSError as error:
            raise FailureError(f"{error.filename or keep}: {error.strerror or error}") from error
