"""Exit codes, and the one place where exceptions become them."""

from __future__ import annotations

import enum


class Exit(enum.IntEnum):
    """What the process tells its caller."""

    OK = 0
    FAILED = 1
    USAGE = 2
    SCENE = 3
    PARTIAL = 4
    INTERRUPTED = 130


class FailureError(Exception):
    """The run cannot go on; the text is for the user."""

    def __init__(self, message: str, code: Exit = Exit.FAILED) -> None:
        """Keep the message and the exit code it leads to."""
        super().__init__(message)
        self.code = code
