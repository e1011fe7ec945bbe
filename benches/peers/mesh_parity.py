"""Embree and Open3D: crossings of closed meshes by rays aimed at vertices and edges.

Every number of meshes and rays is a short binary fraction, so single precision holds it exactly.
A line meets a closed surface evenly; an odd number is a lost or a doubled hit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from report import Row, share

import octray

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

Mesh = tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]
Counts = npt.NDArray[np.int64]


def ball(frequency: int) -> Mesh:
    """An octahedron divided and blown up to radius 16, vertices on a grid of 2^-6."""
    index: dict[tuple[int, int, int], int] = {}
    triangles = []
    for sx in (1, -1):
        for sy in (1, -1):
            for sz in (1, -1):

                def corner(i: int, j: int, s: tuple[int, int, int] = (sx, sy, sz)) -> int:
                    key = (s[0] * i, s[1] * j, s[2] * (frequency - i - j))
                    return index.setdefault(key, len(index))

                for i in range(frequency):
                    for j in range(frequency - i):
                        faces = [(corner(i, j), corner(i + 1, j), corner(i, j + 1))]
                        if i + j < frequency - 1:
                            faces.append((corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)))
                        triangles += faces if sx * sy * sz > 0 else [f[::-1] for f in faces]
    points = np.array(list(index), dtype=np.float64)
    points *= 16 / np.linalg.norm(points, axis=1, keepdims=True)
    return np.round(points * 64) / 64, np.array(triangles)


def grid_box(cells: int) -> Mesh:
    """A box from 0 to ``cells`` whose sides are grids of unit squares, halved."""
    index: dict[tuple[int, ...], int] = {}
    triangles = []
    for axis in range(3):
        for side in (0, cells):
            for i in range(cells):
                for j in range(cells):
                    quad = []
                    for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        key = [0, 0, 0]
                        key[axis], key[(axis + 1) % 3], key[(axis + 2) % 3] = side, a, b
                        quad.append(index.setdefault(tuple(key), len(index)))
                    if side == 0:
                        quad.reverse()
                    triangles += [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]
    return np.array(list(index), dtype=np.float64), np.array(triangles)


def aimed(mesh: Mesh, count: int, seed: int) -> dict[str, npt.NDArray[np.float64]]:
    """Rays from outside to vertices, to middles of edges, and along the axes to vertices."""
    points, triangles = mesh
    rng = np.random.default_rng(seed)
    a, b = triangles[:, [0, 1, 2]].ravel(), triangles[:, [1, 2, 0]].ravel()
    middles = (points[a] + points[b]) / 2
    origins = rng.integers(-64, 65, (count, 3)).astype(np.float64)
    origins[np.arange(count), rng.integers(0, 3, count)] = rng.choice([-64.0, 64.0], count)
    at_vertices = points[rng.integers(0, len(points), count)]
    at_edges = middles[rng.integers(0, len(middles), count)]
    axes = np.eye(3)[rng.integers(0, 3, count)] * rng.choice([-1.0, 1.0], (count, 1))
    return {
        "rays to vertices": np.hstack([origins, at_vertices - origins]),
        "rays to middles of edges": np.hstack([origins, at_edges - origins]),
        "axis-parallel rays to vertices": np.hstack([at_vertices - 128 * axes, axes]),
    }


def embree(mesh: Mesh) -> Callable[[npt.NDArray[np.float64]], Counts]:
    """Embree by trimesh, which asks for the next hit until there is none."""
    import trimesh
    from trimesh.ray.ray_pyembree import RayMeshIntersector

    caster = RayMeshIntersector(trimesh.Trimesh(*mesh, process=False))

    def count(rays: npt.NDArray[np.float64]) -> Counts:
        _, ray = caster.intersects_id(rays[:, :3], rays[:, 3:], multiple_hits=True)
        return np.bincount(ray, minlength=len(rays))

    return count


def open3d(mesh: Mesh) -> Callable[[npt.NDArray[np.float64]], Counts]:
    """Open3D's own count, also on Embree."""
    import open3d as o3d

    caster = o3d.t.geometry.RaycastingScene()
    tensor = o3d.core.Tensor
    caster.add_triangles(tensor(mesh[0].astype(np.float32)), tensor(mesh[1].astype(np.uint32)))

    def count(rays: npt.NDArray[np.float64]) -> Counts:
        answer = caster.count_intersections(tensor(rays.astype(np.float32)))
        return answer.numpy().astype(np.int64)

    return count


def octray_mesh(mesh: Mesh) -> octray.Scene:
    """The mesh as a solid."""
    scene = octray.Scene()
    scene.add(octray.mesh_solid(*mesh))
    return scene


def compare(peer: str, count: int) -> Iterator[Row]:
    """Rows for one of the two."""
    meshes = {"faceted ball": ball(24), "box of unit squares": grid_box(16)}
    for name, mesh in meshes.items():
        theirs = open3d(mesh) if peer == "Open3D" else embree(mesh)
        ours = octray_mesh(mesh)
        for which, rays in aimed(mesh, count, 5).items():
            yield Row(
                f"closed mesh: {name} of {len(mesh[1]):,} triangles",
                f"odd number of crossings, {which}",
                peer,
                share(np.count_nonzero(theirs(rays) % 2), count),
                share(np.count_nonzero(ours.count_intersections(rays) % 2), count),
            )
