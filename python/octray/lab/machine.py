"""What the lab runs on, and how much memory there is."""

from __future__ import annotations

import os
import platform
from pathlib import Path
from typing import Any

from octray._core import cpu_features

_KIB = 1024


def _kibibytes(path: str, key: str) -> int | None:
    """Read an entry of a file such as /proc/meminfo, in bytes."""
    try:
        text = Path(path).read_text(encoding="ascii", errors="replace")
    except OSError:
        return None
    for line in text.splitlines():
        if line.startswith(f"{key}:"):
            return int(line.split()[1]) * _KIB
    return None


def _number(path: str) -> int | None:
    try:
        text = Path(path).read_text(encoding="ascii").strip()
    except OSError:
        return None
    return int(text) if text.isdigit() else None


def _allowed_bytes() -> int | None:
    """Read what the control group of this process leaves to it, where there is a limit."""
    for limit, used in (
        ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
        (
            "/sys/fs/cgroup/memory/memory.limit_in_bytes",
            "/sys/fs/cgroup/memory/memory.usage_in_bytes",
        ),
    ):
        most, now = _number(limit), _number(used)
        if most is not None and now is not None:
            return max(most - now, 0)
    return None


def available_bytes() -> int | None:
    """Give the memory that is free for us now; ``None`` where the system does not tell."""
    known = [_kibibytes("/proc/meminfo", "MemAvailable"), _allowed_bytes()]
    return min((size for size in known if size is not None), default=None)


def resident_bytes() -> int | None:
    """Give the memory that this process holds now."""
    return _kibibytes("/proc/self/status", "VmRSS")


def address_bytes() -> int | None:
    """Give the size of this process's address space now."""
    return _kibibytes("/proc/self/status", "VmSize")


def processor() -> str:
    """Give the processor's name, as far as the system tells."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        text = ""
    for line in text.splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def describe() -> dict[str, Any]:
    """Give what figures of time depend on."""
    return {
        "processor": processor(),
        "processors": os.cpu_count(),
        "features": cpu_features(),
        "memory_bytes": _kibibytes("/proc/meminfo", "MemTotal"),
        "available_bytes": available_bytes(),
        "system": platform.system(),
        "python": platform.python_version(),
    }
