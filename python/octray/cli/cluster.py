"""``octray cluster``: machines that work together, started and joined by hand."""

from __future__ import annotations

import contextlib
import json
import os
import secrets
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import click

from octray.cli.exits import Exit, FailureError

#: Seconds until a node must run, or have ended.
_PATIENCE = 60.0
_TURN = 0.1


def _folder() -> Path:
    base = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(base) / "octray" / "cluster"


def _token_file() -> Path:
    given = os.environ.get("RAY_AUTH_TOKEN_PATH")
    return Path(given) if given else _folder() / "token"


def _need_engine() -> None:
    from octray.cluster import MissingExtraError
    from octray.cluster.engine import load

    try:
        load()
    except MissingExtraError as error:
        raise FailureError(str(error)) from error


def _make_token() -> Path:
    path = _token_file()
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with os.fdopen(handle, "w") as file:
            file.write(secrets.token_hex(32))
    return path


def _start(head: str, address: str, cpus: int, *, join: bool) -> None:
    """Start this machine's part in a session of its own, and wait until it runs."""
    token = _token_file()
    if not token.exists() and not os.environ.get("RAY_AUTH_TOKEN"):
        raise FailureError(f"{token}: copy the token of the cluster's first machine there")
    environment = dict(os.environ)
    if "RAY_AUTH_TOKEN" not in environment:
        environment["RAY_AUTH_TOKEN_PATH"] = str(token)
    folder = _folder()
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    with tempfile.TemporaryDirectory() as place:
        ready = Path(place) / "ready"
        log = folder / f"node-{head.replace(':', '-')}-{secrets.token_hex(4)}.log"
        with log.open("wb") as output:
            process = subprocess.Popen(  # noqa: S603 - our own module
                [
                    *(sys.executable, "-m", "octray.cluster.node", "--head", head),
                    *("--address", address, "--cpus", str(cpus), "--ready", str(ready)),
                    *(["--join"] if join else []),
                ],
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=output,
                start_new_session=True,
            )
        end = time.monotonic() + _PATIENCE
        while not ready.exists():
            if process.poll() is not None or time.monotonic() > end:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)
                raise FailureError(f"the node did not start: see {log}")
            time.sleep(_TURN)
        (folder / f"{process.pid}.node").write_text(head, encoding="ascii")


@click.group("cluster", epilog="Example: octray cluster up --address 192.168.0.10")
def command() -> None:
    """Let machines work together."""


_cpus = click.option(
    "--cpus",
    type=click.IntRange(min=1),
    default=lambda: len(os.sched_getaffinity(0)),
    help="Processors that may be used here; all by default.",
)


@command.command("up")
@click.option(
    "--address",
    default="127.0.0.1",
    show_default=True,
    help="Address of this machine by which the others reach it; 127.0.0.1 is for nobody else.",
)
@click.option("--port", type=click.IntRange(1, 65535), default=6379, show_default=True)
@_cpus
def up(address: str, port: int, cpus: int) -> int:
    """Start a cluster whose first machine is this one."""
    _need_engine()
    token = _make_token()
    head = f"{address}:{port}"
    _start(head, address, cpus, join=False)
    click.echo(f"The cluster runs at {head} with {cpus} processors of this machine.")
    if address not in {"127.0.0.1", "localhost"}:
        click.echo(
            f"On every other machine, with the same octray and Python:\n"
            f"  copy {token} to the same place there (it is the key: keep it secret)\n"
            f"  octray cluster join {head} --address ADDRESS-OF-THAT-MACHINE"
        )
    click.echo(
        f"Then, here:\n  RAY_AUTH_TOKEN_PATH={token} octray render SCENE --cluster {head}\n"
        "  octray cluster down"
    )
    return Exit.OK


@command.command("join")
@click.argument("head", metavar="HOST:PORT")
@click.option("--address", default="127.0.0.1", show_default=True, help="This machine's address.")
@_cpus
def join(head: str, address: str, cpus: int) -> int:
    """Add this machine to the cluster at HOST:PORT."""
    _need_engine()
    _start(head, address, cpus, join=True)
    click.echo(f"This machine takes part in {head} with {cpus} processors.")
    return Exit.OK


@command.command("status")
@click.argument("head", metavar="HOST:PORT")
def status(head: str) -> int:
    """Print the machines of the cluster at HOST:PORT as JSON."""
    from octray.cluster import Address, ClusterError
    from octray.cluster.engine import Engine

    if "RAY_AUTH_TOKEN" not in os.environ:
        os.environ["RAY_AUTH_TOKEN_PATH"] = str(_token_file())
    try:
        engine = Engine(Address.parse(head))
    except (ClusterError, ValueError) as error:
        raise FailureError(str(error)) from error
    try:
        nodes = [
            {"address": n["NodeManagerAddress"], "host": n["NodeManagerHostname"], **n["Resources"]}
            for n in engine.nodes().values()
        ]
    finally:
        engine.close()
    click.echo(json.dumps(nodes, indent=2))
    return Exit.OK


@command.command("down")
def down() -> int:
    """End what ``up`` and ``join`` started on this machine, and nothing else."""
    ended = 0
    for note in sorted(_folder().glob("*.node")):
        pid = int(note.stem)
        with contextlib.suppress(OSError):
            # Its number may belong to somebody else by now.
            if b"octray.cluster.node" in Path(f"/proc/{pid}/cmdline").read_bytes():
                os.kill(pid, signal.SIGTERM)
                ended += 1
                _await_end(pid)
        note.unlink(missing_ok=True)
    click.echo(f"{ended} ended" if ended else "nothing runs here that octray started")
    return Exit.OK


def _await_end(pid: int) -> None:
    end = time.monotonic() + _PATIENCE
    while Path(f"/proc/{pid}").exists() and time.monotonic() < end:
        # Orphans are reaped by the system, children of a test by us.
        with contextlib.suppress(ChildProcessError):
            os.waitpid(pid, os.WNOHANG)
        time.sleep(_TURN)
