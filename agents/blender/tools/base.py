"""What a tool is: a name that models know, arguments that can be checked, and what comes back."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from agents.blender.supervisor import Supervisor
    from simworlds.sandbox.blender_process import Progress


class Arguments(BaseModel):
    """The arguments of a tool; their descriptions are what a model reads."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Docs(Protocol):
    """A way to ask the knowledge base."""

    def __call__(self, query: str, *, max_tokens: int = 400) -> str:
        """The answer in Markdown, "" where there is none to be had."""
        ...


@dataclass(frozen=True, slots=True)
class SavedImage:
    """A PNG, and where it lies in the run's folder."""

    png: bytes
    path: Path


@dataclass(frozen=True, slots=True)
class Result:
    """What a tool found: ``text`` (Markdown, for the model), ``data`` (the same as JSON), pictures.

    ``failed``: the tool ran, and what it was asked to do went wrong.
    """

    text: str
    data: dict[str, Any] = field(default_factory=dict[str, Any])
    pictures: tuple[SavedImage, ...] = ()
    failed: bool = False


@dataclass(frozen=True, slots=True)
class ToolContext:
    """What a tool works with: one run's Blender, and the knowledge base."""

    blender: Supervisor
    docs: Docs


@dataclass(frozen=True, slots=True)
class Call:
    """How a call is watched: ``progress`` gets (done, total, text); ``cancelled`` is set when nobody waits any more."""

    progress: Progress | None = None
    cancelled: threading.Event = field(default_factory=threading.Event)


Given = TypeVar("Given", bound=Arguments)


@dataclass(frozen=True, slots=True)
class BlenderTool:
    """A tool of the suite (paper, Table "Tool suite"). ``run`` raises BlenderError for what it cannot do.

    ``destructive``: what was there before may be gone afterwards.
    """

    name: str
    title: str
    description: str
    arguments: type[Arguments]
    run: Callable[[ToolContext, Any, Call], Result]
    read_only: bool = False
    destructive: bool = False


def parse(tool: BlenderTool, given: dict[str, Any] | None) -> Arguments:
    """The arguments of a call, checked. Raises Refusal, naming each that is wrong."""
    try:
        return tool.arguments.model_validate(given or {})
    except ValidationError as error:
        wrong = "; ".join(
            f"{'.'.join(str(part) for part in fault['loc']) or 'arguments'}: {fault['msg']}"
            for fault in error.errors(include_url=False, include_context=False)
        )
        raise Refusal(f"The arguments do not fit {tool.name}: {wrong[:800]}") from error


def perform(tool: BlenderTool, context: ToolContext, asked: Arguments, call: Call) -> Result:
    """Runs a tool; what has happened to Blender meanwhile comes before its text. Raises BlenderError."""
    result = tool.run(context, asked, call)
    note = context.blender.take_note()
    return (
        replace(result, text=f"{note}\n\n{result.text}", data={**result.data, "note": note})
        if note
        else result
    )
