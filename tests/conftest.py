"""What several test files need."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Protocol

import pytest

ROOT = Path(__file__).resolve().parent.parent
COMMAND = [sys.executable, "-m", "octray"]

#: Six triangles of a closed cube's half, as little text as a mesh file can be.
CUBE_OBJ = """\
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
"""


def blocks(page: str, language: str) -> list[str]:
    """Take the fenced examples in one language out of a page of Markdown."""
    return re.findall(rf"^```{language}\n(.*?)^```", page, re.MULTILINE | re.DOTALL)


class Octray(Protocol):
    """Runs the command line."""

    def __call__(
        self, *arguments: object, env: dict[str, str] | None = None, text: bool = True
    ) -> subprocess.CompletedProcess[str]: ...


@pytest.fixture
def octray_command(tmp_path: Path) -> Octray:
    """``octray`` in an empty directory; ``tmp_path`` is that directory."""

    def run(
        *arguments: object, env: dict[str, str] | None = None, text: bool = True
    ) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [*COMMAND, *map(str, arguments)],
            cwd=tmp_path,
            env={**os.environ, **(env or {})},
            capture_output=True,
            text=text,
            timeout=300,
            check=False,
        )

    return run


@pytest.fixture
def cube(tmp_path: Path) -> Path:
    """A mesh file with a closed cube between (0, 0, 0) and (1, 1, 1)."""
    path = tmp_path / "cube.obj"
    path.write_text(CUBE_OBJ, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def corpus() -> Path:
    """The folder of other people's files."""
    given = os.environ.get("OCTRAY_CORPUS")
    folder = Path(given) if given else ROOT.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"there is no corpus at {folder}; OCTRAY_CORPUS names another place")
    return folder
