"""The last stage: renders, has the result reviewed, and fixes it once (paper, "Final Render and Review")."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from agents.loop.edit.comparison import compared
from agents.loop.errors import NotRendered
from agents.loop.film.allotted_time import is_time_to_mend, minutes_of
from agents.loop.film.draft import asked_of, draft, draft_again, film_frames, settled_film
from agents.loop.film.pictures import link, pictures_of
from agents.loop.record.events import FilmDecided, FinalReviewed, SceneRendered
from agents.loop.review.verdicts import note_verdict, verify
from agents.loop.review.withdrawals import format_withdrawn
from agents.loop.running.run_tools import RENDER, RUNNER
from agents.plan.tactical import FilmDecision, FinalReview
from agents.roles.coder import Coder
from agents.roles.final_reviewer import final_review
from simworlds.llm.errors import Declined, Misfit
from simworlds.llm.messages import Picture, Text

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from agents.loop.film.fitting import FilmSettings
    from agents.loop.running.run import Run
    from agents.loop.running.tool_client import ToolOutcome
    from agents.loop.task import RunTask
    from agents.plan.scene import RenderSettings
    from agents.roles.planner import Planner
    from simworlds.llm.messages import Block

T = TypeVar("T")
_MOST_TELLING = 200
_MENDED = (
    "This is the result after what you asked for was mended. There is no further round: accept, and say in the summary "
    "what is mended, what is not, and what is worse than before."
)


@dataclass(frozen=True, slots=True)
class RenderResult:
    """What was rendered: a ``video`` and its frames, or a still; ``path`` is the file in the run's folder.

    ``shown``: some of the frames, each with its picture as models see it. ``samples``: of the last frames.
    ``film``: how it was to be rendered.
    """

    path: Path
    frames: tuple[Path, ...]
    text: str
    shown: tuple[tuple[Path, Picture], ...]
    samples: int | None = None
    film: FilmSettings | None = None


class LastStage:
    """Renders the scene that was closed as ``last``. Each fix by a coder begins another attempt."""

    def __init__(
        self, run: Run, planner: Planner, task: RunTask, plan: RenderSettings | None, last: str
    ) -> None:
        self._run = run
        self._planner = planner
        self._task = task
        self._plan = plan
        self._last = last
        self._attempt = 1
        self._film: FilmSettings | None = None

    def finish(self) -> RenderResult:
        """The result, reviewed, and fixed at most once for the final reviewer. Raises RunError, ModelError."""
        self._run.position.stage = "render"
        self._mended_if_need_be(self._draft)
        rendering = self._mended_if_need_be(lambda: self._render(1))
        verdict = self._review(rendering, 1)
        needs_fix = verdict.verdict == "needs_fix" and is_time_to_mend(self._run, 1)
        if needs_fix and self._fix(verdict.instructions):
            rendering = self._render(2)
            self._review(rendering, 2)  # it sees what came of its instructions
        return rendering

    def _mended_if_need_be(self, work: Callable[[], T]) -> T:
        """What ``work`` gives. If the scene cannot be rendered, a coder hears why, once."""
        try:
            return work()
        except NotRendered as error:
            if not self._fix(
                f"The scene cannot be rendered. Mend what is in the way, and nothing else: {error}"
            ):
                raise
            return work()

    # Before a film

    def _draft(self) -> None:
        """Fits the film to its time, and lets the planner decide on its frames, once."""
        run, plan = self._run, self._plan
        if plan is None or plan.kind != "animation" or not run.options.early:
            return
        made = draft(run, plan, self._attempt)
        if run.options.planner_looks:
            decision = self._decision(made.shown)
            run.journal.note(FilmDecided(attempt=self._attempt, decision=decision))
            if decision.transition == "mend" and self._fix(decision.instructions):
                made = draft_again(run, plan, self._attempt, made)
        self._film = made.film

    def _decision(self, shown: Sequence[Block]) -> FilmDecision:
        """The planner's. One that declines has no objection."""
        try:
            return self._planner.before_film(shown)
        except (Declined, Misfit) as error:
            return FilmDecision(transition="film", reason=f"There is no decision: {error}"[:2000])

    # Rendering

    def _render(self, number: int) -> RenderResult:
        """Renders the scene as planned (without a plan: by its own settings). Raises NotRendered."""
        run, film = self._run, self._film
        run.position.attempt = self._attempt
        minutes = minutes_of(run)
        if film is not None:
            film = settled_film(run, film, number, minutes)
        outcome = run.tools.use(RUNNER, "render", RENDER, self._arguments(film, minutes))
        if outcome.failed:
            raise NotRendered(f"The scene could not be rendered: {outcome.text}")
        return self._kept(number, outcome, film)

    def _arguments(self, film: FilmSettings | None, minutes: float) -> dict[str, Any]:
        """What ``blender_render`` is asked: what the plan says, but for what a film is fitted to."""
        plan = self._plan
        asked: dict[str, Any] = {"kind": plan.kind if plan else "still", "time_budget": minutes * 60}
        if plan is not None:
            width, height = plan.resolution
            samples = self._run.film_limits.samples or plan.samples
            asked |= asked_of(plan) | {"samples": samples, "width": width, "height": height}
        if film is not None:
            asked |= {"samples": film.samples, "width": film.width, "height": film.height}
        if self._task.plan is not None and asked["kind"] == "animation":
            begun = sorted({phase.start for phase in self._task.plan.motion.phases})
            asked["telling"] = begun[:_MOST_TELLING]
        return asked

    def _kept(self, number: int, outcome: ToolOutcome, film: FilmSettings | None) -> RenderResult:
        """Puts what was rendered into the run's folder, and journals it."""
        run, data = self._run, outcome.data
        moving = data["kind"] == "animation"
        made = Path(data["video"]["path"] if moving and data.get("video") else data["path"])
        frames = tuple(sorted(Path(data["path"]).glob("*.png"))) if moving else (made,)
        result = run.files.root / ("video.mp4" if moving else "still.png")
        if made.is_file():
            link(made, result)
        shown = pictures_of(_telling(run, frames))
        run.journal.note(
            SceneRendered(
                round=number,
                kind=data["kind"],
                path=result.name,
                frames=len(frames),
                samples=data.get("samples"),
                seconds=data.get("seconds"),
                pictures=tuple(run.files.keep(picture) for _, picture in shown),
            )
        )
        return RenderResult(result, frames, outcome.text, shown, data.get("samples"), film)

    def _review(self, rendering: RenderResult, number: int) -> FinalReview:
        """The final reviewer's verdict. One that declines counts as accepting, and the summary says so."""
        task = self._task
        content: list[Block | str] = [Text(rendering.text)]
        if number > 1:
            content.append(Text(_MENDED))
        if rendering.film is not None and self._plan is not None:
            asked = self._run.film_limits.samples
            content.append(Text(quality_of(rendering.film, self._plan, asked, rendering.samples)))
        if told := format_withdrawn(self._run.withdrawn):
            content.append(Text(told))
        if compared_with := _in_film(rendering, task):
            content += compared(self._run, task, compared_with)
        for path, picture in rendering.shown:
            content += [Text(f"Frame {path.stem}:"), picture]
        try:
            review = final_review(
                self._run.context,
                task.plan_text,
                content,
                self._run.acceptance.described(),
                edit=task.edit,
            )
        except (Declined, Misfit) as error:
            review = FinalReview(verdict="accept", summary=f"There is no final review: {error}"[:4000])
        self._run.journal.note(FinalReviewed(round=number, review=review, lines=self._run.acceptance.lines))
        return review

    def _fix(self, instructions: str) -> bool:
        """Lets a coder change the scene as it was closed last; whether the fix stands.

        A fix that is not finished, or breaks a hard rule, is undone: the result is never worse for it.
        """
        run, task = self._run, self._task
        before, self._attempt = self._attempt, self._attempt + 1
        run.position.attempt = self._attempt
        run.roll_back("render", before, self._last)
        coder = Coder(run.context, "render", task.plan_text, edit=task.edit)
        worked = run.attempted("render", self._attempt, lambda: coder.fix(instructions, self._standing()))
        verdict = verify(run, "render", task)
        note_verdict(run, "render", self._attempt, verdict)
        if verdict.ok and worked.how == "done":
            if run.options.early:  # a later fix begins with it
                name = f"mended-{self._attempt}"
                run.save("render", name)
                self._last = name
                run.position.close(name)
            return True
        run.roll_back("render", self._attempt, self._last)
        return False

    def _standing(self) -> str:
        """How the scene stands, and what of the plan is not to be mended."""
        told = format_withdrawn(self._run.withdrawn, to_builder=True)
        return "\n\n".join(filter(None, (told, self._run.state("render"))))


