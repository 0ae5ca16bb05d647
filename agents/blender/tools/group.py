"""``blender_group``: groups meshes into objects of the scene protocol."""

from __future__ import annotations

import re
from typing import Any

from pydantic import Field

from agents.blender.tools.base import Arguments, BlenderTool, Call, CallContext, Result
from agents.protocol.vocabulary import DeformationKind, MotionKind
from simworlds.counting import counted, format_list

_SECONDS = 120.0
_MOST = 500
_LISTED = 8
_FEW = 3
_NUMBER = re.compile(r"-?\d[\d.]*(e-?\d+)?")


class GroupedObject(Arguments):
    """One object (L3)."""

    object: str = Field(
        min_length=1,
        max_length=255,
        description="Its name and its collection's.",
    )
    system: str | None = Field(
        default=None,
        min_length=1,
        max_length=255,
        description="Its system (L2). Required at first.",
    )
    members: list[str] | None = Field(
        default=None,
        min_length=1,
        max_length=10_000,
        description="Its meshes, armatures, helping Empties; added to its own.",
    )
    location: tuple[float, float, float] | None = Field(
        default=None,
        description="Its root's, in the world. Default: as it is, or the bottom centre.",
    )
    deformation_kind: DeformationKind | None = Field(
        default=None,
        description="rig: an armature, a lattice, shape keys or another deformer.",
    )
    motion_kind: MotionKind | None = Field(default=None, description="bake: a baked simulation moves it.")
    contact_with: list[str] | None = Field(
        default=None,
        max_length=1000,
        description="Objects, meshes, roots it touches; itself: its parts may cross. Replaces the list.",
    )
    allows_disconnected: bool | None = Field(default=None, description="Its meshes need not touch.")

    def for_worker(self) -> dict[str, Any]:
        """The arguments in the worker's form."""
        tags = self.model_dump(include={"deformation_kind", "motion_kind", "allows_disconnected"})
        return {
            **self.model_dump(include={"object", "system", "members", "location", "contact_with"}),
            "tags": {name: value for name, value in tags.items() if value is not None},
        }


class GroupArguments(Arguments):
    """The arguments of ``blender_group``."""

    groups: list[GroupedObject] = Field(min_length=1, max_length=_MOST, description="The objects.")


DESCRIPTION = """\
Make logical objects of the scene protocol out of meshes, many in one call: their collections (L3, and L2 unless \
there), a root Empty each, parents and tags. Members leave other collections, but those of physics. Nothing moves in \
the world. A call is done whole or not at all. The reply says what the protocol still requires. For what is \
grouped already it sets tags: give the object and what changes."""


def run(context: CallContext, arguments: GroupArguments, call: Call) -> Result:
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
    alike: dict[str, list[tuple[str, str]]] = {}
    for group in data["groups"]:
        line = _line(group)
        alike.setdefault(_NUMBER.sub("#", line), []).append((group["object"], line))
    lines = [line for told in alike.values() for line in _lines(told)]
    if data["warnings"]:
        lines += ["", "The protocol still requires:", *(f"- {warning}" for warning in data["warnings"])]
    return Result("\n".join(lines), data)


def _lines(told: list[tuple[str, str]]) -> list[str]:
    """Of (object, its line) that differ only in numbers; of more than a few, the first alone is told in full."""
    lines = [line for _, line in told]
    if len(told) <= _FEW:
        return lines
    others = [name for name, _ in told[1:]]
    return [lines[0], f"- In the same way {len(others):,} more: {_names(others)}."]


def _line(group: dict[str, Any]) -> str:
    place = ", ".join(f"{value:.4g}" for value in group["location"])
    members = f"{counted(len(group['members']), 'member')}: {_names(group['members'])}"
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
