"""The page on exactness: its examples, and the error bound it promises."""

from __future__ import annotations

import math
import os
import shlex
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

import octray
from examples import blocks, run_python

if TYPE_CHECKING:
    from collections.abc import Callable

    Value = tuple[Fraction, tuple[Fraction, ...]]
    Implicit = Callable[[Fraction, Fraction, Fraction], Value]

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "exactness.md"


def test_the_examples_print_what_the_page_says() -> None:
    compared = run_python(PAGE)
    assert len(compared) == 15
    for printed, claim in compared:
        assert printed == claim


@pytest.mark.parametrize(
    "command",
    [
        line
        for block in blocks(PAGE.read_text(encoding="utf-8"), "sh")
        for line in block.splitlines()
        if line.startswith("octray ")
    ],
)
def test_the_commands_succeed(command: str) -> None:
    octray_command = Path(sys.executable).with_name("octray")
    done = subprocess.run(
        [octray_command, *shlex.split(command)[1:]],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "faces merged" in done.stdout


@pytest.mark.parametrize("script", ["compare.py", "raysect_rays.py"])
def test_the_comparisons_start(script: str) -> None:
    done = subprocess.run(
        [sys.executable, ROOT / "benches" / "peers" / script, "--help"],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    # Without raysect there is nothing to time, and that is said.
    if done.returncode != 0:
        assert script == "raysect_rays.py"
        assert "raysect is not installed" in done.stderr
    else:
        assert "usage:" in done.stdout


# Implicit functions and their gradients, polynomials with short coefficients: exact in rationals.


def flat(axis: int, offset: int) -> Implicit:
    def plane(*point: Fraction) -> Value:
        return point[axis] - offset, tuple(Fraction(int(i == axis)) for i in range(3))

    return plane


def sphere(x: Fraction, y: Fraction, z: Fraction) -> Value:
    return x * x + y * y + z * z - 1, (2 * x, 2 * y, 2 * z)


def cylinder(x: Fraction, y: Fraction, _z: Fraction) -> Value:
    return x * x + y * y - 1, (2 * x, 2 * y, Fraction(0))


def cone(x: Fraction, y: Fraction, z: Fraction) -> Value:
    radius = 1 - z / 4
    return x * x + y * y - radius * radius, (2 * x, 2 * y, radius / 2)


def ring(minor: Fraction) -> Implicit:
    def torus(x: Fraction, y: Fraction, z: Fraction) -> Value:
        across = x * x + y * y
        q = across + z * z + 1 - minor * minor
        return q * q - 4 * across, (4 * x * q - 8 * x, 4 * y * q - 8 * y, 4 * z * q)

    return torus


#: A solid, all its surfaces, and the largest coordinate.
SURFACES: dict[str, tuple[octray.Solid, list[Implicit], float]] = {
    "box": (octray.box(2), [flat(axis, side) for axis in range(3) for side in (-1, 1)], 1),
    "sphere": (octray.sphere(1), [sphere], 1),
    "cylinder": (octray.cylinder(1, 16), [cylinder, flat(2, -8), flat(2, 8)], 8),
    "cone": (octray.cone(1, 0.25, 3, center=False), [cone, flat(2, 0), flat(2, 3)], 3),
    "fat torus": (octray.torus(1, 0.75), [ring(Fraction(3, 4))], 1.75),
    "thin torus": (octray.torus(1, 2.0**-8), [ring(Fraction(1, 256))], 1.01),
}


def exact_distance(surfaces: list[Implicit], point: list[Fraction]) -> float:
    """From a point near one of the surfaces to it, to first order."""
    distances = []
    for implicit in surfaces:
        value, gradient = implicit(*point)
        distances.append(abs(float(value)) / math.sqrt(sum(g * g for g in gradient)))
    return min(distances)


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("distance", [3.0, 1e3, 1e6])
@pytest.mark.parametrize("place", [0.0, 5.0])
def test_crossings_lie_on_their_surface_to_rounding(
    name: str, distance: float, place: float
) -> None:
    solid, surfaces, size = SURFACES[name]
    scene = octray.Scene()
    scene.add(solid.translate(place, -2 * place, 3 * place))
    moved = np.array([place, -2 * place, 3 * place])
    count = 100 * int(os.environ.get("OCTRAY_CASES", "1"))
    rng = np.random.default_rng(1)
    target = rng.uniform(-1, 1, (count, 3))
    if "torus" in name:
        around = rng.uniform(0, 2 * np.pi, count)
        target = np.column_stack([np.cos(around), np.sin(around), np.zeros(count)])
    origin = rng.normal(size=(count, 3))
    origin *= (size + distance) / np.linalg.norm(origin, axis=1, keepdims=True)
    rays = np.hstack([origin + moved, target - origin])
    found = scene.list_intersections(rays)
    assert len(found) >= count // 3
    for index, *crossings in zip(found.ray_id, found.t_enter, found.t_exit, strict=True):
        exact = [Fraction(v) for v in rays[index].tolist()]
        away = [Fraction(v) for v in moved.tolist()]
        for t in map(float, crossings):
            point = [
                o + Fraction(t) * d - m for o, d, m in zip(exact[:3], exact[3:], away, strict=True)
            ]
            reach = size + 3 * place + t * float(np.linalg.norm(rays[index, 3:]))
            assert exact_distance(surfaces, point) <= 2.0**-49 * reach, (index, t)


def test_the_rules_for_what_cannot_be_decided_hold_everywhere() -> None:
    # The same answers from brute force, on any number of threads, wherever a line is doubtful.
    part = octray.box(2) - octray.cylinder(r=0.5, h=2) + octray.torus(1, 0.25)
    scene = octray.Scene()
    scene.add(part)
    ticks = np.linspace(-1.25, 1.25, 11)
    grid = np.array([(x, y) for x in ticks for y in ticks])
    rays = np.concatenate(
        [
            np.insert(
                np.hstack([grid, np.zeros_like(grid)]), [axis, axis + 2], [[-9.0, 1.0]], axis=1
            )
            for axis in range(3)
        ]
    )
    assert rays.shape == (3 * len(grid), 6)
    expected = scene.list_intersections(rays, whole_line=True)
    assert (scene.count_intersections(rays, whole_line=True) % 2 == 0).all()
    for options in ({"accel": "brute"}, {"threads": 1}, {"threads": 3}):
        again = scene.list_intersections(rays, whole_line=True, **options)
        for column in ("offsets", "t_enter", "t_exit", "face_enter", "normal_exit"):
            np.testing.assert_array_equal(getattr(again, column), getattr(expected, column))
