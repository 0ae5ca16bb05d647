"""R14 and W6: the camera shows its planned subjects, also as one sets another in motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.protocol.judging.measured_motion import followed_names
from agents.protocol.judging.phases import RESTING, cause_of, phase_label, planned_phases
from agents.protocol.measures.motion import CameraViewRequest
from agents.protocol.measures.requests import Measures, Unmeasured
from agents.protocol.rule import NotApplicable, Rule, RuleContext

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.motion import MotionPhase
    from agents.protocol.findings import Finding
    from agents.protocol.measures.motion import CameraViewMeasure


def _subjects(context: RuleContext) -> tuple[str, ...]:
    subjects = tuple(dict.fromkeys(context.planned.camera.subjects))
    if not subjects:
        raise NotApplicable("the plan names no subjects of the camera")
    return subjects


def _frames(context: RuleContext) -> tuple[int | None, ...]:
    """The first, middle and last frame; the current one (None) in a still scene."""
    facts, plan, structure = context.facts, context.planned, context.structure
    names = [*(mesh.name for mesh in structure.meshes), facts.camera or ""]
    if plan.render.kind == "still" and not plan.motion.phases and not any(map(structure.can_move, names)):
        return (None,)
    return tuple(sorted({facts.frame_start, (facts.frame_start + facts.frame_end) // 2, facts.frame_end}))


def _views(context: RuleContext, name: str) -> list[CameraViewRequest]:
    names = followed_names(context, name)
    return [CameraViewRequest(names, frame) for frame in _frames(context)] if names else []


def _requests(context: RuleContext) -> Iterator[CameraViewRequest]:
    if context.facts.camera is not None:
        for name in _subjects(context):
            yield from _views(context, name)


def _judge(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    names = _subjects(context)
    if context.facts.camera is None:
        yield R14.finding(
            names, "The scene has no active camera.", fix="Make a camera the active one (scene.camera)."
        )
        return
    for name in names:
        views = _views(context, name)
        if not views:
            yield R14.undecided((name,), f"no object is named {name!r}")
            continue
        try:
            seen = [(view.frame, measures[view]) for view in views]
        except Unmeasured as reason:
            yield R14.undecided((name,), reason)
            continue
        # Particles that are not emitted yet are not missing.
        seen = [(frame, view) for frame, view in seen if view.inside is not None]
        if not seen:
            yield R14.undecided((name,), "it does not exist at any of the checked frames")
            continue
        findings = list(_badly_framed(context, name, seen))
        if findings and _grows(context, name):
            # It begins as nothing and may leave the picture: one frame that shows it well is enough.
            by_frame = [list(_badly_framed(context, name, [view])) for view in seen]
            findings = min(by_frame, key=len)
        yield from findings


def _grows(context: RuleContext, name: str) -> bool:
    """Whether a subject flows out bit by bit: a gas, or an inflow of liquid."""
    obj = context.structure.by_name.get(name)
    return obj is not None and any(
        item.is_gas or (item.fluid is not None and item.fluid.behavior == "inflow") for item in obj.members
    )


def _badly_framed(
    context: RuleContext, name: str, views: list[tuple[int | None, CameraViewMeasure]]
) -> Iterator[Finding]:
    """Findings, each at its worst frame; frames that do not show the subject are not judged further."""
    camera, tolerances = context.facts.camera or "", context.tolerances
    outsides = [(frame, 1 - (view.inside or 0.0), view) for frame, view in views]
    frame, outside, view = max(outsides, key=lambda entry: entry[1])
    if outside > tolerances.out_of_frame:
        yield R14.finding(
            (name, camera),
            f"{outside:.0%} of {name!r} is outside the picture of {camera!r}{_at(frame)}.",
            frame=frame,
            measured=outside,
            tolerance=tolerances.out_of_frame,
            at=view.at,
        )
    views = [(frame, view) for frame, outside, view in outsides if outside <= tolerances.out_of_frame]
    if not views:
        return
    frame, view = min(views, key=lambda entry: entry[1].cover or 0.0)
    if (cover := view.cover or 0.0) < tolerances.frame_cover:
        yield R14.finding(
            (name, camera),
            f"{name!r} covers only {cover:.2%} of the picture of {camera!r}{_at(frame)}.",
            fix="Move the camera nearer, or use a longer lens.",
            frame=frame,
            measured=cover,
            tolerance=tolerances.frame_cover,
            at=view.at,
        )
    frame, view = max(views, key=lambda entry: entry[1].hidden or 0.0)
    if (hidden := view.hidden or 0.0) > tolerances.occluded:
        yield R14.finding(
            (name, *view.by, camera),
            f"{hidden:.0%} of {name!r} is hidden from {camera!r}{_at(frame)}, mostly by "
            f"{', '.join(map(repr, view.by))}.",
            fix="Move the camera, or the objects in the way.",
            frame=frame,
            measured=hidden,
            tolerance=tolerances.occluded,
            at=view.at,
        )


def _at(frame: int | None) -> str:
    return "" if frame is None else f" at frame {frame}"


# What sets another in motion


@dataclass(frozen=True, slots=True)
class _Blow:
    """A phase that another actor's causes, at ``place`` in the plan, and a subject that acts in one of the two."""

    place: int
    phase: MotionPhase
    subject: str


