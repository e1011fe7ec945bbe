"""What methods build: figures, cells as arrays, criteria of division and sizes of hash tables."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pytest

import octray

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Octray

SIZE = (40, 30)


def plate() -> octray.Scene:
    scene = octray.Scene()
    holes = [octray.cylinder(r=0.3, h=4).translate(x=i, y=j) for i in range(6) for j in range(6)]
    scene.add(octray.box((7, 7, 1)).translate(x=2.5, y=2.5) - octray.union(holes))
    scene.add(octray.sphere(0.8).translate(x=100.5, z=3))
    return scene


@pytest.mark.parametrize("accel", ["auto", "octree:lvsi", "octree:lvsi-empty", "grid", "grid:9"])
def test_cells_fill_the_root_hold_the_surfaces_and_are_what_the_figures_count(accel: str) -> None:
    scene = plate()
    cells = scene.cells(accel=accel)
    stats = scene.stats(accel=accel)["trees"]["cells"]
    n = len(cells)
    assert cells.bounds.shape == (n, 2, 3)
    assert cells.key.shape == (n, 4)
    assert cells.depth.shape == cells.kind.shape == cells.objects.shape == cells.parts.shape == (n,)
    occupied = cells.kind == "occupied"
    assert set(np.unique(cells.kind)) <= {"empty", "occupied"}
    np.testing.assert_array_equal(cells.objects > 0, occupied)
    np.testing.assert_array_equal(cells.parts > 0, occupied)
    assert occupied.sum() == stats["occupied"]
    lowest, highest = np.array(cells.root)
    sizes = cells.bounds[:, 1] - cells.bounds[:, 0]
    share = sizes.prod(axis=1).sum() / (highest - lowest).prod()
    if accel == "octree:lvsi":
        assert occupied.all()
        assert share < 1
    else:
        assert n == stats["occupied"] + stats["empty"]
        assert share == pytest.approx(1)
    if accel.startswith("octree") or accel == "auto":
        np.testing.assert_array_equal(cells.key[:, 0], cells.depth)
        corner = lowest + (highest - lowest) * cells.key[:, 1:] / 2.0 ** cells.depth[:, None]
        np.testing.assert_allclose(cells.bounds[:, 0], corner, atol=1e-9)
        by_depth = np.bincount(cells.depth[occupied], minlength=len(stats["occupied_by_depth"]))
        assert by_depth.tolist() == stats["occupied_by_depth"]
    else:
        assert cells.depth.max() == 0
        assert n == np.prod(stats["resolution"])
    for what in ("objects", "parts"):
        tally = stats[f"{what}_per_leaf"]
        values, counts = np.unique(getattr(cells, what)[occupied], return_counts=True)
        assert tally["counts"] == np.column_stack([values, counts]).tolist()
        assert tally["max"] == values[-1]
        assert tally["mean"] == pytest.approx(getattr(cells, what)[occupied].mean())
    rays = np.random.default_rng(1).normal(size=(200, 6))
    rays += np.array([2, 2, 5, 0, 0, -2])
    hits = scene.cast_rays(rays, accel=accel)
    points = hits.position[hits.hit]
    assert len(points) > 20
    boxes = cells.bounds[occupied]
    inside = (points[:, None] >= boxes[:, 0] - 1e-9) & (points[:, None] <= boxes[:, 1] + 1e-9)
    assert inside.all(axis=2).any(axis=1).all()


def test_methods_without_cells_say_so() -> None:
    for accel in ("brute", "boxes", "spheres"):
        with pytest.raises(ValueError, match=f"{accel} divides no space into cells"):
            plate().cells(accel=accel)
        assert plate().stats(accel=accel)["trees"]["cells"] is None
    with pytest.raises(ValueError, match="makes no cells over solids of this scene"):
        octray.Scene().cells()
    with pytest.raises(ValueError, match="kind must be"):
        plate().cells(kind="voxels")  # type: ignore[arg-type]


def test_memory_is_told_by_part_and_the_table_by_what_it_holds() -> None:
    scene = plate()
    stats = scene.stats(accel="octree:lvsi")
    assert stats["method"] == "octree:lvsi:sung:analytic"
    table = stats["trees"]["cells"]["lvsi"]
    assert table["leaves"] == stats["trees"]["cells"]["occupied"]
    assert (
        table["bytes"] == stats["memory"]["cells"] == 4 * table["table_size"] + 48 * table["rows"]
    )
    assert table["bytes_per_leaf"] == table["bytes"] / table["leaves"]
    assert 1 <= table["longest_chain"] <= table["rows"]
    memory = stats["memory"]
    parts = ("cells", "contents", "expressions", "surfaces", "faces", "triangles", "wide_trees")
    assert memory["total"] == sum(memory[part] for part in parts)
    assert memory["triangles"] == memory["wide_trees"] == 0
    assert memory["building"] == stats["trees"]["cells"]["peak_bytes"] > 0
    mesh = octray.Scene()
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1)]
    triangles = [(0, 1, 2), (0, 1, 3), (1, 2, 4), (0, 2, 3), (1, 3, 5), (2, 3, 4)]
    mesh.add_mesh((corners, triangles))
    memory, wide = mesh.stats()["memory"], mesh.stats()["trees"]["wide"]
    assert memory["triangles"] == 6 * 24 + 6 * 12
    # Nine floats for each reference to a triangle. A look at one sees eight, and eight floats.
    assert memory["wide_trees"] == wide["bytes"] + 4 * (9 * (wide["references"] + 7) + 8)


def fan() -> octray.Scene:
    """Long triangles askew, whose boxes are nearly empty, over a fine grid."""
    turns = np.linspace(0, 3, 400)
    tips = np.stack([np.cos(turns), np.sin(turns), np.sin(3 * turns)], axis=1) * 5
    roots = -tips + np.stack([turns, -turns, turns], axis=1)
    corners = np.concatenate([roots, tips, tips + 0.05])
    n = len(turns)
    scene = octray.Scene()
    scene.add_mesh((corners, [(i, n + i, 2 * n + i) for i in range(n)]))
    x, y = (axis.ravel() for axis in np.mgrid[0:30, 0:30] / 3 - 5)
    grid = np.stack([x, y, np.sin(x + y) - 6], axis=1)
    cells = [30 * i + j for i in range(29) for j in range(29)]
    scene.add_mesh((grid, [(c, c + 1, c + 30) for c in cells]))
    return scene


def test_both_qualities_give_the_same_picture_and_full_cuts_long_triangles() -> None:
    pictures = []
    qualities: list[Literal["fast", "full"] | None] = ["fast", "full", None]
    for quality in qualities:
        scene = fan()
        scene.prepare(quality=quality)
        wide = scene.stats()["trees"]["wide"]
        assert wide["items"] == 400 + 29 * 29
        extra = wide["references"] - wide["items"]
        assert extra == 0 if quality == "fast" else 0 < extra <= 0.3 * wide["items"]
        pictures.append(scene.render(size=SIZE))
    assert pictures[0].equals(pictures[1])
    assert pictures[0].equals(pictures[2])
    brute = fan().render(size=SIZE, accel="brute")
    assert pictures[0].equals(brute)
    with pytest.raises(ValueError, match='quality must be "fast" or "full", not "best"'):
        fan().prepare(quality="best")  # type: ignore[arg-type]


CRITERIA: list[dict[str, Any]] = [
    {"tree_objects": 2, "tree_cost": "off", "tree_depth": 7},
    {"tree_cost": 0.5},
    {"tree_cost": "off", "tree_depth": 4},
    {"tree_share": 0.4, "tree_cost": "off", "tree_depth": 6},
    {"tree_cost": "off", "tree_memory": 200_000},
]


def test_criteria_bite_and_do_not_show() -> None:
    picture = plate().render(size=SIZE)
    usual = len(plate().cells())
    for criteria in CRITERIA:
        scene = plate()
        scene.prepare(**criteria)
        assert scene.render(size=SIZE).equals(picture)
        cells = scene.cells()
        assert len(cells) != usual
        depth = criteria.get("tree_depth", 16)
        assert cells.depth.max() <= depth
        above = cells.depth < depth
        assert cells.parts[above].max() <= criteria.get("tree_objects", 1000)
        stats = scene.stats()["trees"]["cells"]
        if "tree_memory" in criteria:
            assert stats["stopped_by_memory"]
            assert stats["bytes"] <= criteria["tree_memory"]
    tables: list[Literal["prime", "power-of-two"]] = ["prime", "power-of-two"]
    for table in tables:
        for load in (0.25, 4.0):
            scene = plate()
            scene.prepare(accel="octree:lvsi", lvsi_table=table, lvsi_load=load)
            assert scene.render(size=SIZE, accel="octree:lvsi").equals(picture)
            stats = scene.stats(accel="octree:lvsi")["trees"]["cells"]["lvsi"]
            assert stats["rows"] / stats["table_size"] <= load * 1.001
            assert (stats["table_size"] & (stats["table_size"] - 1) == 0) == (table != "prime")


@pytest.mark.parametrize(
    ("criterion", "value"),
    [
        ("tree_depth", 22),
        ("tree_cost", "on"),
        ("tree_cost", -1),
        ("tree_cost", float("nan")),
        ("tree_cost", []),
        ("tree_share", 1.5),
        ("tree_share", float("nan")),
        ("lvsi_table", "odd"),
        ("lvsi_load", 0),
        ("lvsi_load", float("inf")),
    ],
)
def test_bad_criteria_are_refused_by_name(criterion: str, value: Any) -> None:
    with pytest.raises(ValueError, match=criterion):
        plate().prepare(**{criterion: value})


def test_criteria_are_options_of_render_and_query(octray_command: Octray, tmp_path: Path) -> None:
    scene = (
        "difference() { cube([10, 10, 10]);"
        " multmatrix([[1,0,0,3],[0,1,0,3],[0,0,1,-1],[0,0,0,1]]) cylinder(h=12, r1=1, r2=1); }"
    )
    (tmp_path / "a.csg").write_text(scene + "sphere(r = 2);", encoding="utf-8")
    np.save(tmp_path / "rays.npy", np.array([[5.0, 5.0, 99.0, 0.0, 0.0, -1.0]]))
    options: tuple[str | float, ...] = (
        "--tree-cost",
        "off",
        "--tree-objects",
        1,
        "--tree-depth",
        5,
        "--tree-share",
        0.9,
    )
    options += (
        "--quality",
        "fast",
        "--tree-memory",
        10,
        "--lvsi-table",
        "power-of-two",
        "--lvsi-load",
        2,
    )
    accel = ("--accel", "octree:lvsi")
    size = ("--size", "24x16")
    done = octray_command("render", "a.csg", *size, *accel, *options, "--json", "-v")
    cells = json.loads(done.stdout)["trees"]["cells"]
    assert cells["depth"] == 5
    assert cells["lvsi"]["table_size"].bit_count() == 1
    for text in ("occupied by depth", "parts in a leaf: mean", "hash table: leaves", "building"):
        assert text in done.stderr
    assert "None" not in done.stderr
    found = octray_command("query", "a.csg", "--rays", "rays.npy", *accel, *options)
    assert json.loads(found.stdout.splitlines()[0])["t"] == 89
    for option, value in (
        ("--quality", "best"),
        ("--tree-cost", "cheap"),
        ("--tree-cost", "inf"),
        ("--tree-objects", 0),
        ("--tree-share", 2),
        ("--tree-depth", 22),
        ("--lvsi-load", 0),
        ("--lvsi-table", "odd"),
    ):
        for command in ("render", "query"):
            done = octray_command(command, "a.csg", option, value)
            assert done.returncode == 2
            assert option in done.stderr
