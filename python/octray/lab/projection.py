"""From points of the scene to pixels of its picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    Floats = npt.NDArray[np.float64]

#: Corners of a box by number: bit 0 is x, bit 1 is y, bit 2 is z.
_EDGES = np.array([(a, a | 1 << bit) for bit in range(3) for a in range(8) if not a & 1 << bit])
#: What lies nearer to the eye than this share of its distance to the picture plane is cut off.
_NEAR = 1e-3


def corners(bounds: Floats) -> Floats:
    """Give the eight corners of boxes (n, 2, 3) as (n, 8, 3)."""
    pick = np.array([[(number >> axis) & 1 for axis in range(3)] for number in range(8)])
    taken: Floats = bounds[:, pick, np.arange(3)]
    return taken


@dataclass
class Projection:
    """A camera as ``Scene.describe`` gives it, and the picture it makes."""

    camera: dict[str, Any]
    #: Width and height of the whole picture, in pixels.
    size: tuple[int, int]
    #: The first column and row of the part that is shown.
    corner: tuple[int, int] = (0, 0)

    def _axes(self) -> tuple[Floats, Floats, Floats]:
        """Give what points forward, and what spans the picture's width and height."""
        camera, (width, height) = self.camera, self.size
        right = np.array(camera["right"], dtype=np.float64)
        if camera["fit_aspect"]:
            right = right * (width / height)
        return np.array(camera["forward"], dtype=np.float64), right, np.array(camera["up"])

    def rays(self, shape: tuple[int, int]) -> Floats:
        """Give the rays through the middles of the part's pixels; ``shape`` is rows and columns."""
        forward, right, up = self._axes()
        width, height = self.size
        u = (np.arange(shape[1]) + self.corner[0] + 0.5) / width - 0.5
        v = 0.5 - (np.arange(shape[0]) + self.corner[1] + 0.5) / height
        across = u[None, :, None] * right + v[:, None, None] * up
        eye = np.array(self.camera["eye"])
        if self.camera["kind"] == "perspective":
            parts = np.broadcast_to(eye, across.shape), forward + across
        else:
            parts = eye + across, np.broadcast_to(forward, across.shape)
        return np.concatenate(parts, axis=-1).reshape(-1, 6)

    def depth_and_pixels(self, points: Floats) -> tuple[Floats, Floats]:
        """Give how far along the view points (..., 3) lie, and their pixels (..., 2)."""
        camera, (width, height) = self.camera, self.size
        axes = np.stack(self._axes(), axis=1)
        # p - eye = s forward + u right + v up, and u, v are across the picture at s = 1.
        s, u, v = np.moveaxis((points - np.array(camera["eye"])) @ np.linalg.inv(axes).T, -1, 0)
        scale = s if camera["kind"] == "perspective" else np.ones_like(s)
        with np.errstate(divide="ignore", invalid="ignore"):
            pixels = np.stack([(u / scale + 0.5) * width, (0.5 - v / scale) * height], axis=-1)
        return s, pixels - np.array(self.corner)

    def edges(self, bounds: Floats) -> Floats:
        """Give the edges of boxes (n, 2, 3) before the camera as lines (m, 2, 2) of pixels.

        Edges that several boxes share come once.
        """
        ends = corners(bounds)[:, _EDGES].reshape(-1, 2, 3)
        ends = np.unique(ends, axis=0)
        if self.camera["kind"] != "perspective":
            return self.depth_and_pixels(ends)[1]
        depth, _ = self.depth_and_pixels(ends)
        ends, depth = ends[(depth > _NEAR).any(axis=1)], depth[(depth > _NEAR).any(axis=1)]
        # Ends behind the eye move along their edges to where the view begins.
        first, second = depth[:, 0], depth[:, 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.clip((_NEAR - first) / (second - first), 0, 1)[:, None]
        crossing = ends[:, 0] + share * (ends[:, 1] - ends[:, 0])
        behind = depth <= _NEAR
        ends = np.where(behind[:, :, None], crossing[:, None], ends)
        return self.depth_and_pixels(ends)[1]


def view(
    camera: dict[str, Any], size: list[int], crop: list[int] | None
) -> tuple[Projection, tuple[int, int]]:
    """Give the projection of a picture or of a part of it, and its rows and columns."""
    x0, y0, x1, y1 = crop or (0, 0, *size)
    return Projection(camera, (size[0], size[1]), (x0, y0)), (y1 - y0, x1 - x0)
