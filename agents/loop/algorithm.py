"""The paper's algorithm: plan once, build stage by stage, render, review, fix once."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from agents.loop.asset_library import prompt_with_assets
from agents.loop.errors import NotSaved
from agents.loop.film.allotted_time import room_for_film
from agents.loop.film.rendering import LastStage
from agents.loop.record.events import PlanMade, StageMoved
from agents.loop.running.position import START
from agents.loop.stage import StageLoop
from agents.loop.task import RunTask
from agents.plan.part import STAGES
from agents.roles.planner import Planner, format_plan

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.loop.film.rendering import RenderResult
    from agents.loop.running.run import Run
    from agents.plan.part import Stage
    from agents.plan.scene import RenderSettings, ScenePlan

# Without stages, one pass builds everything, and is judged as the last stage is.
ALL_AT_ONCE: tuple[Stage, ...] = ("light",)
_WITHOUT_STAGES = """\
This run has no stages. What is called the stage "light" here is everything at once: geometry, materials, what \
deforms, motion, camera and light, in one pass from an empty scene."""


def make(run: Run) -> RenderResult:
    """From the prompt to a rendered scene (paper, Algorithm 1). Raises RunError, ModelError."""
    run.save("modeling", START)
    planner = Planner(run.context)
    plan = planner.strategic(prompt_with_assets(run), room_for_film(run))
    run.files.write_plan(plan)
    run.journal.note(PlanMade(plan=plan))
    staged = run.options.stages
    told = format_plan(plan, run.options.prompt)
    text = told if staged else f"{_WITHOUT_STAGES}\n\n{told}"
    run.task = task = RunTask(text, plan, _actors(plan))
    wanted = stages_of(plan) if staged else ALL_AT_ONCE
    last = build(run, planner, task, wanted)
    return finish(run, planner, task, plan.render, last)


def build(run: Run, planner: Planner, task: RunTask, wanted: Sequence[Stage]) -> str:
    """Closes the ``wanted`` stages in order; the name of the last one. Raises Aborted, ModelError."""
    last = START
    for stage in STAGES[:-1]:
        if stage not in wanted:
            run.journal.note(StageMoved(type="stage.skipped", stage=stage))
            continue
        attempts = StageLoop(run, planner, task, stage, last).build()
        if run.options.early:
            with suppress(NotSaved):  # the stage is saved, and an earlier scene stands
                run.deliver(stage)
        path = f"checkpoints/{stage}.blend"
        run.journal.note(StageMoved(type="stage.closed", stage=stage, attempts=attempts, file=path))
        run.position.close(stage)
        last = stage
    return last


def finish(run: Run, planner: Planner, task: RunTask, plan: RenderSettings | None, last: str) -> RenderResult:
    """Renders the scene, has it reviewed, fixes it once if needed, and saves it. Raises RunError, ModelError."""
    rendering = LastStage(run, planner, task, plan, last).finish()
    run.deliver("render", verify=True)
    return rendering


def stages_of(plan: ScenePlan) -> tuple[Stage, ...]:
    """The stages to build: without the UV stage where no material has a texture, so that nothing needs coordinates."""
    has_texture = any(planned.material and planned.material.texture.strip() for planned in plan.objects)
    return tuple(stage for stage in plan.stages if has_texture or stage != "uv")


def _actors(plan: ScenePlan) -> tuple[str, ...]:
    return tuple(dict.fromkeys(phase.actor for phase in plan.motion.phases))
