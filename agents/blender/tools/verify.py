"""``blender_verify``: checks the open scene against the rules."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import Field

from agents.blender.checks.verification import ScenePosition, verify_scene
from agents.blender.sheets.findings_sheet import draw_findings
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from agents.blender.tools.preview_files import new_preview
from agents.protocol.report.json_report import as_json
from agents.protocol.report.markdown import as_text
from agents.protocol.report.summary import VerificationScope
from agents.protocol.verify_request import plan_from, rules_named
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from agents.plan.scene import ScenePlan
    from agents.protocol.rule import Rule

_FAULTS = 20
_SECONDS = 60.0


class VerifyArguments(Arguments):
    """The arguments of ``blender_verify``."""

    plan: dict[str, Any] | None = Field(
        default=None,
        description="The scene plan, for the rules about it.",
    )
    rules: list[str] | None = Field(
        default=None,
        min_length=1,
        description="Families (C layout, G parents, V contact, W warnings, R plan, T motion) or rules, "
        "such as ['C', 'V1'].",
    )
    image: bool = Field(
        default=False,
        description="Also show where.",
    )


DESCRIPTION = """\
Measure what no image shows, by tags and plan: gaps where things should touch, meshes in each other, no support, \
wrong sizes, places, relations, motion that is faked, unbaked, late or never at rest, a wrong layout. A finding has \
rule, objects, measured value, tolerance, and what to change. Hard ones must be fixed; soft ones are advice. Bake \
first: the unbaked is stepped."""


def run(context: ToolContext, arguments: VerifyArguments, call: Call) -> Result:
    """Checks the open scene."""
    rules, plan = _rules(arguments.rules), _plan(arguments.plan)
    blender = context.blender
    with blender.alone():
        position = blender.call(
            "go_to_frame",
            {"frame": None},
            ScenePosition.model_validate,
            timeout=_SECONDS,
            cancelled=call.cancelled,
        ).value
        report = verify_scene(blender, rules, plan, call)
        checked = VerificationScope(
            rules,
            scene=position.scene,
            frame=position.frame,
            blender=blender.launch.runtime.version,
            plan=plan.title if plan else "",
        )
        text, data = as_text(report, checked), as_json(report, checked)
        if not arguments.image:
            return Result(text, data)
        try:
            png = draw_findings(blender, report, call, checked.title)
        except Refusal as error:
            return Result(f"{text}\n\nNo image could be made: {error}", data)
    image = new_preview(blender.folder, "findings", png)
    text += f"\n\nThe image is saved as {image.path.relative_to(blender.folder.root)}."
    return Result(text, data, (image,))


def _rules(wanted: list[str] | None) -> tuple[Rule, ...]:
    try:
        return rules_named(wanted)
    except ValueError as error:
        raise Refusal(str(error)) from error


def _plan(data: dict[str, Any] | None) -> ScenePlan | None:
    """Raises Refusal, which lists the plan's faults."""
    if data is None:
        return None
    plan, faults = plan_from(data)
    if plan is None:
        lines = [f"- {fault}" for fault in faults[:_FAULTS]]
        lines += [f"- … and {len(faults) - _FAULTS} more"] if len(faults) > _FAULTS else []
        raise Refusal("\n".join(["The plan cannot be used:", *lines]))
    return plan


TOOL = BlenderTool(
    "blender_verify",
    "Verify the scene",
    DESCRIPTION,
    VerifyArguments,
    run,
    read_only=True,
    profile="look",
)
