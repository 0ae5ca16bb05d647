"""``blender_group``: groups meshes into objects of the scene protocol."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from agents.blender.formatting import format_count, format_list
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
        description="The object's name, such as 'Chair'; its collection (L3) has the same.",
    )
    system: str | None = Field(
        default=None,
        min_length=1,
        max_length=255,
        description="The system (L2) that it belongs to, such as 'furniture'; 'ground' for what everything else stands "
        "on. Required unless it is in one already.",
    )
    members: list[str] | None = Field(
        default=None,
        min_length=1,
        max_length=10_000,
        description="Names of its meshes and of what they depend on (armatures, lattices, Empties). They are added to "
        "what is in its collection already, which is the default.",
    )
    location: tuple[float, float, float] | None = Field(
        default=None,
        description="Where its root is placed, in the world. Default: the bottom centre of its geometry; an existing "
        "root stays.",
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
        description="Names of what the object touches: objects (L3), including those of this call, meshes or roots. "
        "Replaces the earlier list.",
    )
    allows_disconnected: bool | None = Field(
        default=None, description=meaning_of(vocabulary.ALLOWS_DISCONNECTED)
    )

    def for_worker(self) -> dict[str, Any]:
        """The arguments in the worker's form."""
        tags = self.model_dump(include={"deformation_kind", "motion_kind", "allows_disconnected"})
        return {
            **self.model_dump(include={"object", "system", "members", "location", "contact_with"}),
            "tags": {name: value for name, value in tags.items() if value is not None},
        }


class GroupArguments(Arguments):
    """The arguments of ``blender_group``."""

    groups: list[GroupedObject] = Field(min_length=1, max_length=_MOST, description="The objects to make.")


DESCRIPTION = """\
Make logical objects of the scene protocol out of existing meshes, any number in one call. For each: its collection \
(L3) and its system's (L2) are made unless they exist; the members are linked into it and unlinked from other \
collections (except those that physics uses); a root Empty is made unless there is one; all members are parented to \
it, directly or through members that are their parents already; and everything is tagged. Nothing moves in the world; \
animation and deformation stay as they are. Everything is checked first: if anything cannot be done, the call is \
refused and nothing changes. The reply says what the protocol still requires there; blender_verify checks the rest. To \
set only tags, use blender_tag_object."""


def run(context: ToolContext, arguments: GroupArguments, call: Call) -> Result:
    """Makes the objects."""
    reply = context.blender.call(
        "group",
        {"groups": [group.for_worker() for group in arguments.groups]},
        _read,
        timeout=_SECONDS,
        changes=True,
        after="after grouping",
        progress=call.progress,
        cancelled=call.cancelled,
    )
    return reply.value


def _read(data: dict[str, Any]) -> Result:
    """Blender's reply as text. Raises LookupError, TypeError or ValueError for a malformed one."""
    lines = [_line(group) for group in data["groups"]]
    if data["warnings"]:
        lines += ["", "The protocol still requires:", *(f"- {warning}" for warning in data["warnings"])]
    return Result("\n".join(lines), data)


def _line(group: dict[str, Any]) -> str:
    place = ", ".join(f"{value:.4g}" for value in group["location"])
    members = f"{format_count(len(group['members']), 'member')}: {_names(group['members'])}"
    line = f"- {group['object']!r} in {_names(group['systems'])}: root {group['root']!r} at ({place}), {members}."
    if group["taken_out_of"]:
        line += f" Unlinked from {_names(group['taken_out_of'])}."
    if group["freed_from"]:
        pairs = [f"{member!r} from {parent!r}" for member, parent in group["freed_from"].items()]
        line += f" Unparented: {format_list(pairs, _LISTED)}."
    return line


def _names(names: list[str]) -> str:
    return format_list([repr(name) for name in names], _LISTED)


TOOL = BlenderTool("blender_group", "Group meshes into objects", DESCRIPTION, GroupArguments, run)
