"""Measure the LVSI hash table: sizes and loads, and what stored empty space saves.

Runs ``octray render --json`` on three scenes, every choice in interleaved repetitions, and prints
the tables of ``docs/lvsi.md`` as Markdown. Times are the shortest of the repetitions, relative to the
first choice in a table.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

LOADS = (0.25, 0.5, 0.75, 1.0, 2.0, 4.0)
TABLES = ("prime", "power-of-two")
ROOT = Path(__file__).resolve().parents[2]
CAMERA = "v\nfrom 2.1 1.3 1.7\nat 0 0 0\nup 0 0 1\nangle 45\nhither 1\nresolution 512 512\n"


def sphereflake(levels: int) -> str:
    """Give a ball with nine balls of a third of its size on it, and so on, as NFF."""
    lines = [CAMERA + "b 0.08 0.36 0.56\nl 4 3 2\nl 1 -4 4\nf 1 0.9 0.7 0.8 0 0 0 1"]

    def add(center: tuple[float, ...], radius: float, away: tuple[float, ...], level: int) -> None:
        lines.append("s {} {} {} {}".format(*center, radius))
        if level == 0:
            return
        x, y, z = away
        # Two directions across: those and `away` are a frame.
        side = (y, -x, 0.0) if abs(z) < 0.9 else (0.0, z, -y)
        norm = math.hypot(*side)
        a = tuple(c / norm for c in side)
        b = (y * a[2] - z * a[1], z * a[0] - x * a[2], x * a[1] - y * a[0])
        for count, height, turn in ((6, 0.0, 0.0), (3, 60.0, 30.0)):
            up = math.radians(height)
            for i in range(count):
                around = math.radians(turn + 360.0 * i / count)
                way = tuple(
                    math.cos(up) * (math.cos(around) * p + math.sin(around) * q) + math.sin(up) * r
                    for p, q, r in zip(a, b, away, strict=True)
                )
                reach = radius * 4 / 3
                child = tuple(c + reach * w for c, w in zip(center, way, strict=True))
                add(child, radius / 3, way, level - 1)

    add((0.0, 0.0, 0.0), 0.5, (0.0, 0.0, 1.0), levels)
    return "\n".join(lines) + "\n"


def plate(side: int) -> str:
    """Give a plate with a hole in each of ``side * side`` squares, in OpenSCAD's tree format."""
    holes = " ".join(
        f"multmatrix([[1,0,0,{x + 0.5}],[0,1,0,{y + 0.5}],[0,0,1,-1],[0,0,0,1]])"
        f" cylinder(h = 3, r1 = {0.2 + 0.002 * (x + y)}, r2 = {0.2 + 0.002 * (x + y)});"
        for x in range(side)
        for y in range(side)
    )
    return f"difference() {{ cube([{side}, {side}, 1]); {holes} }}\n"


def scenes(folder: Path) -> dict[str, Path]:
    """Write the scenes that are generated; give all of them by name."""
    flake, drilled = folder / "sphereflake.nff", folder / "plate.csg"
    flake.write_text(sphereflake(4), encoding="utf-8")
    drilled.write_text(plate(30), encoding="utf-8")
    workbench = ROOT / "scenes" / "workbench" / "workbench.pov"
    return {"sphereflake": flake, "drilled plate": drilled, "workbench": workbench}


def render(scene: Path, options: tuple[str, ...], size: str, folder: Path) -> dict[str, Any]:
    """Render once; give the report."""
    command = [sys.executable, "-m", "octray", "render", str(scene), "-o", str(folder / "out.png")]
    command += ["--size", size, "-j", "1", "-q", "--json", *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stderr)
    report: dict[str, Any] = json.loads(done.stdout)
    return report


Choice = tuple[str, tuple[str, ...]]


def measure(
    scene: Path, choices: list[Choice], arguments: argparse.Namespace, folder: Path
) -> list[dict[str, Any]]:
    """Give the report of every choice, its time the shortest of the repetitions."""
    best: dict[str, dict[str, Any]] = {}
    for _ in range(arguments.repeat):
        for name, options in choices:
            report = render(scene, options, arguments.size, folder)
            known = best.get(name)
            if known is None or report["phases"]["render_s"] < known["phases"]["render_s"]:
                best[name] = report
    return [best[name] for name, _ in choices]


def figures(report: dict[str, Any], first: dict[str, Any]) -> list[str]:
    """Give a row of a table."""
    cells, per_ray = report["trees"]["cells"], report["tests_per_ray"]
    table = cells["lvsi"]
    leaves = table["leaves"] if table else cells["empty"] + cells["occupied"]
    chain = str(table["longest_chain"]) if table else ""
    used = f"{table['heads_used'] / table['table_size']:.0%}" if table else ""
    time = report["phases"]["render_s"] / first["phases"]["render_s"]
    return [
        f"{leaves}",
        f"{cells['node_bytes'] / max(leaves, 1):.1f}",
        used,
        chain,
        f"{per_ray['cells']:.1f}",
        f"{per_ray['lookups'] / max(per_ray['cells'], 1e-9):.2f}",
        f"{per_ray['lookups']:.0f}",
        f"{time:.2f}",
    ]


HEADER = (
    "leaves kept", "bytes per leaf", "heads used", "longest chain", "steps per ray",
    "look-ups per step", "look-ups per ray", "time",
)  # fmt: skip


def table(title: str, choices: list[Choice], reports: list[dict[str, Any]]) -> None:
    """Print a table."""
    print(f"\n### {title}\n")
    print("| | " + " | ".join(HEADER) + " |")
    print("|---|" + "---:|" * len(HEADER))
    for (name, _), report in zip(choices, reports, strict=True):
        print(f"| {name} | " + " | ".join(figures(report, reports[0])) + " |", flush=True)


def main() -> None:
    """Print all tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=5, help="repetitions of every choice")
    parser.add_argument("--size", default="48x36", help="size of the pictures")
    arguments = parser.parse_args()
    lvsi = ("--accel", "octree:lvsi")
    sizes: list[Choice] = [
        (f"{kind}, load {load:g}", (*lvsi, "--lvsi-table", kind, "--lvsi-load", str(load)))
        for kind in TABLES
        for load in LOADS
    ]
    stores: list[Choice] = [
        (f"`{name}`", ("--accel", name, "--tree-depth", "10"))
        for name in ("octree:lvsi", "octree:lvsi-empty", "octree:tree:sung", "octree:tree:ordered")
    ]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for scene, path in scenes(folder).items():
            reports = measure(path, sizes + stores, arguments, folder)
            table(f"{scene}: size of the table", sizes, reports[: len(sizes)])
            table(f"{scene}: what is stored", stores, reports[len(sizes) :])


if __name__ == "__main__":
    main()
