"""How a symbol is reached and made, since when it is there, and where the manual tells of it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import NODE, TYPES
from kb_build.symbols.flag_names import (
    EMPTY,
    EMPTY_AT_START,
    EVALUATED,
    FILLED_AT_START,
    ITERATED,
    NAMES_ITEMS,
    READ_ONLY,
    WITHOUT_ACTIVE,
    WITHOUT_AREA,
    WITHOUT_SHOWN,
)
from kb_build.symbols.flags import alike_nodes, empty_when_new, fillers, new_subscript
from kb_build.symbols.lines import default_text, item_of, of_evaluated
from kb_serve.answer.ways.makers_of_instances import told_makers
from kb_serve.answer.ways.operator_needs import calls_before

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_OPTIONAL = re.compile(r"(, )?\*, .*\)")
_ADDING = ("new", "add", "link")  # the functions of collections that do so, the likeliest first
_NONE_IN_CONTEXT = {
    WITHOUT_ACTIVE: "`None` where no object is active",
    WITHOUT_AREA: "`None` outside the areas of windows, as in a Blender without a window",
    WITHOUT_SHOWN: "`None` while the interface shows none",
}


def place_lines(symbol: Symbol, reader: BaseReader) -> Iterator[str]:
    """How to reach and to make the symbol, the version that introduced it, and its manual page."""
    if reached := reached_as(symbol, reader):
        if EVALUATED in symbol.flags:
            yield "filled on evaluated objects only: the original's stays empty, or None"
        cls = _owning_class(symbol, reader)
        yield f"reached as `{reached}`" + (_empty_before(cls, reader) if cls else "")
    elif symbol.kind == "context":
        if origin := symbol.editors:
            yield f"provided by: {', '.join(origin)}"
        yield from (text for flag, text in _NONE_IN_CONTEXT.items() if flag in symbol.flags)
    if symbol.kind == "class" and (creation := reader.makers.creations([symbol.path]).get(symbol.path)):
        calls = [*calls_before(reader, symbol.path, creation.call), creation.call]
        yield "made by " + ", then ".join(f"`{call}`" for call in calls)
    yield from told_makers(symbol, reader)
    if target := _assigned(symbol, reader):
        yield f"assign `{target}`"
    if symbol.type == "collection" and (key := _key_of(TYPES + symbol.target, reader)):
        yield f'items by index, or by their `{key}`: `{symbol.name}["…"]`'
    if symbol.trees:
        yield "node of: " + ", ".join(symbol.trees)
    elif (node := _owning_class(symbol, reader)) and _is_taken_nowhere(node, symbol, reader):
        alike = (reader.symbol(path) for path in alike_nodes(node.name))
        taken = ", ".join(f"`{other.name}`" for other in alike if other and other.trees)
        it = "it" if node.path == symbol.path else f"a `{node.name}`"
        yield f"no node tree takes {it}: `nodes.new` refuses it" + (f"; it takes {taken}" if taken else "")
    version, lacked = reader.history.arrival(symbol.path)
    if version:
        yield f"since Blender {version}" + (f" or a little before ({lacked} lacks it)" if lacked else "")
    if page := reader.manual.manual_url(symbol.path):
        yield f"manual: {page}"


def reached_as(symbol: Symbol, reader: BaseReader) -> str:
    """The expression that leads to a symbol from the context; empty where none is known."""
    cls = _owning_class(symbol, reader)
    reached = cls.reached if cls else ""
    if not reached or symbol.kind not in {"class", "property", "socket", "function"}:
        return ""
    if symbol.is_called_back:  # by Blender, not by scripts
        return ""
    last = symbol.path[len(symbol.owner) :] if symbol.kind != "class" else ""
    if symbol.kind == "socket" and (subscript := new_subscript(symbol)):
        last = f".{subscript}"
    if EVALUATED in symbol.flags:
        reached = of_evaluated(reached)
    return f"{reached}{last}" + ("(…)" if symbol.kind == "function" else "")


def _owning_class(symbol: Symbol, reader: BaseReader) -> SymbolEntry | None:
    return reader.entry(symbol.path if symbol.kind == "class" else symbol.owner)


def _key_of(cls: str, reader: BaseReader) -> str:
    """The property, not called ``name``, by whose value collections find instances of a class; empty for none."""
    if reader.member_of(cls, "name"):
        return ""
    for ancestor in reader.lineage(cls):
        for member in reader.members(ancestor.path).values():
            symbol = reader.symbol(member.path) if member.type == "string" else None
            if symbol and NAMES_ITEMS in symbol.flags:
                return member.name
    return ""


def _is_node(path: str, reader: BaseReader) -> bool:
    """Whether a class is one of nodes, below the class of all of them."""
    return path != NODE and reader.descends(path, NODE)


def _is_taken_nowhere(node: SymbolEntry, symbol: Symbol, reader: BaseReader) -> bool:
    """Whether a symbol is a class of nodes that no tree takes, or only belongs to such a one: not to a base class."""
    if node.kind != "class" or not _is_node(node.path, reader):
        return False
    record = reader.symbol(node.path)
    is_taken = record is None or bool(record.trees)
    return not is_taken and (node.path == symbol.path or not reader.subclasses(node.path))


def _empty_before(cls: SymbolEntry, reader: BaseReader) -> str:
    """What on the way to instances of a class is None, or empty, where nobody has filled it, and what fills it; the
    first first.
    """
    told: list[str] = []
    at: SymbolEntry | None = cls
    while at is not None and at.lacks and (pointer := reader.symbol(at.lacks)):
        if text := _empty_text(pointer, reader):
            told.append(text)
        owner = reader.entry(pointer.owner)
        at = owner if owner and owner.path != at.path and _leads_on(owner, at) else None
    return "".join(f"; {text}" for text in reversed(told))


def _leads_on(owner: SymbolEntry, cls: SymbolEntry) -> bool:
    """Whether the way to a class goes on from that to the owner of what it lacks."""
    return (
        bool(owner.reached)
        and len(owner.reached) < len(cls.reached)
        and cls.reached.startswith(owner.reached)
    )


def _empty_text(pointer: Symbol, reader: BaseReader) -> str:
    """That a pointer is None, or a collection empty or only read by a loop; nothing of one that the start-up file has
    filled.
    """
    if ITERATED in pointer.flags and (owner := reader.entry(pointer.owner)):
        return f"a loop gives it: `for {item_of(pointer.name)} in {owner.reached}.{pointer.name}:`"
    if absent := next((text for flag, text in _NONE_IN_CONTEXT.items() if flag in pointer.flags), ""):
        return f"`{pointer.name}` is {absent}"
    if tree := _assigned(pointer, reader):
        return f"`{pointer.name}` is {default_text(pointer)}: assign `{tree}`"
    if EMPTY_AT_START in pointer.flags:
        return f"`{pointer.name}` is empty in the start-up file"
    if EMPTY in pointer.flags and (call := _adding(pointer, reader)):
        return f"`{pointer.name}` is {default_text(pointer)}: add to it by `{call}`"
    empty = empty_when_new(pointer)
    is_there = FILLED_AT_START in pointer.flags or (empty is not None and bool(empty.made))
    return "" if is_there and not fillers(pointer) else f"`{pointer.name}` is {default_text(pointer)}"


def _adding(collection: Symbol, reader: BaseReader) -> str:
    """The shortest call that adds an element to a collection; empty where it has no function for that."""
    makers = (reader.entry(f"{TYPES}{collection.collection}.{name}") for name in _ADDING)
    maker = next(filter(None, makers), None) if collection.collection else None
    return f"{collection.name}.{_OPTIONAL.sub(')', maker.head.strip('`'))}" if maker else ""


def _assigned(symbol: Symbol, reader: BaseReader) -> str:
    """The call that makes the one kind of node tree that a pointer takes which is None on a new thing."""
    is_tree = symbol.target.endswith("NodeTree") and READ_ONLY not in symbol.flags
    if not is_tree or empty_when_new(symbol) is None:
        return ""
    target = TYPES + symbol.target
    creation = reader.makers.creations([target]).get(target)
    return creation.call if creation else ""
