"""Drawings of the octree: its leaves over the picture, and a slice through its cells."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import BoundaryNorm
from matplotlib.image import imread
from matplotlib.ticker import EngFormatter

from octray.lab.figure import DEPTHS, drawn, to_png

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy.typing as npt
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure

    from octray.lab.projection import Projection

    Floats = npt.NDArray[np.float64]
    Cells = Mapping[str, npt.NDArray[Any]]

#: Boxes drawn over a picture at most: more of them hide what they show.
MOST_BOXES = 2500
_AXES = "xyz"


def _root(cells: Cells) -> tuple[Floats, Floats]:
    """Give the lowest corner and the sides of the box that these cells divide."""
    low, high = cells["root"]
    return low, high - low


def _places(points: Floats, low: Floats, root: Floats, depth: int) -> npt.NDArray[np.int64]:
    """Give the number of the cell of a depth in which each point (n, 3) lies, -1 if outside."""
    count = 1 << depth
    at = np.floor((points - low) / root * count).astype(np.int64)
    number: npt.NDArray[np.int64] = (at[:, 2] * count + at[:, 1]) * count + at[:, 0]
    return np.where(((at >= 0) & (at < count)).all(axis=1), number, -1)


def holding(cells: Cells, points: Floats) -> npt.NDArray[np.bool_]:
    """Say which cells have one of these points (n, 3) in them."""
    bounds, depth = cells["bounds"], cells["depth"]
    low, root = _root(cells)
    found = np.zeros(len(depth), dtype=bool)
    for level in np.unique(depth):
        here = depth == level
        middles = bounds[here].mean(axis=1)
        occupied_places = np.unique(_places(points, low, root, int(level)))
        found[here] = np.isin(_places(middles, low, root, int(level)), occupied_places)
    return found


def coarsened(
    cells: Cells, chosen: npt.NDArray[np.bool_], most: int = MOST_BOXES
) -> tuple[Floats, npt.NDArray[Any], int | None]:
    """Give the boxes of chosen cells and their depths, not too many.

    Where there are too many, those below some depth are replaced by their ancestors there; that
    depth is the third value, ``None`` if all are drawn as they are.
    """
    low, root = _root(cells)
    bounds = cells["bounds"][chosen]
    depth = cells["depth"][chosen].astype(int)
    if len(bounds) <= most:
        return bounds, depth, None
    limit = int(depth.max())
    while limit > 0:
        limit -= 1
        level = np.minimum(depth, limit)
        side = root / 2.0 ** level[:, None]
        place = np.floor((bounds.mean(axis=1) - low) / side).astype(np.int64)
        keys = np.unique(np.column_stack([level, place]), axis=0)
        if len(keys) <= most:
            break
    side = root / 2.0 ** keys[:, :1]
    start = low + keys[:, 1:] * side
    return np.stack([start, start + side], axis=1), keys[:, 0], limit


def _depth_colors(deepest: int, shallowest: int) -> tuple[Colormap, BoundaryNorm]:
    levels = np.arange(shallowest, deepest + 2) - 0.5
    colors = colormaps[DEPTHS].resampled(max(len(levels) - 1, 1))
    return colors, BoundaryNorm(levels, colors.N)


def _legend(figure: Figure, axes: Any, colors: Colormap, norm: BoundaryNorm) -> None:
    bar = figure.colorbar(ScalarMappable(norm, colors), ax=axes, shrink=0.7, pad=0.02)
    first, last = norm.boundaries[0] + 0.5, norm.boundaries[-1] - 0.5
    step = max(int((last - first) // 8), 1)
    bar.set_ticks(np.arange(first, last + 1, step).tolist())
    bar.ax.minorticks_off()
    bar.set_label("depth of the cell")
    bar.outline.set_visible(False)


def over_picture(
    picture: bytes, cells: Cells, projection: Projection, seen: Floats | None
) -> tuple[bytes, int | None]:
    """Draw the occupied leaves over the picture, only those with points that are seen, if given.

    The second value is the depth to which they are drawn, if that is limited.
    """
    pixels = imread(io.BytesIO(picture), format="png")[..., :3]
    height, width = pixels.shape[:2]
    chosen = cells["occupied"].copy()
    if seen is not None:
        chosen &= holding(cells, seen)
    bounds, depth, limit = coarsened(cells, chosen)
    shallowest, deepest = (int(depth.min()), int(depth.max())) if len(depth) else (0, 0)
    colors, norm = _depth_colors(deepest, shallowest)
    with drawn("wires", 10, 9.2 * height / width) as figure:
        axes = figure.subplots()
        # Paler than it is, so that lines of all colours stand out.
        axes.imshow(0.45 * pixels + 0.55, extent=(0, width, height, 0), interpolation="nearest")
        for level in range(shallowest, deepest + 1):
            lines = projection.edges(bounds[depth == level])
            strength = 1.6 * 0.8 ** (level - shallowest)
            axes.add_collection(
                LineCollection(
                    list(lines),
                    colors=[colors(norm(level))],
                    linewidths=max(strength, 0.45),
                    zorder=2 + level,
                )
            )
        axes.set(xlim=(0, width), ylim=(height, 0), xticks=[], yticks=[])
        for spine in axes.spines.values():
            spine.set_visible(False)
        axes.grid(visible=False)
        _legend(figure, axes, colors, norm)
        return to_png(figure), limit


def through(cells: Cells, axis: int, value: float) -> npt.NDArray[np.bool_]:
    """Say which cells the plane where ``axis`` is ``value`` passes; at a face, the upper one."""
    bounds = cells["bounds"]
    top = bounds[:, 1, axis]
    last = (value == cells["root"][1, axis]) & (top == value)
    return np.asarray(((bounds[:, 0, axis] <= value) & (value < top)) | last)


def middle(cells: Cells, camera: dict[str, Any] | None, bounds: Any) -> tuple[int, float]:
    """Choose the plane of a slice: through the scene's middle, and seen from the front."""
    low, high = cells["root"] if bounds is None else bounds
    axis = 2 if camera is None else int(np.abs(camera["forward"]).argmax())
    return axis, float(low[axis] + high[axis]) / 2


