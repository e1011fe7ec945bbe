"""Which cluster is meant: ``local``, ``local:4``, ``auto``, or ``HOST:PORT``."""

from __future__ import annotations

import os
import re
from typing import NamedTuple

#: More than any machine has use for.
_MAX_WORKERS = 1024


class Address(NamedTuple):
    """A cluster on this machine with so many workers, or one that runs already."""

    #: Workers to start here; ``None`` to join.
    workers: int | None
    #: ``HOST:PORT`` of the head, or ``auto`` for the one that runs on this machine.
    join: str | None

    @classmethod
    def parse(cls, text: str) -> Address:
        """Read what the user wrote; a ValueError says what is possible."""
        if text == "local":
            return cls(len(os.sched_getaffinity(0)), None)
        if match := re.fullmatch(r"local:(\d{1,6})", text, re.ASCII):
            workers = int(match[1])
            if not 1 <= workers <= _MAX_WORKERS:
                raise ValueError(f"{text}: a cluster has 1 to {_MAX_WORKERS} workers here")
            return cls(workers, None)
        if text == "auto" or re.fullmatch(r"\[?[\w.:-]+\]?:\d{1,5}", text, re.ASCII):
            return cls(None, text)
        raise ValueError(f"{text!r} is neither local, local:N, auto nor HOST:PORT")

    @property
    def is_loopback(self) -> bool:
        """Whether everything stays on this machine."""
        host = (self.join or "127.0.0.1").rpartition(":")[0]
        return self.workers is not None or host in {"127.0.0.1", "localhost", "[::1]"}
