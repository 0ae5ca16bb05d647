"""Edit mode: the same loop on an existing scene; what the request does not name stays (paper, "Edit Mode")."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from agents.loop.algorithm import ALL_AT_ONCE, build, finish
from agents.loop.asset_library import prompt_with_assets
from agents.loop.edit.baseline import format_known
from agents.loop.edit.declared_mechanisms import undeclared
from agents.loop.edit.inputs import picture
from agents.loop.edit.untouched import blocks, compared, unplanned
from agents.loop.errors import Unusable
from agents.loop.record.events import PlanMade, ReferenceKept
from agents.loop.review.evidence import moves, still, still_samples, still_width
from agents.loop.review.verdicts import verify
from agents.loop.running.position import START
from agents.loop.running.run_tools import RENDER, RUNNER
from agents.loop.task import RunTask
from agents.plan.edit import mentioned_in
from agents.roles.planner import Planner, format_edit_plan
from simworlds.llm.messages import Picture

if TYPE_CHECKING:
    from agents.loop.edit.untouched import Blocks
    from agents.loop.film.rendering import RenderResult
    from agents.loop.running.run import Run
    from agents.plan.edit import EditPlan
    from agents.plan.part import Stage
    from agents.plan.scene import RenderSettings
    from agents.protocol.findings import Finding

_FIRST: Stage = "modeling"


def edit(run: Run) -> RenderResult:
    """From a .blend and an instruction to the edited scene, rendered. Raises Unusable, RunError, ModelError."""
    options = run.options
    reference = _reference(run)
    before = _opened(run)
    state = run.state(_FIRST)
    seen = run.tools.use(RUNNER, _FIRST, "blender_scene_layout_preview", {})
    planner = Planner(run.context, edit=True)
    plan = planner.edit(prompt_with_assets(run), state, before.names, seen.pictures, reference)
    run.files.write_plan(plan)
    run.journal.note(PlanMade(edit=plan))
    run.task = task = replace(_task(run, plan, before), goal=reference, **_still_before(run, plan.render))
    wanted = plan.stages if options.stages else ALL_AT_ONCE
    last = build(run, planner, task, wanted)
    rendering = finish(run, planner, task, plan.render, last)
    run.journal.note(compared(before, blocks(run, "render"), plan))
    return rendering


def _opened(run: Run) -> Blocks:
    """Opens the file to edit, and saves a copy of it as the start of the run."""
    file = run.options.file
    assert file is not None
    opened = run.tools.use(RUNNER, _FIRST, "blender_load", {"path": str(file)})
    if opened.failed:
        raise Unusable(f"{file} cannot be edited: {opened.text}")
    run.save(_FIRST, START)
    return blocks(run, _FIRST)


def _still_before(run: Run, render: RenderSettings) -> dict[str, Any]:
    """A still of the file as it is, and its frame; nothing if it cannot be rendered, for want of a camera say."""
    samples = still_samples(run, render)
    outcome = run.tools.use(RUNNER, _FIRST, RENDER, still("before", None, still_width(render), samples))
    if outcome.failed or not outcome.pictures:
        return {}
    data = outcome.data
    return {
        "before": outcome.pictures[0],
        "before_frame": data["frame"],
        "before_width": data["width"],
        "before_samples": samples,
    }


def _reference(run: Run) -> Picture | None:
    """What the result should look like. It is kept with the run: its file may be gone when the run is taken up."""
    if run.options.reference is None:
        return None
    kept = run.journal.find(ReferenceKept())
    if kept is None:
        given = picture(run.options.reference)
        kept = ReferenceKept(path=run.files.keep(given), media_type=given.media_type)
        run.journal.note(kept)
    return Picture((run.files.root / kept.path).read_bytes(), kept.media_type)


def _task(run: Run, plan: EditPlan, before: Blocks) -> RunTask:
    """What the edit is held to: its plan, and not to leave the file worse than it was."""
    actors = tuple(actor.name for actor in plan.actors)
    bare = RunTask("", None, actors, edit=True, tagged=before.tagged)
    known = verify(run, "light", bare).findings
    return replace(
        bare,
        plan_text=format_edit_plan(plan, run.options.prompt, format_known(known)),
        known=known,
        declared=plan.actors,
        targets=tuple(dict.fromkeys(name for task in plan.tasks for name in task.targets)),
        mentioned=tuple(mentioned_in(plan, before.objects)),
        old=before.objects,
        off_plan=partial(_off_plan, run, before, plan),
    )


def _off_plan(run: Run, before: Blocks, plan: EditPlan, stage: Stage) -> list[Finding]:
    """What has changed without being asked for, and what moves without its mechanism's tags. Raises RunError."""
    untagged = undeclared(run, stage, plan.actors) if plan.actors and moves(stage) else []
    return [*unplanned(run, before, plan, stage), *untagged]
