"""The coder: a fresh session for each stage, kept across its retries, with all tools."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.roles.base import Conversation, WorkResult, plan_json
from agents.roles.prompts import system_prompt

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.plan.part import Stage
    from agents.plan.tactical import TacticalPlan
    from agents.roles.base import RoleContext
    from agents.roles.sheets import Solver
    from simworlds.llm.messages import Block

NAME = "coder"

# The stages in which a tool is told of; what is not listed, in all. Called in another stage, a tool works all the same.
# The loop saves and loads by itself, brings no files in, and blender_group sets an object's tags too.
_TOLD_IN: dict[str, tuple[Stage, ...]] = {
    "blender_single_mesh_preview": ("modeling", "uv"),
    "blender_system_layout_preview": ("modeling", "camera", "light"),
    "blender_group": ("modeling", "deformation_setup", "motion", "render"),
    "blender_uv_preview": ("uv",),
    "blender_material_preview": ("texture", "camera", "light"),
    "blender_trial": ("deformation_setup", "motion"),
    "blender_bake": ("deformation_setup", "motion", "camera", "light", "render"),
    "blender_motion_sheet_preview": ("deformation_setup", "motion", "camera", "render"),
    "blender_object_preview": ("modeling", "uv", "texture", "deformation_setup", "render"),
    "blender_render": ("texture", "camera", "light", "render"),
    "blender_save": (),
    "blender_assets": ("modeling", "texture", "light"),
    "blender_load": (),
    "blender_import": (),
    "blender_export": (),
    "blender_tag_object": (),
}
# What a run without stages is not told of: other tools show the same.
_BY_OTHERS = (
    "blender_single_mesh_preview", "blender_object_preview", "blender_system_layout_preview", "blender_uv_preview",
    "blender_material_preview",
)  # fmt: skip
_SHOWING = ("blender_uv_preview", "blender_material_preview")  # what their stages make


def is_needed(tool: str, stage: Stage, *, staged: bool = True) -> bool:
    """Whether a coder is told of a tool in a stage; not ``staged``: when everything is built at once."""
    told = _TOLD_IN.get(tool)
    if not staged:
        return told != () and tool not in _BY_OTHERS
    return told is None or stage in told


def is_seen(tool: str, stage: Stage, *, staged: bool = True) -> bool:
    """Whether a stage has what a tool shows: UV maps and materials are looked at where they are made or filmed."""
    return tool not in _SHOWING or not staged or is_needed(tool, stage)


BEGIN = """\
{plan}

The stage is {stage}. Its tactical plan:
{tactic}

How the scene stands:

{state}

Build this stage."""
_AGAIN = """\
The stage is not done. The planner says: {instructions}

The verifier:
{verified}

The reviewer:
{reviewed}

Mend this in the scene as it is, and end with a short report."""
_REPLANNED = """\
The scene was put back to how it was before this stage; nothing of what you built in it is there any more. The planner \
has made a new tactical plan:
{tactic}

How the scene stands:

{state}

Build the stage by this plan, and end with a short report."""
_FIX = """\
{plan}

The scene is built and rendered. The final reviewer wants this mended:
{instructions}

How the scene stands:

{state}

Mend just that; what moves must be baked again. End with a short report."""


class Coder:
    """One stage's coder. Everything raises ModelError."""

    def __init__(  # noqa: PLR0913 - all that a coder is told
        self,
        context: RoleContext,
        stage: Stage,
        plan: str,
        *,
        edit: bool = False,
        shown: Sequence[Block | str] = (),
        solvers: Sequence[Solver] = (),
    ) -> None:
        """``plan`` is what the whole run is held to, in words; ``shown`` are pictures to begin with; ``solvers`` are
        those that the plan needs.
        """
        self._stage = stage
        self._plan = plan
        prompt = system_prompt(
            NAME, stage, edit=edit, verifier=context.verifier, staged=context.staged, solvers=solvers
        )
        self._talk = Conversation(context, NAME, prompt, context.tools(NAME, stage))
        self._tactic = ""
        self._shown = shown

    def begin(self, tactic: TacticalPlan, state: str) -> WorkResult:
        """The first attempt."""
        self._tactic = plan_json(tactic)
        words = BEGIN.format(plan=self._plan, stage=self._stage, tactic=self._tactic, state=state)
        return self._work(words, shown=self._shown)

    def again(self, instructions: str, verified: str, reviewed: str) -> WorkResult:
        """A retry, in the scene as it stands."""
        words = _AGAIN.format(instructions=instructions, verified=verified, reviewed=reviewed)
        return self._work(words, open_findings=[verified])

    def replanned(self, tactic: TacticalPlan, state: str) -> WorkResult:
        """An attempt by a new plan, in the scene as it was before the stage."""
        self._tactic = plan_json(tactic)
        return self._work(_REPLANNED.format(tactic=self._tactic, state=state))

    def fix(self, instructions: str, state: str) -> WorkResult:
        """What the final reviewer wants mended."""
        return self._work(_FIX.format(plan=self._plan, instructions=instructions, state=state))

    def _work(
        self, words: str, *, shown: Sequence[Block | str] = (), open_findings: Sequence[str] = ()
    ) -> WorkResult:
        pinned: Sequence[str] = (self._plan, *filter(None, [self._tactic]), *open_findings)
        return self._talk.work(self._stage, words, *shown, pinned=pinned)
