"""A line for each symbol or page that was found beside the best one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.lines import first_sentence, written
from kb_serve.answer.budget import AnswerBlock, clip
from kb_serve.answer.facts.asked_values import asked_values, unsaid
from kb_serve.answer.hits import hits_of
from kb_serve.answer.pages import said_of
from kb_serve.rank.ranked_id import RankedId

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_serve.answer.facts.asked_values import AskedValue
    from kb_serve.answer.hits import Hit
    from kb_serve.lookups.records import Creation, SymbolEntry
    from kb_serve.reader import BaseReader

NAMES, PAGES = "further names", "further pages"
_LINE_TOKENS = 60
_LONGEST_CALL = 70  # characters


class HitLines:
    """Words what was found in one base, a line each."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def further(
        self,
        hits: Sequence[Hit],
        rows: Sequence[RankedId],
        asked: Sequence[str] = (),
        first: Sequence[str] = (),
    ) -> Iterator[AnswerBlock]:
        """A line for each further hit: symbols, the ``first`` of which are given, then pages. ``asked`` are the
        question's words.
        """
        before = [*self.by_path(first)]
        further = list(zip(hits, rows, strict=True))
        self._reader.entry.load(hit.id.rpartition(".")[0] for hit in hits if hit.kind == "function")
        made = self._reader.makers.creations([hit.id for hit in hits if hit.kind == "class"])
        for title, name, are_pages in (
            ("In Python", NAMES, False),
            ("Pages", PAGES, True),
        ):
            lines = [
                f"- {self.line(hit, row)}{self._values(hit, asked)}{_made(hit.id, made.get(hit.id))}"
                for hit, row in further
                if hit.is_page == are_pages
            ]
            if lines := [*(() if are_pages else before), *lines]:
                yield AnswerBlock(f"**{title}**\n" + "\n".join(lines), name)

    def asked_members(self, hit: Hit, paths: Sequence[str]) -> Iterator[AnswerBlock]:
        """A line for each member that is asked for beside the best hit; of a class without its name. Behind a page they
        are the first of the further names.
        """
        if hit.is_page:
            return
        own = f"{hit.id}."
        lines = [*self.members(hit.id, [path.removeprefix(own) for path in paths if path.startswith(own)])]
        lines += self.by_path([path for path in paths if not path.startswith(own)])
        if lines:
            yield AnswerBlock("**Asked for**\n" + "\n".join(lines), "members asked for")

    def by_path(self, paths: Sequence[str]) -> Iterator[str]:
        """A line for each of some symbols."""
        rows = [RankedId(path, 1.0, "asked") for path in paths]
        for hit, row in zip(hits_of(rows, self._reader), rows, strict=True):
            yield f"- {self.line(hit, row)}"

    def line(self, hit: Hit, row: RankedId) -> str:
        """What a hit is, with the members that were found with it."""
        entry = None if hit.is_page else self._reader.entry(hit.id)
        if entry is not None:
            owner = f"{entry.owner}." if entry.kind != "socket" else ""
            text = (
                entry.line.partition(" — ")[2]
                if entry.kind in {"operator", "function", "class"}
                else entry.line
            )
            path = self._written(hit.id) if entry.kind == "socket" else hit.id
            name = path[len(entry.owner) + 1 :] if entry.kind == "socket" else entry.name
            if entry.kind == "operator" and text == entry.label:  # which its name says already
                text = ""
            text = text.removeprefix(f"`{name}`").strip(", ·") or self._instead_of_words(entry)
            nearest = f" — nearest: {', '.join(f'`.{name}`' for name in row.members)}" if row.members else ""
            line = clip(f"`{owner + entry.name if owner else path}` {text}", _LINE_TOKENS)
            return line + nearest + self._written_as(entry)
        page = self._reader.manual.page_entry(hit.id)
        text = first_sentence(said_of(page, self._reader)) if page else ""
        return clip(f"`{hit.id}` ({hit.title}) {text}", _LINE_TOKENS)

    def members(self, cls: str, names: Sequence[str]) -> Iterator[str]:
        """A line for each of some members of a class."""
        self._reader.entry.load(f"{cls}.{name}" for name in names)
        for name in names:
            entry = self._reader.entry(f"{cls}.{name}")
            yield f"- {entry.line if entry else f'`{name}`'}"

    def asked(self, hit: Hit, asked: Sequence[str]) -> list[AskedValue]:
        """The arguments and values of a hit that the question speaks of."""
        entry = None if not asked or hit.is_page else self._reader.entry(hit.id)
        if entry is None or not entry.choices:
            return []
        if unsaid(entry.path, entry.label, asked).isdisjoint(entry.choices.split()):
            return []
        symbol = self._reader.symbol(hit.id)
        return asked_values(symbol, asked) if symbol else []

    def _written_as(self, entry: SymbolEntry) -> str:
        """How code calls a method: its path is no code, as a class is not what has it."""
        owner = self._reader.entry(entry.owner) if entry.kind == "function" else None
        return f" — `{owner.reached}.{entry.name}(…)`" if owner is not None and owner.reached else ""

    def _values(self, hit: Hit, asked: Sequence[str]) -> str:
        values = [f"`{value.text}`" for value in self.asked(hit, asked)]
        return f" — asked for: {', '.join(values)}" if values else ""

    def _written(self, path: str) -> str:
        symbol = self._reader.symbol(path)
        return written(symbol) if symbol else path

    def _instead_of_words(self, entry: SymbolEntry) -> str:
        """What is said of a symbol without a description: its call, or how many members it has."""
        if entry.kind != "class":
            return entry.head if "(" in entry.line else ""
        members = self._reader.members(entry.path)
        label = f"{entry.label}, " if entry.label not in {"", entry.name} else ""
        return f"{label}a class with {len(members)} members"


def _made(path: str, creation: Creation | None) -> str:
    """How an instance of a class is made, if that is soon said and the class's name does not say it."""
    if creation is None or len(creation.call) > _LONGEST_CALL or path.endswith(f".{creation.choice}"):
        return ""
    return f" — made by `{creation.call}`"
