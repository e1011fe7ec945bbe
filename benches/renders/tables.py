"""Makes the tables of docs/performance.md from what ``octray bench --json`` printed."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

POVRAY = ("POV-Ray", "POV-Ray +BM2")
SCANLINE = (*POVRAY, "Tachyon")
PEERS = (*SCANLINE, "Mitsuba")
OURS = ("octray", "octray, Python")


class Results:
    """The JSON object, by scene, threads and program."""

    def __init__(self, report: dict[str, Any]) -> None:
        """Index the series."""
        self.report = report
        self.series = {
            (entry["scene"], entry["threads"], entry["program"]): entry
            for entry in report["series"]
        }
        self.threads: list[int] = report["options"]["threads"]
        self.scenes: list[str] = report["options"]["scenes"]

    def get(self, scene: str, threads: int, program: str, *path: str) -> float | None:
        """A figure, if it was measured."""
        value: Any = self.series.get((scene, threads, program))
        for name in path:
            value = None if value is None else value.get(name)
        return None if value is None else float(value)

    def best(self, scene: str, threads: int, programs: tuple[str, ...], *path: str) -> float | None:
        """The least of several programs' figures."""
        found = [self.get(scene, threads, program, *path) for program in programs]
        return min((value for value in found if value is not None), default=None)


def seconds(value: float | None) -> str:
    """Seconds with three digits."""
    return "" if value is None else f"{value:.3f}" if value < 1 else f"{value:.3g}"


def times(value: float | None) -> str:
    """How many times as fast octray is."""
    return "" if value is None else f"**{value:.2g}x**" if value < 9.95 else f"**{value:.0f}x**"


def table(heads: list[str], rows: list[list[str]]) -> str:
    """Markdown; the first column stands at the left."""
    lines = ["| " + " | ".join(heads) + " |", "|---" + "|--:" * (len(heads) - 1) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def traced(results: Results) -> str:
    """Trace times as each program says."""
    rows = []
    for scene in results.scenes:
        if scene == "sphere" or scene.startswith("drilled"):
            continue
        for threads in results.threads:
            row = [scene, str(threads), seconds(results.get(scene, threads, OURS[0], *TRACE))]
            row += [seconds(results.get(scene, threads, peer, *TRACE)) for peer in PEERS]
            row.append(times(results.best(scene, threads, SCANLINE, "ratio", "trace_s")))
            row.append(times(results.get(scene, threads, "Mitsuba", "ratio", "trace_s")))
            rows.append(row)
    heads = ["scene", "threads", "octray", *PEERS, "best of POV-Ray and Tachyon / octray"]
    return table([*heads, "Mitsuba / octray"], rows)


TRACE, WHOLE, PEAK = ("median", "trace_s"), ("median", "whole_s"), ("median", "peak_bytes")


def whole(results: Results) -> str:
    """Whole commands."""
    rows = []
    for scene in results.scenes:
        if scene.startswith("drilled"):
            continue
        for threads in results.threads:
            ours = results.best(scene, threads, OURS, *WHOLE)
            theirs = results.best(scene, threads, PEERS, *WHOLE)
            row = [scene, str(threads)]
            row += [seconds(results.get(scene, threads, name, *WHOLE)) for name in (*OURS, *PEERS)]
            row.append(times(theirs / ours if ours and theirs else None))
            rows.append(row)
    return table(["scene", "threads", *OURS, *PEERS, "best of them / best of ours"], rows)


def phases(results: Results) -> str:
    """Where octray's command spends its time, on one thread."""
    rows = []
    for scene in results.scenes:
        for program in OURS:
            entry = results.series.get((scene, results.threads[0], program))
            if entry is None or entry["median"]["whole_s"] is None:
                continue
            parts = entry["median"]["parts"]
            named = [parts.get(name) for name in ("read", "build", "render", "write")]
            rest = entry["median"]["whole_s"] - sum(value or 0 for value in named)
            rows.append([scene, program, *map(seconds, [*named, rest])])
    return table(["scene", "", "read", "build", "render", "write", "start and end"], rows)


def memory(results: Results) -> str:
    """Peak memory of whole processes, and of each shape."""
    rows = []
    programs = ("octray", "octray, Python", "POV-Ray", "Tachyon", "Mitsuba")
    for scene in results.scenes:
        shapes = sum(results.report["scenes"].get(scene, {}).get("counts", {}).values())
        if shapes < 1000 or scene.startswith("drilled"):
            continue
        row = [scene, f"{shapes:,}"]
        for program in programs:
            peak = results.get(scene, results.threads[0], program, *PEAK)
            each = results.get(scene, results.threads[0], program, "bytes_per_shape")
            row.append("" if peak is None else f"{peak / 2**20:.0f} MiB, {each or 0:.0f} B")
        rows.append(row)
    return table(["scene", "shapes", *programs], rows)


def drilled(results: Results) -> str:
    """The drilled plate: time net of an empty picture."""
    rows = []
    for scene in results.scenes:
        if not scene.startswith("drilled"):
            continue
        threads = results.threads[0]
        ours = results.get(scene, threads, "octray", "net", "whole_s")
        theirs = results.best(scene, threads, POVRAY, "net", "whole_s")
        ratio = theirs / ours if ours and theirs else None
        rows.append([scene, seconds(ours), seconds(theirs), times(ratio)])
    return table(["scene", "octray", "best of POV-Ray", "POV-Ray / octray"], rows)


def scaling(results: Results) -> str:
    """From one thread to many."""
    rows = []
    for scene in results.scenes:
        row = [scene]
        for program in ("octray", *PEERS):
            gain = results.get(scene, results.threads[-1], program, "speedup")
            row.append("" if gain is None else f"{gain:.2f}")
        if any(row[1:]):
            rows.append(row)
    return table([f"1 to {results.threads[-1]} threads", "octray", *PEERS], rows)


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="the JSON object; - is standard input")
    options = parser.parse_args()
    text = sys.stdin.read() if str(options.results) == "-" else options.results.read_text("utf-8")
    results = Results(json.loads(text))
    for make in (traced, whole, phases, memory, drilled, scaling):
        print(f"<!-- {make.__name__} -->\n{make(results)}\n")


if __name__ == "__main__":
    main()
