"""Fills the page's template with the numbers of a run; a number that is missing is an error."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import comparison as c
import tables
from facts import facts

if TYPE_CHECKING:
    from results import Results

TEMPLATE = Path(__file__).with_name("page.md")
#: ``{{ name }}``; a name is of lower-case words with dots.
_FIELD = re.compile(r"\{\{ *([a-z0-9_.]+) *\}\}")


def fill(results: Results, template: str | None = None) -> str:
    """Make the page. Raises ``MissingError`` with everything that the run does not tell."""
    text = TEMPLATE.read_text(encoding="utf-8") if template is None else template
    known = facts(results) | _blocks(results)
    missing = sorted({name for name in _FIELD.findall(text) if name not in known})
    if missing:
        raise c.MissingError(f"the run does not tell: {', '.join(missing)}")
    return _FIELD.sub(lambda field: known[field[1]], text)


def _blocks(results: Results) -> dict[str, str]:
    """The page's tables and lists of figures."""
    found = {
        "table.scenes": tables.scenes(results),
        "table.comparison.time": tables.time(results),
        "table.comparison.build": tables.quantity(results, c.built, _milliseconds),
        "table.comparison.bytes": tables.quantity(results, c.memory, c.in_bytes),
        "table.comparison.steps": tables.quantity(results, c.steps),
        "table.comparison.tests": tables.quantity(results, c.tests),
        "table.comparison.lookups": tables.quantity(results, c.lookups),
        "table.drilled.time": tables.growth(results, "drilled", c.per_ray_s, _microseconds),
        "table.drilled.tests": tables.growth(results, "drilled", c.tests, c.short),
        "table.sizes": tables.table_sizes(results),
        "table.criteria": tables.criteria(results),
        "list.missing": tables.missing(results),
    }
    grown = dict.fromkeys(run.scene for run in results.of("growth"))
    found["list.growth"] = "\n\n".join(
        f"![{name}: build time, memory, cells and tests per ray, time per ray over the number of"
        f" shapes](growth-{name}.svg)"
        for name in grown
    )
    return found


def _milliseconds(seconds: float) -> str:
    return c.short(seconds * 1e3)


def _microseconds(seconds: float) -> str:
    return c.short(seconds * 1e6)
