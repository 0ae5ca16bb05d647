"""Recognises messages of data that was removed while a variable still held it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import BLEND_DATA, STRUCT, TYPES
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.messages.guides import ON_FREED, add_guide

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_FREED = (
    "The variable's data was removed, freed, or moved by an undo or by adding another element: look it up again by "
    "name."
)
_NOT_MADE = (
    "`{cls}` is a class of the script's own. An operator that has ended is gone: whatever still holds its `self`, as "
    "a draw handler, a timer or another callback does, is taken away before `return {{'FINISHED'}}` or "
    "`{{'CANCELLED'}}` (`draw_handler_remove`, `event_timer_remove`). Since 4.4 an instance is also said to be "
    "removed where its class has an `__init__` that does not begin with `super().__init__(*args, **kwargs)`."
)
_PASSING = "DepsgraphObjectInstance"
_PASSED = (
    "Such an instance is there only until the loop goes on: take what is needed inside the loop "
    "(`instance.matrix_world.copy()`, `instance.object.name`); `list(depsgraph.object_instances)` keeps none."
)
_FREED_MESH = (
    "`bm.free()`, a removal (`bm.verts.remove(v)`) or an operator deleted it; `v.is_valid` tells. Keep `bm` until the "
    "work is done, and take elements anew: `bm.verts.ensure_lookup_table()`, then `bm.verts[index]`."
)


class FreedData:
    """Finds in one base what removes data."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds what removes such data, and how it is found again."""
        for match in forms.first_matches(forms.FREED, query):
            if match["type"] == _PASSING:
                recognition.notes.append(_PASSED)
                recognition.add(f"{TYPES}Depsgraph.object_instances", 0.95, "error message")
                continue
            if not match["module"] and self._reader.entry(TYPES + match["type"]) is None:
                recognition.notes.append(_NOT_MADE.format(cls=match["type"]))
                recognition.add(STRUCT, 0.95, "error message")
                continue
            recognition.notes.append(_FREED_MESH if match["module"] else _FREED)
            add_guide(ON_FREED, self._reader, recognition)
            if match["module"]:
                recognition.add("bmesh.types.BMesh.free", 0.84, "error message")
                continue
            for entry in self._reader.members(BLEND_DATA).values():
                if entry.target == match["type"] and (
                    remove := self._reader.member_of(TYPES + entry.collection, "remove")
                ):
                    recognition.add(remove.path, 0.84, "error message")
