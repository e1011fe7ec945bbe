"""Rays and points are handed out in chunks; answers come back in the order of the questions."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from octray.cluster.ledger import Ledger
from octray.cluster.shipment import Holders, Shipment

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from octray._answers import Columns
    from octray.cluster.accounts import Accounts
    from octray.cluster.crew import Crew, Event, Member

#: Chunks that a worker has at a time, and answered ones that wait for their turn, for each worker.
_OUTSTANDING = 2
_AHEAD = 6


class Queries:
    """Many questions of one kind to a crew."""

    def __init__(
        self,
        crew: Crew,
        accounts: Accounts,
        shipment: Shipment,
        mode: str,
        options: dict[str, Any],
    ) -> None:
        """Prepare to ask; ``options`` are those of ``octray._answers.columns``."""
        self._crew = crew
        self._accounts = accounts
        self._shipment = shipment
        self._mode = mode
        self._options = options
        self._calls: dict[Member, set[int]] = {}
        self._found: dict[int, tuple[Columns, int]] = {}
        self._next = 0

    def run(self, chunks: int, rows: Callable[[int], Any]) -> Iterator[tuple[Columns, int]]:
        """Give the answers to all chunks, in order; ``rows`` gives the questions of one."""
        ledger: Ledger[int] = Ledger(range(chunks))
        holders = Holders(self._crew, self._shipment)
        start = time.monotonic()
        try:
            while self._next < chunks:
                for event in self._crew.events():
                    self._take(event, ledger, holders)
                self._hand_out(ledger, holders, rows)
                while self._next in self._found:
                    yield self._found.pop(self._next)
                    self._next += 1
        finally:
            self._crew.forget()
            self._accounts.work_s += time.monotonic() - start
            self._accounts.pieces += ledger.total
            self._accounts.retried += ledger.retried
            self._accounts.doubled += ledger.doubled
            self._accounts.dropped += ledger.dropped

    def _take(self, event: Event, ledger: Ledger[int], holders: Holders) -> None:
        if holders.takes(event):
            return
        member, (_, call, count) = event.member, event.tag
        self._calls[member].discard(call)
        if event.kind == "lost" or event.answer is None:
            ledger.lost(call)
            if event.kind != "lost":
                holders.not_there(member)
            return
        answer, figures = event.answer
        member.account.add(figures)
        for chunk in ledger.answered(call):
            self._found[chunk] = (answer, count)
            member.account.pieces += 1

    def _hand_out(self, ledger: Ledger[int], holders: Holders, rows: Callable[[int], Any]) -> None:
        members = holders.members
        for member in members:
            own = self._calls.setdefault(member, set())
            while len(own) < _OUTSTANDING:
                given = None
                if len(self._found) < _AHEAD * len(members):
                    given = ledger.give(1)
                if given is None and not own:
                    given = ledger.double(own, 1)
                if given is None:
                    break
                call, (chunk,) = given
                questions = rows(chunk)
                own.add(call)
                self._crew.call(
                    member,
                    "query",
                    self._shipment.key,
                    self._mode,
                    questions,
                    self._options,
                    tag=("query", call, len(questions)),
                )
