"""What look-ups find."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from kb_build.schema import Mark

# As numbers: a test of a flag takes a microsecond, and answers make many.
_READ_ONLY, _DEPRECATED, _UNSEEN, _GIVEN = (
    int(mark) for mark in (Mark.READ_ONLY, Mark.DEPRECATED, Mark.UNSEEN, Mark.GIVEN)
)


class SymbolEntry(NamedTuple):
    """The part of a symbol that resolving needs; the whole record is read only for answers.

    ``line`` describes it in the list of its owner's members. ``reached`` and ``lacks`` are a class's, as in its record;
    ``choices``: the stems of what its arguments and values are called, where the line does not tell them all.
    """

    path: str
    kind: str
    owner: str
    name: str
    type: str
    target: str
    collection: str
    base: str
    group: str
    label: str
    marks: int
    line: str
    reached: str
    lacks: str
    choices: str

    @property
    def head(self) -> str:
        """The line without the description: name, type, default, values, and whether it can be set."""
        return self.line.partition(" — ")[0]

    @property
    def is_read_only(self) -> bool:
        """Whether it cannot be assigned."""
        return bool(self.marks & _READ_ONLY)

    @property
    def is_deprecated(self) -> bool:
        """Whether Blender calls it deprecated."""
        return bool(self.marks & _DEPRECATED)

    @property
    def is_unseen(self) -> bool:
        """Whether its default is RNA's alone: no new instance was compared."""
        return bool(self.marks & _UNSEEN)

    @property
    def is_given(self) -> bool:
        """Whether it is a pointer that is None on all new things, and that an assignment alone fills."""
        return bool(self.marks & _GIVEN)


class PageEntry(NamedTuple):
    """A page without its text; ``parent`` is a slug."""

    slug: str
    source: str
    version: str
    title: str
    parent: str
    url: str
    summary: str
    summary_method: str


@dataclass(frozen=True, slots=True)
class Successor:
    """What takes the place of a removed symbol, since which version, and where that is written down.

    ``target`` is a path of this version; it is empty where nothing does, and ``how`` says why. Otherwise ``how`` is
    what else changes.
    """

    target: str
    how: str
    version: str
    source: str


class Creation(NamedTuple):
    """How an instance is made: the call, the function or operator that is called, and the type that it names."""

    call: str
    maker: str
    choice: str


@dataclass(frozen=True, slots=True)
class Use:
    """Lines of one of Blender's own scripts that use a symbol; ``line`` is the first one's number."""

    file: str
    line: int
    code: str


ENTRY_COLUMNS = ", ".join("grp" if field == "group" else field for field in SymbolEntry._fields)
PAGE_COLUMNS = ", ".join(PageEntry._fields)
