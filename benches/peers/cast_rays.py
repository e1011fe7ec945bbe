"""Rays from Python onto meshes: octray beside Open3D's RaycastingScene and trimesh over embreex.

All are given the same arrays and are asked for the same answers, in turn, in one process; of each
round the ratio is taken, and its median is printed. Times are of the clock on the wall: with
several threads nothing else says how long one waits. Rays of 32 bits are what Open3D takes and
rays of 64 bits what trimesh takes; octray takes both and answers in 64 bits.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from report import absent, versions

import octray

if TYPE_CHECKING:
    from collections.abc import Callable

Floats = npt.NDArray[np.floating[Any]]
Mesh = tuple[npt.NDArray[np.float32], npt.NDArray[np.uint32]]

ROOT = Path(__file__).resolve().parents[2]
#: Distances differ if they do by more than this share, as for all comparisons with 32 bits.
TOLERANCE = 1e-4


@dataclass(frozen=True)
class Line:
    """One line of the table: seconds are medians, the ratio is theirs to octray's."""

    mesh: str
    rays: str
    asked: str
    peer: str
    threads: str
    theirs: float
    ours: float
    ratio: float
    least: float
    most: float
    differing: int


def scan() -> Mesh | None:
    """Read the scan of the corpus, which is not part of the project."""
    given = os.environ.get("OCTRAY_CORPUS")
    corpus = Path(given) if given else ROOT.parent / "shared" / "data"
    path = corpus / "mesh" / "armadillo.obj"
    if not path.is_file():
        return None
    lines = path.read_text(encoding="utf-8").splitlines()
    vertices = [line.split()[1:4] for line in lines if line.startswith("v ")]
    corners = [line.split()[1:4] for line in lines if line.startswith("f ")]
    faces = [[int(corner.split("/")[0]) - 1 for corner in face] for face in corners]
    return np.array(vertices, np.float32), np.array(faces, np.uint32)


def bumpy_ball(rows: int) -> Mesh:
    """A sphere with waves, about 4 * rows^2 triangles."""
    polar = np.linspace(0.02, np.pi - 0.02, rows + 1)[:, None]
    around = np.linspace(0, 2 * np.pi, 2 * rows, endpoint=False)[None, :]
    radius = 0.9 + 0.1 * np.sin(7 * polar) * np.cos(5 * around) + 0.03 * np.sin(41 * polar)
    radius = radius + 0.01 * np.cos(83 * around + 20 * polar)
    ring = radius * np.sin(polar)
    points = np.stack(
        [ring * np.cos(around), ring * np.sin(around), radius * np.cos(polar)], axis=-1
    )
    index = np.arange(points[..., 0].size).reshape(points.shape[:2])
    beside = np.roll(index, -1, axis=1)
    a, b, c, d = index[:-1], beside[:-1], index[1:], beside[1:]
    faces = np.stack([np.stack([a, c, b], -1), np.stack([b, c, d], -1)], axis=2)
    return points.reshape(-1, 3).astype(np.float32), faces.reshape(-1, 3).astype(np.uint32)


def picture(mesh: Mesh, size: int) -> Floats:
    """Rays through the pixels of a picture, row by row: shape (size * size, 6)."""
    low, high = mesh[0].min(axis=0), mesh[0].max(axis=0)
    center, extent = (low + high) / 2, float((high - low).max())
    eye = center + extent * np.array([0.5, 0.3, 1.35])
    forward = center - eye
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0, 1, 0))
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    ticks = (np.arange(size) + 0.5) / size * 2 - 1
    x, y = np.meshgrid(ticks * 0.4, -ticks * 0.4)
    directions = forward + x[..., None] * right + y[..., None] * up
    rays = np.concatenate([np.broadcast_to(eye, directions.shape), directions], axis=-1)
    return rays.reshape(-1, 6).astype(np.float32)


def scattered(mesh: Mesh, count: int) -> Floats:
    """Rays without order, from a sphere around the mesh into its box."""
    rng = np.random.default_rng(7)
    low, high = mesh[0].min(axis=0), mesh[0].max(axis=0)
    center, extent = (low + high) / 2, float((high - low).max())
    origins = rng.normal(size=(count, 3))
    origins *= extent / np.linalg.norm(origins, axis=1, keepdims=True)
    origins += center
    rays = np.hstack([origins, rng.uniform(low, high, (count, 3)) - origins])
    return rays.astype(np.float32)


def octray_scene(mesh: Mesh) -> octray.Scene:
    """The mesh in octray."""
    scene = octray.Scene()
    scene.add_mesh((mesh[0].astype(np.float64), mesh[1].astype(np.int64)))
    scene.prepare()
    return scene


