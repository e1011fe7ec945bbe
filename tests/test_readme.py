"""The README's examples do what it says."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import ROOT, blocks

README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_python_examples_run_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    printed = io.StringIO()
    examples = blocks(README, "python")
    assert len(examples) == 4
    with contextlib.redirect_stdout(printed):
        for example in examples:
            exec(compile(example, "README.md", "exec"), names)  # noqa: S102 - our own text
    assert (tmp_path / "bracket.png").stat().st_size > 1000
    lines = printed.getvalue().splitlines()
    claims = [
        match.group(1).strip()
        for example in examples
        for match in re.finditer(r"print\(.*# (\[[^\]]*\])", example)
    ]
    assert len(claims) == 4
    for line, claim in zip(lines, claims, strict=False):
        assert line.strip("[]").split() == claim.strip("[]").split()


COMMANDS = [line for block in blocks(README, "sh") for line in block.splitlines() if line.strip()]


@pytest.mark.parametrize("command", COMMANDS)
def test_the_shell_examples_succeed(command: str, tmp_path: Path) -> None:
    program, *arguments = shlex.split(command)
    assert program == "octray"
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    octray = Path(sys.executable).with_name("octray")
    done = subprocess.run(
        [octray, *arguments],
        cwd=tmp_path,
        env={**os.environ, "NO_COLOR": "1"},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    if "-o" in arguments:
        assert (tmp_path / arguments[arguments.index("-o") + 1]).stat().st_size > 1000
