"""The crates depend on each other in one direction only, and files stay small."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

#: Everything a crate may depend on; an edge that is not here is a change of architecture.
ALLOWED = {
    "octray-math": set(),
    "octray-kernels": set(),
    "octray-tree": {"octray-math", "octray-kernels"},
    "octray-geometry": {"octray-tree", "octray-math", "octray-kernels"},
    "octray-scene": {"octray-geometry", "octray-math"},
    "octray-world": {
        "octray-scene",
        "octray-geometry",
        "octray-tree",
        "octray-math",
        "octray-kernels",
    },
    "octray-render": {"octray-world", "octray-scene", "octray-geometry", "octray-math"},
    "octray-import": {"octray-world", "octray-scene", "octray-geometry", "octray-math"},
    "octray": {
        "octray-math",
        "octray-tree",
        "octray-geometry",
        "octray-scene",
        "octray-world",
        "octray-render",
        "octray-import",
    },
    "octray-python": {"octray"},
}
MAX_LINES = 600


def packages() -> dict[str, set[str]]:
    """Names of our crates, each with ours that it depends on outside its tests."""
    command = ["cargo", "metadata", "--format-version=1", "--no-deps", "--offline"]
    found = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    listed = json.loads(found.stdout)["packages"]
    ours = {package["name"] for package in listed}
    return {
        package["name"]: {
            dependency["name"]
            for dependency in package["dependencies"]
            if dependency["name"] in ours and dependency["kind"] != "dev"
        }
        for package in listed
    }


def test_every_crate_depends_only_on_what_it_may() -> None:
    found = packages()
    assert set(found) == set(ALLOWED), "a new crate takes its place in this table first"
    wrong = {name: edges - ALLOWED[name] for name, edges in found.items() if edges - ALLOWED[name]}
    assert wrong == {}


def sources() -> list[Path]:
    """All our files of code, tests left out."""
    listed = subprocess.run(
        ["git", "ls-files", "--", "*.rs", "*.py", "*.pyi"],  # noqa: S607
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    paths = [Path(line) for line in listed.stdout.splitlines()]
    return [
        path
        for path in paths
        if (ROOT / path).exists()
        and not {"tests", "benches", "fuzz"} & set(path.parts)
        and not path.stem.startswith("test")
        and path.stem != "tests"
    ]


def code_lines(path: Path) -> int:
    """Lines before the tests that stand at the end of a Rust file."""
    text = (ROOT / path).read_text(encoding="utf-8")
    return len(text.split("#[cfg(test)]\nmod tests {")[0].splitlines())


def test_no_file_is_too_long() -> None:
    files = sources()
    assert len(files) > 40
    long = {str(path): code_lines(path) for path in files if code_lines(path) > MAX_LINES}
    assert long == {}


def test_nothing_escapes_the_lints() -> None:
    for manifest in sorted(ROOT.glob("crates/*/Cargo.toml")):
        text = manifest.read_text(encoding="utf-8")
        own_table = 'unsafe_code = "deny"' in text and manifest.parent.name == "python"
        assert "[lints]\nworkspace = true" in text or own_table, manifest
