"""What the data of another type of object has by a name: ``vertices``, which a Camera lacks, is a mesh's.

Scripts that go through all objects ask each for what only those of one type have.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import MissingName

_MOST = 3  # types; what the data of more have tells none
_NOTE = (
    "Objects of another type have `{name}` in their data ({owners}): test `{test}` before. This one's type is "
    "'{own}'."
)


class DataOfOthers(NamedTuple):
    """The members of that name, the most used first, and what to do."""

    paths: tuple[str, ...]
    note: str


def data_of_others(missing: MissingName, reader: BaseReader) -> DataOfOthers | None:
    """What only a few other types of objects have in their data by a name which an object's data lacks."""
    own = reader.object_type(missing.owner)
    entries = [
        entry
        for entry in reader.names.by_name(missing.name)
        if own and entry.kind in {"property", "function"}
    ]
    types = {entry.path: kind for entry in entries if (kind := reader.object_type(entry.owner))}
    if own in types.values() or not 0 < len({*types.values()}) <= _MOST:
        return None
    used = [entry.path for entry in reader.usage.heaviest(entries) if entry.path in types]
    first = {types[path]: path for path in reversed(used)}
    kinds = sorted(first, key=lambda kind: used.index(first[kind]))
    owners = " or ".join(f"`{reader.object_data[kind]}`" for kind in kinds)
    test = f"obj.type == '{kinds[0]}'" if len(kinds) == 1 else f"obj.type in ({', '.join(map(repr, kinds))})"
    note = _NOTE.format(name=missing.name, owners=owners, test=test, own=own)
    return DataOfOthers(tuple(map(first.__getitem__, kinds)), note)
