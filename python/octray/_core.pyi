# Types of the compiled module; its docstrings are in the module itself.

import os
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Literal, Protocol, SupportsIndex, TypeAlias, TypedDict, final

import numpy as np
import numpy.typing as npt
from typing_extensions import Unpack, disjoint_base

from octray._options import (
    Accel,
    Integrator,
    MeshRule,
    Overlaps,
    Quality,
    RenderOptions,
    View,
)
from octray.ray import RayIntersector

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
    "TileRenderer",
    "TiledPicture",
    "__version__",
    "box",
    "check_request",
    "cone",
    "cpu_features",
    "cubic",
    "cylinder",
    "default_threads",
    "difference",
    "empty",
    "half_space",
    "intersection",
    "lathe",
    "load",
    "mesh_solid",
    "method_name",
    "methods",
    "polyhedron",
    "polynomial",
    "prism",
    "quadric",
    "quartic",
    "sphere",
    "superellipsoid",
    "torus",
    "union",
]

__version__: str

_Vector: TypeAlias = Iterable[float]
_Color: TypeAlias = str | Iterable[float]
_Side: TypeAlias = Literal["front", "back", "left", "right", "top", "bottom", "iso"]
_Path: TypeAlias = str | os.PathLike[str]
_Point: TypeAlias = tuple[float, float, float]
_Bounds: TypeAlias = tuple[_Point, _Point]
_Floats: TypeAlias = npt.NDArray[np.float64]
_Integers: TypeAlias = npt.NDArray[np.int64]
_Booleans: TypeAlias = npt.NDArray[np.bool_]

class _Triangles(Protocol):
    @property
    def vertices(self) -> npt.ArrayLike: ...
    @property
    def faces(self) -> npt.ArrayLike: ...

_Mesh: TypeAlias = _Path | tuple[npt.ArrayLike, npt.ArrayLike] | _Triangles

@final
class Diagnostic:
    @property
    def severity(self) -> Literal["error", "warning"]: ...
    @property
    def message(self) -> str: ...
    @property
    def help(self) -> str | None: ...
    @property
    def file(self) -> str | None: ...
    @property
    def line(self) -> int | None: ...
    @property
    def column(self) -> int | None: ...
    @property
    def text(self) -> str: ...

class SceneError(ValueError):
    diagnostics: list[Diagnostic]

