"""Clusters on this machine: the same bytes whatever happens to workers and nodes."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import secrets
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

import octray

if importlib.util.find_spec("ray") is None:
    pytest.skip("Ray is not installed", allow_module_level=True)

from octray.cluster import Cluster, ClusterError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from conftest import Octray

SCENE = Path(__file__).resolve().parent.parent / "scenes" / "workbench" / "workbench.pov"
SIZE = (240, 136)
#: Seconds that a cluster may need to start on a busy machine.
PATIENCE = 60.0

pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture(scope="module")
def scene() -> octray.Scene:
    return octray.load(SCENE)


@pytest.fixture(scope="module")
def expected(scene: octray.Scene) -> bytes:
    return scene.render(size=SIZE, spp=4).to_bytes("exr")


def _later(seconds: float, pid: int, number: int) -> threading.Timer:
    timer = threading.Timer(seconds, os.kill, (pid, number))
    timer.start()
    return timer


def test_workers_are_killed_and_stopped_and_the_picture_is_the_same(
    scene: octray.Scene, expected: bytes, tmp_path: Path
) -> None:
    with Cluster("local:3") as cluster:
        cluster.wait_for(3, PATIENCE)
        pids = set(cluster.pids)
        assert len(pids) == 3
        assert cluster.render(scene, size=SIZE, spp=4).to_bytes("exr") == expected
        first, second, _ = cluster.pids
        timers = [_later(0.2, first, signal.SIGKILL), _later(0.3, second, signal.SIGSTOP)]
        kept = tmp_path / "kept.ckpt"
        image = cluster.render(scene, size=SIZE, spp=4, checkpoint=kept)
        assert image.to_bytes("exr") == expected
        assert not kept.exists()
        for timer in timers:
            timer.join()
        report = image.report["cluster"]
        # Two pictures, every tile counted once in each.
        assert report["total"]["pieces"] == report["pieces"] == 2 * image.report["tiles"]
        assert report["total"]["rays"] > 0
        with pytest.raises(ClusterError, match="object space"):
            cluster.render(scene, distribution="object")
        rays = np.random.default_rng(1).normal(size=(5000, 6))
        answers = list(cluster.query(scene, "first", rays, chunk=999))
        assert [count for _, count in answers] == [999] * 5 + [5]
        for name in ("t", "object_id", "face_id"):
            together = np.concatenate([columns[name] for (_, columns), _ in answers])
            assert together.tobytes() == getattr(scene.cast_rays(rays), name).tobytes()
        everybody = {pid for worker in report["workers"] for pid in worker["pids"]} | pids
        assert "w2" in cluster.accounts.table()
    deadline = time.monotonic() + 10
    while time.monotonic() < deadline and any(Path(f"/proc/{p}").exists() for p in everybody):
        time.sleep(0.1)
    assert not any(Path(f"/proc/{pid}").exists() for pid in everybody)


class _Nodes:
    """Nodes of a cluster on loopback, each in a session of its own."""

    def __init__(self, folder: Path) -> None:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.head = f"127.0.0.1:{probe.getsockname()[1]}"
        self._folder = folder
        self.processes: list[subprocess.Popen[bytes]] = []

    def start(self) -> None:
        ready = self._folder / f"ready{len(self.processes)}"
        log = (self._folder / "log").open("ab")
        process = subprocess.Popen(
            [
                *(sys.executable, "-m", "octray.cluster.node", "--head", self.head),
                *("--cpus", "1", "--ready", str(ready)),
                *(["--join"] if self.processes else []),
            ],
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=log,
            start_new_session=True,
        )
        log.close()
        self.processes.append(process)
        end = time.monotonic() + PATIENCE
        while not ready.exists():
            assert process.poll() is None, (self._folder / "log").read_text()
            assert time.monotonic() < end
            time.sleep(0.05)

    def kill(self, number: int) -> None:
        """End all processes of a node at once."""
        process = self.processes[number]
        children = [process.pid]
        for pid in children:
            with contextlib.suppress(OSError):
                text = Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii")
                children += map(int, text.split())
        for pid in children:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        process.wait(10)

    def end(self) -> None:
        for process in reversed(self.processes):
            if process.poll() is None:
                process.terminate()
        for number, process in enumerate(self.processes):
            try:
                process.wait(15)
            except subprocess.TimeoutExpired:  # noqa: PERF203 - a few times
                self.kill(number)


@pytest.fixture
def nodes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[_Nodes]:
    monkeypatch.setenv("RAY_AUTH_TOKEN", secrets.token_hex(32))
    made = _Nodes(tmp_path)
    try:
        for _ in range(3):
            made.start()
        yield made
    finally:
        made.end()


def test_nodes_are_killed_and_added_and_the_picture_is_the_same(
    scene: octray.Scene, expected: bytes, nodes: _Nodes
) -> None:
    said: list[str] = []
    with Cluster(nodes.head, say=said.append) as cluster:
        cluster.wait_for(3, PATIENCE)
        assert cluster.render(scene, size=SIZE, spp=4).to_bytes("exr") == expected
        killer = threading.Timer(0.2, nodes.kill, (2,))
        killer.start()
        assert cluster.render(scene, size=SIZE, spp=4).to_bytes("exr") == expected
        killer.join()
        nodes.start()
        # The new one is found, besides the two that are left.
        end = time.monotonic() + PATIENCE
        while len(cluster.accounts.workers) < 4 or len(cluster.pids) < 3:
            assert time.monotonic() < end
            # The killed one may count until its loss is known.
            with contextlib.suppress(ClusterError):
                cluster.wait_for(4, 0.5)
        assert cluster.render(scene, size=SIZE, spp=4).to_bytes("exr") == expected
        assert cluster.accounts.workers[3].pieces > 0
    assert any("left" in text for text in said)
    # What we joined runs on.
    assert nodes.processes[0].poll() is None


def test_the_command_renders_on_a_cluster_and_goes_on_after_it_was_killed(
    tmp_path: Path, octray_command: Octray, scene: octray.Scene
) -> None:
    options = ["render", str(SCENE), "-o", "out.exr", "--size", "320x180", "--spp", "8"]
    kept = tmp_path / "out.exr.ckpt"
    with subprocess.Popen(
        [sys.executable, "-m", "octray", *options, "-q", "--cluster", "local:2"], cwd=tmp_path
    ) as process:
        end = time.monotonic() + PATIENCE
        while not kept.exists() and process.poll() is None and time.monotonic() < end:
            time.sleep(0.02)
        process.kill()
    assert kept.exists()
    # A local run goes on with what the cluster did.
    result = octray_command(*options, "--resume")
    assert result.returncode == 0, result.stderr
    whole = scene.render(size=(320, 180), spp=8).to_bytes("exr")
    assert (tmp_path / "out.exr").read_bytes() == whole
    assert not kept.exists()
