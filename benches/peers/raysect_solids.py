"""raysect: every crossing of a CSG primitive, by ``hit`` and ``next_intersection``."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from rays import (
    BORE,
    along_the_bore,
    between_grid_points,
    expect_bored_cube,
    expect_cells,
    expect_cube,
    menger_cells,
    menger_cutters,
    rotated,
    through_a_cube,
    through_a_grid,
    without_slivers,
)
from report import Row, share

import octray

if TYPE_CHECKING:
    from collections.abc import Iterator

#: Turns by these angles in degrees, one axis after the other: no face stays aligned.
ANGLES = (31.0, 17.0, 53.0)
#: A line has no more crossings than this; a primitive that goes on is stuck.
ENDLESS = 10_000


def crossings(primitive: Any, rays: np.ndarray) -> np.ndarray:
    """How often each ray meets the primitive's boundary."""
    from raysect.core import Point3D, Ray, Vector3D

    counts = np.zeros(len(rays), dtype=np.int64)
    for i, (ox, oy, oz, dx, dy, dz) in enumerate(rays.tolist()):
        hit = primitive.hit(Ray(Point3D(ox, oy, oz), Vector3D(dx, dy, dz).normalise()))
        while hit is not None and counts[i] < ENDLESS:
            counts[i] += 1
            hit = primitive.next_intersection()
    return counts


def distances(primitive: Any, rays: np.ndarray) -> list[list[float]]:
    """The parameters at which each ray meets the primitive's boundary, in order."""
    from raysect.core import Point3D, Ray, Vector3D

    found = []
    for ox, oy, oz, dx, dy, dz in rays.tolist():
        direction = Vector3D(dx, dy, dz)
        hit = primitive.hit(Ray(Point3D(ox, oy, oz), direction.normalise()))
        at: list[float] = []
        while hit is not None and len(at) < ENDLESS:
            at.append(hit.ray_distance / direction.length)
            hit = primitive.next_intersection()
        found.append(at)
    return found


def octray_distances(scene: octray.Scene, rays: np.ndarray) -> list[list[float]]:
    """The same for octray."""
    found = scene.list_intersections(rays)
    both = np.column_stack([found.t_enter, found.t_exit]).ravel().tolist()
    return [both[2 * a : 2 * b] for a, b in pairwise(found.offsets.tolist())]


