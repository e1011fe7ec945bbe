"""The command line as its users meet it."""

from __future__ import annotations

import json
import os
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
    from typing import Literal

    from conftest import Octray

    Side = Literal["front", "right", "top", "bottom"]

SIZE = ("--size", "40x30")


def files(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_help_names_the_commands_with_an_example(octray_command: Octray) -> None:
    for arguments in ([], ["render"], ["info"], ["doctor"]):
        shown = octray_command(*arguments, "--help")
        assert shown.returncode == 0
        assert "Example: octray" in shown.stdout
        assert shown.stderr == ""
    assert octray_command("--version").stdout == f"octray {octray.__version__}\n"


def test_help_imports_nothing_heavy() -> None:
    code = """if True:
        import sys
        from octray.cli.command import run
        run(["--help"])
        print(sorted(sys.modules))
    """
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "'numpy'" not in shown.stdout


def test_a_mesh_renders_with_no_option_at_all(octray_command: Octray, cube: Path) -> None:
    done = octray_command("render", cube.name)
    assert done.returncode == 0
    assert done.stdout == ""
    picture = cube.with_name("cube.png")
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert files(cube.parent) == ["cube.obj", "cube.png"]
    assert "cube.png: 1280x720 in " in done.stderr
    assert "rays/s" in done.stderr


def test_progress_is_plain_lines_where_there_is_no_terminal(
    octray_command: Octray, cube: Path
) -> None:
    done = octray_command("render", cube.name, "--size", "900x700")
    assert "\r" not in done.stderr
    assert "\x1b" not in done.stderr
    assert "render 100%\n" in done.stderr
    quiet = octray_command("render", cube.name, *SIZE, "-q")
    assert (quiet.stdout, quiet.stderr) == ("", "")
    none = octray_command("render", cube.name, *SIZE, "--progress", "none")
    assert "render 100%" not in none.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="no pseudo-terminals there")
@pytest.mark.parametrize("plain", [False, True])
def test_progress_is_one_line_on_a_terminal(cube: Path, plain: bool) -> None:
    import pty  # noqa: PLC0415 - not everywhere

    ours, theirs = pty.openpty()
    env = {**os.environ, "TERM": "xterm"}
    env.pop("NO_COLOR", None)
    if plain:
        env["NO_COLOR"] = "1"
    arguments = ["render", cube.name, "--size", "1200x900", "--spp", "4"]
    with subprocess.Popen([*COMMAND, *arguments], cwd=cube.parent, stderr=theirs, env=env) as run:
        os.close(theirs)
        shown = b""
        while True:
            try:
                chunk = os.read(ours, 4096)
            except OSError:  # the other end is closed
                break
            if not chunk:
                break
            shown += chunk
    os.close(ours)
    assert run.returncode == 0
    assert b"\r\x1b[K" in shown
    assert (b"\x1b[36m" in shown) is not plain
    # All but the summary was taken away again.
    assert shown.rsplit(b"\x1b[K", 1)[-1].count(b"\n") == 1


def test_the_picture_can_go_to_standard_output(cube: Path) -> None:
    done = subprocess.run(
        [*COMMAND, "render", cube.name, *SIZE, "-o", "-"],
        cwd=cube.parent,
        capture_output=True,
        check=True,
    )
    assert done.stdout.startswith(b"\x89PNG")
    assert done.stdout.endswith(b"IEND\xaeB`\x82")
    assert files(cube.parent) == ["cube.obj"]
    assert b"standard output: 40x30" in done.stderr


