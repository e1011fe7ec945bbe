"""Every interval of every ray, against formulas, membership of points, and itself."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import octray

if TYPE_CHECKING:
    import numpy.typing as npt

    from octray._options import Accel, Overlaps

    _Floats = npt.NDArray[np.float64]

ARRAYS = (
    "offsets",
    "ray_id",
    "t_enter",
    "t_exit",
    "lengths",
    "object_id",
    "material_id",
    "face_enter",
    "face_exit",
    "normal_enter",
    "normal_exit",
)


def same(one: octray.Intersections, other: octray.Intersections) -> bool:
    return all(
        np.asarray(getattr(one, name)).tobytes() == np.asarray(getattr(other, name)).tobytes()
        for name in ARRAYS
    )


def mixed_scene() -> octray.Scene:
    """Overlapping solids of two materials and priorities, a sheet and a floor."""
    scene = octray.Scene()
    scene.add(octray.box(4) - octray.cylinder(1, 9), name="block", material="#aaaaaa")
    scene.add(octray.sphere(2).translate(x=2), name="ball", material="#0000ff")
    scene.add(octray.sphere(1).translate(x=-2), name="first", priority=1)
    scene.add_mesh(([[-5, -5, 6], [5, -5, 6], [0, 5, 7]], [[0, 1, 2]]), name="roof")
    scene.add(octray.half_space((0, 0, 1), -3), name="floor")
    return scene


def random_rays(*shape: int, seed: int = 5) -> _Floats:
    rng = np.random.default_rng(seed)
    return np.concatenate([rng.uniform(-7, 7, (*shape, 3)), rng.normal(size=(*shape, 3))], axis=-1)


def test_a_ball_has_the_chords_of_the_formula() -> None:
    scene = octray.Scene()
    scene.add(octray.sphere(2).translate(x=1, y=-2, z=0.5))
    rays = random_rays(4000)
    found = scene.list_intersections(rays, whole_line=True)
    to_centre = np.array([1, -2, 0.5]) - rays[:, :3]
    d = rays[:, 3:]
    squared = (d * d).sum(axis=1)
    nearest = (to_centre * d).sum(axis=1) / squared
    rest = to_centre - nearest[:, None] * d
    half = 4 - (rest * rest).sum(axis=1)
    met = half > 0
    np.testing.assert_array_equal(found.counts, met)
    half = np.sqrt(half[met] / squared[met])
    np.testing.assert_allclose(found.t_enter, nearest[met] - half, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found.t_exit, nearest[met] + half, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found.lengths, 2 * half * np.sqrt(squared[met]), rtol=1e-9)
    points = rays[met, :3] + found.t_exit[:, None] * d[met]
    np.testing.assert_allclose(found.normal_exit, (points - [1, -2, 0.5]) / 2, atol=1e-12)
    assert found.ray_id.tolist() == np.flatnonzero(met).tolist()


def test_a_bored_block_seen_from_the_side_has_two_intervals() -> None:
    scene = octray.Scene()
    scene.add(octray.box(4) - octray.cylinder(1, 9))
    y = np.linspace(-0.9, 0.9, 7)
    rays = np.zeros((7, 6))
    rays[:, 0], rays[:, 1], rays[:, 3] = -10, y, 2
    found = scene.list_intersections(rays)
    hole = np.sqrt(1 - y * y)
    assert found.offsets.tolist() == list(range(0, 15, 2))
    np.testing.assert_allclose(found.t_enter.reshape(7, 2), np.c_[0 * y + 4, 5 + hole / 2])
    np.testing.assert_allclose(found.t_exit.reshape(7, 2), np.c_[5 - hole / 2, 0 * y + 6])
    np.testing.assert_allclose(found.path_lengths()[:, 0], 4 - 2 * hole, rtol=1e-12)
    # The wall of the hole looks to its axis.
    walls = found.normal_exit[::2]
    np.testing.assert_allclose(walls, np.c_[hole, -y, 0 * y], atol=1e-12)
    np.testing.assert_array_equal(found.normal_enter[::2], np.tile([-1.0, 0, 0], (7, 1)))


def test_what_begins_or_ends_nowhere_has_no_face_and_no_normal() -> None:
    scene = octray.Scene()
    scene.add(octray.half_space((0, 0, 1), 0))
    down = [0.0, 0, 3, 0, 0, -2]
    found = scene.list_intersections(down)
    assert (found.t_enter.tolist(), found.t_exit.tolist()) == ([1.5], [math.inf])
    assert (found.face_enter.tolist(), found.face_exit.tolist()) == ([0], [-1])
    np.testing.assert_array_equal(found.normal_enter, [[0, 0, 1]])
    assert np.isnan(found.normal_exit).all()
    assert found.lengths.tolist() == [math.inf]
    up = [0.0, 0, -3, 0, 0, 2]
    inside = scene.list_intersections(up)
    assert (inside.t_enter.tolist(), inside.face_enter.tolist()) == ([0], [-1])
    assert inside.lengths.tolist() == [3]
    whole = scene.list_intersections(up, whole_line=True)
    assert (whole.t_enter.tolist(), whole.t_exit.tolist()) == ([-math.inf], [1.5])


def test_who_counts_where_solids_overlap() -> None:
    scene = octray.Scene()
    scene.add(octray.sphere(3), name="large")
    scene.add(octray.sphere(1), name="small")
    ray = [-10.0, 0, 0, 1, 0, 0]

    def found(overlaps: Overlaps) -> list[tuple[int, float, float]]:
        found = scene.list_intersections(ray, overlaps=overlaps)
        columns = (found.object_id, found.t_enter, found.t_exit)
        return list(zip(*(column.tolist() for column in columns), strict=True))

    assert found("regions") == [(0, 7, 9), (1, 9, 11), (0, 11, 13)]
    assert found("priorities") == found("objects") == [(0, 7, 13), (1, 9, 11)]
    scene.add(octray.sphere(2), priority=1)
    assert found("regions") == found("priorities") == [(0, 7, 8), (2, 8, 12), (0, 12, 13)]
    assert found("objects") == [(0, 7, 13), (2, 8, 12), (1, 9, 11)]
    with pytest.raises(ValueError, match='"regions", "priorities" or "objects", not "all"'):
        scene.list_intersections(ray, overlaps="all")  # type: ignore[arg-type]


@pytest.mark.parametrize("whole_line", [False, True])
def test_points_are_inside_exactly_where_the_intervals_are(whole_line: bool) -> None:
    scene = mixed_scene()
    rays = random_rays(300)
    found = scene.list_intersections(rays, whole_line=whole_line)
    t = np.linspace(-6, 6, 61) + 0.0123
    points = rays[:, None, :3] + t[:, None] * rays[:, None, 3:]
    region = scene.locate(points)
    np.testing.assert_array_equal(scene.compute_occupancy(points), region >= 0)
    expected = np.full((300, 61), -1)
    near = np.zeros((300, 61), dtype=bool)
    columns = (found.ray_id, found.t_enter, found.t_exit, found.object_id)
    for ray, enter, leave, owner in zip(*columns, strict=True):
        expected[ray, (enter < t) & (t < leave)] = owner
        near[ray] |= (abs(t - enter) < 1e-9) | (abs(t - leave) < 1e-9)
    counts = near | (t <= 0) & (not whole_line)
    assert counts.mean() < 0.6
    np.testing.assert_array_equal(expected[~counts], region[~counts])
    assert set(np.unique(region)) == {-1, 0, 1, 2, 4}


def test_every_method_gives_the_same_bits() -> None:
    scene = mixed_scene()
    rays = random_rays(5000)
    overlaps: Overlaps
    for whole_line, overlaps in ((False, "regions"), (True, "objects")):
        options: dict[str, Any] = {"whole_line": whole_line, "overlaps": overlaps}
        one = scene.list_intersections(rays, accel="brute", threads=1, **options)
        assert len(one.t_enter) > 3000
        methods: list[tuple[Accel, int]] = [("auto", 1), ("auto", 4), ("brute", 3)]
        for accel, threads in methods:
            other = scene.list_intersections(rays, accel=accel, threads=threads, **options)
            assert same(one, other)
        count = scene.count_intersections(rays, whole_line=True)
        brute = scene.count_intersections(rays, whole_line=True, accel="brute", threads=1)
        np.testing.assert_array_equal(count, brute)


def test_the_arrays_fit_together() -> None:
    scene = mixed_scene()
    rays = random_rays(40, 25)
    found = scene.list_intersections(rays)
    total = len(found.t_enter)
    assert len(found) == 1000
    assert found.counts.shape == (40, 25)
    assert (found.offsets[0], found.offsets[-1], len(found.offsets)) == (0, total, 1001)
    np.testing.assert_array_equal(np.diff(found.offsets), found.counts.ravel())
    np.testing.assert_array_equal(found.ray_id, np.repeat(np.arange(1000), np.diff(found.offsets)))
    for name in ARRAYS[1:]:
        array = getattr(found, name)
        assert array is getattr(found, name), "made once"
        assert array.shape == ((total, 3) if name.startswith("normal") else (total,))
        whole = name.endswith("_id") or name.startswith("face")
        assert array.dtype == (np.int64 if whole else np.float64)
    assert found.offsets.dtype == found.counts.dtype == np.int64
    assert (found.t_enter < found.t_exit).all()
    ends = np.r_[found.t_exit[:-1] <= found.t_enter[1:], True]
    assert ends[np.r_[np.diff(found.ray_id) == 0, False]].all(), "regions never overlap"
    material = {name: i for i, name in enumerate(scene.material_names)}
    assert len(material) >= 2
    for i, name in enumerate(scene.names):
        assert len(np.unique(found.material_id[found.object_id == i])) <= 1, name
    lengths = np.linalg.norm(rays.reshape(-1, 6)[found.ray_id, 3:], axis=1)
    np.testing.assert_allclose(found.lengths, (found.t_exit - found.t_enter) * lengths)
    for name in ("enter", "exit"):
        normals = getattr(found, f"normal_{name}")
        none = getattr(found, f"face_{name}") == -1
        np.testing.assert_array_equal(np.isnan(normals).all(axis=1), none)
        np.testing.assert_allclose(np.linalg.norm(normals[~none], axis=1), 1)
        along = (normals * rays.reshape(-1, 6)[found.ray_id, 3:]).sum(axis=1)[~none]
        assert (along < 0).all() if name == "enter" else (along > 0).all()


def test_path_lengths_sum_the_intervals() -> None:
    scene = mixed_scene()
    rays = random_rays(20, 30)
    found = scene.list_intersections(rays)
    for by, ids, names in (
        ("object", found.object_id, scene.names),
        ("material", found.material_id, scene.material_names),
    ):
        sums = found.path_lengths(by)  # type: ignore[arg-type]
        assert sums.shape == (20, 30, len(names))
        expected = np.zeros((600, len(names)))
        np.add.at(expected, (found.ray_id, ids), found.lengths)
        np.testing.assert_array_equal(sums.reshape(600, -1), expected)
    with pytest.raises(ValueError, match='"object" or "material", not "face"'):
        found.path_lengths("face")  # type: ignore[arg-type]


def test_rays_can_be_taken_out_one_by_one() -> None:
    scene = mixed_scene()
    rays = random_rays(50)
    found = scene.list_intersections(rays)
    for i, one in enumerate(found):
        assert len(one) == 1
        assert same(one, scene.list_intersections(rays[i : i + 1]))
    assert same(found[-1], found[49])
    assert same(found[10:30:3], scene.list_intersections(rays[10:30:3]))
    assert same(found[::-1], scene.list_intersections(rays[::-1]))
    for bad in (50, -51):
        with pytest.raises(IndexError, match=f"no ray {bad} among 50"):
            found[bad]
    with pytest.raises(TypeError, match="integer"):
        found["a"]  # type: ignore[index]
    assert repr(found[:0]) == "<octray.Intersections 0 intervals of 0 rays>"


def test_chunks_are_the_whole() -> None:
    scene = mixed_scene()
    rays = random_rays(1000)
    whole = scene.list_intersections(rays, whole_line=True, overlaps="objects")

    def together(parts: list[octray.Intersections]) -> dict[str, _Floats]:
        return {n: np.concatenate([getattr(p, n) for p in parts]) for n in ("t_enter", "t_exit")}

    sources: list[Any] = [rays, rays.astype(object).astype(float), iter([rays[:700], rays[700:]])]
    sources.append(part for part in np.split(rays, 10))
    for source in sources:
        parts = list(
            scene.iter_intersections(source, chunk=300, whole_line=True, overlaps="objects")
        )
        assert max(map(len, parts)) <= 300
        assert sum(map(len, parts)) == 1000
        for name, array in together(parts).items():
            np.testing.assert_array_equal(array, getattr(whole, name))
    assert list(scene.iter_intersections(np.empty((0, 6)))) == []
    with pytest.raises(ValueError, match="chunk must be at least 1, not 0"):
        scene.iter_intersections(rays, chunk=0)
    with pytest.raises(ValueError, match=r"shape \(N, 6\), not shape \(20, 50, 6\)"):
        scene.iter_intersections(rays.reshape(20, 50, 6))
    with pytest.raises(ValueError, match="not dtype complex128"):
        scene.iter_intersections(rays.astype(complex))
    with pytest.raises(ValueError, match="overlaps must be"):
        scene.iter_intersections(rays, overlaps="none")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"not shape \(5,\)"):
        list(scene.iter_intersections(iter([np.zeros(5)])))


def test_a_memory_mapped_file_is_read_in_pieces(tmp_path: Any) -> None:
    scene = mixed_scene()
    rays = random_rays(5000)
    np.save(tmp_path / "rays.npy", rays)
    mapped = np.load(tmp_path / "rays.npy", mmap_mode="r")
    found = sum(
        part.lengths[np.isfinite(part.lengths)].sum()
        for part in scene.iter_intersections(mapped, chunk=999)
    )
    whole = scene.list_intersections(rays).lengths
    assert found == pytest.approx(whole[np.isfinite(whole)].sum(), rel=1e-12)


def test_rays_that_are_none_have_no_intervals_and_are_counted() -> None:
    rays = np.tile([0.0, 0, 20, 0, 0, -1], (10, 1))
    for i in range(6):
        rays[i, i] = math.nan
    rays[6, 3:] = 0
    rays[7, 0] = math.inf
    rays[8, 4] = -math.inf
    scene = mixed_scene()
    found = scene.list_intersections(rays, whole_line=True)
    assert found.counts.tolist() == [0] * 9 + [found.counts[9]]
    assert found.counts[9] == 1
    assert found.invalid_rays == scene.cast_rays(rays).invalid_rays == 9
    assert found[8].invalid_rays == 1
    assert found[9].invalid_rays == 0
    assert (found.path_lengths()[:9] == 0).all()
    points = [[math.nan, 0.0, -9.0], [0.0, 0.0, math.inf], [0.0, 0.0, -9.0]]
    assert scene.locate(points).tolist() == [-1, -1, 4]


@pytest.mark.parametrize(
    ("rays", "message"),
    [
        (np.zeros((3, 5)), r"shape \(\.\.\., 6\), not shape \(3, 5\)"),
        (np.float64(0), r"not shape \(\)"),
        (np.zeros((2, 6), dtype=complex), "not dtype complex128"),
        (np.full((2, 6), "1"), "not dtype <U1"),
        (np.full((2, 6), None), "not dtype object"),
    ],
)
def test_wrong_arrays_are_refused_by_naming_the_right_shape(rays: Any, message: str) -> None:
    scene = mixed_scene()
    with pytest.raises(ValueError, match=message):
        scene.list_intersections(rays)
    for ask in (scene.locate, scene.compute_occupancy):
        with pytest.raises(ValueError, match=message.replace("6", "3").replace("5", "5")):
            ask(rays[..., :5] if rays.shape == (3, 5) else rays)


def test_touching_solids_count_twice_and_whole_lines_cross_an_even_number() -> None:
    scene = octray.Scene()
    scene.add(octray.box(2))
    scene.add(octray.box(2).translate(x=2))
    assert scene.count_intersections([-9.0, 0.1, 0.2, 1, 0, 0]).item() == 4
    scene.add(octray.torus(4, 1))
    scene.add(octray.sphere(3) - octray.box(3).rotate(x=30, y=40))
    rays = random_rays(20000)
    counts = scene.count_intersections(rays, whole_line=True)
    assert (counts % 2 == 0).all()
    assert counts.max() >= 8
    behind = rays * [1, 1, 1, -1, -1, -1]
    np.testing.assert_array_equal(
        counts, scene.count_intersections(rays) + scene.count_intersections(behind)
    )


_NUMBER = st.floats(-3, 3, allow_nan=False, width=32)
_VECTOR = st.tuples(_NUMBER, _NUMBER, _NUMBER)


@settings(max_examples=60, deadline=None)
@given(
    balls=st.lists(st.tuples(_VECTOR, st.floats(0.25, 2)), min_size=1, max_size=4),
    origin=_VECTOR,
    direction=_VECTOR,
)
def test_single_balls_have_their_own_chords(
    balls: list[tuple[tuple[float, float, float], float]],
    origin: tuple[float, float, float],
    direction: tuple[float, float, float],
) -> None:
    scene = octray.Scene()
    for centre, radius in balls:
        scene.add(octray.sphere(radius).translate(*centre))
    ray = np.array([*origin, *direction])
    found = scene.list_intersections(ray, overlaps="objects", whole_line=True)
    squared = float(ray[3:] @ ray[3:])
    expected = np.zeros(len(balls))
    sure = np.ones(len(balls), dtype=bool)
    for i, (centre, radius) in enumerate(balls):
        to = np.array(centre) - ray[:3]
        if squared > 0:
            rest = to - (to @ ray[3:] / squared) * ray[3:]
            under = radius**2 - rest @ rest
            expected[i] = 2 * math.sqrt(max(under, 0))
            sure[i] = abs(under) > 1e-6
    np.testing.assert_allclose(found.path_lengths()[sure], expected[sure], rtol=1e-6, atol=1e-9)
    # The other way round it is the same line.
    back = scene.list_intersections(np.r_[ray[:3], -ray[3:]], overlaps="objects", whole_line=True)
    np.testing.assert_allclose(
        found.path_lengths()[sure], back.path_lengths()[sure], rtol=1e-9, atol=1e-9
    )


def test_open3d_users_find_their_keys() -> None:
    scene = mixed_scene()
    rays = random_rays(60, 50)
    hits = scene.cast_rays(rays)
    found = hits.to_open3d()
    assert set(found) == {"t_hit", "geometry_ids", "primitive_ids", "primitive_normals"}
    none = np.iinfo(np.uint32).max
    missed = ~hits.hit
    assert 0 < missed.mean() < 1
    np.testing.assert_array_equal(found["t_hit"], hits.t)
    assert found["geometry_ids"].dtype == found["primitive_ids"].dtype == np.uint32
    assert (found["geometry_ids"][missed] == none).all()
    assert (found["primitive_ids"][missed] == none).all()
    np.testing.assert_array_equal(found["geometry_ids"][~missed], hits.object_id[~missed])
    np.testing.assert_array_equal(found["primitive_normals"][~missed], hits.normal[~missed])
    assert (found["primitive_normals"][missed] == 0).all()
    # A block of six sides and a hole, balls of one side, a triangle, a floor.
    for geometry, most in enumerate((8, 0, 0, 0, 0)):
        own = found["primitive_ids"][found["geometry_ids"] == geometry]
        assert own.max() <= most
        assert own.min() == 0 or geometry == 0
