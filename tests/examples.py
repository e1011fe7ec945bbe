"""Runs the examples of a Markdown page and compares what they print with what the page says."""

from __future__ import annotations

import contextlib
import io
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


def blocks(page: str, language: str) -> list[str]:
    """The fenced blocks in one language."""
    return re.findall(rf"^```{language}\n(.*?)^```", page, re.MULTILINE | re.DOTALL)


def run_python(path: Path) -> list[tuple[str, str]]:
    """What each ``print(...)  # claim`` prints, beside its claim; the page is one program."""
    names: dict[str, object] = {}
    compared = []
    for block in blocks(path.read_text(encoding="utf-8"), "python"):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block, path.name, "exec"), names)  # noqa: S102 - our own text
        claims = re.findall(r"^\s*print\(.*\) +# (.*)$", block, re.MULTILINE)
        compared += list(zip(printed.getvalue().splitlines(), claims, strict=True))
    return compared
