"""``blender_execute`` in the open Blender: code is rehearsed in a copy first, then applied as one undo step."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from agents.blender.attached.attached_blender import TooLarge
from agents.blender.checks.preflight import PreFlight, check_before_running
from agents.blender.tools import execute
from agents.blender.tools.base import BlenderTool, Call, Result
from agents.blender.tools.execute import ExecuteArguments, Outcome, describe, title_of
from simworlds.counting import format_list
from simworlds.sandbox.errors import Lost, Refusal
from simworlds.sandbox.replies import Text  # noqa: TC001 - annotates fields of models

if TYPE_CHECKING:
    from agents.blender.attached.tools.base import AttachedContext
    from agents.blender.supervisor import Supervisor
    from simworlds.sandbox.blender_process import WorkerReply

_LISTED = 8
_UNCHANGED = "**Nothing was done in the open Blender.**"
_KEPT_OUT = "Do without that: the user's Blender is not to write files, open sockets or start anything."


class RehearsedArguments(ExecuteArguments):
    """The arguments of ``blender_execute``, with ``rehearse``."""

    rehearse: Literal["on", "off"] = Field(
        default="on",
        description="off: without a rehearsal in a copy, if the user allows that.",
    )


DESCRIPTION = """\
Run Python in the user's open Blender. It is checked, then rehearsed in a sandboxed copy of the scene; code that \
fails, hangs, crashes, writes files, opens sockets or quits never reaches the open Blender. Then it runs there as one \
undo step, named after its first line (a comment says best what it does). The reply has what was printed, the value of \
a final expression and what changed. Each call has a fresh namespace; `bpy.data` stays. Use data, and operators that \
need no editor; the user may be selecting and moving things meanwhile: find objects by name."""


class _Applied(Outcome):
    """The report on code that ran guarded: ``noted`` is what it tried that it must not."""

    noted: list[Text] = Field(max_length=20)


class _Rehearsed(_Applied):
    """The same of a rehearsal: files that appeared, and what undo will not take back."""

    wrote: list[Text] = Field(max_length=20)
    stays: list[Text] = Field(max_length=20)


@dataclass(frozen=True, slots=True)
class _Rehearsal:
    """What came of it: ``stopped`` if the code must not be applied, with why; else its ``outcome``, and ``notes``.

    ``of_part``: the copy had a part of the scene, in which more is told of changes, and names may be free.
    """

    stopped: Result | None = None
    outcome: Outcome | None = None
    of_part: bool = False
    seconds: float = 0.0
    notes: tuple[str, ...] = ()


def run(context: AttachedContext, arguments: RehearsedArguments, call: Call) -> Result:
    """Checks the code, rehearses it, and runs it in the open Blender."""
    checked = PreFlight()
    if arguments.preflight == "on":
        checked = check_before_running(context.of_open, arguments.code, call)
    if checked.errors:
        data = {"executed": False, "preflight": checked.data, "blender": checked.blender}
        return Result(checked.refusal(), data, failed=True)
    rehearsal = _Rehearsal()
    if arguments.rehearse == "on":
        rehearsal = _rehearse(context, arguments, checked, call)
        if rehearsal.stopped is not None:
            return rehearsal.stopped
    return _apply(context, arguments, checked, rehearsal, call)


def _rehearse(
    context: AttachedContext, arguments: RehearsedArguments, checked: PreFlight, call: Call
) -> _Rehearsal:
    """Runs the code in a copy; if the scene is too large for one, in a copy of the part that it touches. Where that
    cannot be told either, the user's panel decides."""
    try:
        twin, of_part = _copy(context, arguments.code, call)
    except TooLarge as error:
        return _Rehearsal(notes=(f"Not rehearsed: {error}",))
    folders = [place.for_blender() for place in twin.launch.folders]
    try:
        reply = twin.call(
            "rehearse",
            {"code": arguments.code, "seconds": arguments.timeout, "folders": folders},
            _Rehearsed.model_validate,
            timeout=arguments.timeout,
            what=f"the rehearsal of {title_of(arguments.code)!r}",
            progress=call.progress,
            printed=True,
            cancelled=call.cancelled,
        )
    except Lost as error:
        twin.take_note()
        said = str(error).partition(" A new Blender was started")[0]
        output = error.printed.strip()[-1500:]
        text = f"{_UNCHANGED} The rehearsal in a copy of the scene ended badly: {said}"
        text += f"\n\nThe end of its output:\n```\n{output}\n```" if output else ""
        return _Rehearsal(Result(text, {"executed": False, "rehearsal": said}, failed=True))
    rehearsed = reply.value
    tried = [*rehearsed.noted, *(f"it wrote {path}" for path in rehearsed.wrote)]
    if tried:
        text = f"{_UNCHANGED} In the rehearsal, {'; '.join(tried)}. {_KEPT_OUT}"
        return _Rehearsal(Result(text, {"executed": False, "tried": tried}, failed=True))
    if rehearsed.error is not None:
        data = {"executed": False, **_reply_data(context, rehearsed, reply)}
        data["scene"] = f"{_UNCHANGED} This was the rehearsal in a copy of {of_part or 'the scene'}."
        if of_part:
            data["scene"] += " What code reaches by other names than texts in it is not there."
        return _Rehearsal(Result(describe(data, reply, checked), data, failed=True))
    notes = [f"Rehearsed in a copy of {of_part} alone: the whole is too large."] if of_part else []
    if rehearsed.stays:
        notes.append(
            f"Undo will not take back what the code leaves in Blender: {', '.join(rehearsed.stays)}."
        )
    return _Rehearsal(outcome=rehearsed, of_part=bool(of_part), seconds=reply.seconds, notes=tuple(notes))


