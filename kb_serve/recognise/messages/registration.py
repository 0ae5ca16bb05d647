"""Recognises messages of classes and properties that are registered."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_serve.recognise import message_patterns as forms

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

# Classes whose functions return something to Blender.
_REGISTERED = (
    "Operator",
    "Panel",
    "Menu",
    "UIList",
    "Gizmo",
    "GizmoGroup",
    "Node",
    "FileHandler",
    "AssetShelf",
)
_HAVING_TYPE = frozenset({"PointerProperty", "CollectionProperty"})
_OF_TYPE = "the class in `type` is not registered yet (`bpy.utils.register_class` comes first)"
_OF_ARGUMENTS = (
    "an argument is refused: a `default` of another type or length, or that is none of `items`, an unknown name, or a "
    "function with another number of arguments (`update` and `items` get `(self, context)`)"
)


class Registration:
    """Finds in one base what registration wants."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds the member of the class, or the property, that is refused."""
        for match in forms.first_matches(forms.INCOMPATIBLE, query):
            kind = match["class"].rpartition("_OT_")[1] and "Operator"
            owners = [kind] if kind else _REGISTERED
            found = (self._reader.entry(f"{TYPES}{owner}.{match['function']}") for owner in owners)
            if entry := next(filter(None, found), None):
                recognition.add(entry.path, 0.98, "error message")
                recognition.notes.append(
                    f"`{match['function']}` of `{match['class']}` must return what `{entry.path}` returns."
                )
        for match in forms.first_matches(forms.NO_PROPERTY, query):
            recognition.add(f"bpy.props.{match['kind']}", 0.98, "error message")
            recognition.notes.append(
                "The cause is the error that Blender printed before this one, on stderr: mostly that "
                f"{_OF_TYPE if match['kind'] in _HAVING_TYPE else _OF_ARGUMENTS}."
            )
        for match in forms.first_matches(forms.EXPECTED_MEMBER, query):
            if entry := self._reader.entry(f"{TYPES}{match['base']}.{match['name']}"):
                recognition.add(entry.path, 0.98, "error message")
                how = "a function of that name" if entry.kind == "function" else f"`{entry.name} = …`"
                recognition.notes.append(
                    f"The class lacks `{entry.name}`, without which it is not registered: write {how} in it."
                )
        for match in forms.first_matches(forms.NO_PARENT, query):
            recognition.add(f"{TYPES}Panel.bl_parent_id", 0.98, "error message")
            recognition.notes.append(
                f"Register the panel whose `bl_idname`, or else class name, is `{match['parent']}` first."
            )
