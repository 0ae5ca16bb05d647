"""Explains Python's messages of a script's own function that Blender calls with other arguments than it takes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import HANDLERS
from kb_serve.recognise import message_patterns as forms

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_GIVEN = (
    "`{name}` is a function of the script's own. What Blender calls gets arguments: `update` and `items` of a property "
    "`(self, context)`, a handler `(scene, depsgraph)`, or the scene alone if it takes one, those of a file its path, "
    "a draw handler what the tuple in `draw_handler_add` has, a timer none. `*args` takes any."
)
_CALLED = (
    " Blender is given the function itself, `handlers.append({name})`: `{name}()` calls it at once, "
    "without arguments."
)
_HANDLED = frozenset({"scene", "filepath"})  # what handlers are mostly given
_TOLD = frozenset({"depsgraph"})  # of which something else is told


class OwnFunctions:
    """Knows from one base which functions are not a script's own."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds with which arguments Blender calls the functions that it is given."""
        for match in forms.first_matches(forms.OTHER_ARGUMENTS, query):
            name, missing = match["name"], match["missing"]
            if name.startswith("__") or missing in _TOLD or self._reader.names.by_name(name):
                continue  # of Blender, or of a class that Blender makes
            note = _GIVEN.format(name=name)
            recognition.notes.append(note + _CALLED.format(name=name) if missing else note)
            if missing in _HANDLED:
                recognition.add(HANDLERS.rstrip("."), 0.9, "error message")
            return