def seconds(work: Callable[[], Any]) -> float:
    """How long one waits for it."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def in_turn(
    ours: Callable[[], Any], theirs: Callable[[], Any], rounds: int
) -> list[tuple[float, float]]:
    """Times of both, round by round; the first round only warms up."""
    pairs = [(seconds(ours), seconds(theirs)) for _ in range(rounds + 1)]
    return pairs[1:]


def line(names: tuple[str, ...], pairs: list[tuple[float, float]], differing: int) -> Line:
    """What a line of the table says."""
    ratios = [theirs / ours for ours, theirs in pairs]
    mesh, rays, asked, peer, threads = names
    found = Line(
        mesh=mesh,
        rays=rays,
        asked=asked,
        peer=peer,
        threads=threads,
        theirs=statistics.median(theirs for _, theirs in pairs),
        ours=statistics.median(ours for ours, _ in pairs),
        ratio=statistics.median(ratios),
        least=min(ratios),
        most=max(ratios),
        differing=differing,
    )
    print(
        f"| {found.mesh} | {found.rays} | {found.asked} | {found.peer} | {found.threads} |"
        f" {found.theirs * 1e3:.1f} ms | {found.ours * 1e3:.1f} ms |"
        f" **{found.ratio:.2f}x** ({found.least:.2f} to {found.most:.2f}) | {found.differing} |",
        flush=True,
    )
    return found


def beside_open3d(name: str, mesh: Mesh, count: int, rounds: int, threads: list[int]) -> list[Line]:
    """Distances and ids, then all that Open3D answers, on a million rays or so."""
    import open3d

    scene = octray_scene(mesh)
    peer = open3d.t.geometry.RaycastingScene()
    peer.add_triangles(open3d.core.Tensor(mesh[0]), open3d.core.Tensor(mesh[1]))
    size = round(count**0.5)
    lines = []
    for title, rays in (
        (f"{size:,}x{size:,} pixels", picture(mesh, size)),
        (f"{count:,} scattered", scattered(mesh, count)),
    ):
        tensor = open3d.core.Tensor(rays)
        t = peer.cast_rays(tensor)["t_hit"].numpy()
        differing = differ(scene.cast_rays(rays).t, t)
        for n in threads:

            def plain(rays: Floats = rays, n: int = n) -> Any:
                hits = scene.cast_rays(rays, threads=n)
                return hits.t, hits.object_id, hits.face_id

            def full(rays: Floats = rays, n: int = n) -> Any:
                return scene.cast_rays(rays, threads=n).to_open3d()

            def theirs(tensor: Any = tensor, n: int = n) -> Any:
                answers = peer.cast_rays(tensor, nthreads=n)
                return {key: value.numpy() for key, value in answers.items()}

            for asked, ours in (("t and ids", plain), ("with normals", full)):
                names = (name, title, asked, "Open3D", str(n))
                lines.append(line(names, in_turn(ours, theirs, rounds), differing))
    return lines


def beside_trimesh(name: str, mesh: Mesh, size: int, rounds: int) -> list[Line]:
    """The first triangle on the rays of a picture, with as many threads as each takes by itself."""
    import trimesh
    from trimesh.ray.ray_pyembree import RayMeshIntersector

    scene = octray_scene(mesh)
    vertices, faces = mesh
    peer = RayMeshIntersector(trimesh.Trimesh(vertices, faces, process=False))
    rays = picture(mesh, size).astype(np.float64)
    origins, directions = rays[:, :3].copy(), rays[:, 3:].copy()
    found = peer.intersects_first(origins, directions)
    differing = int(np.count_nonzero(found != scene.cast_rays(rays).face_id))
    title = f"{size}x{size} pixels"
    lines = []
    for asked, ours in (
        ("`cast_rays(...).face_id`", lambda: scene.cast_rays(rays).face_id),
        ("`ray.intersects_first`", lambda: scene.ray.intersects_first(origins, directions)),
    ):
        pairs = in_turn(ours, lambda: peer.intersects_first(origins, directions), rounds)
        names = (name, title, asked, "trimesh + embreex", "default")
        lines.append(line(names, pairs, differing))
    return lines


def differ(ours: Floats, theirs: Floats) -> int:
    """How many distances are not the same."""
    met = np.isfinite(ours) & np.isfinite(theirs)
    apart = np.isfinite(ours) != np.isfinite(theirs)
    apart[met] = np.abs(ours[met] - theirs[met]) > TOLERANCE * np.abs(ours[met])
    return int(np.count_nonzero(apart))


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--rays", type=int, default=1_000_000, help="of the batch beside Open3D")
    parser.add_argument("--size", type=int, default=512, help="of the picture beside trimesh")
    parser.add_argument("--mesh", default="", help="only meshes whose name holds this text")
    parser.add_argument("--json", type=Path, help="write the figures there too")
    options = parser.parse_args()
    found = versions()
    missing = [peer for peer in absent(found) if peer.split()[0] in {"Embree", "trimesh", "Open3D"}]
    meshes = {"scan": scan(), "ball of 280,000": bumpy_ball(265), "ball of 1 M": bumpy_ball(500)}
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    peers = ", ".join(f"{name} {found[name]}" for name in ("Open3D", "trimesh") if name in found)
    print(f"octray {octray.__version__}, {peers}, {platform.machine()}, {cores} cores")
    for peer in missing:
        print(f"not installed here: {peer}")
    if meshes["scan"] is None:
        print("scan: OCTRAY_CORPUS names no corpus with mesh/armadillo.obj")
    print(
        "\n| mesh | rays | asked for | peer | threads | peer's time | octray's | octray is faster by"
        " | differing |\n|---|---|---|---|---|--:|--:|--:|--:|"
    )
    lines = []
    for name, mesh in meshes.items():
        if mesh is None or options.mesh not in name:
            continue
        if "Open3D" in found:
            threads = sorted({1, cores or 1})
            lines += beside_open3d(name, mesh, options.rays, options.rounds, threads)
        if "trimesh" in found and "Embree (embreex)" in found:
            lines += beside_trimesh(name, mesh, options.size, options.rounds)
    if not lines:
        sys.exit("no peer is installed here: there is nothing to compare (pip: open3d, embreex)")
    if options.json:
        options.json.write_text(json.dumps([asdict(one) for one in lines], indent=1) + "\n")


if __name__ == "__main__":
    main()
