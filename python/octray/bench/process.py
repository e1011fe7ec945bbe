"""Runs a command and measures it from outside."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_LAUNCHER = Path(__file__).with_name("launcher.py")
#: How many characters of what a failing program said are kept.
_LAST_WORDS = 300


class RunError(Exception):
    """A program did not do its work; ``status`` says why in a word of the report."""

    def __init__(self, status: str, message: str) -> None:
        """Keep the status, one of ``Status``, and the reason in words."""
        super().__init__(message)
        self.status = status


@dataclass(frozen=True)
class Cost:
    """What a command cost as a whole, and what it said."""

    wall_s: float
    cpu_s: float
    peak_bytes: int
    text: str


def supported() -> bool:
    """Say whether this system tells what a process cost."""
    return hasattr(os, "wait4") and hasattr(os, "posix_spawnp")


def measure(
    command: list[str], folder: Path, timeout: float | None, environment: dict[str, str]
) -> Cost:
    """Run the command in the folder; it is killed if it takes longer than ``timeout`` seconds.

    Raises ``RunError`` if it cannot be started, fails, or is late. Ctrl-C does not reach it: it is
    killed on the way out.
    """
    log = folder / "log"
    launcher = subprocess.Popen(  # noqa: S603 - programs that the user installed
        [sys.executable, "-I", "-S", str(_LAUNCHER), str(log), *command],
        cwd=folder,
        stdout=subprocess.PIPE,
        env={**os.environ, "LC_ALL": "C", **environment},  # numbers with a point
        start_new_session=True,
    )
    try:
        out, _ = launcher.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        _end(launcher)
        raise RunError("out of time", f"not done after {timeout:.3g} s") from None
    except BaseException:
        _end(launcher)
        raise
    text = log.read_text(encoding="utf-8", errors="replace") if log.exists() else ""
    try:
        cost: dict[str, Any] = json.loads(out)
    except ValueError:
        raise RunError("failed", "its launcher was killed") from None
    if "error" in cost:
        raise RunError("failed", f"it does not start: {cost['error']}")
    if cost["exit"] != 0:
        raise RunError("failed", f"exit status {cost['exit']}: {_last_words(text)}")
    return Cost(cost["wall_s"], cost["cpu_s"], cost["peak_bytes"], text)


def _end(launcher: subprocess.Popen[bytes]) -> None:
    """End the launcher and its command, which is in its group."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(launcher.pid, signal.SIGKILL)
    launcher.communicate()


def _last_words(text: str) -> str:
    return " ".join(text.split())[-_LAST_WORDS:]
