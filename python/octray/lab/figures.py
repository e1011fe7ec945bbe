"""The lab's figures, taken from what octray reports of a rendering and of a structure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

#: The kinds of ray, in the order in which they are shown.
KINDS = ("primary", "shadow", "reflected", "refracted")


#: Parts of memory that are the scene's geometry, about the same for all methods.
GEOMETRY = ("surfaces", "faces", "triangles")
#: Entries of ``memory`` that are no parts.
_NO_PARTS = ("peak_bytes", "total", "building")


@dataclass
class Figures:
    """Figures of one method; ``None`` is what was not measured, or what the method has not."""

    #: Bytes of what finds surfaces; the most while it was made; all by part, geometry too.
    memory: int | None = None
    building: int | None = None
    parts: dict[str, int] | None = None
    #: Numbers of nodes by kind.
    nodes: dict[str, int] | None = None
    #: Why the builder did not divide further.
    stopped: dict[str, Any] | None = None
    #: For each depth, how many leaves are empty and how many occupied: (depth, empty, occupied).
    depths: list[list[int]] | None = None
    #: Pairs of a number of objects and how many occupied leaves hold so many.
    per_leaf: list[list[int]] | None = None
    #: The hash table, where there is one.
    lvsi: dict[str, Any] | None = None
    #: Of cells over triangles: questions whether one touches a cell, and lists that came of them;
    #: how many of the questions each step of the triangle-cube test decided.
    marks: dict[str, int] | None = None
    triangle_cube_steps: dict[str, int] | None = None
    #: The membership test of solids: its temporary pieces, its steps, and the marks it made.
    membership: dict[str, Any] | None = None
    #: Numbers of rays by kind.
    rays: dict[str, int] | None = None
    #: What a ray cost on average, of all and by kind of ray.
    per_ray: dict[str, float] | None = None
    per_ray_by_kind: dict[str, dict[str, float]] | None = None

    @property
    def cells(self) -> int | None:
        """Give the number of all nodes."""
        return None if self.nodes is None else sum(self.nodes.values())

    @property
    def structure(self) -> dict[str, int] | None:
        """Give the parts of memory without geometry."""
        if self.parts is None:
            return None
        return {part: size for part, size in self.parts.items() if part not in GEOMETRY}

    def each_ray(self, *names: str) -> float | None:
        """Sum these costs of a ray; ``None`` if none of them was counted."""
        counted = self.per_ray or {}
        known = [counted[name] for name in names if name in counted]
        return sum(known) if known else None


def _depths(trees: list[dict[str, Any]]) -> list[list[int]] | None:
    """Sum the leaves of octrees by depth; voxels of a grid have none."""
    octrees = [tree for tree in trees if tree["resolution"] is None]
    if not octrees:
        return None
    deepest = max(tree["depth"] for tree in octrees)

    def leaves(kind: str, depth: int) -> int:
        lists = [tree[f"{kind}_by_depth"] for tree in octrees]
        return sum(numbers[depth] for numbers in lists if depth < len(numbers))

    return [[d, leaves("empty", d), leaves("occupied", d)] for d in range(deepest + 1)]


def _per_leaf(trees: dict[str, Any]) -> list[list[int]]:
    """Sum the leaves by how many objects they hold; of a mesh sheet, each triangle counts."""
    counts: dict[int, int] = {}
    for over, what in (("cells", "objects_per_leaf"), ("triangles", "parts_per_leaf")):
        for number, leaves in trees[over][what]["counts"] if trees[over] else ():
            counts[number] = counts.get(number, 0) + leaves
    return [[number, counts[number]] for number in sorted(counts)]


def _of_trees(figures: Figures, trees: dict[str, Any]) -> None:
    """Take what there is to say about cells, over solids and over triangles together."""
    known = [tree for tree in trees.values() if tree is not None]
    cells = [tree for tree in known if "occupied" in tree]
    nodes: dict[str, int] = {}
    for kind in ("empty", "occupied", "divided") if cells else ():
        nodes[kind] = sum(tree[kind] for tree in cells)
    wide = [tree["nodes"] for tree in known if "nodes" in tree]
    if any(wide):
        nodes["wide"] = sum(wide)
    figures.nodes = nodes or None
    if not cells:
        return
    figures.depths, figures.per_leaf = _depths(cells), _per_leaf(trees)
    figures.stopped = {
        "depth": sum(tree["stopped_by_depth"] for tree in cells),
        "size": sum(tree["stopped_by_size"] for tree in cells),
        "memory": any(tree["stopped_by_memory"] for tree in cells),
    }
    figures.lvsi = next((tree["lvsi"] for tree in cells if tree["lvsi"]), None)


def of(report: dict[str, Any] | None, stats: dict[str, Any] | None) -> Figures:
    """Collect the figures of one method; nothing is invented where something is absent."""
    figures = Figures()
    built = stats or report
    if built is not None:
        _of_trees(figures, built["trees"])
        memory = built["memory"]
        figures.parts = {part: n for part, n in memory.items() if part not in _NO_PARTS}
        figures.memory = sum((figures.structure or {}).values())
        figures.building = memory["building"]
        membership = built["trees"]["membership"]
        if membership is not None:
            figures.membership = dict(membership)
        marks = built["triangle_cube"]
        if marks is not None:
            figures.triangle_cube_steps = marks["steps"]
            figures.marks = {what: n for what, n in marks.items() if what != "steps"}
    if report is not None:
        figures.rays = dict(report["rays"])
        figures.per_ray = dict(report["tests_per_ray"])
        figures.per_ray_by_kind = {kind: dict(report["tests_by_kind"][kind]) for kind in KINDS}
    return figures


def primitives_of(scene: dict[str, Any]) -> int:
    """Count the primitives of a described scene; a mesh counts by its triangles."""
    solids = sum(
        count
        for entry in scene["objects"]
        for kind, count in entry["primitives"].items()
        if kind != "mesh"
    )
    return int(solids + scene["triangles"])


def of_scene(scene: dict[str, Any]) -> dict[str, Any]:
    """Give what figures of a method depend on."""
    return {
        "objects": len(scene["objects"]),
        "primitives": primitives_of(scene) - scene["triangles"],
        "triangles": scene["triangles"],
        "lights": len(scene["lights"]),
        "bounds": scene["bounds"],
        "units": scene["units"],
    }
