"""Makes the tables of docs/performance.md from what ``octray bench --json`` printed.

``tables.py RESULTS... --page docs/performance.md`` puts them where the page has a comment with
their name; without a page they are printed. Of several results the later ones add to the earlier
ones and replace what is in both.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from pathlib import Path
from typing import Any

from octray.bench import catalogue

POVRAY = ("POV-Ray", "POV-Ray +BM2")
SCANLINE = (*POVRAY, "Tachyon")
PEERS = (*SCANLINE, "Mitsuba")
OURS = ("octray", "octray, Python")


class Results:
    """What JSON objects tell, by scene, threads and program."""

    def __init__(self, reports: list[dict[str, Any]]) -> None:
        """Index the series; the last word counts."""
        self.reports = reports
        self.series: dict[tuple[str, int, str], dict[str, Any]] = {}
        self.scenes: dict[str, dict[str, Any]] = {}
        for report in reports:
            for entry in report["series"]:
                self.series[entry["scene"], entry["threads"], entry["program"]] = entry
            self.scenes |= report["scenes"]
        rank = {name: place for place, name in enumerate(catalogue.ALL)}
        named = [name for name, facts in self.scenes.items() if facts["empty"] != name]
        self.names = sorted(named, key=lambda name: rank.get(name, len(rank)))
        self.threads = sorted({threads for _, threads, _ in self.series})

    def shapes(self, scene: str) -> int:
        """How many shapes a scene has."""
        return sum(self.scenes[scene]["counts"].values())

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
    if value is None:
        return ""
    text = f"{value:.2g}x" if value < 9.95 else f"{value:.0f}x"
    return text if value < 1 else f"**{text}**"


def table(heads: list[str], rows: list[list[str]]) -> str:
    """Markdown; the first column stands at the left."""
    lines = ["| " + " | ".join(heads) + " |", "|---" + "|--:" * (len(heads) - 1) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def traced(results: Results) -> str:
    """Trace times as each program says."""
    rows = []
    for scene in results.names:
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
    for scene in results.names:
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
    for scene in results.names:
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
    for scene in results.names:
        shapes = results.shapes(scene)
        if shapes < 1000 or scene.startswith("drilled"):
            continue
        row = [scene, f"{shapes:,}"]
        for program in programs:
            peak = results.get(scene, results.threads[0], program, *PEAK)
            each = results.get(scene, results.threads[0], program, "bytes_per_shape")
            text = "" if peak is None else f"{peak / 2**20:.0f} MiB"
            row.append(text if each is None else f"{text}, {each:.0f} B")
        rows.append(row)
    return table(["scene", "shapes", *programs], rows)


def drilled(results: Results) -> str:
    """The drilled plate: time net of an empty picture, and time per ray."""
    rows = []
    threads = results.threads[0]
    for scene in sorted(results.names, key=results.shapes):
        if not scene.startswith("drilled"):
            continue
        ours = results.get(scene, threads, "octray", "net", "whole_s")
        theirs = results.best(scene, threads, POVRAY, "net", "whole_s")
        rows.append([f"{results.shapes(scene) - 1:,}", seconds(ours), seconds(theirs)])
        rows[-1].append(times(theirs / ours if ours and theirs else None))
        for program in ("octray", "POV-Ray"):
            each = results.get(scene, threads, program, "ray_s")
            rows[-1].append("" if each is None else f"{each * 1e6:.3g}")
    heads = ["holes", "octray", "best of POV-Ray", "POV-Ray / octray"]
    return table([*heads, "octray, µs a ray", "POV-Ray, µs a ray"], rows)


def scaling(results: Results) -> str:
    """From one thread to many."""
    rows = []
    for scene in results.names:
        if scene == "sphere" or results.threads[-1] == 1:
            continue
        row = [scene]
        for program in ("octray", *PEERS):
            one, many = (
                results.get(scene, threads, program, *TRACE) for threads in (1, results.threads[-1])
            )
            row.append(f"{one / many:.2f}" if one and many else "")
        if any(row[1:]):
            rows.append(row)
    return table([f"1 to {results.threads[-1]} threads", "octray", *PEERS], rows)


def lost(results: Results) -> str:
    """Everything in which some program is faster or smaller than octray, with the best of them."""
    worst: dict[tuple[str, int, str], tuple[float, str]] = {}
    words = {"trace_s": "tracing", "whole_s": "command", "peak_bytes": "memory"}
    for (scene, threads, program), entry in results.series.items():
        if results.scenes[scene]["empty"] == scene or program in OURS:
            continue
        for what, word in words.items():
            ratio = entry["ratio"][what]
            # On a stamp tracing takes less than a clock tells.
            if ratio is None or ratio >= 1 or ratio == 0 or (scene, what) == ("sphere", "trace_s"):
                continue
            place = scene, threads, word
            worst[place] = min(worst.get(place, (1.0, "")), (ratio, program))
    rows = [
        [scene, str(threads), word, f"{1 / ratio:.3g}x that of {program}"]
        for (scene, threads, word), (ratio, program) in worst.items()
    ]
    return table(["scene", "threads", "what", "octray takes"], rows)


def run(results: Results) -> str:
    """What was run, where and when it was how busy."""
    report = results.reports[-1]
    machine = report["machine"]
    programs: dict[str, str] = {}
    for one in results.reports:
        programs |= one["programs"]
    loads = [
        one["machine"]["load"] for one in results.reports if one["machine"]["load"] is not None
    ]
    load = f"load {min(loads):.1f} to {max(loads):.1f} when a run began; " if loads else ""
    repeats = sorted({one["options"]["repeat"] for one in results.reports})
    return (
        f"{machine['processor']}, {machine['processors']} processors,"
        f" {(machine['memory_bytes'] or 0) / 2**30:.0f} GiB, {machine['system']}, Python"
        f" {machine['python']}; {load}{' or '.join(map(str, repeats))} rounds. "
        + ", ".join(f"{name} {version}" for name, version in programs.items())
        + "."
    )


BLOCKS = (run, traced, whole, phases, memory, drilled, scaling, lost)


def fill(page: str, results: Results) -> str:
    """Replace what stands between the comments that name a block."""
    for make in BLOCKS:
        name = make.__name__
        pattern = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
        page, count = pattern.subn(
            lambda found, m=make: f"{found[1]}{m(results)}\n{found[2]}", page
        )
        if count != 1:
            raise ValueError(f"the page has {count} places for {name}")
    return page


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, nargs="+", help="JSON objects")
    parser.add_argument("--page", type=Path, help="put the tables into this page")
    options = parser.parse_args()
    results = Results([json.loads(path.read_text(encoding="utf-8")) for path in options.results])
    if options.page is None:
        for make in BLOCKS:
            print(f"<!-- {make.__name__} -->\n{make(results)}\n")
        return
    try:
        options.page.write_text(fill(options.page.read_text("utf-8"), results), encoding="utf-8")
    except ValueError as error:
        sys.exit(f"{options.page}: {error}")


if __name__ == "__main__":
    main()
