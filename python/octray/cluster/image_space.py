"""Every worker has the whole scene; pieces of the picture are handed out on demand."""

from __future__ import annotations

import dataclasses
import time
from typing import TYPE_CHECKING, Any

from octray.cluster.ledger import Ledger
from octray.cluster.shipment import Holders, Shipment

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from octray._core import TiledPicture
    from octray.cluster.accounts import Accounts
    from octray.cluster.crew import Crew, Event, Member

#: Seconds that a piece should take: so long that calls cost little, so short that nobody waits.
PIECE_SECONDS = 0.25
#: Pieces that a worker has at a time: one to work on, one to go on with.
OUTSTANDING = 2
#: Of what is left, a worker gets at most this share of its part.
_SHARE = 3
#: Seconds between checkpoints.
_KEEP = 1.5
#: Tiles of the first piece, for each thread.
_FIRST = 2


@dataclasses.dataclass
class Watch:
    """Who wants to know: how far it is, with figures; and where finished tiles are kept."""

    progress: Callable[[float, str], None]
    checkpoint: Path | None = None


class ImageSpace:
    """One picture on a crew."""

    def __init__(
        self,
        crew: Crew,
        accounts: Accounts,
        shipment: Shipment,
        picture: TiledPicture,
        *,
        settings: dict[str, Any],
        watch: Watch,
    ) -> None:
        """Prepare to render what is missing of ``picture``."""
        self._crew = crew
        self._accounts = accounts
        self._shipment = shipment
        self._picture = picture
        self._settings = settings
        self._watch = watch
        self._ledger: Ledger[int] = Ledger(picture.missing())
        self._holders = Holders(crew, shipment)
        #: By call, how many tiles.
        self._under_way: dict[Member, dict[int, int]] = {}
        self._rays = 0
        self._start = self._kept = time.monotonic()

    def run(self) -> None:
        """Render until nothing is missing. On Ctrl-C what is finished is in the checkpoint."""
        crew = self._crew
        try:
            while self._ledger.missing:
                waiting = time.monotonic()
                for event in crew.events():
                    self._accounts.wait_s += time.monotonic() - waiting
                    self._take(event)
                    waiting = time.monotonic()
                self._accounts.wait_s += time.monotonic() - waiting
                self._hand_out()
                self._tell()
                self._keep()
        finally:
            self._close()
        self._watch.progress(1.0, self._state())

    def _close(self) -> None:
        ledger, accounts = self._ledger, self._accounts
        self._crew.forget()
        accounts.work_s += time.monotonic() - self._start
        accounts.pieces += ledger.total
        accounts.retried += ledger.retried
        accounts.doubled += ledger.doubled
        accounts.dropped += ledger.dropped
        if ledger.missing:
            self._keep(at_once=True)

    def _take(self, event: Event) -> None:
        if self._holders.takes(event):
            return
        member, (_, call) = event.member, event.tag
        if event.kind == "lost":
            self._under_way[member].pop(call, None)
            self._ledger.lost(call)
            return
        tiles = self._under_way[member].pop(call)
        if event.answer is None:
            # The process is new and has no scene yet.
            self._ledger.lost(call)
            self._holders.not_there(member)
            return
        records, figures = event.answer
        member.account.add(figures)
        merging = time.monotonic()
        new = self._picture.take_records(records)
        self._accounts.merge_s += time.monotonic() - merging
        pieces = len(self._ledger.answered(call))
        if pieces != len(new):
            raise RuntimeError("the ledger and the picture disagree about what is new")
        member.account.pieces += pieces
        self._rays += figures["rays"]
        pace = figures["trace_s"] / tiles
        member.pace = pace if member.pace is None else 0.5 * (member.pace + pace)

    def _hand_out(self) -> None:
        """Give every worker that has room something to do."""
        for member in self._holders.members:
            own = self._under_way.setdefault(member, {})
            while len(own) < OUTSTANDING:
                given = self._ledger.give(self._count(member))
                if given is None and not own:
                    # Nothing waits: do what somebody else has not finished.
                    given = self._ledger.double(own, max(self._count(member), 1))
                if given is None:
                    break
                call, tiles = given
                own[call] = len(tiles)
                self._crew.call(
                    member,
                    "render",
                    self._shipment.key,
                    self._picture.job,
                    self._settings,
                    list(tiles),
                    tag=("render", call),
                )

    def _count(self, member: Member) -> int:
        """How many tiles make a piece: of the right length, and fewer at the end."""
        if member.pace is None:
            count = _FIRST * member.threads
        else:
            count = round(PIECE_SECONDS / max(member.pace, 1e-6))
        workers = max(len(self._holders.members), 1)
        fair = -(-self._ledger.waiting // (_SHARE * workers))
        return max(min(count, fair), 1)

    def _state(self) -> str:
        """Give what people want to see while they wait."""
        seconds = max(time.monotonic() - self._start, 1e-9)
        lost = sum(member.account.lost for member in self._crew.members)
        text = f"{len(self._holders.members)} workers, {self._rays / seconds / 1e6:.2f} Mrays/s"
        if lost or self._ledger.retried:
            text += f", {lost} calls lost, {self._ledger.retried} tiles retried"
        return text

    def _tell(self) -> None:
        done = self._picture.tiles - self._ledger.missing
        self._watch.progress(done / max(self._picture.tiles, 1), self._state())

    def _keep(self, *, at_once: bool = False) -> None:
        now = time.monotonic()
        if self._watch.checkpoint is None or (now - self._kept < _KEEP and not at_once):
            return
        self._kept = now
        self._picture.save_checkpoint(self._watch.checkpoint)
