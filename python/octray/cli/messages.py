"""What a scene file's reader has to say, for terminals and for reports."""

from __future__ import annotations

import contextlib
import os
from typing import TYPE_CHECKING

import click

from octray.cli.exits import Exit, FailureError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from octray import Diagnostic, Scene


class RejectedSceneError(FailureError):
    """A scene that is not rendered. Its diagnostics have been shown already."""

    def __init__(self, message: str, diagnostics: list[Diagnostic]) -> None:
        """Keep the diagnostics for the report."""
        super().__init__(message, Exit.SCENE)
        self.diagnostics = diagnostics


def as_dict(diagnostic: Diagnostic) -> dict[str, Any]:
    """Turn a message into an entry of the report."""
    return {
        "severity": diagnostic.severity,
        "message": diagnostic.message,
        "help": diagnostic.help,
        "file": diagnostic.file,
        "line": diagnostic.line,
        "column": diagnostic.column,
    }


def show(diagnostics: list[Diagnostic], *, errors_only: bool) -> None:
    """Print messages on standard error."""
    for diagnostic in diagnostics:
        if diagnostic.severity == "error" or not errors_only:
            click.echo(diagnostic.text, err=True)


def _count(diagnostics: list[Diagnostic], severity: str) -> str:
    number = sum(diagnostic.severity == severity for diagnostic in diagnostics)
    return f"{number} {severity}" if number == 1 else f"{number} {severity}s"


def load(path: str, *, facets: bool, strict: bool, quiet: bool) -> Scene:
    """Read a scene and show what its reader says; refuse it if there is an error."""
    import octray

    try:
        scene = octray.load(path, facets=facets)
    except octray.SceneError as error:
        show(error.diagnostics, errors_only=quiet)
        reason = f"{path}: {_count(error.diagnostics, 'error')}, no picture"
        raise RejectedSceneError(reason, error.diagnostics) from error
    except OSError as error:
        reason = error.strerror or str(error)
        name = os.fspath(error.filename) if error.filename else path
        raise FailureError(f"{name}: {reason}", Exit.SCENE) from error
    warnings = scene.diagnostics
    show(warnings, errors_only=quiet and not strict)
    if strict and warnings:
        reason = f"{path}: {_count(warnings, 'warning')}, and --strict allows none"
        raise RejectedSceneError(reason, warnings)
    return scene


@contextlib.contextmanager
def preparing(path: str) -> Iterator[None]:
    """Turn what is wrong with a scene, once it is made ready for rays, into an end of the run."""
    import octray

    try:
        yield
    except octray.SceneError as error:
        show(error.diagnostics, errors_only=True)
        reason = f"{path}: {_count(error.diagnostics, 'error')}, no picture"
        raise RejectedSceneError(reason, error.diagnostics) from error
    except MemoryError as error:
        raise FailureError(f"{path}: {error}") from error
