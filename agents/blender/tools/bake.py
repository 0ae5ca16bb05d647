"""``blender_bake``: bakes physics and checks the caches, or frees bakes."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from simworlds.counting import format_list
from simworlds.sandbox.replies import Claim, Name

_LISTED = 20
_LAST_FRAME = 1_048_574


class BakeArguments(Arguments):
    """The arguments of ``blender_bake``."""

    objects: list[str] | None = Field(
        default=None,
        min_length=1,
        description="Default: every simulation. A rigid body: its whole world.",
    )
    frame_start: int | None = Field(default=None, ge=0, le=_LAST_FRAME, description="Default: the scene's.")
    frame_end: int | None = Field(default=None, ge=1, le=_LAST_FRAME, description="Default: the scene's.")
    free: bool = Field(
        default=False,
        description="Free their bakes instead.",
    )
    timeout: float = Field(default=900.0, ge=1, le=86_400, description="Seconds.")


DESCRIPTION = """\
Bake physics: cloth, soft bodies, particles, hair, rigid bodies, dynamic paint, liquid and gas. Earlier bakes are \
replaced; frames simulated already are kept if nothing has changed. Every cache is checked: baked, whole, and \
something moved; else likely causes are named. Never call bpy.ops.fluid.free_all, which crashes later calls: use \
`free`. Past `timeout` it is undone."""


def run(context: ToolContext, arguments: BakeArguments, call: Call) -> Result:
    """Bakes, and checks the caches; or frees bakes."""
    blender = context.blender
    if arguments.free:
        return blender.call(
            "free_bake",
            {"objects": arguments.objects},
            read_freed,
            timeout=arguments.timeout,
            changes=True,
            after="after freeing bakes",
            cancelled=call.cancelled,
        ).value
    reply = blender.call(
        "bake",
        {
            **arguments.model_dump(exclude={"timeout", "free"}),
            "folder": blender.folder.workspace.for_blender(),
        },
        read_baked,
        timeout=arguments.timeout,
        changes=True,
        always_keep=True,
        after="after baking",
        progress=call.progress,
        cancelled=call.cancelled,
    )
    return reply.value


def read_baked(data: dict[str, Any]) -> Result:
    """Blender's reply as text. Raises LookupError, TypeError or ValueError for a malformed one."""
    caches = data["caches"]
    baked = sum(not cache["fault"] for cache in caches)
    first, last = data["range"]
    head = f"Baked {baked} of {len(caches)} caches over frames {first}–{last} in {data['seconds']:.1f} s."
    text = "\n".join([head, *(f"- {_cache(cache)}" for cache in caches), *data["notes"]])
    return Result(text, data, failed=baked < len(caches))


class _Freed(Claim):
    """The labels of caches whose bakes were freed, and of those that had none."""

    freed: list[Name] = Field(max_length=10_000)
    unbaked: list[Name] = Field(max_length=10_000)


def read_freed(data: Any) -> Result:
    """Blender's reply as text. Raises ValidationError for a malformed one."""
    reply = _Freed.model_validate(data)
    lines = [f"Freed: {format_list(reply.freed, _LISTED)}." if reply.freed else "Nothing was freed."]
    lines += [f"Not baked before: {format_list(reply.unbaked, _LISTED)}."] if reply.unbaked else []
    return Result(" ".join(lines), reply.model_dump())


def _cache(cache: dict[str, Any]) -> str:
    if cache["fault"]:
        return f"**{cache['label']}: not baked**: {cache['fault']}"
    first, last = cache["range"]
    size = f"{cache['bytes'] / 1e6:.1f} MB" if cache["bytes"] >= 1e5 else f"{cache['bytes'] / 1e3:.1f} kB"
    where = f" in {cache['folder']}" if cache["folder"] else ""
    frames = f"frames {first}–{last}" if first <= last else "no frames"
    took = "simulated before and kept" if cache["kept"] else f"{cache['seconds']:.1f} s"
    line = f"{cache['label']}: {frames}, {took}, {size}{where}; "
    if cache["warning"]:
        return f"{line}**{cache['warning']}**"
    if cache["unit"] != "m":
        return f"{line}values change by up to {cache['moved']:.2f}"
    mover = f"{cache['who']!r} moves" if cache["who"] else "moves"
    line += f"{mover} up to {cache['moved']:.3g} m"
    return f"{line}; {cache['bodies_moved']} of {cache['bodies']} bodies move" if "bodies" in cache else line


TOOL = BlenderTool(
    "blender_bake",
    "Bake physics",
    DESCRIPTION,
    BakeArguments,
    run,
    destructive=True,
    habit="for physics, before you judge motion; never jump to a frame of an unbaked simulation",
)