def test_a_closed_pipe_is_quiet(cube: Path) -> None:
    command = subprocess.list2cmdline([*COMMAND, "info", cube.name, "--json"])
    done = subprocess.run(
        ["/bin/sh", "-c", f"{command} | true; {command} | head -n 1"],
        cwd=cube.parent,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == "{\n"
    assert done.stderr == ""


def test_json_is_one_object_and_alone(octray_command: Octray, cube: Path) -> None:
    done = octray_command("render", cube.name, *SIZE, "--json", "-j", 2)
    report: dict[str, Any] = json.loads(done.stdout)
    assert report["octray"] == octray.__version__
    assert set(report["phases"]) == {"import_s", "build_s", "render_s", "write_s"}
    assert report["rays"]["primary"] == 1200
    assert report["tests_per_ray"]["triangles"] >= 0
    assert set(report["trees"]) == {"cells", "instances", "membership", "triangles", "wide"}
    assert report["memory"]["peak_bytes"] is None or report["memory"]["peak_bytes"] > 1e6
    assert report["warnings"] == report["errors"] == []
    assert report["outputs"][0]["path"] == "cube.png"
    assert report["args"]["threads"] == report["threads"] == 2
    assert report["exit"] == done.returncode == 0


def test_a_picture_of_costs_says_what_its_colours_mean(octray_command: Octray, cube: Path) -> None:
    done = octray_command("render", cube.name, *SIZE, "--integrator", "cost", "--json")
    cost = json.loads(done.stdout)["cost"]
    assert set(cost) == {"weights", "low", "high"}
    assert cost["high"] > cost["low"] == 0
    assert f"the brightest {cost['high']:.3g} or more" in done.stderr
    viewed = octray_command("render", cube.name, "--integrator", "cost", "--view", "raw")
    assert viewed.returncode == 2
    assert "leave the view out" in viewed.stderr


def test_threads_and_accelerator_do_not_change_a_byte(octray_command: Octray, cube: Path) -> None:
    (cube.parent / "solid.csg").write_text(
        "difference() { cube(size = [2, 2, 2], center = true); sphere(r = 1.3, $fn = 0); }"
    )
    for scene, suffix in ((cube.name, "png"), ("solid.csg", "png"), ("solid.csg", "exr")):
        pictures = set()
        for i, options in enumerate((["-j1"], ["-j4"], ["--accel=brute", "-j3"], ["--preview"])):
            name = f"{i}.{suffix}"
            done = octray_command("render", scene, *SIZE, *options, "-o", name)
            assert done.returncode == 0, done.stderr
            pictures.add((cube.parent / name).read_bytes())
        assert len(pictures) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--size", "1000000x1000000"], "MiB are allowed"),
        (["--size", "0x10"], "at least one pixel"),
        (["--size", "10"], "not a size such as"),
        (["--size", "-5x5"], "not a size such as"),
        (["--size", "99999999999999999999x1"], "not a size such as"),
        (["--spp", "0"], "0 is not in the range"),
        (["--spp", "100000000"], "samples per pixel"),
        (["-j", "0"], "0 is not in the range"),
        (["-j", "100000"], "threads must be"),
        (["--crop", "1,2,3"], "not a crop such as"),
        (["--crop", "9,9,9,20"], "x0 must be below x1"),
        (["--size", "40x30", "--crop", "0,0,41,30"], "does not lie in the picture"),
        (["--view", "pretty"], "pretty"),
        (["--accel", "magic"], "magic"),
        (["-o", "picture.jpg"], ".png or .exr"),
        (["-o", "-", "--json"], "both want standard output"),
        (["--frobnicate"], "No such option"),
    ],
)
def test_wrong_usage_is_exit_code_2_and_writes_nothing(
    octray_command: Octray, cube: Path, arguments: list[str], message: str
) -> None:
    done = octray_command("render", cube.name, *arguments)
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
    assert files(cube.parent) == ["cube.obj"]


def test_a_crop_outside_the_default_size_is_wrong_usage_too(
    octray_command: Octray, cube: Path
) -> None:
    done = octray_command("render", cube.name, "--crop", "0,0,5000,10")
    assert done.returncode == 2
    assert files(cube.parent) == ["cube.obj"]


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("none.obj", None, "none.obj"),
        ("a.step", b"ISO-10303-21;", ".step"),
        ("empty.stl", b"", "empty.stl"),
        ("short.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n", "short.ply"),
        ("index.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "index.obj:4:"),
        ("nan.obj", b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "nan.obj:1:"),
        ("syntax.csg", b"cube(size = [1, 1, 1];\n", "syntax.csg:1:"),
        ("syntax.pov", b"sphere { <0, 0, 0> 1 \n", "syntax.pov:"),
    ],
)
def test_a_bad_scene_is_exit_code_3_and_writes_nothing(
    octray_command: Octray, tmp_path: Path, name: str, content: bytes | None, message: str
) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    before = files(tmp_path)
    for command in (["render", name], ["info", name]):
        done = octray_command(*command)
        assert done.returncode == 3, done.stderr
        assert message in done.stderr
        assert "Traceback" not in done.stderr
        assert done.stdout == ""
    assert files(tmp_path) == before
    report = json.loads(octray_command("render", name, "--json").stdout)
    assert report["exit"] == 3
    assert report["outputs"] == []
    assert report["error"]


