"""docs/methods.md leads from every method's name to its one file, and its examples work."""

from __future__ import annotations

import re
import shlex
import subprocess
from typing import TYPE_CHECKING, Any

import octray
from conftest import COMMAND, ROOT, blocks

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

PAGE = (ROOT / "docs" / "methods.md").read_text(encoding="utf-8")
#: Of the table of methods; the one of marked cells has four columns.
ROWS = [
    row
    for row in (
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in PAGE.splitlines()
        if line.startswith("| ") and "`" in line
    )
    if len(row) == 5
]


def test_every_word_of_every_method_has_a_row() -> None:
    listed = {word for row in ROWS for word in re.findall(r"`([\w-]+)`", row[1])}
    words = {word for method in octray.methods() for word in method.split(":")}
    assert words - {"auto", "octree"} == listed


def test_every_row_names_a_file_that_names_its_source() -> None:
    assert len(ROWS) > 10
    for _part, words, _what, file, source in ROWS:
        path = ROOT / file.strip("`")
        text = path.read_text(encoding="utf-8")
        header = "\n".join(line for line in text.splitlines() if line.startswith("//!"))
        assert header, f"{file} says nothing about itself"
        for author, year in re.findall(r"(\w+) ((?:19|20)\d\d)", source):
            assert author in text, f"{file} ({words}) does not cite {author}"
            assert year in text, f"{file} ({words}) does not cite {author} {year}"
        assert len(text.splitlines()) <= 400, f"{file} cannot be read in one sitting"


def test_the_examples_do_what_the_page_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for example in blocks(PAGE, "python"):
        exec(compile(example, "methods.md", "exec"), names)  # noqa: S102 - our own text
    assert len(names["pictures"]) == 4
    commands = [line for block in blocks(PAGE, "sh") for line in block.splitlines()]
    assert len(commands) == 2
    for command in commands:
        program, *arguments = shlex.split(command, comments=True)
        assert program == "octray"
        done = subprocess.run(
            [*COMMAND, *arguments], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "hello.png").stat().st_size > 1000
