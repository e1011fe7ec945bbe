"""Heat maps: what every pixel cost, for all methods on one scale."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.ticker import FuncFormatter

from octray._table import number
from octray.lab.figure import drawn, to_png

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy.typing as npt

#: Steps, surfaces and triangles are counted alike: each is one thing that was looked at.
_COLUMNS = 3


def totals(cost: npt.NDArray[np.float32]) -> npt.NDArray[np.float64]:
    """Give steps and tests of each pixel together, per sample."""
    total: npt.NDArray[np.float64] = cost.astype(np.float64).sum(axis=-1)
    return total


def maps(costs: Mapping[str, npt.NDArray[np.float32]]) -> bytes:
    """Draw all heat maps side by side, from the lowest cost of all (at least 1) to the highest."""
    sums = {method: totals(cost) for method, cost in costs.items()}
    top = max(float(total.max()) for total in sums.values())
    low = max(min(float(total.min()) for total in sums.values()), 1.0)
    norm = LogNorm(low, max(top, 10 * low))
    columns = min(len(sums), _COLUMNS)
    lines = -(-len(sums) // columns)
    height, width = next(iter(sums.values())).shape
    with drawn("heat", 10, lines * (0.42 + 9.3 / columns * height / width) + 0.5) as figure:
        panels = figure.subplots(lines, columns, squeeze=False)
        for axes in panels.flat:
            axes.set_axis_off()
        for axes, (method, total) in zip(panels.flat, sums.items(), strict=False):
            axes.imshow(np.maximum(total, low), norm=norm, cmap="inferno", interpolation="nearest")
            axes.set_title(
                f"{method}\nmean {number(total.mean())}",
                fontsize=7.5,
                fontweight="normal",
                family="monospace",
            )
        bar = figure.colorbar(
            ScalarMappable(norm, "inferno"),
            ax=panels,
            location="bottom",
            shrink=0.6,
            aspect=40,
            pad=0.02,
        )
        bar.ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        bar.set_label("steps and tests per sample, logarithmic scale")
        return to_png(figure, dpi=140)
