"""Progress on standard error: one line that updates, or plain lines every tenth."""

from __future__ import annotations

import os
import sys
import time
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from typing import TextIO

    from typing_extensions import Self

Style = Literal["auto", "bar", "plain", "none"]

_WIDTH = 28
#: Below this share the time that is left is anybody's guess.
_GUESSABLE = 0.02
_ALL = 10
#: Seconds between plain lines, so that a quick picture does not fill a log.
_LINE_PAUSE = 0.2


def resolve(style: Style, stream: TextIO) -> Style:
    """Choose what ``auto`` means for this stream."""
    if style != "auto":
        return style
    return "bar" if stream.isatty() and os.environ.get("TERM") != "dumb" else "plain"


def duration(seconds: float) -> str:
    """Write a duration as one reads it: ``0.42 s``, ``12.3 s``, ``3 min 05 s``."""
    for limit, digits in ((10, 2), (100, 1)):
        if seconds < limit:
            return f"{seconds:.{digits}f} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours == 0:
        return f"{minutes} min {rest:02d} s"
    return f"{hours} h {minutes:02d} min"


class Progress:
    """Shows how far one phase has come. Used as a context; leaves no line behind on a terminal."""

    def __init__(self, label: str, style: Style, stream: TextIO | None = None) -> None:
        """Prepare to show ``label`` in the given style on ``stream`` (standard error)."""
        self._label = label
        self._stream = sys.stderr if stream is None else stream
        self._style = resolve(style, self._stream)
        self._start = time.monotonic()
        self._tenth = 0
        self._last = self._start
        self._drawn = False
        self._detail = ""
        self._color = self._style == "bar" and not os.environ.get("NO_COLOR")

    def __enter__(self) -> Self:
        """Start the clock."""
        self._start = time.monotonic()
        return self

    def __exit__(self, *details: object) -> None:
        """Take the line away."""
        if self._drawn:
            self._stream.write("\r\x1b[K")
            self._stream.flush()

    def announce(self) -> None:
        """Show the name alone, for what cannot say how far it is; only where it can go away."""
        if self._style == "bar":
            self._stream.write(f"\r\x1b[K{self._label} ...")
            self._stream.flush()
            self._drawn = True

    def with_detail(self, fraction: float, detail: str) -> None:
        """Show that ``fraction`` is done, and a few words more."""
        self._detail = f", {detail}" if detail else ""
        self(fraction)

    def __call__(self, fraction: float) -> None:
        """Show that ``fraction`` (0 to 1) is done."""
        if self._style == "bar":
            self._draw(fraction)
        elif self._style == "plain":
            self._line(fraction)

    def _rest(self, fraction: float) -> str:
        spent = time.monotonic() - self._start
        if spent < 1 or fraction < _GUESSABLE or fraction >= 1:
            return ""
        return f", {duration(spent / fraction - spent)} left"

    def _draw(self, fraction: float) -> None:
        filled = round(fraction * _WIDTH)
        bar, empty = "█" * filled, "░" * (_WIDTH - filled)
        encoding = (self._stream.encoding or "ascii").lower()
        if not encoding.startswith("utf"):
            bar, empty = "#" * filled, "." * (_WIDTH - filled)
        if self._color:
            bar, empty = f"\x1b[36m{bar}\x1b[0m", f"\x1b[2m{empty}\x1b[0m"
        text = f"\r\x1b[K{self._label} {bar}{empty} {fraction:4.0%}{self._rest(fraction)}"
        text += self._detail
        self._stream.write(text)
        self._stream.flush()
        self._drawn = True

    def _line(self, fraction: float) -> None:
        tenth = int(fraction * 10 + 1e-9)
        now = time.monotonic()
        if tenth > self._tenth and (tenth == _ALL or now - self._last > _LINE_PAUSE):
            self._tenth = tenth
            self._last = now
            self._stream.write(f"{self._label} {tenth * 10}%{self._rest(fraction)}{self._detail}\n")
            self._stream.flush()
