"""Renderings that are interrupted and gone on with, and pictures in pieces."""

from __future__ import annotations

import random
import signal
import subprocess
import sys
import time
from typing import TYPE_CHECKING

import numpy as np
import pytest

import octray
from octray._core import TiledPicture, TileRenderer

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Octray

#: Mirrors that see each other: slow enough to be interrupted.
SLOW = """
background { rgb <0.2, 0.3, 0.4> }
camera { location <0, 0, -6> look_at 0 }
light_source { <3, 5, -5> rgb 1 }
#declare I = 0;
#while (I < 40)
  sphere { <sin(I) * 2, cos(I * 1.7) * 1.5, sin(I * 0.6)>, 0.45
    pigment { rgb <0.3, 0.5, 0.2> } finish { reflection 0.6 phong 0.4 } }
  #declare I = I + 1;
#end
"""


def scene() -> octray.Scene:
    made = octray.Scene()
    made.add(octray.sphere(1) - octray.box(1), material=(0.8, 0.1, 0.1))
    made.add(octray.torus(2, 0.4))
    return made


def test_a_scene_survives_bytes() -> None:
    before = scene()
    data = before.to_bytes()
    assert before.to_bytes() == data
    for form in (data, np.frombuffer(data, dtype=np.uint8)):
        after = octray.Scene.from_bytes(form)
        assert after.names == before.names
        assert after.to_bytes() == data
        assert after.render(size=(40, 30)).equals(before.render(size=(40, 30)))
    with pytest.raises(ValueError, match="not a scene"):
        octray.Scene.from_bytes(b"nothing")
    with pytest.raises(ValueError, match="damaged"):
        octray.Scene.from_bytes(data[:-1] + b"\xff")
    with pytest.raises(TypeError, match="bytes"):
        octray.Scene.from_bytes("text")  # type: ignore[arg-type]


def test_tiles_in_any_order_are_the_picture() -> None:
    whole = scene().render(size=(150, 90), spp=2)
    picture = TiledPicture(scene(), size=(150, 90), spp=2)
    renderer = TileRenderer(octray.Scene.from_bytes(scene().to_bytes()), size=(150, 90), spp=2)
    assert renderer.job == picture.job
    ids = picture.missing()
    assert ids == list(range(picture.tiles))
    random.Random(1).shuffle(ids)  # noqa: S311 - no secret
    for start in range(0, len(ids), 4):
        part = ids[start : start + 4]
        records, cost = renderer.render(part)
        assert cost["rays"]["primary"] > 0
        assert sorted(picture.take_records(records)) == sorted(part)
        # Nothing is new the second time.
        assert picture.take_records(records) == []
    assert picture.image().equals(whole)
    again = TiledPicture(scene(), size=(150, 90), spp=2)
    assert sorted(again.resume(picture.checkpoint())) == list(range(picture.tiles))
    assert again.image().equals(whole)
    other = TiledPicture(scene(), size=(150, 90), spp=3)
    with pytest.raises(ValueError, match="other settings"):
        other.resume(picture.checkpoint())
    with pytest.raises(ValueError, match="damaged"):
        again.take_records(records[:-1])
    with pytest.raises(ValueError, match="tiles 0 to"):
        renderer.render([picture.tiles])


def _interrupted(folder: Path, number: int) -> Path:
    """Start a rendering, end it once there is a checkpoint; give the checkpoint."""
    (folder / "slow.pov").write_text(SLOW)
    kept = folder / "out.png.ckpt"
    with subprocess.Popen(
        [
            *(sys.executable, "-m", "octray", "render", "slow.pov", "-o", "out.png"),
            *("--size", "640x480", "--spp", "512", "-q", "-j", "1"),
        ],
        cwd=folder,
    ) as process:
        end = time.monotonic() + 60
        while not kept.exists() and time.monotonic() < end:
            time.sleep(0.02)
        process.send_signal(number)
    assert kept.exists()
    return kept


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_what_was_finished_is_kept_and_only_for_the_same_picture(
    tmp_path: Path, octray_command: Octray, number: int
) -> None:
    kept = _interrupted(tmp_path, number)
    loaded = octray.load(tmp_path / "slow.pov")
    picture = TiledPicture(loaded, size=(640, 480), spp=512)
    finished = picture.resume(kept.read_bytes())
    assert finished
    # What it holds are the bits of those tiles.
    renderer = TileRenderer(loaded, size=(640, 480), spp=512)
    alone = TiledPicture(loaded, size=(640, 480), spp=512)
    alone.take_records(renderer.render(finished[:2])[0])
    pixels, expected = picture.image().to_numpy(), alone.image().to_numpy()
    lit = expected.sum(axis=2) > 0
    assert lit.any()
    assert np.array_equal(pixels[lit], expected[lit])
    # Other settings are refused before anything is rendered.
    result = octray_command(
        "render", "slow.pov", "-o", "out.png", "--size", "640x480", "--spp", 4, "--resume"
    )
    assert result.returncode == 2
    assert "other settings" in result.stderr


def test_a_resumed_picture_has_the_same_bytes(tmp_path: Path, octray_command: Octray) -> None:
    (tmp_path / "slow.pov").write_text(SLOW)
    loaded = octray.load(tmp_path / "slow.pov")
    whole = loaded.render(size=(128, 96), spp=4)
    picture = TiledPicture(loaded, size=(128, 96), spp=4)
    renderer = TileRenderer(loaded, size=(128, 96), spp=4)
    picture.take_records(renderer.render(picture.missing()[::2])[0])
    picture.save_checkpoint(tmp_path / "out.exr.ckpt")
    result = octray_command(
        *("render", "slow.pov", "-o", "out.exr", "--size", "128x96", "--spp", 4, "--resume")
    )
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "out.exr").read_bytes() == whole.to_bytes("exr")
    assert not (tmp_path / "out.exr.ckpt").exists()
    # Without one it starts afresh and says so.
    result = octray_command(
        *("render", "slow.pov", "-o", "out.exr", "--size", "128x96", "--spp", 4, "--resume")
    )
    assert result.returncode == 0
    assert "starting afresh" in result.stderr
    assert (tmp_path / "out.exr").read_bytes() == whole.to_bytes("exr")
