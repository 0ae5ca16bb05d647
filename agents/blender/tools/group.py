"""``blender_group``: objects of the scene protocol, made in one call."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from agents.protocol import vocabulary
from agents.protocol.vocabulary import DeformationKind, MotionKind, meaning_of

_SECONDS = 120.0
_MOST = 500
_LISTED = 8


class GroupedObject(Arguments):
    """One object (L3)."""

    object: str = Field(
        min_length=1,
        max_length=255,
        description="The object's name, as 'Chair': that of its collection (L3).",
    )
    system: str | None = Field(
        default=None,
        min_length=1,
        max_length=255,
        description="The system (L2) that it belongs to, as 'furniture'; 'ground' for what all else stands on. Needed "
        "unless it is in one already.",
    )
    members: list[str] | None = Field(
        default=None,
        min_length=1,
        max_length=10_000,
        description="Names of its meshes, and of what they hang on (armatures, lattices, Empties). Default: what is in "
        "its collection already, to which members are added.",
    )
    location: tuple[float, float, float] | None = Field(
        default=None,
        description="Where its root is to be, in the world. Default: at the bottom, in the middle, of its geometry; a "
        "root that it has stays.",
    )
    deformation_kind: DeformationKind | None = Field(
        default=None, description=meaning_of(vocabulary.DEFORMATION_KIND, vocabulary.DEFORMATION_KINDS)
    )
    motion_kind: MotionKind | None = Field(
        default=None, description=meaning_of(vocabulary.MOTION_KIND, vocabulary.MOTION_KINDS)
    )
    contact_with: list[str] | None = Field(
        default=None,
        max_length=1000,
        description="Names of what the object touches: objects (L3), also of this call, meshes or roots. Replaces "
        "the list before.",
    )
    allows_disconnected: bool | None = Field(
        default=None, description=meaning_of(vocabulary.ALLOWS_DISCONNECTED)
    )

    def for_worker(self) -> dict[str, Any]:
        """It as Blender's side takes it."""
        tags = self.model_dump(include={"deformation_kind", "motion_kind", "allows_disconnected"})
        return {
            **self.model_dump(include={"object", "system", "members", "location", "contact_with"}),
            "tags": {name: value for name, value in tags.items() if value is not None},
        }


class GroupArguments(Arguments):
    """The arguments of ``blender_group``."""

    groups: list[GroupedObject] = Field(min_length=1, max_length=_MOST, description="The objects to make.")


DESCRIPTION = """\
Make logical objects of the scene protocol out of meshes that are there, any number in one call. For each: its \
collection (L3) and its system's (L2) are made, or taken if they exist; the members are linked into it and out of \
other collections (not out of those that physics goes by); a root Empty is made, or the one that is there taken; all \
members are parented to it, directly or through members that they hang on already; and everything is tagged. Nothing \
moves in the world, animation and deformation stay as they are. All is checked first: what cannot be done is refused, \
and nothing is changed then. The reply tells what the protocol still misses; blender_verify tells the rest. For tags \
alone, use blender_tag_object."""


def run(context: ToolContext, arguments: GroupArguments, call: Call) -> Result:
    """Groups; tells what there is now."""
    reply = context.blender.call(
        "group",
        {"groups": [one.for_worker() for one in arguments.groups]},
        timeout=_SECONDS,
        changes=True,
        after="after grouping",
        progress=call.progress,
        cancelled=call.cancelled,
    )
    data: dict[str, Any] = reply.value
    lines = [_line(one) for one in data["groups"]]
    if data["warnings"]:
        lines += ["", "The protocol still misses:", *(f"- {one}" for one in data["warnings"])]
    return Result("\n".join(lines), data)


def _line(one: dict[str, Any]) -> str:
    place = ", ".join(f"{value:.4g}" for value in one["location"])
    line = (
        f"- {one['object']!r} in {_names(one['systems'])}: root {one['root']!r} at ({place}), "
        f"{len(one['members'])} {'member' if len(one['members']) == 1 else 'members'}: {_names(one['members'])}."
    )
    if one["taken_out_of"]:
        line += f" Taken out of {_names(one['taken_out_of'])}."
    if one["freed_from"]:
        pairs = [f"{thing!r} off {parent!r}" for thing, parent in one["freed_from"].items()]
        more = f" and {len(pairs) - _LISTED} more" if len(pairs) > _LISTED else ""
        line += f" Taken off their parents: {', '.join(pairs[:_LISTED])}{more}."
    return line


def _names(names: list[str]) -> str:
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return ", ".join(repr(name) for name in names[:_LISTED]) + more


TOOL = BlenderTool("blender_group", "Group meshes into objects", DESCRIPTION, GroupArguments, run)
