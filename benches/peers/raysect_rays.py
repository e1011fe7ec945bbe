"""Rays per second and core: raysect beside octray, on the same rays.

Both run on one thread, in turn, in one process, and give the distance, the sense and the normal of
every crossing of every ray, or of the first one; the ratio of each round's processor times is taken
and its median is printed. Beside it stands the ratio to what raysect does at least: rays made
beforehand, nothing read but distances.
The absolute rates are this machine's and this hour's.
"""

from __future__ import annotations

import argparse
import functools
import platform
import statistics
import sys
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from rays import BORE, through_a_cube
from raysect_solids import ENDLESS
from report import versions

import octray

try:
    from raysect.core import Point3D, Ray, Vector3D, World, translate
    from raysect.primitive import Box, Cylinder, Subtract, Union
except ImportError:
    sys.exit("raysect is not installed here: there is nothing to compare (pip: raysect)")

if TYPE_CHECKING:
    from collections.abc import Callable

#: Holes along a side of the plate.
HOLES = 80
#: Rays in a batch of octray's: the same ones over and over.
BATCH = 50_000


def plate_rays(count: int, seed: int) -> npt.NDArray[np.float64]:
    """Rays from a sphere around the plate to points of its slab."""
    rng = np.random.default_rng(seed)
    origins = rng.normal(size=(count, 3))
    origins *= 1.5 * HOLES / np.linalg.norm(origins, axis=1, keepdims=True)
    half = HOLES / 2
    return np.hstack(
        [origins, rng.uniform((-half, -half, -1), (half, half, 1), (count, 3)) - origins]
    )


def joined(solids: list[Any]) -> Any:
    """A balanced tree of unions, neighbours first: what a careful user of raysect builds."""
    while len(solids) > 1:
        pairs = [Union(a, b) for a, b in zip(solids[::2], solids[1::2], strict=False)]
        solids = pairs + solids[len(pairs) * 2 :]
    return solids[0]


def bored_cube() -> tuple[Any, octray.Scene]:
    """A cube with one hole; the cutter is longer, so that both count the same."""
    cube = Box(Point3D(-1, -1, -1), Point3D(1, 1, 1))
    theirs = Subtract(cube, Cylinder(BORE, 2.2, transform=translate(0, 0, -1.1)), parent=World())
    scene = octray.Scene()
    scene.add(octray.box(2) - octray.cylinder(r=BORE, h=2.2))
    return theirs, scene


def plate(how: str) -> tuple[Any, octray.Scene]:
    """A plate with HOLES x HOLES holes; ``how`` says what raysect's tree looks like."""
    half = HOLES / 2
    places = [(x + 0.5 - half, y + 0.5 - half) for x in range(HOLES) for y in range(HOLES)]
    drills = [Cylinder(0.3, 2.2, transform=translate(x, y, -1.1)) for x, y in places]
    theirs = Box(Point3D(-half, -half, -1), Point3D(half, half, 1))
    if how == "a loop of Subtract":
        for drill in drills:
            theirs = Subtract(theirs, drill)
    elif how == "a loop of Union":
        theirs = Subtract(theirs, functools.reduce(Union, drills))
    else:
        theirs = Subtract(theirs, joined(drills))
    theirs.parent = World()
    cut = octray.union([octray.cylinder(r=0.3, h=2.2).translate(x, y) for x, y in places])
    scene = octray.Scene()
    scene.add(octray.box((HOLES, HOLES, 2)) - cut)
    return theirs, scene


def distances_of(primitive: Any, rays: list[Any], most: int) -> list[list[float]]:
    """The distances of the first crossings, of rays that are raysect's already."""
    answer = []
    for ray in rays:
        distances: list[float] = []
        hit = primitive.hit(ray)
        while hit is not None:
            distances.append(hit.ray_distance)
            if len(distances) >= most:
                break
            hit = primitive.next_intersection()
        answer.append(distances)
    return answer


