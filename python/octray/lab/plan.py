"""What a run of the lab is to do."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


def _no_progress(_fraction: float) -> None:
    pass


@dataclass
class Plan:
    """A scene, options and limits, checked already."""

    #: The scene's file, and how to read it.
    path: str
    facets: bool = False
    viewall: bool = False
    #: How often every method renders.
    repeat: int = 3
    threads: int | None = None
    #: Limits for one method: bytes beyond the scene that was read, seconds of one step.
    memory: int | None = None
    timeout: float | None = None
    #: Seconds for the whole run.
    budget: float | None = None
    #: Arguments of ``Scene.render`` and of ``Scene.prepare``, the method left out.
    render: dict[str, Any] = field(default_factory=dict)
    tree: dict[str, Any] = field(default_factory=dict)
    #: Whether costs of pixels and cells are collected for pictures.
    drawings: bool = False
    #: Is told how much is done, from 0 to 1.
    progress: Callable[[float], object] = _no_progress
