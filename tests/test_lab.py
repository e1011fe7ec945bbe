"""``octray lab``: figures of many methods, and what happens when one of them cannot."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from html.parser import HTMLParser
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import octray
from conftest import COMMAND, ROOT, blocks
from examples import run_python
from json_page import check_against_page
from octray import lab
from octray.lab import selection
from octray.lab.pictures import different_pixels
from octray.lab.process import WorkerProcess
from octray.lab.result import Combination, Status
from octray.lab.session import Session

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Octray

HELLO = ROOT / "scenes" / "hello" / "hello.pov"
COUPLING = ROOT / "scenes" / "coupling" / "coupling.csg"
SMALL = ("--size", "32x24", "--progress", "none")
PAGE = ROOT / "docs" / "lab.md"
SCHEMA = ROOT / "docs" / "lab-json.md"


def rows(table: str) -> dict[str, list[str]]:
    """The table by method."""
    lines = table.split("\n\n", maxsplit=1)[0].splitlines()[2:]
    return {line.split()[0]: line.split() for line in lines}


def test_the_default_set_has_every_choice_and_changes_one_at_a_time() -> None:
    names = octray.methods()
    chosen = selection.one_change_at_a_time(names)
    words = {(place, word) for name in names for place, word in enumerate(name.split(":"))}
    assert {(p, w) for name in chosen for p, w in enumerate(name.split(":"))} == words
    assert {"auto", "brute", "grid", "spheres", "boxes"} <= set(chosen)
    assert len(chosen) < len(names)
    base = next(name for name in names if name.startswith("octree")).split(":")
    for name in chosen:
        if name.startswith("octree"):
            changed = sum(a != b for a, b in zip(base, name.split(":"), strict=True))
            # A hash table cannot be walked in order: there the traversal changes with it.
            assert changed <= (2 if "lvsi" in name else 1), name


def test_brute_force_is_left_out_of_large_scenes_with_a_word() -> None:
    names = octray.methods()
    few, silent = selection.select(names, [], everything=True, primitives=2000)
    assert (few, silent) == (names, None)
    many, word = selection.select(names, [], everything=True, primitives=2001)
    assert many == [name for name in names if name != "brute"]
    assert word is not None
    assert "brute is left out" in word
    named, silent = selection.select(names, ["brute"], everything=False, primitives=10**9)
    assert (named, silent) == (["brute"], None)


def test_the_table_has_every_method_with_the_same_picture(octray_command: Octray) -> None:
    done = octray_command("lab", COUPLING, *SMALL, "--repeat", 1)
    assert done.returncode == 0, done.stderr
    table = rows(done.stdout)
    assert list(table) == selection.one_change_at_a_time(octray.methods())
    assert {row[-1] for row in table.values()} == {"same"}
    assert "compared with that of brute" in done.stdout
    build, memory, cells = table["brute"][1:4]
    assert float(build) > 0
    assert float(memory) < float(table["auto"][2])
    assert cells == "-"
    assert float(table["brute"][6]) > float(table["auto"][6]), "tests per ray"
    assert done.stderr == ""


def test_the_json_is_alone_and_as_documented(octray_command: Octray) -> None:
    methods = ("--accel", "auto", "--accel", "brute", "--accel", "octree:lvsi:sung")
    done = octray_command("lab", COUPLING, *SMALL, *methods, "--repeat", 2, "--json", "-j", 2)
    assert done.returncode == 0, done.stderr
    report: dict[str, Any] = json.loads(done.stdout)
    check_against_page(report, SCHEMA)
    assert report["format"] == 1
    assert report["reference"] == "brute"
    assert report["scene"]["objects"] == len(octray.load(COUPLING))
    assert report["options"]["size"] == [32, 24]
    auto, brute, sung = report["combinations"]
    assert sung["method"] == "octree:lvsi:sung:analytic"
    assert sung["per_ray"]["lookups"] > 0
    # Without an accelerator there is nothing to visit; expressions are there, whole.
    assert (brute["nodes"], brute["depth_histogram"], brute["lvsi"]) == (None, None, None)
    parts = brute["memory"]["parts"]
    assert parts["cells"] == 0
    assert brute["memory"]["structure_bytes"] == parts["contents"] + parts["expressions"] > 0
    for tree in (auto, sung):
        leaves = tree["nodes"]["empty"] + tree["nodes"]["occupied"]
        assert sum(empty + full for _, empty, full in tree["depth_histogram"]) == leaves
        assert sum(count for _, count in tree["objects_per_leaf"]) == tree["nodes"]["occupied"]
    assert (auto["lvsi"], sung["lvsi"]["leaves"]) == (None, sung["nodes"]["occupied"])
    for combination in report["combinations"]:
        assert len(combination["render"]["times_s"]) == 2
        assert combination["rays"] == auto["rays"], "the same picture from the same rays"
        assert combination["picture"] == {
            "sha256": auto["picture"]["sha256"],
            "same": True,
            "different_pixels": 0,
        }
        # Kinds of ray make up the whole.
        for what in ("surfaces", "cells", "lookups"):
            kinds = combination["per_ray_by_kind"].values()
            whole = combination["per_ray"][what] * combination["rays"]["total"]
            assert sum(kind[what] * kind["rays"] for kind in kinds) == pytest.approx(whole)
    direct = octray.load(COUPLING).render(size=(32, 24), accel="brute")
    assert brute["per_ray"] == pytest.approx(direct.report["tests_per_ray"])


def test_triangles_of_meshes_have_cells_too(cube: Path) -> None:
    methods = ["auto", "brute", "octree", "octree:tree:ordered:bounding-box", "grid:4"]
    report = lab.run(cube, accel=methods, size=(32, 24), repeat=1, drawings=True)
    check_against_page(json.loads(report.to_json()), SCHEMA)
    auto, brute, octree, boxes, grid = (c.to_dict() for c in report.combinations)
    assert auto["nodes"] == {"wide": 1}
    assert (brute["nodes"], brute["triangle_cube_steps"]) == (None, None)
    leaves = sum(count for _, count in octree["objects_per_leaf"])
    assert octree["nodes"]["occupied"] == leaves > 1
    for entry in (octree, grid):
        decided = sum(entry["triangle_cube_steps"].values())
        assert decided == entry["marks"]["questions"]
        listed = sum(number * leaves for number, leaves in entry["objects_per_leaf"])
        assert listed == entry["marks"]["references"] > 0
        assert entry["memory"]["parts"]["triangle_cells"] > 0
    assert sum(boxes["triangle_cube_steps"].values()) == 0
    assert grid["nodes"]["empty"] + grid["nodes"]["occupied"] == 4**3
    assert len(report.drawings.cells["grid:4"]["depth"]) == 4**3


def test_what_is_no_method_is_refused_before_anything_runs(octray_command: Octray) -> None:
    done = octray_command("lab", "absent.pov", "--accel", "auto", "--accel", "octree:hash")
    assert done.returncode == 2
    assert "`octree:hash` is no method" in " ".join(done.stderr.split())
    with pytest.raises(ValueError, match="is no method"):
        lab.run("absent.pov", accel=["fast"])
    for wrong in ({"repeat": 0}, {"budget": 0.0}, {"timeout": -1.0}, {"memory": 0}):
        with pytest.raises(ValueError, match="must be greater than 0"):
            lab.run("absent.pov", **wrong)
    assert octray_command("lab", "absent.pov").returncode == 3


def test_the_budget_cuts_off_what_it_lists(octray_command: Octray) -> None:
    start = time.monotonic()
    done = octray_command("lab", HELLO, *SMALL, "--budget", 0.01, "--accel", "auto", "--json")
    assert time.monotonic() - start < 60
    assert done.returncode == 4
    report = json.loads(done.stdout)
    check_against_page(report, SCHEMA)
    assert report["cut_off"] == ["auto"]
    assert report["combinations"][0]["status"] == "cut off by the budget"
    assert report["combinations"][0]["render"]["median_s"] is None
    shown = octray_command("lab", HELLO, *SMALL, "--budget", 0.01, "--accel", "auto")
    assert "The budget cut off: auto." in shown.stdout
    assert rows(shown.stdout)["auto"][1:4] == ["-", "-", "-"]


def test_one_that_takes_too_long_does_not_hold_up_the_rest() -> None:
    # Three hundred million samples: only the time limit ends it. Building is quick.
    report = lab.run(HELLO, accel=["brute"], size=(1280, 720), spp=400, timeout=1.5, repeat=2)
    (brute,) = report.combinations
    assert brute.status is Status.OUT_OF_TIME
    assert brute.message is not None
    assert "not done after 1.5" in brute.message
    assert brute.build is not None
    assert brute.render is None
    assert report.reference is None
    assert "out of time" in lab.table(report)


@pytest.mark.skipif(sys.platform != "linux", reason="memory is limited on Linux only")
def test_one_that_needs_too_much_memory_is_reported_as_such(tmp_path: Path) -> None:
    # Many triangles: their tree alone takes far more than 1 MiB.
    side = np.arange(260)
    x, y = (grid.ravel() for grid in np.meshgrid(side, side))
    at = (side[:-1, None] * 260 + side[None, :-1]).ravel()
    faces = np.concatenate([[at, at + 1, at + 261], [at, at + 261, at + 260]], axis=1).T
    path = tmp_path / "sheet.obj"
    lines = [f"v {a} {b} {(a * b) % 7}" for a, b in zip(x, y, strict=True)]
    lines += [f"f {a} {b} {c}" for a, b, c in faces + 1]
    path.write_text("\n".join(lines), encoding="ascii")
    report = lab.run(path, accel=["auto"], size=(32, 24), repeat=1, memory=1 << 20)
    (auto,) = report.combinations
    assert auto.status is Status.OUT_OF_MEMORY, auto
    assert report.missing == [auto]
    plenty = lab.run(path, accel=["auto"], size=(32, 24), repeat=1, memory=2000 << 20)
    assert plenty.combinations[0].status is Status.DONE, plenty.combinations[0].message


def test_a_worker_that_dies_is_reported_and_the_rest_goes_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    repeat = Session.repeat

    def kill_boxes(self: Session, member: Any, *, build_again: bool) -> None:
        if member.combination.method == "boxes" and build_again:
            os.kill(member.worker.pid, signal.SIGKILL)
        repeat(self, member, build_again=build_again)

    monkeypatch.setattr(Session, "repeat", kill_boxes)
    report = lab.run(HELLO, accel=["boxes", "auto", "brute"], size=(32, 24), repeat=2)
    boxes, auto, brute = report.combinations
    assert boxes.status is Status.FAILED
    assert boxes.message is not None
    assert "SIGKILL" in boxes.message
    assert (len(boxes.render_s), boxes.same) == (1, True), "what was done stays"
    assert auto.status is brute.status is Status.DONE
    assert len(auto.render_s) == len(brute.render_s) == 2


def test_methods_that_do_not_fit_together_run_in_groups_beside_a_yardstick(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # A worker holds some 40 MB: two of them fit.
    monkeypatch.setattr("octray.lab.session.available_bytes", lambda: 130 << 20)
    methods = ["auto", "brute", "boxes", "grid"]
    report = lab.run(HELLO, accel=methods, size=(32, 24), repeat=1)
    assert len(report.groups) > 1
    assert [name for group in report.groups for name in group.methods] == methods
    assert all(len(group.yardstick_s) == 1 for group in report.groups)
    assert any("groups" in note for note in report.notes)
    for group in report.groups:
        for combination in report.combinations:
            if combination.method in group.methods:
                assert combination.status is Status.DONE
                (seconds,) = combination.render_s
                assert combination.relative == pytest.approx(seconds / group.yardstick_s[0])
    # Even where nothing fits, each runs, alone with its yardstick.
    monkeypatch.setattr("octray.lab.session.available_bytes", lambda: 0)
    tight = lab.run(HELLO, accel=["boxes", "auto"], size=(32, 24), repeat=1)
    assert [group.methods for group in tight.groups] == [["auto"], ["boxes"]]
    assert all(c.same for c in tight.combinations)


def test_a_worker_that_is_asked_for_the_impossible_answers_so() -> None:
    worker = WorkerProcess()
    try:
        with pytest.raises(lab.process.WorkerError, match="absent"):
            worker.ask(
                "load",
                60,
                path="absent.pov",
                accel="auto",
                threads=1,
                facets=False,
                viewall=False,
                memory=None,
            )
    finally:
        worker.close()


def test_a_picture_that_differs_is_an_alarm(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from octray.cli.command import run  # noqa: PLC0415 - only here without a process

    receive = Session.receive

    def forge(self: Session, member: Any, **how: Any) -> dict[str, Any] | None:
        answer = receive(self, member, **how)
        if answer and "picture" in answer and member.combination.method == "grid":
            pixels = np.load(self.folder / f"{answer['picture']}.npy")
            pixels[3, 5, 1] = np.nextafter(pixels[3, 5, 1], 2)
            np.save(self.folder / "forged.npy", pixels)
            answer["picture"] = "forged"
        return answer

    monkeypatch.setattr(Session, "receive", forge)
    monkeypatch.chdir(tmp_path)
    code = run(["lab", str(HELLO), *SMALL, "--accel", "grid", "--accel", "brute", "--repeat", "1"])
    assert code == 1
    assert "DIFFERS in 1" in capsys.readouterr().out


def test_pixels_are_compared_by_their_bits() -> None:
    one = np.zeros((2, 3, 3), np.float32)
    other = one.copy()
    assert different_pixels(one, other) == 0
    other[0, 0] = -0.0
    other[1, 2, 0] = np.nan
    assert different_pixels(one, other) == 2
    assert different_pixels(other, other) == 0
    assert different_pixels(one, one[:1]) == 6


@pytest.mark.skipif(sys.platform == "win32", reason="no process groups there")
def test_an_interruption_keeps_what_is_done(tmp_path: Path) -> None:
    # Ctrl-C reaches all processes of the terminal's group, here while one renders again and again.
    code = f"""if True:
        import os, signal, sys
        from octray.cli.command import run
        from octray.lab.session import Session

        repeat = Session.repeat

        def repeat_and_interrupt(self, member, *, build_again):
            repeat(self, member, build_again=build_again)
            if len(member.combination.render_s) == 3:
                os.killpg(0, signal.SIGINT)

        Session.repeat = repeat_and_interrupt
        methods = ["--accel", "auto", "--accel", "grid", "--repeat", "100"]
        sys.exit(run(["lab", {str(HELLO)!r}, *{SMALL!r}, *methods, "--json"]))
    """
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        start_new_session=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 130, done.stderr
    report = json.loads(done.stdout)
    assert report["interrupted"]
    auto, grid = report["combinations"]
    assert auto["status"] == grid["status"] == "interrupted"
    assert (len(auto["render"]["times_s"]), len(grid["render"]["times_s"])) == (3, 2)
    assert auto["message"] == "3 of 100 repetitions were done"
    assert auto["picture"]["same"]
    assert grid["picture"]["same"]


class Loads(HTMLParser):
    """Collects every address that a page makes a browser load, and counts its elements."""

    def __init__(self) -> None:
        super().__init__()
        self.loads: list[str] = []
        self.tags: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            if name in {"src", "href", "xlink:href", "srcset", "data", "poster"}:
                self.loads.append(value or "")


def test_the_report_is_one_page_that_needs_nothing_else(
    octray_command: Octray, tmp_path: Path
) -> None:
    pytest.importorskip("matplotlib")
    methods = [f"--accel={name}" for name in ("auto", "brute", "octree:lvsi-empty", "grid")]
    done = octray_command("lab", COUPLING, *SMALL, *methods, "--repeat", 1, "-o", "out")
    assert done.returncode == 0, done.stderr
    assert "the report is out/index.html" in done.stderr.replace(os.sep, "/")
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["index.html"]
    text = (tmp_path / "out" / "index.html").read_text(encoding="utf-8")
    page = Loads()
    page.feed(text)
    assert page.loads
    assert all(load.startswith(("data:image/png;base64,", "#")) for load in page.loads)
    assert not re.search(r"url\((?!#|['\"]?#)", text)
    assert "@import" not in text
    assert "script" not in page.tags
    assert page.tags.count("svg") >= 4
    assert page.tags.count("img") >= 2
    for name in ("auto", "brute", "octree:lvsi-empty:sung:analytic", "grid"):
        assert f">{name}</th>" in text
    assert text.count("<figcaption>") == page.tags.count("figure") >= 6


def test_a_page_can_be_written_of_nothing(tmp_path: Path) -> None:
    html = pytest.importorskip("octray.lab.html", exc_type=ImportError)
    report = lab.run(HELLO, accel=["auto"], budget=1e-6, drawings=True)
    path = html.write(report, tmp_path / "a" / "b")
    assert "cut off by the budget" in path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["--slice", "w=1", "-o", "x"], 2, "is not a plane"),
        (["--slice", "z=nan", "-o", "x"], 2, "is not a plane"),
        (["--slice", "z=0.3"], 2, "needs -o"),
        (["-o", "there"], 1, "is not a directory"),
        (["-o", "no/such/place"], 1, "there is no directory"),
    ],
)
def test_a_report_that_cannot_be_is_refused_at_once(
    arguments: list[str], code: int, words: str, octray_command: Octray, tmp_path: Path
) -> None:
    (tmp_path / "there").write_text("a file", encoding="utf-8")
    done = octray_command("lab", "absent.pov", *arguments)
    assert done.returncode == code
    assert words in " ".join(done.stderr.split())


def test_without_matplotlib_a_report_is_refused_at_once(octray_command: Octray) -> None:
    code = """if True:
        import sys, importlib.util
        find = importlib.util.find_spec
        importlib.util.find_spec = lambda name, *more: (
            None if name == "matplotlib" else find(name, *more))
        from octray.cli.command import run
        sys.exit(run(["lab", "absent.pov", "-o", "x"]))
    """
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "pip install 'octray[lab]'" in done.stderr
    del octray_command


def test_render_does_not_load_the_lab() -> None:
    code = f"""if True:
        import sys
        from octray.cli.command import run
        run(["render", {str(HELLO)!r}, "--size", "8x6", "-o", {os.devnull!r} + ".png", "-q"])
        print([name for name in sys.modules if "lab" in name.split(".") or "matplotlib" in name])
    """
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout == "[]\n"


def test_relative_times_and_spreads_are_those_of_their_numbers() -> None:
    combination = Combination("grid", build_s=[3.0, 1.0, 2.0], render_s=[5.0, 1.0, 2.0, 4.0])
    assert combination.build == 2.0
    assert combination.render == 3.0
    assert combination.spread == 2.0
    nothing = Combination("grid")
    assert (nothing.build, nothing.render, nothing.spread) == (None, None, None)


def test_the_examples_of_the_page_do_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    monkeypatch.chdir(tmp_path)
    compared = run_python(PAGE)
    assert len(compared) == 3
    for printed, claim in compared:
        assert printed == claim
    pytest.importorskip("matplotlib")
    commands = [line for block in blocks(PAGE.read_text(), "sh") for line in block.splitlines()]
    assert len(commands) == 2
    program, *arguments = shlex.split(commands[1])
    assert program == "octray"
    # The second does all that the first does.
    done = subprocess.run(
        [*COMMAND, *arguments, "--repeat", "1"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "coupling-lab" / "index.html").exists()


def test_numbers_are_short_and_have_no_exponent() -> None:
    from octray._table import number  # noqa: PLC0415 - only here
    from octray.lab.table import count  # noqa: PLC0415 - only here

    assert [count(n) for n in (None, 0, 9_000, 12_345, 999_900, 1_346_000, 2_100_000_000)] == [
        *("-", "0", "9000", "12.3k", "1M", "1.35M", "2100M")
    ]
    assert [number(x) for x in (None, 0.0, 1234.5, 12.345, 0.000012)] == [
        *("-", "0", "1234", "12.3", "0.000012")
    ]


def test_marks_of_solids_are_counted_against_the_analytic_test() -> None:
    methods = ["octree", "octree:tree:ordered:bounding-sphere", "octree:tree:ordered:shells"]
    report = lab.run(COUPLING, accel=methods, size=(16, 12), repeat=1)
    check_against_page(json.loads(report.to_json()), SCHEMA)
    analytic, sphere, shells = report.to_dict()["combinations"]
    for entry in (sphere, shells):
        found = entry["membership"]
        direct = octray.load(COUPLING).stats(accel=entry["method"])["trees"]["membership"]
        assert found["marks"] == direct["marks"] > 0
        if analytic["membership"] is None:
            assert found["in_vain"] is None
        else:
            assert found["in_vain"] == found["marks"] - analytic["membership"]["marks"]
    assert shells["membership"]["pieces"] > sphere["membership"]["pieces"]
    assert sum(shells["membership"]["steps"].values()) > 0
