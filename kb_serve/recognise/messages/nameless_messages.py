"""Recognises Blender's messages that name nothing of the API.

Each row of the tables was seen in Blender: a test makes it say them all.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_serve.recognise.messages.nameless.animation import ANIMATION
from kb_serve.recognise.messages.nameless.custom_properties import CUSTOM_PROPERTIES
from kb_serve.recognise.messages.nameless.files import FILES
from kb_serve.recognise.messages.nameless.meshes import MESHES
from kb_serve.recognise.messages.nameless.message import bare_part, bare_query
from kb_serve.recognise.messages.nameless.modes import MODES
from kb_serve.recognise.messages.nameless.modifiers import MODIFIERS
from kb_serve.recognise.messages.nameless.nodes import NODES
from kb_serve.recognise.messages.nameless.objects import OBJECTS
from kb_serve.recognise.messages.nameless.python import PYTHON
from kb_serve.recognise.messages.nameless.registration import REGISTRATION
from kb_serve.recognise.messages.nameless.rendering import RENDERING
from kb_serve.recognise.messages.nameless.vectors import VECTORS

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.messages.nameless.message import NamelessMessage
    from kb_serve.recognise.recognition import Recognition

_SURE = 0.97
NAMELESS_MESSAGES = (
    *OBJECTS,
    *MESHES,
    *MODIFIERS,
    *CUSTOM_PROPERTIES,
    *PYTHON,
    *VECTORS,
    *NODES,
    *ANIMATION,
    *RENDERING,
    *REGISTRATION,
    *FILES,
    *MODES,
)
# What nearly always decides, with and without quotes, of each.
_FIRST_PARTS = tuple(
    (message.parts[0], bare_part(message.parts[0]), message) for message in NAMELESS_MESSAGES
)
_ANYWHERE = (
    (
        " not found in ()",
        "The enumeration has no values at present: they come from other data, such as the active object, whose type "
        "has some modes, or the Menu Switch that a menu is linked to.",
    ),
    (
        "expected a set, not a str",
        "An enumeration of flags takes a set of texts: `{'A'}`, `{'A', 'B'}`.",
    ),
)
# Newer Blenders say nothing more, and the code that failed may follow.
_ONE_OF_SEVERAL = re.compile(
    r"item\.attr = val:\s*(?:$|sequence expected at dimension 1|[\w.]+(?:\[[^\]]*\])?[\w.\[\]\"']* = )"
)
_NOT_ONE = (
    "One value was given where several are wanted: a vector `(x, y, z)`, a colour `(r, g, b, a)`, as many as the "
    "property has."
)


class NamelessMessages:
    """Recognises them against one base, of which they lead to symbols and pages."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds what such a message is about, with what helps."""
        bare = bare_query(query)
        for part, own, message in _FIRST_PARTS:
            is_begun = part in query or (own and own in bare)
            if is_begun and message.is_in(query) and self._is_told(message):
                for rank, path in enumerate(message.paths):
                    if "/" not in path or self._reader.manual.is_page(path):
                        recognition.add(path, _SURE - 0.03 * rank, "error message")
                recognition.notes.append(message.help)
        recognition.notes += [note for part, note in _ANYWHERE if part in query]
        if _ONE_OF_SEVERAL.search(query):
            recognition.notes.append(_NOT_ONE)
            recognition.add("bpy.props.FloatVectorProperty", _SURE, "error message")

    def _is_told(self, message: NamelessMessage) -> bool:
        """Whether what is known of a message holds in this Blender."""
        has_first = self._reader.entry(message.paths[0]) is not None
        return has_first and not (message.lacking and self._reader.entry(message.lacking))
