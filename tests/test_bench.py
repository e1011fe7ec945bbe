"""``octray bench``: what it measures, and what it does when a program cannot."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import signal
import statistics
import subprocess
import sys
import time
from typing import TYPE_CHECKING

import pytest

from conftest import COMMAND, ROOT, blocks
from json_page import check_against_page
from octray import bench
from octray.bench import catalogue, programs
from octray.bench.process import RunError, measure
from octray.bench.result import Report, Run, SceneFacts, Series, Status
from octray.cli import bench as bench_command

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Octray

SCHEMA = ROOT / "docs" / "bench-json.md"
PAGE = ROOT / "docs" / "performance.md"
QUICK = ("-j", 1, "--repeat", 2, "--progress", "none")

#: For scripts that have no path but their own.
SLEEP = shutil.which("sleep")

#: Says what POV-Ray says of a picture, in as long as the scene's name tells.
POVRAY = """\
#!/bin/sh
case "$1" in --version) echo "POV-Ray 3.7.test" >&2; exit 0;; esac
{work}
echo "Rays:                 600   Saved: 0" >&2
echo "Shadow Ray Tests:     300   Succeeded: 0" >&2
echo "  Parse Time:       0 hours  0 minutes  0 seconds (0.250 seconds)" >&2
echo "  Trace Time:       0 hours  0 minutes  7 seconds (7.500 seconds)" >&2
"""


def path_with(folder: Path, **programs: str) -> dict[str, str]:
    """An environment with these programs and no other peers."""
    place = folder / "bin"
    place.mkdir(exist_ok=True)
    for name, text in programs.items():
        (place / name).write_text(text, encoding="utf-8")
        (place / name).chmod(0o755)
    return {"PATH": str(place), "OCTRAY_MITSUBA": str(place / "no-such-python")}


def test_absent_programs_are_named_and_the_rest_is_measured(
    octray_command: Octray, tmp_path: Path
) -> None:
    environment = path_with(tmp_path)
    done = octray_command("bench", "sphere", *QUICK, env=environment)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    rows = [line.split() for line in done.stdout.splitlines()]
    (sphere,) = [row for row in rows if row[:1] == ["sphere"]]
    assert sphere[1:3] == ["1", "octray"]
    trace, whole, peak = map(float, sphere[3:6])
    assert 0 < trace < whole
    assert 5 < peak < 500
    for name in ("povray", "tachyon", "mitsuba"):
        assert re.search(rf"Not run: .*{name}", done.stdout)


def test_a_peer_is_measured_and_compared_round_by_round(
    octray_command: Octray, tmp_path: Path
) -> None:
    environment = path_with(tmp_path, povray=POVRAY.format(work=f"{SLEEP} 0.1"))
    done = octray_command("bench", "sphere", "drilled1", *QUICK, "--json", env=environment)
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    check_against_page(report, SCHEMA)
    assert report["format"] == 1
    assert set(report["programs"]) == {"octray", "octray, Python", "POV-Ray", "POV-Ray +BM2"}
    assert report["programs"]["POV-Ray"] == "3.7.test"
    assert set(report["absent"]) == {"Tachyon", "Mitsuba"}
    names = ["empty32x24", "sphere", "empty320x240", "drilled1"]
    assert list(report["scenes"]) == names
    assert report["scenes"]["drilled1"]["unfit"] == {
        "octray, Python": "is for meshes in binary files"
    }
    found = {(entry["scene"], entry["program"]): entry for entry in report["series"]}
    here = {(n, p) for n in names for p in ("octray", "POV-Ray", "POV-Ray +BM2")}
    # Of what is no mesh, the script renders the empty pictures alone.
    assert set(found) == here | {(names[0], "octray, Python"), (names[2], "octray, Python")}
    ours, theirs = found["sphere", "octray"], found["sphere", "POV-Ray"]
    for entry in (ours, theirs):
        assert [run["round"] for run in entry["runs"]] == [0, 1]
        assert entry["status"] == "done"
        wholes = [run["whole_s"] for run in entry["runs"]]
        assert entry["median"]["whole_s"] == statistics.median(wholes)
        # A process takes no more processor time than four threads have in its life.
        assert 0 <= entry["median"]["cpu_s"] <= 4 * entry["median"]["whole_s"]
    assert theirs["median"]["trace_s"] == 7.5
    assert theirs["median"]["parts"] == {"read": 0.25}
    # One ray for each pixel, one to the light, and those that the mirror sends.
    assert {run["rays"] for run in theirs["runs"]} == {900}
    assert theirs["ray_s"] == 7.5 / 900
    assert 32 * 24 < ours["runs"][0]["rays"] < 3 * 32 * 24
    assert theirs["median"]["whole_s"] >= 0.1
    ratios = [7.5 / run["trace_s"] for run in ours["runs"]]
    assert theirs["ratio"]["trace_s"] == pytest.approx(statistics.median(ratios))
    assert ours["ratio"]["whole_s"] == 1
    assert set(ours["median"]["parts"]) == {"read", "build", "render", "write"}
    # A shell takes no memory for a shape, more or less; a picture takes time.
    assert abs(theirs["bytes_per_shape"]) < 1 << 20
    empty = found["empty320x240", "octray"]["median"]["whole_s"]
    drilled = found["drilled1", "octray"]
    assert drilled["net"]["whole_s"] == pytest.approx(drilled["median"]["whole_s"] - empty)
    assert found["empty320x240", "octray"]["net"]["whole_s"] is None


@pytest.mark.parametrize(
    ("work", "status", "words"),
    [
        ("echo broken; exit 3", "failed", "exit status 3: broken"),
        ("kill -9 $$", "failed", "exit status -9"),
        ("exit 0", "failed", "does not tell its times"),
        (f"{SLEEP} 60", "out of time", "not done after 0.5 s"),
    ],
)
def test_a_peer_that_cannot_does_not_stop_the_others(
    octray_command: Octray, tmp_path: Path, work: str, status: str, words: str
) -> None:
    environment = path_with(tmp_path, povray=POVRAY.format(work=work))
    limit = ("--timeout", 0.5) if "time" in status else ()
    arguments = ("--only", "POV-Ray", *QUICK, *limit, "--json")
    done = octray_command("bench", "sphere", *arguments, env=environment)
    assert done.returncode == 4, done.stderr
    report = json.loads(done.stdout)
    check_against_page(report, SCHEMA)
    theirs = [entry for entry in report["series"] if entry["program"] == "POV-Ray"]
    assert {entry["status"] for entry in theirs} == {status}
    assert all(words in entry["message"] for entry in theirs)
    assert all(entry["median"]["trace_s"] is None for entry in theirs)
    if status == "failed":
        ours = [entry for entry in report["series"] if entry["program"] == "octray"]
        assert [len(entry["runs"]) for entry in ours] == [2, 2]


def test_the_budget_cuts_off_what_it_must(octray_command: Octray, tmp_path: Path) -> None:
    environment = path_with(tmp_path, povray=POVRAY.format(work=f"{SLEEP} 60"))
    started = time.monotonic()
    done = octray_command(
        *("bench", "sphere", "drilled1", "--only", "povray", "--json", "--budget", 3, *QUICK),
        env=environment,
    )
    assert done.returncode == 2
    assert "there is no program 'povray'" in done.stderr
    done = octray_command(
        *("bench", "sphere", "drilled1", "--only", "pov-ray", "--json", "--budget", 3, *QUICK),
        env=environment,
    )
    assert time.monotonic() - started < 45
    assert done.returncode == 4
    report = json.loads(done.stdout)
    statuses = {entry["program"]: entry["status"] for entry in report["series"]}
    assert statuses["POV-Ray"] == "cut off by the budget"
    assert report["not_begun"] == ["drilled1"]


def test_an_interruption_keeps_what_is_done(tmp_path: Path) -> None:
    environment = path_with(tmp_path, povray=POVRAY.format(work=f"echo $$ > pid; {SLEEP} 60"))
    folder = tmp_path / "kept"
    arguments = ["sphere", "drilled1", "--only", "POV-Ray", "--json", "--keep", str(folder)]
    process = subprocess.Popen(
        [*COMMAND, "bench", *arguments, *map(str, QUICK)],
        cwd=tmp_path,
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    pid = folder / "pid"
    for _ in range(600):
        if pid.exists() and pid.read_text():
            break
        time.sleep(0.1)
    started = int(pid.read_text())
    os.killpg(process.pid, signal.SIGINT)
    out, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    report = json.loads(out)
    check_against_page(report, SCHEMA)
    assert report["interrupted"]
    assert report["not_begun"] == ["sphere", "drilled1"]
    ours, theirs = report["series"]
    assert (ours["status"], theirs["status"]) == ("interrupted", "interrupted")
    assert (ours["message"], len(ours["runs"])) == ("1 of 2 runs were done", 1)
    # The program that was running does not stay behind.
    for _ in range(100):
        try:
            os.kill(started, 0)
        except ProcessLookupError:
            break
        time.sleep(0.1)
    else:
        pytest.fail("the peer still runs")
    assert {path.name for path in folder.iterdir()} >= {"empty32x24.pov", "octray.png"}


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["teapot"], "there is no scene 'teapot'"),
        (["balls99"], "0 to 7"),
        (["balls4", "--all"], "either one or the other"),
        (["--only", "Radiance"], "there is no program 'radiance'"),
        (["-j", "0"], "-j"),
        (["-j", "100000"], "threads"),
        (["--repeat", "0"], "--repeat"),
        (["--budget", "0"], "--budget"),
        (["--timeout", "-1"], "--timeout"),
        (["--timeout", "nan"], "timeout"),
    ],
)
def test_bad_requests_are_refused_before_anything_runs(
    octray_command: Octray, arguments: list[str], word: str
) -> None:
    done = octray_command("bench", *arguments)
    assert done.returncode == 2, done.stderr
    assert word in done.stderr
    assert done.stdout == ""
    assert "Traceback" not in done.stderr


def test_a_place_for_files_that_is_none_is_refused(octray_command: Octray, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for place in ("file", "file/below"):
        done = octray_command("bench", "sphere", "--keep", place, *QUICK)
        assert done.returncode == 1
        assert place in done.stderr
        assert "Traceback" not in done.stderr


def test_the_list_names_what_can_be_run(octray_command: Octray) -> None:
    done = octray_command("bench", "--list")
    assert done.returncode == 0
    names = [line.split()[0] for line in done.stdout.splitlines()]
    for name in names:
        catalogue.check(name.replace("N", "3"))
    for name in (*catalogue.ALL, *catalogue.USUAL):
        catalogue.check(name)


def test_memory_and_time_are_those_of_the_command(tmp_path: Path) -> None:
    code = "import time; block = bytearray(150 << 20); time.sleep(0.3)"
    cost = measure([sys.executable, "-S", "-c", code], tmp_path, 60, {})
    assert 150 << 20 <= cost.peak_bytes < 250 << 20
    assert cost.wall_s > 0.3
    # What this process holds does not count.
    block = bytearray(b"\1") * (200 << 20)
    small = measure([sys.executable, "-S", "-c", "print('done')"], tmp_path, 60, {})
    assert small.peak_bytes < 50 << 20 < len(block)
    assert small.text == "done\n"
    with pytest.raises(RunError, match="does not start: No such file"):
        measure([str(tmp_path / "nothing")], tmp_path, 60, {})


def made(program: str, threads: int, runs: list[tuple[float, int]]) -> Series:
    """A series of (trace seconds, peak bytes)."""
    series = Series("balls4", threads, program)
    series.runs = [Run(n, t, 2 * t, 3 * t, peak, {}) for n, (t, peak) in enumerate(runs)]
    return series


def test_ratios_are_medians_over_rounds_and_not_ratios_of_medians() -> None:
    report = Report({"load": 0.0, "processors": 4}, {"scenes": ["balls4"]})
    report.scenes["balls4"] = SceneFacts("", {"spheres": 1000}, (8, 8), "empty8x8")
    report.scenes["empty8x8"] = SceneFacts("", {}, (8, 8), "empty8x8")
    # The machine was busy in the second round, for both.
    ours = made("octray", 1, [(1.0, 5_000_000), (8.0, 5_000_000), (2.0, 5_000_000)])
    theirs = made("POV-Ray", 1, [(3.0, 9_000_000), (16.0, 9_000_000), (2.0, 9_000_000)])
    four = made("octray", 4, [(0.5, 5_000_000)])
    base = made("octray", 1, [(0.25, 4_000_000)])
    base.scene = "empty8x8"
    report.series = [base, ours, theirs, four]
    assert report.ratio(theirs, "trace_s") == 2.0
    assert report.ratio(ours, "whole_s") == 1.0
    assert report.ratio(made("Tachyon", 2, [(1.0, 1)]), "trace_s") is None
    assert report.bytes_per_shape(ours) == 1000
    assert report.bytes_per_shape(theirs) is None
    assert report.net(ours, "trace_s") == 2.0 - 0.25
    assert report.speedup(four) == 4.0
    assert report.speedup(ours) is None
    theirs.status, theirs.message = Status.FAILED, "no"
    assert report.missing == [theirs]
    table = bench.table(report)
    assert re.search(r"balls4 +1 +POV-Ray +3\.?0* +2\.?0* ", table)
    assert "failed: no" in table
    assert "empty" not in table


def test_the_page_is_filled_from_results(octray_command: Octray, tmp_path: Path) -> None:
    environment = path_with(tmp_path, povray=POVRAY.format(work=""))
    results: list[Path] = []
    for scene, threads in (("balls0", 1), ("drilled2", 1), ("drilled2", 2)):
        arguments = ("-j", threads, "--repeat", 1, "--progress", "none", "--json")
        done = octray_command("bench", scene, *arguments, env=environment)
        assert done.returncode == 0, done.stderr
        results.append(tmp_path / f"{len(results)}.json")
        results[-1].write_text(done.stdout, encoding="utf-8")
    page = tmp_path / "page.md"
    page.write_text(PAGE.read_text(encoding="utf-8"), encoding="utf-8")

    def fill() -> subprocess.CompletedProcess[str]:
        script = ROOT / "benches" / "renders" / "tables.py"
        command = [sys.executable, *map(str, [script, *results, "--page", page])]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    done = fill()
    assert done.returncode == 0, done.stderr
    text = page.read_text(encoding="utf-8")
    median = json.loads(results[0].read_text())["series"][-1]["median"]
    assert re.search(r"^\| balls0 \| 1 \| [0-9.e-]+ \| 7\.5 \| 7\.5 \|", text, re.MULTILINE)
    assert median["trace_s"] == 7.5
    assert re.search(r"^\| 4 \| [0-9.]+ \| [-0-9.]+ \|", text, re.MULTILINE), "the drilled plate"
    assert re.search(r"^\| drilled2 \| [0-9.]+ \| 1\.00 \| 1\.00 \|", text, re.MULTILINE), "threads"
    assert fill().returncode == 0
    assert page.read_text(encoding="utf-8") == text
    page.write_text(text.replace("<!-- traced -->", ""), encoding="utf-8")
    assert "0 places for traced" in fill().stderr


@pytest.mark.parametrize(
    "command",
    [
        line
        for page in (PAGE,)
        for block in blocks(page.read_text(encoding="utf-8"), "sh")
        for line in block.splitlines()
        if line.startswith("octray bench")
    ],
)
def test_the_commands_of_the_page_are_understood(command: str) -> None:
    arguments = [word for word in shlex.split(command, comments=True)[2:] if word != "--list"]
    understood = bench_command.command.make_context("octray bench", arguments).params
    for scene in understood["scenes"]:
        catalogue.check(scene)
    assert set(understood["only"]) <= {program.name for program in programs.programs()}
