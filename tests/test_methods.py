"""Methods of finding surfaces, by name: the same answers and the same picture from all."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

import octray

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Octray


def part() -> octray.Scene:
    scene = octray.Scene()
    body = octray.box((4, 3, 1)) - octray.cylinder(r=0.5, h=1)
    body -= octray.cylinder(r=0.3, h=2).translate(x=1)
    scene.add(body + octray.torus(1.2, 0.2).translate(z=0.5), name="body")
    scene.add(octray.sphere(0.4).translate(z=1.2), material=octray.Material.glass(1.5))
    scene.add(octray.half_space((0, 0, 1), -0.8), name="floor")
    return scene


def test_every_method_gives_the_same_picture_and_the_same_crossings() -> None:
    rays = np.random.default_rng(5).normal(size=(300, 6))
    size = (48, 32)
    picture = part().render(size=size, accel="brute").to_numpy()
    chords = part().list_intersections(rays, accel="brute")
    assert {"auto", "spheres", "boxes", "grid", "octree:lvsi:sung:analytic"} <= set(
        octray.methods()
    )
    for method in [*octray.methods(), "grid:5", "octree", "octree:lvsi-empty"]:
        scene = part()
        image = scene.render(size=size, accel=method).to_numpy()
        np.testing.assert_array_equal(image, picture, err_msg=method)
        found = scene.list_intersections(rays, accel=method)
        np.testing.assert_array_equal(found.t_enter, chords.t_enter)
        np.testing.assert_array_equal(found.face_exit, chords.face_exit)


@pytest.mark.parametrize(
    ("method", "reason"),
    [
        ("fast", "is no method: use auto, brute"),
        ("octree:lvsi:ordered", "use `sung` with it"),
        ("grid:0", "at least one voxel"),
    ],
)
def test_what_is_no_method_is_refused_with_a_reason(
    method: str, reason: str, octray_command: Octray, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=reason):
        part().prepare(accel=method)
    (tmp_path / "a.csg").write_text("cube(1);", encoding="utf-8")
    done = octray_command("render", "a.csg", "--accel", method)
    assert done.returncode == 2
    assert reason.split("`", maxsplit=1)[0] in " ".join(done.stderr.split())
