"""The experiments of the lab: which scenes of which size, by which methods, under which options."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from scenes.families import FAMILIES

if TYPE_CHECKING:
    from collections.abc import Iterator

ORDERED = "octree:tree:ordered:analytic"
FUJIMOTO_IWATA = "octree:tree:fujimoto-iwata:analytic"
SUNG = "octree:tree:sung:analytic"
BEAM = "octree:tree:beam:analytic"
LVSI = "octree:lvsi:sung:analytic"
LVSI_EMPTY = "octree:lvsi-empty:sung:analytic"
BY_BOX = "octree:tree:ordered:bounding-box"
BY_SHELLS = "octree:tree:ordered:shells"

#: What grows with the scene. Flat methods test every object, and go to 10^4 only; of a million
#: shapes fewer methods are asked, because building takes long.
FLAT = ("spheres", "boxes")
GROWING = ("auto", "grid", ORDERED, FUJIMOTO_IWATA, BEAM, LVSI, LVSI_EMPTY, BY_BOX)
GROWN = ("grid", ORDERED, LVSI, LVSI_EMPTY, BY_BOX)
#: Where the CSG tree is what matters, and up to which size these builders are asked.
OPERANDS = (BY_SHELLS, "octree:tree:ordered:bounding-cover")
#: Not touched by any option about octrees: what the times of a sweep are measured by.
CONTROL = "grid:32"


@dataclass(frozen=True)
class Job:
    """One scene by some methods, in turns."""

    #: ``comparison``, ``growth``, ``table``, ``criteria``; ``brute`` joins the growth before it.
    experiment: str
    #: A family's name, or ``scan`` for the mesh of the corpus.
    scene: str
    #: About how many shapes.
    shapes: int
    #: The methods; none stands for the lab's own selection.
    methods: tuple[str, ...] = ()
    #: Keywords of ``Scene.prepare``, and the words for them in a table.
    tree: dict[str, Any] = field(default_factory=dict)
    label: str = ""
    #: Seconds of one build or one rendering at most.
    timeout: float = 20.0
    #: What is other than in the mode.
    size: tuple[int, int] | None = None
    repeat: int | None = None


@dataclass(frozen=True)
class Mode:
    """How much is done."""

    name: str
    #: Width and height of the pictures, and how often each is rendered.
    size: tuple[int, int]
    repeat: int
    #: Width and height of the pictures along brute force's growth curve.
    small: tuple[int, int]
    #: Shapes of the scenes that all methods are compared on.
    middle: int
    #: Shapes of the growth curves, and the most that flat methods are asked.
    growth: tuple[int, ...]
    flat_limit: int
    #: Families of the comparison, of the growth curves and of the sweeps.
    compared: tuple[str, ...]
    growing: tuple[str, ...]
    swept: tuple[str, ...]
    #: Which settings of the criteria: all, or every how manyth.
    every: int
    #: Seconds for everything.
    budget: float
    timeout: float


MODES = {
    mode.name: mode
    for mode in (
        Mode(
            name="full",
            size=(128, 96),
            repeat=3,
            small=(24, 18),
            middle=10_000,
            growth=(100, 1_000, 10_000, 100_000, 1_000_000),
            flat_limit=10_000,
            compared=(*FAMILIES, "scan"),
            growing=("balls", "mount", "drilled", "stadium"),
            swept=("balls", "drilled", "rings", "tetra"),
            every=1,
            budget=3900,
            timeout=20,
        ),
        Mode(
            name="quick",
            size=(64, 48),
            repeat=2,
            small=(24, 18),
            middle=1_000,
            growth=(100, 1_000),
            flat_limit=1_000,
            compared=(*FAMILIES, "scan"),
            growing=("balls", "drilled"),
            swept=("balls",),
            every=2,
            budget=90,
            timeout=2,
        ),
        Mode(
            name="tiny",
            size=(16, 12),
            repeat=1,
            small=(8, 6),
            middle=100,
            growth=(10, 100),
            flat_limit=100,
            compared=("balls",),
            growing=("drilled",),
            swept=("balls",),
            every=5,
            budget=600,
            timeout=120,
        ),
    )
}

#: Sizes of the hash table: the next prime, the next power of two, and primes by how full it gets.
TABLES: tuple[tuple[str, dict[str, Any]], ...] = (
    ("prime", {"lvsi_table": "prime"}),
    ("power of two", {"lvsi_table": "power-of-two"}),
    ("prime, a quarter full", {"lvsi_table": "prime", "lvsi_load": 0.25}),
    ("prime, twice full", {"lvsi_table": "prime", "lvsi_load": 2.0}),
)

#: One criterion changed at a time; the label says which cells are divided.
CRITERIA: tuple[tuple[str, dict[str, Any]], ...] = (
    ("default", {}),
    *((f"depth <= {n}", {"tree_depth": n}) for n in (3, 5, 7, 9, 12)),
    *((f"objects > {n}", {"tree_objects": n}) for n in (1, 4, 16, 64)),
    *((f"share <= {x}", {"tree_share": x}) for x in (0.1, 0.5, 0.9)),
    *((f"cost of a cell {n}", {"tree_cost": n}) for n in (1, 16)),
    ("no cost", {"tree_cost": "off"}),
    *((f"memory {n} MiB", {"tree_memory": n << 20}) for n in (1, 4)),
)


def jobs(mode: Mode) -> Iterator[Job]:
    """Everything in order of importance: what the budget cuts off comes last.

    A little of each experiment comes first, so that there is a page whatever is cut off.
    """
    yield from _comparison(mode, mode.compared[:1])
    small, medium, large = (
        [n for n in mode.growth if least < n <= most]
        for least, most in ((0, 1_000), (1_000, 10_000), (10_000, 10**9))
    )
    yield from _growth(mode, small)
    yield from _sweeps(mode, mode.swept[:1])
    yield from _comparison(mode, mode.compared[1:])
    yield from _growth(mode, medium)
    yield from _sweeps(mode, mode.swept[1:])
    yield from _growth(mode, large)


def _comparison(mode: Mode, scenes: tuple[str, ...]) -> Iterator[Job]:
    for scene in scenes:
        yield Job("comparison", scene, mode.middle, timeout=mode.timeout)


def _growth(mode: Mode, sizes: list[int]) -> Iterator[Job]:
    for shapes, scene in itertools.product(sizes, mode.growing):
        many = shapes > 100_000
        methods: tuple[str, ...] = GROWN if many else GROWING
        if scene == "drilled" and many:
            methods = ("grid", ORDERED)  # each takes gigabytes while it builds
        if scene == "mount" and many:
            methods = ("auto", *methods)  # it has a structure of its own for triangles
        if shapes <= mode.flat_limit:
            methods = (*FLAT, *methods)
        if scene == "drilled" and not many:
            methods = (*methods, *OPERANDS)
        # Building a million takes longer than rendering it.
        timeout, repeat = (mode.timeout * 4, 2) if many else (mode.timeout, None)
        yield Job("growth", scene, shapes, methods, timeout=timeout, repeat=repeat)
        if shapes <= mode.flat_limit:
            methods = ("auto", "brute")
            yield Job("brute", scene, shapes, methods, timeout=mode.timeout, size=mode.small)


def _sweeps(mode: Mode, scenes: tuple[str, ...]) -> Iterator[Job]:
    for scene in scenes:
        for label, tree in TABLES:
            hashed = (CONTROL, LVSI, LVSI_EMPTY)
            yield Job("table", scene, mode.middle, hashed, tree, label, mode.timeout)
        for label, tree in CRITERIA[:: mode.every]:
            divided = (CONTROL, ORDERED)
            yield Job("criteria", scene, mode.middle, divided, tree, label, mode.timeout)