def _slice(axes: Axes, cells: Cells, plane: tuple[int, float], colors: Any, norm: Any) -> None:
    axis, value = plane
    across, up = [a for a in range(3) if a != axis]
    hit = through(cells, axis, value)
    bounds, depth = cells["bounds"][hit], cells["depth"][hit]
    full = cells["occupied"][hit]
    low, high = bounds[:, 0], bounds[:, 1]
    square = np.stack(
        [
            np.stack([corner_x[:, across], corner_y[:, up]], axis=-1)
            for corner_x, corner_y in ((low, low), (high, low), (high, high), (low, high))
        ],
        axis=1,
    )
    shade = colors(norm(depth))
    # Empty cells: the same colour, nearly white.
    shade[~full, :3] = 0.2 * shade[~full, :3] + 0.8
    axes.add_collection(
        PolyCollection(list(square), facecolors=shade, edgecolors="white", linewidths=0.25)
    )
    first, last = cells["root"]
    axes.set_xlim(first[across], last[across])
    axes.set_ylim(first[up], last[up])
    axes.set_aspect("equal")
    axes.set_xlabel(_AXES[across])
    axes.set_ylabel(_AXES[up])
    axes.grid(visible=False)
    axes.xaxis.set_major_formatter(EngFormatter())
    axes.yaxis.set_major_formatter(EngFormatter())


def distinct(cells: Mapping[str, Cells]) -> list[list[str]]:
    """Group the methods that have the same cells."""
    groups: dict[bytes, list[str]] = {}
    for method, arrays in cells.items():
        # Structures list their cells in different orders.
        order = np.lexsort([*arrays["bounds"][:, 0].T, arrays["depth"]])
        parts = [arrays[name][order].tobytes() for name in ("bounds", "depth", "occupied")]
        groups.setdefault(b"".join(parts), []).append(method)
    return list(groups.values())


def slices(
    cells: Mapping[str, Cells], groups: Sequence[list[str]], plane: tuple[int, float]
) -> bytes:
    """Draw the plane's slice through the cells of the first method of every group."""
    shown = [cells[methods[0]] for methods in groups]
    depths = [arrays["depth"][through(arrays, *plane)] for arrays in shown]
    deepest = max((int(d.max()) for d in depths if len(d)), default=0)
    shallowest = min((int(d.min()) for d in depths if len(d)), default=0)
    colors, norm = _depth_colors(deepest, shallowest)
    columns = min(len(groups), 3)
    lines = -(-len(groups) // columns)
    with drawn("slices", 10, lines * (0.55 + 8.8 / columns)) as figure:
        panels = figure.subplots(lines, columns, squeeze=False)
        for axes in panels.flat[len(groups) :]:
            axes.set_visible(False)
        for axes, arrays, methods in zip(panels.flat, shown, groups, strict=False):
            if through(arrays, *plane).any():
                _slice(axes, arrays, plane, colors, norm)
            more = f"\nand {len(methods) - 1} more" if len(methods) > 1 else ""
            axes.set_title(methods[0] + more, fontsize=8, fontweight="normal", family="monospace")
        _legend(figure, panels, colors, norm)
        return to_png(figure, dpi=170)