def quality_of(film: FilmSettings, plan: RenderSettings, asked: int | None, made: int | None) -> str:
    """How the film's samples and size came about: planned, asked for by the run's options, fitted, and made."""
    steps = [f"{plan.samples} planned"]
    if asked is not None and asked != plan.samples:
        steps.append(f"{asked} asked for by the run's options")
    if film.samples != (asked or plan.samples):
        steps.append(f"{film.samples} fitted to the time")
    if made is not None and made != film.samples:
        steps.append(f"{made} in some frames, since frames took longer than expected")
    width, height = plan.resolution
    size = f"{film.width}×{film.height}"
    planned = "" if (film.width, film.height) == (width, height) else f" instead of {width}×{height}"
    judged = " What time has lowered is not held against the scene." if planned or len(steps) > 1 else ""
    return f"The film's samples: {', '.join(steps)}. Its size: {size}{planned}.{judged}"


def _in_film(rendering: RenderResult, task: RunTask) -> Picture | None:
    """The picture of the frame that an edit is compared at; the first, if that was not rendered."""
    if task.before is None and task.goal is None:
        return None
    name = f"{task.before_frame or 0:04d}"
    path = next((frame for frame in rendering.frames if frame.stem == name), rendering.frames[0])
    known = dict(rendering.shown)
    return known[path] if path in known else pictures_of([path])[0][1]


def _telling(run: Run, frames: Sequence[Path]) -> list[Path]:
    """Those by which the film is judged. Where time was short, not every frame was rendered."""
    if len(frames) == 1:
        return list(frames)
    numbers = {int(path.stem): path for path in frames}
    wanted = film_frames(run, min(numbers), max(numbers))
    nearest = {min(numbers, key=lambda number: abs(number - frame)) for frame in wanted}
    return [numbers[number] for number in sorted(nearest)]
