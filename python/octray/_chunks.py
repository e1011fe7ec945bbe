"""Rays that are more than memory holds, a chunk at a time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    import numpy.typing as npt

    from octray._core import Intersections, Scene


def check_chunk(chunk: int) -> None:
    """Refuse a number of rays that is none."""
    if chunk < 1:
        raise ValueError(f"chunk must be at least 1, not {chunk}")


def check_rows(what: str, rows: npt.NDArray[Any], width: int) -> None:
    """Refuse, before any work, what is no array of rows of real numbers."""
    expected = f"{what} must be an array of real numbers of shape (N, {width})"
    if rows.ndim != 2 or rows.shape[1] != width:  # noqa: PLR2004 - rows and columns
        raise ValueError(f"{expected}, not shape {rows.shape}")
    if rows.dtype.kind not in "fiu":
        raise ValueError(f"{expected}, not dtype {rows.dtype}")


def row_chunks(what: str, rows: npt.NDArray[Any], width: int, chunk: int) -> Iterator[Any]:
    """Yield at most ``chunk`` rows at a time; only these are ever read into memory."""
    check_rows(what, rows, width)
    for start in range(0, len(rows), chunk):
        yield rows[start : start + chunk]


def _arrays(rays: Any) -> Iterable[npt.NDArray[Any]]:
    if hasattr(rays, "__next__"):
        return map(np.asarray, rays)
    array = np.asarray(rays)
    check_rows("rays", array, 6)
    return [array]


def iter_intersections(
    scene: Scene, rays: Any, chunk: int, options: dict[str, Any]
) -> Iterator[Intersections]:
    """Check the arguments, and give the iterator that ``Scene.iter_intersections`` promises."""
    check_chunk(chunk)
    # Names of options are checked here, not only when the first chunk is asked for.
    scene.list_intersections(np.empty((0, 6)), **options)
    arrays = _arrays(rays)
    return (
        scene.list_intersections(part, **options)
        for array in arrays
        for part in row_chunks("rays", array, 6, chunk)
    )
