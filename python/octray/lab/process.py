"""The lab's side of a worker process: questions, answers, time limits, and how it died."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
import tempfile
import threading
import time
from typing import IO, Any

#: How many characters of what a dying process said are kept.
_LAST_WORDS = 400


class WorkerError(Exception):
    """A worker could not do what it was asked; ``status`` says why in a word of the report."""

    def __init__(self, status: str, message: str) -> None:
        """Keep the status, one of ``Status``, and the reason in words."""
        super().__init__(message)
        self.status = status


class WorkerProcess:
    """One worker. Every question is answered, or it is a ``WorkerError``."""

    def __init__(self) -> None:
        """Start the process, out of reach of the terminal's Ctrl-C: the lab ends it itself."""
        self._errors: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - closed in close()
        self._process = subprocess.Popen(
            [sys.executable, "-m", "octray.lab.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            text=True,
            encoding="utf-8",
            start_new_session=True,
        )
        self._answers: queue.Queue[str | None] = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @property
    def pid(self) -> int:
        """Give the number of the process."""
        return self._process.pid

    def _read(self) -> None:
        assert self._process.stdout is not None  # noqa: S101 - for the type checker
        with self._process.stdout as lines:
            for line in lines:
                self._answers.put(line)
        self._answers.put(None)

    def send(self, do: str, **details: Any) -> None:
        """Ask without waiting for the answer."""
        assert self._process.stdin is not None  # noqa: S101 - for the type checker
        with contextlib.suppress(OSError, ValueError):  # it has died: receiving says how
            self._process.stdin.write(json.dumps({"do": do, **details}) + "\n")
            self._process.stdin.flush()

    def receive(self, timeout: float | None, late: str = "out of time") -> dict[str, Any]:
        """Wait for the answer, at most ``timeout`` seconds; then the status is ``late``."""
        start = time.monotonic()
        try:
            line = self._answers.get(timeout=timeout)
        except queue.Empty:
            self.close()
            spent = time.monotonic() - start
            raise WorkerError(late, f"not done after {spent:.3g} s") from None
        if line is None:
            raise self._death()
        answer: dict[str, Any] = json.loads(line)
        error = answer.get("error")
        if error is not None:
            status = "out of memory" if error == "memory" else "failed"
            raise WorkerError(status, answer["message"])
        return answer

    def ask(
        self, do: str, timeout: float | None, late: str = "out of time", **details: Any
    ) -> dict[str, Any]:
        """Ask and wait for the answer."""
        self.send(do, **details)
        return self.receive(timeout, late)

    def _death(self) -> WorkerError:
        code = self._process.wait()
        words = self._last_words()
        self.close()
        # What Rust says when an allocation fails, and Python where it cannot catch it.
        if "memory allocation of" in words or "MemoryError" in words:
            return WorkerError("out of memory", "an allocation failed")
        if code >= 0:
            how = f"the process ended with exit code {code}"
        else:
            try:
                how = f"the process was ended by {signal.Signals(-code).name}"
            except ValueError:
                how = f"the process was ended by signal {-code}"
            if -code == getattr(signal, "SIGKILL", None):
                how += ", as the system does where memory runs out"
        return WorkerError("failed", f"{how}: {words}" if words else how)

    def _last_words(self) -> str:
        size = self._errors.seek(0, os.SEEK_END)
        self._errors.seek(max(size - _LAST_WORDS, 0))
        return " ".join(self._errors.read().decode(errors="replace").split())

    def close(self) -> None:
        """End the process, if it has not ended."""
        if self._process.poll() is None:
            self._process.kill()
            self._process.wait()
        if self._process.stdin is not None:
            with contextlib.suppress(OSError):
                self._process.stdin.close()
        if not self._errors.closed:
            self._errors.close()
