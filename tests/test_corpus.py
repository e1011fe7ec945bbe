"""Other people's files: bad ones are refused cleanly, good ones are rendered."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np
import pytest

import octray

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Octray

SUFFIXES = {".obj", ".ply", ".stl", ".nff", ".csg", ".pov"}


def loaded(path: Path) -> octray.Scene | None:
    """Read a file; if it is refused, see that its name is said."""
    try:
        return octray.load(path)
    except octray.SceneError as error:
        reason = str(error)
    assert str(path) in reason
    return None


@pytest.mark.parametrize(
    "name",
    [
        "crash-30d6d0f7c529b3b66b4131700b7a4580cd7082df.ply",
        "empty.obj",
        "empty.ply",
        "malformed.obj",
        "malformed2.obj",
    ],
)
def test_malformed_meshes_are_refused_with_a_position(
    corpus: Path, octray_command: Octray, tmp_path: Path, name: str
) -> None:
    path = corpus / "malformed" / "assimp" / name
    done = octray_command("render", path)
    assert "Traceback" not in done.stderr
    assert "panicked" not in done.stderr
    assert f"{path}" in done.stderr
    assert done.returncode == 3
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("folder", ["obj", "ply", "stl", "mesh"])
def test_every_mesh_is_rendered_or_refused_with_a_reason(corpus: Path, folder: str) -> None:
    rendered = 0
    for path in sorted((corpus / folder).rglob("*")):
        if path.suffix.lower() not in SUFFIXES or path.stat().st_size > 2 << 20:
            continue
        scene = loaded(path)
        if scene is not None:
            image = scene.render(size=(32, 24))
            assert image.complete
            assert np.isfinite(image.to_numpy()).all()
            rendered += 1
    assert rendered >= 3


def test_files_cut_off_anywhere_never_break_the_reader(corpus: Path, tmp_path: Path) -> None:
    for source in (corpus / "mesh" / "suzanne.obj", corpus / "mesh" / "dragon_22866.ply"):
        data = source.read_bytes()
        for i in range(12):
            path = tmp_path / f"cut{i}{source.suffix}"
            path.write_bytes(data[: len(data) * i // 12])
            scene = loaded(path)
            if scene is not None:
                assert scene.render(size=(8, 6)).complete


def test_a_binary_stl_that_claims_too_much_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "claims.stl"
    path.write_bytes(b"\0" * 80 + struct.pack("<I", 0xFFFF_FFFF) + b"\0" * 50)
    with pytest.raises(octray.SceneError) as caught:
        octray.load(path)
    assert str(path) in str(caught.value)
