"""The parts of the lab's page that have charts and pictures, each with its caption."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any

from octray.lab import cells, charts, figures, heat, histograms
from octray.lab.figure import data_uri
from octray.lab.projection import view

if TYPE_CHECKING:
    from octray.lab.result import Combination, Report

_escape = html.escape


def framed(content: str | None, label: str, caption: str) -> str:
    """Frame a chart; an absent one is left out."""
    if content is None:
        return ""
    return (
        f'<figure role="group" aria-label="{_escape(label)}">\n{content}\n'
        f"<figcaption>{caption}</figcaption>\n</figure>"
    )


def picture_element(png: bytes, label: str, kind: str = "") -> str:
    """Give an ``<img>`` that holds the picture itself."""
    style = f' class="{kind}"' if kind else ""
    return f'<img{style} src="{data_uri(png)}" alt="{_escape(label)}">'


def _marks(report: Report, combination: Combination) -> dict[str, int] | None:
    """Give the pairs of cells and what may touch them; those in vain apart, where that is known."""
    found = figures.of(combination.report, combination.stats)
    marks: dict[str, int] = {}
    if found.membership is not None:
        vain = max(report.in_vain(combination) or 0, 0)
        marks = {"primitives": found.membership["marks"] - vain, "in vain": vain}
    if found.marks is not None:
        marks["triangles"] = found.marks["references"]
    return marks or None


def charts_section(report: Report) -> str:
    """Give the charts of times, memory, nodes and work per ray."""
    them = report.combinations
    found = [figures.of(c.report, c.stats) for c in them]
    return "\n".join(
        [
            "<h2>Time</h2>",
            framed(
                charts.times(them),
                "Seconds of building and of rendering",
                "A dot is the median, a tick one repetition, the pale band their range. Repetitions"
                " of all methods were taken in turns, so that a disturbance of the machine meets"
                " them alike.",
            ),
            "<h2>Memory and nodes</h2>",
            framed(
                charts.stacked(
                    "memory",
                    "Memory of the structure",
                    them,
                    [f.structure for f in found],
                    unit="B",
                ),
                "Memory of the structure by part",
                "Bytes of what a method builds to find surfaces, by part: cells are nodes, rows of"
                " a hash table or voxels, contents what occupied ones hold, expressions the CSG"
                " trees reduced in them. Geometry, which is the same for all, is not in it.",
            ),
            framed(
                charts.stacked("nodes", "Nodes by kind", them, [f.nodes for f in found]),
                "Nodes by kind",
                "Empty cells hold nothing that a ray could meet, occupied ones do, divided ones"
                " have children.",
            ),
            framed(
                histograms.histograms(
                    "depths", "depth", them, [f.depths for f in found], ("empty", "occupied")
                ),
                "Leaves by depth",
                "How many leaves lie at which depth of the octree; 0 is the whole scene.",
            ),
            framed(
                histograms.histograms(
                    "leaves", "objects in a leaf", them, [f.per_leaf for f in found]
                ),
                "Leaves by how many objects they hold",
                "How many leaves hold how many objects: what a ray that enters one has to ask.",
            ),
            framed(
                charts.stacked("marks", "Marks", them, [_marks(report, c) for c in them]),
                "Marks: pairs of a cell and what may touch it",
                "Primitives of solids as the membership test found them, and triangles of sheets."
                " In vain are those beyond what the analytic test finds by the same encoding and"
                " traversal in this run, where it ran.",
            ),
            "<h2>Work per ray</h2>",
            framed(
                charts.work(them),
                "Steps, look-ups and tests per ray, by kind of ray",
                "What one ray cost on average, by kind of ray. Shadow rays may stop at the first"
                " thing they meet, and rays from mirrors and through glass start at a surface.",
            ),
        ]
    )


def heat_section(report: Report) -> str:
    """Give the heat maps, if there are any."""
    costs = report.drawings.cost
    if not costs:
        return ""
    label = "Cost of every pixel, by method"
    return "\n".join(
        [
            "<h2>Where the work is</h2>",
            framed(
                picture_element(heat.maps(costs), label),
                label,
                "Steps and tests of all rays of a pixel, shadows and reflections with them. All"
                " maps have the same scale, so that the same colour is the same cost; above each"
                " is its mean.",
            ),
        ]
    )


def octree_section(report: Report, cut: tuple[int, float] | None) -> str:
    """Give the octree over the picture and the slice of the cells, if there are cells."""
    drawn = report.drawings.cells
    if not drawn:
        return ""
    parts = ["<h2>The cells</h2>"]
    camera = report.scene["camera"]
    if report.drawings.framed is not None and report.drawings.picture is not None:
        parts.append(_wires(report, report.drawings.framed, camera))
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
        framed(
            picture_element(cells.slices(drawn, groups, plane), label),
            label,
            f"{label}. Full colours are cells that hold something, pale ones are empty, what is"
            " white is not kept at all; the colour is the depth, 0 for a grid. Methods with the"
            " same cells share a panel"
            f"{': ' + same if same else ''}.",
        )
    )
    return "\n".join(parts)


def _wires(report: Report, method: str, camera: dict[str, Any]) -> str:
    projection, _ = view(camera, report.options["size"], report.options["crop"])
    drawings = report.drawings
    picture, seen = drawings.picture or b"", drawings.seen
    png, limit = cells.over_picture(picture, drawings.cells[method], projection, seen)
    coarse = (
        ""
        if limit is None
        else f" There are too many to draw them all: those below depth {limit} are drawn as the"
        f" cells of depth {limit} that they lie in."
    )
    label = f"The octree of {method} over the picture"
    return framed(
        picture_element(png, label),
        label,
        f"The leaves of <code>{_escape(method)}</code> in which the surfaces lie that one sees, as"
        f" frames over the picture, coloured by depth: the builder divides where it expects to save"
        f" tests.{coarse}",
    )
