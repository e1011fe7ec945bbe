"""Meshes in binary PLY files, single precision."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from typing import BinaryIO

    from octray.bench.scene import Mesh


def name(scene: str, number: int) -> str:
    """Give the name of the file of a scene's mesh."""
    return f"{scene}-{number}.ply"


def write(mesh: Mesh, file: BinaryIO) -> None:
    """Write vertices and triangles."""
    file.write(
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(mesh.vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(mesh.faces)}\n"
        "property list uchar int vertex_indices\nend_header\n".encode("ascii")
    )
    file.write(mesh.vertices.astype("<f4").tobytes())
    faces = np.empty(len(mesh.faces), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, mesh.faces
    file.write(faces.tobytes())
