"""The frames of a film that tell what happens in it: its ends, where its phases move fastest, and between them evenly.

Even times alone show a short fall in a long film at rest.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import accumulate, chain, zip_longest
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from agents.plan.motion import MotionPhase

_GROWS = frozenset({"flow", "emit"})  # fastest as it begins, when there is hardly anything to see
_SLOW = 0.1  # of the fastest speed; phases that are slower have no frame of their own
_APART = 4  # frames that are nearer than this part of an even distance show the same
_OF_MOTION = 0.8  # what is put between others goes by motion so far, the rest by time


@dataclass(frozen=True, slots=True)
class MeasuredMotion:
    """What motion sheets measured. ``peaks``: the highest speed of each phase, and the frame that shows it best.

    ``meetings``: the frames at which an actor comes to touch something, the first of each of the two.
    ``speeds``: how fast everything was at a frame, where the fastest of each actor is 1.
    """

    peaks: tuple[tuple[float, int], ...] = ()
    meetings: tuple[int, ...] = ()
    speeds: Mapping[int, float] = field(default_factory=dict[int, float])

    @classmethod
    def of(cls, sheets: Iterable[Mapping[str, Any]], phases: Iterable[MotionPhase]) -> MeasuredMotion:
        """From the data of motion sheets."""
        kinds = {(phase.name, phase.start, phase.end): phase.kind for phase in phases}
        peaks: list[tuple[float, int]] = []
        meetings: set[int] = set()
        speeds: dict[int, float] = {}
        for actor in (actor for sheet in sheets for actor in sheet.get("actors", ())):
            for row in actor.get("phases", ()):
                if row.get("peak_frame") is None:
                    continue
                start, end, frame = row["start"], row["end"], row["peak_frame"]
                if kinds.get((row["phase"], start, end)) in _GROWS:
                    frame = max(frame, start + (end - start) // 4)
                peaks.append((row["peak_speed"], frame))
            meetings.update(_meetings(actor))
            measured = zip(actor.get("frames", ()), actor.get("speeds", ()), strict=False)
            known = {frame: speed for frame, speed in measured if speed is not None}
            if fastest := max(known.values(), default=0.0):
                for frame, speed in known.items():
                    speeds[frame] = speeds.get(frame, 0.0) + speed / fastest
        return cls(tuple(sorted(peaks, reverse=True)), tuple(sorted(meetings)), speeds)


def _meetings(actor: Mapping[str, Any]) -> Iterator[int]:
    """When an actor first touches each of what it did not touch from the start."""
    first: dict[str, int] = {}
    for row in actor.get("phases", ()):
        for contact in row.get("contacts", ()):
            begun = min((begin for begin, _ in contact["frames"]), default=None)
            if begun is not None:
                first[contact["with"]] = min(begun, first.get(contact["with"], begun))
    start = min((row["start"] for row in actor.get("phases", ())), default=0)
    return (frame for frame in first.values() if frame > start)


def telling_frames(
    first: int, last: int, count: int, motion: MeasuredMotion, phases: Sequence[MotionPhase] = ()
) -> list[int]:
    """At most ``count`` frames in order, with ``first`` and ``last``. ``phases`` count where none was measured."""
    chosen = {first, last}
    apart = max(1.0, (last - first) / (_APART * count))
    fastest = motion.peaks[0][0] if motion.peaks else 0.0
    wanted = [frame for speed, frame in motion.peaks if speed >= _SLOW * fastest and fastest]
    # By turns, the fastest first: a bump is slower than the way to it.
    by_turns = chain.from_iterable(zip_longest(wanted, motion.meetings))
    wanted = [frame for frame in by_turns if frame is not None]
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
