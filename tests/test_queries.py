"""Arrays of rays: shapes, kinds, misses, and the same answers by every method."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import octray

if TYPE_CHECKING:
    import numpy.typing as npt


def sample_scene() -> octray.Scene:
    """A solid, an overlapping one, a sheet and an unbounded floor."""
    scene = octray.Scene()
    scene.add(octray.box(4) - octray.cylinder(1, 9) + octray.sphere(1).translate(z=3), name="part")
    scene.add(octray.cone(2, 0, 3).translate(x=3), name="hat")
    scene.add_mesh(([[-5, -5, 6], [5, -5, 6], [0, 5, 7]], [[0, 1, 2]]), name="roof")
    scene.add(octray.half_space((0, 0, 1), -3), name="floor")
    return scene


def random_rays(*shape: int) -> npt.NDArray[np.float64]:
    rng = np.random.default_rng(7)
    origins = rng.uniform(-8, 8, (*shape, 3))
    return np.concatenate([origins, rng.normal(size=(*shape, 3))], axis=-1)


def test_results_keep_the_leading_axes_and_have_their_kinds() -> None:
    scene = sample_scene()
    for shape in [(), (5,), (2, 3), (4, 1, 2), (0,), (2, 0)]:
        rays = random_rays(*shape)
        hits = scene.cast_rays(rays)
        assert hits.t.shape == hits.object_id.shape == hits.face_id.shape == shape
        assert hits.normal.shape == hits.position.shape == (*shape, 3)
        assert hits.t.dtype == hits.normal.dtype == hits.position.dtype == np.float64
        assert hits.object_id.dtype == hits.face_id.dtype == np.int64
        assert len(hits) == math.prod(shape)
        counts = scene.count_intersections(rays)
        assert (counts.shape, counts.dtype) == (shape, np.dtype(np.int64))
        blocked = scene.test_occlusions(rays)
        assert (blocked.shape, blocked.dtype) == (shape, np.dtype(np.bool_))


def test_many_rays_get_the_answers_of_few() -> None:
    scene = sample_scene()
    rays = random_rays(40_000).astype(np.float32)
    few = [rays[start : start + 1000] for start in range(0, len(rays), 1000)]
    for threads in (1, 3):
        many = scene.cast_rays(rays, threads=threads)
        for name in ("t", "object_id", "face_id", "hit", "normal", "position"):
            parts = [getattr(scene.cast_rays(part), name) for part in few]
            np.testing.assert_array_equal(getattr(many, name), np.concatenate(parts))
        parts = [scene.cast_rays(part).to_open3d() for part in few]
        for key, answers in many.to_open3d().items():
            np.testing.assert_array_equal(answers, np.concatenate([part[key] for part in parts]))
        met = scene.test_occlusions(rays, threads=threads)
        np.testing.assert_array_equal(met, many.hit)


def test_float32_and_lists_and_other_memory_orders_are_accepted() -> None:
    scene = sample_scene()
    rays = random_rays(40).astype(np.float32)
    expected = scene.cast_rays(rays.astype(np.float64)).t
    for same in (rays, rays.tolist(), np.asfortranarray(rays), rays[::-1][::-1]):
        np.testing.assert_array_equal(scene.cast_rays(same).t, expected)
    np.testing.assert_array_equal(
        scene.cast_rays([[0, 0, 20, 0, 0, -1]]).t, scene.cast_rays([[0.0, 0, 20, 0, 0, -1]]).t
    )


@pytest.mark.parametrize(
    ("rays", "message"),
    [
        (np.zeros((3, 5)), r"shape \(\.\.\., 6\), not shape \(3, 5\)"),
        (np.zeros(3), r"not shape \(3,\)"),
        (np.zeros(()), r"not shape \(\)"),
        (np.zeros((2, 6), dtype=complex), "not dtype complex128"),
        (np.zeros((2, 6), dtype=bool), "not dtype bool"),
        ("rays", "not dtype <U4"),
        ([[1, 2], [3]], "ragged"),
        (None, "not dtype object"),
    ],
)
def test_wrong_arrays_are_refused_by_naming_the_right_shape(rays: Any, message: str) -> None:
    scene = sample_scene()
    for ask in (scene.cast_rays, scene.count_intersections, scene.test_occlusions):
        with pytest.raises(ValueError, match=message):
            ask(rays)


def test_rays_that_are_none_miss() -> None:
    rays = np.tile([0.0, 0, 20, 0, 0, -1], (8, 1))
    for i in range(6):
        rays[i, i] = math.nan
    rays[6, 3:] = 0
    rays[7, 0] = math.inf
    scene = sample_scene()
    hits = scene.cast_rays(rays)
    assert np.isposinf(hits.t).all()
    assert (hits.object_id == -1).all()
    assert (hits.face_id == -1).all()
    assert not hits.hit.any()
    assert np.isnan(hits.position).all()
    assert (scene.count_intersections(rays) == 0).all()
    assert not scene.test_occlusions(rays).any()


def test_every_method_gives_the_same_bits() -> None:
    scene = sample_scene()
    # More than one slice of rays, so that several threads take part.
    rays = random_rays(3000)
    one = scene.cast_rays(rays, accel="brute", threads=1)
    for accel, threads in (("auto", 1), ("auto", 4), ("brute", 3)):
        other = scene.cast_rays(rays, accel=accel, threads=threads)
        for name in ("t", "object_id", "face_id", "normal", "position"):
            assert getattr(one, name).tobytes() == getattr(other, name).tobytes(), name
    assert 0.2 < one.hit.mean() < 1
    assert set(np.unique(one.object_id)) == {-1, 0, 1, 2, 3}


def test_hits_lie_on_the_ray_and_normals_have_length_one() -> None:
    rays = random_rays(500)
    hits = sample_scene().cast_rays(rays)
    met = hits.hit
    np.testing.assert_allclose(
        hits.position[met], rays[met, :3] + hits.t[met, None] * rays[met, 3:], rtol=1e-12
    )
    np.testing.assert_allclose(np.linalg.norm(hits.normal[met], axis=-1), 1, rtol=1e-12)
    floor = hits.object_id == 3
    assert floor.any()
    np.testing.assert_array_equal(hits.normal[floor], np.tile([0.0, 0, 1], (floor.sum(), 1)))
    np.testing.assert_allclose(hits.position[floor, 2], -3, atol=1e-9)


def test_occlusion_is_having_a_hit_nearer_than_tfar() -> None:
    rays = random_rays(800)
    scene = sample_scene()
    t = scene.cast_rays(rays).t
    np.testing.assert_array_equal(scene.test_occlusions(rays), np.isfinite(t))
    np.testing.assert_array_equal(scene.test_occlusions(rays, tfar=3.0), t < 3.0)
    with pytest.raises(ValueError, match="tfar"):
        scene.test_occlusions(rays, tfar=math.nan)


def test_a_ray_from_inside_leaves_once_and_one_from_outside_twice() -> None:
    scene = octray.Scene()
    scene.add(octray.sphere(2))
    rng = np.random.default_rng(3)
    directions = rng.normal(size=(200, 3))
    inside = np.concatenate([np.zeros((200, 3)), directions], axis=1)
    assert (scene.count_intersections(inside) == 1).all()
    outside = np.concatenate([directions * 10, -directions], axis=1)
    assert (scene.count_intersections(outside) == 2).all()
    chord = scene.cast_rays(inside).t * np.linalg.norm(directions, axis=1)
    np.testing.assert_allclose(chord, 2, rtol=1e-12)


def test_the_scene_may_change_between_questions() -> None:
    scene = octray.Scene()
    ray = [0.0, 0, 10, 0, 0, -1]
    assert float(scene.cast_rays(ray).t) == math.inf
    scene.add(octray.sphere(1))
    assert float(scene.cast_rays(ray).t) == 9
    before = scene.cast_rays(ray)
    scene.add(octray.sphere(1).translate(z=4))
    assert float(scene.cast_rays(ray).t) == 5
    assert before.position.tolist() == [0, 0, 1]


def test_wrong_methods_are_named() -> None:
    scene = sample_scene()
    with pytest.raises(ValueError, match="fast"):
        scene.cast_rays(random_rays(1), accel="fast")
    with pytest.raises(ValueError, match="threads must be 1 to 1024, not 0"):
        scene.cast_rays(random_rays(1), threads=0)
