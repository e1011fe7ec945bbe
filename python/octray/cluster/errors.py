"""What can go wrong with a cluster."""

from __future__ import annotations


class ClusterError(RuntimeError):
    """The cluster cannot do what it was asked; the text is for the user."""


class MissingExtraError(ClusterError):
    """Ray is not installed."""
