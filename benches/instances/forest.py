"""Measure instances: a forest of copies of a solid or of a mesh, against trees written out.

Three forests of each kind, which cover squares of the ground equally densely: many copies, few
copies, and the few written out as objects. The same rays go through all of them chunk by chunk in
turn, in one process; rates are medians over the chunks. Building and memory are measured in a
process for each forest, memory as what the process has more than after importing. Results as a
Markdown table, or with ``--json`` as JSON.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import octray

SPACING = 3.0
CHUNK = 20_000
Floats = npt.NDArray[np.float64]


def resident() -> int:
    """Bytes of memory that this process has now."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * 4096


def transforms(count: int) -> Floats:
    """Turn, scale and place trees on a square grid, jittered; the same for the same count."""
    rng = np.random.default_rng(count)
    side = math.isqrt(count - 1) + 1
    index = np.arange(count)
    angle, size = rng.uniform(0, 2 * np.pi, count), rng.uniform(0.7, 1.3, count)
    placed = np.zeros((count, 3, 4))
    placed[:, 0, 0] = placed[:, 1, 1] = np.cos(angle) * size
    placed[:, 1, 0] = np.sin(angle) * size
    placed[:, 0, 1] = -placed[:, 1, 0]
    placed[:, 2, 2] = size
    placed[:, 0, 3] = (index % side + rng.uniform(-0.2, 0.2, count)) * SPACING
    placed[:, 1, 3] = (index // side + rng.uniform(-0.2, 0.2, count)) * SPACING
    return placed


def solid_tree() -> octray.Solid:
    """Three cones with a bite and a trunk: one CSG solid."""
    crown = octray.cone(1.0, 0.1, 1.5, center=False).translate(z=1)
    crown += octray.cone(0.8, 0.05, 1.3, center=False).translate(z=1.9)
    crown += octray.cone(0.6, 0.02, 1.2, center=False).translate(z=2.7)
    bitten = crown - octray.sphere(0.5).translate(x=0.9, z=1.6)
    return octray.cylinder(0.15, 1.2, center=False) + bitten


def mesh_tree() -> tuple[Floats, npt.NDArray[np.int64]]:
    """A bumpy crown of 336 triangles: ten thousand of them written out still fit."""
    rows, columns = 13, 14
    u, v = np.meshgrid(
        np.linspace(0.02, np.pi - 0.02, rows), np.arange(columns) * 2 * np.pi / columns
    )
    radius = 1 + 0.15 * np.sin(7 * u) * np.cos(9 * v)
    corners = np.stack(
        [np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), 1.3 * np.cos(u)], axis=-1
    ) * radius[..., None] + [0, 0, 2]
    at = np.arange(rows * columns).reshape(columns, rows)
    a, b = at[:, :-1], np.roll(at, -1, axis=0)[:, :-1]
    quads = np.stack([a, b, b + 1, a + 1], axis=-1).reshape(-1, 4)
    return corners.reshape(-1, 3), np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def forest(kind: str, count: int, *, written: bool) -> octray.Scene:
    """Make the scene."""
    scene = octray.Scene()
    placed = transforms(count)
    if kind == "solid":
        tree = solid_tree()
        if written:
            for matrix in placed:
                scene.add(tree.transform(np.vstack([matrix, [0, 0, 0, 1]])))
        else:
            scene.add_instances(tree, placed)
        return scene
    corners, faces = mesh_tree()
    if written:
        for matrix in placed:
            scene.add_mesh((corners @ matrix[:, :3].T + matrix[:, 3], faces))
    else:
        scene.add_instances((corners, faces), placed)
    return scene


def built(kind: str, count: int, *, written: bool, threads: int) -> dict[str, Any]:
    """Build one forest in this process: seconds and bytes."""
    octray.Scene().prepare()
    before = resident()
    start = time.perf_counter()
    scene = forest(kind, count, written=written)
    adding = time.perf_counter() - start
    scene.prepare(threads=threads)
    stats = scene.stats()
    after = resident()
    return {
        "count": count,
        "written": written,
        "adding_s": adding,
        "build_s": stats["build_s"],
        "tree_bytes": stats["memory"]["total"] / count,
        "resident_bytes": (after - before) / count,
    }


