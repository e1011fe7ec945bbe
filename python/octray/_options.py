"""The types of arguments that several functions share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypedDict

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from octray._core import Image

#: How surfaces are found: ``auto``, ``brute``, ``spheres``, ``boxes``, ``grid[:N]`` or
#: ``octree[:ENCODING[:TRAVERSAL[:MEMBERSHIP]]]``, as in ``octree:tree:beam:shells``;
#: ``octray.methods()`` lists all of them. The answers are the same bits.
Accel = str
#: How long the tree over the triangles of meshes may take to build.
Quality = Literal["fast", "full"]
MeshRule = Literal["strict", "winding"]
#: Whose intervals count where solids overlap.
Overlaps = Literal["regions", "priorities", "objects"]
#: What a pixel shows: light, or what the rays of its light cost.
Integrator = Literal["whitted", "cost"]
#: How light becomes the colours of a PNG.
View = Literal["neutral", "standard", "raw"]


class RenderOptions(TypedDict, total=False):
    """What ``Scene.render`` can be told, all by keyword."""

    size: tuple[int, int] | None
    spp: int
    threads: int | None
    accel: Accel
    crop: tuple[int, int, int, int] | None
    view: View | None
    max_depth: int | None
    threshold: float | None
    seed: int
    progress: bool | Callable[[float], object] | None
    preview: Callable[[Image], object] | None
    on_interrupt: Literal["raise", "return"]
    integrator: Integrator
    checkpoint: str | os.PathLike[str] | None
    resume: bool
