"""Options about clusters that several commands share, and a cluster for one command."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

import click

from octray.cli.exits import FailureError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from octray.cluster import Cluster


def _parse(_ctx: click.Context, _param: click.Parameter, value: str | None) -> str | None:
    if value is not None:
        from octray.cluster.address import Address

        try:
            Address.parse(value)
        except ValueError as error:
            raise click.BadParameter(str(error)) from None
    return value


def cluster_option(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add ``--cluster``."""
    return click.option(
        "--cluster",
        metavar="WHERE",
        callback=_parse,
        help="Work on a cluster: local[:N] starts N workers here, HOST:PORT joins one that runs"
        " (octray cluster up), auto the one that runs on this machine. The answers are the same.",
    )(function)


@contextlib.contextmanager
def started(address: str, *, quiet: bool) -> Iterator[Cluster]:
    """Give a cluster; what goes wrong with it is a ``FailureError``."""
    from octray.cluster import Cluster, ClusterError

    def say(text: str) -> None:
        if not quiet:
            click.echo(f"octray: {text}", err=True)

    try:
        with Cluster(address, say=say) as cluster:
            yield cluster
    except ClusterError as error:
        raise FailureError(str(error)) from error
