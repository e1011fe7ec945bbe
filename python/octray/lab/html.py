"""The lab's report as one page of HTML that needs nothing else."""

from __future__ import annotations

import html
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from octray.lab import cells, charts, figures, heat
from octray.lab.figure import data_uri
from octray.lab.projection import Projection
from octray.lab.result import Status
from octray.lab.selection import YARDSTICK
from octray.lab.table import ABSENT, COLUMNS, number, row

if TYPE_CHECKING:
    import os

    from octray.lab.result import Combination, Report

_MIB = 1 << 20
_escape = html.escape


def write(
    report: Report, folder: str | os.PathLike[str], *, cut: tuple[int, float] | None = None
) -> Path:
    """Write ``index.html`` into the folder, which is made if need be; give its path.

    ``cut`` is the plane of the slice: an axis (0 to 2) and where on it, by default the middle of
    the scene. The page appears complete or not at all. Raises ``OSError``, and ``ImportError``
    without matplotlib.
    """
    text = page(report, cut=cut)
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    path = place / "index.html"
    partial = place / "index.html.partial"
    partial.write_text(text, encoding="utf-8")
    partial.replace(path)
    return path


def page(report: Report, *, cut: tuple[int, float] | None = None) -> str:
    """Give the whole page."""
    title = f"{Path(report.path).name}: methods side by side"
    style = resources.files("octray.lab").joinpath("page.css").read_text(encoding="utf-8")
    sections = [
        _head(report, title),
        _summary(report),
        _charts(report),
        _heat(report),
        _octree(report, cut),
        _conditions(report),
    ]
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{_escape(title)}</title>\n<style>\n{style}</style>\n</head>\n<body>\n"
        + "\n".join(part for part in sections if part)
        + "\n</body>\n</html>\n"
    )


def _figure(content: str | None, label: str, caption: str) -> str:
    """Frame a chart; an absent one is left out."""
    if content is None:
        return ""
    return (
        f'<figure role="group" aria-label="{_escape(label)}">\n{content}\n'
        f"<figcaption>{caption}</figcaption>\n</figure>"
    )


def _image(png: bytes, label: str, kind: str = "") -> str:
    style = f' class="{kind}"' if kind else ""
    return f'<img{style} src="{data_uri(png)}" alt="{_escape(label)}">'


def _plural(count: int, one: str) -> str:
    return f"{count:,} {one}" if count == 1 else f"{count:,} {one}s"


def _head(report: Report, title: str) -> str:
    scene = figures.of_scene(report.scene)
    parts = [
        _plural(scene["objects"], "object"),
        _plural(scene["primitives"], "primitive"),
        _plural(scene["triangles"], "triangle"),
        _plural(scene["lights"], "light"),
    ]
    width, height = report.options["size"]
    return (
        f"<h1>{_escape(title)}</h1>\n"
        f'<p class="sub">{", ".join(parts)}; {width} × {height} pixels,'  # noqa: RUF001
        f" {_plural(report.options['spp'], 'sample')} per pixel</p>"
    )


def _verdicts(report: Report) -> list[str]:
    """Say what came of the comparison of pictures, and of the times."""
    rendered = [c for c in report.combinations if c.same is not None]
    said = []
    if report.different:
        names = ", ".join(
            f"<code>{_escape(c.method)}</code> ({c.different_pixels} pixels)"
            for c in report.different
        )
        said.append(
            f'<p class="verdict alarm">Not the same picture as <code>{report.reference}</code>:'
            f" {names}.</p>"
        )
    elif rendered:
        said.append(
            f'<p class="verdict">All {_plural(len(rendered), "method")} gave the same picture, bit'
            f" for bit, in every repetition; it was compared with that of"
            f" <code>{report.reference}</code>.</p>"
        )
    timed = sorted((c for c in rendered if c.render is not None), key=lambda c: c.render or 0.0)
    if len(timed) > 1:
        fast, slow = timed[0], timed[-1]
        said.append(
            f"<p>Rendering took from {number(fast.render)} s (<code>{_escape(fast.method)}</code>)"
            f" to {number(slow.render)} s (<code>{_escape(slow.method)}</code>),"
            f" {number((slow.render or 0) / max(fast.render or 0, 1e-9))} times as long.</p>"
        )
    return said


