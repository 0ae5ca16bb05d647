"""By how much something is to be moved, in words that can be acted on. Metres, in the world."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agents.protocol.judging.contact_pairs import diagonal_around

if TYPE_CHECKING:
    from agents.protocol.facts import Vector
    from agents.protocol.measures.measure import GapMeasure, Names
    from agents.protocol.rule import Subject

_AXES = (("−X", "+X"), ("−Y", "+Y"), ("−Z", "+Z"))
_WORDS = {"+Z": "up", "−Z": "down"}
_ALONG = 0.999  # share of a way that is along one axis


def across(gap: GapMeasure) -> Vector:
    """The way from the first of two surfaces to the second."""
    here, there = gap.here, gap.there
    return (there[0] - here[0], there[1] - here[1], there[2] - here[2])


def told_move(name: str, way: Vector) -> str:
    """``Move 'Chair' 5.0 mm down (−Z)``, or by a vector; without a full stop."""
    length = math.sqrt(sum(part * part for part in way))
    axis = max(range(3), key=lambda one: abs(way[one]))
    if abs(way[axis]) < _ALONG * length:
        return f"Move {name!r} by ({', '.join(_signed(part) for part in way)}) mm"
    side = _AXES[axis][way[axis] > 0]
    return f"Move {name!r} {length * 1000:.1f} mm " + (
        f"{_WORDS[side]} ({side})" if side in _WORDS else f"along {side}"
    )


def _signed(part: float) -> str:
    return f"{part * 1000:+.1f}".replace("-", "−").replace("+0.0", "0").replace("−0.0", "0")


def told_join(subject: Subject, first: tuple[str, Names], second: tuple[str, Names], way: Vector) -> str:
    """Which of two things, given as (name, its surfaces), is to be moved, so that the first goes ``way``.

    The smaller one; but never one of the ground.
    """
    if _is_ground(subject, first[0]) == _is_ground(subject, second[0]):
        moves_first = diagonal_around(subject, first[1]) <= diagonal_around(subject, second[1])
    else:
        moves_first = _is_ground(subject, second[0])
    if moves_first:
        return told_move(first[0], way)
    return told_move(second[0], (-way[0], -way[1], -way[2]))


def _is_ground(subject: Subject, name: str) -> bool:
    thing = subject.structure.thing_of(name)
    return thing is not None and thing.name in subject.structure.grounds
