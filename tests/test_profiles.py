"""Prisms and lathes against formulas."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pytest

import octray

if TYPE_CHECKING:
    from collections.abc import Callable

L_SHAPE = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]


def volume(solid: octray.Solid, rays: int = 300) -> float:
    """By chords along z through the middles of a grid of squares."""
    scene = octray.Scene()
    scene.add(solid)
    assert solid.bounds is not None
    low, high = np.asarray(solid.bounds)
    steps = (high - low)[:2] / rays
    places = [low[k] + steps[k] * (np.arange(rays) + 0.5) for k in range(2)]
    x, y = (grid.ravel() for grid in np.meshgrid(*places))
    zeros, ones = np.zeros_like(x), np.ones_like(x)
    origins = np.column_stack([x, y, zeros + low[2] - 1, zeros, zeros, ones])
    chords = scene.list_intersections(origins)
    return float(np.sum(chords.lengths) * steps[0] * steps[1])


def test_a_prism_has_the_volume_of_its_area() -> None:
    assert volume(octray.prism(L_SHAPE, h=4)) == pytest.approx(20, rel=1e-12)
    square = octray.prism([(-1, -1), (1, -1), (1, 1), (-1, 1)], h=3, center=False, scale=0)
    assert volume(square) == pytest.approx(4, rel=1e-3)
    assert square.bounds == ((-1, -1, 0), (1, 1, 3))


def test_an_outline_may_have_arcs_curves_and_holes() -> None:
    slot = octray.Outline(-2, -1).line_to(2, -1).arc_to(2, 1, center=(2, 0))
    slot = slot.line_to(-2, 1).arc_to(-2, -1, center=(-2, 0))
    hole = octray.Outline.circle(0.5, center=(1, 0))
    plate = octray.prism([slot, hole], h=1)
    assert volume(plate) == pytest.approx(8 + math.pi - math.pi / 4, rel=1e-3)
    bowl = octray.Outline(0, 0).quadratic_to((1, 0), 2, 2).line_to(0, 2)
    # By quadratics from (0, 0) over (1, 0) to (2, 2): y = x^2 / 2, filled to y = 2.
    assert volume(octray.prism(bowl, h=1)) == pytest.approx(8 / 3, rel=1e-3)
    cubic = octray.Outline(0, 0).cubic_to((2 / 3, 0), (4 / 3, 2 / 3), 2, 2).line_to(0, 2)
    assert volume(octray.prism(cubic, h=1)) == pytest.approx(8 / 3, rel=1e-3)


def test_a_lathe_is_what_the_profile_sweeps() -> None:
    bowl = octray.Outline(0, 0).quadratic_to((1, 0), 2, 2).line_to(0, 2)
    assert volume(octray.lathe(bowl)) == pytest.approx(math.pi * 4, rel=2e-3)
    ring = octray.lathe(octray.Outline.circle(0.5, center=(2, 0)), angle=90)
    assert volume(ring) == pytest.approx(math.pi**2 * 0.25 * 2 * 2 / 4, rel=2e-3)
    assert np.asarray(ring.bounds)[0] == pytest.approx([0, 0, -0.5], abs=1e-12)


def test_faces_that_coincide_leave_no_skin() -> None:
    rest = octray.box((3, 3, 2)).translate(1.5, 1.5, 1) - octray.prism(L_SHAPE, 2, center=False)
    scene = octray.Scene()
    scene.add(rest)
    rng = np.random.default_rng(3)
    rays = np.column_stack([rng.uniform(-1, 4, (20_000, 3)), rng.normal(size=(20_000, 3))])
    other = octray.Scene()
    other.add(octray.box((2, 2, 2)).translate(2, 2, 1))
    counts = scene.count_intersections(rays)
    assert np.array_equal(counts, other.count_intersections(rays))
    assert counts.max() == 2


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: octray.prism([(0, 0), (1, 1), (2, 2), (3, 3)][:1], 1), "no area"),
        (lambda: octray.prism([(0, 0, 0)], 1), r"shape \(N, 2\)"),
        (lambda: octray.prism(L_SHAPE, 0), "height must be greater than 0"),
        (lambda: octray.prism(L_SHAPE, 1, scale=-1), "scale"),
        (lambda: octray.prism([(0, 0), (1, math.nan), (1, 1)], 1), "not finite"),
        (lambda: octray.lathe([(-1, 0), (1, 0), (1, 1)]), "other side of the axis"),
        (lambda: octray.lathe(L_SHAPE, angle=400), "angle"),
        (lambda: octray.Outline.circle(-1), "radius"),
        (lambda: octray.prism(cast("Any", 3), 1), "profile"),
        (
            lambda: octray.prism(octray.Outline(0, 0).arc_to(1, 0, center=(5, 5)), 1),
            "equally far",
        ),
    ],
)
def test_what_is_no_profile_is_refused(make: Callable[[], object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        make()
