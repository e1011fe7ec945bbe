"""Compares a JSON object with the page that documents its paths."""

from __future__ import annotations

import re
from collections import deque
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path


def documented(page: Path) -> dict[str, str]:
    """Every path of a JSON object with the types that the page gives it."""
    lines = re.findall(
        r"^\| `([^`]+)` \| ([^|]+) \|", page.read_text(encoding="utf-8"), re.MULTILINE
    )
    assert len(lines) == len(dict(lines)), "a path is documented twice"
    return {path: kinds.strip() for path, kinds in lines}


TYPES = {
    "string": lambda value: isinstance(value, str),
    "integer": lambda value: isinstance(value, int) and not isinstance(value, bool),
    "number": lambda value: isinstance(value, (int, float)) and not isinstance(value, bool),
    "boolean": lambda value: isinstance(value, bool),
    "null": lambda value: value is None,
    "list": lambda value: isinstance(value, list),
    "object": lambda value: isinstance(value, dict),
}


def check_against_page(report: dict[str, Any], page: Path) -> None:
    """Everything in the object is documented with its type, and everything documented is there."""
    schema = documented(page)
    seen = set()
    work = deque((name, value) for name, value in report.items())
    while work:
        path, value = work.popleft()
        if path not in schema:
            # Names that depend on the run stand as `*`, and what is below them comes next.
            path = re.sub(r"\.[^.]+$", ".*", path)
        assert path in schema, f"{path} is not documented"
        kinds = schema[path].split(" or ")
        assert any(TYPES[kind](value) for kind in kinds), f"{path}: {value!r} is no {kinds}"
        seen.add(path)
        if isinstance(value, dict):
            work.extend((f"{path}.{name}", part) for name, part in value.items())
        elif isinstance(value, list):
            work.extend((f"{path}[]", part) for part in value)
    # Below something that is null here there may be more.
    absent = {path for path in schema if path not in seen}
    hidden = {path for path in absent if any(path.startswith((f"{s}.", f"{s}[")) for s in seen)}
    assert absent == hidden
