"""Recognises messages of operators that nothing has registered."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS, TYPES
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.likely.corrections import is_misspelling

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_UNREGISTERED = (
    'No operator `{name}` is registered: `bpy.utils.register_class()` of the class with `bl_idname = "{name}"` did not '
    "run here. Its add-on is not enabled, its `register()` ended before with an error, or the `bl_idname` is "
    "another."
)
_REGISTERING = ("bpy.utils.register_class", f"{TYPES}Operator.bl_idname")
_MISSPELT, _OF_ADD_ON, _PERHAPS_OF_ADD_ON = 0.98, 0.98, 0.94


class UnregisteredOperators:
    """Finds in one base what such an operator may have been."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds the operator that is only misspelt, or else what registers one; what is gone is told elsewhere."""
        for match in forms.first_matches(forms.NO_OPERATOR, query):
            name = match["called"] or match["drawn"]
            path = OPERATORS + name
            module, _, last = path.rpartition(".")
            others = self._reader.members(module).values()
            meant = [entry.path for entry in others if is_misspelling(last, entry.name)]
            for operator in meant:
                recognition.add(operator, _MISSPELT, "similar name")
            if not meant and not self._reader.history.removed(path):
                # A module that Blender lacks is an add-on's; in its own, another operator may be meant.
                known = self._reader.entry(module) is not None
                self._unregistered(name, _PERHAPS_OF_ADD_ON if known else _OF_ADD_ON, recognition)

    @staticmethod
    def _unregistered(name: str, sure: float, recognition: Recognition) -> None:
        recognition.notes.append(_UNREGISTERED.format(name=name))
        for place, path in enumerate(_REGISTERING):
            recognition.add(path, sure - 0.01 * place, "error message")
