"""The frames of a film that tell what happens in it: its ends, where its phases move fastest, and between them evenly.

Even times alone show a short fall in a long film at rest.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import accumulate
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from agents.plan.motion import MotionPhase

_GROWS = frozenset({"flow", "emit"})  # fastest as it begins, when there is hardly anything to see
_SLOW = 0.1  # of the fastest speed; phases that are slower have no frame of their own
_APART = 4  # frames that are nearer than this part of an even distance show the same
_OF_MOTION = 0.8  # what is put between others goes by motion so far, the rest by time


@dataclass(frozen=True, slots=True)
class MeasuredMotion:
    """What motion sheets measured. ``peaks``: the highest speed of each phase, and the frame that shows it best.

    ``speeds``: how fast everything was at a frame, where the fastest of each actor is 1.
    """

    peaks: tuple[tuple[float, int], ...] = ()
    speeds: Mapping[int, float] = field(default_factory=dict[int, float])

    @classmethod
    def of(cls, sheets: Iterable[Mapping[str, Any]], phases: Iterable[MotionPhase]) -> MeasuredMotion:
        """From the data of motion sheets."""
        kinds = {(phase.name, phase.start, phase.end): phase.kind for phase in phases}
        peaks: list[tuple[float, int]] = []
        speeds: dict[int, float] = {}
        for actor in (actor for sheet in sheets for actor in sheet.get("actors", ())):
            for row in actor.get("phases", ()):
                if row.get("peak_frame") is None:
                    continue
                start, end, frame = row["start"], row["end"], row["peak_frame"]
                if kinds.get((row["phase"], start, end)) in _GROWS:
                    frame = max(frame, start + (end - start) // 4)
                peaks.append((row["peak_speed"], frame))
            measured = zip(actor.get("frames", ()), actor.get("speeds", ()), strict=False)
            known = {frame: speed for frame, speed in measured if speed is not None}
            if fastest := max(known.values(), default=0.0):
                for frame, speed in known.items():
                    speeds[frame] = speeds.get(frame, 0.0) + speed / fastest
        return cls(tuple(sorted(peaks, reverse=True)), speeds)


def telling_frames(
    first: int, last: int, count: int, motion: MeasuredMotion, phases: Sequence[MotionPhase] = ()
) -> list[int]:
    """At most ``count`` frames in order, with ``first`` and ``last``. ``phases`` count where none was measured."""
    chosen = {first, last}
    apart = max(1.0, (last - first) / (_APART * count))
    fastest = motion.peaks[0][0] if motion.peaks else 0.0
    wanted = [frame for speed, frame in motion.peaks if speed >= _SLOW * fastest and fastest]
    wanted = wanted or [(phase.start + phase.end) // 2 for phase in phases if phase.kind != "hold"]
    for frame in wanted:
        if (
            first < frame < last
            and len(chosen) < count
            and all(abs(frame - other) >= apart for other in chosen)
        ):
            chosen.add(frame)
    passed = _passed(first, last, motion)
    while len(chosen) < min(count, last - first + 1):
        free = [frame for frame in range(first, last + 1) if frame not in chosen]
        chosen.add(max(free, key=lambda frame: min(abs(passed[frame] - passed[other]) for other in chosen)))
    return sorted(chosen)


def _passed(first: int, last: int, motion: MeasuredMotion) -> dict[int, float]:
    """How much of what happens has happened by each frame, from 0 to 1."""
    frames = range(first, last + 1)
    length = max(1, last - first)
    moved = list(accumulate(motion.speeds.get(frame, 0.0) for frame in frames))
    share = _OF_MOTION if moved[-1] > 0 else 0.0
    total = moved[-1] or 1.0
    return {
        frame: share * so_far / total + (1 - share) * (frame - first) / length
        for frame, so_far in zip(frames, moved, strict=True)
    }
