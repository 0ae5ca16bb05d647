"""The team over MCP: roles and stages as prompts, and the plan check as a tool.

With these, a single model with the Blender tools can be planner, coder and reviewer.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import mcp_types as types
from mcp.shared.exceptions import MCPError

from agents.blender.checks import plan_check
from agents.plan.part import STAGES
from agents.roles.names import ROLES
from agents.roles.prompts import (
    protocol_text,
    role_text,
    rules_text,
    shapes_text,
    stage_text,
    system_prompt,
    team_text,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from agents.plan.part import Stage

_LONGEST = 20_000  # characters of an argument
_STAGES = ", ".join(STAGES)


@dataclass(frozen=True, slots=True)
class Prompt:
    """A prompt that clients offer to their users; ``write`` makes its text from the arguments."""

    name: str
    title: str
    description: str
    arguments: tuple[types.PromptArgument, ...]
    write: Callable[..., str]

    @property
    def entry(self) -> types.Prompt:
        """The prompt's entry in the list of prompts."""
        return types.Prompt(
            name=self.name, title=self.title, description=self.description, arguments=list(self.arguments)
        )


def _argument(name: str, description: str, *, required: bool = True) -> types.PromptArgument:
    return types.PromptArgument(name=name, description=description, required=required)


def _joined(*parts: str) -> str:
    return "\n\n".join(parts)


def _everything(*, edit: bool) -> str:
    """Everything the team knows: the loop, the roles, the protocol, the stages."""
    return _joined(
        team_text(edit=edit),
        *(role_text(role, edit=edit) for role in ROLES),
        protocol_text(edit=edit),
        rules_text(edit=edit),
        shapes_text("planner", edit=edit),
        *(stage_text(stage, edit=edit) for stage in STAGES),
    )


def _make_scene(prompt: str) -> str:
    return _joined(_everything(edit=False), f"# The request\n\n{prompt}")


def _edit_scene(instruction: str, file: str = "") -> str:
    where = f"The file: {file}" if file else "The file is the open scene; if that is empty, ask which file."
    return _joined(_everything(edit=True), f"# The instruction\n\n{instruction}\n\n{where}")


def _plan(prompt: str) -> str:
    return _joined(
        *system_prompt("planner"),
        f"# The request\n\nWrite the scene plan for this, check it with `{plan_check.NAME}`, fix it until it is "
        f"valid, and show it. Build nothing yet.\n\n{prompt}",
    )


def _stage(stage: Stage) -> str:
    return _joined(
        *system_prompt("coder", stage),
        f"# The request\n\nBuild the stage {stage} of our scene plan in the open scene. First plan it in a few "
        "lines: what to do, and how to tell that it is done.",
    )


def _review(stage: Stage) -> str:
    return _joined(
        *system_prompt("reviewer", stage),
        f"# The request\n\nReview the stage {stage} in the open scene. Without a tactical plan, work out what its "
        "questions would be. Also call blender_verify, and add its hard findings to your review.",
    )


_PROMPT = _argument("prompt", "What the scene shows, and what happens in it.")
_STAGE = _argument("stage", f"One of: {_STAGES}.")

PROMPTS: tuple[Prompt, ...] = (
    Prompt(
        "make_scene",
        "Make a scene",
        "Turns a sentence into a simulated, editable .blend: plans, builds by stages, verifies, reviews, renders.",
        (_PROMPT,),
        _make_scene,
    ),
    Prompt(
        "edit_scene",
        "Edit a scene",
        "Changes only what the instruction names in a .blend, with the same stages and checks.",
        (
            _argument("instruction", "What to change."),
            _argument("file", "The .blend to open. Default: the scene that is open.", required=False),
        ),
        _edit_scene,
    ),
    Prompt("plan", "Plan a scene", "Writes a scene plan and checks it; builds nothing.", (_PROMPT,), _plan),
    Prompt(
        "stage", "Build a stage", "Builds one stage of a scene plan in the open scene.", (_STAGE,), _stage
    ),
    Prompt("review", "Review a stage", "Reviews one stage of the open scene.", (_STAGE,), _review),
)
_BY_NAME = {prompt.name: prompt for prompt in PROMPTS}
_TOOLS = {plan_check.NAME: plan_check.answer}


class Team:
    """What a server offers besides Blender's tools: the plan check and the prompts."""

    names = tuple(_TOOLS)

    def tools(self) -> list[types.Tool]:
        """The entries of the tools."""
        return [plan_check.entry()]

    def resources(self) -> list[types.Resource]:
        """The entries of the resources."""
        return [plan_check.SCHEMA]

    def read(self, uri: str) -> str | None:
        """The text of the resource of that address; None if it is not one of these."""
        return json.dumps(plan_check.schema()) if uri == plan_check.SCHEMA.uri else None

    def prompts(self) -> list[types.Prompt]:
        """The entries of the prompts."""
        return [prompt.entry for prompt in PROMPTS]

    def use(self, name: str, arguments: Mapping[str, Any]) -> types.CallToolResult:
        """The reply of the tool of that name, one of ``names``."""
        return _TOOLS[name](arguments)

    def prompt(self, name: str, arguments: Mapping[str, str]) -> types.GetPromptResult:
        """The text of a prompt. Raises MCPError, which names the valid choices."""
        prompt = _BY_NAME.get(name)
        if prompt is None:
            raise _refused(f"There is no prompt {name[:80]!r}. Available: {', '.join(_BY_NAME)}.")
        text = prompt.write(**_checked(prompt, arguments))
        return types.GetPromptResult(
            description=prompt.description,
            messages=[types.PromptMessage(role="user", content=types.TextContent(text=text))],
        )

    def completions(self, argument: str, begun: str) -> list[str]:
        """Values of an argument that start with ``begun``."""
        return [stage for stage in STAGES if stage.startswith(begun)] if argument == _STAGE.name else []


def _checked(prompt: Prompt, arguments: Mapping[str, str]) -> dict[str, str]:
    """The arguments of a prompt, without empty ones. Raises MCPError."""
    known = {argument.name: bool(argument.required) for argument in prompt.arguments}
    texts = {name: text.strip() for name, text in arguments.items() if text.strip()}
    if unknown := [name for name in texts if name not in known]:
        raise _refused(f"{prompt.name} has no argument {unknown[0][:80]!r}; it has {', '.join(known)}.")
    if missing := [name for name, required in known.items() if required and name not in texts]:
        raise _refused(f"{prompt.name} needs the argument {missing[0]!r}.")
    if long := [name for name, text in texts.items() if len(text) > _LONGEST]:
        raise _refused(f"{long[0]!r} has {len(texts[long[0]])} characters; the limit is {_LONGEST}.")
    stage = texts.get(_STAGE.name)
    if stage is not None and stage not in STAGES:
        raise _refused(f"There is no stage {stage[:80]!r}. Available: {_STAGES}.")
    return texts


def _refused(message: str) -> MCPError:
    return MCPError(types.INVALID_PARAMS, message)
