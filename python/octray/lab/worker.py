"""One method in a process of its own: ``python -m octray.lab.worker``.

It reads requests and writes answers, one JSON object a line, on standard input and output. A
request names what to ``do``; an answer has an ``error`` if it could not be done. When standard
input ends, the process ends, whatever it was doing.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import queue
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import octray
from octray.lab.machine import address_bytes, resident_bytes

if TYPE_CHECKING:
    import numpy.typing as npt


def limit_memory(extra: int) -> bool:
    """Let the address space grow by ``extra`` bytes more; say whether the system can do that."""
    size = address_bytes()
    if size is None:
        return False
    import resource  # noqa: PLC0415 - only where there is a size of the address space

    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit = size + extra
    if hard != resource.RLIM_INFINITY:
        limit = min(limit, hard)
    resource.setrlimit(resource.RLIMIT_AS, (limit, hard))
    return True


def warm_up(threads: int | None) -> None:
    """Start the threads, so that neither times nor limits of memory meet them later."""
    scene = octray.Scene()
    scene.add(octray.sphere(1))
    scene.render(size=(64, 64), threads=threads)


class Worker:
    """A loaded scene and one method."""

    def __init__(self) -> None:
        """Wait for a scene."""
        self.scene = octray.Scene()
        self.accel = "auto"

    def do_load(
        self,
        *,
        path: str,
        accel: str,
        threads: int | None,
        facets: bool,
        viewall: bool,
        memory: int | None,
    ) -> dict[str, Any]:
        """Read the scene; from now on keep to the limit of memory."""
        warm_up(threads)
        self.accel = accel
        start = time.perf_counter()
        self.scene = octray.load(path, facets=facets)
        seconds = time.perf_counter() - start
        if viewall:
            self.scene.view_all()
        limited = memory is not None and limit_memory(memory)
        return {"load_s": seconds, "limited": limited, "resident_bytes": resident_bytes()}

    def do_build(self, threads: int | None, tree: dict[str, Any]) -> dict[str, Any]:
        """Build what the method needs."""
        start = time.perf_counter()
        self.scene.prepare(accel=self.accel, threads=threads, **tree)
        seconds = time.perf_counter() - start
        return {
            "build_s": seconds,
            "resident_bytes": resident_bytes(),
            "stats": self.scene.stats(accel=self.accel),
        }

    def do_render(self, options: dict[str, Any], folder: str, png: bool) -> dict[str, Any]:
        """Render; leave the picture in the folder under its hash, unless one is there.

        With ``png`` also leave it there as one looks at it.
        """
        image = self.scene.render(accel=self.accel, **_tuples(options))
        pixels = image.to_numpy()
        name = picture_hash(pixels)
        path = Path(folder) / f"{name}.npy"
        if not path.exists():
            save(path, pixels)
            if png:
                image.save(path.with_suffix(".png"))
        return {
            "render_s": image.report["phases"]["render_s"],
            "picture": name,
            "report": image.report,
        }

    def do_cost(self, options: dict[str, Any], file: str) -> dict[str, Any]:
        """Leave the cost of every pixel in a file."""
        image = self.scene.render(accel=self.accel, integrator="cost", **_tuples(options))
        save(Path(file), image.to_numpy())
        return {}

    def do_seen(self, rays: str, file: str) -> dict[str, Any]:
        """Leave in a file the points where rays first meet something."""
        hits = self.scene.cast_rays(np.load(rays), accel=self.accel)
        save(Path(file), hits.position[hits.hit])
        return {}

    def do_cells(self, file: str) -> dict[str, Any]:
        """Leave the cells in a file; without one if the method has none."""
        try:
            cells = self.scene.cells(accel=self.accel)
        except ValueError:  # it divides no space, or there is nothing in it
            return {"cells": 0}
        with Path(file).open("wb") as out:
            np.savez(
                out,
                root=np.array(cells.root),
                bounds=cells.bounds,
                depth=cells.depth,
                occupied=cells.kind == "occupied",
            )
        return {"cells": len(cells)}


def _tuples(options: dict[str, Any]) -> dict[str, Any]:
    """Undo what JSON does to tuples."""
    return {
        name: tuple(value) if isinstance(value, list) else value for name, value in options.items()
    }


def picture_hash(pixels: npt.NDArray[np.float32]) -> str:
    """Give the SHA-256 of a picture's size and of its numbers as little-endian float32."""
    digest = hashlib.sha256(repr(pixels.shape).encode())
    digest.update(np.ascontiguousarray(pixels, dtype="<f4").tobytes())
    return digest.hexdigest()


def save(path: Path, array: npt.NDArray[Any]) -> None:
    """Write an array so that it is there completely or not at all."""
    partial = path.with_name(f"{path.name}.{os.getpid()}")
    with partial.open("wb") as out:
        np.save(out, array)
    partial.replace(path)


def answer(worker: Worker, request: dict[str, Any]) -> dict[str, Any]:
    """Do what is asked; an exception becomes an answer."""
    work = request.pop("do")
    try:
        done: dict[str, Any] = getattr(worker, f"do_{work}")(**request)
    except MemoryError:
        return {"error": "memory", "message": "out of memory"}
    except Exception as error:  # noqa: BLE001 - whatever it is, the others go on
        text = str(error) or type(error).__name__
        # So ends a structure that the limit of memory leaves no room to stay coarser in.
        refused = "bytes, more than the limit of" in text
        return {"error": "memory" if refused else "failed", "message": text}
    return done


def _read_requests(lines: queue.Queue[str]) -> None:
    for line in sys.stdin:
        lines.put(line)
    os._exit(0)  # whoever asked has gone


def main() -> None:
    """Answer requests until there are no more."""
    # Whatever else writes to standard output must not mix with the answers.
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    lines: queue.Queue[str] = queue.Queue()
    threading.Thread(target=_read_requests, args=(lines,), daemon=True).start()
    worker = Worker()
    with contextlib.suppress(BrokenPipeError):
        while True:
            out.write(json.dumps(answer(worker, json.loads(lines.get()))) + "\n")
            out.flush()


if __name__ == "__main__":
    main()
