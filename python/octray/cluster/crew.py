"""The workers of a cluster: who is there, who is ready, what became of calls."""

from __future__ import annotations

import dataclasses
import time
from typing import TYPE_CHECKING, Any, Literal

from octray.cluster.accounts import Accounts, WorkerAccount
from octray.cluster.engine import LostError
from octray.cluster.errors import ClusterError
from octray.cluster.worker import Worker, identity

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from octray.cluster.engine import Engine

#: Seconds before a lost worker is greeted again, and between looks for new nodes.
_REST = 0.2
_LOOK = 1.0
#: A worker that is lost this often without an answer in between is given up.
_PATIENCE = 50


@dataclasses.dataclass(eq=False)
class Member:
    """A place where a worker is; its process may be another one than before."""

    name: str
    actor: Any
    node: str | None
    threads: int
    account: WorkerAccount
    #: What was said when it was greeted; ``None`` while it is not there.
    hello: dict[str, Any] | None = None
    calls: int = 0
    lost_in_a_row: int = 0
    rest_until: float = 0.0
    greeting: bool = False
    #: Seconds of the last pieces, each: what a distribution makes of it.
    pace: float | None = None


@dataclasses.dataclass
class Event:
    """Something happened to a member: it is ready to be asked, a call was answered or lost."""

    kind: Literal["ready", "answer", "lost"]
    member: Member
    #: What the caller gave with the call.
    tag: Any = None
    answer: Any = None


class Crew:
    """Actors on the nodes of a cluster."""

    def __init__(self, engine: Engine, workers: int | None, accounts: Accounts) -> None:
        """Start so many workers of one thread each here, or one on each node with all its cores."""
        self._engine = engine
        self._accounts = accounts
        self.members: list[Member] = []
        self._calls: dict[Any, tuple[Member, Any]] = {}
        self._by_node = workers is None
        self._known: set[str] = set()
        self._looked = 0.0
        self._say: Callable[[str], None] = lambda _text: None
        for _ in range(workers or 0):
            self._enlist(None, 1)

    @property
    def ready(self) -> list[Member]:
        """Give those that can be asked."""
        return [member for member in self.members if member.hello is not None]

    @property
    def pids(self) -> list[int]:
        """Give the numbers of all processes that there have been."""
        return [pid for member in self.members for pid in member.account.pids]

    def on_message(self, say: Callable[[str], None]) -> None:
        """Tell ``say`` what the user should know."""
        self._say = say

    def _enlist(self, node: str | None, threads: int) -> None:
        name = f"w{len(self._accounts.workers)}"
        actor = self._engine.actor(Worker, node, threads, name=name, threads=threads)
        account = WorkerAccount(name, threads=threads)
        self._accounts.workers.append(account)
        self.members.append(Member(name, actor, node, threads, account))

    def _look_for_nodes(self) -> None:
        """Greet nodes that are new, give up those that are gone."""
        now = time.monotonic()
        if not self._by_node or now - self._looked < _LOOK:
            return
        self._looked = now
        alive = self._engine.nodes()
        for node, about in alive.items():
            cpus = int(about["Resources"].get("CPU", 0))
            if node not in self._known and cpus > 0:
                self._known.add(node)
                self._enlist(node, cpus)
        for member in list(self.members):
            if member.node is not None and member.node not in alive:
                self._give_up(member, "its node is gone")

    def _give_up(self, member: Member, why: str) -> None:
        if member in self.members:
            self.members.remove(member)
            member.hello = None
            self._say(f"worker {member.name} {member.account.host} left: {why}")

    def call(self, member: Member, method: str, *arguments: Any, tag: Any, **options: Any) -> None:
        """Ask a member; the answer, or its loss, is an event with this tag."""
        reference = getattr(member.actor, method).remote(*arguments, **options)
        self._calls[reference] = (member, tag)
        member.calls += 1

    def retire(self) -> None:
        """End all workers."""
        self.forget()
        for member in self.members:
            self._engine.dismiss(member.actor)

    def forget(self) -> None:
        """Expect no answers any more."""
        for member, _ in self._calls.values():
            member.calls = 0
            member.greeting = False
        self._calls.clear()

    def events(self, seconds: float = 0.1) -> Iterator[Event]:
        """Wait up to so long; give what happened."""
        self._look_for_nodes()
        now = time.monotonic()
        for member in self.members:
            if member.hello is None and not member.greeting and now >= member.rest_until:
                member.greeting = True
                self.call(member, "hello", tag=_GREETING)
        if not self.members and not self._by_node:
            raise ClusterError("no worker is left")
        for reference in self._engine.wait(list(self._calls), seconds):
            member, tag = self._calls.pop(reference)
            member.calls -= 1
            yield from self._ended(member, tag, reference)

    def _ended(self, member: Member, tag: Any, reference: Any) -> Iterator[Event]:
        try:
            answer = self._engine.result(reference)
        except LostError:
            member.hello = None
            member.greeting = member.greeting and tag is not _GREETING
            member.rest_until = time.monotonic() + _REST
            member.lost_in_a_row += 1
            if member.lost_in_a_row > _PATIENCE:
                self._give_up(member, "it does not come back")
            if tag is not _GREETING:
                member.account.lost += 1
                yield Event("lost", member, tag)
            return
        if tag is not _GREETING:
            member.lost_in_a_row = 0
            yield Event("answer", member, tag, answer)
            return
        member.greeting = False
        objection = self._objection(answer)
        if objection is not None:
            self._accounts.refused.append(objection)
            self._give_up(member, objection)
            if not self.members:
                raise ClusterError(objection)
            return
        member.hello = answer
        member.account.greeted(answer)
        yield Event("ready", member)

    @staticmethod
    def _objection(hello: dict[str, Any]) -> str | None:
        own = identity()
        who = f"the worker on {hello['host']}"
        for what in ("version", "python", "binary"):
            if hello[what] != own[what]:
                kind = {"version": "octray", "python": "Python", "binary": "the compiled core"}[
                    what
                ]
                return (
                    f"{who} is refused: it has {kind} {hello[what]}, this machine {own[what]};"
                    " the same bits need the same program"
                )
        return None


_GREETING = object()
