"""The motion plan as a drawing: a lane for each actor, with its phases as bars, and lines from causes to effects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from simworlds.terminal.text import plain, shortened

if TYPE_CHECKING:
    from collections.abc import Callable

    from agents.plan.motion import MotionPhase
    from agents.plan.scene import ScenePlan

MOST = 60  # actors that one can still read
_LEFT, _WIDTH, _TOP, _ROW, _BAR = 190.0, 700.0, 34.0, 24.0, 15.0
_TICKS = (1, 2, 5, 10, 12, 24, 25, 50, 100, 250, 500, 1000, 2500, 5000, 10_000, 50_000, 100_000, 500_000)
_MOST_TICKS = 12
_BY_HAND = ("translate", "rotate", "swing")
_LETTERS, _LETTER = 24, 6.2  # how long a name may be; pixels


@dataclass(frozen=True, slots=True)
class Bar:
    """A phase. ``x`` and ``y`` are its top left; ``word`` stands on it, or is "" where it finds no room."""

    x: float
    y: float
    width: float
    word: str
    colour: str
    hint: str


@dataclass(frozen=True, slots=True)
class Tick:
    """A frame on the axis; the second that it stands for."""

    x: float
    frame: int
    second: str


@dataclass(frozen=True, slots=True)
class Lane:
    """An actor, at a height."""

    y: float
    actor: str


@dataclass(frozen=True, slots=True)
class Timeline:
    """A drawing of that size in pixels; ``causes`` are SVG paths. ``hidden`` actors did not find room."""

    width: float
    height: float
    left: float
    lanes: tuple[Lane, ...]
    bars: tuple[Bar, ...]
    ticks: tuple[Tick, ...]
    causes: tuple[str, ...]
    hidden: int = 0


def draw_timeline(plan: ScenePlan) -> Timeline | None:
    """The drawing; None for a scene in which nothing moves."""
    phases = sorted(plan.motion.phases, key=lambda phase: (phase.start, phase.end))
    if not phases:
        return None
    # Actors follow each other as they begin to move; what waits before that does not count.
    moving = (phase.actor for phase in phases if phase.kind != "hold")
    actors = list(dict.fromkeys((*moving, *(phase.actor for phase in phases))))
    lanes = {actor: _TOP + place * _ROW for place, actor in enumerate(actors[:MOST])}
    first = min(plan.frame_start, *(phase.start for phase in phases))
    last = max(plan.frame_end, *(phase.end for phase in phases))
    scale = _WIDTH / max(1, last - first + 1)

    def across(frame: float) -> float:
        return _LEFT + (frame - first) * scale

    shown = [phase for phase in phases if phase.actor in lanes]
    bars = {phase.name: _bar(phase, lanes[phase.actor], across, plan.fps) for phase in shown}
    causes = tuple(
        _cause(bars[phase.cause], bars[phase.name])
        for phase in shown
        if phase.cause in bars and bars[phase.cause].y != bars[phase.name].y
    )
    step = next((tick for tick in _TICKS if (last - first) / tick <= _MOST_TICKS), last - first)
    frames = [first, *(frame for frame in range(first - first % step + step, last + 1, step))]
    return Timeline(
        width=_LEFT + _WIDTH + 20,
        height=_TOP + len(lanes) * _ROW + 12,
        left=_LEFT,
        lanes=tuple(Lane(y + _ROW / 2, shortened(actor, _LETTERS)) for actor, y in lanes.items()),
        bars=tuple(bars.values()),
        ticks=tuple(Tick(across(frame), frame, f"{(frame - first) / plan.fps:.2f} s") for frame in frames),
        causes=causes,
        hidden=len(actors) - len(lanes),
    )


def _bar(phase: MotionPhase, lane: float, across: Callable[[float], float], fps: int) -> Bar:
    x = across(phase.start)
    width = max(3.0, across(phase.end + 1) - x - 1)
    words = [f"{plain(phase.name)}: {plain(phase.actor)}, {phase.kind}, frames {phase.start}–{phase.end}"]
    words += [f"{(phase.end - phase.start + 1) / fps:.2f} s"]
    words += [f"{phase.extent:g} m"] if phase.extent is not None else []
    words += [f"{phase.turn:g}°"] if phase.turn is not None else []
    words += [f"set off by {plain(phase.cause)}"] if phase.cause is not None else []
    return Bar(
        x=x,
        y=lane + (_ROW - _BAR) / 2,
        width=width,
        word=phase.kind if len(phase.kind) * _LETTER + 10 < width else "",
        colour="still" if phase.kind in ("hold", "settle") else "led" if phase.kind in _BY_HAND else "free",
        hint=", ".join(words),
    )


def _cause(one: Bar, other: Bar) -> str:
    """From the bar that sets off, at the moment when the other begins, down or up to it."""
    x = min(max(other.x, one.x), one.x + one.width)
    start = one.y + (_BAR if other.y > one.y else 0.0)
    end = other.y + _BAR / 2
    return f"M{x:.1f} {start:.1f} V{end:.1f} H{other.x:.1f}"
