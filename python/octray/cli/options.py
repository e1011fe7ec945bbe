"""Options that several commands share, and values that click does not know: sizes and crops."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

#: A part of the picture: x0 <= x < x1, y0 <= y < y1 in pixels, row 0 at the top.
Crop = tuple[int, int, int, int]


def parse_method(_ctx: click.Context, _param: click.Parameter, value: str) -> str:
    """Look a method up; only the core knows them all."""
    if value == "auto":
        return value
    from octray._core import method_name

    try:
        return method_name(value)
    except ValueError as error:
        raise click.BadParameter(str(error)) from None


accel_option = click.option(
    "--accel",
    metavar="METHOD",
    callback=parse_method,
    default="auto",
    show_default=True,
    help=(
        "How surfaces are found: auto, brute, spheres, boxes, grid[:N] or "
        "octree[:ENCODING[:TRAVERSAL[:MEMBERSHIP]]]. Encodings: tree, lvsi, lvsi-empty; "
        "traversals: ordered, sung, fujimoto-iwata, beam; memberships: analytic, bounding-box, "
        "bounding-sphere, bounding-cover, shells. The answers are the same."
    ),
)
threads_option = click.option(
    "-j",
    "--threads",
    type=click.IntRange(min=1),
    metavar="N",
    envvar="OCTRAY_THREADS",
    help="Threads; by default one for each processor.",
)
progress_option = click.option(
    "--progress",
    type=click.Choice(["auto", "bar", "plain", "none"]),
    default="auto",
    show_default=True,
    help="How progress is shown on standard error.",
)
repeat_option = click.option(
    "--repeat",
    type=click.IntRange(min=1),
    default=3,
    show_default=True,
    metavar="N",
    help="Renderings by each, taken in turns.",
)
budget_option = click.option(
    "--budget",
    type=click.FloatRange(min=0, min_open=True),
    metavar="S",
    help="Most seconds of the whole run; what it cuts off is listed.",
)
quiet_option = click.option("-q", "--quiet", is_flag=True, help="Only errors on standard error.")


def parse_size(
    _ctx: click.Context, _param: click.Parameter, value: str | None
) -> tuple[int, int] | None:
    """``WIDTHxHEIGHT`` in pixels. What is too large is decided where pictures are made."""
    if value is None:
        return None
    match = re.fullmatch(r"(\d{1,9})[xX](\d{1,9})", value.strip(), re.ASCII)
    if match is None:
        raise click.BadParameter(f"{value!r} is not a size such as 1280x720")
    width, height = int(match[1]), int(match[2])
    if width < 1 or height < 1:
        raise click.BadParameter(f"{value}: a picture has at least one pixel each way")
    return width, height


def parse_crop(_ctx: click.Context, _param: click.Parameter, value: str | None) -> Crop | None:
    """``x0,y0,x1,y1`` in pixels. Whether it lies in the picture is decided later."""
    if value is None:
        return None
    match = re.fullmatch(r"(\d{1,9}),(\d{1,9}),(\d{1,9}),(\d{1,9})", value.strip(), re.ASCII)
    if match is None:
        raise click.BadParameter(f"{value!r} is not a crop such as 100,50,300,200")
    x0, y0, x1, y1 = (int(number) for number in match.groups())
    if x0 >= x1 or y0 >= y1:
        raise click.BadParameter(f"{value}: x0 must be below x1 and y0 below y1")
    return x0, y0, x1, y1


def scene_argument(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the argument SCENE and the options about reading it."""
    for add in (
        click.option(
            "--facets", is_flag=True, help="OpenSCAD: faceted solids even where $fn is 0."
        ),
        click.option("--strict", is_flag=True, help="Treat warnings as errors."),
        click.argument("scene"),
    ):
        function = add(function)
    return function


def picture_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options about which picture of a scene is rendered."""
    for add in reversed(
        (
            click.option("--size", metavar="WxH", callback=parse_size, help="Size in pixels."),
            click.option(
                "--spp",
                type=click.IntRange(min=1),
                default=1,
                show_default=True,
                help="Samples per pixel; 1 is the pixel's centre.",
            ),
            click.option(
                "--crop",
                metavar="X0,Y0,X1,Y1",
                callback=parse_crop,
                help="Render only these pixels (row 0 at the top).",
            ),
            click.option(
                "--viewall", is_flag=True, help="Move the camera to where it sees everything."
            ),
            click.option(
                "--max-depth",
                type=click.IntRange(min=1),
                metavar="N",
                help="Generations of rays; 1 is without mirrors and glass.",
            ),
            click.option(
                "--threshold",
                type=click.FloatRange(min=0),
                metavar="X",
                help="Rays that add less than this to a pixel are not followed.",
            ),
        )
    ):
        function = add(function)
    return function


def parse_cost(
    _ctx: click.Context, _param: click.Parameter, value: str | None
) -> float | str | None:
    """``off``, or the cost of entering a cell."""
    if value is None or value == "off":
        return value
    try:
        cost = float(value)
    except ValueError:
        cost = -1.0
    if not 0 <= cost < float("inf"):
        raise click.BadParameter(f"{value!r} is neither off nor a number, 0 or more")
    return cost


def tree_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options about how trees are divided and kept; see ``tree_values``."""
    for add in reversed(
        (
            click.option(
                "--quality",
                type=click.Choice(["fast", "full"]),
                help="Trees over triangles that are built soon, or searched soon; full by default.",
            ),
            click.option(
                "--tree-objects",
                type=click.IntRange(1, 2**32 - 1),
                metavar="N",
                help="Leave cells of at most N surfaces undivided.",
            ),
            click.option(
                "--tree-depth",
                type=click.IntRange(0, 21),
                metavar="N",
                help="Deepest level of the octree over solids; 16 by default.",
            ),
            click.option(
                "--tree-cost",
                callback=parse_cost,
                metavar="X",
                help="Divide where rays get cheaper, if entering a cell costs as much as X planes;"
                " 4 by default. off: whatever it costs.",
            ),
            click.option(
                "--tree-share",
                type=click.FloatRange(0, 1),
                metavar="X",
                help="Leave cells undivided of which boxes of objects fill more than the share X.",
            ),
            click.option(
                "--tree-memory",
                type=click.IntRange(0, 2**40),
                metavar="MIB",
                help="Most memory of an octree in MiB; what does not fit stays undivided.",
            ),
            click.option(
                "--lvsi-table",
                type=click.Choice(["prime", "power-of-two"]),
                help="Sizes of hash tables; prime by default.",
            ),
            click.option(
                "--lvsi-load",
                type=click.FloatRange(1 / 64, 64),
                metavar="X",
                help="Rows used for each row of a hash table; 0.75 by default.",
            ),
        )
    ):
        function = add(function)
    return function


def tree_values(options: dict[str, Any]) -> dict[str, Any]:
    """Give what ``tree_options`` asked for as keywords of ``Scene.prepare``."""
    names = ("objects", "depth", "cost", "share", "memory")
    values = {f"tree_{name}": options[f"tree_{name}"] for name in names}
    values |= {name: options[name] for name in ("quality", "lvsi_table", "lvsi_load")}
    if values["tree_memory"] is not None:
        values["tree_memory"] <<= 20
    return values
