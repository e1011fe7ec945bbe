"""How all figures of a report look, and how they become parts of a page."""

from __future__ import annotations

import base64
import contextlib
import io
import re
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from collections.abc import Iterator

#: Colours that people with any kind of colour vision tell apart (Okabe & Ito 2008).
COLORS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#f0e442", "#555555")
#: Text of less weight, and lines behind the data.
FAINT = "#59636e"
GRID = "#dfe3e8"
#: What depths are coloured with: lightness and hue grow evenly.
DEPTHS = "viridis_r"

_STYLE: Any = {
    "font.family": ["DejaVu Sans", "sans-serif"],
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.edgecolor": FAINT,
    "axes.labelcolor": "#24292f",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "xtick.color": FAINT,
    "ytick.color": "#24292f",
    "legend.frameon": False,
    "svg.fonttype": "none",
}


@contextlib.contextmanager
def drawn(name: str, width: float, height: float) -> Iterator[Figure]:
    """Give an empty figure (inches) with our style; ``name`` makes its parts' names unique."""
    with mpl.rc_context({**_STYLE, "svg.hashsalt": name}):
        figure = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(figure)
        yield figure


def to_svg(figure: Figure) -> str:
    """Give the figure as an ``<svg>`` element, the same text for the same figure."""
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    text = out.getvalue()
    text = text[text.index("<svg") :]
    return re.sub(r"\s*<metadata>.*?</metadata>", "", text, flags=re.DOTALL)


def to_png(figure: Figure, dpi: int = 150) -> bytes:
    """Give the figure as a PNG, for what has too many lines to be an SVG."""
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=dpi, metadata={"Software": None})
    return out.getvalue()


def data_uri(png: bytes) -> str:
    """Give an address that holds the picture itself."""
    return "data:image/png;base64," + base64.b64encode(png).decode("ascii")
