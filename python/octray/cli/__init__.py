"""The command ``octray``. Start-up stays fast: everything heavy is imported where it is used."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command line and end the process with its exit code."""
    from octray.cli.command import run

    sys.exit(run())
