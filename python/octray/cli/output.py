"""Where pictures go: a file that appears complete or not at all, or standard output."""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from octray.cli.exits import FailureError

if TYPE_CHECKING:
    from octray import Image

View = Literal["neutral", "standard", "raw"]
FORMATS = {".png": "png", ".exr": "exr"}


class Output:
    """A place for one picture, checked before the work starts."""

    def __init__(self, given: str | None, scene: Path) -> None:
        """Take ``-o``; by default the scene's name with ``.png``, in the current directory."""
        self.to_stdout = given == "-"
        name = given if given is not None else f"{scene.stem or 'octray'}.png"
        self.path = Path(name)
        if self.to_stdout:
            self.format = "png"
            if sys.stdout.isatty():
                raise click.UsageError("-o - writes a PNG: redirect standard output to a file")
            return
        suffix = self.path.suffix.lower()
        if suffix not in FORMATS:
            raise click.UsageError(f"-o {name}: the name must end in .png or .exr (or be -)")
        self.format = FORMATS[suffix]
        folder = self.path.parent
        if not folder.is_dir():
            raise FailureError(f"{name}: there is no directory {folder}")
        if self.path.is_dir():
            raise FailureError(f"{name} is a directory")
        if not os.access(folder, os.W_OK):
            raise FailureError(f"{name}: no permission to write to {folder}")

    def write(self, image: Image, view: View | None) -> None:
        """Write the picture."""
        data = image.to_bytes(self.format, view=view)
        if self.to_stdout:
            sys.stdout.buffer.write(data)
            sys.stdout.buffer.flush()
            return
        try:
            replace_file(self.path, data)
        except OSError as error:
            raise FailureError(f"{self.path}: {error.strerror or error}") from error


def replace_file(path: Path, data: bytes) -> None:
    """Write ``data`` beside ``path``, then rename: nobody ever sees half a file."""
    handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        # mkstemp makes private files; a picture gets the permissions any new file gets.
        mask = os.umask(0)
        os.umask(mask)
        Path(temporary).chmod(0o666 & ~mask)
        Path(temporary).replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            Path(temporary).unlink()
        raise
