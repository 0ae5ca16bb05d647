"""Explains messages of elements that a collection, or of custom properties that a thing, does not have by a name."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import COLLECTION, STRUCT, TYPES
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.removed.newer_nodes import tell_of_the_newer_node
from kb_serve.recognise.resolving.subscripts import CustomProperties

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.messages.former_sockets import FormerSockets
    from kb_serve.recognise.recognition import Recognition

_OF_COLLECTIONS = "bpy_prop_collection"
_OF_PROPERTIES = (f"{STRUCT}.get", f"{TYPES}ID.bl_system_properties_get")  # where they are read

_LOOKED_INTO = r"""\.(\w+)\[['"]{}['"]\]"""
_EDIT_BONES = re.compile(r"\bedit_bones\b")
_IN_EDIT_MODE = (
    "`edit_bones` are empty unless the armature is in Edit Mode: make its object active, then "
    "`bpy.ops.object.mode_set(mode='EDIT')`."
)


class Keys:
    """Finds in one base what a key may have meant."""

    def __init__(self, reader: BaseReader, sockets: FormerSockets) -> None:
        self._reader = reader
        self._sockets = sockets

    def explain(self, query: str, recognition: Recognition) -> None:
        """Adds notes on each key, and a socket that had it as its name in another version."""
        for match in forms.first_matches(forms.NO_KEY, query):
            self._key(match["on"] or _OF_COLLECTIONS, match["name"], query, recognition)

    def _key(self, collection: str, name: str, query: str, recognition: Recognition) -> None:
        """A collection without such an element; it may be a socket's name in another version."""
        if collection == _OF_COLLECTIONS:
            recognition.notes.append(
                f'The collection has no element `{name}`; `.get("{name}")` returns None instead of an error, '
                "and `.keys()` tells which there are."
            )
            if _EDIT_BONES.search(query):
                recognition.notes.append(_IN_EDIT_MODE)
            # What was looked into is there.
            within = re.findall(_LOOKED_INTO.format(re.escape(name)), query)
            gone = [one for one in recognition.removed if one.path.rpartition(".")[2] in within]
            recognition.removed = [one for one in recognition.removed if one not in gone]
        if recognition.removed or any(match.sure >= 0.9 for match in recognition.matches):
            return
        if collection != _OF_COLLECTIONS:
            recognition.notes.append(
                f'There is no custom property `{name}`: assigning makes it, and `.get("{name}")` returns None instead '
                f"of an error. {CustomProperties(self._reader).on_registered(name)}".rstrip()
            )
            for rank, path in enumerate(_OF_PROPERTIES):
                recognition.add(path, 0.9 - 0.01 * rank, "error message")
            return
        tell_of_the_newer_node(name, self._reader, recognition)
        still_taken = self._sockets.explain(name, query, recognition)
        if not still_taken and not recognition.removed:
            recognition.add(f"{COLLECTION}.get", 0.9, "error message")
