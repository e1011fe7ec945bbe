"""A whole scene on its way to workers, and who has it."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from octray.cluster.crew import Crew, Event, Member


@dataclasses.dataclass
class Shipment:
    """A scene as a shared array, and how its trees are built."""

    key: str
    data: Any
    accel: str
    trees: dict[str, Any]


class Holders:
    """The members that have the scene."""

    def __init__(self, crew: Crew, shipment: Shipment) -> None:
        """Send the scene to all that are there."""
        self._crew = crew
        self._shipment = shipment
        self._members: dict[Member, int] = {}
        for member in crew.ready:
            self._load(member)

    @property
    def members(self) -> list[Member]:
        """Give those that can be asked about the scene."""
        return [member for member in self._members if member.hello is not None]

    def _load(self, member: Member) -> None:
        self._members.pop(member, None)
        shipment = self._shipment
        self._crew.call(
            member,
            "load",
            shipment.key,
            shipment.data,
            shipment.accel,
            shipment.trees,
            tag=("load", 0),
        )

    def takes(self, event: Event) -> bool:
        """Deal with an event if it is about having the scene."""
        member = event.member
        if event.kind == "ready":
            self._load(member)
            return True
        if event.kind == "lost":
            self._members.pop(member, None)
        if event.tag[0] != "load":
            return False
        if event.kind == "answer":
            member.account.add(event.answer)
            self._members[member] = event.answer["pid"]
        return True

    def not_there(self, member: Member) -> None:
        """Send the scene again: the process that answered is new."""
        if member in self._members:
            self._load(member)
