"""Advice on how far to move an object, in words. Metres, in the world."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agents.protocol.judging.sizes import diagonal_around

if TYPE_CHECKING:
    from agents.protocol.facts import Vector
    from agents.protocol.measures.geometry import GapMeasure
    from agents.protocol.measures.requests import Names
    from agents.protocol.rule import RuleContext

_AXES = (("−X", "+X"), ("−Y", "+Y"), ("−Z", "+Z"))
_WORDS = {"+Z": "up", "−Z": "down"}
_MOST = 0.5  # of an object's diagonal
_ALONG_AXIS = 0.999  # share of a move along one axis, from which only that axis is named


def gap_vector(gap: GapMeasure) -> Vector:
    """From the first of two surfaces to the second."""
    here, there = gap.here, gap.there
    return (there[0] - here[0], there[1] - here[1], there[2] - here[2])


def describe_move(name: str, move: Vector) -> str:
    """``Move 'Chair' 5.0 mm down (−Z)``, or by a vector; without a full stop."""
    length = math.hypot(*move)
    axis = max(range(3), key=lambda place: abs(move[place]))
    if abs(move[axis]) < _ALONG_AXIS * length:
        return f"Move {name!r} by ({', '.join(map(_signed, move))}) mm"
    side = _AXES[axis][move[axis] > 0]
    direction = f"{_WORDS[side]} ({side})" if side in _WORDS else f"along {side}"
    return f"Move {name!r} {length * 1000:.1f} mm {direction}"


def _signed(length: float) -> str:
    return f"{length * 1000:+.1f}".replace("-", "−").replace("+0.0", "0").replace("−0.0", "0")


def is_near(context: RuleContext, names: Names, length: float) -> bool:
    """Whether a move is short enough to be advised: what has to go farther is in the wrong place altogether."""
    return length <= _MOST * diagonal_around(context, names)


def describe_closing_move(
    context: RuleContext, first: tuple[str, Names], second: tuple[str, Names], move: Vector
) -> str:
    """Which of two objects, given as (name, its surfaces), to move so that the first goes by ``move`` relative to the
    second: the smaller one, but never one of the ground. "" for a move that is too far to be advised.
    """
    if _is_ground(context, first[0]) == _is_ground(context, second[0]):
        moves_first = diagonal_around(context, first[1]) <= diagonal_around(context, second[1])
    else:
        moves_first = _is_ground(context, second[0])
    if not is_near(context, first[1] if moves_first else second[1], math.hypot(*move)):
        return ""
    if moves_first:
        return describe_move(first[0], move)
    return describe_move(second[0], (-move[0], -move[1], -move[2]))


def _is_ground(context: RuleContext, name: str) -> bool:
    obj = context.structure.logical_object_of(name)
    return obj is not None and obj.name in context.structure.grounds
