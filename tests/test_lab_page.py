"""The page of the lab: every number and verdict comes out of the run's results."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import comparison as c
import page
import results
from facts import facts
from plan import LVSI, MODES, ORDERED, SUNG, jobs
from results import Measured, Results, Row, Scene

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).resolve().parent.parent
LAB = ROOT / "docs" / "lab"
RUN = ROOT / "benches" / "lab" / "run.py"


def test_the_page_is_what_the_template_makes_of_the_results() -> None:
    found = results.load(LAB / "results.json")
    assert page.fill(found) == (LAB / "README.md").read_text(encoding="utf-8")


def test_the_template_has_no_numbers_of_its_own() -> None:
    text = page.TEMPLATE.read_text(encoding="utf-8")
    text = re.sub(r"\{\{.*?\}\}|`[^`]*`|\[[^]]*\]\([^)]*\)|10\^\d", "", text)
    # Years, a journal's volume, and what equal ratios are.
    assert set(re.findall(r"\d+(?:\.\d+)?", text)) == {"1993", "1987", "7", "11", "1"}
    # Verdicts are filled in; the words themselves stand only where the rule is explained.
    assert len(re.findall(r"\bconfirmed\b", text)) == 2
    assert len(re.findall(r"\brefuted\b", text)) == 2


def test_files_are_small_enough_to_keep() -> None:
    kept = list(LAB.iterdir())
    assert {"results.json", "README.md"} <= {path.name for path in kept}
    for path in kept:
        most = {".svg": 160_000, ".png": 60_000}.get(path.suffix, 600_000)
        assert path.stat().st_size < most, path.name
    shown = re.findall(
        r'(?:src="|\]\()([\w-]+\.(?:png|svg))', (LAB / "README.md").read_text("utf-8")
    )
    assert set(shown) == {path.name for path in kept if path.suffix in (".png", ".svg")}


def row(method: str, **known: object) -> Row:
    usual = {
        "status": "done",
        "build_s": 0.5,
        "render_s": 1.0,
        "relative": 1.0,
        "bytes": 1000,
        "node_bytes": 500,
        "rays": {"primary": 10, "total": 10},
        "per_ray": {"surfaces": 2.0, "triangles": 1.0, "cells": 5.0, "nodes": 1.0},
    }
    return Row(method=method, **{**usual, **known})  # type: ignore[arg-type]


def invented(change: Callable[[int], dict[str, object]], method: str = LVSI) -> Results:
    """Three scenes with all that is asked for equal, but for one method."""
    found = Results("tiny", "0", {"processor": "none", "processors": 1}, [8, 6], [4, 3], 1, 1.0)
    for index, name in enumerate(("one", "two", "three")):
        found.scenes.append(Scene(name, name, "a scene", 10))
        rows = [row(other) for other in (ORDERED, SUNG, LVSI) if other != method]
        rows.append(row(method, **change(index)))
        found.measured.append(Measured("comparison", name, 10, 10, "", rows))
    return found


@pytest.mark.parametrize(
    ("sizes", "expected"),
    [
        ((900, 900, 900), "confirmed"),
        ((900, 900, 1100), "confirmed"),
        ((900, 1000, 1100), "refuted"),
        ((1100, 1100, 1100), "refuted"),
    ],
)
def test_a_claim_is_judged_by_most_scenes(sizes: tuple[int, ...], expected: str) -> None:
    found = facts(invented(lambda index: {"bytes": sizes[index]}))
    assert found["claim.saves"] == expected
    assert found["claim.saves.of"] == "3"
    assert found["hash_tree.bytes.median"] == c.times(sorted(sizes)[1] / 1000)


def test_times_within_the_noise_count_as_equal() -> None:
    found = facts(invented(lambda _: {"relative": 1.04}))
    assert found["claim.slower"] == "refuted"
    found = facts(invented(lambda _: {"relative": 1.06}))
    assert found["claim.slower"] == "confirmed"


def test_a_method_that_was_not_finished_is_no_evidence() -> None:
    found = facts(invented(lambda index: {"status": "out of time"} if index else {"bytes": 1}))
    assert found["claim.saves.of"] == "1"
    found = facts(invented(lambda _: {"status": "out of time"}))
    assert "claim.saves" not in found


def test_a_number_that_is_missing_stops_the_page() -> None:
    known = invented(lambda _: {})
    assert page.fill(known, "{{ claim.saves.of }} of {{run.scenes}}") == "3 of 3"
    with pytest.raises(
        c.MissingError, match=r"does not tell: drilled\.faces\.time\.growth, no\.name"
    ):
        page.fill(known, "{{ drilled.faces.time.growth }} {{ claim.saves }} {{ no.name }}")
    with pytest.raises(c.MissingError, match=r"claim\.criteria"):
        page.fill(known)


def test_growth_is_measured_from_the_first_size_to_the_last() -> None:
    known = invented(lambda _: {})
    for shapes, spent in ((100, 1.0), (1_000, 2.0), (10_000, 4.0)):
        rows = [row(ORDERED, render_s=spent)]
        known.measured.append(Measured("growth", "drilled", shapes, shapes, "", rows))
    found = facts(known)
    assert found["drilled.faces.time.growth"] == "4.0"
    assert found["drilled.faces.time.per_decade"] == "2.0"
    assert found["drilled.faces.time.exponent"] == "0.30"
    assert found["drilled.faces.time.below_linear"] == "25"


def test_brute_force_joins_its_growth_curve_with_its_yardstick() -> None:
    known = invented(lambda _: {})
    known.add(Measured("growth", "one", 10, 10, "", [row("auto"), row(ORDERED, relative=0.5)]))
    rows = [row("auto"), row("brute", relative=30.0, render_s=0.1)]
    known.add(Measured("brute", "one", 10, 10, "", rows))
    (run,) = known.of("growth")
    assert [entry.method for entry in run.rows] == ["brute", "auto", ORDERED]
    assert c.ratio(run, c.seconds, "brute", ORDERED) == 60
    with pytest.raises(ValueError, match="comes after"):
        known.add(Measured("brute", "two", 10, 10, "", rows))


def test_results_are_read_as_they_were_written(tmp_path: Path) -> None:
    known = invented(lambda index: {"message": None, "build_s": index + 0.25})
    known.save(tmp_path / "results.json")
    assert results.load(tmp_path / "results.json") == replace(known)
    text = (tmp_path / "results.json").read_text(encoding="utf-8")
    (tmp_path / "results.json").write_text(text.replace('"format": 1', '"format": 0'), "utf-8")
    with pytest.raises(ValueError, match="another version"):
        results.load(tmp_path / "results.json")


def test_every_mode_asks_for_what_the_page_wants() -> None:
    for mode in MODES.values():
        wanted = list(jobs(mode))
        assert {job.experiment for job in wanted} == {
            "comparison",
            "growth",
            "brute",
            "table",
            "criteria",
        }
        # Titles of the scenes that are swept come from the comparison.
        assert {*mode.growing, *mode.swept} - {"drilled"} <= set(mode.compared)


def test_a_tiny_run_makes_a_whole_page(tmp_path: Path) -> None:
    command = [sys.executable, str(RUN), "--mode", "tiny", "--output", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    found = results.load(tmp_path / "results.json")
    assert found.skipped == []
    assert all(entry.same is not False for run in found.measured for entry in run.rows)
    made = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert "{{" not in made
    assert "**confirmed**" in made or "**refuted**" in made
    again = [*command, "--page"]
    subprocess.run(again, capture_output=True, timeout=120, check=True)
    assert (tmp_path / "README.md").read_text(encoding="utf-8") == made
