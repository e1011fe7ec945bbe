"""The lab's scenes: counts against closed formulas, the same files every time, pictures of all."""

from __future__ import annotations

import io
import itertools
from typing import TYPE_CHECKING

import numpy as np
import pytest

import octray
from octray.bench.shapes import HALF, holes, sphere_flake
from scenes import drilled, gears, mount, rings, scan, stadium, tetra, tree
from scenes.families import FAMILIES, generate, level_near, size

if TYPE_CHECKING:
    from pathlib import Path


def written(name: str, level: int) -> str:
    file = io.StringIO()
    FAMILIES[name].write(level, file)
    return file.getvalue()


def entities(text: str) -> dict[str, int]:
    """How often each of NFF's shapes begins a line."""
    first = [line.split()[0] for line in text.splitlines()]
    return {word: first.count(word) for word in ("s", "c", "p")}


@pytest.mark.parametrize("level", [0, 1, 2, 3])
def test_nff_scenes_have_as_many_shapes_as_their_formulas_say(level: int) -> None:
    flake = (9 ** (level + 1) - 1) // 8
    assert entities(written("balls", level)) == {"s": flake, "c": 0, "p": 1}
    assert entities(written("mount", level)) == {"s": 4, "c": 0, "p": 2 * 4**level}
    clusters = sum(k * k for k in range(1, level + 2))
    assert entities(written("rings", level)) == {"s": 30 * clusters, "c": 30 * clusters, "p": 1}
    assert entities(written("tetra", level)) == {"s": 0, "c": 0, "p": 4 * 4**level}
    branches = sum(2**k for k in range(level + 1))
    assert entities(written("tree", level)) == {"s": branches, "c": branches, "p": 1}


@pytest.mark.parametrize("level", [0, 1, 2])
def test_pov_scenes_have_as_many_shapes_as_their_formulas_say(level: int) -> None:
    assert written("gears", level).count("object { Wheel") == (level + 1) ** 3
    assert gears.count(level)["faces of prisms"] == 146 * (level + 1) ** 3
    assert len(gears.outline()) == 144
    assert written("drilled", level).count("cylinder {") == drilled.SIDES[level] ** 2
    half = 5 * 10**level
    text = written("stadium", level)
    assert text.count("material { Gold }") == half
    assert text.count("material { Red }") + text.count("material { Blue }") == half


@pytest.mark.parametrize("name", FAMILIES)
def test_every_count_is_what_is_said(name: str) -> None:
    for level in range(5):
        assert size(name, level) == sum(FAMILIES[name].count(level).values())
        assert size(name, level) < size(name, level + 1)
    for shapes in (100, 1_000, 10_000, 100_000, 1_000_000):
        found = size(name, level_near(name, shapes))
        assert shapes / 3 < found < 3 * shapes
    with pytest.raises(ValueError, match="at most 2,000,000"):
        level_near(name, 10**9)


def test_the_published_sizes_are_among_them() -> None:
    # Haines' table of the databases at their default sizes, with floors and walls.
    assert size("balls", 4) == 7382
    assert size("gears", 3) == 9345
    assert size("mount", 6) == 8196
    assert size("rings", 6) == 8401
    assert size("tetra", 5) == 4096
    assert size("tree", 11) == 8191


@pytest.mark.parametrize("name", ["balls", "gears", "mount", "rings", "tetra", "tree"])
def test_the_originals_have_as_many_shapes(name: str, corpus: Path) -> None:
    path = corpus / "spd" / f"{name}_s2.nff"
    theirs = sum(entities(path.read_text(encoding="ascii")).values())
    level = {"balls": 2, "gears": 1, "mount": 2, "rings": 1, "tetra": 1, "tree": 2}[name]
    assert size(name, level) == theirs


@pytest.mark.parametrize("name", FAMILIES)
def test_a_scene_is_the_same_file_every_time_and_renders_without_a_word(
    name: str, tmp_path: Path
) -> None:
    first, again = (generate(name, 100, folder) for folder in _folders(tmp_path))
    assert first.path.read_bytes() == again.path.read_bytes()
    scene = octray.load(first.path)
    assert scene.diagnostics == []
    pixels = scene.render(size=(32, 24)).to_numpy()
    assert np.isfinite(pixels).all()
    # Something is to be seen, and it is not one colour.
    assert len(np.unique(pixels.reshape(-1, 3).round(3), axis=0)) > 20


def _folders(tmp_path: Path) -> list[Path]:
    folders = [tmp_path / "first", tmp_path / "again"]
    for folder in folders:
        folder.mkdir()
    return folders


