"""What a machine lacks is said clearly before anything fails."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

CHECK = Path(__file__).resolve().parent.parent / "tools" / "check-toolchain"

#: What the script itself and its stand-ins need.
PLAIN_TOOLS = ("sh", "sed", "dirname", "printf", "env", "cat", "id", "uname")
GOOD = {
    "cargo": "echo 'cargo 1.95.0 (f2d3ce0bd 2026-03-21)'",
    "rustc": "echo 'rustc 1.95.0'",
    "cc": "exit 0",
    # Answers the question for its version; the modules are there.
    "python3": 'case "$2" in *version_info*) echo 3.12 ;; esac',
}

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the script is for POSIX shells")


def check(folder: Path, programs: dict[str, str], *arguments: str) -> tuple[int, str]:
    """Run the script on a machine that has these programs and no others."""
    for tool in PLAIN_TOOLS:
        found = shutil.which(tool)
        if found:
            (folder / tool).symlink_to(found)
    for name, body in programs.items():
        program = folder / name
        program.write_text(f"#!/bin/sh\n{body}\n")
        program.chmod(0o755)
    done = subprocess.run(
        ["/bin/sh", str(CHECK), *arguments],
        env={"PATH": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == ""
    return done.returncode, done.stderr


def test_a_complete_machine_is_not_mentioned(tmp_path: Path) -> None:
    assert check(tmp_path, GOOD) == (0, "")


@pytest.mark.parametrize(
    ("changes", "messages"),
    [
        ({"cargo": None}, ["cargo was not found (Rust 1.89 or newer)", "https://rustup.rs"]),
        ({"cargo": "echo cargo 1.88.0"}, ["cargo 1.88 is too old", "rustup update"]),
        ({"cargo": "echo cargo 1.9.2-nightly"}, ["cargo 1.9 is too old"]),
        ({"cargo": "exit 1"}, ["`cargo --version` fails", "rustup default stable"]),
        ({"rustc": None}, ["rustc does not run"]),
        ({"cc": None}, ["cc was not found", "build-essential"]),
        ({"python3": None}, ["python3 was not found (Python 3.10 or newer)"]),
        ({"python3": "echo 3.9"}, ["python3 is Python 3.9 (3.10 or newer)"]),
        (
            {"python3": 'case "$2" in *version_info*) echo 3.11 ;; *) exit 1 ;; esac'},
            ["no venv module", "apt install python3-venv"],
        ),
        ({"cargo": None, "cc": None, "python3": None}, ["cargo was", "cc was", "python3 was"]),
    ],
)
def test_everything_that_is_missing_is_named_with_its_cure(
    tmp_path: Path, changes: dict[str, str | None], messages: list[str]
) -> None:
    programs = {k: v for k, v in {**GOOD, **changes}.items() if v is not None}
    code, said = check(tmp_path, programs)
    assert code == 1
    assert said.startswith("octray cannot be built on this machine yet:\n")
    for message in messages:
        assert message in said


def test_newer_and_equal_versions_are_good(tmp_path: Path) -> None:
    for i, version in enumerate(("1.89.0", "1.100.0", "2.0.0-beta.1")):
        folder = tmp_path / str(i)
        folder.mkdir()
        assert check(folder, {**GOOD, "cargo": f"echo 'cargo {version}'"}) == (0, "")


def test_rust_alone_can_be_checked(tmp_path: Path) -> None:
    programs = {k: v for k, v in GOOD.items() if k != "python3"}
    assert check(tmp_path, programs, "--rust") == (0, "")
