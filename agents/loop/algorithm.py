"""The paper's algorithm: plan once, build stage by stage, render, review, mend once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.loop.rendering import fixed, render, reviewed
from agents.loop.run import START, plan_file
from agents.loop.stage import StageLoop
from agents.loop.task import Task
from agents.plan.part import STAGES
from agents.roles.planner import Planner, told

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from agents.loop.rendering import Rendering
    from agents.loop.run import Run
    from agents.plan.part import Stage
    from agents.plan.scene import RenderSettings, ScenePlan

# Without stages, one pass builds everything, and is judged as the last stage is.
ALL_AT_ONCE: tuple[Stage, ...] = ("light",)
_WITHOUT_STAGES = """\
This run has no stages. What is called the stage "light" here is everything at once: geometry, materials, what \
deforms, motion, camera and light, in one pass from an empty scene."""


def make(run: Run) -> Rendering:
    """From the prompt to a rendered scene (paper, Algorithm 1). Raises RunError, ModelError."""
    run.save("modeling", START, run.checkpoints)
    planner = Planner(run.desk)
    plan = planner.strategic(run.options.prompt)
    run.write("plan.json", plan_file(plan))
    run.journal.note("plan", plan=plan.model_dump(mode="json"))
    staged = run.options.stages
    task = Task(told(plan) if staged else f"{_WITHOUT_STAGES}\n\n{told(plan)}", plan, _actors(plan))
    run.task = task
    wanted = plan.stages if staged else ALL_AT_ONCE
    last = build(run, planner, task, wanted)
    return finish(run, task, plan.render, last)


def build(run: Run, planner: Planner, task: Task, wanted: Sequence[Stage]) -> str:
    """Closes the stages that are ``wanted``, in order; the name of the last that was. Raises Aborted, ModelError."""
    last = START
    for stage in STAGES[:-1]:
        if stage not in wanted:
            run.journal.note("stage.skipped", stage=stage)
            continue
        attempts = StageLoop(run, planner, task, stage, last).build()
        file = run.save(stage, stage, run.checkpoints)
        run.journal.note("stage.closed", stage=stage, attempts=attempts, file=f"checkpoints/{file.name}")
        last = stage
    return last


def finish(run: Run, task: Task, plan: RenderSettings | None, last: str) -> Rendering:
    """Renders, has it reviewed, and mends it once if need be; the scene is saved. Raises RunError, ModelError."""
    rendering = render(run, plan, 1)
    review = reviewed(run, task, rendering, 1)
    if review.verdict == "needs_fix" and fixed(run, task, review, last):
        rendering = render(run, plan, 2)
    run.save("render", "scene", run.root, verify=True)
    return rendering


def result_so_far(run: Run) -> Path | None:
    """The file of the last stage that was closed."""
    closed = [row["file"] for row in run.journal.rows if row["type"] == "stage.closed"]
    return run.root / closed[-1] if closed else None


def _actors(plan: ScenePlan) -> tuple[str, ...]:
    return tuple(dict.fromkeys(phase.actor for phase in plan.motion.phases))
