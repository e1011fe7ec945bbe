"""``octray query``: what is in its files, in what order, and what it refuses."""

from __future__ import annotations

import json
import math
import signal
import subprocess
import sys
import time
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import octray
from conftest import COMMAND

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt

    from conftest import Octray

#: Two bars along x, one inside the other's end, and a hole.
SCENE = """\
difference() {
  cube(size = [4, 2, 2], center = true);
  cylinder(h = 3, r = 0.5, center = true, $fn = 0);
}
multmatrix([[1,0,0,3],[0,1,0,0],[0,0,1,0],[0,0,0,1]]) { sphere(r = 2, $fn = 0); }
"""


@pytest.fixture
def part(tmp_path: Path) -> Path:
    path = tmp_path / "part.csg"
    path.write_text(SCENE)
    return path


def some_rays(count: int) -> npt.NDArray[np.float64]:
    rng = np.random.default_rng(11)
    rays = np.concatenate([rng.uniform(-6, 6, (count, 3)), rng.normal(size=(count, 3))], axis=1)
    rays[1] = [-9, 0, 0, 1, 0, 0]
    rays[2] = [0, 0, 0.5, 0, 0, 0]
    rays[3, 4] = math.nan
    return rays


def files(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def read(path: Path) -> dict[str, npt.NDArray[Any]]:
    with np.load(path, allow_pickle=False) as archive:
        return dict(archive)


def test_archives_hold_what_python_gets(octray_command: Octray, part: Path) -> None:
    folder = part.parent
    # More than one chunk, so that lists are put together.
    rays = some_rays(70_000)
    np.save(folder / "rays.npy", rays)
    scene = octray.load(part)
    for mode, *options in (
        ("first", "--normals"),
        ("all", "--normals", "--whole-line"),
        ("all", "--overlaps", "objects"),
        ("count", "--whole-line"),
        ("any",),
        ("inside",),
    ):
        done = octray_command(
            "query", "part.csg", "--rays", "rays.npy", "--mode", mode, *options, "-o", "a.npz"
        )
        assert done.returncode == 0, done.stderr
        assert done.stdout == ""
        assert "a.npz: 70000 rays in " in done.stderr
        assert "2 of them with NaN" in done.stderr
        found = read(folder / "a.npz")
        whole = "--whole-line" in options
        expected: dict[str, npt.NDArray[Any]]
        if mode == "first":
            hits = scene.cast_rays(rays)
            expected = {
                "t": hits.t,
                "object_id": hits.object_id,
                "face_id": hits.face_id,
                "normal": hits.normal,
            }
        elif mode == "all":
            overlaps: Any = "objects" if "objects" in options else "regions"
            lists = scene.list_intersections(rays, whole_line=whole, overlaps=overlaps)
            names = ["offsets", "t_enter", "t_exit", "object_id", "material_id"]
            names += ["face_enter", "face_exit"]
            if "--normals" in options:
                names += ["normal_enter", "normal_exit"]
            expected = {name: getattr(lists, name) for name in names}
            assert found.pop("material_names").tolist() == scene.material_names
        elif mode == "count":
            expected = {"count": scene.count_intersections(rays, whole_line=True)}
        elif mode == "any":
            expected = {"any": scene.test_occlusions(rays)}
        else:
            located = scene.locate(rays[:, :3])
            expected = {"inside": located >= 0, "object_id": located}
        if mode not in {"count", "any"}:
            assert found.pop("object_names").tolist() == scene.names
        assert list(found) == list(expected)
        for name, array in expected.items():
            assert found[name].dtype == array.dtype, name
            np.testing.assert_array_equal(found[name], array, err_msg=name)
    assert files(folder) == ["a.npz", "part.csg", "rays.npy"]


def test_lines_hold_one_object_for_each_ray(octray_command: Octray, part: Path) -> None:
    folder = part.parent
    rays = np.array(
        [[-9.0, 0.9, 0, 2, 0, 0], [0, 0, 0, 0, 0, 1], [3, 0, 0, 1, 0, 0], [0, 0, 0, 0, 0, 0]]
    )
    np.save(folder / "rays.npy", rays)

    def ask(*options: str) -> list[dict[str, Any]]:
        done = octray_command("query", "part.csg", "--rays", "rays.npy", *options)
        assert done.returncode == 0, done.stderr
        return [json.loads(line) for line in done.stdout.splitlines()]

    every = ask("--mode", "all", "-q")
    assert [answer["ray"] for answer in every] == [0, 1, 2, 3]
    bar, ball = every[0]["intervals"]
    assert (bar["t_enter"], bar["object_id"], ball["object_id"]) == (3.5, 0, 1)
    # The bar is the smaller solid and has what both hold, up to its end at x = 2.
    assert bar["t_exit"] == ball["t_enter"] == 5.5
    assert ball["t_exit"] == pytest.approx((12 + math.sqrt(4 - 0.81)) / 2)
    assert every[1]["intervals"] == []
    inside = every[2]["intervals"]
    assert (inside[0]["t_enter"], inside[0]["face_enter"], inside[0]["t_exit"]) == (0.0, -1, 2.0)
    assert every[3]["intervals"] == []
    first = ask("--mode", "first", "--normals")
    assert first[0]["t"] == 3.5
    assert first[0]["normal"] == [-1, 0, 0]
    assert first[1] == {
        "ray": 1,
        "t": None,
        "object_id": -1,
        "face_id": -1,
        "normal": [None] * 3,
    }
    assert [answer["count"] for answer in ask("--mode", "count")] == [4, 0, 1, 0]
    assert [answer["any"] for answer in ask("--mode", "any")] == [True, False, True, False]
    assert ask("--mode", "inside")[2] == {"ray": 2, "inside": True, "object_id": 1}


def test_a_floor_without_end_is_null(octray_command: Octray, tmp_path: Path) -> None:
    (tmp_path / "floor.pov").write_text("plane { y, 0 pigment { color rgb 1 } }\n")
    np.save(tmp_path / "rays.npy", np.array([[0.0, 1, 0, 0, -1, 0], [0, 1, 0, 0, 1, 0]]))
    done = octray_command(
        "query", "floor.pov", "--rays", "rays.npy", "--mode=all", "--whole-line", "-o", "a.jsonl"
    )
    assert done.returncode == 0, done.stderr
    lines = (tmp_path / "a.jsonl").read_text().splitlines()
    ends = [
        (interval["t_enter"], interval["t_exit"])
        for line in lines
        for interval in json.loads(line)["intervals"]
    ]
    assert ends == [(1.0, None), (None, -1.0)]


def test_points_and_empty_arrays(octray_command: Octray, part: Path) -> None:
    np.save(part.parent / "points.npy", np.array([[3, 0, 0], [-1.5, 0, 0], [0, 0, 0]], np.float32))
    done = octray_command(
        "query", "part.csg", "--points", "points.npy", "--mode", "inside", "-o", "a.npz"
    )
    assert done.returncode == 0, done.stderr
    assert read(part.parent / "a.npz")["object_id"].tolist() == [1, 0, -1]
    np.save(part.parent / "none.npy", np.empty((0, 6)))
    for mode in ("first", "all", "count", "any", "inside"):
        done = octray_command(
            "query", "part.csg", "--rays", "none.npy", "--mode", mode, "-o", "a.npz"
        )
        assert done.returncode == 0, done.stderr
        found = read(part.parent / "a.npz")
        assert found.pop("offsets", np.zeros(1)).tolist() == [0]
        assert all(len(a) == 0 for name, a in found.items() if not name.endswith("_names"))
        lines = octray_command("query", "part.csg", "--rays", "none.npy", "--mode", mode)
        assert (lines.returncode, lines.stdout) == (0, "")


def test_threads_and_accelerator_do_not_change_a_byte(octray_command: Octray, part: Path) -> None:
    np.save(part.parent / "rays.npy", some_rays(3000))
    written = set()
    for options in (["-j1"], ["-j3"], ["--accel=brute", "-j2"]):
        done = octray_command(
            *("query", "part.csg", "--rays", "rays.npy", "--mode=all", "--normals"),
            *(*options, "-o", "a.npz"),
        )
        assert done.returncode == 0, done.stderr
        written.add((part.parent / "a.npz").read_bytes())
    assert len(written) == 1


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        ([], 2, "needs --rays"),
        (["--mode", "inside"], 2, "either --rays or --points"),
        (["--rays", "rays.npy", "--points", "rays.npy", "--mode=inside"], 2, "either"),
        (["--points", "rays.npy"], 2, "--points goes with --mode inside, not first"),
        (["--rays", "rays.npy", "--whole-line"], 2, "--whole-line goes with --mode all or count"),
        (["--rays", "rays.npy", "--mode=any", "--normals"], 2, "--normals goes with"),
        (["--rays", "rays.npy", "--overlaps=objects"], 2, "--overlaps goes with --mode all"),
        (["--rays", "rays.npy", "-o", "a.csv"], 2, "must end in .npz or .jsonl"),
        (["--rays", "rays.npy", "-j", "100000"], 2, "threads must be"),
        (["--rays", "rays.npy", "--mode", "last"], 2, "last"),
        (["--rays", "rays.npy", "-o", "none/a.npz"], 1, "there is no directory none"),
        (["--rays", "none.npy"], 1, "none.npy: No such file"),
        (["--rays", "part.csg"], 1, "not an array in a .npy file"),
        (["--rays", "short.npy"], 1, "short.npy is not an array"),
        (["--rays", "empty.npy"], 1, "empty.npy is not an array"),
        (["--rays", "objects.npy"], 1, "objects.npy is not an array"),
        (["--rays", "several.npz"], 1, "several.npz holds several arrays"),
        (["--rays", "five.npy"], 1, "shape (N, 6), not shape (3, 5)"),
        (["--rays", "cube.npy"], 1, "shape (N, 6), not shape (1, 2, 6)"),
        (["--rays", "complex.npy"], 1, "not dtype complex128"),
        (["--points", "rays.npy", "--mode=inside"], 1, "points must be an array"),
    ],
)
def test_wrong_usage_and_wrong_files_are_named(
    octray_command: Octray, part: Path, arguments: list[str], code: int, message: str
) -> None:
    folder = part.parent
    np.save(folder / "rays.npy", some_rays(10))
    (folder / "short.npy").write_bytes((folder / "rays.npy").read_bytes()[:200])
    (folder / "empty.npy").write_bytes(b"")
    np.save(folder / "objects.npy", np.array([None, "a"]), allow_pickle=True)
    np.savez(folder / "several.npz", a=np.zeros(3))
    np.save(folder / "five.npy", np.zeros((3, 5)))
    np.save(folder / "cube.npy", np.zeros((1, 2, 6)))
    np.save(folder / "complex.npy", np.zeros((3, 6), complex))
    before = files(folder)
    done = octray_command("query", "part.csg", *arguments)
    assert done.returncode == code, done.stderr
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
    assert files(folder) == before


