"""``octray lab``: a scene by many methods, side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from octray.cli.exits import Exit
from octray.cli.messages import load
from octray.cli.options import (
    parse_method,
    picture_options,
    progress_option,
    quiet_option,
    scene_argument,
    threads_option,
    tree_options,
    tree_values,
)
from octray.cli.progress import Progress

if TYPE_CHECKING:
    from octray.cli.progress import Style
    from octray.lab import Report


def _parse_methods(
    context: click.Context, parameter: click.Parameter, values: tuple[str, ...]
) -> tuple[str, ...]:
    return tuple(parse_method(context, parameter, value) for value in values)


@click.command("lab", epilog="Example: octray lab part.csg --size 320x240 -o part-lab")
@scene_argument
@click.option(
    "--accel",
    metavar="METHOD",
    multiple=True,
    callback=_parse_methods,
    help="Run this method; repeat it for more. By default every choice occurs at least once.",
)
@click.option("--all", "everything", is_flag=True, help="Run every valid combination.")
@click.option(
    "--repeat",
    type=click.IntRange(min=1),
    default=3,
    show_default=True,
    metavar="N",
    help="Renderings of every method, taken in turns.",
)
@click.option(
    "-o", "--output", metavar="DIR", help="Write a report with charts and pictures to DIR."
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@picture_options
@tree_options
@threads_option
@click.option(
    "--memory",
    type=click.IntRange(min=1),
    metavar="MIB",
    help="Most memory of one method beyond the scene that was read.",
)
@click.option(
    "--timeout",
    type=click.FloatRange(min=0, min_open=True),
    metavar="S",
    help="Most seconds of one build or one rendering.",
)
@click.option(
    "--budget",
    type=click.FloatRange(min=0, min_open=True),
    metavar="S",
    help="Most seconds of the whole run; what it cuts off is listed.",
)
@progress_option
@quiet_option
def command(scene: str, **options: Any) -> int:
    """Render SCENE by many methods and compare what they cost.

    Every method works in a process of its own; all pictures must be the same bits. Exit code 1
    says that one is not, 4 that a method is missing: out of memory, out of time, failed, or cut
    off by the budget.
    """
    report = _run(scene, options)
    from octray.lab import table

    click.echo(report.to_json() if options["as_json"] else table(report))
    return _exit(report)


def _run(path: str, options: dict[str, Any]) -> Report:
    loaded = load(path, facets=options["facets"], strict=options["strict"], quiet=options["quiet"])
    from octray import lab

    style: Style = "none" if options["quiet"] else options["progress"]
    memory = options["memory"]
    with Progress("lab", style) as progress:
        try:
            return lab.run(
                path,
                scene=loaded,
                memory=None if memory is None else memory << 20,
                tree=tree_values(options),
                drawings=options["output"] is not None,
                progress=progress,
                **{
                    name: options[name]
                    for name in (
                        "accel",
                        "everything",
                        "repeat",
                        "size",
                        "spp",
                        "threads",
                        "crop",
                        "viewall",
                        "max_depth",
                        "threshold",
                        "facets",
                        "timeout",
                        "budget",
                    )
                },
            )
        except ValueError as error:
            raise click.UsageError(str(error)) from error


def _exit(report: Report) -> Exit:
    if report.interrupted:
        return Exit.INTERRUPTED
    if report.different:
        return Exit.FAILED
    return Exit.PARTIAL if report.missing else Exit.OK
