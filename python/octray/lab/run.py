"""The lab's one entrance for Python programs."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from octray._core import check_request, load, method_name, methods
from octray.lab import machine
from octray.lab.figures import primitives_of
from octray.lab.pictures import compare
from octray.lab.plan import Plan
from octray.lab.result import Combination, Report
from octray.lab.selection import select
from octray.lab.session import Session

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from octray._core import Scene

#: Pixels at most, where neither the caller nor the scene says how many.
_PIXELS = 320 * 240
_DEFAULT_SIZE = (1280, 720)


def run(
    path: str | os.PathLike[str],
    *,
    accel: Sequence[str] = (),
    everything: bool = False,
    repeat: int = 3,
    size: tuple[int, int] | None = None,
    spp: int = 1,
    threads: int | None = None,
    crop: tuple[int, int, int, int] | None = None,
    viewall: bool = False,
    max_depth: int | None = None,
    threshold: float | None = None,
    facets: bool = False,
    tree: Mapping[str, Any] | None = None,
    memory: int | None = None,
    timeout: float | None = None,
    budget: float | None = None,
    drawings: bool = False,
    progress: Callable[[float], object] | None = None,
    scene: Scene | None = None,
) -> Report:
    """Render the scene in the file ``path`` by many methods, and give what that cost.

    Every method builds and renders in a process of its own; ``repeat`` renderings are taken in
    turns, so that all methods meet the same disturbances.

    The methods are those named in ``accel``, or all valid ones if ``everything``, or a selection
    in which every choice occurs once. ``size`` is by default the scene's own, made smaller where
    it has more than 76,800 pixels; ``spp``, ``threads``, ``crop``, ``max_depth`` and
    ``threshold`` are those of ``Scene.render``, ``tree`` are the keywords of ``Scene.prepare``
    about trees. ``memory`` (bytes) is what one method may need beyond its scene, ``timeout``
    (seconds) how long one build or one rendering may take, ``budget`` (seconds) how long it all
    may take; what exceeds them is in the report as such. ``drawings`` collects costs of pixels
    and cells for ``octray.lab.html``. ``progress`` is called with numbers from 0 to 1. ``scene``
    may be what was read from ``path`` already.

    An interruption from the keyboard ends the run; the report says so and has what is done.

    Raises ``ValueError`` for a method or an option that cannot be, before anything runs, and
    what ``octray.load`` raises.
    """
    named = [_known(name) for name in accel]
    _check(repeat=repeat, memory=memory, timeout=timeout, budget=budget)
    request: dict[str, Any] = {
        "spp": spp,
        "crop": crop,
        "max_depth": max_depth,
        "threshold": threshold,
    }
    check_request(size=size, threads=threads, **request)
    if scene is None:
        scene = load(path, facets=facets)
    described = _describe(scene, viewall=viewall)
    size = size or _size(described["size"], crop)
    request["size"] = size
    check_request(threads=threads, **request)
    chosen, word = select(
        methods(), named, everything=everything, primitives=primitives_of(described)
    )
    limits = dict(tree or {})
    if memory is not None and limits.get("tree_memory") is None:
        limits["tree_memory"] = memory
    plan = Plan(
        os.fspath(path),
        facets=facets,
        viewall=viewall,
        repeat=repeat,
        threads=threads,
        memory=memory,
        timeout=timeout,
        budget=budget,
        render={**request, "threads": threads},
        tree=limits,
        drawings=drawings,
    )
    if progress is not None:
        plan.progress = progress
    report = Report(
        os.fspath(path),
        scene=described,
        options=_options(plan),
        machine=machine.describe(),
        combinations=[Combination(name) for name in chosen],
        notes=[word] if word else [],
    )
    with tempfile.TemporaryDirectory(prefix="octray-lab-") as folder:
        Session(plan, report, Path(folder)).run()
        compare(report, Path(folder))
    if len(report.groups) > 1:
        report.notes.append(
            f"the processes of all methods do not fit in memory together: they ran in"
            f" {len(report.groups)} groups, each beside a yardstick of its own"
        )
    return report


def _known(name: str) -> str:
    return name if name == "auto" else method_name(name)


def _check(**limits: float | None) -> None:
    for name, value in limits.items():
        if value is not None and not value > 0:
            raise ValueError(f"{name} must be greater than 0, not {value}")


def _describe(scene: Scene, *, viewall: bool) -> dict[str, Any]:
    """Describe the scene with the camera that its pictures are taken with."""
    described = scene.describe()
    if viewall or described["camera"] is None:
        try:
            scene.view_all()
        except ValueError:
            if viewall:
                raise
        else:
            described["camera"] = scene.describe()["camera"]
    return described


def _size(own: tuple[int, int] | None, crop: tuple[int, int, int, int] | None) -> tuple[int, int]:
    """Give the scene's own size, or one of the same shape with fewer pixels."""
    width, height = own or _DEFAULT_SIZE
    if crop is not None or width * height <= _PIXELS:
        return width, height
    shrink = (_PIXELS / (width * height)) ** 0.5
    return max(round(width * shrink), 1), max(round(height * shrink), 1)


def _options(plan: Plan) -> dict[str, Any]:
    render = dict(plan.render)
    return {
        "size": list(render.pop("size")),
        "crop": None if render["crop"] is None else list(render.pop("crop")),
        **{name: value for name, value in render.items() if name != "crop"},
        "viewall": plan.viewall,
        "facets": plan.facets,
        "tree": plan.tree,
        "repeat": plan.repeat,
        "memory_bytes": plan.memory,
        "timeout_s": plan.timeout,
        "budget_s": plan.budget,
    }
