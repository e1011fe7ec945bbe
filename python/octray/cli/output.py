"""Where pictures go: a file that appears complete or not at all, or standard output."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from octray.cli.exits import FailureError

if TYPE_CHECKING:
    from octray import Image
    from octray._options import View


def check_place(path: Path) -> None:
    """Refuse, before the work starts, a place where no file can be written."""
    folder = path.parent
    if not folder.is_dir():
        raise FailureError(f"{path}: there is no directory {folder}")
    if path.is_dir():
        raise FailureError(f"{path} is a directory")
    if not os.access(folder, os.W_OK):
        raise FailureError(f"{path}: no permission to write to {folder}")


class Output:
    """A place for one picture, checked before the work starts."""

    def __init__(self, given: str | None, scene: str) -> None:
        """Take ``-o``; by default the scene's name with ``.png``, in the current directory."""
        self.to_stdout = given == "-"
        self.path = Path(f"{Path(scene).stem or 'octray'}.png" if given is None else given)
        self.name = "standard output" if self.to_stdout else str(self.path)
        self.format = "png" if self.to_stdout else self.path.suffix.lower().removeprefix(".")
        self.written = False
        if self.to_stdout:
            if sys.stdout.isatty():
                raise click.UsageError("-o - writes a PNG: redirect standard output to a file")
            return
        if self.format not in {"png", "exr"}:
            raise click.UsageError(f"-o {given}: the name must end in .png or .exr (or be -)")
        check_place(self.path)

    def write(self, image: Image, view: View | None) -> None:
        """Write the picture, or write it again."""
        if self.to_stdout:
            sys.stdout.buffer.write(image.to_bytes("png", view=view))
            sys.stdout.buffer.flush()
        else:
            try:
                image.save(self.path, view=view)
            except OSError as error:
                raise FailureError(f"{self.path}: {error.strerror or error}") from error
        self.written = True
