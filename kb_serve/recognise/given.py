"""Says what to give where a message tells that a value of another type was given."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.reader import TYPES
from kb_serve.recognise.absent import ANY, as_written

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader
    from kb_serve.recognise.absent import Absent

_OBJECT = "Object"
_SEQUENCES = frozenset({"tuple", "list"})


def what_to_give(wanted: str, given: str, reader: BaseReader, absent: Absent) -> Iterator[str]:
    """A sentence on what to give for a type that was wanted, as the message names both; none where nothing is known."""
    cls = TYPES + wanted
    if given in {"None", "NoneType"}:
        why = absent.note(cls)
        yield f"None was given for a `{cls}`" + (f": {why}." if why else ".")
    elif given == "str" and (collection := absent.looked_up(cls)):
        yield f'Give the thing itself, not its name: `{as_written(collection)}["…"]`.'
    elif wanted == _OBJECT and reader.is_object_data(TYPES + given):
        yield f"Give the object, not its data: `obj`, whose `.data` is the `{given}`."
    elif given == _OBJECT and reader.is_object_data(cls):
        yield "Give the data of the object: `obj.data`."
    elif (wanted, given) == ("int", "float"):
        yield "Give a whole number: `int(value)`, or `round(value)`."
    elif wanted in {"int", "float"} and given in _SEQUENCES:
        yield f"Give one number, not a {given} of them."
    elif cls not in ANY and (symbol := reader.symbol(cls)) and symbol.reached and "[" not in symbol.reached:
        yield f"A `{cls}` is reached as `{symbol.reached}`."
