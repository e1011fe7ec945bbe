"""The ledger counts every piece once, whatever becomes of calls."""

from __future__ import annotations

import random

import pytest

from octray.cluster.address import Address
from octray.cluster.ledger import Ledger


@pytest.mark.parametrize("seed", range(200))
def test_every_piece_is_counted_once_whatever_is_lost(seed: int) -> None:
    chance = random.Random(seed)  # noqa: S311 - no secret
    pieces = chance.randrange(1, 60)
    ledger = Ledger(range(pieces))
    under_way: dict[int, tuple[int, ...]] = {}
    counted: list[int] = []
    while ledger.missing:
        what = chance.random()
        if what < 0.5:
            given = ledger.give(chance.randrange(1, 9))
            if given is None:
                given = ledger.double(chance.sample(list(under_way), len(under_way) // 2), 3)
            if given is not None:
                under_way[given[0]] = given[1]
        elif under_way:
            call = chance.choice(list(under_way))
            keys = under_way.pop(call)
            if what < 0.7:
                ledger.lost(call)
            else:
                first = ledger.answered(call)
                assert set(first) <= set(keys)
                counted += first
        # What is missing waits or is under way: nothing is forgotten.
        known = {key for keys in under_way.values() for key in keys} | set(ledger._waiting)  # noqa: SLF001
        assert set(range(pieces)) - set(counted) <= known
    assert sorted(counted) == list(range(pieces))


def test_a_lost_piece_comes_first_again_and_an_answer_too_late_is_dropped() -> None:
    ledger = Ledger("abc")
    first = ledger.give(2)
    assert first == (0, ("a", "b"))
    second = ledger.double([], 1)
    assert second == (1, ("a",))
    ledger.lost(0)
    # Somebody else still works on a.
    assert ledger.give(9) == (2, ("b", "c"))
    assert ledger.answered(1) == ["a"]
    assert ledger.answered(2) == ["b", "c"]
    assert (ledger.missing, ledger.retried, ledger.doubled, ledger.dropped) == (0, 1, 1, 0)


def test_addresses() -> None:
    assert Address.parse("local:3") == (3, None)
    assert Address.parse("auto") == (None, "auto")
    assert Address.parse("10.0.0.7:6379") == (None, "10.0.0.7:6379")
    assert (Address.parse("local").workers or 0) >= 1
    assert Address.parse("127.0.0.1:1").is_loopback
    assert not Address.parse("10.0.0.7:6379").is_loopback
    for wrong in ("", "local:0", "local:x", "remote", "host:", "local:99999", "a b:3"):
        with pytest.raises(ValueError, match="local"):
            Address.parse(wrong)
