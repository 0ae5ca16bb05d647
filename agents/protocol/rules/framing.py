"""R14: the camera sees what it is to show."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.judging.phases import body_of
from agents.protocol.measures.measure import Measures, Unmeasured
from agents.protocol.measures.motion import View
from agents.protocol.rule import Idle, Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding
    from agents.protocol.measures.motion import ViewMeasure


def _subjects(subject: Subject) -> tuple[str, ...]:
    found = tuple(dict.fromkeys(subject.planned.camera.subjects))
    if not found:
        raise Idle("the plan names no subjects of the camera")
    return found


def _frames(subject: Subject) -> tuple[int | None, ...]:
    """The first, the middle and the last frame; now, in a still scene."""
    facts, plan, structure = subject.facts, subject.planned, subject.structure
    seen = [*(one.name for one in structure.meshes), facts.camera or ""]
    if plan.render.kind == "still" and not plan.motion.phases and not any(map(structure.moves, seen)):
        return (None,)
    return tuple(sorted({facts.frame_start, (facts.frame_start + facts.frame_end) // 2, facts.frame_end}))


def _views(subject: Subject, name: str) -> list[View]:
    names = body_of(subject, name)
    return [View(names, frame) for frame in _frames(subject)] if names else []


def _requests(subject: Subject) -> Iterator[View]:
    if subject.facts.camera is not None:
        for name in _subjects(subject):
            yield from _views(subject, name)


def _judge(subject: Subject, measures: Measures) -> Iterator[Finding]:
    names = _subjects(subject)
    if subject.facts.camera is None:
        yield R14.finding(
            names, "The scene has no active camera.", fix="Make a camera the scene's (scene.camera)."
        )
        return
    for name in names:
        views = _views(subject, name)
        if not views:
            yield R14.undecided((name,), f"there is nothing called {name!r}")
            continue
        try:
            found = [(view.frame, measures[view]) for view in views]
        except Unmeasured as reason:
            yield R14.undecided((name,), reason)
            continue
        # What is yet to be emitted is not missed.
        found = [(frame, seen) for frame, seen in found if seen.inside is not None]
        if not found:
            yield R14.undecided((name,), "there is nothing of it at the frames that were looked at")
            continue
        yield from _unseen(subject, name, found)


def _unseen(subject: Subject, name: str, views: list[tuple[int | None, ViewMeasure]]) -> Iterator[Finding]:
    """What is amiss, each at the frame at which it is worst; a view that misses it is not looked at further."""
    camera, tolerances = subject.facts.camera or "", subject.tolerances
    told = [(frame, 1 - (view.inside or 0.0), view) for frame, view in views]
    frame, outside, view = max(told, key=lambda one: one[1])
    if outside > tolerances.out_of_frame:
        yield R14.finding(
            (name, camera),
            f"{outside:.0%} of {name!r} is outside of the picture of {camera!r}{_at(frame)}.",
            frame=frame,
            measured=outside,
            tolerance=tolerances.out_of_frame,
            at=view.at,
        )
    views = [(frame, view) for frame, outside, view in told if outside <= tolerances.out_of_frame]
    if not views:
        return
    frame, view = min(views, key=lambda one: one[1].cover or 0.0)
    if (cover := view.cover or 0.0) < tolerances.frame_cover:
        yield R14.finding(
            (name, camera),
            f"{name!r} covers {cover:.2%} of the picture of {camera!r}{_at(frame)}.",
            fix="Move the camera nearer, or use a longer lens.",
            frame=frame,
            measured=cover,
            tolerance=tolerances.frame_cover,
            at=view.at,
        )
    frame, view = max(views, key=lambda one: one[1].hidden or 0.0)
    if (hidden := view.hidden or 0.0) > tolerances.occluded:
        yield R14.finding(
            (name, *view.by, camera),
            f"{hidden:.0%} of {name!r} is hidden from {camera!r}{_at(frame)}, most of all by "
            f"{', '.join(map(repr, view.by))}.",
            fix="Move the camera, or what stands in the way.",
            frame=frame,
            measured=hidden,
            tolerance=tolerances.occluded,
            at=view.at,
        )


def _at(frame: int | None) -> str:
    return "" if frame is None else f" at frame {frame}"


R14 = Rule(
    "R14",
    "framing",
    "hard",
    "The active camera sees each planned subject: inside the picture, large enough, not hidden by other things; of "
    "what moves, at the first, the middle and the last frame.",
    "What the camera does not show was built for nothing.",
    "Aim the camera at its subjects, from a place and with a lens that takes them in.",
    _judge,
    _requests,
    needs_plan=True,
    tolerances=("out_of_frame", "frame_cover", "occluded"),
)
RULES = (R14,)
