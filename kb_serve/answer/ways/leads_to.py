"""What a pointer leads to: the settings, and the other members, of the class that it points to."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import ID, STRUCT, TYPES
from kb_serve.answer.budget import AnswerBlock
from kb_serve.answer.facts.members_in_brief import MOST_SETTINGS, settings_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_OF_DATA_BLOCK = 4  # settings of what has a page of its own in any search
_OTHERS = 6  # collections, pointers and functions
_OF_ALL = frozenset({ID, STRUCT})
_LEAST = 1.0  # weight of one that scripts use


def leads_to(pointer: Symbol, reader: BaseReader) -> Iterator[AnswerBlock]:
    """The heaviest settings of what a pointer leads to, with their defaults, and the names of its other members, those
    first of which one is the heaviest; none where the base says nothing of them.
    """
    cls = f"{TYPES}{pointer.target}"
    if cls == ID:  # any data-block
        return
    most = _OF_DATA_BLOCK if reader.descends(cls, ID) else MOST_SETTINGS
    settings = settings_of(cls, reader, most)
    bases = [base.path for base in reader.lineage(cls) if base.path not in _OF_ALL]
    members = reader.usage.heaviest(entry for base in bases for entry in reader.members(base).values())
    others = [entry for entry in members if _is_other(entry) and f"`{entry.name}`" not in settings]
    named = reader.usage.heaviest(others, _LEAST)[:_OTHERS]
    names = ", ".join(f"`.{one.name}()`" if one.kind == "function" else f"`.{one.name}`" for one in named)
    told = [names, settings] if named and members[0] == named[0] else [settings, names]
    if text := "; ".join(filter(None, told)):
        yield AnswerBlock(f"**Leads to** `{pointer.target}`: {text}", "what it leads to")


def _is_other(entry: SymbolEntry) -> bool:
    """Whether a member is no setting, nor for Blender's own use."""
    is_part = entry.kind == "function" or entry.type in {"collection", "pointer"}
    return is_part and not entry.name.startswith("bl_")
