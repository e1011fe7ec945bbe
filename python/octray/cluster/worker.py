"""What runs in the other processes. Nothing of the engine is in here."""

from __future__ import annotations

import functools
import hashlib
import os
import platform
import resource
import socket
import time
from pathlib import Path
from typing import Any


@functools.cache
def identity() -> dict[str, Any]:
    """Say which octray this is: only equal ones make equal pictures for certain."""
    import octray  # noqa: PLC0415 - not before the process is a worker
    from octray import _core  # noqa: PLC0415

    binary = Path(str(_core.__file__)).read_bytes()
    return {
        "version": octray.__version__,
        "binary": hashlib.blake2b(binary, digest_size=16).hexdigest(),
        "python": platform.python_version(),
    }


def proportional_bytes() -> int:
    """Give the memory of this process; what is shared counts by shares, where that is known."""
    try:
        for line in Path("/proc/self/smaps_rollup").read_text(encoding="ascii").splitlines():
            if line.startswith("Pss:"):
                return int(line.split()[1]) << 10
    except OSError:
        pass
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10


class Worker:
    """Has a scene and answers questions about it. A question names the scene's key."""

    def __init__(self, name: str, threads: int) -> None:
        """Take a name for reports, and the threads that may be used."""
        self._name = name
        self._threads = threads
        self._key: str | None = None
        self._scene: Any = None
        self._renderers: dict[str, Any] = {}
        self._load_s = 0.0
        self._last = time.monotonic()
        self._idle = 0.0

    def hello(self) -> dict[str, Any]:
        """Say who this is."""
        return {
            **identity(),
            "name": self._name,
            "pid": os.getpid(),
            "host": socket.gethostname(),
            "threads": self._threads,
        }

    def load(self, key: str, data: Any, accel: str, trees: dict[str, Any]) -> dict[str, Any]:
        """Take a scene as an array of bytes and build its trees."""
        from octray import Scene  # noqa: PLC0415

        start = self._begin()
        if key == self._key:
            return self._account(start, {})
        self._renderers.clear()
        self._key = None
        self._scene = Scene.from_bytes(data)
        self._scene.prepare(accel=accel, threads=self._threads, **trees)
        self._key = key
        self._load_s = time.monotonic() - start
        return self._account(start, {"scene_bytes": len(data), "load_s": self._load_s})

    def render(self, key: str, job: str, settings: dict[str, Any], tiles: list[int]) -> Any:
        """Render tiles of a picture; ``None`` if the scene is not here (this process is new)."""
        from octray._core import TileRenderer  # noqa: PLC0415

        if key != self._key:
            return None
        start = self._begin()
        if job not in self._renderers:
            self._renderers.clear()
            renderer = TileRenderer(self._scene, threads=self._threads, **settings)
            if renderer.job != job:
                raise ValueError("the worker's picture is another one than the driver's")
            self._renderers[job] = renderer
        records, cost = self._renderers[job].render(tiles)
        figures = {
            "trace_s": cost["render_s"],
            "rays": cost["rays"]["total"],
            "bytes_out": len(records),
        }
        return records, self._account(start, figures)

    def query(self, key: str, mode: str, rows: Any, options: dict[str, Any]) -> Any:
        """Answer rays or points; ``None`` if the scene is not here."""
        from octray._answers import columns  # noqa: PLC0415

        if key != self._key:
            return None
        start = self._begin()
        answer = columns(self._scene, mode, rows, {**options, "threads": self._threads})
        arrays = answer[1].values()
        figures = {
            "trace_s": time.monotonic() - start,
            "rays": len(rows),
            "bytes_in": rows.nbytes,
            "bytes_out": sum(array.nbytes for array in arrays),
        }
        return answer, self._account(start, figures)

    def _begin(self) -> float:
        self._idle = time.monotonic() - self._last
        return time.monotonic()

    def _account(self, start: float, figures: dict[str, Any]) -> dict[str, Any]:
        """Give what this call cost, with the state of the process."""
        self._last = time.monotonic()
        usage = resource.getrusage(resource.RUSAGE_SELF)
        return {
            "pid": os.getpid(),
            "busy_s": self._last - start,
            "idle_s": self._idle,
            "cpu_s": usage.ru_utime + usage.ru_stime,
            "peak_bytes": usage.ru_maxrss << 10,
            "memory_bytes": proportional_bytes(),
            **figures,
        }
