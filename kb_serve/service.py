"""Answers calls, whatever the transport: picks the base, queries it, and adds a note on its version."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING, Any

from kb_serve.errors import BadQuery, BaseMissing, KBServeError
from kb_serve.query_limits import LEAST_TOKENS, LONGEST_QUERY

if TYPE_CHECKING:
    from kb_build.pages.page import Page
    from kb_build.symbols.records import Symbol
    from kb_serve.answer.docs_answer import DocsAnswer
    from kb_serve.bases import Bases
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.rebuild import Upkeep


def readable(text: str) -> str:
    """A text without lone surrogates, which undecodable input leaves."""
    return text.encode(errors="replace").decode()


def checked_query(query: str) -> str:
    """The query, readable. Raises BadQuery for one that is too long."""
    if len(query) > LONGEST_QUERY:
        raise BadQuery(
            f"The query has {len(query):,} characters, more than the limit of {LONGEST_QUERY:,}. Shorten it."
        )
    return readable(query)


def answer_below(  # noqa: PLR0913 - those of a query
    note: str, base: KnowledgeBase, query: str, *, limit: int, max_tokens: int, part: int, command: str = ""
) -> DocsAnswer:
    """A base's answer to a query, below a note if there is one and room for it. Raises KBServeError."""
    if not note:
        return base.query(query, limit=limit, max_tokens=max_tokens, part=part, command=command)
    from kb_serve.answer.budget import tokens  # noqa: PLC0415 - loaded with the base

    lead = f"> {note}\n\n"
    room = max_tokens - tokens(lead) - 1
    has_room = room >= LEAST_TOKENS
    most = room if has_room else max_tokens
    answer = base.query(query, limit=limit, max_tokens=most, part=part, command=command)
    text = lead + answer.text if has_room and part == 1 else answer.text
    return replace(answer, text=text, notes=(note, *answer.notes))


class Service:
    """Answers from the bases that are built."""

    def __init__(self, bases: Bases, upkeep: Upkeep) -> None:
        self.bases = bases
        self.upkeep = upkeep

    def warm(self) -> None:
        """Loads what the first answer needs, and looks up which Blender is in use and whether it has a base."""
        _ = self.bases.in_use  # an executable takes long to say it
        self.upkeep.plan()
        with contextlib.suppress(KBServeError):
            self.upkeep.note(self.bases.pick().meta, None)

    def load_search(self) -> None:
        """Loads what the first query needs that is no name."""
        import_module("kb_serve.rank.search")

    def ask(
        self, query: str, *, blender: str | None, limit: int, max_tokens: int, part: int
    ) -> tuple[DocsAnswer, str]:
        """The answer, and the full version of the Blender that it holds for. Raises KBServeError."""
        query = checked_query(query)
        if told := self.upkeep.accept(query):
            raise BaseMissing(told)
        base, note = self.base(blender)
        answer = answer_below(note, base, query, limit=limit, max_tokens=max_tokens, part=part)
        return answer, base.meta.get("blender", "")

    def symbol(self, blender: str, path: str) -> Symbol | None:
        """The raw record of an identifier. Raises KBServeError."""
        return self.base(blender)[0].symbol(path)

    def page(self, blender: str, slug: str) -> Page | None:
        """A page, whole. Raises KBServeError."""
        return self.base(blender)[0].page(slug)

    def built(self) -> list[dict[str, Any]]:
        """The bases: for each its versions and when it was built, or why it cannot be read."""
        return [self._facts(version) for version in self.bases.built()]

    def _facts(self, version: str) -> dict[str, Any]:
        try:
            meta = self.bases.pick(version).meta
        except KBServeError as error:
            return {"version": version, "error": str(error)}
        return {"version": version, "blender": meta.get("blender", ""), "built_at": meta.get("built_at", "")}

    def base(self, blender: str | None) -> tuple[KnowledgeBase, str]:
        """The base of a version, and a note if another Blender is in use. Raises KBServeError."""
        try:
            base = self.bases.pick(blender)
        except BaseMissing as error:
            if note := self.upkeep.missing_note(blender):
                what = error.what if self.upkeep.state == "running" else str(error)
                raise BaseMissing(what, note) from error
            if error.advice and (offer := self.upkeep.offer(blender)):
                how = f"Or ask blender_docs {offer!r}: then it is fetched and built here, in the background."
                raise BaseMissing(str(error), how) from error
            raise
        return base, self.upkeep.note(base.meta, blender or self.bases.default)