def compare(rays_per_scene: int) -> Iterator[Row]:
    """Rows for raysect."""
    from raysect.core import AffineMatrix3D, Point3D, World, rotate_x, rotate_y, rotate_z, translate
    from raysect.primitive import Box, Cylinder, Intersect, Subtract, Torus, Union

    turn = rotate_z(ANGLES[2]) * rotate_y(ANGLES[1]) * rotate_x(ANGLES[0])
    matrix = np.array([[turn[i, j] for j in range(3)] for i in range(3)])

    def cube(low: tuple[float, ...] = (-1, -1, -1), high: tuple[float, ...] = (1, 1, 1)) -> Box:
        return Box(Point3D(*low), Point3D(*high))

    def bore() -> Cylinder:
        return Cylinder(BORE, 2.0, transform=translate(0, 0, -1))

    bored = octray.box(2) - octray.cylinder(r=BORE, h=2)
    halves = octray.box((1, 2, 2)).translate(x=-0.5) + octray.box((1, 2, 2)).translate(x=0.5)
    whole = octray.box(2)
    drill = octray.cylinder(r=BORE, h=2)
    split = (whole - drill) + (whole & drill)

    scenes = [
        (
            "cube minus cylinder of equal height",
            lambda at: Subtract(cube(), bore(), parent=World(), transform=at),
            bored,
            expect_bored_cube,
        ),
        (
            "two abutting boxes in a union",
            lambda at: Union(
                cube(high=(0, 1, 1)), cube(low=(0, -1, -1)), parent=World(), transform=at
            ),
            halves,
            expect_cube,
        ),
        (
            "(A - B) + (A & B), which is the cube A",
            lambda at: Union(
                Subtract(cube(), bore()), Intersect(cube(), bore()), parent=World(), transform=at
            ),
            split,
            expect_cube,
        ),
    ]
    for name, primitive, solid, expect in scenes:
        cases = [
            ("random rays", through_a_cube(rays_per_scene, 1), False),
            ("rays parallel to the bore", along_the_bore(rays_per_scene, 2), False),
            ("random rays, all turned", through_a_cube(rays_per_scene, 3), True),
        ]
        for which, rays, turned in cases:
            expected, sure = expect(rays)
            shot = rotated(rays, matrix) if turned else rays
            mine = solid.rotate(*ANGLES) if turned else solid
            scene = octray.Scene()
            scene.add(mine)
            theirs = crossings(primitive(turn if turned else AffineMatrix3D()), shot[sure])
            ours = scene.count_intersections(shot[sure])
            yield Row(
                name,
                f"wrong number of crossings, {which}",
                "raysect",
                share(np.count_nonzero(theirs != expected[sure]), len(theirs)),
                share(np.count_nonzero(ours != expected[sure]), len(ours)),
            )
    yield from menger(2, rays_per_scene // 10)
    yield from torus(rays_per_scene // 10, Torus)


def menger(level: int, count: int) -> Iterator[Row]:
    """A sponge cut by boxes that end in the cube's faces."""
    from raysect.core import Point3D, World
    from raysect.primitive import Box, Subtract, Union

    size = 3**level
    cutters = menger_cutters(level)
    boxes = [Box(Point3D(*low), Point3D(*high)) for low, high in cutters]
    while len(boxes) > 1:  # a balanced tree of unions
        pairs = [Union(a, b) for a, b in zip(boxes[::2], boxes[1::2], strict=False)]
        boxes = pairs + boxes[len(pairs) * 2 :]
    sponge = Subtract(Box(Point3D(0, 0, 0), Point3D(size, size, size)), boxes[0], parent=World())
    rays = through_a_grid(size, count, 4)
    expected, sure = expect_cells(rays, menger_cells(level))
    rays, expected = rays[sure], expected[sure]
    theirs = crossings(sponge, rays)
    scene = octray_sponge(level)
    ours = scene.count_intersections(rays)
    name = f"Menger sponge of level {level} cut by {len(cutters)} boxes"
    yield Row(
        name,
        "wrong number of crossings, random rays",
        "raysect",
        share(np.count_nonzero(theirs != expected), len(rays)),
        share(np.count_nonzero(ours != expected), len(rays)),
    )

    rays = between_grid_points(size, count, 5)
    expected, _ = expect_cells(rays, menger_cells(level))
    for what, of in (
        ("", len),
        (", what is shorter than 10^-9 left out", without_slivers),
    ):
        theirs = np.array([of(at) for at in distances(sponge, rays)])
        ours = np.array([of(at) for at in octray_distances(scene, rays)])
        yield Row(
            name,
            f"the same, rays through edges and corners{what}",
            "raysect",
            share(np.count_nonzero(theirs != expected), count),
            share(np.count_nonzero(ours != expected), count),
        )


def octray_sponge(level: int) -> octray.Scene:
    """The sponge in octray."""
    size = 3**level
    cut = [
        octray.box([b - a for a, b in zip(low, high, strict=True)], center=False).translate(*low)
        for low, high in menger_cutters(level)
    ]
    scene = octray.Scene()
    scene.add(octray.box(size, center=False) - octray.union(cut))
    return scene


def torus_rays(ratio: float, distance: float, count: int, seed: int) -> np.ndarray:
    """Rays from ``distance`` to points well inside the tube of a torus of radius 1 about z."""
    rng = np.random.default_rng(seed)
    around = rng.uniform(0, 2 * np.pi, count)
    within = rng.uniform(0, 2 * np.pi, count)
    depth = 0.5 * ratio * np.sqrt(rng.uniform(0, 1, count))
    radius = 1 + depth * np.cos(within)
    target = np.column_stack(
        [radius * np.cos(around), radius * np.sin(around), depth * np.sin(within)]
    )
    origin = rng.normal(size=(count, 3))
    origin *= (1 + ratio + distance) / np.linalg.norm(origin, axis=1, keepdims=True)
    return np.hstack([origin, (target - origin) / np.linalg.norm(target - origin, axis=1)[:, None]])


TORUS_RATIOS = (0.001, 0.01, 0.1, 0.5, 0.999)
#: Names and distances from the torus, in its radii.
TORUS_DISTANCES = {"1 to 100": (1.0, 10.0, 100.0), "10^4 to 10^6": (1e4, 1e5, 1e6)}


def torus_cases(distances: tuple[float, ...], count: int) -> Iterator[tuple[float, np.ndarray]]:
    """Ratios of tubes, and rays into each of them: ``count`` in all."""
    cases = [(ratio, distance) for ratio in TORUS_RATIOS for distance in distances]
    for seed, (ratio, distance) in enumerate(cases):
        yield ratio, torus_rays(ratio, distance, count // len(cases), seed)


def torus(count: int, kind: Any) -> Iterator[Row]:
    """Rays aimed into the tube: none may miss, and a closed surface is crossed evenly."""
    from raysect.core import World

    for far, distances in TORUS_DISTANCES.items():
        lost, odd, ours_lost, ours_odd, total = 0, 0, 0, 0, 0
        for ratio, rays in torus_cases(distances, count):
            theirs = crossings(kind(1.0, ratio, parent=World()), rays)
            scene = octray.Scene()
            scene.add(octray.torus(1.0, ratio))
            ours = scene.count_intersections(rays)
            total += len(rays)
            lost += np.count_nonzero(theirs == 0)
            odd += np.count_nonzero(theirs % 2)
            ours_lost += np.count_nonzero(ours == 0)
            ours_odd += np.count_nonzero(ours % 2)
        name = f"torus, tube 0.001 to 0.999 of its radius, seen from {far} radii"
        yield Row(
            name,
            "rays aimed into the tube that miss",
            "raysect",
            share(lost, total),
            share(ours_lost, total),
        )
        yield Row(
            name,
            "odd number of crossings",
            "raysect",
            share(odd, total),
            share(ours_odd, total),
        )
