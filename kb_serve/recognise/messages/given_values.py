"""Recognises messages of values of another type than is wanted: what to give."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.likely.likely_values import item_called
from kb_serve.recognise.messages.absent import ANY, as_written

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.messages.absent import Absent
    from kb_serve.recognise.recognition import Recognition

_OBJECT = "Object"
_ANY = "AnyType"
_NOTHING_GIVEN = (
    "`{argument}` is None here: what is to be shown is not there, as an object without a material, or no active "
    "object. Test it before: `if mat: layout.prop(mat, …)`."
)
_NUMBERS = frozenset({"int", "float"})
_FRAME = "frame"
_SEQUENCES = frozenset({"tuple", "list"})
_KIND = "_type"  # at the end of the name of what decides which class a pointer takes


class GivenValues:
    """Finds in one base what to give instead."""

    def __init__(self, reader: BaseReader, absent: Absent) -> None:
        self._reader = reader
        self._absent = absent

    def recognise(self, query: str, recognition: Recognition) -> None:
        """What to give in place of a value of another type."""
        for match in forms.first_matches(forms.GIVEN, query):
            if forms.OF_CLASSES in query:  # whose attributes are told of elsewhere
                continue
            wanted, given = match["wanted"] or match["of"], match["given"] or match["none"]
            if given == "None" and wanted == _ANY and (argument := forms.IN_ARGUMENT.search(query)):
                recognition.notes.append(_NOTHING_GIVEN.format(argument=argument["name"]))
                continue
            setting = self._deciding(query, given)
            recognition.notes += [setting] if setting else self._what_to_give(wanted, given)

    def _deciding(self, query: str, given: str) -> str:
        """What to set first so that a pointer takes what was given, where another setting decides it: ``id_type`` which
        class ``id`` takes. Empty where none does.
        """
        for match in forms.first_matches(forms.WRONG_TYPE, query):
            path = f"{TYPES}{match['path']}"
            pointer, kinds = self._reader.symbol(path), self._reader.symbol(path + _KIND)
            if not pointer or not kinds or not self._reader.descends(TYPES + given, TYPES + pointer.target):
                continue
            if kind := item_called(kinds, [given]):
                setting = f"{kinds.name} = {kind!r}"
                return f"Set `{setting}` before `{pointer.name}`: it decides which class that takes."
        return ""

    def _what_to_give(self, wanted: str, given: str) -> Iterator[str]:
        """A sentence on what to give for a type that was wanted, as the message names both; none where nothing is
        known.
        """
        cls = TYPES + wanted
        if given in {"None", "NoneType"}:
            why = self._absent.note(cls)
            yield f"None was given for a `{cls}`" + (f": {why}." if why else ".")
        elif given == "str" and (collection := self._absent.looked_up(cls)):
            yield f'Give the thing itself, not its name: `{as_written(collection)}["…"]`.'
        elif wanted == _OBJECT and self._reader.is_object_data(TYPES + given):
            yield f"Give the object, not its data: `obj`, whose `.data` is the `{given}`."
        elif given == _OBJECT and self._reader.is_object_data(cls):
            yield "Give the data of the object: `obj.data`."
        elif wanted == "string":
            path = given.endswith("Path")
            yield "Give a text: `str(path)`." if path else "Give a text: `str(value)`."
        elif (wanted, given) == ("int", "float"):
            yield "Give a whole number: `int(value)`, or `round(value)`."
        elif wanted in _NUMBERS and given == "str":
            yield f"Give a number, not a text: `{wanted}(value)`."
        elif wanted == "int" and self._reader.member_of(f"{TYPES}{given}", f"{_FRAME}_number"):
            yield f"Give the number: `{_FRAME}.{_FRAME}_number`."
        elif wanted in _NUMBERS and given in _SEQUENCES:
            yield f"Give one number, not a {given} of them."
        elif (
            cls not in ANY
            and (symbol := self._reader.symbol(cls))
            and symbol.reached
            and "[" not in symbol.reached
        ):
            yield f"A `{cls}` is reached as `{symbol.reached}`."
