"""Two methods against each other over many scenes: ratios, their median, and verdicts."""

from __future__ import annotations

import math
import statistics
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from results import Measured, Row

    Quantity = Callable[[Row], float | None]

#: Ratios this close to 1 count as equal, where noise plays a part.
NOISE = 0.05


#: What a table shows where nothing was measured.
ABSENT = "-"


class MissingError(Exception):
    """A number that is wanted is not in the results."""


def steps(row: Row) -> float | None:
    """Cells and nodes that a ray visits."""
    return _each_ray(row, "cells", "nodes")


def tests(row: Row) -> float | None:
    """Intersection tests of a ray: with surfaces, triangles and the volumes around objects."""
    return _each_ray(row, "surfaces", "triangles", "bounds")


def lookups(row: Row) -> float | None:
    """Rows of the hash table that a ray looks at."""
    return _each_ray(row, "lookups")


def built(row: Row) -> float | None:
    """Seconds of a build."""
    return row.build_s


def memory(row: Row) -> float | None:
    """Bytes of all structures."""
    return row.bytes


def nodes(row: Row) -> float | None:
    """Bytes of the cells alone."""
    return row.node_bytes


def depth(row: Row) -> float | None:
    """The level of an occupied cell, on average."""
    return row.leaf_depth


def walks(row: Row) -> bool:
    """Whether the method's cells or volumes were visited at all; brute force has none."""
    return row.method == "brute" or (row.per_ray or {}).get("cells") != 0


def seconds(row: Row) -> float | None:
    """Seconds of a picture, for ratios within one run only."""
    return row.render_s


def per_ray_s(row: Row) -> float | None:
    """Seconds of a picture for each of its rays."""
    if row.render_s is None or not row.rays:
        return None
    return row.render_s / sum(n for kind, n in row.rays.items() if kind != "total")


def kind_of_ray(kind: str, *counts: str) -> Quantity:
    """What one ray of a kind costs in these counts."""

    def quantity(row: Row) -> float | None:
        costs = (row.per_ray_by_kind or {}).get(kind, {})
        known = [costs[name] for name in counts if name in costs]
        return sum(known) if known else None

    return quantity


def _each_ray(row: Row, *names: str) -> float | None:
    known = [row.per_ray[name] for name in names if name in (row.per_ray or {})]  # type: ignore[index]
    return sum(known) if known else None


def ratio(measured: Measured, quantity: Quantity, method: str, base: str) -> float | None:
    """How many times as much the method has as the other in the same run."""
    one, other = measured.row(method), measured.row(base)
    if one is None or other is None:
        return None
    if quantity is seconds and (one.relative is not None or other.relative is not None):
        # Groups of methods, and brute force with its smaller pictures, have a yardstick each.
        if one.relative is None or not other.relative:
            return None
        return one.relative / other.relative
    a, b = quantity(one), quantity(other)
    return a / b if a is not None and b else None


@dataclass(frozen=True)
class Ratios:
    """Ratios by scene."""

    by_scene: dict[str, float]
    #: How far from 1 a ratio must be to count.
    noise: float = 0.0

    @property
    def of(self) -> int:
        """On how many scenes there is one."""
        return len(self.by_scene)

    @property
    def above(self) -> int:
        """On how many it is above 1."""
        return sum(r > 1 + self.noise for r in self.by_scene.values())

    @property
    def below(self) -> int:
        """On how many it is below 1."""
        return sum(r < 1 - self.noise for r in self.by_scene.values())

    def facts(self, name: str) -> dict[str, str]:
        """Everything that a text may say of them."""
        least = min(self.by_scene, key=self.by_scene.__getitem__)
        most = max(self.by_scene, key=self.by_scene.__getitem__)
        return {
            f"{name}.median": times(statistics.median(self.by_scene.values())),
            f"{name}.least": times(self.by_scene[least]),
            f"{name}.least_scene": least,
            f"{name}.most": times(self.by_scene[most]),
            f"{name}.most_scene": most,
            f"{name}.above": str(self.above),
            f"{name}.below": str(self.below),
            f"{name}.of": str(self.of),
        }


def over_scenes(
    runs: Iterable[Measured],
    quantity: Quantity,
    method: str,
    base: str,
    title: Callable[[str], str],
) -> Ratios | None:
    """The ratio on every scene where both methods had something to do; ``None`` if on none."""
    found = {}
    for measured in runs:
        rows = [measured.row(name) for name in (method, base)]
        value = ratio(measured, quantity, method, base)
        # A scene of which a method leaves everything to another structure says nothing about it.
        if value is not None and value > 0 and all(row and walks(row) for row in rows):
            found[title(measured.scene)] = value
    noise = NOISE if quantity in (seconds, built) else 0.0
    return Ratios(found, noise) if found else None


def verdict(shown: int, of: int) -> str:
    """A claim about scenes is confirmed if more than half of them show it."""
    if of == 0:
        raise MissingError("a claim cannot be judged without a scene")
    return "confirmed" if 2 * shown > of else "refuted"


def exponent(points: list[tuple[float, float]]) -> float:
    """The p of y ~ x^p from the first point to the last."""
    (x0, y0), (x1, y1) = points[0], points[-1]
    return math.log(y1 / y0) / math.log(x1 / x0)


def times(value: float) -> str:
    """A ratio with two digits, or a whole number from 10 on."""
    if value >= 9.95:
        return f"{value:,.0f}"
    return f"{value:.1f}" if value >= 0.95 else f"{value:.2g}"


def short(value: float) -> str:
    """A count or a number of seconds with three digits."""
    if value == 0:
        return "0"
    if abs(value) >= 100:
        return f"{value:,.0f}"
    return f"{value:.3g}"


def in_bytes(value: float) -> str:
    """Bytes with a unit."""
    for unit in ("B", "KiB", "MiB"):
        if value < 1000:
            return f"{short(value)} {unit}"
        value /= 1024
    return f"{short(value)} GiB"


def written(value: float | None, text: Callable[[float], str] = short) -> str:
    """A number as a table shows it."""
    return ABSENT if value is None else text(value)
