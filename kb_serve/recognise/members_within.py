"""Finds what a class lacks on what it points to: ``SpaceView3D.overlay`` has ``show_overlays``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.api_names import STRUCT, TYPES

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader, SymbolEntry


def members_within(owner: str, name: str, reader: BaseReader) -> list[tuple[str, SymbolEntry]]:
    """(pointer, member) for the members of that name which a class's pointers lead to: ``drawing``, ``strokes``."""
    found = {
        member: pointer.name
        for cls in reader.lineage(owner)
        if cls.path != STRUCT
        for pointer in reader.members(cls.path).values()
        if pointer.type == "pointer" and pointer.target
        for member in [reader.member_of(TYPES + pointer.target, name)]
        if member and member.owner != STRUCT
    }
    return [(found[member], member) for member in reader.heaviest(found)]


def note_on_within(pointer: str, member: SymbolEntry) -> str:
    """A sentence on a member that a class reaches by a pointer."""
    return f"Its `.{pointer}` has it: `.{pointer}.{member.name}` (`{member.path}`)."
