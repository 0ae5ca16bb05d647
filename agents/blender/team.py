"""The team over MCP: its roles and stages as prompts, and the plan's check as a tool.

With these, a model that has the Blender tools can be planner, coder and reviewer by itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import mcp_types as types
from mcp.shared.exceptions import MCPError

from agents.blender import plan_check
from agents.plan.part import STAGES
from agents.roles.prompts import protocol_text, role_text, shapes_text, stage_text, team_text

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from agents.plan.part import Stage

_LONGEST = 20_000  # characters of an argument
_STAGES = ", ".join(STAGES)


@dataclass(frozen=True, slots=True)
class Prompt:
    """A prompt that clients offer to their users; ``write`` makes it from the arguments."""

    name: str
    title: str
    description: str
    arguments: tuple[types.PromptArgument, ...]
    write: Callable[..., str]

    @property
    def entry(self) -> types.Prompt:
        """Its entry in the list of prompts."""
        return types.Prompt(
            name=self.name, title=self.title, description=self.description, arguments=list(self.arguments)
        )


def _argument(name: str, description: str, *, required: bool = True) -> types.PromptArgument:
    return types.PromptArgument(name=name, description=description, required=required)


def _joined(*parts: str) -> str:
    return "\n\n".join(parts)


def _everything(*, edit: bool) -> str:
    """What the whole team knows, from the loop to the stages."""
    return _joined(
        team_text(edit=edit),
        *(role_text(role, edit=edit) for role in ("planner", "coder", "reviewer", "final_reviewer")),
        protocol_text(),
        shapes_text("planner", edit=edit),
        *(stage_text(stage, edit=edit) for stage in STAGES),
    )


def _make_scene(prompt: str) -> str:
    return _joined(_everything(edit=False), f"# The request\n\n{prompt}")


def _edit_scene(instruction: str, file: str = "") -> str:
    where = f"The file: {file}" if file else "The file is the scene that is open; if it is empty, ask which."
    return _joined(_everything(edit=True), f"# The instruction\n\n{instruction}\n\n{where}")


def _plan(prompt: str) -> str:
    return _joined(
        role_text("planner"),
        protocol_text(),
        shapes_text("planner"),
        f"# The request\n\nWrite the scene plan for this, check it with `{plan_check.NAME}`, mend it until it is "
        f"sound, and show it. Build nothing yet.\n\n{prompt}",
    )


def _stage(stage: Stage) -> str:
    return _joined(
        role_text("coder"),
        protocol_text(),
        shapes_text("coder"),
        stage_text(stage),
        f"# The request\n\nBuild the stage {stage} of our scene plan in the open scene. Plan it in a few lines "
        "first: what is to be done, and how it is known to be done.",
    )


def _review(stage: Stage) -> str:
    return _joined(
        role_text("reviewer"),
        protocol_text(),
        shapes_text("reviewer"),
        stage_text(stage),
        f"# The request\n\nReview the stage {stage} in the open scene. Where no tactical plan is at hand, ask "
        "yourself what its questions would be. Call blender_verify too, and tell its hard findings beside your review.",
    )


_PROMPT = _argument("prompt", "What the scene is to show, and what is to happen in it.")
_STAGE = _argument("stage", f"One of: {_STAGES}.")

PROMPTS: tuple[Prompt, ...] = (
    Prompt(
        "make_scene",
        "Make a scene",
        "From a sentence to a simulated, editable .blend: plans, builds stage by stage, verifies, reviews, renders.",
        (_PROMPT,),
        _make_scene,
    ),
    Prompt(
        "edit_scene",
        "Edit a scene",
        "Changes what the instruction names in a .blend, by the same stages and checks, and leaves the rest alone.",
        (
            _argument("instruction", "What is to be different."),
            _argument("file", "The .blend to open. Default: the scene that is open.", required=False),
        ),
        _edit_scene,
    ),
    Prompt("plan", "Plan a scene", "Writes a scene plan and checks it; builds nothing.", (_PROMPT,), _plan),
    Prompt(
        "stage", "Build a stage", "Builds one stage of a scene plan in the open scene.", (_STAGE,), _stage
    ),
    Prompt(
        "review", "Review a stage", "Looks at the open scene and judges one stage of it.", (_STAGE,), _review
    ),
)
_BY_NAME = {prompt.name: prompt for prompt in PROMPTS}


class Team:
    """What a server offers beside Blender's own tools."""

    names = (plan_check.NAME,)

    def tools(self) -> list[types.Tool]:
        """The entries of its tools."""
        return [plan_check.entry()]

    def prompts(self) -> list[types.Prompt]:
        """The entries of its prompts."""
        return [prompt.entry for prompt in PROMPTS]

    def use(self, name: str, arguments: Mapping[str, Any]) -> types.CallToolResult | None:
        """What the tool of that name answers; None where there is no such tool here."""
        return plan_check.answer(arguments) if name == plan_check.NAME else None

    def prompt(self, name: str, arguments: Mapping[str, str]) -> types.GetPromptResult:
        """The text of a prompt. Raises MCPError, naming what there is."""
        prompt = _BY_NAME.get(name)
        if prompt is None:
            raise _refused(f"There is no prompt {name[:80]!r}; there are {', '.join(_BY_NAME)}.")
        text = prompt.write(**_checked(prompt, arguments))
        return types.GetPromptResult(
            description=prompt.description,
            messages=[types.PromptMessage(role="user", content=types.TextContent(text=text))],
        )

    def completions(self, argument: str, begun: str) -> list[str]:
        """Values of an argument that begin so."""
        return [stage for stage in STAGES if stage.startswith(begun)] if argument == _STAGE.name else []


def _checked(prompt: Prompt, given: Mapping[str, str]) -> dict[str, str]:
    """The arguments of a prompt, those that say nothing left out. Raises MCPError."""
    known = {one.name: bool(one.required) for one in prompt.arguments}
    found = {name: text.strip() for name, text in given.items() if text.strip()}
    if strange := [name for name in found if name not in known]:
        raise _refused(f"{prompt.name} has no argument {strange[0][:80]!r}; it has {', '.join(known)}.")
    if missing := [name for name, required in known.items() if required and name not in found]:
        raise _refused(f"{prompt.name} needs the argument {missing[0]!r}.")
    if long := [name for name, text in found.items() if len(text) > _LONGEST]:
        raise _refused(f"{long[0]!r} has {len(found[long[0]])} characters; {_LONGEST} are the most.")
    stage = found.get(_STAGE.name)
    if stage is not None and stage not in STAGES:
        raise _refused(f"There is no stage {stage[:80]!r}; there are {_STAGES}.")
    return found


def _refused(message: str) -> MCPError:
    return MCPError(types.INVALID_PARAMS, message)