def crossings_of(
    primitive: Any, rays: npt.NDArray[np.float64], most: int
) -> list[list[tuple[float, ...]]]:
    """Distance, sense and normal of the first crossings, of rays that are numbers."""
    answer = []
    for ox, oy, oz, dx, dy, dz in rays.tolist():
        found: list[tuple[float, ...]] = []
        hit = primitive.hit(Ray(Point3D(ox, oy, oz), Vector3D(dx, dy, dz).normalise()))
        while hit is not None:
            normal = hit.normal
            found.append((hit.ray_distance, hit.exiting, normal.x, normal.y, normal.z))
            if len(found) >= most:
                break
            hit = primitive.next_intersection()
        answer.append(found)
    return answer


@dataclass(frozen=True)
class Query:
    """A question to both: its name, octray's call, its counts, and how many crossings it wants."""

    name: str
    ask: Callable[[octray.Scene, npt.NDArray[np.float64]], Any]
    count: Callable[[octray.Scene, npt.NDArray[np.float64]], npt.NDArray[Any]]
    most: int


QUERIES = (
    Query(
        "list_intersections",
        lambda scene, rays: scene.list_intersections(rays, threads=1),
        lambda scene, rays: scene.count_intersections(rays),
        ENDLESS,
    ),
    Query(
        "cast_rays",
        lambda scene, rays: scene.cast_rays(rays, threads=1),
        lambda scene, rays: scene.cast_rays(rays).hit.astype(int),
        1,
    ),
)


def seconds(work: Callable[[], Any]) -> float:
    """How long it keeps a processor busy; all threads of the process count."""
    start = time.process_time()
    work()
    return time.process_time() - start


def compare(
    name: str, pair: tuple[Any, octray.Scene], rays: npt.NDArray[np.float64], rounds: int
) -> None:
    """A line of the table for each query."""
    primitive, scene = pair
    scene.prepare()
    ready = [Ray(Point3D(*ray[:3]), Vector3D(*ray[3:]).normalise()) for ray in rays.tolist()]
    batch = np.tile(rays, (max(1, BATCH // len(rays)), 1))
    for query in QUERIES:
        ours = query.count(scene, rays)
        theirs = np.array([len(found) for found in distances_of(primitive, ready, query.most)])
        unequal = np.count_nonzero(ours != theirs)
        same, bare, rates = [], [], []
        ask = functools.partial(query.ask, scene, batch)
        for _ in range(rounds):
            fast = seconds(ask) / len(batch)
            most = query.most
            slow = seconds(lambda most=most: crossings_of(primitive, rays, most)) / len(rays)
            least = seconds(lambda most=most: distances_of(primitive, ready, most)) / len(rays)
            fast = (fast + seconds(ask) / len(batch)) / 2
            same.append(slow / fast)
            bare.append(least / fast)
            rates.append((1 / slow, 1 / fast))
        median = statistics.median
        print(
            f"| {name} | {len(rays):,} | {ours.mean():.1f} | {unequal} |"
            f" {median(r for r, _ in rates):.2g} | {median(r for _, r in rates):.2g} |"
            f" **{median(same):.3g}x** ({min(same):.3g} to {max(same):.3g}) |"
            f" {median(bare):.3g}x | `{query.name}` |",
            flush=True,
        )


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=7)
    options = parser.parse_args()
    print(f"octray {octray.__version__}, raysect {versions()['raysect']}, {platform.machine()}\n")
    print(
        "| scene | rays | crossings a ray | unequal counts | raysect rays/s | octray rays/s |"
        " octray to raysect | to its bare distances | octray's query |\n"
        "|---|--:|--:|--:|--:|--:|--:|--:|---|"
    )
    compare("cube minus cylinder", bored_cube(), through_a_cube(20_000, 1), options.rounds)
    for how, count in (
        ("a balanced tree", 2_000),
        ("a loop of Union", 50),
        ("a loop of Subtract", 50),
    ):
        name = f"plate of {HOLES * HOLES:,} holes, raysect with {how}"
        compare(name, plate(how), plate_rays(count, 2), options.rounds)


if __name__ == "__main__":
    main()
