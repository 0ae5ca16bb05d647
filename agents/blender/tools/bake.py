"""``blender_bake``: physics, baked and checked."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from agents.blender.tools.base import Arguments, Call, Result, Session, Tool

_LAST_FRAME = 1_048_574


class Bake(Arguments):
    """The arguments of ``blender_bake``."""

    objects: list[str] | None = Field(
        default=None,
        min_length=1,
        description="Objects whose simulations to bake; any rigid body stands for the whole rigid-body world. "
        "Default: every simulation of the scene.",
    )
    frame_start: int | None = Field(
        default=None, ge=0, le=_LAST_FRAME, description="First frame. Default: the scene's."
    )
    frame_end: int | None = Field(
        default=None, ge=1, le=_LAST_FRAME, description="Last frame. Default: the scene's."
    )
    timeout: float = Field(
        default=900.0, ge=1, le=86_400, description="Seconds after which Blender is stopped and put back."
    )


DESCRIPTION = """\
Bake physics: cloth, soft bodies, particles, hair, rigid bodies, dynamic paint, liquid and gas; all of it or that \
of some objects. Each cache's own range is set from `frame_start` and `frame_end`; what was baked before is baked \
anew. Afterwards every cache is checked: that it is baked, covers the range, has all its frames, and that something \
moved; where nothing did, the likely causes are named. Fluids bake with cache_type 'ALL' into a folder that the run \
keeps; use this rather than bpy.ops.fluid.free_all, which goes on in a thread of its own and crashes what follows. \
A bake that runs past `timeout` (seconds) is undone."""


def run(session: Session, asked: Bake, call: Call) -> Result:
    """Bakes; tells what came of it."""
    blender = session.blender
    arguments: dict[str, Any] = {
        "objects": asked.objects,
        "frame_start": asked.frame_start,
        "frame_end": asked.frame_end,
        "folder": str(blender.folder.workspace),
    }
    reply = blender.call(
        "bake",
        arguments,
        timeout=asked.timeout,
        changes=True,
        always_keep=True,
        after="after baking",
        progress=call.progress,
        given_up=call.given_up,
    )
    data: dict[str, Any] = reply.value
    return Result(_told(data), data, failed=any(cache["fault"] for cache in data["caches"]))


def _told(data: dict[str, Any]) -> str:
    caches = data["caches"]
    good = sum(not cache["fault"] for cache in caches)
    first, last = data["range"]
    head = f"Baked {good} of {len(caches)} caches over frames {first}–{last} in {data['seconds']:.1f} s."
    return "\n".join([head, *(f"- {_line(cache)}" for cache in caches), *data["notes"]])


def _line(cache: dict[str, Any]) -> str:
    if cache["fault"]:
        return f"**{cache['label']}: not baked**: {cache['fault']}"
    first, last = cache["range"]
    size = f"{cache['bytes'] / 1e6:.1f} MB" if cache["bytes"] >= 1e5 else f"{cache['bytes'] / 1e3:.1f} kB"
    where = f" in {cache['folder']}" if cache["folder"] else ""
    frames = f"frames {first}–{last}" if first <= last else "no frames"
    line = f"{cache['label']}: {frames}, {cache['seconds']:.1f} s, {size}{where}; "
    if cache["warning"]:
        return f"{line}**{cache['warning']}**"
    if cache["unit"] != "m":
        return f"{line}values change by up to {cache['moved']:.2f}"
    who = f"{cache['who']!r} goes" if cache["who"] else "moves"
    line += f"{who} up to {cache['moved']:.3g} m"
    return f"{line}; {cache['bodies_moved']} of {cache['bodies']} bodies move" if "bodies" in cache else line


TOOL = Tool("blender_bake", "Bake physics", DESCRIPTION, Bake, run, read_only=False, destructive=True)
