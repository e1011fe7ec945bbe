"""The examples and recipes in docs/queries.md do what the page says."""

from __future__ import annotations

import contextlib
import io
import json
import math
import re
import shlex
import subprocess
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from conftest import COMMAND, ROOT, blocks

if TYPE_CHECKING:
    from pathlib import Path

PAGE = (ROOT / "docs" / "queries.md").read_text(encoding="utf-8")


def numbers(text: str) -> list[str]:
    return re.findall(r"[-\w.]+", text)


@pytest.fixture
def ran(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Every name that the page's examples have made, after what they print was compared."""
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    compared = 0
    for example in blocks(PAGE, "python"):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(example, "queries.md", "exec"), names)  # noqa: S102 - our own text
        claims = re.findall(r"^print\(.*\) +# (\[[^\]]*\]|[\d.]+)", example, re.MULTILINE)
        for line, claim in zip(printed.getvalue().splitlines(), claims, strict=False):
            assert numbers(line) == numbers(claim)
            compared += 1
    assert compared == 15
    return names


def test_the_radiograph_shows_the_hole_the_plate_and_the_ball(
    ran: dict[str, Any], tmp_path: Path
) -> None:
    header, pixels = (tmp_path / "radiograph.pgm").read_bytes().split(b"\n", 1)
    assert header == b"P5 320 240 255"
    picture = np.frombuffer(pixels, np.uint8).reshape(240, 320)
    x = np.linspace(-4.5, 4.5, 320)
    row, hole, plate, ball = 120, abs(x).argmin(), abs(x + 3).argmin(), abs(x - 2.5).argmin()
    assert picture[row, hole] == picture[0, 0] == 255
    assert picture[row, plate] == round(255 * math.exp(-0.5 * 2))
    # Through the middle of the ball: its chord in brass, the rest of the plate in steel.
    y = np.linspace(3.4, -3.4, 240)[row]
    half = math.sqrt(1 - (x[ball] - 2.5) ** 2 - y**2)
    expected = math.exp(-0.8 * 2 * half - 0.5 * (2 - half))
    assert ran["left"][row, ball] == pytest.approx(expected, rel=1e-12)


def test_the_sector_map_has_the_means_that_integrals_give(ran: dict[str, Any]) -> None:
    directions, shielding = ran["directions"], ran["shielding"]
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1, rtol=1e-12)
    np.testing.assert_allclose(directions.mean(axis=0), 0, atol=1e-3)
    assert (shielding[abs(directions[:, 2]) > 0.8] == 0).all(), "the hole"
    # Towards -y: from the hole's wall to the plate's side.
    side = (directions @ [0, -1, 0]).argmax()
    d = directions[side]
    along = math.hypot(d[0], d[1])
    assert shielding[side] == pytest.approx(7.9 * (3 / -d[1] - 1 / along), rel=1e-9)


def test_the_volumes_agree_within_their_errors(ran: dict[str, Any]) -> None:
    volume, error = ran["volume"], ran["error"]
    truth = np.array([8 * 6 * 2 - 2 * math.pi, 4 / 3 * math.pi])
    assert (error < 0.01).all()
    assert (error > 0).all()
    assert (abs(volume - truth) < 4 * error).all()


def test_the_shell_examples_succeed(tmp_path: Path) -> None:
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    rng = np.random.default_rng(1)
    np.save(tmp_path / "rays.npy", rng.normal(size=(500, 6)) * 20)
    np.save(tmp_path / "points.npy", rng.normal(size=(500, 3)) * 20)
    commands = [line for block in blocks(PAGE, "sh") for line in block.splitlines()]
    assert len(commands) == 4
    for command in commands:
        program, *arguments = shlex.split(command)
        assert program == "octray"
        done = subprocess.run(
            [*COMMAND, *arguments], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
    assert sum(json.loads(line)["inside"] for line in done.stdout.splitlines()) > 0
    with np.load(tmp_path / "chords.npz") as whole, np.load(tmp_path / "hits.npz") as hits:
        assert len(whole["t_enter"]) > 100
        assert np.isfinite(hits["t"]).sum() > 50
    assert len((tmp_path / "chords.jsonl").read_text().splitlines()) == 500
