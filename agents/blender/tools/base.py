"""What all tools share: arguments, context, call and result."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Protocol

from pydantic import BaseModel, ConfigDict, ValidationError

from simworlds.sandbox.errors import Refusal
from simworlds.schemas.faults import describe_faults

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from agents.blender.assets.library import AssetLibrary
    from agents.blender.supervisor import Supervisor
    from agents.blender.tool_profiles import Profile
    from simworlds.sandbox.blender_process import Progress, WorkerReply
    from simworlds.sandbox.replies import Reader, T


class Arguments(BaseModel):
    """The arguments of a tool; models read their descriptions."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Docs(Protocol):
    """A look-up in the knowledge base."""

    def __call__(self, query: str, *, max_tokens: int = 400) -> str:
        """The answer in Markdown; "" if there is none."""
        ...


class NotChecked(Exception):  # noqa: N818 - reads as the state it names
    """Code was not checked; the message says why."""


class Check(Protocol):
    """A check of code against the knowledge base."""

    def __call__(self, code: str) -> dict[str, Any]:
        """What ``blender_check`` returns as JSON. Raises NotChecked."""
        ...


@dataclass(frozen=True, slots=True)
class Knowledge:
    """The knowledge base of one Blender version."""

    docs: Docs
    check: Check | None = None


@dataclass(frozen=True, slots=True)
class SavedImage:
    """A PNG, and its path in the run's folder."""

    png: bytes
    path: Path


@dataclass(frozen=True, slots=True)
class Result:
    """What a tool returns: ``text`` (Markdown, for the model), ``data`` (the same as JSON), images.

    ``failed``: the tool ran, but what it was to do went wrong.
    """

    text: str
    data: dict[str, Any] = field(default_factory=dict[str, Any])
    pictures: tuple[SavedImage, ...] = ()
    failed: bool = False


class CalledBlender(Protocol):
    """A Blender that tools call, whoever it belongs to: a run's own, or the one that the user has open."""

    def call(  # noqa: PLR0913 - what a caller may want to say of a call
        self,
        tool: str,
        arguments: dict[str, Any],
        read: Reader[T],
        *,
        timeout: float,
        what: str = "",
        changes: bool = False,
        after: str = "",
        progress: Progress | None = None,
        cancelled: threading.Event | None = None,
    ) -> WorkerReply[T]:
        """Runs a tool of the worker; see ``Supervisor.call``. Raises BlenderError."""
        ...

    def take_note(self) -> str:
        """What happened to it that no reply has mentioned yet."""
        ...

    def note_once(self, note: str) -> None:
        """Puts a note before the next reply, unless it stood before an earlier one."""
        ...


@dataclass(frozen=True, slots=True)
class CallContext:
    """What any tool works with: a Blender and the knowledge base. Without ``check``, code is not checked."""

    blender: CalledBlender
    docs: Docs
    check: Check | None = None
    assets: AssetLibrary | None = None


@dataclass(frozen=True, slots=True)
class ToolContext(CallContext):
    """The same with a run's own Blender, which has checkpoints and a folder."""

    blender: Supervisor


@dataclass(frozen=True, slots=True)
class Call:
    """A call's link to its caller: ``progress`` gets (done, total, text); ``cancelled`` is set to end the call.

    ``job``: what it is called as a job, before which a scene with checkpoints is kept. ``begins`` is called first.
    """

    progress: Progress | None = None
    cancelled: threading.Event = field(default_factory=threading.Event)
    job: str = ""
    begins: Callable[[], None] | None = None

    def begin(self) -> None:
        """It begins now, after those before it."""
        if self.begins is not None:
            self.begins()


@dataclass(frozen=True, slots=True)
class BlenderTool:
    """A tool of the suite (paper, Table "Tool suite"). ``run`` raises BlenderError.

    ``destructive``: it may remove or replace what was there. ``open_world``: it reaches beyond this machine.
    ``shows_scene``: what it returns follows from the scene and its arguments alone. ``profile``: the smallest one that
    has it. ``habit``: when to use it, for a server's instructions.
    """

    name: str
    title: str
    description: str
    arguments: type[Arguments]
    run: Callable[[ToolContext, Any, Call], Result]
    read_only: bool = False
    destructive: bool = False
    open_world: bool = False
    shows_scene: bool = False
    profile: Profile = "build"
    habit: str = ""

    @property
    def told(self) -> tuple[str, str]:
        """Its name, and when to use it."""
        return self.name, self.habit


def parse(tool: BlenderTool, arguments: dict[str, Any] | None) -> Arguments:
    """The arguments of a call, checked. Raises Refusal, which names each wrong one."""
    try:
        return tool.arguments.model_validate(arguments or {})
    except ValidationError as error:
        wrong = describe_faults(tool.arguments, error, at_most=800)
        raise Refusal(f"Wrong arguments for {tool.name}: {wrong}") from error


def perform(tool: BlenderTool, context: ToolContext, arguments: Arguments, call: Call) -> Result:
    """Runs a tool. Its text begins with what happened to Blender since the last reply. Raises BlenderError."""
    return with_note(tool.run(context, arguments, call), context.blender)


def with_note(result: Result, blender: CalledBlender) -> Result:
    """The result, begun with what happened to Blender since the last reply."""
    if not (note := blender.take_note()):
        return result
    return replace(result, text=f"{note}\n\n{result.text}", data={**result.data, "note": note})
