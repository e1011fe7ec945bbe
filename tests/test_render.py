"""Pictures: their bits, their files, and how they are interrupted."""

from __future__ import annotations

import _thread
import signal
import struct
import threading
import time
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import octray

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


def small_scene() -> octray.Scene:
    """Solids with shadows, a mirror and glass."""
    scene = octray.Scene()
    scene.add(octray.box(4) - octray.sphere(2.4), material="#c04020")
    scene.add(octray.sphere(1.2), material=octray.Material.mirror())
    scene.add(octray.sphere(1).translate(3, -3, -1), material=octray.Material.glass())
    floor = octray.Material.checker("#dddddd", "#333333")
    scene.add(octray.half_space((0, 0, 1), -2), material=floor)
    scene.add_light(octray.PointLight((5, -8, 9)))
    scene.camera = octray.Camera.look_at((6, -9, 5))
    scene.background = ["#405060", "#a0c0ff"]
    return scene


def slow_scene() -> octray.Scene:
    """Some seconds of work for one thread, or many."""
    scene = octray.Scene()
    for i in range(60):
        ball = octray.sphere(1).translate(2.5 * (i % 8), 2.5 * (i // 8))
        scene.add(ball, material=octray.Material.glass())
    scene.add_light(octray.PointLight((5, -8, 30)))
    return scene


def test_a_picture_has_the_same_bits_by_every_method() -> None:
    scene = small_scene()
    first = scene.render(size=(96, 64))
    for options in (
        {"threads": 1},
        {"threads": 4},
        {"accel": "brute", "threads": 2},
        {"preview": lambda _image: None},
    ):
        other = scene.render(size=(96, 64), **options)
        assert other.equals(first), options
        assert other.to_bytes("png") == first.to_bytes("png")
        assert other.to_bytes("exr") == first.to_bytes("exr")
    assert not scene.render(size=(96, 65)).equals(first)


def test_pixels_show_what_rays_meet() -> None:
    scene = octray.Scene()
    scene.add(octray.sphere(1), material=octray.Material(diffuse=0, ambient=0, emission=(3, 0, 0)))
    scene.add_light(octray.PointLight((0, 0, 99), strength=0))
    scene.background = (0, 0, 2)
    scene.camera = octray.Camera.orthographic((0, -9, 0), height=4)
    light = scene.render(size=(80, 40)).to_numpy()
    assert (light.shape, light.dtype) == ((40, 80, 3), np.dtype(np.float32))
    # One pixel is 0.1 wide: the ball's silhouette is a disc of radius 10 pixels.
    y, x = np.mgrid[0:40, 0:80] + 0.5
    inside = np.hypot(x - 40, y - 20) < 10
    np.testing.assert_array_equal(light[..., 0] > 0, inside)
    np.testing.assert_array_equal(
        light[~inside], np.tile(np.array([0, 0, 2], np.float32), ((~inside).sum(), 1))
    )


def test_numpy_sees_a_picture_as_an_array() -> None:
    image = small_scene().render(size=(7, 5))
    array = image.to_numpy()
    np.testing.assert_array_equal(np.asarray(image), array)
    assert np.asarray(image, dtype=np.float64).dtype == np.float64
    assert (image.size, image.width, image.height) == ((7, 5), 7, 5)
    array[:] = 0
    assert image.to_numpy().any()


def test_a_crop_is_a_part_of_the_whole() -> None:
    scene = small_scene()
    whole = scene.render(size=(60, 40)).to_numpy()
    part = scene.render(size=(60, 40), crop=(10, 5, 33, 29)).to_numpy()
    np.testing.assert_array_equal(part, whole[5:29, 10:33])


def png_chunks(data: bytes) -> dict[bytes, bytes]:
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    chunks: dict[bytes, bytes] = {}
    at = 8
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        (check,) = struct.unpack(">I", data[at + 8 + length : at + 12 + length])
        assert check == zlib.crc32(kind + body)
        chunks[kind] = chunks.get(kind, b"") + body
        at += 12 + length
    return chunks


def test_files_are_what_their_suffix_says(tmp_path: Path) -> None:
    image = small_scene().render(size=(33, 21))
    image.save(tmp_path / "a.png")
    image.save(str(tmp_path / "a.exr"))
    chunks = png_chunks((tmp_path / "a.png").read_bytes())
    assert struct.unpack(">II", chunks[b"IHDR"][:8]) == (33, 21)
    assert (tmp_path / "a.exr").read_bytes()[:4] == b"\x76\x2f\x31\x01"
    assert image._repr_png_() == (tmp_path / "a.png").read_bytes()
    assert image.to_bytes("png", view="raw") != image.to_bytes("png", view="standard")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.exr", "a.png"]
    with pytest.raises(ValueError, match=r"\.png or \.exr"):
        image.save(tmp_path / "a.jpg")
    with pytest.raises(ValueError, match="view must be"):
        image.save(tmp_path / "b.png", view="pretty")  # type: ignore[arg-type]
    with pytest.raises(FileNotFoundError):
        image.save(tmp_path / "none" / "a.png")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.exr", "a.png"]


def test_empty_and_bare_scenes_have_pictures() -> None:
    empty = octray.Scene()
    empty.background = (1, 2, 3)
    assert (empty.render(size=(3, 2)).to_numpy() == [1, 2, 3]).all()
    bare = octray.Scene()
    bare.add(octray.sphere(5) - octray.box(4))
    light = bare.render(size=(40, 30)).to_numpy()
    # Dressed with a camera and lights, so the part stands out from the background.
    assert np.isfinite(light).all()
    assert light.std() > 0.05
    unbounded = octray.Scene()
    unbounded.add(octray.half_space((0, 0, 1)))
    assert unbounded.render(size=(4, 4)).complete


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"size": (1_000_000, 1_000_000)}, "MiB are allowed"),
        ({"size": (0, 5)}, "not 0 x 5"),
        ({"spp": 0}, "samples per pixel"),
        ({"crop": (5, 5, 5, 9)}, "x0 < x1"),
        ({"crop": (0, 0, 65, 4)}, "does not lie in the picture"),
        ({"max_depth": 0}, "generation limit"),
        ({"threshold": -1.0}, "threshold"),
        ({"threads": 0}, "threads must be 1 to 1024"),
        ({"accel": "fast"}, "fast"),
        ({"view": "nice"}, "view must be"),
        ({"on_interrupt": "ignore"}, "on_interrupt must be"),
    ],
)
def test_what_cannot_be_rendered_is_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        small_scene().render(**{"size": (64, 48), **options})


