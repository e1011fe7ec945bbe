"""The examples in docs/structures.md print what the page says, and its keys are those there are."""

from __future__ import annotations

import re
from pathlib import Path

import octray
from examples import run_python

PAGE = Path(__file__).resolve().parent.parent / "docs" / "structures.md"


def test_the_examples_print_what_the_page_says() -> None:
    compared = run_python(PAGE)
    assert len(compared) == 7
    for printed, claim in compared:
        assert printed == claim


def test_every_key_is_explained() -> None:
    scene = octray.Scene()
    scene.add(octray.sphere(1))
    stats = scene.stats(accel="octree:lvsi")
    explained = set(re.findall(r"[`.]([a-z_]+)`", PAGE.read_text(encoding="utf-8")))
    cells = stats["trees"]["cells"]
    for keys in (stats, stats["trees"], cells, cells["lvsi"], stats["memory"], stats["world"]):
        assert set(keys) - explained <= {"trees"}