def test_a_bad_scene_is_exit_code_3(octray_command: Octray, tmp_path: Path) -> None:
    np.save(tmp_path / "rays.npy", some_rays(10))
    (tmp_path / "bad.csg").write_text("cube(size = [1, 1, 1];\n")
    done = octray_command("query", "bad.csg", "--rays", "rays.npy", "-o", "a.npz")
    assert done.returncode == 3
    assert "bad.csg:1:" in done.stderr
    assert files(tmp_path) == ["bad.csg", "rays.npy"]


def listen() -> None:
    """Make Ctrl-C count again where whoever started the tests has switched it off."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.mark.skipif(sys.platform == "win32", reason="signals are different there")
@pytest.mark.parametrize("output", ["a.npz", "a.jsonl", "-"])
def test_ctrl_c_leaves_no_half_written_file(part: Path, output: str) -> None:
    folder = part.parent
    # Far more rays than anyone waits for, in a file with a hole instead of numbers.
    rays = np.lib.format.open_memmap(
        folder / "rays.npy", mode="w+", dtype=np.float64, shape=(100_000_000, 6)
    )
    rays[:200_000] = np.tile(some_rays(1000), (200, 1))
    del rays
    with subprocess.Popen(
        [*COMMAND, "query", part.name, "--rays", "rays.npy", "--mode=all", "-o", output, "-j2"],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=listen,  # noqa: PLW1509 - no other thread runs here
    ) as run:
        if output == "-":
            assert run.stdout is not None
            assert json.loads(run.stdout.readline())["ray"] == 0
        else:
            deadline = time.monotonic() + 60
            while len(files(folder)) < 3 and time.monotonic() < deadline:
                time.sleep(0.02)
            assert len(files(folder)) == 3
        run.send_signal(signal.SIGINT)
        _, err = run.communicate(timeout=60)
    assert run.returncode == 130
    assert "Traceback" not in err
    said = "interrupted after" if output == "-" else "interrupted; nothing was written"
    assert said in err
    assert files(folder) == ["part.csg", "rays.npy"]
