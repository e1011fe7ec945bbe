"""Lists of cells: written, read again, edited by hand, and taken from another scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import octray
from conftest import ROOT

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Octray

COUPLING = ROOT / "scenes" / "coupling" / "coupling.csg"
OCTREES = ("octree", "octree:lvsi", "octree:lvsi-empty")


@pytest.fixture
def cells(tmp_path: Path) -> Path:
    """The coupling's cells, by the tree."""
    path = tmp_path / "coupling.cells"
    octray.load(COUPLING).dump_cells(path)
    return path


def render(scene: octray.Scene, method: str) -> bytes:
    """Give the picture's numbers."""
    return scene.render(size=(48, 36), accel=method).to_numpy().tobytes()


@pytest.mark.parametrize("method", OCTREES)
def test_a_list_gives_the_same_cells_and_the_same_picture(method: str, tmp_path: Path) -> None:
    path, again = tmp_path / "first", tmp_path / "again"
    scene = octray.load(COUPLING)
    oracle = render(scene, "brute")
    scene.dump_cells(path, accel=method)
    other = octray.load(COUPLING)
    other.prepare(accel=method, cells=path)
    assert render(other, method) == oracle
    other.dump_cells(again, accel=method)
    assert again.read_text(encoding="utf-8") == path.read_text(encoding="utf-8")


@pytest.mark.parametrize("method", OCTREES)
def test_the_list_decides_what_is_built(method: str, cells: Path) -> None:
    scene = octray.load(COUPLING)
    scene.prepare(accel=method, cells=cells)
    found = scene.cells(accel=method)
    occupied = {
        tuple(key) for key, kind in zip(found.key, found.kind, strict=True) if kind == "occupied"
    }
    listed = {
        tuple(int(n) for n in key.replace(":", ",").replace("(", "").replace(")", "").split(","))
        for key, *operands in map(str.split, cells.read_text(encoding="utf-8").splitlines()[1:])
        if operands
    }
    assert occupied == listed
    assert len(listed) > 20


def test_what_is_there_is_replaced_whole(cells: Path, tmp_path: Path) -> None:
    whole = cells.read_bytes()
    link = tmp_path / "link"
    old = tmp_path / "old"
    old.write_text("something else", encoding="utf-8")
    link.symlink_to(old)
    octray.load(COUPLING).dump_cells(link)
    assert link.is_symlink()
    assert old.read_bytes() == whole
    assert sorted(path.name for path in tmp_path.iterdir()) == ["coupling.cells", "link", "old"]


@pytest.mark.parametrize(
    ("line", "text"),
    [
        (1, "cells of mine"),
        (1, ""),
        (3, "nonsense"),
        (3, "4:(99,3,3) 0"),
        (3, "40:(0,0,0) 0"),
        (3, "4:(5,3,3) 99"),
        (3, "4:(5,3,3) 2 1"),
        (3, "4:(5,3,3) -1"),
        (3, "4:(4,3,3) 0"),
        (3, "0:(0,0,0) 0"),
    ],
)
def test_a_wrong_line_is_named(line: int, text: str, cells: Path) -> None:
    lines = cells.read_text(encoding="utf-8").splitlines()
    lines[line - 1] = text
    cells.write_text("\n".join(lines) + "\n", encoding="utf-8")
    with pytest.raises(ValueError, match=rf"coupling\.cells: line {line} of the list of cells"):
        octray.load(COUPLING).prepare(accel="octree", cells=cells)


def test_lists_of_other_scenes_and_other_files_are_refused(cells: Path, tmp_path: Path) -> None:
    ball = octray.Scene()
    ball.add(octray.sphere(1))
    with pytest.raises(ValueError, match=r"coupling\.cells: .* of another scene"):
        ball.prepare(accel="octree", cells=cells)
    cells.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match="UTF-8"):
        ball.prepare(accel="octree", cells=cells)
    with pytest.raises(FileNotFoundError, match="absent"):
        ball.prepare(accel="octree", cells=tmp_path / "absent")
    with pytest.raises(FileNotFoundError, match="nowhere"):
        ball.dump_cells(tmp_path / "nowhere" / "cells")


@pytest.mark.parametrize("method", ["brute", "boxes", "grid:4"])
def test_methods_without_an_octree_have_no_list(method: str, cells: Path) -> None:
    scene = octray.load(COUPLING)
    with pytest.raises(ValueError, match="no octree"):
        scene.dump_cells(cells.with_name("none"), accel=method)
    with pytest.raises(ValueError, match=r"coupling\.cells: .* no octree"):
        scene.prepare(accel=method, cells=cells)
    assert not cells.with_name("none").exists()


def test_the_command_line_writes_and_reads_lists(octray_command: Octray, tmp_path: Path) -> None:
    def render(name: str, *options: str) -> bytes:
        done = octray_command("render", COUPLING, "-o", name, "--size", "48x36", *options)
        assert done.returncode == 0, done.stderr
        return (tmp_path / name).read_bytes()

    first = render("a.png", "--accel", "octree", "--dump-cells", "cells")
    for number, method in enumerate(OCTREES):
        assert render(f"{number}.png", "--accel", method, "--load-cells", "cells") == first
    (tmp_path / "wrong").write_text("octray-cells 9\n", encoding="utf-8")
    for options, code, words in (
        (["--load-cells", "wrong"], 2, "wrong: line 1"),
        (["--load-cells", "absent"], 1, "absent: No such file"),
        (["--dump-cells", "nowhere/cells"], 1, "nowhere/cells: No such file"),
        (["--accel", "brute", "--dump-cells", "none"], 2, "makes no octree"),
    ):
        given = options if "--accel" in options else ["--accel", "octree", *options]
        done = octray_command("render", COUPLING, "-o", "x.png", "--size", "48x36", *given)
        assert done.returncode == code
        assert words in " ".join(done.stderr.split())
        assert "Traceback" not in done.stderr
        assert not (tmp_path / "x.png").exists()
