"""``octray lab``: a scene by many methods, side by side."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from octray.cli.exits import Exit, FailureError
from octray.cli.messages import load
from octray.cli.options import (
    budget_option,
    parse_method,
    picture_options,
    progress_option,
    quiet_option,
    repeat_option,
    scene_argument,
    threads_option,
    tree_options,
    tree_values,
)
from octray.cli.output import check_place
from octray.cli.progress import Progress

if TYPE_CHECKING:
    from octray.cli.progress import Style
    from octray.lab import Report


def _parse_methods(
    context: click.Context, parameter: click.Parameter, values: tuple[str, ...]
) -> tuple[str, ...]:
    return tuple(parse_method(context, parameter, value) for value in values)


def _parse_plane(
    _ctx: click.Context, _param: click.Parameter, value: str | None
) -> tuple[int, float] | None:
    """``z=0.3`` as an axis (0 to 2) and a number."""
    if value is None:
        return None
    axis, _, place = value.strip().partition("=")
    try:
        plane = "xyz".index(axis.lower()), float(place)
    except ValueError:
        plane = 0, math.nan
    if len(axis) != 1 or not math.isfinite(plane[1]):
        raise click.BadParameter(f"{value!r} is not a plane such as z=0.3")
    return plane


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
@repeat_option
@click.option(
    "-o", "--output", metavar="DIR", help="Write a report with charts and pictures to DIR."
)
@click.option(
    "--slice",
    "cut",
    metavar="AXIS=VALUE",
    callback=_parse_plane,
    help="The plane in which the report shows cells, such as z=0.3.",
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
@budget_option
@progress_option
@quiet_option
def command(scene: str, **options: Any) -> int:
    """Render SCENE by many methods and compare what they cost.

    Every method works in a process of its own; all pictures must be the same bits. Exit code 1
    says that one is not, 4 that a method is missing: out of memory, out of time, failed, or cut
    off by the budget.
    """
    if options["output"] is not None:
        _check_output(Path(options["output"]))
    elif options["cut"] is not None:
        raise click.UsageError("--slice is about the report, which needs -o")
    report = _run(scene, options)
    from octray.lab import table

    if options["output"] is not None:
        _write(report, options)
    click.echo(report.to_json() if options["as_json"] else table(report))
    return _exit(report)


def _check_output(folder: Path) -> None:
    """Refuse, before the work starts, a place or an installation without a report."""
    if importlib.util.find_spec("matplotlib") is None:
        raise FailureError("-o needs matplotlib for its charts: pip install 'octray[lab]'")
    if folder.exists() and not folder.is_dir():
        raise FailureError(f"{folder} is not a directory")
    check_place(folder / "index.html" if folder.exists() else folder)


def _write(report: Report, options: dict[str, Any]) -> None:
    from octray.lab.html import write

    try:
        path = write(report, options["output"], cut=options["cut"])
    except OSError as error:
        raise FailureError(f"{options['output']}: {error.strerror or error}") from error
    if not options["quiet"]:
        click.echo(f"octray: the report is {path}", err=True)


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
