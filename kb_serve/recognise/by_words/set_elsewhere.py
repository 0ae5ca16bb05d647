"""Where a script sets what an operator has no argument for: on what the operator makes, or on what it works with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import ID, OPERATORS, TYPES
from kb_serve.recognise.by_words.said_otherwise import labelled
from kb_serve.recognise.chains.operator_classes import operator_of_class

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_OBJECT = "bpy.context.object"


@dataclass(frozen=True, slots=True)
class _Place:
    """An expression of a class; ``after``: whether the operator makes it, and it is there afterwards alone."""

    expression: str
    cls: str
    after: bool = True


def _data(cls: str) -> _Place:
    return _Place(f"{_OBJECT}.data", cls)


# What operators that are called so, or begin so, make or work with.
_PLACES: dict[str, _Place] = {
    "curve.primitive_": _data("Curve"),
    "mesh.primitive_": _data("Mesh"),
    "surface.primitive_": _data("SurfaceCurve"),
    "object.armature_add": _data("Armature"),
    "object.camera_add": _data("Camera"),
    "object.constraint_add": _Place(f"{_OBJECT}.constraints[-1]", "Constraint"),
    "object.effector_add": _Place(f"{_OBJECT}.field", "FieldSettings"),
    "object.grease_pencil_add": _data("GreasePencil"),
    "object.light_add": _data("Light"),
    "object.lightprobe_add": _data("LightProbe"),
    "object.metaball_add": _data("MetaBall"),
    "object.modifier_add": _Place(f"{_OBJECT}.modifiers[-1]", "Modifier"),
    "object.particle_system_add": _Place(f"{_OBJECT}.particle_systems[-1].settings", "ParticleSettings"),
    "object.speaker_add": _data("Speaker"),
    "object.text_add": _data("TextCurve"),
    "object.volume_add": _data("Volume"),
    "render.opengl": _Place("bpy.context.scene.render", "RenderSettings", after=False),
    "render.render": _Place("bpy.context.scene.render", "RenderSettings", after=False),
    "rigidbody.constraint_add": _Place(f"{_OBJECT}.rigid_body_constraint", "RigidBodyConstraint"),
    "rigidbody.object_add": _Place(f"{_OBJECT}.rigid_body", "RigidBodyObject"),
    "rigidbody.world_add": _Place("bpy.context.scene.rigidbody_world", "RigidBodyWorld"),
}
_NEW_OBJECT = _Place(_OBJECT, "Object")
# Operators that leave the object that they make as the active one.
_ADDING = (
    *(path for path, place in _PLACES.items() if place.expression == f"{_OBJECT}.data"),
    "object.empty_add",
    "object.effector_add",
)


def set_elsewhere(operator: Symbol, name: str, reader: BaseReader) -> str:
    """A sentence on where to set ``name``, which an operator takes no argument for; empty where that is not known."""
    if not operator.path.startswith(OPERATORS):
        return ""
    for place in _places(operator.path.removeprefix(OPERATORS)):
        if found := _member(place.cls, name, reader):
            when = "Set it on what it makes" if place.after else "Set it before"
            return f"{when}: `{place.expression}.{found}`."
    taking = reader.names.operators_taking(name)
    for part in (one.name for one in operator.parameters if operator_of_class(one.name) in taking):
        return f'Its part takes it: `{part}={{"{name}": …}}`.'
    further = [path for path in taking if path.startswith(f"{operator.path}_")]
    return f"`{further[0]}` takes it." if len(further) == 1 else ""


def _places(operator: str) -> Iterator[_Place]:
    """What an operator makes or works with: data before the object, as this has the less special settings."""
    yield from (place for beginning, place in _PLACES.items() if operator.startswith(beginning))
    if operator.startswith(_ADDING):
        yield _NEW_OBJECT


def _member(cls: str, name: str, reader: BaseReader) -> str:
    """The property of a class, or of one of its cases, that has a name or is labelled so; what all data-blocks have is
    the object's.
    """
    path = TYPES + cls
    own = (reader.member_of(one, name) for one in (path, *(case.path for case in reader.descendants(path))))
    if any(entry and _is_set(entry, cls) for entry in own):
        return name
    called = map(reader.entry, labelled(path, name, reader))
    return next((entry.name for entry in called if entry and _is_set(entry, cls)), "")


def _is_set(entry: SymbolEntry, cls: str) -> bool:
    is_own = entry.owner != ID or cls == _NEW_OBJECT.cls
    return is_own and entry.kind == "property" and not entry.is_read_only
