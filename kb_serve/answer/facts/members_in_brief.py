"""How steps write the members of classes."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import ID, TYPES
from kb_build.symbols.lines import SET

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

MOST_SETTINGS = 10
_MOST_INPUTS = 8
_LEAST = 1.0  # weight of a setting that somebody uses
_NONE = " = None"
_INPUT = re.compile(r'`(inputs\[".+?"\])` · .*?( = .*)')
_ENDS = re.compile("[12]$")
_PLAIN = ("name", "index")  # every thing has them
_DISPLAY = "Viewport Display"  # the section of the manual on what no render shows
_OF_DISPLAY = "; of its display in the viewport alone: "
_MACHINERY = {
    "bl_rna_get_subclass",
    "bl_rna_get_subclass_py",
    "bl_system_properties_get",
    "input_template",
    "output_template",
    "is_registered_node_type",
}


def settings_of(cls: str, reader: BaseReader, most: int = MOST_SETTINGS) -> str:
    """The heaviest settings of a class, each with its default and first values; empty for a class without any.

    What is given to it, a data-block where a new one has none, counts as a setting. Those of its display in the
    viewport come last, and are said to be that, where it has others.
    """
    entries, parts = _heaviest_settings(cls, reader)
    entries = entries[:most]
    displayed = [entry for entry in entries if _is_of_display(entry, reader)]
    others = [entry for entry in entries if entry not in displayed]
    told = [_in_words(each, parts) for each in (others, displayed)]
    return _OF_DISPLAY.join(filter(None, told))


def own_settings(cls: str, most: int, reader: BaseReader) -> str:
    """The heaviest settings that a class itself has, and that count at all, each as above; empty for none."""
    entries, _ = _heaviest_settings(cls, reader)
    own = reader.usage.heaviest((entry for entry in entries if entry.owner == cls), _LEAST)
    return _in_words(own[:most], {})


def _in_words(entries: Iterable[SymbolEntry], parts: Mapping[str, SymbolEntry]) -> str:
    told: list[str] = []
    for entry in entries:
        told.append(_short(entry))
        if part := parts.get(entry.name):
            told.append(f"`{part.name}` (after `{entry.name}`){_NONE} ({part.target})")
    return ", ".join(told)


def _is_of_display(entry: SymbolEntry, reader: BaseReader) -> bool:
    """Whether the manual explains a setting where it explains how a thing looks in the viewport alone."""
    passage = reader.manual.passage(entry.path)
    page = reader.manual.page(passage[0]) if passage else None
    return page is not None and passage is not None and page.sections[passage[1]].title == _DISPLAY


def inputs_of(node: str, reader: BaseReader) -> str:
    """The heaviest inputs of a class of nodes that its name alone reaches, each with its default; empty for none."""
    known = {
        entry: match for entry in reader.members(node).values() if (match := _INPUT.fullmatch(entry.head))
    }
    heaviest = reader.usage.heaviest(known)[:_MOST_INPUTS]
    return ", ".join(f"`{known[entry][1]}.default_value`{known[entry][2]}" for entry in heaviest)


def are_settings_seen(cls: str, reader: BaseReader) -> bool:
    """Whether the defaults of a class's heaviest settings are those of instances that could be made."""
    entries, _ = _heaviest_settings(cls, reader)
    return not any(entry.is_unseen for entry in entries)


def _heaviest_settings(cls: str, reader: BaseReader) -> tuple[list[SymbolEntry], dict[str, SymbolEntry]]:
    """The heaviest settings of a class, and by their names the parts that must be set along with them."""
    entries = [
        entry
        for entry in reader.members(cls).values()
        if entry.kind == "property"
        and entry.name not in _PLAIN
        and (_is_given(entry, reader) or entry.type not in {"pointer", "collection"})
        and not (entry.is_read_only or entry.is_deprecated)
    ]
    parts = {
        entry.name: part
        for entry in entries
        if entry.type == "pointer" and (part := part_given_with(entry, reader))
    }
    # What only stores which part it is counts for nothing beside that.
    stored = tuple(f"{part.name}_" for part in parts.values())
    entries = [entry for entry in entries if not (stored and entry.name.startswith(stored))]
    heaviest = reader.usage.heaviest(entries)
    # What a thing is between comes first, without which it does nothing: ``object1`` and ``object2``.
    ends = sorted(
        (entry for entry in heaviest if entry.type == "pointer" and _ENDS.search(entry.name)),
        key=lambda entry: entry.name,
    )
    first = [*ends, *heaviest] if len(ends) > 1 else heaviest
    return [*dict.fromkeys(first)][:MOST_SETTINGS], parts


def part_given_with(pointer: SymbolEntry, reader: BaseReader) -> SymbolEntry | None:
    """The pointer that must be set along with another, to a part of what that leads to, which is no data-block of its
    own: the slot of an action, without which the action does nothing there. None where a thing is used as a whole.
    """
    parts = {
        f"{TYPES}{entry.target}"
        for entry in reader.members(f"{TYPES}{pointer.target}").values()
        if entry.type == "collection" and not reader.descends(f"{TYPES}{entry.target}", ID)
    }
    members = reader.members(pointer.owner).values() if parts else ()
    fitting = (
        entry
        for entry in members
        if entry.type == "pointer"
        and entry.name.startswith(f"{pointer.name}_")
        and f"{TYPES}{entry.target}" in parts
        and not entry.is_read_only
    )
    return next(fitting, None)


def _is_given(entry: SymbolEntry, reader: BaseReader) -> bool:
    """Whether a property takes a data-block, and has none on a new instance."""
    return entry.is_given and reader.descends(f"{TYPES}{entry.target}", ID)


def is_machinery(entry: SymbolEntry) -> bool:
    """Whether a member is one that every class has, for Blender's own use, or a class within a class."""
    return entry.kind == "class" or entry.name in _MACHINERY


def call_of(function: SymbolEntry) -> str:
    """A call as it can be written: without ``self``, and without the marks of how arguments are given."""
    call = function.line.partition("`")[2].partition("`")[0]
    return call.replace("(self, ", "(").replace("*, ", "").replace(", /", "")


def _short(entry: SymbolEntry) -> str:
    """A property with its default and its first values, without its type (quality = 5); of a pointer its target."""
    if entry.type == "pointer":
        return f"`{entry.name}`{_NONE} ({entry.target})"
    name, _, rest = entry.head.partition(" ")
    rest = rest.removeprefix(SET).removeprefix(entry.type).strip()
    return f"{name} {rest.partition('] ')[2] if rest.startswith('[') else rest}".strip()