def _copy(context: AttachedContext, code: str, call: Call) -> tuple[Supervisor, str]:
    """The Blender that has a copy, and what of the scene it has in words; "" for all. Raises BlenderError."""
    try:
        return context.twin.refreshed(context.open, call.cancelled), ""
    except TooLarge as whole:
        try:
            twin, objects = context.twin.part_of_code(context.open, code, call.cancelled)
        except TooLarge as error:
            raise TooLarge(f"{whole} {error}") from error
    named = format_list(objects, _LISTED)
    return twin, f"what the code names and needs ({named})" if named else "the scene without its objects"


def _apply(
    context: AttachedContext,
    arguments: RehearsedArguments,
    checked: PreFlight,
    rehearsal: _Rehearsal,
    call: Call,
) -> Result:
    try:
        reply = _called(context, arguments, rehearsal, call)
    except Refusal as error:
        raise Refusal(" ".join([*rehearsal.notes, str(error)])) from error
    applied = reply.value
    data = _reply_data(context, applied, reply)
    if checked.warnings:
        data["preflight"] = checked.data
    notes = [*rehearsal.notes, *(f"Blender was kept from this: {words}." for words in applied.noted)]
    if (rehearsed := rehearsal.outcome) is not None:
        comparable = _added_and_removed if rehearsal.of_part else _names
        same = comparable(rehearsed) == comparable(applied)
        data["rehearsal"] = {"seconds": rehearsal.seconds, "same": same}
        if not same:
            notes.append(
                f"In the rehearsal, other things changed: {_listed(rehearsed.changed) or 'nothing'}."
            )
    if applied.error is not None:
        data["scene"] = "The scene is as the code left it. To undo it: blender_undo()."
        if arguments.on_error == "restore":
            data["scene"] = "What the code had done was undone."
    text = "\n\n".join([describe(data, reply, checked), *notes])
    return Result(text, data, failed=applied.error is not None)


def _names(outcome: Outcome) -> object:
    return outcome.changed


def _added_and_removed(outcome: Outcome) -> object:
    """How many of each kind came and went, which is the same in a part of the scene and in the whole."""
    counts = {
        kind: [entry.get(word, 0) for word in ("added", "removed")] for kind, entry in outcome.counts.items()
    }
    return {kind: both for kind, both in counts.items() if any(both)}


def _called(
    context: AttachedContext, arguments: RehearsedArguments, rehearsal: _Rehearsal, call: Call
) -> WorkerReply[_Applied]:
    return context.open.call(
        "apply",
        {
            "code": arguments.code,
            "seconds": arguments.timeout,
            "rehearsed": rehearsal.outcome is not None,
            "restores": arguments.on_error == "restore",
        },
        _Applied.model_validate,
        timeout=arguments.timeout,
        what=f"the code {title_of(arguments.code)!r}",
        changes=True,
        after=_step_of(arguments.code),
        progress=call.progress,
        cancelled=call.cancelled,
    )


def _step_of(code: str) -> str:
    """What the undo step is called: the first line, which may be a comment."""
    lines = [line.strip() for line in code.splitlines() if line.strip()]
    return lines[0].lstrip("# ") if lines else "nothing"


def _reply_data(context: AttachedContext, outcome: _Applied, reply: WorkerReply[Any]) -> dict[str, Any]:
    data = outcome.model_dump()
    data.update(stdout=reply.stdout, stderr=reply.stderr, seconds=round(reply.seconds, 4))
    if (error := data["error"]) is not None:
        error["documentation"] = context.docs(error["ask"]) if error["ask"] else ""
    return data


def _listed(changed: dict[str, dict[str, list[str]]]) -> str:
    return "; ".join(
        f"{kind} {word}: {', '.join(names)}"
        for kind, entry in changed.items()
        for word, names in entry.items()
    )


TOOL: BlenderTool = replace(execute.TOOL, description=DESCRIPTION, arguments=RehearsedArguments)
