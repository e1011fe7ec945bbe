"""Putting scenes together: materials, lights, cameras, meshes."""

from __future__ import annotations

import json
import math
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pytest

import octray

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

TRIANGLE = (np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=np.float64), np.array([[0, 1, 2]]))


def test_a_scene_lists_what_was_added() -> None:
    scene = octray.Scene(units="mm")
    assert scene.add(octray.box(2), name="block", material="#ff0000") == 0
    assert scene.add(octray.sphere(1).translate(x=4), material=octray.Material.glass(1.3)) == 1
    assert scene.add_mesh(TRIANGLE, name="flag", material=(0.1, 0.2, 0.3)) == 2
    scene.add_light(octray.PointLight((0, 0, 9), strength=2))
    scene.camera = octray.Camera.look_at((10, 0, 0))
    assert scene.names == ["block", "object 1", "flag"]
    assert len(scene) == 3
    assert scene.bounds == ((-1.0, -1.0, -1.0), (5.0, 1.0, 1.0))

    described = json.loads(json.dumps(scene.describe()))
    assert [o["kind"] for o in described["objects"]] == ["solid", "solid", "sheet"]
    assert described["objects"][0]["primitives"] == {"box": 1}
    assert described["triangles"] == described["objects"][2]["triangles"] == 1
    assert described["units"] == "mm"
    assert described["lights"][0]["color"] == [2, 2, 2]
    assert described["camera"]["eye"] == [10, 0, 0]
    assert described["materials"][1]["ior"] == 1.3
    # "#ff0000" is full red in any encoding.
    assert described["materials"][0]["color"] == [1, 0, 0]


def test_hexadecimal_colours_are_srgb_and_numbers_are_light() -> None:
    scene = octray.Scene()
    scene.add(octray.sphere(1), material="#808080")
    scene.add(octray.sphere(1), material=(0.5, 0.5, 0.5))
    encoded, linear = (m["color"][0] for m in scene.describe()["materials"])
    # IEC 61966-2-1 for 128 / 255.
    assert encoded == pytest.approx(((128 / 255 + 0.055) / 1.055) ** 2.4, rel=1e-12)
    assert linear == 0.5


def test_equal_materials_are_stored_once() -> None:
    scene = octray.Scene()
    for _ in range(3):
        scene.add(octray.sphere(1), material="#123456")
        scene.add(octray.sphere(1), material=octray.Material("#123456", specular=0.5))
    assert len(scene.describe()["materials"]) == 2
    assert octray.Material("#123") == octray.Material("#112233")
    assert octray.Material("#123") != octray.Material("#112234")


