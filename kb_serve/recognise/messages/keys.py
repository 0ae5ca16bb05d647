"""Explains messages of elements that a collection, or of custom properties that a thing, does not have by a name."""

from __future__ import annotations

import re
from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import COLLECTION, STRUCT, TYPES
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.chains.subscripts import CustomProperties
from kb_serve.recognise.messages.guides import EXTENSIONS
from kb_serve.recognise.messages.labelled_nodes import sockets_of_labelled_nodes
from kb_serve.recognise.messages.of_older import of_older
from kb_serve.recognise.messages.parts_of_nodes import (
    nodes_called,
    on_called,
    on_setting,
    sockets_by_setting,
)
from kb_serve.recognise.named.names_of_new import NamesOfNew
from kb_serve.recognise.named.newer_nodes import tell_of_the_newer_node

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.messages.former_sockets import FormerSockets
    from kb_serve.recognise.recognition import Recognition

_OF_COLLECTIONS = "bpy_prop_collection"
_OF_PROPERTIES = (f"{STRUCT}.get", f"{TYPES}ID.bl_system_properties_get")  # where they are read

_LINKING = f"{TYPES}NodeLinks.new"
_FEW = 3
_LOOKED_INTO = r"""\.(\w+)\[['"]{}['"]\]"""
_EDIT_BONES = re.compile(r"\bedit_bones\b")
_IN_EDIT_MODE = (
    "`edit_bones` are empty unless the armature is in Edit Mode: make its object active, then "
    "`bpy.ops.object.mode_set(mode='EDIT')`."
)
SLOTTED = f"{TYPES}AnimData.action_slot"  # since actions have slots
KEY_OF_SLOTS = (
    'The key of a slot is its `identifier`, two letters for the type of data and the name: `action.slots["OBCube"]`, '
    "for a slot that is shown as Cube."
)
_SLOTS = re.compile(r"(?<!\w)slots\[")
_MODIFIERS = re.compile(r"\bmodifiers\[")
_NO_MODIFIER = (
    "The object has no modifier of that name: keep what `modifiers.new(…)` returns, or find it by its type, "
    "`next((m for m in obj.modifiers if m.type == 'NODES'), None)`."
)
_ADDONS = re.compile(r"\baddons\[")
_OF_ADDONS = (
    "`addons` has the add-ons that are enabled, each by the name of its module; that of an extension is "
    "`bl_ext.repository.name`. Its own files find it by `context.preferences.addons[__package__]`, an add-on of one "
    "file by `[__name__]`; the `bl_idname` of the `AddonPreferences` is the same."
)


# Of a node that is called after the inputs or the outputs of a group.
_GROUP_SOCKETS = re.compile(
    r"\b(?:gin|gout|\w*group_?(?:in|out)\w*|(?:n|node|g)_?(?:in|out)(?:put)?)\.(?:in|out)puts\[",
    re.IGNORECASE,
)
_OF_GROUP = (
    "The sockets of a Group Input and a Group Output are those of the tree's interface: "
    "`node_tree.interface.new_socket(\"Radius\", in_out='INPUT', socket_type='NodeSocketFloat')` makes one of each."
)
_KEYMAP_ITEMS = re.compile(r"\bkeymap_items\[")
_OF_KEYMAP = (
    "The keymaps that Blender brings have items only in a Blender with a window. Add-ons keep their own, which "
    "`keymap_items.new(…)` returns; those of the user are in `keyconfigs.user`."
)


# What has a name of its own when it is new → what it is, and the operator that adds one.
_HOLDERS = {
    "modifiers": ("modifier", "bpy.ops.object.modifier_add"),
    "constraints": ("constraint", "bpy.ops.object.constraint_add"),
}


