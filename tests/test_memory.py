"""What does not fit into memory is refused in words."""

from __future__ import annotations

import re
import subprocess
import sys
from typing import TYPE_CHECKING

import numpy as np
import pytest

import octray
from conftest import COMMAND

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Octray


@pytest.fixture
def terrain(tmp_path: Path) -> Path:
    """A height field of half a million triangles."""
    edge = 500
    x, y = np.meshgrid(np.arange(edge + 1.0), np.arange(edge + 1.0))
    points = np.stack([x, y, np.sin(x) * np.cos(y)], axis=-1).reshape(-1, 3).astype("<f4")
    corner = (np.arange(edge)[:, None] * (edge + 1) + np.arange(edge)).reshape(-1, 1)
    faces = np.zeros((2 * edge * edge, 13), dtype=np.uint8)
    faces[:, 0] = 3
    halves = np.array([[0, 1, edge + 2], [0, edge + 2, edge + 1]])
    faces[:, 1:] = (corner[:, None] + halves).reshape(-1, 3).astype("<i4").view(np.uint8)
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    path = tmp_path / "terrain.ply"
    path.write_bytes(header.encode() + points.tobytes() + faces.tobytes())
    return path


def test_a_tree_of_triangles_beyond_its_limit_is_an_error_in_words(
    octray_command: Octray, terrain: Path
) -> None:
    arguments = ("render", terrain.name, "--size", "32x24", "-o", "terrain.png")
    done = octray_command(*arguments, "--tree-memory", "4")
    assert done.returncode == 1
    assert re.search(
        r"^octray: error: terrain\.ply: a tree over 500000 items takes at least \d+ bytes of "
        r"memory, more than the limit of 4194304$",
        done.stderr,
        re.MULTILINE,
    )
    assert not terrain.with_name("terrain.png").exists()
    with pytest.raises(MemoryError, match="more than the limit of 1000"):
        octray.load(terrain).prepare(tree_memory=1000)


@pytest.mark.skipif(sys.platform != "linux", reason="limits of address space are Linux's")
@pytest.mark.parametrize(("mebibytes", "fits"), [(250, False), (4000, True)])
def test_a_process_that_may_not_grow_says_so(terrain: Path, mebibytes: int, fits: bool) -> None:
    picture = terrain.with_suffix(".png")
    command = [*COMMAND, "render", str(terrain), "-o", str(picture), "--size", "32x24", "-j", "2"]
    done = subprocess.run(
        ["/bin/sh", "-c", f'ulimit -v {mebibytes << 10} && exec "$@"', "sh", *command],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == (0 if fits else 3), done.stderr
    assert picture.exists() == fits
    assert fits or "does not fit into the memory budget of" in done.stderr