def test_every_ball_touches_its_parent() -> None:
    generations = sphere_flake(3)
    for (parents, large), (children, small) in itertools.pairwise(generations):
        away = np.linalg.norm(children.reshape(len(parents), 9, 3) - parents[:, None], axis=2)
        np.testing.assert_allclose(away, large + small, rtol=1e-12)
    # Nine children at least one radius apart from each other: they touch, and do not overlap.
    nine = generations[1][0]
    apart = [np.linalg.norm(a - b) for a, b in itertools.combinations(nine, 2)]
    assert min(apart) > 2 * generations[1][1]


def test_the_balls_stand_where_the_originals_do(corpus: Path) -> None:
    lines = (corpus / "spd" / "balls_s2.nff").read_text(encoding="ascii").splitlines()
    theirs = np.array([line.split()[1:4] for line in lines if line.startswith("s ")], dtype=float)
    ours = np.vstack([centers for centers, _ in sphere_flake(1)])
    nearest = np.linalg.norm(theirs[:, None] - ours, axis=2).min(axis=0)
    assert nearest.max() < 1e-5


def test_the_rings_are_pentagons_with_thirty_joints_and_edges_of_one_length() -> None:
    pentagons = rings.pentagons()
    assert pentagons.shape == (6, 5, 3)
    np.testing.assert_allclose(np.linalg.norm(pentagons, axis=2), 1, rtol=1e-12)
    edges = np.linalg.norm(np.roll(pentagons, -1, axis=1) - pentagons, axis=2)
    np.testing.assert_allclose(edges, 2 * np.sin(np.pi / 5), rtol=1e-12)
    np.testing.assert_allclose(pentagons.sum(axis=1), 0, atol=1e-12)


def test_the_tetrahedra_meet_in_corners_and_halve_their_area_every_time() -> None:
    for level in range(4):
        triangles = tetra.triangles(level)
        sides = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        area = np.linalg.norm(sides, axis=1).sum() / 2
        # Four times as many of half the size: the area stays.
        assert area == pytest.approx(8 * np.sqrt(3))
        corners = np.unique(triangles.reshape(-1, 3).round(9), axis=0)
        assert len(corners) == 2 * 4**level + 2


def test_the_mountain_keeps_its_points_as_it_gets_finer() -> None:
    coarse, fine = mount.heights(4), mount.heights(6)
    np.testing.assert_array_equal(fine[::4, ::4], coarse)
    assert np.ptp(fine) > 0.3
    assert mount.balls()[:, 2].min() - mount.BALL > fine[:16, -16:].max() * 0.5


def test_wheels_that_mesh_do_not_meet() -> None:
    scene = octray.Scene()
    pitch = 180 / gears.TEETH
    profile = gears.outline()
    scene.add(octray.prism(profile, 1))
    scene.add(octray.prism(profile, 1).rotate(z=pitch).translate(x=1))
    rng = np.random.default_rng(3)
    start = np.column_stack([rng.uniform(0.4, 0.6, 4000), rng.uniform(-0.3, 0.3, 4000)])
    rays = np.hstack([start, np.full((4000, 1), -2.0), np.tile([0.0, 0.0, 1.0], (4000, 1))])
    found = scene.list_intersections(rays, overlaps="objects")
    assert (found.counts <= 1).all()
    assert {0, 1} == set(found.object_id.tolist())


def test_no_hole_meets_another() -> None:
    for level in range(1, 5):
        side = drilled.SIDES[level]
        x, y, radius = holes(side).reshape(side, side, 3).transpose(2, 0, 1)
        assert (np.diff(x, axis=1) > radius[:, 1:] + radius[:, :-1]).all()
        assert (np.diff(y, axis=0) > radius[1:] + radius[:-1]).all()
        assert (np.abs(x) + radius < HALF).all()


def test_the_stadium_is_a_thousand_times_its_teapot() -> None:
    places = stadium.beads(500)
    across = np.hypot(places[:, 0], places[:, 1])
    assert 0.35 < across.min() < across.max() < 0.75
    assert 700 < stadium.INNER / across.max() < 1500


def test_branches_start_where_their_parents_end() -> None:
    generations = tree.branches(4)
    for (_, tips, _, thin), (feet, _, thick, _) in itertools.pairwise(generations):
        np.testing.assert_array_equal(np.repeat(tips, 2, axis=0), feet)
        assert thin == thick
    lengths = [np.linalg.norm(tip - base, axis=1).sum() for base, tip, _, _ in generations]
    np.testing.assert_allclose(np.diff(np.log(lengths)), np.log(0.65 + 0.7), rtol=1e-9)


def test_a_scan_is_named_by_its_entry_or_said_to_be_absent(
    corpus: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("OCTRAY_CORPUS", str(tmp_path))
    absent = scan.find()
    assert isinstance(absent, str)
    assert scan.ENTRY in absent
    monkeypatch.setenv("OCTRAY_CORPUS", str(corpus))
    found = scan.find()
    assert isinstance(found, scan.Scan)
    assert found.entry in (corpus / "MANIFEST.tsv").read_text(encoding="utf-8")
    assert found.triangles == 86482