@final
class Solid:
    def __add__(self, other: Solid, /) -> Solid: ...
    def __radd__(self, other: Solid, /) -> Solid: ...
    def __sub__(self, other: Solid, /) -> Solid: ...
    def __rsub__(self, other: Solid, /) -> Solid: ...
    def __and__(self, other: Solid, /) -> Solid: ...
    def __rand__(self, other: Solid, /) -> Solid: ...
    def __invert__(self) -> Solid: ...
    def complement(self) -> Solid: ...
    def translate(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Solid: ...
    def rotate(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Solid: ...
    def scale(self, factor: float | _Vector) -> Solid: ...
    def mirror(self, normal: _Vector) -> Solid: ...
    def transform(self, matrix: npt.ArrayLike) -> Solid: ...
    @property
    def bounds(self) -> _Bounds | None: ...

_Pair: TypeAlias = tuple[float, float]

@final
class Outline:
    def __new__(cls, x: float, y: float) -> Outline: ...
    @staticmethod
    def circle(r: float, center: _Pair = (0.0, 0.0)) -> Outline: ...
    def line_to(self, x: float, y: float) -> Outline: ...
    def quadratic_to(self, control: _Pair, x: float, y: float) -> Outline: ...
    def cubic_to(self, control1: _Pair, control2: _Pair, x: float, y: float) -> Outline: ...
    def arc_to(self, x: float, y: float, center: _Pair, clockwise: bool = False) -> Outline: ...

_Profile: TypeAlias = Outline | npt.ArrayLike | Sequence[Outline | npt.ArrayLike]

def prism(profile: _Profile, h: float, center: bool = True, scale: float = 1.0) -> Solid: ...
def lathe(profile: _Profile, angle: float = 360.0) -> Solid: ...
def box(size: float | _Vector, center: bool = True) -> Solid: ...
def sphere(r: float) -> Solid: ...
def cylinder(r: float, h: float, center: bool = True) -> Solid: ...
def cone(r1: float, r2: float, h: float, center: bool = True) -> Solid: ...
def torus(R: float, r: float) -> Solid: ...  # noqa: N803 - what everyone calls it
def half_space(normal: _Vector, d: float = 0.0) -> Solid: ...
def quadric(coefficients: Sequence[float]) -> Solid: ...
def cubic(coefficients: Sequence[float]) -> Solid: ...
def quartic(coefficients: Sequence[float]) -> Solid: ...
def polynomial(degree: int, coefficients: Sequence[float]) -> Solid: ...
def superellipsoid(e: float, n: float) -> Solid: ...
def polyhedron(
    vertices: npt.ArrayLike,
    faces: Iterable[Iterable[SupportsIndex]],
    rule: MeshRule = "strict",
) -> Solid: ...
def mesh_solid(
    vertices: npt.ArrayLike, faces: npt.ArrayLike, rule: MeshRule = "strict"
) -> Solid: ...
def empty() -> Solid: ...
def union(*solids: Solid | Iterable[Solid]) -> Solid: ...
def intersection(*solids: Solid | Iterable[Solid]) -> Solid: ...
def difference(*solids: Solid | Iterable[Solid]) -> Solid: ...

@final
class Material:
    def __new__(
        cls,
        color: _Color | None = None,
        *,
        name: str = "material",
        ambient: float | _Color | None = None,
        emission: float | _Color | None = None,
        diffuse: float = 0.9,
        brilliance: float = 1.0,
        phong: float = 0.0,
        phong_size: float = 40.0,
        specular: float = 0.0,
        roughness: float = 0.05,
        metallic: float = 0.0,
        reflection: float | _Color | None = None,
        fresnel: bool = False,
        filter: float = 0.0,  # noqa: A002 - the term of the model
        transmit: float = 0.0,
        ior: float = 1.0,
        absorption: float | _Color | None = None,
    ) -> Material: ...
    @staticmethod
    def glass(
        ior: float = 1.5, *, absorption: float | _Color | None = None, name: str = "glass"
    ) -> Material: ...
    @staticmethod
    def mirror(color: _Color | None = None, *, name: str = "mirror") -> Material: ...
    @staticmethod
    def checker(
        first: _Color,
        second: _Color,
        size: float | _Vector | None = None,
        *,
        reflection: float | _Color | None = None,
        name: str = "checker",
    ) -> Material: ...
    @property
    def name(self) -> str: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@disjoint_base
class Light: ...

@final
class PointLight(Light):
    def __new__(
        cls,
        position: _Vector,
        color: _Color | None = None,
        *,
        strength: float = 1.0,
        falloff: Literal["none", "inverse_square"] = "none",
        shadows: bool = True,
    ) -> PointLight: ...

@final
class SpotLight(Light):
    def __new__(
        cls,
        position: _Vector,
        target: _Vector,
        color: _Color | None = None,
        *,
        inner: float = 20.0,
        outer: float = 30.0,
        tightness: float = 0.0,
        strength: float = 1.0,
        falloff: Literal["none", "inverse_square"] = "none",
        shadows: bool = True,
    ) -> SpotLight: ...

@final
class DirectionalLight(Light):
    def __new__(
        cls,
        direction: _Vector,
        color: _Color | None = None,
        *,
        strength: float = 1.0,
        shadows: bool = True,
    ) -> DirectionalLight: ...

@final
class Camera:
    @staticmethod
    def look_at(
        eye: _Vector,
        target: _Vector | None = None,
        up: _Vector | None = None,
        fov: float = 40.0,
    ) -> Camera: ...
    @staticmethod
    def orthographic(
        eye: _Vector,
        target: _Vector | None = None,
        up: _Vector | None = None,
        *,
        height: float,
    ) -> Camera: ...
    @property
    def eye(self) -> _Point: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Image:
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def complete(self) -> bool: ...
    @property
    def report(self) -> dict[str, Any]: ...
    def to_numpy(self) -> npt.NDArray[np.float32]: ...
    def __array__(
        self, dtype: npt.DTypeLike | None = None, copy: bool | None = None
    ) -> npt.NDArray[Any]: ...
    def to_bytes(
        self,
        format: Literal["png", "exr"] = "png",  # noqa: A002 - as Pillow calls it
        *,
        view: View | None = None,
    ) -> bytes: ...
    def save(self, path: _Path, *, view: View | None = None) -> None: ...
    def _repr_png_(self) -> bytes: ...
    def equals(self, other: Image) -> bool: ...

@final
class Hits:
    @property
    def t(self) -> _Floats: ...
    @property
    def object_id(self) -> _Integers: ...
    @property
    def instance_id(self) -> _Integers: ...
    @property
    def face_id(self) -> _Integers: ...
    @property
    def normal(self) -> _Floats: ...
    @property
    def position(self) -> _Floats: ...
    @property
    def hit(self) -> _Booleans: ...
    @property
    def invalid_rays(self) -> int: ...
    def to_open3d(self) -> dict[str, npt.NDArray[Any]]: ...
    def __len__(self) -> int: ...

@final
class Intersections:
    @property
    def offsets(self) -> _Integers: ...
    @property
    def counts(self) -> _Integers: ...
    @property
    def ray_id(self) -> _Integers: ...
    @property
    def t_enter(self) -> _Floats: ...
    @property
    def t_exit(self) -> _Floats: ...
    @property
    def lengths(self) -> _Floats: ...
    @property
    def object_id(self) -> _Integers: ...
    @property
    def instance_id(self) -> _Integers: ...
    @property
    def material_id(self) -> _Integers: ...
    @property
    def face_enter(self) -> _Integers: ...
    @property
    def face_exit(self) -> _Integers: ...
    @property
    def normal_enter(self) -> _Floats: ...
    @property
    def normal_exit(self) -> _Floats: ...
    @property
    def invalid_rays(self) -> int: ...
    def path_lengths(self, by: Literal["object", "material"] = "object") -> _Floats: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[Intersections]: ...
    def __getitem__(self, key: SupportsIndex | slice, /) -> Intersections: ...

@final
class Cells:
    @property
    def root(self) -> _Bounds: ...
    @property
    def bounds(self) -> _Floats: ...
    @property
    def depth(self) -> _Integers: ...
    @property
    def key(self) -> _Integers: ...
    @property
    def kind(self) -> npt.NDArray[np.str_]: ...
    @property
    def objects(self) -> _Integers: ...
    @property
    def parts(self) -> _Integers: ...
    def __len__(self) -> int: ...

@final
class Scene:
    @property
    def camera(self) -> Camera | None: ...
    @camera.setter
    def camera(self, value: Camera, /) -> None: ...
    def __new__(cls, *, units: str = "", up: _Vector | None = None) -> Scene: ...
    def add(
        self,
        solid: Solid,
        *,
        name: str | None = None,
        material: Material | _Color | None = None,
        priority: int = 0,
        shadows: bool = True,
    ) -> int: ...
    def add_mesh(
        self,
        mesh: _Mesh,
        *,
        name: str | None = None,
        material: Material | _Color | None = None,
        solid: bool | MeshRule | None = None,
        priority: int = 0,
        shadows: bool = True,
    ) -> int: ...
    def add_instances(
        self,
        what: Solid | _Mesh | Sequence[Solid | _Mesh],
        transforms: npt.ArrayLike,
        *,
        name: str | None = None,
        material: Material | _Color | None = None,
        solid: bool | MeshRule | None = None,
        priority: int = 0,
        shadows: bool = True,
    ) -> int: ...
    def add_light(self, light: Light) -> None: ...
    @property
    def background(self) -> list[list[float]]: ...
    @background.setter
    def background(self, value: float | _Color | Sequence[_Color], /) -> None: ...
    def view_all(self) -> None: ...
    def view_from(self, side: _Side) -> None: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def material_names(self) -> list[str]: ...
    @property
    def bounds(self) -> _Bounds | None: ...
    @property
    def diagnostics(self) -> list[Diagnostic]: ...
    def describe(self) -> dict[str, Any]: ...
    def check_meshes(self) -> list[dict[str, Any]]: ...
    def check_surfaces(self) -> dict[str, Any]: ...
    def prepare(
        self,
        *,
        accel: Accel = "auto",
        threads: int | None = None,
        quality: Quality | None = None,
        tree_objects: int | None = None,
        tree_depth: int | None = None,
        tree_cost: float | Literal["off"] | None = None,
        tree_share: float | None = None,
        tree_memory: int | None = None,
        lvsi_table: Literal["prime", "power-of-two"] | None = None,
        lvsi_load: float | None = None,
        cells: _Path | None = None,
    ) -> None: ...
    def dump_cells(
        self,
        path: _Path,
        *,
        accel: Accel = "octree",
        threads: int | None = None,
    ) -> None: ...
    def stats(self, *, accel: Accel = "auto", threads: int | None = None) -> dict[str, Any]: ...
    def cells(
        self,
        *,
        accel: Accel = "auto",
        kind: Literal["solids", "triangles"] = "solids",
        threads: int | None = None,
    ) -> Cells: ...
    def to_bytes(self) -> bytes: ...
    @staticmethod
    def from_bytes(data: bytes | npt.NDArray[np.uint8]) -> Scene: ...
    def render(self, **options: Unpack[RenderOptions]) -> Image: ...
    @property
    def ray(self) -> RayIntersector: ...
    def cast_rays(
        self, rays: npt.ArrayLike, *, accel: Accel = "auto", threads: int | None = None
    ) -> Hits: ...
    def list_intersections(
        self,
        rays: npt.ArrayLike,
        *,
        whole_line: bool = False,
        overlaps: Overlaps = "regions",
        accel: Accel = "auto",
        threads: int | None = None,
    ) -> Intersections: ...
    def iter_intersections(
        self,
        rays: npt.ArrayLike | Iterator[npt.ArrayLike],
        *,
        chunk: int = 65536,
        whole_line: bool = False,
        overlaps: Overlaps = "regions",
        accel: Accel = "auto",
        threads: int | None = None,
    ) -> Iterator[Intersections]: ...
    def count_intersections(
        self,
        rays: npt.ArrayLike,
        *,
        whole_line: bool = False,
        accel: Accel = "auto",
        threads: int | None = None,
    ) -> _Integers: ...
    def test_occlusions(
        self,
        rays: npt.ArrayLike,
        *,
        tfar: float = ...,
        accel: Accel = "auto",
        threads: int | None = None,
    ) -> _Booleans: ...
    def compute_occupancy(
        self, points: npt.ArrayLike, *, accel: Accel = "auto", threads: int | None = None
    ) -> _Booleans: ...
    def locate(
        self, points: npt.ArrayLike, *, accel: Accel = "auto", threads: int | None = None
    ) -> _Integers: ...
    def _crossings(
        self, rays: npt.ArrayLike, limit: int | None = None
    ) -> tuple[_Integers, _Integers, _Floats]: ...
    def _count_invalid_rays(
        self, rays: npt.ArrayLike, *, accel: Accel = "auto", threads: int | None = None
    ) -> int: ...
    def __len__(self) -> int: ...

def load(path: _Path, *, facets: bool = False) -> Scene: ...

class _PictureOptions(TypedDict, total=False):
    size: tuple[int, int] | None
    spp: int
    crop: tuple[int, int, int, int] | None
    view: View | None
    max_depth: int | None
    threshold: float | None
    seed: int
    integrator: Integrator

class _TileOptions(_PictureOptions, total=False):
    accel: Accel
    threads: int | None

@final
class TiledPicture:
    def __new__(cls, scene: Scene, **options: Unpack[_PictureOptions]) -> TiledPicture: ...
    @property
    def tiles(self) -> int: ...
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def job(self) -> str: ...
    def missing(self) -> list[int]: ...
    def take_records(self, records: bytes) -> list[int]: ...
    def checkpoint(self) -> bytes: ...
    def save_checkpoint(self, path: _Path) -> None: ...
    def resume(self, checkpoint: bytes) -> list[int]: ...
    def image(self, report: dict[str, Any] | None = None) -> Image: ...

@final
class TileRenderer:
    def __new__(cls, scene: Scene, **options: Unpack[_TileOptions]) -> TileRenderer: ...
    @property
    def job(self) -> str: ...
    @property
    def build_s(self) -> float: ...
    def render(self, ids: list[int]) -> tuple[bytes, dict[str, Any]]: ...

def check_request(
    *,
    size: tuple[int, int] | None = None,
    spp: int = 1,
    threads: int | None = None,
    crop: tuple[int, int, int, int] | None = None,
    max_depth: int | None = None,
    threshold: float | None = None,
    view: View | None = None,
    integrator: Integrator = "whitted",
) -> None: ...
def cpu_features() -> list[str]: ...
def default_threads() -> int: ...
def methods() -> list[str]: ...
def method_name(name: str) -> str: ...
