"""The last stage: renders, has the result reviewed, and fixes it once (paper, "Final Render and Review")."""

from __future__ import annotations

import os
import shutil
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agents.blender.render.image_checks import LARGEST_STILL, look_at
from agents.loop.edit.comparison import compared
from agents.loop.errors import RunError
from agents.loop.events import FinalReviewed, SceneRendered
from agents.loop.judging import note_verdict, verify
from agents.loop.run import RUNNER
from agents.plan.tactical import FinalReview
from agents.roles.coder import Coder
from agents.roles.final_reviewer import final_review
from simworlds.llm.errors import Declined, Misfit
from simworlds.llm.messages import Picture, Text
from simworlds.sandbox.confined_command import best_sandbox
from simworlds.sandbox.picture_decoder import PictureDecoder

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.loop.run import Run
    from agents.loop.task import RunTask
    from agents.plan.scene import RenderSettings
    from simworlds.llm.messages import Block

LARGEST_FRAME = 1024  # pixels a side, of one of several frames
_FRAMES_SHOWN = 5  # at 0, 25, 50, 75, 100 %
_ENGINES = {"CYCLES": "cycles", "BLENDER_EEVEE": "eevee", "BLENDER_WORKBENCH": "workbench"}


@dataclass(frozen=True, slots=True)
class RenderResult:
    """What was rendered: a ``video`` and its frames, or a still; ``path`` is the file in the run's folder.

    ``shown``: some of the frames, each with its picture as models see it.
    """

    path: Path
    frames: tuple[Path, ...]
    text: str
    shown: tuple[tuple[Path, Picture], ...]


def render(run: Run, plan: RenderSettings | None, number: int) -> RenderResult:
    """Renders the scene as planned (None: by the scene's own settings). Raises RunError."""
    run.attempt = number
    asked: dict[str, Any] = {"kind": plan.kind if plan else "still"}
    if plan is not None:
        asked |= {"engine": _ENGINES[plan.engine], "samples": run.options.samples or plan.samples}
        asked |= {"width": plan.resolution[0], "height": plan.resolution[1]}
    if run.options.render_minutes is not None:
        asked["time_budget"] = run.options.render_minutes * 60
    outcome = run.use(RUNNER, "render", "blender_render", asked)
    if outcome.failed:
        raise RunError(f"The scene could not be rendered: {outcome.text}")
    data = outcome.data
    moving = data["kind"] == "animation"
    made = Path(data["video"]["path"] if moving and data.get("video") else data["path"])
    frames = tuple(sorted(Path(data["path"]).glob("*.png"))) if moving else (made,)
    result = run.root / ("video.mp4" if moving else "still.png")
    if made.is_file():
        _link(made, result)
    shown = _pictures(_spread(frames))
    run.journal.note(
        SceneRendered(
            round=number,
            kind=data["kind"],
            path=result.name,
            frames=len(frames),
            samples=data.get("samples"),
            seconds=data.get("seconds"),
            pictures=tuple(run.keep(picture) for _, picture in shown),
        )
    )
    return RenderResult(result, frames, outcome.text, shown)


def _pictures(paths: Sequence[Path]) -> tuple[tuple[Path, Picture], ...]:
    """Rendered frames with their pictures as models see them; Blender has written the files."""
    with closing(PictureDecoder(best_sandbox())) as decoder:
        return tuple(
            (path, Picture(look_at(decoder, path, LARGEST_STILL if len(paths) == 1 else LARGEST_FRAME).png))
            for path in paths
        )


def review(run: Run, task: RunTask, rendering: RenderResult, number: int) -> FinalReview:
    """The final reviewer's verdict. A reviewer that declines counts as accepting, and the summary says so."""
    content: list[Block | str] = [Text(rendering.text)]
    if compared_with := _in_film(rendering, task):
        content += compared(run, task, compared_with)
    for place, (path, picture) in enumerate(rendering.shown):
        content += [Text(f"Frame {path.stem} ({25 * place} %):"), picture]
    try:
        review = final_review(run.context, task.plan_text, content, edit=task.edit)
    except (Declined, Misfit) as error:
        review = FinalReview(verdict="accept", summary=f"There is no final review: {error}"[:4000])
    run.journal.note(FinalReviewed(round=number, review=review))
    return review


def _in_film(rendering: RenderResult, task: RunTask) -> Picture | None:
    """The picture of the frame that an edit is compared at; the first, if that was not rendered."""
    if task.before is None and task.goal is None:
        return None
    name = f"{task.before_frame or 0:04d}"
    path = next((one for one in rendering.frames if one.stem == name), rendering.frames[0])
    known = dict(rendering.shown)
    return known[path] if path in known else _pictures([path])[0][1]


def fix(run: Run, task: RunTask, review: FinalReview, last: str) -> bool:
    """Fixes once what the final reviewer wants, from the last checkpoint on; whether the fix stands.

    A fix that is not finished, or breaks a hard rule, is undone: the result is never worse for it.
    """
    run.attempt = 2
    run.roll_back("render", 1, last)
    coder = Coder(run.context, "render", task.plan_text, edit=task.edit)
    worked = run.attempted("render", 2, lambda: coder.fix(review.instructions, run.state("render")))
    verdict = verify(run, "render", task)
    note_verdict(run, "render", 2, verdict)
    if verdict.ok and worked.how == "done":
        return True
    run.roll_back("render", 2, last)
    return False


def _spread(frames: Sequence[Path]) -> list[Path]:
    """Five of them, from the first to the last."""
    last = len(frames) - 1
    places = {round(last * share / (_FRAMES_SHOWN - 1)) for share in range(_FRAMES_SHOWN)}
    return [frames[place] for place in sorted(places)]


def _link(made: Path, result: Path) -> None:
    result.unlink(missing_ok=True)
    try:
        os.link(made, result)
    except OSError:
        shutil.copyfile(made, result)
