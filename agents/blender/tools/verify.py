"""``blender_verify``: checks the open scene against the rules."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import Field

from agents.blender.sheets.findings_sheet import draw_findings
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from agents.blender.tools.preview_files import new_preview
from agents.blender.verification import ScenePosition, verify_scene
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
        description="The scene plan (JSON) that the scene is built to. Without one, rules that compare with a plan "
        "are skipped.",
    )
    rules: list[str] | None = Field(
        default=None,
        min_length=1,
        description="Families (C layout, G parents, V contact and penetration, W warnings, R against the plan, T "
        "motion) or rules, such as ['C', 'V1']. Default: all.",
    )
    image: bool = Field(
        default=False,
        description="Also return an image: views of the scene with faulty objects coloured, and gaps and "
        "penetrations marked with their size.",
    )


DESCRIPTION = """\
Measure what no image shows: whether the scene is what its tags and its plan say. It finds gaps between objects that \
should touch, meshes that intersect, objects without support, wrong sizes, positions, relations and arrangements, \
motion that is faked, unbaked, late, or never comes to rest, and a wrong layout of collections. Each finding names the \
rule, the objects, the measured value, the tolerance, and what to change. Hard findings must be fixed; soft ones are \
advice. What could not be decided is listed too. The scene is not changed; frames of unbaked simulations are stepped \
through, so bake first. Call it after every change that may have broken something."""


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


TOOL = BlenderTool("blender_verify", "Verify the scene", DESCRIPTION, VerifyArguments, run, read_only=True)
