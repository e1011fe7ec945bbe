"""Ray tracing of exact CSG solids and triangle meshes on an octree.

Right-handed coordinates, z up, angles in degrees; numbers are float64. Colours are three numbers
in linear light, or text such as ``"#b8c4d0"`` in sRGB.

>>> import octray
>>> body = octray.box((40, 30, 10)) - octray.cylinder(r=4, h=20)
>>> scene = octray.Scene(units="mm")
>>> scene.add(body, name="bracket", material="#b8c4d0")
0
>>> octray.render(scene, size=(64, 48))
<octray.Image 64x48>
>>> scene.cast_rays([0, 0, 100, 0, 0, -1]).hit.item()
False
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from octray._core import (
    Camera,
    Cells,
    Diagnostic,
    DirectionalLight,
    Hits,
    Image,
    Intersections,
    Light,
    Material,
    Outline,
    PointLight,
    Scene,
    SceneError,
    Solid,
    SpotLight,
    __version__,
    box,
    cone,
    cubic,
    cylinder,
    difference,
    empty,
    half_space,
    intersection,
    lathe,
    load,
    mesh_solid,
    methods,
    polyhedron,
    polynomial,
    prism,
    quadric,
    quartic,
    sphere,
    superellipsoid,
    torus,
    union,
)

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from octray._options import RenderOptions

__all__ = [
    "Camera",
    "Cells",
    "Diagnostic",
    "DirectionalLight",
    "Hits",
    "Image",
    "Intersections",
    "Light",
    "Material",
    "Outline",
    "PointLight",
    "Scene",
    "SceneError",
    "Solid",
    "SpotLight",
    "__version__",
    "box",
    "cone",
    "cubic",
    "cylinder",
    "difference",
    "empty",
    "half_space",
    "intersection",
    "lathe",
    "load",
    "mesh_solid",
    "methods",
    "polyhedron",
    "polynomial",
    "prism",
    "quadric",
    "quartic",
    "render",
    "sphere",
    "superellipsoid",
    "torus",
    "union",
]


def render(scene: Scene, **options: Unpack[RenderOptions]) -> Image:
    """Render a picture of the scene: the same as ``scene.render``."""
    return scene.render(**options)
