"""``python -m octray`` is the command ``octray``."""

from octray.cli import main

main()
