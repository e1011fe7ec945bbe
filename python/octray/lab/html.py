"""The lab's report as one page of HTML that needs nothing else."""

from __future__ import annotations

import html
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from octray._table import ABSENT, number
from octray.lab import figures, sections
from octray.lab.result import Status
from octray.lab.selection import YARDSTICK
from octray.lab.table import COLUMNS, row

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
    parts = [
        _head(report, title),
        _summary(report),
        sections.charts_section(report),
        sections.heat_section(report),
        sections.octree_section(report, cut),
        _conditions(report),
    ]
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{_escape(title)}</title>\n<style>\n{style}</style>\n</head>\n<body>\n"
        + "\n".join(part for part in parts if part)
        + "\n</body>\n</html>\n"
    )


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
        shown = sections.framed(
            sections.picture_element(picture, label, "scene"),
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
