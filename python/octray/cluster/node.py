"""A machine's part in a cluster, as a process that stays: ``python -m octray.cluster.node``.

``octray cluster up`` and ``join`` start it in a session of its own; when it is told to end it takes
all of the engine's processes on this machine that it started with it, and no others.
"""

from __future__ import annotations

import argparse
import importlib
import os
import signal
import sys
import threading
from pathlib import Path
from typing import Any

from octray.cluster.engine import HEALTH, STORE_BYTES, load, stay_on_loopback


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="octray.cluster.node")
    parser.add_argument("--head", metavar="HOST:PORT", required=True)
    parser.add_argument("--join", action="store_true")
    parser.add_argument("--address")
    parser.add_argument("--cpus", type=int, required=True)
    parser.add_argument("--store", type=int, default=STORE_BYTES)
    parser.add_argument("--ready", type=Path, help="a file to write when it runs")
    return parser.parse_args()


def main() -> int:
    """Start the node, say so, and wait to be told to end."""
    arguments = _arguments()
    load()
    host, _, port = arguments.head.rpartition(":")
    own = arguments.address or host
    if own in {"127.0.0.1", "localhost"}:
        stay_on_loopback()
    node = importlib.import_module("ray._private.node")
    parameter = importlib.import_module("ray._private.parameter")
    options: dict[str, Any] = {
        "node_ip_address": own,
        "num_cpus": arguments.cpus,
        "num_gpus": 0,
        "object_store_memory": arguments.store,
        "include_dashboard": False,
        "include_log_monitor": False,
        "min_worker_port": 0,
        "max_worker_port": 0,
    }
    if arguments.join:
        options |= {"gcs_address": arguments.head, "redis_address": arguments.head}
    else:
        options |= {"gcs_server_port": int(port), "_system_config": HEALTH}
    end = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: end.set())
    started = node.Node(
        parameter.RayParams(**options),
        head=not arguments.join,
        shutdown_at_exit=False,
        spawn_reaper=False,
        connect_only=False,
    )
    if arguments.ready is not None:
        arguments.ready.write_text(str(os.getpid()), encoding="ascii")
    end.wait()
    started.kill_all_processes(check_alive=False, allow_graceful=True, wait=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
