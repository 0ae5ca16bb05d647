"""What the reviewer is shown of a stage, so that it sees what it is to judge."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

from agents.loop.edit.comparison import compared
from agents.loop.film.telling_frames import MeasuredMotion, telling_frames
from agents.loop.running.run_tools import RENDER, RUNNER
from agents.plan.part import STAGES
from simworlds.llm.messages import Picture, Text

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from agents.loop.running.run import Run
    from agents.loop.task import RunTask
    from agents.plan.motion import MotionPhase
    from agents.plan.part import Stage
    from agents.plan.scene import RenderSettings
    from simworlds.llm.messages import Block

WIDTH, SAMPLES = 960, 64  # of stills, at most
_LEAST_SAMPLES = 16  # that leave a denoised picture readable
_SECONDS = 60  # for each: of what takes longer, fewer samples are taken
_MOST_ACTORS, _MOST_PHASES, _MOST_SHEETS = 8, 24, 6  # of a motion sheet; sheets of a stage
_MOST_SUBJECTS = 40
_MOST_TARGETS = 200
_LOOKS = 3  # frames of a film that the camera's and the light's reviewers see
_LAYOUT, _MATERIALS, _UV = "blender_scene_layout_preview", "blender_material_preview", "blender_uv_preview"
_MOTION, _STATE = "blender_motion_sheet_preview", "blender_scene_state"


def moves(stage: Stage) -> bool:
    """Whether things move from this stage on."""
    return STAGES.index(stage) >= STAGES.index("motion")


def evidence(run: Run, stage: Stage, task: RunTask) -> list[Block | str]:
    """The layout, then what the stage is about, then the coder's own stills and the readout.

    Motion is shown in its stage: what comes after does not touch it, and rules judge it to the end. Materials are lit
    by a light of their own; what the camera sees is lit so until the scene has its light, and then rendered at the
    first frame, at that of the fastest motion, and at the last. Of an edit, the file as it was stands beside the file
    as it is.
    """
    shown = _Shown(run, stage)
    subjects = _subjects(task)
    first = subjects or list(task.targets)[:_MOST_SUBJECTS]
    shown.take(_LAYOUT, {"subjects": subjects} if subjects else {})
    if stage == "uv":
        shown.take(_UV, {})
    if stage == "texture" or not run.options.stages:
        _show_materials(shown, task, first)
    if task.actors and (stage == "motion" or (moves(stage) and not run.options.stages)):
        phases = task.plan.motion.phases if task.plan is not None and stage == "motion" else ()
        sheets = motion_sheets(task.actors, phases)
        run.motion = MeasuredMotion.of([shown.take(_MOTION, sheet) for sheet in sheets], phases)
    if task.edit:
        shown.blocks += edit_comparison(run, stage, task)
    elif stage == "camera":
        shown.take(_MATERIALS, {"show": "scene", "frames": _telling_frames(task, run.motion)})
    elif stage == "light":
        for frame in _telling_frames(task, run.motion):
            asked = still(f"look-{frame}", frame, _width(task), _samples(run, task))
            shown.take(RENDER, _again(asked))
    shown.blocks += _coders_stills(run)
    focus, known = task.readout()
    shown.take(_STATE, focus or ({"first": first} if first else {}), known)
    return shown.blocks


class _Shown:
    """Collects what the tools show."""

    def __init__(self, run: Run, stage: Stage) -> None:
        self._run = run
        self._stage: Stage = stage
        self.blocks: list[Block | str] = []

    def take(
        self, name: str, arguments: Mapping[str, Any], known: Mapping[str, Any] | None = None
    ) -> Mapping[str, Any]:
        """Shows what a call gives; returns it as data. ``known``: arguments that follow from the run."""
        outcome = self._run.tools.use(RUNNER, self._stage, name, arguments, known)
        self.blocks += [Text(f"{name}:"), *outcome.content]
        return outcome.data


def _show_materials(shown: _Shown, task: RunTask, first: Sequence[str]) -> None:
    """All in its materials; of an edit, alone only what its plan names and what it has added."""
    if task.edit:
        asked = {"first": list(task.targets)[:_MOST_TARGETS], "only_first": True}
        shown.take(_MATERIALS, asked, task.old_objects)
    else:
        shown.take(_MATERIALS, {"first": list(first)} if first else {})


def _width(task: RunTask) -> int:
    """Of stills."""
    return still_width(task.plan.render) if task.plan is not None else WIDTH


def still_width(render: RenderSettings) -> int:
    """No more than the plan's picture has, as larger ones take longer than they tell."""
    return min(WIDTH, render.resolution[0])


def _samples(run: Run, task: RunTask) -> int:
    return still_samples(run, task.plan.render) if task.plan is not None else min(SAMPLES, _LEAST_SAMPLES)


