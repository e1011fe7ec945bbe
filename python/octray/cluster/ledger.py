"""What is missing, what is under way, and what has been answered: every piece counts once."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable

Key = TypeVar("Key", bound="Hashable")


class Ledger(Generic[Key]):
    """Pieces of work by key. A piece may be given out several times; it is answered once."""

    def __init__(self, keys: Iterable[Key]) -> None:
        """Begin with everything missing; pieces are given out in this order."""
        self._waiting: deque[Key] = deque(keys)
        self._open: dict[Key, set[int]] = {key: set() for key in self._waiting}
        self._calls: dict[int, tuple[Key, ...]] = {}
        self._next = 0
        self.total = len(self._open)
        #: Pieces given out again because their worker was lost.
        self.retried = 0
        #: Pieces given out twice so that nobody waits for the slowest.
        self.doubled = 0
        #: Answers that came second.
        self.dropped = 0

    @property
    def missing(self) -> int:
        """How many pieces have no answer yet."""
        return len(self._open)

    @property
    def waiting(self) -> int:
        """How many of them are not under way."""
        return len(self._waiting)

    def give(self, count: int) -> tuple[int, tuple[Key, ...]] | None:
        """Give out up to ``count`` pieces that are not under way; with the number of the call."""
        keys: list[Key] = []
        while self._waiting and len(keys) < count:
            key = self._waiting.popleft()
            # It may have been answered by a call that was given up.
            if key in self._open:
                keys.append(key)
        return self._call(tuple(keys)) if keys else None

    def double(self, exclude: Iterable[int], count: int) -> tuple[int, tuple[Key, ...]] | None:
        """Give out pieces again that are under way only once, and not in the calls ``exclude``."""
        avoid = set(exclude)
        keys = [key for key, calls in self._open.items() if len(calls) == 1 and not calls & avoid][
            :count
        ]
        if not keys:
            return None
        self.doubled += len(keys)
        return self._call(tuple(keys))

    def _call(self, keys: tuple[Key, ...]) -> tuple[int, tuple[Key, ...]]:
        call = self._next
        self._next += 1
        self._calls[call] = keys
        for key in keys:
            self._open[key].add(call)
        return call, keys

    def answered(self, call: int) -> list[Key]:
        """Take the answer to a call; give the pieces that it is the first answer to."""
        first = []
        for key in self._calls.pop(call):
            if self._open.pop(key, None) is None:
                self.dropped += 1
            else:
                first.append(key)
        return first

    def lost(self, call: int) -> None:
        """There will be no answer: what nobody else works on waits again, before all else."""
        for key in reversed(self._calls.pop(call)):
            calls = self._open.get(key)
            if calls is None:
                continue
            calls.discard(call)
            if not calls:
                self._waiting.appendleft(key)
                self.retried += 1
