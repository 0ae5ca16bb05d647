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
_OF_WHAT_IT_HOLDS = (
    "A {written} has no `.{name}`, but what is in it may have (`{path}`): `things[0].{called}`, or `for thing in "
    "things:` and `thing.{called}`."
)
_ONE_VALUE = (
    "What stands before `.{name}` is one value already, of type `{written}`: take `.{name}` of what it was read from, "
    "or leave it out."
)
PYTHONS = frozenset({"tuple", "list", "str", "dict", "set", "int", "float", "bool", "function", "method"})
_ROWS = frozenset({"tuple", "list"})
_SINGLE = frozenset({"int", "float", "bool"})
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
        elif written in _ROWS and not hasattr(dict, name) and (member := self._absent.usual(name)):
            recognition.add(member.path, 0.95, "error message")
            called = f"{name}(…)" if member.kind == "function" else name
            recognition.notes.append(
                _OF_WHAT_IT_HOLDS.format(written=written, name=name, path=member.path, called=called)
            )
        elif written in _SINGLE:
            if member := self._of_numbers(name) or self._absent.usual(name):
                recognition.add(member.path, 0.95, "error message")
            recognition.notes.append(_ONE_VALUE.format(name=name, written=written))
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