class Keys:
    """Finds in one base what a key may have meant."""

    def __init__(self, reader: BaseReader, sockets: FormerSockets) -> None:
        self._reader = reader
        self._sockets = sockets
        self._names_of_new = NamesOfNew(reader)

    def explain(self, query: str, recognition: Recognition) -> None:
        """Adds notes on each key, and a socket that had it as its name in another version."""
        for match in forms.first_matches(forms.NO_KEY, query):
            self._key(match["on"] or _OF_COLLECTIONS, match["name"], query, recognition)

    @cached_property
    def _of_collections(self) -> tuple[tuple[re.Pattern[str], str], ...]:
        """What is said of a collection that was asked for a key, by how it is written."""
        told = [(_EDIT_BONES, _IN_EDIT_MODE)]
        if self._reader.entry(SLOTTED):
            told.append((_SLOTS, KEY_OF_SLOTS))
        if self._reader.entry(EXTENSIONS):
            told.append((_ADDONS, _OF_ADDONS))
        if self._reader.entry(f"{TYPES}NodeTreeInterface.new_socket"):
            told.append((_GROUP_SOCKETS, _OF_GROUP))
        told.append((_KEYMAP_ITEMS, _OF_KEYMAP))
        return tuple(told)

    def _key(self, collection: str, name: str, query: str, recognition: Recognition) -> None:
        """A collection without such an element; it may be a socket's name in another version."""
        if collection == _OF_COLLECTIONS:
            recognition.notes.append(
                f'The collection has no element `{name}`; `.get("{name}")` returns None instead of an error, '
                "and `.keys()` tells which there are."
            )
            recognition.notes += (told for asked, told in self._of_collections if asked.search(query))
            if _MODIFIERS.search(query):
                recognition.notes.append(_NO_MODIFIER)
            if any(one.written == name for one in recognition.corrections):  # a key is no name of Blender's
                recognition.corrections = [one for one in recognition.corrections if one.written != name]
                recognition.matches = [match for match in recognition.matches if match.why != "correction"]
            # What was looked into is there.
            within = re.findall(_LOOKED_INTO.format(re.escape(name)), query)
            gone = [one for one in recognition.removed if one.path.rpartition(".")[2] in within]
            recognition.removed = [one for one in recognition.removed if one not in gone]
            if not self._as_new(name, query, recognition) and not any(held in query for held in _HOLDERS):
                self._as_node(name, query, recognition)
        for rank, path in enumerate(sockets_of_labelled_nodes(name, query, self._reader)):
            recognition.add(path, 0.98 - 0.01 * rank, "error message")
        there = [match.id for match in recognition.matches if match.id.endswith(f'["{name}"]')]
        recognition.notes += filter(None, (of_older(path, self._reader) for path in there[:1]))
        sockets = sockets_by_setting(name, self._reader)
        recognition.notes += on_setting([one for one in sockets if one.path in there])
        if collection == _OF_COLLECTIONS:
            tell_of_the_newer_node(name, self._reader, recognition)
        # Sockets are mostly asked for to be linked.
        sure = {match.id for match in recognition.matches if match.sure >= 0.9} - {_LINKING}
        if recognition.removed or sure:
            return
        if collection != _OF_COLLECTIONS:
            recognition.notes.append(
                f'There is no custom property `{name}`: assigning makes it, and `.get("{name}")` returns None instead '
                f"of an error. {CustomProperties(self._reader).on_registered(name)}".rstrip()
            )
            for rank, path in enumerate(_OF_PROPERTIES):
                recognition.add(path, 0.9 - 0.01 * rank, "error message")
            return
        still_taken = self._sockets.explain(name, query, recognition)
        if not still_taken and not recognition.removed:
            recognition.add(f"{COLLECTION}.get", 0.9, "error message")
            _add_hidden(sockets[:_FEW], recognition)

    def _as_node(self, name: str, query: str, recognition: Recognition) -> None:
        """Adds the nodes that are called so while they are new."""
        nodes = nodes_called(name, query, self._reader)
        recognition.notes += on_called(nodes, self._reader)
        for rank, node in enumerate(nodes[:_FEW]):
            recognition.add(node.path, 0.96 - 0.01 * rank, "error message")

    def _as_new(self, name: str, query: str, recognition: Recognition) -> bool:
        """Adds what a modifier or a constraint is called that nobody gave a name; whether a key may mean one."""
        is_told = False
        for holder, (what, adds) in _HOLDERS.items():
            meant = self._names_of_new.meant(holder, name)
            if meant is None or any(other in query for other in _HOLDERS.keys() - {holder}):
                continue
            recognition.notes.append(
                f'A {what} of type {meant.choice!r} is called "{meant.name}" where it gets no name, as by '
                f"`{adds}(type={meant.choice!r})`. Better keep what makes it: `{holder[:-1]} = "
                f"obj.{holder}.new(…)`."
            )
            recognition.add(f"{TYPES}Object.{holder}", 0.95, "error message")
            is_told = True
        return is_told


def _add_hidden(sockets: Sequence[Symbol], recognition: Recognition) -> None:
    """Adds sockets that nodes have only with some setting."""
    recognition.notes += on_setting(sockets)
    for rank, socket in enumerate(sockets):
        recognition.add(socket.path, 0.96 - 0.01 * rank, "error message")
