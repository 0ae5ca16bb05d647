"""``blender_plan_check``: checks a scene plan before anything is built."""

from __future__ import annotations

from collections import Counter
from functools import cache
from typing import TYPE_CHECKING, Any

import mcp_types as types

from agents.plan.arithmetic import DOUBTED, doubts_of
from agents.plan.faults import grouped
from agents.plan.part import STAGES
from agents.plan.scene import ScenePlan
from agents.protocol.report.text_format import fold_names, format_rule_ids
from agents.protocol.rules.catalogue import RULES
from agents.protocol.rules_by_stage import first_stage, rules_of
from agents.protocol.verify_request import plan_from
from simworlds.schemas.json_schema import lean_schema_of
from simworlds.schemas.notation import HOW_TO_READ, shape_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agents.plan.faults import Fault

NAME = "blender_plan_check"
SCHEMA = types.Resource(
    uri="blender://plan/schema",
    name="plan",
    title="Schema of a scene plan",
    description="The JSON Schema of what blender_plan_check and blender_verify take as `plan`.",
    mime_type="application/json",
)
_TITLE = "Check a scene plan"
DESCRIPTION = """\
Check a scene plan before anything is built. The reply lists each fault with its path, or what is in the plan and \
from which stage on each rule of blender_verify applies; and doubts: relations, falls and views that cannot hold by \
sizes, positions and frames. Called without a plan, it returns the shape of one."""
_LISTED_FAULTS = 20
_LISTED = 12


@cache
def schema() -> dict[str, Any]:
    """The JSON Schema of a plan."""
    return lean_schema_of(ScenePlan)


@cache
def entry() -> types.Tool:
    """The tool's entry in the list of tools. The plan's schema, many times as long, is had by a call or a resource."""
    return types.Tool(
        name=NAME,
        title=_TITLE,
        description=DESCRIPTION,
        input_schema={
            "type": "object",
            "title": NAME,
            "properties": {"plan": {"type": "object", "description": "The scene plan."}},
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
    """The tool's reply: text for the model, and the same as data."""
    if not arguments:
        return _result(
            f"A scene plan is JSON of this shape. {HOW_TO_READ}\n\n```\n{shape_of(ScenePlan)}\n```"
        )
    data = arguments.get("plan")
    if isinstance(data, str):  # models sometimes write JSON into a string
        data = data.encode(errors="replace")
    if not isinstance(data, (bytes, dict)) or set(arguments) != {"plan"}:
        return _result('Give only the plan: {"plan": {…}}.', failed=True)
    plan, faults = plan_from(data)
    if plan is None:
        return _result(_fault_text(faults), {"sound": False, "faults": [_as_json(fault) for fault in faults]})
    doubts = doubts_of(plan)
    data = {"sound": True, "faults": [], "stages": list(plan.stages), "doubts": list(map(_as_json, doubts))}
    return _result(summary(plan) + _doubt_text(doubts), data)


def _result(text: str, data: dict[str, Any] | None = None, *, failed: bool = False) -> types.CallToolResult:
    return types.CallToolResult(
        content=[types.TextContent(text=text.encode(errors="replace").decode())],
        structured_content=data,
        is_error=failed,
    )


def _as_json(fault: Fault) -> dict[str, str]:
    return {"path": fault.path, "message": fault.message}


def _fault_text(faults: list[Fault]) -> str:
    faults = grouped(faults)
    count = len(faults)
    lines = [f"- `{fault.path or 'plan'}`: {fault.message}" for fault in faults[:_LISTED_FAULTS]]
    lines += [f"- … and {count - _LISTED_FAULTS} more"] if count > _LISTED_FAULTS else []
    return "\n".join([f"The plan has {count} fault{'s' if count != 1 else ''}:", *lines])


def _doubt_text(doubts: list[Fault]) -> str:
    if not doubts:
        return ""
    lines = [f"- `{doubt.path}`: {doubt.message}" for doubt in doubts[:_LISTED_FAULTS]]
    left = len(doubts) - _LISTED_FAULTS
    lines += [f"- … and {left} more"] if left > 0 else []
    return "\n".join(["", "", f"Doubts ({len(doubts)}):", *lines, DOUBTED])


def summary(plan: ScenePlan) -> str:
    """A summary of a valid plan, for whoever builds it."""
    roles: dict[str, list[str]] = {}
    for obj in plan.objects:
        roles.setdefault(obj.role, []).append(obj.name)
    objects = "; ".join(f"{role}: {fold_names(names, _LISTED)}" for role, names in roles.items())
    return "\n".join(
        [
            f"The plan {plan.title!r} is valid.",
            f"- Objects ({len(plan.objects)}): {objects}.",
            f"- Relations ({len(plan.relations)}): {_counted(relation.kind for relation in plan.relations)}.",
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
        return "Phases: none; nothing moves."
    actors = fold_names((phase.actor for phase in phases), _LISTED)
    return (
        f"Phases ({len(phases)}) of {actors}, in frames {plan.frame_start}–{plan.frame_end} "
        f"({frames / plan.fps:.3g} s at {plan.fps} fps)."
    )


def _rules(plan: ScenePlan) -> list[str]:
    """The rules that apply from each of the plan's stages on."""
    order = [rule.id for rule in RULES]
    since: dict[str, list[str]] = {}
    for rule in rules_of(STAGES[-1]):
        first = next(stage for stage in plan.stages if STAGES.index(stage) >= STAGES.index(first_stage(rule)))
        since.setdefault(first, []).append(rule.id)
    return [
        f"- Checked from {stage} on: {format_rule_ids(since[stage], order)}."
        for stage in plan.stages
        if stage in since
    ]
