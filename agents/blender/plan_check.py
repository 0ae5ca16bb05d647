"""``blender_plan_check``: a scene plan, judged for itself before anything is built."""

from __future__ import annotations

from collections import Counter
from functools import cache
from typing import TYPE_CHECKING, Any

import mcp_types as types

from agents.plan.part import STAGES
from agents.plan.scene import ScenePlan
from agents.protocol.report.text_format import fold_names, format_rule_ids
from agents.protocol.rules.catalogue import RULES
from agents.protocol.rules_by_stage import first_stage, rules_of
from agents.protocol.verify_request import plan_from
from simworlds.schema_notation import lean_schema_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agents.plan.faults import Fault

NAME = "blender_plan_check"
_TITLE = "Check a scene plan"
DESCRIPTION = """\
Check a scene plan before anything is built: fields and their values, names that nobody has, relations that contradict \
each other or close a circle, things that nothing holds up, contents that do not fit into their container, phases out \
of the timeline or before their cause, tolerances. Answers with each fault as its path and a sentence, or, for a sound \
plan, with what is in it and which rules of blender_verify judge it from which stage on. It does not touch Blender and \
does not know the geometry: whether things overlap is measured once they are built."""
_FAULTS = 20
_LISTED = 12


@cache
def entry() -> types.Tool:
    """The tool's entry in the list of tools."""
    return types.Tool(
        name=NAME,
        title=_TITLE,
        description=DESCRIPTION,
        input_schema={
            "type": "object",
            "title": NAME,
            "properties": {"plan": {**lean_schema_of(ScenePlan), "description": "The scene plan."}},
            "required": ["plan"],
        },
        annotations=types.ToolAnnotations(
            title=_TITLE,
            read_only_hint=True,
            destructive_hint=False,
            idempotent_hint=True,
            open_world_hint=False,
        ),
    )


def answer(arguments: Mapping[str, Any]) -> types.CallToolResult:
    """What the tool answers: text for the model, and the same as data."""
    given = arguments.get("plan")
    if isinstance(given, str):  # models at times write JSON into a string
        given = given.encode(errors="replace")
    if not isinstance(given, (bytes, dict)) or set(arguments) != {"plan"}:
        return _result('Give the plan, and nothing else: {"plan": {…}}.', failed=True)
    plan, faults = plan_from(given)
    if plan is None:
        return _result(_told(faults), {"sound": False, "faults": [_as_json(one) for one in faults]})
    return _result(summary(plan), {"sound": True, "faults": [], "stages": list(plan.stages)})


def _result(text: str, data: dict[str, Any] | None = None, *, failed: bool = False) -> types.CallToolResult:
    return types.CallToolResult(
        content=[types.TextContent(text=text.encode(errors="replace").decode())],
        structured_content=data,
        is_error=failed,
    )


def _as_json(fault: Fault) -> dict[str, str]:
    return {"path": fault.path, "message": fault.message}


def _told(faults: list[Fault]) -> str:
    count = len(faults)
    lines = [f"- `{fault.path or 'the whole'}`: {fault.message}" for fault in faults[:_FAULTS]]
    lines += [f"- … and {count - _FAULTS} more"] if count > _FAULTS else []
    return "\n".join([f"The plan has {count} fault{'s' if count != 1 else ''}:", *lines])


def summary(plan: ScenePlan) -> str:
    """What a sound plan says, for whoever is to build it."""
    roles: dict[str, list[str]] = {}
    for one in plan.objects:
        roles.setdefault(one.role, []).append(one.name)
    objects = "; ".join(f"{role}: {fold_names(names, _LISTED)}" for role, names in roles.items())
    return "\n".join(
        [
            f"The plan {plan.title!r} contradicts itself nowhere.",
            f"- Objects ({len(plan.objects)}): {objects}.",
            f"- Relations ({len(plan.relations)}): {_counted(one.kind for one in plan.relations)}.",
            f"- {_motion(plan)}",
            f"- Stages: {', '.join(plan.stages)}.",
            *_rules(plan),
        ]
    )


def _counted(kinds: Any) -> str:
    return ", ".join(f"{kind} {count}" for kind, count in Counter(kinds).most_common()) or "none"


def _motion(plan: ScenePlan) -> str:
    frames = plan.frame_end - plan.frame_start + 1
    phases = plan.motion.phases
    if not phases:
        return "Phases: none; the scene is still."
    actors = fold_names((phase.actor for phase in phases), _LISTED)
    return (
        f"Phases ({len(phases)}) of {actors}, in frames {plan.frame_start}–{plan.frame_end} "
        f"({frames / plan.fps:.3g} s at {plan.fps} fps)."
    )


def _rules(plan: ScenePlan) -> list[str]:
    """From which of the plan's stages on which rules judge."""
    order = [rule.id for rule in RULES]
    since: dict[str, list[str]] = {}
    for rule in rules_of(STAGES[-1]):
        first = next(stage for stage in plan.stages if STAGES.index(stage) >= STAGES.index(first_stage(rule)))
        since.setdefault(first, []).append(rule.id)
    told = [(stage, format_rule_ids(since[stage], order)) for stage in plan.stages if stage in since]
    return [f"- Judged from {stage} on by {ids}." for stage, ids in told]
