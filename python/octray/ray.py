"""Ray queries under the names, argument orders and return orders of trimesh's ``mesh.ray``.

Code that was written for ``mesh.ray`` runs with ``scene.ray``; what differs is said here:

* Distances are exact to rounding (float64), hits are never doubled at edges, and come ordered by
  ray and then by distance.
* ``index_tri`` numbers all faces object by object: in a scene of one mesh it is the triangle; the
  triangles of several meshes follow one another as in a concatenation of them. The faces of exact
  solids have numbers in the same row.
* Surfaces count at t > 0, solids' and sheets' alike; where two solids touch there is one hit.
* ``contains_points`` asks for solids. A mesh has an inside if it was added with ``solid=True``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, overload

import numpy as np

if TYPE_CHECKING:
    from typing import TypeAlias

    import numpy.typing as npt

    from octray._core import Scene

    _Floats: TypeAlias = npt.NDArray[np.float64]
    _Integers: TypeAlias = npt.NDArray[np.int64]
    _Booleans: TypeAlias = npt.NDArray[np.bool_]

__all__ = ["RayIntersector"]


def _vectors(what: str, values: npt.ArrayLike) -> _Floats:
    array = np.asarray(values)
    if array.shape == (0,):
        array = array.reshape(0, 3)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "fiu":  # noqa: PLR2004
        raise ValueError(
            f"{what} must be an array of real numbers of shape (n, 3),"
            f" not shape {array.shape} of {array.dtype}"
        )
    return array.astype(np.float64, copy=False)


def _rays(ray_origins: npt.ArrayLike, ray_directions: npt.ArrayLike) -> _Floats:
    origins = _vectors("ray_origins", ray_origins)
    directions = _vectors("ray_directions", ray_directions)
    if origins.shape != directions.shape:
        raise ValueError(
            f"there must be as many ray_directions as ray_origins,"
            f" not {len(directions)} and {len(origins)}"
        )
    return np.concatenate([origins, directions], axis=1)


def _locations(rays: _Floats, index_ray: _Integers, t: _Floats) -> _Floats:
    met = rays[index_ray]
    return met[:, :3] + t[:, None] * met[:, 3:]


class RayIntersector:
    """Asks a scene about rays the way trimesh asks a mesh. Get it as ``scene.ray``."""

    def __init__(self, scene: Scene) -> None:
        """Ask ``scene``, as it stands whenever a question is asked."""
        self._scene = scene

    @overload
    def intersects_id(
        self,
        ray_origins: npt.ArrayLike,
        ray_directions: npt.ArrayLike,
        multiple_hits: bool = ...,
        max_hits: int | None = ...,
        return_locations: Literal[False] = ...,
    ) -> tuple[_Integers, _Integers]: ...

    @overload
    def intersects_id(
        self,
        ray_origins: npt.ArrayLike,
        ray_directions: npt.ArrayLike,
        multiple_hits: bool = ...,
        max_hits: int | None = ...,
        *,
        return_locations: Literal[True],
    ) -> tuple[_Integers, _Integers, _Floats]: ...

    def intersects_id(
        self,
        ray_origins: npt.ArrayLike,
        ray_directions: npt.ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
        return_locations: bool = False,
    ) -> tuple[_Integers, _Integers] | tuple[_Integers, _Integers, _Floats]:
        """Find the faces that rays hit, with ``multiple_hits`` all of them, else the first.

        Origins and directions are (n, 3). Returns ``index_tri`` (h,), ``index_ray`` (h,) and, with
        ``return_locations``, ``locations`` (h, 3); at most ``max_hits`` for each ray.
        """
        rays = _rays(ray_origins, ray_directions)
        index_ray, index_tri, t = self._hits(rays, multiple_hits, max_hits)
        if return_locations:
            return index_tri, index_ray, _locations(rays, index_ray, t)
        return index_tri, index_ray

    def intersects_location(
        self,
        ray_origins: npt.ArrayLike,
        ray_directions: npt.ArrayLike,
        multiple_hits: bool = True,
    ) -> tuple[_Floats, _Integers, _Integers]:
        """Find where rays hit: ``locations`` (h, 3), ``index_ray`` (h,) and ``index_tri`` (h,)."""
        rays = _rays(ray_origins, ray_directions)
        index_ray, index_tri, t = self._hits(rays, multiple_hits, None)
        return _locations(rays, index_ray, t), index_ray, index_tri

    def intersects_first(
        self, ray_origins: npt.ArrayLike, ray_directions: npt.ArrayLike
    ) -> _Integers:
        """Find the first face that each ray hits, -1 if it hits none: (n,)."""
        rays = _rays(ray_origins, ray_directions)
        index_ray, index_tri, _ = self._hits(rays, False, None)
        first = np.full(len(rays), -1, dtype=np.int64)
        first[index_ray] = index_tri
        return first

    def intersects_any(
        self, ray_origins: npt.ArrayLike, ray_directions: npt.ArrayLike
    ) -> _Booleans:
        """Find out whether each ray hits anything: (n,)."""
        return self._scene.test_occlusions(_rays(ray_origins, ray_directions))

    def contains_points(self, points: npt.ArrayLike) -> _Booleans:
        """Find out whether each of the points (n, 3) lies in a solid: (n,)."""
        return self._scene.compute_occupancy(_vectors("points", points))

    def _hits(
        self, rays: _Floats, multiple_hits: bool, max_hits: int | None
    ) -> tuple[_Integers, _Integers, _Floats]:
        if max_hits is not None and max_hits < 1:
            raise ValueError(f"max_hits must be at least 1, not {max_hits}")
        limit = max_hits if multiple_hits else 1
        return self._scene._crossings(rays, limit)  # noqa: SLF001
