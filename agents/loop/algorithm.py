"""The paper's algorithm: plan once, build stage by stage, render, review, fix once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.loop.events import PlanMade, StageMoved
from agents.loop.reducer import run_state_after
from agents.loop.rendering import fix, render, review
from agents.loop.run import START, plan_file
from agents.loop.stage import StageLoop
from agents.loop.task import RunTask
from agents.plan.part import STAGES
from agents.roles.planner import Planner, format_plan

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from agents.loop.rendering import RenderResult
    from agents.loop.run import Run
    from agents.plan.part import Stage
    from agents.plan.scene import RenderSettings, ScenePlan

# Without stages, one pass builds everything, and is judged as the last stage is.
ALL_AT_ONCE: tuple[Stage, ...] = ("light",)
_WITHOUT_STAGES = """\
This run has no stages. What is called the stage "light" here is everything at once: geometry, materials, what \
deforms, motion, camera and light, in one pass from an empty scene."""


def make(run: Run) -> RenderResult:
    """From the prompt to a rendered scene (paper, Algorithm 1). Raises RunError, ModelError."""
    run.save("modeling", START, run.checkpoints)
    planner = Planner(run.context)
    plan = planner.strategic(run.options.prompt)
    run.write("plan.json", plan_file(plan))
    run.journal.note(PlanMade(plan=plan))
    staged = run.options.stages
    told = format_plan(plan, run.options.prompt)
    text = told if staged else f"{_WITHOUT_STAGES}\n\n{told}"
    run.task = task = RunTask(text, plan, _actors(plan))
    wanted = stages_of(plan) if staged else ALL_AT_ONCE
    last = build(run, planner, task, wanted)
    return finish(run, task, plan.render, last)


def build(run: Run, planner: Planner, task: RunTask, wanted: Sequence[Stage]) -> str:
    """Closes the ``wanted`` stages in order; the name of the last one. Raises Aborted, ModelError."""
    last = START
    for stage in STAGES[:-1]:
        if stage not in wanted:
            run.journal.note(StageMoved(type="stage.skipped", stage=stage))
            continue
        attempts = StageLoop(run, planner, task, stage, last).build()
        file = run.save(stage, stage, run.checkpoints)
        path = f"checkpoints/{file.name}"
        run.journal.note(StageMoved(type="stage.closed", stage=stage, attempts=attempts, file=path))
        last = stage
    return last


def finish(run: Run, task: RunTask, plan: RenderSettings | None, last: str) -> RenderResult:
    """Renders the scene, has it reviewed, fixes it once if needed, and saves it. Raises RunError, ModelError."""
    rendering = render(run, plan, 1)
    verdict = review(run, task, rendering, 1)
    if verdict.verdict == "needs_fix" and fix(run, task, verdict, last):
        rendering = render(run, plan, 2)
    run.save("render", "scene", run.root, verify=True)
    return rendering


def result_so_far(run: Run) -> Path | None:
    """The file of the stage that was closed last."""
    closed = [stage.file for stage in run_state_after(run.journal.rows).stages if stage.state == "closed"]
    return run.root / closed[-1] if closed else None


def stages_of(plan: ScenePlan) -> tuple[Stage, ...]:
    """The stages to build: without the UV stage where no material has a texture, so that nothing needs coordinates."""
    has_texture = any(planned.material and planned.material.texture.strip() for planned in plan.objects)
    return tuple(stage for stage in plan.stages if has_texture or stage != "uv")


def _actors(plan: ScenePlan) -> tuple[str, ...]:
    return tuple(dict.fromkeys(phase.actor for phase in plan.motion.phases))