def test_progress_rises_to_one() -> None:
    seen: list[float] = []
    slow_scene().render(size=(400, 300), progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1
    assert octray.render(small_scene(), size=(4, 4), progress=False).complete


def test_an_error_in_a_callback_stops_the_rendering() -> None:
    def fail(_share: float) -> None:
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        slow_scene().render(size=(4000, 4000), progress=fail)


def test_previews_come_coarse_to_fine() -> None:
    previews: list[octray.Image] = []
    final = small_scene().render(size=(64, 48), preview=previews.append)
    assert len(previews) >= 2
    errors = [np.abs(p.to_numpy() - final.to_numpy()).mean() for p in previews]
    assert errors == sorted(errors, reverse=True)
    assert all(not p.complete and p.size == (64, 48) for p in previews)


@pytest.fixture
def listening() -> Iterator[None]:
    """Ctrl-C counts, also where whoever started the tests has switched it off."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("listening")
def test_an_interruption_raises_or_returns_what_there_is() -> None:
    scene = slow_scene()
    scene.prepare()

    def interrupt_at_once(_share: float) -> None:
        _thread.interrupt_main()

    with pytest.raises(KeyboardInterrupt):
        scene.render(size=(3000, 3000), progress=interrupt_at_once)
    start = time.monotonic()
    image = scene.render(size=(3000, 3000), progress=interrupt_at_once, on_interrupt="return")
    assert not image.complete
    assert 0 <= image.report["finished_pixels"] < 9_000_000
    assert time.monotonic() - start < 60


def test_other_threads_run_while_a_picture_is_made() -> None:
    ticks = 0
    stop = threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not stop.wait(0.001):
            ticks += 1

    thread = threading.Thread(target=tick)
    thread.start()
    try:
        slow_scene().render(size=(600, 450), threads=1)
    finally:
        stop.set()
        thread.join()
    assert ticks > 3


def test_the_report_counts_rays() -> None:
    scene = octray.Scene()
    scene.add(octray.sphere(1), material=octray.Material(ambient=1.0))
    scene.add_light(octray.PointLight((0, 0, 9)))
    report = scene.render(size=(20, 10), spp=3).report
    assert report["rays"]["primary"] == 600
    assert report["rays"]["total"] == sum(report["rays"].values()) - report["rays"]["total"]
    assert report["rays"]["reflected"] == 0
    assert 0 < report["hits"]["primary"] < 600
    assert report["tests_per_ray"]["triangles"] == 0
    assert report["complete"]


def test_the_report_tells_what_each_kind_of_ray_cost() -> None:
    scene = octray.Scene()
    scene.add(octray.sphere(1), material=octray.Material.glass())
    scene.add(octray.box((9, 9, 1)).translate(z=-3))
    scene.add_light(octray.PointLight((0, 5, 9)))
    report = scene.render(size=(32, 24)).report
    kinds = report["tests_by_kind"]
    assert set(kinds) == {"primary", "reflected", "refracted", "shadow"}
    for kind, tests in kinds.items():
        assert tests["rays"] == report["rays"][kind] > 0
        assert tests["surfaces"] > 0
    for name, average in report["tests_per_ray"].items():
        total = sum(tests["rays"] * tests[name] for tests in kinds.values())
        assert total == pytest.approx(average * report["rays"]["total"])


def test_a_cost_picture_shows_what_the_rays_of_each_pixel_cost() -> None:
    scene = octray.Scene()
    for x in range(5):
        scene.add(octray.sphere(0.4).translate(x=x))
    image = scene.render(size=(40, 30), accel="brute", integrator="cost")
    steps, surfaces, triangles = np.moveaxis(image.to_numpy(), -1, 0)
    assert steps.max() == triangles.max() == 0
    rays = image.report["rays"]
    assert surfaces.sum() == 5 * rays["total"]
    assert surfaces.min() == 5
    cost = image.report["cost"]
    assert cost["low"] == 0
    assert cost["high"] == surfaces.max() * cost["weights"]["surface"]
    assert scene.render(size=(4, 3)).report["cost"] is None
    # A PNG is the heat map, which is neither black nor the array.
    assert image.to_bytes("png") != scene.render(size=(40, 30)).to_bytes("png")
    with pytest.raises(ValueError, match="no light"):
        image.to_bytes("png", view="raw")
    with pytest.raises(ValueError, match="no light"):
        scene.render(size=(4, 3), integrator="cost", view="raw")
    with pytest.raises(ValueError, match="integrator must be"):
        scene.render(size=(4, 3), integrator="light")  # type: ignore[arg-type]


def test_limits_of_the_octree_hold_are_reported_and_do_not_show() -> None:
    def picture(
        tree_depth: int | None = None, tree_memory: int | None = None
    ) -> tuple[octray.Image, dict[str, Any]]:
        scene = octray.Scene()
        holes = [
            octray.cylinder(r=0.3, h=4).translate(x=i, y=j) for i in range(6) for j in range(6)
        ]
        scene.add(octray.box((7, 7, 1)).translate(x=2.5, y=2.5) - octray.union(holes))
        scene.prepare(tree_depth=tree_depth, tree_memory=tree_memory)
        image = scene.render(size=(48, 36))
        return image, image.report["trees"]["cells"]

    free, cells = picture()
    assert cells["depth"] > 2
    assert cells["stopped_by_depth"] == 0
    shallow, cells = picture(tree_depth=2)
    assert cells["depth"] == 2
    assert cells["stopped_by_depth"] > 0
    small, cells = picture(tree_memory=5_000)
    assert cells["stopped_by_memory"]
    assert cells["bytes"] <= 5_000
    assert free.equals(shallow)
    assert free.equals(small)
    with pytest.raises(ValueError, match="tree_depth"):
        octray.Scene().prepare(tree_depth=22)
