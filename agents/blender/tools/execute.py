"""``blender_execute``: runs Python in the live Blender."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from agents.blender.checks.preflight import PreFlight, check_before_running
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from simworlds.counting import counted
from simworlds.sandbox.replies import Claim, Count, Text

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agents.blender.files.checkpoints import Checkpoint
    from simworlds.sandbox.blender_process import WorkerReply

LONGEST_CODE = 400_000
_LONGEST_PRINT = 8_000
_LONGEST_TITLE = 40
_BEFORE_IT_FAILS = "with on_error='restore' a call is undone when it fails"
# With the line of code that Python shows below it.
_DEPRECATION = r"^<blender_execute>:{line}: DeprecationWarning: .*\n?(?:^  .*\n?)?"
_OF_CACHES = {
    "reset": "A reset simulation simulates again from its first frame, however far it had come.",
    "older than their settings": (
        "The old bake is played, whatever the settings say. Bake these again (blender_bake; name their objects, "
        "or every simulation is baked anew), or free them first (free=true) to step or try the new settings."
    ),
}


class ExecuteArguments(Arguments):
    """The arguments of ``blender_execute``."""

    code: str = Field(max_length=LONGEST_CODE, description="Python; `bpy` is imported.")
    timeout: float = Field(default=60.0, ge=0.1, le=3600, description="Seconds.")
    preflight: Literal["on", "off"] = Field(
        default="on",
        description="off: run it unchecked.",
    )
    on_error: Literal["keep", "restore"] = Field(
        default="keep",
        description="The scene, when it fails half-way.",
    )


DESCRIPTION = """\
Run Python in the live Blender. Each call has a fresh namespace; `bpy.data` stays. Code with names, keywords or \
values that this Blender lacks is not run: the reply says what to write instead. Else it has what was printed, the \
value of a final expression, what changed and which simulations that reset; for an error the line, and what the \
documentation says. Step physics frame by frame, never jump. No network, no processes; write files below the current \
folder. Code that ends Blender or runs past `timeout` is undone."""


class _Fault(Claim):
    """An exception of executed code, as the worker reports it."""

    type: Text
    message: Text
    line: int | None
    source: Text
    traceback: Text
    ask: Text
    there: list[Text] = Field(max_length=100)


class Outcome(Claim):
    """The worker's report on executed code. ``changed`` has names in brief; ``counts``, which is not passed on, how
    many they are."""

    value: Text | None
    error: _Fault | None
    changed: dict[Text, dict[Text, list[Text]]]
    counts: dict[Text, dict[Text, Count]] = Field(default_factory=dict[Text, dict[Text, Count]], exclude=True)
    mode: Text
    unwatched: Text = ""


def run(context: ToolContext, arguments: ExecuteArguments, call: Call) -> Result:
    """Checks the code, and runs it unless it is sure to fail."""
    blender = context.blender
    checked = (
        PreFlight() if arguments.preflight == "off" else check_before_running(context, arguments.code, call)
    )
    if checked.errors:
        data = {"executed": False, "preflight": checked.data, "blender": checked.blender}
        return Result(checked.refusal(), data, failed=True)
    if arguments.on_error == "restore":
        blender.keep("before code that may be undone")
    before, unkept = blender.checkpoints.last, blender.checkpoints.unkept
    title = title_of(arguments.code)
    reply = blender.call(
        "execute",
        {"code": arguments.code},
        Outcome.model_validate,
        timeout=arguments.timeout,
        what=f"the code {title!r}",
        changes=True,
        after=f"after {title!r}",
        progress=call.progress,
        printed=True,
        cancelled=call.cancelled,
    )
    data = reply.value.model_dump()
    if checked.warnings:
        data["preflight"] = checked.data
    data.update(stdout=reply.stdout, stderr=reply.stderr, seconds=round(reply.seconds, 4))
    error = data["error"]
    if error is None:
        return Result(describe(data, reply, checked), data)
    error["documentation"] = context.docs(error["ask"]) if error["ask"] else ""
    if arguments.on_error == "restore":
        data["scene"] = f"The scene was restored from {blender.restore()}."
    else:
        data["scene"] = f"The scene is as the code left it.{_how_to_undo(before, unkept)}"
    return Result(describe(data, reply, checked), data, failed=True)


def title_of(code: str) -> str:
    """The first line that is not empty, shortened."""
    lines = [line.strip() for line in code.splitlines() if line.strip()]
    first = lines[0] if lines else "(empty)"
    return first if len(lines) < 2 and len(first) <= _LONGEST_TITLE else f"{first[:_LONGEST_TITLE]} …"


def _how_to_undo(before: Checkpoint | None, unkept: int) -> str:
    if before is None:
        return ""
    calls = f" and the {counted(unkept, 'call')} before it" if unkept else ""
    return f" To undo it{calls}: blender_load(checkpoint={before.number}), if you have that tool; {_BEFORE_IT_FAILS}."


def describe(data: dict[str, Any], reply: WorkerReply[Any], checked: PreFlight) -> str:
    """What came of executed code, as text."""
    parts: list[str] = []
    if error := data["error"]:
        parts.append(f"**{error['type']}**: {error['message']}")
        if error["source"]:
            parts.append(f"```python\n{error['source']}\n```")
        if error["there"]:
            parts.append(
                "Existing names, nearest first: " + ", ".join(f"`{name}`" for name in error["there"])
            )
        if error["documentation"]:
            parts.append(f"The documentation on `{error['ask'][:120]}`:\n\n{error['documentation']}")
        parts.append(data["scene"])
    if data["value"] is not None:
        parts.append(f"Value: `{data['value']}`")
    stderr = _without_told(reply.stderr, checked.remarked_lines())
    for name, text in (("Printed", reply.stdout), ("On stderr", stderr)):
        if text.strip():
            parts.append(f"{name}:\n```\n{_shortened(text.rstrip())}\n```")
    if data["changed"]:
        lines = [
            f"- {kind} {word}: {', '.join(names)}"
            for kind, entry in data["changed"].items()
            for word, names in entry.items()
        ]
        lines += [f"  {_OF_CACHES[word]}" for word in data["changed"].get("caches", {}) if word in _OF_CACHES]
        parts.append("Changed:\n" + "\n".join(lines))
    if data["mode"] != "OBJECT":
        parts.append(f"Blender is in {data['mode']} mode.")
    parts.append(f"{reply.seconds:.2f} s" + ("" if parts else "; nothing was printed or changed"))
    if remarks := checked.remarks():
        parts.append("\n".join(remarks))
    return "\n\n".join(parts)


def _without_told(stderr: str, lines: Iterable[int]) -> str:
    """What was printed, but for deprecations at lines that a warning names: it says more of the same."""
    for line in lines:
        stderr = re.sub(_DEPRECATION.format(line=line), "", stderr, flags=re.MULTILINE)
    return stderr


def _shortened(text: str) -> str:
    if len(text) <= _LONGEST_PRINT:
        return text
    half = _LONGEST_PRINT // 2
    return f"{text[:half]}\n… {len(text) - 2 * half:,} characters left out …\n{text[-half:]}"


TOOL = BlenderTool(
    "blender_execute",
    "Run Python in Blender",
    DESCRIPTION,
    ExecuteArguments,
    run,
    destructive=True,
    habit="to build in small steps: one object or idea per call, with meaningful names",
)