def in_own_process(kind: str, count: int, how: str, threads: int) -> dict[str, Any]:
    """Do the same in a process that has done nothing else."""
    command = [
        sys.executable,
        __file__,
        "--threads",
        str(threads),
        "--built",
        kind,
        str(count),
        how,
    ]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    result: dict[str, Any] = json.loads(done.stdout)
    return result


def rays(kind: str, count: int, side: float, rng: np.random.Generator) -> Floats:
    """Give rays within the middle of a forest of this side: coherent from a camera, or any."""
    middle = np.array([side / 2, side / 2, 0.0])
    if kind == "camera":
        width = math.isqrt(count)
        x, y = np.meshgrid(np.linspace(-1, 1, width), np.linspace(-1, 1, width))
        eye = middle + rng.uniform(-2, 2, 3) + np.array([-40, -40, 30])
        target = middle + np.stack([x * 15, y * 15, np.zeros_like(x)], axis=-1).reshape(-1, 3)
        return np.concatenate([np.broadcast_to(eye, target.shape), target - eye], axis=1)
    origin = middle + rng.uniform([-30, -30, 0], [30, 30, 4], (count, 3))
    return np.concatenate([origin, rng.normal(size=(count, 3)) * [1, 1, 0.3]], axis=1)


def rates(kind: str, many: int, few: int, chunks: int, threads: int) -> list[dict[str, Any]]:
    """Rays per second of the three forests, chunk by chunk in turn."""
    forests = {
        f"{many} copies": (many, forest(kind, many, written=False)),
        f"{few} copies": (few, forest(kind, few, written=False)),
        f"{few} written out": (few, forest(kind, few, written=True)),
    }
    rows = []
    for what in ("camera", "any"):
        seconds: dict[str, list[float]] = {name: [] for name in forests}
        met = dict.fromkeys(forests, 0)
        for chunk in range(chunks + 1):
            for name, (count, scene) in forests.items():
                rng = np.random.default_rng(chunk)
                batch = rays(what, CHUNK, math.sqrt(count) * SPACING, rng)
                start = time.perf_counter()
                hits = scene.cast_rays(batch, threads=threads)
                if chunk:  # The first one warms up.
                    seconds[name].append((time.perf_counter() - start) / len(batch))
                    met[name] += int(np.isfinite(hits.t).sum())
        for name, times in seconds.items():
            rate = 1 / statistics.median(times)
            rows.append({"rays": what, "forest": name, "rate": rate, "met": met[name]})
    return rows


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--many", type=int, default=1_000_000)
    parser.add_argument("--few", type=int, default=10_000)
    parser.add_argument("--chunks", type=int, default=15)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--built", nargs=3, help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.built:
        kind, count, written = args.built
        one = built(kind, int(count), written=written == "written", threads=args.threads)
        print(json.dumps(one))
        return
    report: dict[str, Any] = {"building": {}, "rays": {}}
    for kind in ("solid", "mesh"):
        report["building"][kind] = [
            in_own_process(kind, n, how, args.threads)
            for n, how in ((args.many, "copies"), (args.few, "copies"), (args.few, "written"))
        ]
        report["rays"][kind] = rates(kind, args.many, args.few, args.chunks, args.threads)
    if args.json:
        print(json.dumps(report, indent=1))
        return
    print("| forest of | trees | kept | build s | bytes of trees each | bytes resident each |")
    print("|---|---|---|---|---|---|")
    for kind, all_of in report["building"].items():
        for row in all_of:
            kept = "written out" if row["written"] else "copies"
            print(
                f"| {kind} | {row['count']:,} | {kept} | {row['build_s']:.3g}"
                f" | {row['tree_bytes']:,.0f} | {row['resident_bytes']:,.0f} |"
            )
    print("\n| forest of | rays | forest | million rays per second |\n|---|---|---|---|")
    for kind, all_of in report["rays"].items():
        for row in all_of:
            print(f"| {kind} | {row['rays']} | {row['forest']} | {row['rate'] / 1e6:.3f} |")


if __name__ == "__main__":
    main()
