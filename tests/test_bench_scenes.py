"""The benchmark's scenes: counts, and the same picture by every program that is installed."""

from __future__ import annotations

import io
import itertools
import json
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import pytest

import octray
from conftest import ROOT
from octray.bench import catalogue, shapes
from octray.bench.writers import mitsuba, ply, pov, script, tachyon
from octray.lab.figures import primitives_of

if TYPE_CHECKING:
    from pathlib import Path

    from octray.bench.scene import Scene

    Picture = npt.NDArray[np.float64]

#: One of every family, small.
SMALL = ("sphere", "balls2", "mesh70k", "csg2", "plate3", "drilled4")


def write(scene: Scene, folder: Path) -> Path:
    """Write it for POV-Ray and octray."""
    path = folder / f"{scene.name}.pov"
    with path.open("w", encoding="ascii") as file:
        pov.write(scene, file)
    return path


def by_octray(path: Path, size: tuple[int, int]) -> Picture:
    """Light, linear, 0 to 1."""
    scene = octray.load(path)
    assert scene.diagnostics == []
    return np.asarray(scene.render(size=size).to_numpy().clip(0, 1), dtype=np.float64)


def encode(linear: Picture) -> Picture:
    """The curve of sRGB, 0 to 255."""
    low, high = 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055
    return np.asarray(255 * np.where(linear < 0.0031308, low, high), dtype=np.float64).round()


def read_ppm(path: Path, size: tuple[int, int]) -> Picture:
    data = path.read_bytes()
    width, height = size
    assert data.startswith(b"P6")
    pixels = np.frombuffer(data[-3 * width * height :], np.uint8)
    return pixels.reshape(height, width, 3).astype(np.float64)


@pytest.mark.parametrize("name", SMALL)
def test_the_scene_has_the_shapes_that_it_counts(name: str, tmp_path: Path) -> None:
    scene = catalogue.make(name)
    assert scene.name == name
    read = octray.load(write(scene, tmp_path))
    assert read.diagnostics == []
    described = read.describe()
    # A floor is two triangles.
    assert described["triangles"] - 2 * (scene.floor is not None) == scene.counts.get(
        "triangles", 0
    )
    assert primitives_of(described) == scene.shapes + 2 * (scene.floor is not None)
    assert len(described["lights"]) == len(scene.lights)
    nothing = octray.load(write(scene.emptied(), tmp_path))
    assert len(nothing) == 0


def test_the_numbers_of_shapes_are_the_known_ones() -> None:
    expected = {"balls3": 820, "balls4": 7381, "balls5": 66430, "mesh70k": 69564, "csg5": 500}
    expected |= {"plate10": 201, "plate32": 2049, "drilled80": 6401}
    assert {name: catalogue.make(name).shapes for name in expected} == expected
    # What is too large to be made here.
    assert 2 * catalogue.MESHES["mesh1m"] * (catalogue.MESHES["mesh1m"] - 1) == 998_284


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("", "there is no scene"),
        ("balls", "there is no scene"),
        ("teapot3", "balls"),
        ("balls8", "0 to 7"),
        ("csg0", "1 to 100"),
        ("plate99999999999999999999", "there is no scene"),
        ("drilled-1", "there is no scene"),
        ("balls4.5", "there is no scene"),
        ("balls²", "there is no scene"),
        ("../balls4", "there is no scene"),
    ],
)
def test_a_name_that_means_nothing_is_refused(name: str, word: str) -> None:
    with pytest.raises(ValueError, match=word):
        catalogue.make(name)


