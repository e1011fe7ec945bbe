"""Ray: started, joined and left; the only module that imports it.

What is set, and why: no usage statistics; token authentication; everything bound to loopback unless
another machine takes part; a node that does not answer for two seconds is dead; the object store
has a size that we know; no dashboard. A local cluster is always a new one: one that runs already is
never joined unless its address is given, and one that we did not start is never stopped.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import secrets
import signal
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from octray.cluster.errors import ClusterError, MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from octray.cluster.address import Address

#: Dead after three times half a second without an answer.
HEALTH = {
    "health_check_initial_delay_ms": 0,
    "health_check_period_ms": 500,
    "health_check_timeout_ms": 500,
    "health_check_failure_threshold": 3,
}
_MEBI = 1 << 20
#: Beside the scene: records on their way.
STORE_BYTES = 128 * _MEBI


def environment(token: str | None = None) -> dict[str, str]:
    """Give the variables that the engine's processes must find."""
    variables = {
        "RAY_USAGE_STATS_ENABLED": "0",
        "RAY_AUTH_MODE": "token",
        "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0",
    }
    if token is not None:
        variables["RAY_AUTH_TOKEN"] = token
    return variables


def load(token: str | None = None) -> Any:
    """Import Ray with the environment that it is to have."""
    os.environ.update(environment(token))
    try:
        ray = importlib.import_module("ray")
        # It reads the token when it is imported, which may have been before.
        core: Any = importlib.import_module("ray._raylet")
        core.AuthenticationTokenLoader.instance().reset_cache()
    except ImportError as error:
        raise MissingExtraError(
            "clusters need Ray: pip install 'octray[cluster]' (in octray's own source: make setup)"
        ) from error
    return ray


def stay_on_loopback() -> None:
    """Let processes started from here listen on 127.0.0.1 only.

    Ray replaces 127.0.0.1 by an address that others can reach; this answers its question instead.
    """
    services: Any = importlib.import_module("ray._private.services")
    services.get_node_ip_address = lambda *_args, **_options: "127.0.0.1"


class Engine:
    """A connection to a cluster, ours or somebody else's."""

    def __init__(self, address: Address, scene_bytes: int = 0) -> None:
        """Start or join a cluster; ``scene_bytes`` is what its object store must hold besides."""
        self._own = address.workers is not None
        has_token = any(os.environ.get(f"RAY_AUTH_TOKEN{name}") for name in ("", "_PATH"))
        self.ray = load(secrets.token_hex(32) if self._own and not has_token else None)
        if self.ray.is_initialized():
            raise ClusterError("this process is part of a cluster already")
        if address.is_loopback:
            stay_on_loopback()
        self._silence()
        options: dict[str, Any] = {"log_to_driver": False, "logging_level": "ERROR"}
        if address.workers is not None:
            options |= {
                "address": "local",
                "num_cpus": address.workers,
                "num_gpus": 0,
                "include_dashboard": False,
                "object_store_memory": STORE_BYTES + scene_bytes,
                "_system_config": HEALTH,
            }
        else:
            options["address"] = address.join
        try:
            self.ray.init(**options)
        except (ConnectionError, RuntimeError, ValueError, OSError) as error:
            what = "a local cluster" if self._own else f"the cluster at {address.join}"
            raise ClusterError(f"{what} cannot be used: {_first_line(error)}") from error

    @staticmethod
    def _silence() -> None:
        """Say about dead workers what we say, not what the engine prints."""
        worker: Any = importlib.import_module("ray._private.worker")
        worker.print_to_stdstream = lambda *_args, **_options: None

    @property
    def is_own(self) -> bool:
        """Whether we started it."""
        return self._own

    def nodes(self) -> dict[str, dict[str, Any]]:
        """Give the nodes that are alive, by id."""
        return {node["NodeID"]: node for node in self.ray.nodes() if node["Alive"]}

    def actor(self, cls: type, node: str | None, cpus: float, **arguments: Any) -> Any:
        """Start an actor, on this node if one is named."""
        options: dict[str, Any] = {
            "num_cpus": cpus,
            "max_restarts": -1,
            "max_task_retries": 0,
            "max_concurrency": 1,
        }
        if node is not None:
            strategies = importlib.import_module("ray.util.scheduling_strategies")
            options["scheduling_strategy"] = strategies.NodeAffinitySchedulingStrategy(
                node_id=node, soft=False
            )
        return self.ray.remote(**options)(cls).remote(**arguments)

    def dismiss(self, actor: Any) -> None:
        """End an actor; it does not come back."""
        with contextlib.suppress(self.ray.exceptions.RayError, ValueError):
            self.ray.kill(actor, no_restart=True)

    def wait(self, references: list[Any], seconds: float) -> list[Any]:
        """Give the calls that have ended, as soon as there is one."""
        if not references:
            time.sleep(seconds)
            return []
        ready, _ = self.ray.wait(references, num_returns=1, timeout=seconds, fetch_local=False)
        if not ready:
            return []
        # And whatever else has ended meanwhile.
        ready, _ = self.ray.wait(
            references, num_returns=len(references), timeout=0, fetch_local=False
        )
        return list(ready)

    def put(self, array: Any) -> Any:
        """Share an array with all workers: once on each node."""
        return self.ray.put(array)

    def result(self, reference: Any) -> Any:
        """Give what a call gave, or raise ``LostError`` if its process is lost."""
        errors = self.ray.exceptions
        try:
            return self.ray.get(reference)
        except errors.RayTaskError as error:
            raise ClusterError(f"a worker failed: {_last_line(error)}") from error
        except errors.RayError as error:
            raise LostError(type(error).__name__) from error

    def close(self, pids: Iterable[int] = ()) -> None:
        """Leave the cluster; end it, with these processes on this machine, if we started it."""
        self.ray.shutdown()
        if self._own:
            for pid in pids:
                _end(pid)


class LostError(Exception):
    """A call will not be answered: its process or its node is gone."""


def _end(pid: int) -> None:
    """End a worker that did not end by itself, stopped ones too."""
    with contextlib.suppress(OSError, UnicodeDecodeError):
        # Its number may belong to somebody else by now.
        if b"ray::" in Path(f"/proc/{pid}/cmdline").read_bytes():
            os.kill(pid, signal.SIGKILL)


def _first_line(error: BaseException) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[0]


def _last_line(error: BaseException) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[-1]