def still_samples(run: Run, render: RenderSettings) -> int:
    """As many as the film's, as far as a picture of so many is readable, and more would tell nothing.

    They are those that the run began with: a session that resumes asks for the same stills.
    """
    return min(SAMPLES, max(_LEAST_SAMPLES, run.options.samples or render.samples))


def still(
    name: str,
    frame: int | None,
    width: int | None = None,
    samples: int | None = None,
    seconds: float = _SECONDS,
) -> dict[str, Any]:
    """The arguments of a still that is to be looked at, and may take so many seconds."""
    asked = {"kind": "still", "name": name, "width": width or WIDTH, "denoise": True}
    asked["samples"] = samples or min(SAMPLES, _LEAST_SAMPLES)
    return {**asked, "time_budget": seconds} | ({} if frame is None else {"frame": frame})


def _again(asked: dict[str, Any]) -> dict[str, Any]:
    """The arguments of a still that is shown as it was rendered before, while nothing that it shows has changed."""
    return {**asked, "keep": True}


def _subjects(task: RunTask) -> list[str]:
    """What the plan is about: the camera's subjects and the actors."""
    subjects = (*task.plan.camera.subjects, *task.actors) if task.plan is not None else ()
    return list(dict.fromkeys(subjects))[:_MOST_SUBJECTS]


def motion_sheets(actors: Sequence[str], phases: Iterable[MotionPhase]) -> list[dict[str, Any]]:
    """Arguments of motion sheets that show all actors, by the plan's phases.

    A sheet reads best whose phases do not overlap: actors share one as far as theirs do not. What would need too many
    sheets is shown without phases.
    """
    by_actor: dict[str, set[tuple[int, int, str]]] = {actor: set() for actor in actors}
    for phase in phases:
        if phase.actor in by_actor and phase.end > phase.start:
            by_actor[phase.actor].add((phase.start, phase.end, phase.name))
    sheets: list[tuple[list[str], set[tuple[int, int, str]]]] = []
    for actor, planned in by_actor.items():
        own = planned if _is_in_a_row(planned) else set[tuple[int, int, str]]()
        fitting = (
            sheet
            for sheet in sheets
            if len(sheet[0]) < _MOST_ACTORS and bool(own) == bool(sheet[1]) and _is_in_a_row(sheet[1] | own)
        )
        sheet = next(fitting, None)
        if sheet is None:
            sheet = ([], set())
            sheets.append(sheet)
        sheet[0].append(actor)
        sheet[1].update(own)
    if len(sheets) > _MOST_SHEETS:
        most = _MOST_ACTORS * _MOST_SHEETS
        few = list(actors)[:: max(1, -(-len(actors) // most))]
        return [{"actors": few[at : at + _MOST_ACTORS]} for at in range(0, len(few), _MOST_ACTORS)]
    return [
        {"actors": names}
        | ({"phases": [{"name": name, "start": a, "end": b} for a, b, name in sorted(own)]} if own else {})
        for names, own in sheets
    ]


def _is_in_a_row(phases: set[tuple[int, int, str]]) -> bool:
    """Whether none begins before another ends."""
    ordered = sorted(phases)
    return len(ordered) <= _MOST_PHASES and all(
        phase[1] <= after[0] for phase, after in itertools.pairwise(ordered)
    )


def _telling_frames(task: RunTask, motion: MeasuredMotion) -> list[int]:
    """The first frame, that of the fastest motion, and the last; of a still, the first."""
    plan = task.plan
    if plan is None or plan.render.kind == "still":
        return [plan.frame_start] if plan is not None else []
    return telling_frames(plan.frame_start, plan.frame_end, _LOOKS, motion, plan.motion.phases)


def _coders_stills(run: Run) -> list[Block | str]:
    """The last pictures that the coder rendered in this attempt."""
    blocks: list[Block | str] = []
    for kept in run.stills:
        when = "of the scene as it is" if run.is_current(kept) else "made before its last changes"
        blocks += [Text(f"A still of the coder's own, {when}. {kept.text}"), kept.picture]
    return blocks


def edit_comparison(run: Run, stage: Stage, task: RunTask) -> list[Block | str]:
    """The file as it was, as it is, and as it is to be, at one size; nothing where there is nothing to compare with."""
    if task.before is None and task.goal is None:
        return []
    outcome = run.tools.use(
        RUNNER,
        stage,
        RENDER,
        _again(still("present", task.before_frame, task.before_width, task.before_samples)),
    )
    now = next((block for block in outcome.content if isinstance(block, Picture)), None)
    words = [Text(f"{RENDER}, the scene as it is now:"), *(b for b in outcome.content if isinstance(b, Text))]
    return [*words, *(compared(run, task, now) if now is not None else ())]
