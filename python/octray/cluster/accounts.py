"""Memory, time and communication of every process, and of all together."""

from __future__ import annotations

import dataclasses
import json
from typing import Any


@dataclasses.dataclass
class WorkerAccount:
    """What one worker did; if its process died, its successors' work is counted with it."""

    name: str
    host: str = ""
    pids: list[int] = dataclasses.field(default_factory=list)
    threads: int = 1
    #: Bytes: of the scene as it came, of the process now and at most.
    scene_bytes: int = 0
    memory_bytes: int = 0
    peak_bytes: int = 0
    #: Seconds: reading the scene and building trees, tracing, all else in calls, between calls.
    load_s: float = 0.0
    trace_s: float = 0.0
    other_s: float = 0.0
    idle_s: float = 0.0
    rays: int = 0
    pieces: int = 0
    #: Calls and answers.
    messages: int = 0
    bytes_in: int = 0
    bytes_out: int = 0
    #: Calls that were not answered, and processes that came after the first.
    lost: int = 0
    restarts: int = 0

    def greeted(self, hello: dict[str, Any]) -> None:
        """Take note that a process has come."""
        self.host, self.threads = hello["host"], hello["threads"]
        if hello["pid"] not in self.pids:
            self.restarts += bool(self.pids)
            self.pids.append(hello["pid"])

    def add(self, figures: dict[str, Any]) -> None:
        """Add what a call cost."""
        self.messages += 2
        self.scene_bytes = figures.get("scene_bytes", self.scene_bytes)
        self.memory_bytes = figures["memory_bytes"]
        self.peak_bytes = max(self.peak_bytes, figures["peak_bytes"])
        load, trace = figures.get("load_s", 0.0), figures.get("trace_s", 0.0)
        self.load_s += load
        self.trace_s += trace
        self.other_s += max(figures["busy_s"] - load - trace, 0.0)
        if not load:
            self.idle_s += figures["idle_s"]
        self.rays += figures.get("rays", 0)
        self.bytes_in += figures.get("bytes_in", 0) + figures.get("scene_bytes", 0)
        self.bytes_out += figures.get("bytes_out", 0)


@dataclasses.dataclass
class Accounts:
    """All workers, and the driver."""

    workers: list[WorkerAccount] = dataclasses.field(default_factory=list)
    #: Seconds from the first piece given out to the last answer, and of starting before that.
    work_s: float = 0.0
    start_s: float = 0.0
    #: Seconds in which the driver waited for answers, and put them together.
    wait_s: float = 0.0
    merge_s: float = 0.0
    pieces: int = 0
    retried: int = 0
    doubled: int = 0
    dropped: int = 0
    refused: list[str] = dataclasses.field(default_factory=list)

    @property
    def imbalance(self) -> float:
        """The busiest worker's tracing time over the mean of all; 1 is perfect."""
        times = [worker.trace_s for worker in self.workers]
        mean = sum(times) / max(len(times), 1)
        return max(times) / mean if mean > 0 else 1.0

    def as_dict(self) -> dict[str, Any]:
        """Give everything as plain numbers and lists, ready for JSON."""
        report = dataclasses.asdict(self)
        total = {
            field.name: sum(getattr(worker, field.name) for worker in self.workers)
            for field in dataclasses.fields(WorkerAccount)
            if field.type in {"int", "float"}
        }
        return report | {"total": total, "imbalance": self.imbalance}

    def to_json(self) -> str:
        """Give ``as_dict`` as text."""
        return json.dumps(self.as_dict(), indent=2)

    def table(self) -> str:
        """Give a line for each worker and one for all."""
        mebi = 1 << 20
        heading = (
            "worker                 memory MiB  load s  trace s  other s  idle s"
            "      Mrays  calls  MiB in  MiB out  lost  restarts"
        )
        lines = [heading]
        total = self.as_dict()["total"] | {"name": "all", "host": ""}
        for row in [*(dataclasses.asdict(worker) for worker in self.workers), total]:
            name = f"{row['name']} {row['host']}".strip()
            lines.append(
                f"{name:<22} {row['memory_bytes'] / mebi:10.0f} {row['load_s']:7.2f}"
                f" {row['trace_s']:8.2f} {row['other_s']:8.2f} {row['idle_s']:7.2f}"
                f" {row['rays'] / 1e6:10.3f} {row['messages'] // 2:6d}"
                f" {row['bytes_in'] / mebi:7.1f} {row['bytes_out'] / mebi:8.1f}"
                f" {row['lost']:5d} {row['restarts']:9d}"
            )
        lines.append(
            f"driver: {self.start_s:.2f} s to start, {self.work_s:.2f} s of work, of which"
            f" {self.wait_s:.2f} s waiting and {self.merge_s:.2f} s merging; {self.pieces} pieces,"
            f" {self.retried} retried, {self.doubled} given out twice, {self.dropped} answers too"
            f" late; imbalance {self.imbalance:.2f}"
        )
        lines += [f"refused: {reason}" for reason in self.refused]
        return "\n".join(lines)
