"""Explains what one of Python's own types lacks: a vector's member, or that of the thing which a text names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import CONTEXT, HANDLERS
from kb_serve.recognise.messages.absent import as_written

if TYPE_CHECKING:
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.messages.absent import Absent
    from kb_serve.recognise.recognition import Recognition

_PATH_OF_FILE = (
    "Where a context is expected the code has a text: `load_pre` and `load_post` call their handlers with the file's "
    "path. Take `bpy.context.{name}` there."
)
PYTHONS = frozenset({"tuple", "list", "str", "dict", "set", "int", "float", "bool", "function", "method"})
_ROWS = frozenset({"tuple", "list"})
# What rows of numbers are made into, the most usual first.
_OF_NUMBERS = {
    "mathutils.Vector": "a vector",
    "mathutils.Matrix": "a matrix",
    "mathutils.Quaternion": "a quaternion",
    "mathutils.Euler": "an Euler",
    "mathutils.Color": "a color",
}


class PythonTypes:
    """Finds in one base what has the member that one of Python's own types lacks."""

    def __init__(self, reader: BaseReader, absent: Absent) -> None:
        self._reader = reader
        self._absent = absent

    def _of_numbers(self, name: str) -> SymbolEntry | None:
        """The member of that name of what rows of numbers are made into."""
        members = (self._reader.entry(f"{cls}.{name}") for cls in _OF_NUMBERS)
        return next(filter(None, members), None)

    def explain(self, written: str, name: str, recognition: Recognition) -> None:
        """What one of Python's own types lacks: a vector's member, or that of the thing which a text names."""
        if written in _ROWS and (entry := self._of_numbers(name)):
            recognition.add(entry.path, 0.95, "error message")
            called, made = _OF_NUMBERS[entry.owner], f"{entry.owner}(value).{name}"
            recognition.notes.append(
                f"A {written} has no `.{name}`; {called} has: `{made}{'()' if entry.kind == 'function' else ''}`."
            )
        elif written == "str" and self._reader.entry(f"{CONTEXT}.{name}"):
            recognition.add(f"{CONTEXT}.{name}", 0.95, "error message")
            recognition.add(f"{HANDLERS}load_post", 0.93, "error message")
            recognition.notes.append(_PATH_OF_FILE.format(name=name))
        elif written == "str" and (member := self._absent.usual(name)):
            recognition.add(member.path, 0.95, "error message")
            if collection := self._absent.looked_up(member.owner):
                recognition.add(collection, 0.93, "error message")
                recognition.notes.append(
                    f'The text is only the name of a thing, which is `{as_written(collection)}["…"]`.'
                )