def _blows(context: RuleContext) -> dict[CameraViewRequest, _Blow]:
    """A look at each frame and subject that can be looked at, with the first blow there. Raises NotApplicable."""
    subjects, facts = _subjects(context), context.facts
    blows: dict[CameraViewRequest, _Blow] = {}
    for place, phase in planned_phases(context):
        cause = cause_of(context, phase)
        if cause is None or cause.actor == phase.actor or phase.kind in RESTING:
            continue
        if not facts.frame_start <= phase.start <= facts.frame_end:
            continue
        for subject in subjects:
            if subject in {phase.actor, cause.actor} and not _grows(context, subject):
                names = followed_names(context, subject)
                if names and facts.camera is not None:
                    look = CameraViewRequest(names, phase.start)
                    blows.setdefault(look, _Blow(place, phase, subject))
    if not blows:
        raise NotApplicable("no subject of the camera sets another in motion, or is set in motion")
    return blows


def _looks(context: RuleContext) -> Iterator[CameraViewRequest]:
    yield from _blows(context)


def _unseen(context: RuleContext, measures: Measures) -> Iterator[Finding]:
    """Findings, one for each subject and frame."""
    camera, most = context.facts.camera or "", context.tolerances.occluded
    for look, blow in _blows(context).items():
        try:
            view = measures[look]
        except Unmeasured as reason:
            yield W6.undecided((blow.subject,), reason)
            continue
        if view.inside is None:
            continue
        hidden = view.hidden or 0.0
        unseen = 1 - view.inside * (1 - hidden)
        if unseen <= most:
            continue
        outside = 1 - view.inside
        why = f"{outside:.0%} is outside the picture" if outside else ""
        if hidden:
            behind = f"{hidden:.0%} is hidden, mostly by {', '.join(map(repr, view.by))}"
            why = f"{why}; of the rest, {behind}" if why else behind
        yield W6.finding(
            (blow.subject, *view.by, camera),
            f"{phase_label(blow.place, blow.phase)} begins at frame {blow.phase.start}, where {camera!r} shows "
            f"{1 - unseen:.0%} of {blow.subject!r}: {why}.",
            frame=blow.phase.start,
            measured=unseen,
            tolerance=most,
            at=view.at,
        )


R14 = Rule(
    "R14",
    "framing",
    "hard",
    "The active camera shows each planned subject: inside the picture, large enough, not hidden by other objects; in a "
    "moving scene at the first, middle and last frame; gas and inflows at one of them.",
    "An object that the camera does not show was built for nothing.",
    "Aim the camera at its subjects, from a place and with a lens that show them all.",
    _judge,
    _requests,
    needs_plan=True,
    tolerances=("out_of_frame", "frame_cover", "occluded"),
)
W6 = Rule(
    "W6",
    "cause and effect in view",
    "soft",
    "Where a phase begins that another causes, the camera shows at least half of each of its subjects that acts in "
    "them.",
    "A blow that is hidden is missed: the film shows that things move, and not why.",
    "If the film is to show it, move the camera, or what is in the way.",
    _unseen,
    _looks,
    needs_plan=True,
    tolerances=("occluded",),
)
RULES = (R14, W6)