def _summary(report: Report) -> str:
    said = _verdicts(report)
    if report.interrupted:
        said.append('<p class="verdict alarm">The run was interrupted; this is what was done.</p>')
    picture = report.drawings.picture
    shown = ""
    if picture is not None:
        label = f"The scene, rendered by {report.reference}"
        shown = _figure(
            _image(picture, label, "scene"),
            label,
            f"The picture that every method has to give; this one is by"
            f" <code>{report.reference}</code>.",
        )
    notes = "".join(f"<li>{_escape(note)}</li>" for note in _notes(report))
    return "\n".join(
        [*said, shown, "<h2>Figures</h2>", _table(report), f"<ul>{notes}</ul>" if notes else ""]
    )


def _notes(report: Report) -> list[str]:
    notes = list(report.notes)
    for status in Status:
        names = [c.method for c in report.combinations if c.status is status]
        if status is not Status.DONE and names:
            notes.append(f"{status.value}: {', '.join(names)}")
    return notes


def _table(report: Report) -> str:
    heads = "".join(
        f'<th scope="col"{_left(left)}>{_escape(name)}'
        f"<small>{_escape(unit) or '&nbsp;'}</small></th>"
        for name, unit, left in COLUMNS
    )
    body = "\n".join(_row(combination) for combination in report.combinations)
    return (
        f'<div class="scroll"><table>\n<thead><tr>{heads}</tr></thead>\n<tbody>\n{body}\n</tbody>'
        "</table></div>\n"
        '<p class="sub">Times are medians of all repetitions; ± is half the distance from the'
        f" fastest to the slowest, and the last column of numbers compares with {YARDSTICK}."
        f" Steps are cells and nodes visited, tests are surfaces and triangles intersected, both"
        f" on average over rays of all kinds. {ABSENT} is what was not measured or what the method"
        " does not have.</p>"
    )


def _left(left: bool) -> str:
    return ' class="left"' if left else ""


def _row(combination: Combination) -> str:
    name, *numbers, verdict = row(combination)
    fine = combination.same is not False and combination.status is Status.DONE
    cells_of_row = "".join(f"<td>{_escape(text)}</td>" for text in numbers)
    return (
        f'<tr><th scope="row" class="left mono">{_escape(name)}</th>{cells_of_row}'
        f'<td class="left note{"" if fine else " bad"}">{_escape(verdict)}</td></tr>'
    )


def _charts(report: Report) -> str:
    them = report.combinations
    found = [figures.of(c.report, c.stats) for c in them]
    return "\n".join(
        [
            "<h2>Time</h2>",
            _figure(
                charts.times(them),
                "Seconds of building and of rendering",
                "A dot is the median, a tick one repetition, the pale band their range. Repetitions"
                " of all methods were taken in turns, so that a disturbance of the machine meets"
                " them alike.",
            ),
            "<h2>Memory and nodes</h2>",
            _figure(
                charts.stacked(
                    "memory", "Memory of the structure", them, [f.parts for f in found], unit="B"
                ),
                "Memory of the structure by part",
                "Bytes of what a method builds to find surfaces, by part; the scene itself, which"
                " is the same for all, is not in it.",
            ),
            _figure(
                charts.stacked("nodes", "Nodes by kind", them, [f.nodes for f in found]),
                "Nodes by kind",
                "Empty cells hold nothing that a ray could meet, occupied ones do, divided ones"
                " have children.",
            ),
            _figure(
                charts.histograms("depths", "depth", them, [f.depths for f in found]),
                "Leaves by depth",
                "How many leaves lie at which depth of the octree; 0 is the whole scene.",
            ),
            _figure(
                charts.histograms("leaves", "objects in a leaf", them, [f.per_leaf for f in found]),
                "Leaves by how many objects they hold",
                "How many leaves hold how many objects: what a ray that enters one has to ask.",
            ),
            "<h2>Work per ray</h2>",
            _figure(
                charts.work(them),
                "Steps, look-ups and tests per ray, by kind of ray",
                "What one ray cost on average, by kind of ray. Shadow rays may stop at the first"
                " thing they meet, and rays from mirrors and through glass start at a surface.",
            ),
        ]
    )


