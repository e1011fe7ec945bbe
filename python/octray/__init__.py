"""Ray tracing of exact CSG solids and triangle meshes on an octree.

Right-handed coordinates, z up, angles in degrees; numbers are float64. Colours are three numbers
in linear light, or text such as ``"#b8c4d0"`` in sRGB.

>>> import octray
>>> body = octray.box((40, 30, 10)) - octray.cylinder(r=4, h=20)
>>> scene = octray.Scene(units="mm")
>>> scene.add(body, name="bracket", material="#b8c4d0")
0
"""

from octray._core import (
    Camera,
    Diagnostic,
    DirectionalLight,
    Light,
    Material,
    PointLight,
    Scene,
    SceneError,
    Solid,
    SpotLight,
    __version__,
    box,
    cone,
    cylinder,
    difference,
    empty,
    half_space,
    intersection,
    load,
    mesh_solid,
    polyhedron,
    sphere,
    torus,
    union,
)

__all__ = [
    "Camera",
    "Diagnostic",
    "DirectionalLight",
    "Light",
    "Material",
    "PointLight",
    "Scene",
    "SceneError",
    "Solid",
    "SpotLight",
    "__version__",
    "box",
    "cone",
    "cylinder",
    "difference",
    "empty",
    "half_space",
    "intersection",
    "load",
    "mesh_solid",
    "polyhedron",
    "sphere",
    "torus",
    "union",
]