def test_warnings_do_not_stop_a_picture_but_strict_does(
    octray_command: Octray, tmp_path: Path
) -> None:
    (tmp_path / "a.csg").write_text("cube(size = [1, 1, 1]);\nminkowski() { cube(size = 1); }\n")
    done = octray_command("render", "a.csg", *SIZE)
    assert done.returncode == 0
    assert "a.csg:2:1: warning: " in done.stderr
    assert files(tmp_path) == ["a.csg", "a.png"]
    report = json.loads(octray_command("render", "a.csg", *SIZE, "--json").stdout)
    assert (report["warnings"][0]["line"], report["warnings"][0]["column"]) == (2, 1)
    (tmp_path / "a.png").unlink()
    for command in ("render", "info"):
        strict = octray_command(command, "a.csg", "--strict")
        assert strict.returncode == 3
        assert "--strict" in strict.stderr
    assert files(tmp_path) == ["a.csg"]


def test_places_that_cannot_be_written_are_exit_code_1(octray_command: Octray, cube: Path) -> None:
    done = octray_command("render", cube.name, "-o", "none/cube.png")
    assert done.returncode == 1
    assert "there is no directory none" in done.stderr
    (cube.parent / "folder.png").mkdir()
    done = octray_command("render", cube.name, "-o", "folder.png")
    assert done.returncode == 1
    assert "is a directory" in done.stderr


