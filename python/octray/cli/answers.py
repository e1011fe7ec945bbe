"""Answers to rays on their way into a file, piece by piece.

A file appears complete or not at all: it is written beside its place and renamed at the end.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import shutil
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy.typing as npt
    from typing_extensions import Self

    from octray._answers import Columns


class Writer:
    """Takes columns of answers; as a context it takes away what is half done."""

    def __enter__(self) -> Self:
        """Make room."""
        return self

    def __exit__(self, *details: object) -> None:
        """Take away everything but the finished file."""

    def add(self, columns: Columns) -> None:
        """Write the answers for the next rays."""
        raise NotImplementedError

    def finish(self, labels: dict[str, list[str]]) -> None:
        """Complete the file; ``labels`` are the names of what the answers have ids of."""
        raise NotImplementedError


def _temporary_beside(path: Path) -> Path:
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    os.close(handle)
    return Path(name)


def _publish(temporary: Path, path: Path) -> None:
    """Put a finished file in its place, with the permissions that new files get."""
    mask = os.umask(0)
    os.umask(mask)
    temporary.chmod(0o666 & ~mask)
    temporary.replace(path)


def _plain(value: Any) -> Any:
    """Give a value that JSON has: infinity and NaN become null."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return value


class JsonLines(Writer):
    """One JSON object for each ray, in a file or on standard output."""

    def __init__(self, path: Path | None) -> None:
        """Write to ``path``, or to standard output."""
        # A link keeps pointing where it points.
        self._path = path.resolve() if path else None
        self._temporary: Path | None = None
        self._stream: IO[str] = sys.stdout
        self._next = 0

    def __enter__(self) -> Self:
        """Open the file."""
        if self._path is not None:
            self._temporary = _temporary_beside(self._path)
            self._stream = self._temporary.open("w", encoding="utf-8")
        return self

    def __exit__(self, *details: object) -> None:
        """Take away everything but the finished file."""
        if self._temporary is not None:
            self._stream.close()
            self._temporary.unlink(missing_ok=True)

    def add(self, columns: Columns) -> None:
        """Write the answers for the next rays."""
        counts, arrays = columns
        names = list(arrays)
        rows = zip(*(array.tolist() for array in arrays.values()), strict=True)
        entries = (dict(zip(names, map(_plain, row), strict=True)) for row in rows)
        if counts is None:
            for entry in entries:
                self._write(entry)
        else:
            for count in counts.tolist():
                self._write({"intervals": [next(entries) for _ in range(count)]})
        self._stream.flush()

    def _write(self, answer: dict[str, Any]) -> None:
        line = json.dumps({"ray": self._next, **answer}, allow_nan=False)
        self._stream.write(line + "\n")
        self._next += 1

    def finish(self, labels: dict[str, list[str]]) -> None:
        """Put the file in its place."""
        del labels
        if self._temporary is not None and self._path is not None:
            self._stream.close()
            _publish(self._temporary, self._path)
            self._temporary = None


class Npz(Writer):
    """Arrays in a NumPy archive; each grows in a file of its own until its length is known."""

    def __init__(self, path: Path) -> None:
        """Write to ``path``."""
        self._path = path.resolve()
        self._folder: Path | None = None
        self._columns: dict[str, _Column] = {}
        self._total = 0

    def __enter__(self) -> Self:
        """Make a folder for the columns, beside the archive."""
        name = tempfile.mkdtemp(prefix=f".{self._path.name}.", dir=self._path.parent)
        self._folder = Path(name)
        return self

    def __exit__(self, *details: object) -> None:
        """Take away everything but the finished archive."""
        for column in self._columns.values():
            with contextlib.suppress(OSError):
                column.file.close()
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)

    def add(self, columns: Columns) -> None:
        """Write the answers for the next rays."""
        import numpy as np

        counts, arrays = columns
        if counts is not None:
            if "offsets" not in self._columns:
                self._append("offsets", np.zeros(1, dtype=np.int64))
            self._append("offsets", self._total + np.cumsum(counts))
            self._total += int(counts.sum())
        for name, array in arrays.items():
            self._append(name, array)

    def _append(self, name: str, array: npt.NDArray[Any]) -> None:
        if self._folder is None:
            raise ValueError("the archive is not open")
        if name not in self._columns:
            self._columns[name] = _Column(self._folder / name, array)
        self._columns[name].append(array)

    def finish(self, labels: dict[str, list[str]]) -> None:
        """Put the columns together and the archive in its place."""
        import numpy as np

        if self._folder is None:
            raise ValueError("the archive is not open")
        temporary = self._folder / "archive"
        with zipfile.ZipFile(temporary, "w", zipfile.ZIP_STORED, allowZip64=True) as archive:
            for name, column in self._columns.items():
                # The date in it is always the same, so that equal answers are equal files.
                info = zipfile.ZipInfo(f"{name}.npy")
                with archive.open(info, "w", force_zip64=True) as member:
                    for block in column.blocks():
                        member.write(block)
                column.remove()
            for name, texts in labels.items():
                with archive.open(zipfile.ZipInfo(f"{name}.npy"), "w") as member:
                    np.lib.format.write_array(member, np.array(texts, dtype=np.str_))
        _publish(temporary, self._path)


class _Column:
    """An array that grows on disk."""

    def __init__(self, path: Path, like: npt.NDArray[Any]) -> None:
        self._path = path
        self._dtype = like.dtype
        self._row_shape = like.shape[1:]
        self._length = 0
        self.file = path.open("w+b")

    def append(self, array: npt.NDArray[Any]) -> None:
        """Add rows at the end."""
        self.file.write(array.astype(self._dtype, order="C", copy=False).tobytes())
        self._length += len(array)

    def blocks(self) -> Iterator[bytes]:
        """Yield the bytes of a .npy file with all rows."""
        import io

        import numpy as np

        header = io.BytesIO()
        about = {
            "descr": np.lib.format.dtype_to_descr(self._dtype),
            "fortran_order": False,
            "shape": (self._length, *self._row_shape),
        }
        np.lib.format.write_array_header_1_0(header, about)
        yield header.getvalue()
        self.file.seek(0)
        while block := self.file.read(1 << 22):
            yield block

    def remove(self) -> None:
        """Free the space on the disk."""
        self.file.close()
        self._path.unlink()
