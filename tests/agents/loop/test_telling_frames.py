"""The frames by which a film is judged: its ends, its fastest moments, and what lies between where most happens."""

from __future__ import annotations

from typing import Any

import pytest

from agents.loop.film.telling_frames import MeasuredMotion, telling_frames
from agents.plan.motion import MotionPhase


def phase(name: str, start: int, end: int, kind: Any = "fall") -> MotionPhase:
    return MotionPhase(name=name, actor="Bear", kind=kind, start=start, end=end)


def sheet(rows: list[tuple[MotionPhase, float, int]], speeds: dict[int, float]) -> dict[str, Any]:
    """A motion sheet's data: for each phase its highest speed and the frame of that."""
    phases = [
        {"phase": one.name, "start": one.start, "end": one.end, "peak_speed": speed, "peak_frame": frame}
        for one, speed, frame in rows
    ]
    return {"actors": [{"phases": phases, "frames": list(speeds), "speeds": list(speeds.values())}]}


DROP, BOB, REST = phase("drop", 1, 6), phase("bob", 7, 42, "bounce"), phase("rest", 43, 84, "settle")
FALLING = {frame: 0.4 * (frame - 1) if frame < 7 else 0.6 * 0.8 ** (frame - 7) for frame in range(1, 85)}


def test_a_short_fall_in_a_long_film_is_seen() -> None:
    motion = MeasuredMotion.of([sheet([(DROP, 2.0, 6), (BOB, 0.6, 7), (REST, 0.001, 43)], FALLING)], [])
    frames = telling_frames(1, 84, 5, motion)
    assert (frames[0], frames[-1], len(frames)) == (1, 84, 5)
    assert 6 in frames
    assert sum(frame <= 20 for frame in frames) >= 3, frames
    assert telling_frames(1, 84, 3, motion) == [1, 6, 84]


def test_a_burst_between_even_times_is_seen_once_there_is_something_to_see() -> None:
    burst = phase("burst", 8, 20, "emit")
    motion = MeasuredMotion.of([sheet([(burst, 17.0, 9)], {})], [burst])
    assert 11 in telling_frames(1, 144, 5, motion)


def test_each_phase_has_a_frame_the_fastest_first() -> None:
    hops = [phase(f"hop {number}", 20 * number, 20 * number + 10) for number in range(1, 7)]
    rows = [(hop, 7.0 - number, hop.start + 5) for number, hop in enumerate(hops)]
    motion = MeasuredMotion.of([sheet(rows, {})], hops)
    assert telling_frames(1, 200, 5, motion) == [1, 25, 45, 65, 200]
    assert telling_frames(1, 200, 8, motion) == [1, 25, 45, 65, 85, 105, 125, 200]


def test_a_bump_is_seen_though_the_way_from_it_is_faster() -> None:
    drift, spin, on = phase("drift", 1, 50), phase("spin", 51, 80), phase("on", 81, 120)
    measured = sheet([(drift, 0.38, 48), (spin, 0.379, 80), (on, 0.385, 114)], {})
    rows = measured["actors"][0]["phases"]
    rows[0]["contacts"] = [{"with": "Water", "frames": [[1, 50]]}]
    rows[1]["contacts"] = [{"with": "Water", "frames": [[51, 80]]}, {"with": "Stone", "frames": [[54, 62]]}]
    motion = MeasuredMotion.of([measured], [drift, spin, on])
    assert motion.meetings == (54,), "water is touched from the start"
    assert telling_frames(1, 120, 5, motion) == [1, 48, 54, 114, 120]
    assert telling_frames(1, 120, 4, motion) == [1, 54, 80, 120]


def test_what_was_not_measured_is_taken_from_the_plan() -> None:
    planned = [phase("fall", 40, 60), phase("wait", 60, 90, "hold")]
    assert telling_frames(1, 101, 3, MeasuredMotion(), planned) == [1, 50, 101]


@pytest.mark.parametrize(
    ("last", "count", "frames"),
    [(101, 5, [1, 26, 51, 76, 101]), (4, 5, [1, 2, 3, 4]), (1, 5, [1]), (2, 3, [1, 2])],
)
def test_without_motion_times_are_even_and_no_frame_comes_twice(
    last: int, count: int, frames: list[int]
) -> None:
    assert telling_frames(1, last, count, MeasuredMotion()) == frames
