"""What ``octray render --json`` prints."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from octray.cli.messages import as_dict

if TYPE_CHECKING:
    from octray import Diagnostic, Image
    from octray.cli.output import Output


class Report:
    """Collects what there is to say about one rendering."""

    def __init__(self, scene: str, options: dict[str, Any]) -> None:
        """Start with what was asked."""
        self.phases: dict[str, float] = {}
        self.error: str | None = None
        self._asked = {"scene": scene, "args": options}
        self._rendering: dict[str, Any] = {}
        self._messages: list[dict[str, Any]] = []
        self._outputs: list[dict[str, Any]] = []

    def add_messages(self, diagnostics: list[Diagnostic]) -> None:
        """Add what the scene's reader said."""
        self._messages.extend(as_dict(diagnostic) for diagnostic in diagnostics)

    def add_rendering(self, rendering: dict[str, Any]) -> None:
        """Add what the rendering cost."""
        self._rendering = dict(rendering)
        self.phases["render_s"] = self._rendering.pop("phases")["render_s"]

    def add_output(self, output: Output, image: Image) -> None:
        """Add a picture that was written."""
        self._outputs.append(
            {
                "path": output.name,
                "format": output.format,
                "size": list(image.size),
                "complete": image.complete,
            }
        )

    def to_json(self, code: int) -> str:
        """Give the one object."""
        from octray import __version__

        return json.dumps(
            {
                "octray": __version__,
                **self._asked,
                "phases": self.phases,
                **self._rendering,
                "warnings": [m for m in self._messages if m["severity"] == "warning"],
                "errors": [m for m in self._messages if m["severity"] == "error"],
                "error": self.error,
                "outputs": self._outputs,
                "exit": int(code),
            },
            indent=2,
        )

    def details(self) -> str:
        """Give the same for people, as ``--verbose`` shows it."""
        rendering = self._rendering
        rays = ", ".join(f"{count} {kind}" for kind, count in rendering["rays"].items())
        tests = ", ".join(
            f"{number:.2f} {kind}" for kind, number in rendering["tests_per_ray"].items()
        )
        lines = [f"  rays {rays}", f"  tests per ray {tests}", f"  threads {rendering['threads']}"]
        for name, tree in rendering["trees"].items():
            if tree is not None:
                lines.append(f"  tree of {name}: {_flat(tree)}")
        cells = rendering["trees"]["cells"]
        if cells is not None:
            lines += _details_of_cells(cells)
        parts = {k: v for k, v in rendering["memory"].items() if k != "peak_bytes" and v}
        lines.append("  bytes " + ", ".join(f"{v} {k}" for k, v in parts.items()))
        peak = rendering["memory"]["peak_bytes"]
        if peak is not None:
            lines.append(f"  memory {peak / 2**20:.0f} MiB at most")
        return "\n".join(lines)


def _flat(figures: dict[str, Any]) -> str:
    """Give the figures that are single values."""
    return ", ".join(
        f"{key} {value}"
        for key, value in figures.items()
        if not isinstance(value, list | tuple | dict | type(None))
    )


def _details_of_cells(cells: dict[str, Any]) -> list[str]:
    """Give leaves by depth and by what they hold."""
    lines = []
    if cells["resolution"] is not None:
        lines.append("    voxels " + " x ".join(str(n) for n in cells["resolution"]))
    else:
        for kind in ("empty", "occupied"):
            numbers = cells[f"{kind}_by_depth"]
            at = (f"{count} at {depth}" for depth, count in enumerate(numbers) if count)
            lines.append(f"    {kind} by depth: {', '.join(at) or 'none'}")
    for what in ("objects", "parts"):
        tally = cells[f"{what}_per_leaf"]
        lines.append(f"    {what} in a leaf: mean {tally['mean']:.3g}, at most {tally['max']}")
    if cells["lvsi"] is not None:
        lines.append(f"    hash table: {_flat(cells['lvsi'])}")
    return lines
