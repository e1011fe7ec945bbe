"""Copies from Python: the page's example, pictures as if written out, and what is refused."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import octray
from conftest import ROOT
from examples import run_python

if TYPE_CHECKING:
    import numpy.typing as npt

CORNERS = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
SIDES = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]


def moves(*offsets: tuple[float, float, float]) -> npt.NDArray[np.float64]:
    transforms = np.tile(np.eye(4), (len(offsets), 1, 1))
    transforms[:, :3, 3] = offsets
    return transforms


def test_the_page_says_what_its_example_prints() -> None:
    compared = run_python(ROOT / "docs" / "instances.md")
    assert len(compared) == 5
    for printed, claim in compared:
        assert printed == claim


@pytest.mark.parametrize("spacing", [1.5, 3.0])
@pytest.mark.parametrize("look", ["#b83a3a", octray.Material.glass(absorption=0.3)])
def test_a_picture_of_copies_is_that_of_the_objects_written_out(
    look: str | octray.Material, spacing: float
) -> None:
    part = octray.box(2) - octray.sphere(1.25)
    # No two faces in one plane; the nearer ones overlap.
    offsets = [(x * spacing, y * spacing, 0.13 * x + 0.29 * y) for x in range(4) for y in range(4)]
    copies, written = octray.Scene(), octray.Scene()
    copies.add_instances(part, moves(*offsets), material=look)
    for offset in offsets:
        written.add(part.translate(*offset), material=look)
    for scene in (copies, written):
        scene.add(octray.half_space((0, 0, 1), -1), name="floor")
        scene.view_all()
    size, depth = (48, 36), 4
    pictures = [scene.render(size=size, max_depth=depth).to_numpy() for scene in (copies, written)]
    apart = abs(pictures[0].astype(int) - pictures[1].astype(int))
    assert (apart > 1).mean() < 1e-3
    brute = copies.render(size=size, max_depth=depth, accel="brute").to_numpy()
    np.testing.assert_array_equal(pictures[0], brute)


@pytest.mark.parametrize("solid", [None, True])
def test_meshes_and_lists_are_copied(solid: bool | None) -> None:
    mesh = (CORNERS, SIDES)
    ball = octray.sphere(0.5).translate(z=3)
    everything: list[Any] = [mesh, list(mesh), [mesh], [mesh, ball], [ball, mesh]]
    for what in everything:
        scene = octray.Scene()
        scene.add_instances(what, moves((0, 0, 0), (5, 0, 0))[:, :3], solid=solid)
        hits = scene.cast_rays([[5.1, 0.1, -4, 0, 0, 1], [0.1, 0.1, 2, 0, 0, 1]])
        assert hits.t[0] == 4
        met = 0 if any(part is ball for part in what) else -1
        assert hits.instance_id.tolist() == [1, met]
        inside = scene.compute_occupancy([[5.1, 0.1, 0.1]])
        assert inside.tolist() == [solid is True]


def test_intervals_know_their_copies() -> None:
    scene = octray.Scene()
    scene.add(octray.box(1), name="plain")
    scene.add_instances(octray.sphere(1), moves((4, 0, 0), (8, 0, 0)), name="balls")
    found = scene.list_intersections([[-5, 0, 0, 1, 0, 0]])
    assert found.object_id.tolist() == [0, 1, 1]
    assert found.instance_id.tolist() == [-1, 0, 1]
    np.testing.assert_array_equal(found.t_enter, [4.5, 8, 12])
    np.testing.assert_array_equal(found.normal_exit, [[1, 0, 0]] * 3)
    assert scene.count_intersections([[-5, 0, 0, 1, 0, 0]]).tolist() == [6]


@pytest.mark.parametrize(
    ("what", "transforms", "message"),
    [
        (octray.sphere(1), np.eye(4), r"shape \(N, 4, 4\) or \(N, 3, 4\), not \(4, 4\)"),
        (octray.sphere(1), np.zeros((2, 4, 3)), r"transforms must be an array"),
        (octray.sphere(1), np.zeros((2, 3, 4)), "transform 0 is not finite or cannot be inverted"),
        (octray.sphere(1), [np.eye(4), np.eye(4) * 2], "transform 1 is not affine"),
        (octray.sphere(1), [np.eye(4) * [1, 1, np.nan, 1]], "transform 0"),
        (octray.half_space((0, 0, 1), 0), [np.eye(4)], "part 0 of the prototype has no end"),
    ],
)
def test_what_cannot_be_copied_is_refused(what: Any, transforms: Any, message: str) -> None:
    scene = octray.Scene()
    with pytest.raises(ValueError, match=message):
        scene.add_instances(what, transforms)
    assert len(scene) == 0


def test_no_copies_and_wrong_things() -> None:
    scene = octray.Scene()
    scene.add_instances(octray.sphere(1), [])
    scene.add_instances([], np.eye(4)[None])
    assert scene.cast_rays([[0, 0, -5, 0, 0, 1]]).instance_id.tolist() == [-1]
    with pytest.raises(TypeError, match="expected a path"):
        scene.add_instances(3, np.eye(4)[None])  # type: ignore[arg-type]
    assert len(scene) == 2


def test_more_copies_than_the_memory_limit_allows_are_refused() -> None:
    scene = octray.Scene()
    scene.add_instances(octray.sphere(1), moves(*[(float(i), 0, 0) for i in range(2000)]))
    with pytest.raises(MemoryError, match="instances: a tree over 2000 items"):
        scene.prepare(tree_memory=50_000)


def test_a_description_counts_the_copies() -> None:
    scene = octray.Scene()
    scene.add_instances((CORNERS, SIDES), moves((0, 0, 0), (5, 0, 0)), name="pair")
    entry = scene.describe()["objects"][0]
    assert (entry["kind"], entry["instances"], entry["triangles"]) == ("instances", 2, 4)
    assert entry["bounds"] == [[0, 0, 0], [6, 1, 1]]
    assert json.dumps(scene.stats()["trees"]["instances"])
    assert scene.check_meshes()[0]["solid"]
