"""``octray doctor``: whether this installation is sound."""

from __future__ import annotations

import importlib.metadata
import json
import os
import platform
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from octray.cli.exits import Exit

if TYPE_CHECKING:
    from collections.abc import Callable

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"


class _Check(NamedTuple):
    name: str
    good: bool
    detail: str


def _versions() -> str:
    from octray import __version__

    parts = [f"octray {__version__}", f"Python {platform.python_version()}"]
    parts += [f"{name} {importlib.metadata.version(name)}" for name in ("numpy", "click")]
    return ", ".join(parts)


def _system() -> str:
    from octray._core import cpu_features, default_threads

    features = ", ".join(cpu_features()) or "no special instructions"
    return (
        f"{platform.system()} {platform.machine()}, {default_threads()} threads by default,"
        f" processor with {features}"
    )


def _numpy() -> str:
    import numpy as np

    import octray

    scene = octray.Scene()
    scene.add(octray.sphere(2))
    hits = scene.cast_rays(np.array([[0.0, 0.0, 10.0, 0.0, 0.0, -1.0], [9, 9, 9, 0, 0, 1]]))
    found = hits.t.tolist()
    if found != [8.0, float("inf")]:
        raise RuntimeError(f"a ray to a sphere should meet it at 8 and another not: {found}")
    return "arrays go in and out, a ray meets a sphere where it should"


def _write() -> str:
    folder = Path.cwd()
    with tempfile.TemporaryFile(dir=folder):
        return f"{folder} can be written to"


def _render() -> str:
    import octray

    scene = octray.Scene()
    scene.add(octray.sphere(2) - octray.box(2), material="#b8c4d0")
    scene.add(octray.box((8, 8, 1)).translate(z=-2.5), material="#445566")
    size = (48, 32)
    pictures = [
        scene.render(size=size),
        scene.render(size=size, threads=1),
        scene.render(size=size, threads=1, accel="brute"),
    ]
    if not all(picture.equals(pictures[0]) for picture in pictures):
        raise RuntimeError("the picture depends on threads or accelerator")
    if not pictures[0].to_bytes("png").startswith(PNG_SIGNATURE):
        raise RuntimeError("the PNG is none")
    return "a small scene has the same bits by octree and brute force, with 1 and with all threads"


def _run(name: str, check: Callable[[], str]) -> _Check:
    try:
        return _Check(name, good=True, detail=check())
    except Exception as error:  # noqa: BLE001 - whatever it is, it is the finding
        return _Check(name, good=False, detail=f"{type(error).__name__}: {error}")


@click.command("doctor", epilog="Example: octray doctor --json")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(as_json: bool) -> int:
    """Check versions, processor, write access, and render a tiny scene."""
    checks = [
        _run(name, check)
        for name, check in (
            ("versions", _versions),
            ("system", _system),
            ("arrays", _numpy),
            ("rendering", _render),
            ("directory", _write),
        )
    ]
    good = all(check.good for check in checks)
    if as_json:
        report: dict[str, Any] = {
            "good": good,
            "python": sys.executable,
            "processors": os.cpu_count(),
            "checks": [check._asdict() for check in checks],
        }
        click.echo(json.dumps(report, indent=2))
    else:
        for check in checks:
            click.echo(f"{'ok  ' if check.good else 'FAIL'}  {check.name}: {check.detail}")
        click.echo("all is well" if good else "something is wrong")
    return Exit.OK if good else Exit.FAILED
