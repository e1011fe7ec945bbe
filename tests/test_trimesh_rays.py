"""``scene.ray`` beside trimesh's ``mesh.ray``: names, orders, kinds, and the same answers."""

from __future__ import annotations

import inspect
import math
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import octray
from octray.ray import RayIntersector

_Floats = npt.NDArray[np.float64]


def pyramid(n: int) -> tuple[_Floats, npt.NDArray[np.int64]]:
    """A closed mesh of 2 n triangles over a polygon that no ray below hits at an edge."""
    angles = np.arange(n) * (2 * math.pi / n) + 0.1
    rim = np.c_[np.cos(angles), np.sin(angles), np.zeros(n)]
    vertices = np.r_[rim, [[0.05, 0.02, 1.5], [0.01, -0.03, -1.0]]]
    sides = [[i, (i + 1) % n, n] for i in range(n)] + [[(i + 1) % n, i, n + 1] for i in range(n)]
    return vertices, np.array(sides)


def some_rays(count: int) -> tuple[_Floats, _Floats]:
    rng = np.random.default_rng(17)
    return rng.uniform(-2, 2, (count, 3)), rng.normal(size=(count, 3))


def both(solid: bool) -> tuple[octray.Scene, octray.Scene]:
    """One mesh alone, and the same mesh after another one."""
    alone, second = octray.Scene(), octray.Scene()
    alone.add_mesh(pyramid(7), solid=solid)
    vertices, faces = pyramid(5)
    second.add_mesh((vertices + 50, faces), solid=solid)
    second.add_mesh(pyramid(7), solid=solid)
    return alone, second


def crossings_by_hand(origins: _Floats, directions: _Floats) -> list[list[tuple[float, int]]]:
    """Distance and triangle of every crossing, by the textbook and one ray at a time."""
    vertices, faces = pyramid(7)
    corner, *others = (vertices[faces[:, i]] for i in range(3))
    a, b = (other - corner for other in others)
    found = []
    for origin, direction in zip(origins, directions, strict=True):
        p = np.cross(direction, b)
        determinant = (a * p).sum(axis=1)
        u = ((origin - corner) * p).sum(axis=1) / determinant
        q = np.cross(origin - corner, a)
        v = (q @ direction) / determinant
        t = (b * q).sum(axis=1) / determinant
        hit = (u > 0) & (v > 0) & (u + v < 1) & (t > 0)
        found.append(sorted((float(t[i]), int(i)) for i in np.flatnonzero(hit)))
    return found


@pytest.mark.parametrize("solid", [False, True])
def test_triangles_keep_their_numbers(solid: bool) -> None:
    origins, directions = some_rays(3000)
    expected = crossings_by_hand(origins, directions)
    rays = np.repeat(np.arange(3000), [len(hits) for hits in expected])
    assert len(rays) > 500
    triangles = np.array([triangle for hits in expected for _, triangle in hits])
    t = np.array([t for hits in expected for t, _ in hits])
    for scene, first in zip(both(solid), (0, 10), strict=True):
        index_tri, index_ray, locations = scene.ray.intersects_id(
            origins, directions, return_locations=True
        )
        assert index_tri.dtype == index_ray.dtype == np.int64
        np.testing.assert_array_equal(index_ray, rays)
        np.testing.assert_array_equal(index_tri, triangles + first)
        np.testing.assert_allclose(
            locations, origins[rays] + t[:, None] * directions[rays], atol=1e-9
        )
        located = scene.ray.intersects_location(origins, directions)
        for one, other in zip(located, (locations, index_ray, index_tri), strict=True):
            np.testing.assert_array_equal(one, other)
        firsts = np.array([hits[0][1] + first if hits else -1 for hits in expected])
        np.testing.assert_array_equal(scene.ray.intersects_first(origins, directions), firsts)
        assert scene.ray.intersects_first(origins, directions).dtype == np.int64
        hit_any = scene.ray.intersects_any(origins, directions)
        assert hit_any.dtype == np.bool_
        np.testing.assert_array_equal(hit_any, firsts >= 0)
        one_each = scene.ray.intersects_location(origins, directions, multiple_hits=False)
        np.testing.assert_array_equal(one_each[1], np.flatnonzero(firsts >= 0))
        np.testing.assert_array_equal(one_each[2], firsts[firsts >= 0])
        two = scene.ray.intersects_id(origins, directions, max_hits=2)
        at_most = np.minimum([len(hits) for hits in expected], 2)
        np.testing.assert_array_equal(np.bincount(two[1], minlength=3000), at_most)


