"""Compares the pictures of the methods with that of the reference."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from octray.lab.selection import ORACLE, YARDSTICK

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt

    from octray.lab.result import Combination, Report


def reference_of(combinations: list[Combination]) -> Combination | None:
    """Choose whose picture is right: brute force, else the yardstick, else the first there is."""
    rendered = [combination for combination in combinations if combination.pictures]
    ranks = {ORACLE: 0, YARDSTICK: 1}
    return min(rendered, key=lambda c: ranks.get(c.method, len(ranks)), default=None)


def different_pixels(one: npt.NDArray[np.float32], other: npt.NDArray[np.float32]) -> int:
    """Count the pixels whose bits differ; all of them if the sizes do."""
    if one.shape != other.shape:
        return max(one.size, other.size) // 3
    bits = np.ascontiguousarray(one).view(np.uint32) != np.ascontiguousarray(other).view(np.uint32)
    return int(np.count_nonzero(bits.any(axis=-1)))


def compare(report: Report, folder: Path) -> None:
    """Compare the bits of every repetition of every method with the reference picture."""
    reference = reference_of(report.combinations)
    if reference is None:
        return
    report.reference = reference.method
    right = reference.pictures[0]
    expected = np.load(folder / f"{right}.npy")
    shown = folder / f"{right}.png"
    if shown.exists():
        report.drawings.picture = shown.read_bytes()
    for combination in report.combinations:
        if not combination.pictures:
            continue
        others = set(combination.pictures) - {right}
        combination.same = not others
        combination.different_pixels = max(
            (different_pixels(expected, np.load(folder / f"{name}.npy")) for name in others),
            default=0,
        )