def listen() -> None:
    """Make Ctrl-C count again where whoever started the tests has switched it off."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


def slow_file(folder: Path) -> Path:
    """A scene that takes some seconds at full size."""
    balls = "".join(
        f"multmatrix([[1,0,0,{3 * x}],[0,1,0,{3 * y}],[0,0,1,0],[0,0,0,1]]) {{ sphere(r = 1); }}\n"
        for x in range(8)
        for y in range(8)
    )
    path = folder / "slow.csg"
    path.write_text(balls)
    return path


@pytest.mark.skipif(sys.platform == "win32", reason="signals are different there")
@pytest.mark.parametrize("preview", [False, True])
def test_ctrl_c_saves_what_there_is(tmp_path: Path, preview: bool) -> None:
    scene = slow_file(tmp_path)
    arguments = ["render", scene.name, "--size", "6000x4000", "--spp", "16", "-j", "2", "--json"]
    if preview:
        arguments.append("--preview")
    with subprocess.Popen(
        [*COMMAND, *arguments],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=listen,  # noqa: PLW1509 - no other thread runs here
    ) as run:
        if preview:
            deadline = time.monotonic() + 60
            while not (tmp_path / "slow.png").exists() and time.monotonic() < deadline:
                time.sleep(0.05)
            assert (tmp_path / "slow.png").exists()
        else:
            time.sleep(3)
        assert run.poll() is None, run.communicate()
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=60)
    assert run.returncode == 130
    assert "interrupted; slow.png has the" in err
    assert "--resume goes on" in err
    assert (tmp_path / "slow.png").read_bytes().endswith(b"IEND\xaeB`\x82")
    # What was finished is kept, to go on with.
    assert files(tmp_path) == ["slow.csg", "slow.png", "slow.png.ckpt"]
    report = json.loads(out)
    assert report["exit"] == 130
    assert report["complete"] is False
    assert report["outputs"][0]["complete"] is False


def test_info_lists_the_scene(octray_command: Octray, cube: Path) -> None:
    shown = octray_command("info", cube.name)
    assert shown.returncode == 0
    assert "triangles 12" in shown.stdout
    assert "(0, 0, 0) to (1, 1, 1)" in shown.stdout
    described = json.loads(octray_command("info", cube.name, "--json").stdout)
    assert described["file"] == cube.name
    assert described["triangles"] == 12
    assert described["warnings"] == []
    assert [(m["closed"], m["solid"], m["shells"]) for m in described["meshes"]] == [
        (True, True, 1)
    ]


def test_info_says_which_surfaces_coincide_and_which_nearly_do(
    octray_command: Octray, tmp_path: Path
) -> None:
    path = tmp_path / "stack.pov"

    def stack(gap: float) -> None:
        upper = f"cylinder {{ <2, {4 + gap:.17g}, 2>, <2, 10, 2>, 1 }}"
        path.write_text(f"box {{ 0, 4 }}\n{upper}\n", encoding="utf-8")

    stack(0)
    lines = octray_command("info", path.name).stdout.splitlines()
    assert "surfaces 8, faces merged with them 1" in lines

    stack(1e-7)
    lines = octray_command("info", path.name).stdout.splitlines()
    at = lines.index("surfaces 9, faces merged with them 0")
    assert lines[at + 1].startswith("  1 nearly coincides with another: nearer than 9.54e-06,")
    assert "1e-07 apart, at (2, 4, 2)" in lines[at + 2]
    assert lines[at + 2].startswith("  planes of `")
    described = json.loads(octray_command("info", path.name, "--json").stdout)["surfaces"]
    assert described["near_count"] == 1
    [pair] = described["pairs"]
    assert pair["kind"] == "plane"
    assert pair["objects"] == [0, 1]
    assert abs(pair["gap"] - 1e-7) < 1e-14
    assert pair["position"] == [2.0, 4.0, 2.0]


def test_info_says_what_is_wrong_with_a_mesh(
    octray_command: Octray, cube: Path, tmp_path: Path
) -> None:
    assert "bounds a solid of 1 shell" in octray_command("info", cube.name).stdout
    # Without its last face, of which every edge is open.
    lines = cube.read_text().strip().splitlines()
    (tmp_path / "open.obj").write_text("\n".join(lines[:-1]))
    shown = octray_command("info", "open.obj").stdout
    assert "not closed: no boundary of a solid: open edge 4" in shown
    assert "has the edge (0, 0, 0) to (0, 1, 0)" in shown
    (check,) = json.loads(octray_command("info", "open.obj", "--json").stdout)["meshes"]
    assert (check["closed"], check["solid"], check["flaws"]) == (False, False, {"open edge": 4})
    corners = {tuple(point) for place in check["places"] for point in place["points"]}
    assert corners == {(0, 0, 0), (0, 1, 0), (0, 0, 1), (0, 1, 1)}


def test_the_doctor_finds_this_installation_sound(octray_command: Octray) -> None:
    shown = octray_command("doctor")
    assert shown.returncode == 0, shown.stdout
    assert shown.stdout.endswith("all is well\n")
    report = json.loads(octray_command("doctor", "--json").stdout)
    assert report["good"] is True
    assert {check["name"] for check in report["checks"]} >= {"versions", "rendering", "directory"}


@pytest.mark.parametrize(
    ("side", "shares"),
    [("front", (2, 4)), ("right", (3, 4)), ("top", (2, 3)), ("bottom", (2, 3))],
)
def test_view_from_shows_a_part_as_drawings_do(
    octray_command: Octray, tmp_path: Path, side: Side, shares: tuple[int, int]
) -> None:
    """A box of 2 x 3 x 4 shows the rectangle of that side."""
    (tmp_path / "part.csg").write_text(
        "multmatrix([[1,0,0,50],[0,1,0,9],[0,0,1,-7],[0,0,0,1]])"
        "{ cube(size = [2, 3, 4], center = true); }"
    )
    arguments = ("part.csg", "--size", "200x200", "--view-from", side, "-o", "part.exr")
    done = octray_command("render", *arguments)
    assert done.returncode == 0, done.stderr
    scene = octray.load(tmp_path / "part.csg")
    scene.view_from(side)
    rendered = scene.render(size=(200, 200))
    assert (tmp_path / "part.exr").read_bytes() == rendered.to_bytes("exr")
    image = rendered.to_numpy()
    # Parallel rays see the same of the background everywhere.
    rows, columns = np.nonzero((image != image[0, 0]).any(axis=-1))
    width, height = np.ptp(columns) + 1, np.ptp(rows) + 1
    assert max(width, height) == pytest.approx(184, abs=2)
    assert width / height == pytest.approx(shares[0] / shares[1], abs=0.02)


def test_viewall_moves_the_camera(octray_command: Octray, cube: Path) -> None:
    (cube.parent / "far.csg").write_text("cube(size = [1, 1, 1], center = true);")
    done = octray_command("render", "far.csg", *SIZE, "--viewall")
    assert done.returncode == 0
    (cube.parent / "empty.csg").write_text("group();")
    done = octray_command("render", "empty.csg", *SIZE, "--viewall")
    assert done.returncode == 3
    assert "nothing bounded" in done.stderr
    assert octray_command("render", "empty.csg", *SIZE).returncode == 0