@pytest.mark.parametrize(
    "mesh",
    [
        TRIANGLE,
        list(TRIANGLE),
        SimpleNamespace(vertices=TRIANGLE[0], faces=TRIANGLE[1]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
        (TRIANGLE[0].astype(np.float32), TRIANGLE[1].astype(np.uint8)),
    ],
)
def test_meshes_come_in_many_forms(mesh: Any) -> None:
    scene = octray.Scene()
    assert scene.add_mesh(mesh) == 0
    hits = scene.cast_rays(
        np.array([[0.2, 0.2, 5, 0, 0, -1], [0.2, 0.2, -5, 0, 0, 1], [2, 2, 5, 0, 0, -1]])
    )
    assert hits.t.tolist() == [5, 5, math.inf]


def test_a_mesh_file_can_be_a_sheet_or_a_solid(cube: Path) -> None:
    ray = [0.3, 0.4, 5, 0, 0, -1]
    for path in (cube, str(cube)):
        scene = octray.Scene()
        scene.add_mesh(path, name="cube", material="#ff0000", solid=True)
        assert scene.describe()["objects"][0]["kind"] == "solid"
        assert int(scene.count_intersections(ray)) == 2
    scene = octray.Scene()
    scene.add_mesh(cube)
    assert scene.describe()["objects"][0]["kind"] == "sheet"
    assert scene.describe()["triangles"] == 12


def test_open_meshes_are_no_solids_and_scenes_no_meshes(tmp_path: Path) -> None:
    scene = octray.Scene()
    for rule in (True, "strict", "winding"):
        with pytest.raises(ValueError, match="3 open edges"):
            scene.add_mesh(TRIANGLE, solid=rule)
    with pytest.raises(TypeError, match="boolean"):
        scene.add_mesh(TRIANGLE, solid=3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="expected a path, a pair"):
        scene.add_mesh(3)  # type: ignore[arg-type]
    with pytest.raises(FileNotFoundError):
        scene.add_mesh(tmp_path / "none.obj")
    (tmp_path / "a.csg").write_text("sphere(r = 1);")
    with pytest.raises(ValueError, match=r"octray\.load reads"):
        scene.add_mesh(tmp_path / "a.csg")
    assert len(scene) == 0


@pytest.mark.parametrize(
    ("make", "kind", "message"),
    [
        (lambda: octray.Material("#12"), ValueError, "#b8c4d0"),
        (lambda: octray.Material("red"), ValueError, "#b8c4d0"),
        (lambda: octray.Material((1, 2)), ValueError, "three numbers"),
        (lambda: octray.Material(ior=0), ValueError, "index of refraction"),
        (lambda: octray.Material(roughness=-1), ValueError, "roughness"),
        (lambda: octray.Material((math.nan, 0, 0)), ValueError, "colour must be finite"),
        (lambda: octray.Material.checker("#000", "#fff", 0), ValueError, "size"),
        (lambda: octray.PointLight((0, 0)), ValueError, "position: expected three numbers"),
        (lambda: octray.PointLight((0, 0, math.inf)), ValueError, "position must be finite"),
        (lambda: octray.SpotLight((0, 0, 1), (0, 0, 1)), ValueError, "target"),
        (lambda: octray.SpotLight((0, 0, 1), (0, 0, 0), inner=40), ValueError, "half angles"),
        (lambda: octray.DirectionalLight((0, 0, 0)), ValueError, "direction"),
        (lambda: octray.Camera.look_at((0, 0, 0)), ValueError, "different points"),
        (lambda: octray.Camera.look_at((0, 0, 5)), ValueError, "up must not"),
        (lambda: octray.Camera.look_at((5, 0, 0), fov=180), ValueError, "fov"),
        (lambda: octray.Camera.orthographic((5, 0, 0), height=0), ValueError, "height"),
        (lambda: octray.Scene(up=(0, 0, 0)), ValueError, "up"),
        (lambda: octray.Scene().add(cast("Any", "box")), TypeError, "expected a solid"),
        (lambda: octray.Scene().add(octray.box(1), material=cast("Any", 3)), TypeError, "material"),
    ],
)
def test_what_is_wrong_is_said_at_once(
    make: Callable[[], object], kind: type[Exception], message: str
) -> None:
    with pytest.raises(kind, match=message):
        make()


def test_backgrounds_are_colours_or_gradients() -> None:
    scene = octray.Scene()
    scene.background = "#ffffff"
    assert scene.background == [[1, 1, 1]]
    scene.background = [(0, 0, 0), (0.5, 0.5, 0.5), (1, 1, 1)]
    assert scene.background == [[0, 0, 0], [0.5, 0.5, 0.5], [1, 1, 1]]
    with pytest.raises(ValueError, match="background"):
        scene.background = "blue"
    with pytest.raises(ValueError, match="finite"):
        scene.background = (math.nan, 0, 0)


def test_load_reads_a_mesh_and_dresses_it(cube: Path) -> None:
    scene = octray.load(cube)
    described = scene.describe()
    assert described["bounds"] == [[0, 0, 0], [1, 1, 1]]
    assert described["camera"] is not None
    assert len(described["lights"]) >= 1
    assert scene.diagnostics == []


def test_load_errors_carry_their_position(tmp_path: Path) -> None:
    path = tmp_path / "bad.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
    with pytest.raises(octray.SceneError) as caught:
        octray.load(path)
    first = caught.value.diagnostics[0]
    assert (first.severity, first.line) == ("error", 4)
    assert first.file == str(path)
    assert first.text.startswith(f"{path}:4:")
    assert str(first) in str(caught.value)
    assert isinstance(caught.value, ValueError)
    with pytest.raises(FileNotFoundError) as missing:
        octray.load(tmp_path / "none.obj")
    assert missing.value.filename == str(tmp_path / "none.obj")