def test_nothing_hit_is_empty_arrays_of_the_right_kinds() -> None:
    for scene in (both(False)[0], octray.Scene()):
        for rays in (([[5, 5, 5]], [[0, 0, 1]]), ([], [])):
            locations, index_ray, index_tri = scene.ray.intersects_location(*rays)
            assert locations.shape == (0, 3)
            assert locations.dtype == np.float64
            assert index_ray.shape == index_tri.shape == (0,)
            assert index_ray.dtype == index_tri.dtype == np.int64


def test_wrong_rays_are_refused() -> None:
    ray = both(False)[0].ray
    good = np.zeros((2, 3))
    wrong: list[Any] = [np.zeros((2, 2)), np.zeros(3), np.zeros((2, 3), complex), [["a"] * 3]]
    for bad in wrong:
        with pytest.raises(ValueError, match=r"ray_origins must be .* shape \(n, 3\), not shape"):
            ray.intersects_any(bad, good)
        with pytest.raises(ValueError, match=r"points must be .* shape \(n, 3\), not shape"):
            ray.contains_points(bad)
    with pytest.raises(ValueError, match="as many ray_directions as ray_origins, not 1 and 2"):
        ray.intersects_id(good, good[:1])
    with pytest.raises(ValueError, match="max_hits must be at least 1, not 0"):
        ray.intersects_id(good, good, max_hits=0)


def test_points_in_solids_are_contained() -> None:
    points = np.random.default_rng(2).uniform(-1.2, 1.2, (500, 3))
    sheet, solid = both(False)[0], both(True)[0]
    inside = solid.ray.contains_points(points)
    assert inside.dtype == np.bool_
    up = crossings_by_hand(points, np.tile([0.01, 0.02, 1.0], (500, 1)))
    np.testing.assert_array_equal(inside, [len(hits) % 2 == 1 for hits in up])
    assert 50 < inside.sum() < 450
    assert not sheet.ray.contains_points(points).any()


def test_trimesh_says_the_same() -> None:
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    pytest.importorskip("rtree", reason="rtree, which trimesh's rays need, is not installed")
    intersector: Any = pytest.importorskip("trimesh.ray.ray_triangle").RayMeshIntersector
    mesh = trimesh.Trimesh(*pyramid(7), process=False)
    theirs = intersector(mesh)
    ours = octray.Scene()
    ours.add_mesh(mesh, solid=True)
    origins, directions = some_rays(300)
    for name in ("intersects_id", "intersects_location", "intersects_first", "intersects_any"):
        expected = getattr(theirs, name)(origins, directions)
        found = getattr(ours.ray, name)(origins, directions)
        if not isinstance(expected, tuple):
            np.testing.assert_array_equal(found, expected)
            assert found.dtype == expected.dtype
            continue
        assert len(found) == len(expected)
        # Theirs come in no particular order.
        ray, triangle = (1, 2) if name == "intersects_location" else (1, 0)
        order = np.lexsort((expected[triangle], expected[ray]))
        own = np.lexsort((found[triangle], found[ray]))
        for mine, other in zip(found, expected, strict=True):
            assert mine.dtype == other.dtype
            np.testing.assert_allclose(mine[own], other[order], atol=1e-9)
    points = np.random.default_rng(2).uniform(-1.2, 1.2, (200, 3))
    np.testing.assert_array_equal(ours.ray.contains_points(points), theirs.contains_points(points))
    for name, method in inspect.getmembers(RayIntersector, inspect.isfunction):
        if not name.startswith("_"):
            assert (
                list(inspect.signature(method).parameters)[:3]
                == list(inspect.signature(getattr(intersector, name)).parameters)[:3]
            )
