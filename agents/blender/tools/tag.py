"""``blender_tag_object``: sets the scene protocol's tags."""

from __future__ import annotations

from typing import Any

from pydantic import ConfigDict, Field

from agents.blender.tools.base import Arguments, BlenderTool, Call, CallContext, Result
from agents.protocol import vocabulary
from agents.protocol.vocabulary import DeformationKind, MotionKind, Role, meaning_of
from simworlds.sandbox.errors import Refusal

_SECONDS = 60.0
_MOST = 1000
_NAME = Field(min_length=1, max_length=255, description="Its name in Blender.")


def _without_defaults(schema: dict[str, Any]) -> None:
    """Removes defaults from the schema: a tag that is left out stays as it is."""
    for entry in schema.get("properties", {}).values():
        entry.pop("default", None)


class _Tags(Arguments):
    model_config = ConfigDict(json_schema_extra=_without_defaults)

    name: str = _NAME

    def for_worker(self) -> tuple[str, dict[str, Any]]:
        """(name, {property: value; None removes it})."""
        tags = self.model_dump(include=self.model_fields_set - {"name"})
        return self.name, {vocabulary.PROTOCOL_ROLE if key == "role" else key: tags[key] for key in tags}


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
    """Tags of a Blender object: a mesh or an Empty."""

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
Set the scene protocol's tags on any number of collections and objects at once. A collection is a *system* (L2, \
directly under the scene: `ground`, `lighting`, `cameras`, a room, …) or an *object* (L3, in a system: all meshes of \
one logical object, parented to one root Empty). A tag that is left out stays as it is; null removes it. If anything \
contradicts the protocol, the call is refused and nothing changes. The reply lists the tags as they are now and what \
the protocol still requires there. blender_group makes collections, roots and parents, and tags them."""


def run(context: CallContext, arguments: TagArguments, call: Call) -> Result:
    """Sets the tags."""
    scene: dict[str, Any] = {}
    if vocabulary.STRICT_GROUNDING in arguments.model_fields_set:
        scene[vocabulary.STRICT_GROUNDING] = arguments.strict_grounding
    if not (arguments.collections or arguments.objects or scene):
        raise Refusal("There is nothing to tag: give collections, objects or strict_grounding.")
    reply = context.blender.call(
        "tag",
        {
            "collections": [tags.for_worker() for tags in arguments.collections],
            "objects": [tags.for_worker() for tags in arguments.objects],
            "scene": scene,
        },
        _read,
        timeout=_SECONDS,
        changes=True,
        after="after tagging",
        cancelled=call.cancelled,
    )
    return reply.value


def _read(data: dict[str, Any]) -> Result:
    """Blender's reply as text. Raises LookupError, TypeError or ValueError for a malformed one."""
    lines = [f"- collection {_line(name, tags)}" for name, tags in data["collections"].items()]
    lines += [f"- object {_line(name, tags)}" for name, tags in data["objects"].items()]
    if data["scene"]:
        lines.append(f"- scene: {_tags(data['scene'])}")
    lines = ["Tags now:", *lines] if lines else ["The scene has no tags now."]
    if data["warnings"]:
        lines += ["", "The protocol still requires:", *(f"- {warning}" for warning in data["warnings"])]
    return Result("\n".join(lines), data)


def _line(name: str, tags: dict[str, Any]) -> str:
    return f"{name!r}: {_tags(tags) or 'none'}"


def _tags(tags: dict[str, Any]) -> str:
    return "; ".join(
        f"{tag} {', '.join(repr(name) for name in value) if isinstance(value, list) else value}"
        for tag, value in tags.items()
    )


# blender_group sets the tags of objects too, in fewer calls.
TOOL = BlenderTool(
    "blender_tag_object",
    "Tag for the scene protocol",
    DESCRIPTION,
    TagArguments,
    run,
    profile="all",
)
