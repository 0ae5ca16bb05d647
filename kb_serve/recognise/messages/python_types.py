"""Explains what one of Python's own types lacks: a vector's member, or that of the thing which a text names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import CONTEXT, HANDLERS
from kb_serve.recognise.messages.absent import as_written

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.messages.absent import Absent
    from kb_serve.recognise.recognition import Recognition

_PATH_OF_FILE = (
    "Where a context is expected the code has a text: `load_pre` and `load_post` call their handlers with the file's "
    "path. Take `bpy.context.{name}` there."
)
PYTHONS = frozenset({"tuple", "list", "str", "dict", "set", "int", "float", "bool", "function", "method"})
_VECTOR = "mathutils.Vector"


class PythonTypes:
    """Finds in one base what has the member that one of Python's own types lacks."""

    def __init__(self, reader: BaseReader, absent: Absent) -> None:
        self._reader = reader
        self._absent = absent

    def explain(self, written: str, name: str, recognition: Recognition) -> None:
        """What one of Python's own types lacks: a vector's member, or that of the thing which a text names."""
        if written in {"tuple", "list"} and (entry := self._reader.entry(f"{_VECTOR}.{name}")):
            recognition.add(entry.path, 0.95, "error message")
            recognition.notes.append(
                f"A {written} has no `.{name}`; a vector has: `mathutils.Vector(value).{name}`."
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
