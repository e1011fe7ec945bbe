"""Solids against analytic geometry."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import octray

if TYPE_CHECKING:
    from collections.abc import Callable

numbers = st.floats(-10, 10)
lengths = st.floats(0.1, 10)
DOWN = [0.3, 0.2, 100.0, 0.0, 0.0, -1.0]


def scene_of(*solids: octray.Solid) -> octray.Scene:
    scene = octray.Scene()
    for solid in solids:
        scene.add(solid)
    return scene


def count(solid: octray.Solid, ray: list[float]) -> int:
    return int(scene_of(solid).count_intersections(ray))


def depth(solid: octray.Solid, ray: list[float] = DOWN) -> float:
    return float(scene_of(solid).cast_rays(ray).t)


@settings(max_examples=60, deadline=None)
@given(r=lengths, x=numbers, y=numbers)
def test_a_ray_meets_a_sphere_at_the_height_of_pythagoras(r: float, x: float, y: float) -> None:
    ray = [x, y, 50.0, 0.0, 0.0, -1.0]
    hits = scene_of(octray.sphere(r)).cast_rays(ray)
    height = r * r - x * x - y * y
    if height > 1e-9:
        assert float(hits.t) == pytest.approx(50 - math.sqrt(height), rel=1e-12)
        assert np.asarray(hits.normal) == pytest.approx(hits.position / r, abs=1e-6)
        assert int(hits.object_id) == 0
    elif height < -1e-9:
        assert float(hits.t) == math.inf
        assert int(hits.object_id) == int(hits.face_id) == -1
        assert np.isnan(hits.normal).all()


@settings(max_examples=40, deadline=None)
@given(scale=st.floats(1e-3, 1e3))
def test_t_counts_in_units_of_the_direction(scale: float) -> None:
    ray = [0.0, 0.0, 10.0, 0.0, 0.0, -scale]
    t = float(scene_of(octray.sphere(1)).cast_rays(ray).t)
    assert t * scale == pytest.approx(9, rel=1e-12)


@pytest.mark.parametrize(
    ("make", "top"),
    [
        (lambda: octray.box((2, 4, 6)), 3.0),
        (lambda: octray.box((2, 4, 6), center=False), 6.0),
        (lambda: octray.box(2), 1.0),
        (lambda: octray.cylinder(1, 4), 2.0),
        (lambda: octray.cylinder(1, 4, center=False), 4.0),
        (lambda: octray.cone(2, 1, 4), 2.0),
        (lambda: octray.cone(2, 1, 4, center=False), 4.0),
        (lambda: octray.torus(math.hypot(0.3, 0.2), 0.25), 0.25),
        (lambda: octray.half_space((0, 0, 2), 1.5), 1.5),
        # x^2 + y^2 + z = 3, as seen from above at (0.3, 0.2).
        (lambda: octray.quadric([1, 1, 0, 0, 0, 0, 0, 0, 1, -3]), 3 - 0.13),
        (lambda: octray.polynomial(2, [1, 0, 0, 0, 1, 0, 0, 0, 1, -3]), 3 - 0.13),
        # z^3 = 8 + x y: 20 coefficients, x y is the seventh, z^3 the seventeenth.
        (lambda: octray.cubic([0] * 6 + [-1] + [0] * 9 + [1, 0, 0, -8]), 8.06 ** (1 / 3)),
        # z^4 = 16.
        (lambda: octray.quartic([0] * 30 + [1, 0, 0, 0, -16]), 2.0),
        (lambda: octray.superellipsoid(2, 2), 0.5),
        (lambda: octray.superellipsoid(1, 0.5), (1 - 0.13**2) ** 0.25),
        (lambda: octray.sphere(2).scale((1, 1, 0.5)), math.sqrt(4 - 0.13) / 2),
        (lambda: octray.box(2).translate(z=5), 6.0),
        (lambda: octray.box((2, 4, 6)).rotate(x=90), 2.0),
        (lambda: octray.box((2, 4, 6), center=False).mirror((0, 0, 1)), 0.0),
        (lambda: octray.box(2).transform(np.diag([1.0, 1.0, 7.0, 1.0])), 7.0),
        (lambda: octray.box(2) + octray.box(4), 2.0),
        (lambda: octray.box(4) - octray.box(2).translate(z=1.5), 0.5),
        (lambda: octray.box(4) & octray.box(2).translate(z=0.5), 1.5),
        (lambda: octray.box(4) & ~octray.box((2, 2, 5)).translate(z=1), -1.5),
    ],
)
def test_the_top_of_each_solid_is_where_it_should_be(
    make: Callable[[], octray.Solid], top: float
) -> None:
    assert depth(make()) == pytest.approx(100 - top, rel=1e-12)


def test_rotations_go_x_then_y_then_z_about_fixed_axes() -> None:
    rod = octray.box((1, 1, 10), center=False).rotate(x=-90, z=90)
    # z is turned to y by -90 degrees about x, then y to -x by 90 about z.
    assert rod.bounds is not None
    low, high = rod.bounds
    assert low == pytest.approx([-10, 0, -1])
    assert high == pytest.approx([0, 1, 0])


def test_operations_leave_their_operands_alone() -> None:
    ball = octray.sphere(1)
    bounds = ball.bounds
    _ = ball.translate(x=5), ball + octray.box(9), ~ball
    assert ball.bounds == bounds


@pytest.mark.parametrize(
    ("solid", "expected"),
    [
        (octray.sphere(1), 2),
        (octray.box(2) - octray.sphere(0.5).translate(x=0.3, y=0.2), 4),
        (octray.union(octray.sphere(1).translate(z=3 * i) for i in range(5)), 10),
        (octray.empty(), 0),
        (octray.sphere(1) - octray.sphere(1), 0),
        (octray.intersection(octray.sphere(1), octray.sphere(1).translate(x=9)), 0),
        (octray.difference(octray.box(4), octray.box(2), octray.sphere(0.1)), 4),
        (octray.half_space((0, 0, 1)), 1),
    ],
)
def test_boundaries_are_counted(solid: octray.Solid, expected: int) -> None:
    assert count(solid, DOWN) == expected


@settings(max_examples=40, deadline=None)
@given(a=lengths, b=lengths, offset=numbers, x=numbers, y=numbers)
def test_two_ways_to_write_a_difference_are_one(
    a: float, b: float, offset: float, x: float, y: float
) -> None:
    ray = [x, y, 50.0, 0.01, 0.02, -1.0]
    one, other = octray.sphere(a), octray.box(b).translate(z=offset)
    counts = {count(one - other, ray), count(one & ~other, ray)}
    assert len(counts) == 1
    assert depth(one - other, ray) == depth(one & other.complement(), ray)


def test_a_closed_mesh_is_a_solid_and_a_convex_one_is_a_polyhedron() -> None:
    corners = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]], dtype=np.float32)
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    tetrahedron = octray.polyhedron(corners, faces)
    mesh = octray.mesh_solid(corners, faces)
    # The slanted face is x + y + z = 4.
    for solid in (tetrahedron, mesh):
        assert depth(solid) == pytest.approx(100 - 3.5, rel=1e-12)
        assert count(solid - octray.box(0.5).translate(0.3, 0.2, 2), DOWN) == 4


def test_a_quadric_is_the_solid_of_the_same_shape() -> None:
    # (x - 1)^2 + y^2 + z^2 = 4: nothing is left of the one without the other.
    ball = octray.quadric([1, 1, 1, 0, 0, 0, -2, 0, 0, -3])
    assert np.asarray(ball.bounds).tolist() == [[-1, -2, -2], [3, 2, 2]]
    same = octray.sphere(2).translate(x=1)
    assert count(ball - same, DOWN) == count(same - ball, DOWN) == 0
    assert count(ball, DOWN) == 2


def test_a_polyhedron_may_have_dents() -> None:
    # An L of height 1 over (0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3).
    outline = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]
    corners = [(x, y, z) for z in (0.0, 1.0) for x, y in outline]
    n = len(outline)
    sides = [[i, (i + 1) % n, (i + 1) % n + n, i + n] for i in range(n)]
    solid = octray.polyhedron(corners, [list(range(n))[::-1], list(range(n, 2 * n)), *sides])
    along_x = [[-5, y, 0.4, 1, 0, 0] for y in (0.5, 1.5, 2.5, 3.5)]
    scene = scene_of(solid)
    assert scene.count_intersections(np.array(along_x)).tolist() == [2, 2, 2, 0]
    back = [[5, y, 0.4, -1, 0, 0] for y in (0.5, 1.5)]
    assert scene.cast_rays(np.array(back)).t.tolist() == [2, 4]


def test_open_meshes_are_refused_as_solids() -> None:
    with pytest.raises(ValueError, match="not closed"):
        octray.mesh_solid([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], "winding")
    with pytest.raises(
        ValueError, match=r"3 open edges: only triangle 0 .* \(0, 0, 0\) to \(1, 0, 0"
    ):
        octray.mesh_solid([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])


def test_meshes_that_cross_are_taken_by_winding_number_on_request() -> None:
    corner = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]], dtype=float)
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    corners, faces = np.vstack([corner, corner + 0.5]), np.vstack([faces, faces + 4])
    with pytest.raises(ValueError, match=r"crossings of triangles: .*cross at \("):
        octray.mesh_solid(corners, faces)
    # The slanted faces are x + y + z = 4 and 5.5.
    solid = octray.mesh_solid(corners, faces, "winding")
    through_both = [0.7, 0.6, 100.0, 0.0, 0.0, -1.0]
    assert depth(solid, through_both) == pytest.approx(100 - 4.2, rel=1e-12)
    assert count(solid, through_both) == 2
    # An inside-out mesh has the same inside.
    with pytest.raises(ValueError, match="inside out"):
        octray.mesh_solid(corner, faces[:4, ::-1])
    turned = octray.mesh_solid(corner, faces[:4, ::-1], "winding")
    assert depth(turned) == pytest.approx(100 - 3.5, rel=1e-12)
    with pytest.raises(ValueError, match='"strict" or "winding", not "loose"'):
        octray.mesh_solid(corner, faces[:4], "loose")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: octray.sphere(0), "radius must be greater than 0, not 0"),
        (lambda: octray.sphere(math.nan), "radius must be finite"),
        (lambda: octray.box((1, 2)), "size: expected three numbers"),
        (lambda: octray.box((1, 2, -3)), "size along z must be greater than 0, not -3"),
        (lambda: octray.box(math.inf), "must be finite"),
        (lambda: octray.cone(0, 0, 1), "largest radius must be greater than 0"),
        (lambda: octray.torus(1, -1), "minor radius must be greater than 0"),
        (lambda: octray.half_space((0, 0, 0)), "normal must not be the zero vector"),
        (lambda: octray.quadric([1, 2]), "expected 10 numbers, not 2"),
        (lambda: octray.quadric([math.inf] * 10), "coefficient must be finite"),
        (lambda: octray.quartic([1] * 34), "35 coefficients, not 34"),
        (lambda: octray.polynomial(16, [1]), "degree must be 1 to 15, not 16"),
        (lambda: octray.superellipsoid(0, 1), "exponent e must be from"),
        (lambda: octray.sphere(1).scale(0), "no inverse"),
        (lambda: octray.sphere(1).translate(x=math.nan), "no inverse"),
        (lambda: octray.sphere(1).mirror((0, 0, 0)), "normal must not be the zero vector"),
        (lambda: octray.sphere(1).transform([[1, 2], [3, 4]]), "4x4 matrix"),
        (lambda: octray.sphere(1).transform(np.ones((4, 4))), "last row"),
        (lambda: octray.mesh_solid([[0, 0]], [[0, 0, 0]]), r"shape \(N, 3\), not shape \(1, 2\)"),
        (lambda: octray.mesh_solid([[0, 0, 0]], [[0, 1, 2]]), "vertex 1, but there are only 1"),
        (lambda: octray.mesh_solid([[0, 0, 0]], [[0, -1, 0]]), "vertex -1"),
        (lambda: octray.mesh_solid([[0, 0, 0]], [[0, 0.5, 0]]), "integers"),
        (lambda: octray.mesh_solid([[0, 0, math.nan]], [[0, 0, 0]]), "not finite"),
        (lambda: octray.mesh_solid([], []), "no triangles"),
        (lambda: octray.polyhedron([[0, 0, 0]], [[0, 1, 2]]), "face 0 uses a corner"),
        (lambda: octray.polyhedron([[0, 0, 0]], cast("Any", 3)), "lists of vertex indices"),
    ],
)
def test_what_is_no_solid_is_refused_with_a_reason(
    make: Callable[[], octray.Solid], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_expressions_that_would_never_end_are_refused_early() -> None:
    def repeated(times: int, change: Callable[[octray.Solid], octray.Solid]) -> octray.Solid:
        solid = octray.sphere(1)
        for _ in range(times):
            solid = change(solid)
        return solid

    with pytest.raises(ValueError, match="operands"):
        repeated(64, lambda solid: solid + solid.translate(x=1))
    with pytest.raises(ValueError, match="nested"):
        repeated(2000, lambda solid: ~solid)


def test_long_chains_stay_flat() -> None:
    solid = octray.sphere(1)
    for i in range(1, 3000):
        solid += octray.sphere(1).translate(z=-3 * i)
    assert solid.bounds is not None
    assert solid.bounds[0][2] == -3 * 2999 - 1
