"""What the knowledge base has on a stage's topic, for the coder to begin with: it would ask for that first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.loop.running.run_tools import RUNNER

if TYPE_CHECKING:
    from agents.loop.running.run import Run
    from agents.loop.task import RunTask
    from agents.plan.part import Stage

_DOCS = "blender_docs"
_TOKENS = 600
_TOPICS: dict[Stage, str] = {
    "modeling": "modeling",
    "uv": "uv",
    "texture": "materials",
    "camera": "camera",
    "light": "lights",
}
# What a stage sets up or runs depends on the plan; what a solver does is in the coder's instructions.
_BY_ROLE: dict[Stage, dict[str, str]] = {
    "deformation_setup": {"rig": "armatures", "hair": "hair"},
    "motion": {"keyframed": "keyframes", "rig": "keyframes"},
}


def topic_of(stage: Stage, task: RunTask) -> str:
    """What to look up for a stage; "" for nothing."""
    if task.plan is None or stage not in _BY_ROLE:
        return _TOPICS.get(stage, "")
    roles = {planned.role for planned in task.plan.objects}
    return next((topic for role, topic in _BY_ROLE[stage].items() if role in roles), "")


def topic_page(run: Run, stage: Stage, task: RunTask) -> str:
    """The page of the stage's topic, in words; "" where there is none, or all is built at once."""
    topic = topic_of(stage, task) if run.options.stages else ""
    if not topic:
        return ""
    outcome = run.tools.use(RUNNER, stage, _DOCS, {"query": topic, "max_tokens": _TOKENS})
    if outcome.failed or outcome.data.get("kind") != "page":
        return ""
    return f'{_DOCS} on "{topic}":\n\n{outcome.text}'
