"""Which combinations are run when none are named."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

#: The yardstick: every time is also given relative to the time of this method.
YARDSTICK = "auto"
#: The oracle: every picture is compared with the picture of this method.
ORACLE = "brute"
#: From this many primitives and triangles on, brute force is run only where it is named.
BRUTE_LIMIT = 2000


def choices(name: str) -> list[tuple[int, str]]:
    """Give the choices that a method's name makes: its words, each with its place in the name."""
    return list(enumerate(name.split(":")))


def _family(name: str) -> str:
    return name.partition(":")[0]


def one_change_at_a_time(names: Sequence[str]) -> list[str]:
    """Select methods so that every choice that ``names`` offers occurs in one of them.

    Greedy: the first method of every family (``auto``, ``brute``, ..., ``octree``) is taken, and
    then, again and again, the method that adds a choice and differs in as few words as possible
    from the one of its family taken first. So most differences between two rows of the result
    have one cause.
    """
    first: dict[str, str] = {}
    for name in names:
        first.setdefault(_family(name), name)
    taken = set(first.values())
    covered = {choice for name in taken for choice in choices(name)}

    def changes(name: str) -> int:
        return len(set(choices(name)) - set(choices(first[_family(name)])))

    while True:
        useful = [name for name in names if set(choices(name)) - covered]
        if not useful:
            return [name for name in names if name in taken]
        best = min(useful, key=changes)
        taken.add(best)
        covered.update(choices(best))


def select(
    valid: Sequence[str], named: Sequence[str], *, everything: bool, primitives: int
) -> tuple[list[str], str | None]:
    """Give the methods to run, and a word about one that was left out, if one was.

    What is named is run, and nothing else. Otherwise it is all of ``valid`` if ``everything``,
    else every choice at least once; brute force is left out of scenes with more than
    ``BRUTE_LIMIT`` primitives and triangles.
    """
    if named:
        return list(dict.fromkeys(named)), None
    chosen = list(valid) if everything else one_change_at_a_time(valid)
    if primitives <= BRUTE_LIMIT or ORACLE not in chosen:
        return chosen, None
    chosen.remove(ORACLE)
    return chosen, (
        f"{ORACLE} is left out: the scene has {primitives} primitives and triangles, more than"
        f" {BRUTE_LIMIT}; --accel {ORACLE} runs it all the same"
    )
