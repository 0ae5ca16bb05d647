"""``blender_tag_object``: the scene protocol's tags."""

from __future__ import annotations

from typing import Any

from pydantic import ConfigDict, Field

from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from agents.protocol import vocabulary
from agents.protocol.vocabulary import DeformationKind, MotionKind, Role, meaning_of
from simworlds.sandbox.errors import Refusal

_SECONDS = 60.0
_MOST = 1000
_NAME = Field(min_length=1, max_length=255, description="Its name in Blender.")


def _without_defaults(schema: dict[str, Any]) -> None:
    """A tag that is left out stays as it is: no default is to be read from the schema."""
    for entry in schema.get("properties", {}).values():
        entry.pop("default", None)


class _Tags(Arguments):
    model_config = ConfigDict(json_schema_extra=_without_defaults)

    name: str = _NAME

    def for_worker(self) -> tuple[str, dict[str, Any]]:
        """(name, {property: value, None to remove it})."""
        given = self.model_dump(include=self.model_fields_set - {"name"})
        return self.name, {vocabulary.PROTOCOL_ROLE if key == "role" else key: given[key] for key in given}


class CollectionTags(_Tags):
    """Tags of a collection."""

    role: Role | None = Field(
        default=None, description=meaning_of(vocabulary.PROTOCOL_ROLE, vocabulary.ROLES)
    )
    deformation_kind: DeformationKind | None = Field(
        default=None, description=meaning_of(vocabulary.DEFORMATION_KIND, vocabulary.DEFORMATION_KINDS)
    )
    motion_kind: MotionKind | None = Field(
        default=None, description=meaning_of(vocabulary.MOTION_KIND, vocabulary.MOTION_KINDS)
    )
    allows_disconnected: bool | None = Field(
        default=None, description=meaning_of(vocabulary.ALLOWS_DISCONNECTED)
    )


class ObjectTags(_Tags):
    """Tags of an object of Blender's: a mesh or an Empty."""

    is_object_root: bool | None = Field(default=None, description=meaning_of(vocabulary.IS_OBJECT_ROOT))
    contact_with: list[str] | None = Field(
        default=None,
        max_length=_MOST,
        description=meaning_of(vocabulary.CONTACT_WITH) + " The list replaces the one before.",
    )


class TagArguments(Arguments):
    """The arguments of ``blender_tag_object``."""

    model_config = ConfigDict(json_schema_extra=_without_defaults)

    collections: list[CollectionTags] = Field(
        default_factory=list[CollectionTags], max_length=_MOST, description="Collections to tag."
    )
    objects: list[ObjectTags] = Field(
        default_factory=list[ObjectTags], max_length=_MOST, description="Meshes and Empties to tag."
    )
    strict_grounding: bool | None = Field(
        default=None, description="Of the scene: " + meaning_of(vocabulary.STRICT_GROUNDING)
    )


DESCRIPTION = """\
Set the scene protocol's tags, on any number of collections and objects at once. A collection is a *system* (L2, \
directly under the scene: `ground`, `lighting`, `cameras`, a room, …) or an *object* (L3, in a system: all meshes of \
one logical object, parented to one root Empty). Collections carry `role`, `deformation_kind`, `motion_kind`, \
`allows_disconnected`; meshes and Empties carry `is_object_root` and `contact_with`. A tag that is left out stays as \
it is; null removes it. Names must exist. What contradicts the protocol is refused, and nothing is changed then. The \
reply tells the tags as they now are and what the protocol still misses there. Tags are custom properties and are \
saved with the file; this tool makes and moves nothing: blender_group makes collections, roots and parents, and tags."""


def run(context: ToolContext, arguments: TagArguments, call: Call) -> Result:
    """Tags; tells what the tags are now."""
    scene: dict[str, Any] = {}
    if vocabulary.STRICT_GROUNDING in arguments.model_fields_set:
        scene[vocabulary.STRICT_GROUNDING] = arguments.strict_grounding
    if not (arguments.collections or arguments.objects or scene):
        raise Refusal("Nothing is named: give collections, objects or strict_grounding.")
    reply = context.blender.call(
        "tag",
        {
            "collections": [one.for_worker() for one in arguments.collections],
            "objects": [one.for_worker() for one in arguments.objects],
            "scene": scene,
        },
        timeout=_SECONDS,
        changes=True,
        after="after tagging",
        cancelled=call.cancelled,
    )
    return Result(_told(reply.value), dict(reply.value))


def _told(found: dict[str, Any]) -> str:
    lines = [f"- collection {_line(name, tags)}" for name, tags in found["collections"].items()]
    lines += [f"- object {_line(name, tags)}" for name, tags in found["objects"].items()]
    if found["scene"]:
        lines.append(f"- scene: {_list(found['scene'])}")
    told = "Tags now:\n" + "\n".join(lines) if lines else "The scene carries no tag now."
    if found["warnings"]:
        told += "\n\nThe protocol still misses:\n" + "\n".join(f"- {one}" for one in found["warnings"])
    return told


def _line(name: str, tags: dict[str, Any]) -> str:
    return f"{name!r}: {_list(tags) or 'none'}"


def _list(tags: dict[str, Any]) -> str:
    return "; ".join(
        f"{tag} {', '.join(repr(name) for name in value) if isinstance(value, list) else value}"
        for tag, value in tags.items()
    )


TOOL = BlenderTool("blender_tag_object", "Tag for the scene protocol", DESCRIPTION, TagArguments, run)
