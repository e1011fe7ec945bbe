"""What the lab draws: the right places of the right cells."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import octray
from octray.lab.projection import Projection, corners, view

if TYPE_CHECKING:
    from collections.abc import Mapping

pytest.importorskip("matplotlib")

from octray.lab import cells, charts, heat, histograms
from octray.lab.figure import COLORS
from octray.lab.result import Combination, Status

CAMERAS = {
    "perspective": octray.Camera.look_at((3, -4, 2.5), (0.2, 0.1, 0.3), fov=35),
    "orthographic": octray.Camera.orthographic((3, -4, 2.5), (0.2, 0.1, 0.3), height=3.5),
}
SIZE = (60, 40)


def part(camera: octray.Camera) -> octray.Scene:
    """Two bodies that shine red, in front of blue."""
    scene = octray.Scene()
    light = octray.Material(emission=(1, 0, 0), diffuse=0.0)
    scene.add(octray.box((1, 1, 0.5)) - octray.cylinder(r=0.3, h=1), material=light)
    scene.add(octray.sphere(0.4).translate(x=0.8, z=0.7), material=light)
    scene.background = (0, 0, 1)
    scene.camera = camera
    return scene


def seen_from(scene: octray.Scene, crop: list[int] | None = None) -> tuple[Projection, Any]:
    return view(scene.describe()["camera"], list(SIZE), crop)


@pytest.mark.parametrize("kind", CAMERAS)
def test_rays_are_those_of_the_picture_and_points_fall_where_they_came_from(kind: str) -> None:
    scene = part(CAMERAS[kind])
    lit = scene.render(size=SIZE).to_numpy()[..., 0] > 0
    projection, shape = seen_from(scene)
    assert shape == (40, 60)
    hits = scene.cast_rays(projection.rays(shape))
    np.testing.assert_array_equal(hits.hit.reshape(shape), lit)
    depth, pixels = projection.depth_and_pixels(hits.position[hits.hit])
    rows, columns = np.nonzero(lit)
    np.testing.assert_allclose(pixels[:, 0], columns + 0.5, atol=1e-9)
    np.testing.assert_allclose(pixels[:, 1], rows + 0.5, atol=1e-9)
    assert (depth > 0).all()
    # A part of the picture has the same rays.
    cropped, part_shape = seen_from(scene, [10, 5, 30, 25])
    assert part_shape == (20, 20)
    whole = projection.rays(shape).reshape(40, 60, 6)
    np.testing.assert_array_equal(cropped.rays(part_shape).reshape(20, 20, 6), whole[5:25, 10:30])


def test_a_box_has_twelve_edges_and_neighbours_share_four() -> None:
    projection, _ = seen_from(part(CAMERAS["perspective"]))
    one = np.array([[[0, 0, 0], [1, 1, 1]]], dtype=float)
    two = np.concatenate([one, one + np.array([1, 0, 0])])
    assert len(projection.edges(one)) == 12
    assert len(projection.edges(two)) == 20
    # Each edge joins two corners that differ on one axis.
    _, pixels = projection.depth_and_pixels(corners(one)[0])
    ends = projection.edges(one)
    for a, b in ends:
        first = int(np.abs(pixels - a).sum(axis=1).argmin())
        second = int(np.abs(pixels - b).sum(axis=1).argmin())
        assert (first ^ second).bit_count() == 1


def test_edges_behind_the_eye_are_cut_where_the_view_begins() -> None:
    camera = {
        "kind": "perspective",
        "eye": [0.0, 0.0, 0.0],
        "forward": [0.0, 1.0, 0.0],
        "right": [1.0, 0.0, 0.0],
        "up": [0.0, 0.0, 1.0],
        "fit_aspect": True,
    }
    projection = Projection(camera, (100, 100))
    around = projection.edges(np.array([[[-1, -1, -1], [1, 1, 1]]], dtype=float))
    # Four edges lie in front, four pass the eye's plane, four lie behind.
    assert len(around) == 8
    assert np.isfinite(around).all()
    behind = projection.edges(np.array([[[-1, -3, -1], [1, -2, 1]]], dtype=float))
    assert len(behind) == 0


def octree(points: np.ndarray[Any, Any], deepest: int) -> Mapping[str, Any]:
    """A cube from 0 to 1, divided wherever there are points."""
    rows: list[tuple[Any, Any, int, bool]] = []

    def divide(low: Any, side: float, depth: int) -> None:
        full = bool(((points >= low) & (points < low + side)).all(axis=1).any())
        if not full or depth == deepest:
            rows.append((low, low + side, depth, full))
            return
        for number in range(8):
            step = np.array([number & 1, number >> 1 & 1, number >> 2 & 1])
            divide(low + step * side / 2, side / 2, depth + 1)

    divide(np.zeros(3), 1.0, 0)
    return {
        "root": np.array([[0, 0, 0], [1, 1, 1]], dtype=float),
        "bounds": np.array([(low, high) for low, high, _, _ in rows]),
        "depth": np.array([depth for _, _, depth, _ in rows]),
        "occupied": np.array([full for *_, full in rows]),
    }


POINTS = np.random.default_rng(3).random((60, 3)) * [1, 1, 0.4]
CELLS = octree(POINTS, 4)


def contains(bounds: Any, points: Any) -> Any:
    """Which boxes have which points, one after the other."""
    inside = (points[None] >= bounds[:, None, 0]) & (points[None] < bounds[:, None, 1])
    return inside.all(axis=-1)


def test_cells_that_hold_points_are_found() -> None:
    some = POINTS[:20]
    expected = contains(CELLS["bounds"], some).any(axis=1)
    np.testing.assert_array_equal(cells.holding(CELLS, some), expected)
    assert 0 < expected.sum() < CELLS["occupied"].sum()
    assert not cells.holding(CELLS, POINTS + 5).any()
    np.testing.assert_array_equal(cells.holding(CELLS, POINTS), CELLS["occupied"])


def test_too_many_cells_become_their_ancestors() -> None:
    full = CELLS["occupied"]
    bounds, depth, limit = cells.coarsened(CELLS, full)
    assert limit is None
    np.testing.assert_array_equal(bounds, CELLS["bounds"][full])
    bounds, depth, limit = cells.coarsened(CELLS, full, most=30)
    assert limit is not None
    assert len(bounds) == len(depth) <= 30
    assert depth.max() == limit < 4
    # The same points are covered, each once.
    np.testing.assert_array_equal(contains(bounds, POINTS).sum(axis=0), 1)
    one, _, limit = cells.coarsened(CELLS, full, most=1)
    assert limit == 0
    np.testing.assert_array_equal(one, [CELLS["root"]])


@pytest.mark.parametrize("value", [0.0, 0.3, 0.5, 1.0])
def test_a_slice_is_a_partition_of_its_plane(value: float) -> None:
    hit = cells.through(CELLS, 2, value)
    sides = CELLS["bounds"][hit][:, 1] - CELLS["bounds"][hit][:, 0]
    assert (sides[:, 0] * sides[:, 1]).sum() == pytest.approx(1)
    assert not cells.through(CELLS, 2, 1.5).any()


def test_methods_with_the_same_cells_share_a_panel() -> None:
    order = np.random.default_rng(1).permutation(len(CELLS["depth"]))
    shuffled = {name: array if name == "root" else array[order] for name, array in CELLS.items()}
    other = octree(POINTS, 3)
    groups = cells.distinct({"a": CELLS, "b": other, "c": shuffled})
    assert groups == [["a", "c"], ["b"]]
    png = cells.slices({"a": CELLS, "b": other, "c": shuffled}, groups, (2, 0.2))
    assert png.startswith(b"\x89PNG")


def test_the_plane_of_a_slice_is_the_middle_seen_from_the_front() -> None:
    camera = {"forward": [0.1, -0.9, 0.2]}
    assert cells.middle(CELLS, camera, ((0, 2, 0), (1, 6, 1))) == (1, 4.0)
    assert cells.middle(CELLS, None, None) == (2, 0.5)


def test_frames_are_drawn_where_the_cells_are() -> None:
    from matplotlib.image import imread  # noqa: PLC0415 - it is there, says importorskip

    blank = np.ones((40, 60, 3))
    out = io.BytesIO()
    from matplotlib.image import imsave  # noqa: PLC0415

    imsave(out, blank, format="png")
    camera = octray.Camera.look_at((0.5, -3, 0.5), (0.5, 0, 0.5), fov=40)
    scene = part(camera)
    projection, _ = seen_from(scene)
    png, limit = cells.over_picture(out.getvalue(), CELLS, projection, POINTS[:5])
    assert limit is None
    drawn = imread(io.BytesIO(png), format="png")
    assert drawn.shape[0] > 300
    assert (drawn[..., :3].min(axis=-1) < 0.5).any()


def test_heat_maps_sum_what_a_pixel_cost() -> None:
    cost = np.arange(24, dtype=np.float32).reshape(2, 4, 3)
    np.testing.assert_array_equal(heat.totals(cost), cost.sum(axis=-1))
    assert heat.maps({"a": cost, "b": cost * 0}).startswith(b"\x89PNG")


def test_charts_say_why_a_row_is_empty_and_are_the_same_each_time() -> None:
    done = Combination("auto", build_s=[0.1], render_s=[1.0, 2.0])
    gone = Combination("grid", status=Status.OUT_OF_MEMORY)
    chart = charts.times([done, gone])
    assert "out of memory" in chart
    assert chart == charts.times([done, gone])
    assert charts.work([done, gone]) is None
    nothing = charts.stacked("m", "Memory", [done, gone], [None, None])
    assert nothing is None
    bars = charts.stacked("m", "Memory", [done, gone], [{"cells": 10, "none": 0}, None])
    assert bars is not None
    assert "cells" in bars
    assert ">none<" not in bars
    assert COLORS[0] in bars


def test_histograms_of_large_numbers_have_ranges() -> None:
    two = [Combination("a"), Combination("b")]
    few = histograms.histograms("h", "objects", two, [[[0, 3], [2, 5]], None])
    assert few is not None
    assert "\N{EN DASH}" not in few
    many = histograms.histograms("h", "objects", two, [[[0, 3], [2, 5], [90, 1]], [[1, 1]]])
    assert many is not None
    assert "65\N{EN DASH}128" in many
    assert histograms.histograms("h", "objects", two, [None, []]) is None
