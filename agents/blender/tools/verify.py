"""``blender_verify``: the open scene, judged by the rules."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import Field

from agents.blender.sheets.findings_sheet import draw_findings
from agents.blender.tools.base import Arguments, Call, Picture, Result, Session, Tool
from agents.blender.verification import verify_scene
from agents.protocol.report.json_report import as_json
from agents.protocol.report.markdown import as_text
from agents.protocol.report.summary import VerificationScope
from agents.protocol.verify_request import plan_from, rules_named
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from pathlib import Path

    from agents.blender.run_folder import RunFolder
    from agents.plan.scene import ScenePlan
    from agents.protocol.rule import Rule

_FAULTS = 20
_SECONDS = 60.0


class Verify(Arguments):
    """The arguments of ``blender_verify``."""

    plan: dict[str, Any] | None = Field(
        default=None,
        description="The scene plan (JSON) that the scene is built to. Without one, the rules that compare with a "
        "plan are passed over.",
    )
    rules: list[str] | None = Field(
        default=None,
        min_length=1,
        description="Families (C layout, G parents, V contact and penetration, W warnings, R against the plan, T "
        "motion) or rules, as ['C', 'V1']. Default: all.",
    )
    image: bool = Field(
        default=False,
        description="Also a picture: views of the scene with what is at fault coloured, gaps and penetrations marked "
        "with their size.",
    )


DESCRIPTION = """\
Measure what no picture shows: whether the scene holds what its tags and its plan say. Gaps between what is to touch, \
meshes in each other, objects that stand on nothing, wrong sizes, places, relations and arrangements, motions that are \
faked, unbaked, late, or never come to rest; the layout of the collections. Each finding names the rule, the objects, \
what was measured, the tolerance, and what to change. Hard findings are to be mended; soft ones are advice. What could \
not be decided is told as such. The scene stays as it is; frames of unbaked simulations are stepped through, so bake \
first. Call it after every change that may have broken something."""


def run(session: Session, asked: Verify, call: Call) -> Result:
    """Judges the open scene."""
    rules, plan = _rules(asked.rules), _plan(asked.plan)
    blender = session.blender
    with blender.alone():
        stands = blender.call("stand_at", {"frame": None}, timeout=_SECONDS, given_up=call.given_up).value
        report = verify_scene(blender, rules, plan, call)
        checked = VerificationScope(
            rules,
            scene=str(stands["scene"]),
            frame=int(stands["frame"]),
            blender=blender.launch.runtime.version,
            plan=plan.title if plan else "",
        )
        text, data = as_text(report, checked), as_json(report, checked)
        if not asked.image:
            return Result(text, data)
        try:
            png = draw_findings(blender, report, call, checked.title)
        except Refusal as error:
            return Result(f"{text}\n\nThere is no picture: {error}", data)
    path = _place(blender.folder)
    path.write_bytes(png)
    told = f"{text}\n\nThe picture is saved as {path.relative_to(blender.folder.root)}."
    return Result(told, data, (Picture(png, path),))


def _rules(wanted: list[str] | None) -> tuple[Rule, ...]:
    try:
        return rules_named(wanted)
    except ValueError as error:
        raise Refusal(str(error)) from error


def _plan(given: dict[str, Any] | None) -> ScenePlan | None:
    """Raises Refusal, with what contradicts itself in it."""
    if given is None:
        return None
    plan, faults = plan_from(given)
    if plan is None:
        told = [f"- {fault}" for fault in faults[:_FAULTS]]
        told += [f"- … and {len(faults) - _FAULTS} more"] if len(faults) > _FAULTS else []
        raise Refusal("\n".join(["The plan cannot be used:", *told]))
    return plan


def _place(folder: RunFolder) -> Path:
    """A fresh path below ``previews``."""
    previews = folder.root / "previews"
    previews.mkdir(exist_ok=True)
    number = 1 + max((int(path.name[:4]) for path in previews.glob("[0-9][0-9][0-9][0-9]-*.png")), default=0)
    return previews / f"{number:04d}-findings.png"


TOOL = Tool("blender_verify", "Verify the scene", DESCRIPTION, Verify, run, read_only=True)