def test_the_ball_of_triangles_is_closed_but_for_its_poles() -> None:
    vertices, faces = shapes.bumpy_ball(12)
    # All corners at a pole are one point.
    _, same = np.unique(vertices.round(6), axis=0, return_inverse=True)
    corners = same.reshape(-1)[faces]
    edges = np.concatenate([corners[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    assert (edges[:, 0] != edges[:, 1]).all()
    directed = {(a, b) for a, b in edges.tolist()}
    assert len(directed) == len(edges)
    assert {(b, a) for a, b in directed} == directed
    assert len(faces) == 2 * 12 * 11


def test_every_ball_touches_its_parent() -> None:
    for (parents, large), (children, small) in itertools.pairwise(shapes.sphere_flake(3)):
        away = np.linalg.norm(children.reshape(len(parents), 9, 3) - parents[:, None], axis=2)
        np.testing.assert_allclose(away, large + small, rtol=1e-12)


@pytest.mark.skipif(shutil.which("povray") is None, reason="POV-Ray is not installed (povray)")
@pytest.mark.parametrize("name", [*SMALL, "empty64x48"])
def test_the_picture_is_povrays(name: str, tmp_path: Path) -> None:
    scene = catalogue.make("sphere").emptied() if name.startswith("empty") else catalogue.make(name)
    path, size = write(scene, tmp_path), (64, 48)
    if scene.size[0] == scene.size[1]:
        size = (64, 64)
    target = tmp_path / "povray.ppm"
    options = f"+FP8 +W{size[0]} +H{size[1]} -A -D -P +WT1".split()
    command = ["povray", f"+I{path}", f"+O{target}", *options]
    subprocess.run(command, check=True, capture_output=True, timeout=120)
    theirs, ours = read_ppm(target, size), encode(by_octray(path, size))
    # A step of 255 is rounding; at a silhouette one of them may see the other side.
    different = (np.abs(theirs - ours) > 1).any(axis=2)
    assert np.count_nonzero(different) <= size[0] * size[1] // 1000
    assert len(np.unique(ours.reshape(-1, 3), axis=0)) > (1 if name.startswith("empty") else 50) - 1


@pytest.mark.skipif(shutil.which("tachyon") is None, reason="Tachyon is not installed (tachyon)")
@pytest.mark.parametrize(("name", "size"), [("balls2", (64, 64)), ("sphere", (64, 48))])
def test_the_picture_is_tachyons(name: str, size: tuple[int, int], tmp_path: Path) -> None:
    scene = catalogue.make(name)
    path = tmp_path / f"{name}.dat"
    with path.open("w", encoding="ascii") as file:
        tachyon.write(scene, file)
    target = tmp_path / "tachyon.ppm"
    options = f"-fullshade -res {size[0]} {size[1]} -format PPM".split()
    command = ["tachyon", str(path), *options, "-o", str(target)]
    subprocess.run(command, check=True, capture_output=True, timeout=120)
    theirs = read_ppm(target, size) / 255
    ours = by_octray(write(scene, tmp_path), size)
    # Its rays go through corners of pixels.
    different = np.abs(theirs - ours).mean()
    assert different < 0.06
    # Seen in a mirror, or from another distance, it would be another picture.
    others = theirs[:, ::-1], theirs[::-1], np.roll(theirs, 3, axis=1)
    assert all(different < 0.7 * np.abs(other - ours).mean() for other in others)
    np.testing.assert_allclose(theirs.mean(axis=(0, 1)), ours.mean(axis=(0, 1)), atol=0.02)


def test_tachyon_gets_every_shape() -> None:
    for name, word, floor in (("balls2", "SPHERE CENTER", 0), ("mesh70k", "TRI V0", 2)):
        scene = catalogue.make(name)
        file = io.StringIO()
        tachyon.write(scene, file)
        assert file.getvalue().count(word) == scene.shapes + floor


def test_mitsuba_gets_every_shape(tmp_path: Path) -> None:
    for name in ("balls2", "mesh70k"):
        scene = catalogue.make(name)
        path = tmp_path / f"{name}.xml"
        with path.open("w", encoding="ascii") as file:
            mitsuba.write(scene, file, tmp_path)
        # What it writes itself.
        root = ET.parse(path).getroot()  # noqa: S314
        kinds = [shape.get("type") for shape in root.iter("shape")]
        assert kinds.count("rectangle") == 1
        assert kinds.count("sphere") == sum(len(part.radii) for part in scene.spheres)
        assert kinds.count("ply") == len(scene.meshes)
        looks = {look.get("id") for look in root.findall("bsdf")}
        assert {ref.get("id") for ref in root.iter("ref")} == looks
    mesh = octray.load(tmp_path / ply.name("mesh70k", 0))
    assert mesh.describe()["triangles"] == catalogue.make("mesh70k").shapes


def test_a_mesh_in_a_binary_file_makes_the_same_picture(tmp_path: Path) -> None:
    scene = catalogue.make("mesh70k")
    with (tmp_path / "mesh70k.xml").open("w", encoding="ascii") as file:
        mitsuba.write(scene, file, tmp_path)
    path = tmp_path / "mesh70k.py"
    with path.open("w", encoding="ascii") as file:
        script.write(scene, file)
    small = path.read_text(encoding="ascii").replace(str(scene.size), "(48, 48)")
    path.write_text(small, encoding="ascii")
    target = tmp_path / "binary.png"
    done = subprocess.run(
        [sys.executable, path, target, "1"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["rays"]["primary"] == 48 * 48
    image = octray.load(write(scene, tmp_path)).render(size=(48, 48))
    assert target.read_bytes() == image.to_bytes("png")


def test_the_script_writes_the_scenes_for_every_program(tmp_path: Path) -> None:
    command = [sys.executable, str(ROOT / "benches" / "renders" / "write_scenes.py")]
    names = ("sphere", "csg2", "mesh70k")
    done = subprocess.run(
        [*command, str(tmp_path), *names], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    written = {path.name for path in tmp_path.iterdir()}
    everything = {f"mesh70k{suffix}" for suffix in (".pov", ".dat", ".xml", ".py", "-0.ply")}
    assert written == everything | {"csg2.pov", "sphere.pov", "sphere.dat", "sphere.xml"}
    done = subprocess.run(
        [*command, str(tmp_path), "teapot"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert "there is no scene 'teapot'" in done.stderr
