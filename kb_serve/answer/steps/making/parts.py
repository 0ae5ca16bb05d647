"""Parts of a thing that are made through what it points to: the sockets of a tree, by its interface."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_serve.answer.facts.members_in_brief import call_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import EnumItem
    from kb_serve.answer.steps.names.topic_names import TopicNames
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_MOST_CALLS = 2  # through one pointer
_VALUES = 8  # of one argument


def parts(cls: str, variable: str, names: TopicNames, reader: BaseReader) -> Iterator[str]:
    """Calls that make parts of ``variable``: ``tree.interface.new_socket(…)``. The topic's own classes are no parts."""
    for ancestor in reader.lineage(cls):
        for entry in reader.members(ancestor.path).values():
            target = f"{TYPES}{entry.target}"
            if entry.type == "pointer" and entry.is_read_only and target not in names.classes:
                for function in reader.usage.heaviest(reader.members(target).values())[:_MOST_CALLS]:
                    if function.kind == "function" and function.name.startswith("new"):
                        choices = _choices(function, cls, reader)
                        yield f"`{variable}.{entry.name}.{call_of(function)}`{choices}"


def _choices(function: SymbolEntry, cls: str, reader: BaseReader) -> str:
    """The values of a function's arguments that are a choice, of those that an instance of the class takes."""
    symbol, made = reader.symbol(function.path), reader.entry(cls)
    label = made.label.lower() if made else ""
    told: list[str] = []
    for parameter in symbol.parameters if symbol else ():
        taken = [item.identifier for item in parameter.enum_items if _is_taken(item, label)]
        if len(taken) > 1:
            values = "|".join(map(repr, taken[:_VALUES])) + ("|…" if len(taken) > _VALUES else "")
            told.append(f"`{parameter.name}={values}`")
    return f" ({', '.join(told)})" if told else ""


def _is_taken(item: EnumItem, label: str) -> bool:
    """Whether an item is taken by a new thing of this label."""
    things = item.where.deciding_things if item.where else ()
    if item.where is None or not things:
        return item.is_taken
    return (label in things) == (item.where.how == "only")