def _heat(report: Report) -> str:
    costs = report.drawings.cost
    if not costs:
        return ""
    label = "Cost of every pixel, by method"
    return "\n".join(
        [
            "<h2>Where the work is</h2>",
            _figure(
                _image(heat.maps(costs), label),
                label,
                "Steps and tests of all rays of a pixel, shadows and reflections with them. All"
                " maps have the same scale, so that the same colour is the same cost; above each"
                " is its mean.",
            ),
        ]
    )


def _octree(report: Report, cut: tuple[int, float] | None) -> str:
    drawn = report.drawings.cells
    if not drawn:
        return ""
    parts = ["<h2>The cells</h2>"]
    octrees = [name for name in drawn if not name.startswith("grid")]
    camera = report.scene["camera"]
    if octrees and camera is not None and report.drawings.picture is not None:
        parts.append(_wires(report, octrees[0], camera))
    plane = cut or cells.middle(next(iter(drawn.values())), camera, report.scene["bounds"])
    groups = cells.distinct(drawn)
    label = f"Slice through the cells at {'xyz'[plane[0]]} = {plane[1]:.6g}"
    same = "; ".join(
        f"<code>{_escape(names[0])}</code> has the cells of"
        f" {', '.join(f'<code>{_escape(name)}</code>' for name in names[1:])} too"
        for names in groups
        if len(names) > 1
    )
    parts.append(
        _figure(
            _image(cells.slices(drawn, groups, plane), label),
            label,
            f"{label}. Full colours are cells that hold something, pale ones are empty; the colour"
            " is the depth. Methods with the same cells share a panel"
            f"{': ' + same if same else ''}.",
        )
    )
    return "\n".join(parts)


def _wires(report: Report, method: str, camera: dict[str, Any]) -> str:
    crop = report.options["crop"]
    projection = Projection(
        camera,
        tuple(report.options["size"]),
        (crop[0], crop[1]) if crop else (0, 0),
    )
    picture = report.drawings.picture or b""
    png, limit = cells.over_picture(picture, report.drawings.cells[method], projection)
    coarse = (
        ""
        if limit is None
        else f" There are too many to draw them all: those below depth {limit} are drawn as the"
        f" cells of depth {limit} that they lie in."
    )
    label = f"The octree of {method} over the picture"
    return _figure(
        _image(png, label),
        label,
        f"The leaves of <code>{_escape(method)}</code> that hold something, as frames over the"
        f" picture, coloured by depth. Frames behind the surfaces are drawn too.{coarse}",
    )


def _option(name: str, value: Any) -> str:
    """Write the value of an option with its unit."""
    if isinstance(value, list):
        return ", ".join(map(str, value))
    if value is True:
        return "yes"
    return f"{value:g} s" if name.endswith("_s") else str(value)


def _conditions(report: Report) -> str:
    machine, options = report.machine, report.options
    memory = machine["memory_bytes"]
    entries = {
        "scene": report.path,
        "processor": f"{machine['processor']}, {machine['processors']} threads",
        "memory": ABSENT if memory is None else f"{memory / _MIB:,.0f} MiB",
        "system": f"{machine['system']}, Python {machine['python']}",
        "repetitions": str(options["repeat"]),
        **{
            name.removesuffix("_s").replace("_", " "): _option(name, value)
            for name, value in {**options, **options["tree"]}.items()
            if value not in (None, False, {}) and name not in {"tree", "repeat", "size"}
        },
    }
    items = "".join(
        f"<dt>{_escape(name)}</dt><dd>{_escape(value)}</dd>" for name, value in entries.items()
    )
    groups = ""
    if len(report.groups) > 1:
        lists = "".join(
            f"<li>{', '.join(f'<code>{_escape(m)}</code>' for m in group.methods)}</li>"
            for group in report.groups
        )
        groups = (
            "<p>Memory was not enough for all at once. Methods in one group ran beside each"
            f" other:</p><ol>{lists}</ol>"
        )
    return f"<h2>Conditions</h2>\n<dl>{items}</dl>\n{groups}"
