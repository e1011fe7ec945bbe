"""Runs one command and says what it cost; a program of its own, and a small one.

``python -I -S launcher.py LOG COMMAND...`` gives the command no input, puts all it says into the
file LOG and prints one JSON object: wall and processor seconds, peak memory, exit status. It is
small because a process begins with the peak memory of the one that started it.
"""

import json
import os
import sys
import time


def main(log: str, command: list[str]) -> None:
    """Run the command."""
    out = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    nothing = os.open(os.devnull, os.O_RDONLY)
    files = [(os.POSIX_SPAWN_DUP2, nothing, 0)]
    files += [(os.POSIX_SPAWN_DUP2, out, stream) for stream in (1, 2)]
    start = time.perf_counter()
    try:
        pid = os.posix_spawnp(command[0], command, os.environ, file_actions=files)
    except OSError as error:
        print(json.dumps({"error": error.strerror or str(error)}))  # noqa: T201
        return
    _, status, usage = os.wait4(pid, 0)
    wall = time.perf_counter() - start
    unit = 1 if sys.platform == "darwin" else 1024
    cost = {
        "wall_s": wall,
        "cpu_s": usage.ru_utime + usage.ru_stime,
        "peak_bytes": usage.ru_maxrss * unit,
        "exit": os.waitstatus_to_exitcode(status),
    }
    print(json.dumps(cost))  # noqa: T201


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
