"""Composes the answer to a query: within a token budget, in parts."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

from kb_build.records import PAGE_SOURCES
from kb_serve.answer.budget import AnswerBlock, clip, paginate, tokens
from kb_serve.answer.render import MarkdownRenderer, first_sentence
from kb_serve.answer.topic_overview import Topics
from kb_serve.errors import BadQuery
from kb_serve.rank.merging import QueryRanker, RankedId, Ranking

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_serve.reader import BaseReader

AnswerKind = Literal["schema", "page", "candidates", "none"]
LIMIT = 8
MAX_LIMIT = 50
MAX_TOKENS = 1_500
LEAST_TOKENS = 150
_FOOTER_TOKENS = 70
_ASKED_TOKENS = 20
_LINE_TOKENS = 60
_LONGEST_WORD = 100  # no name of Blender's has as many letters
_LONG_WORD = re.compile(rf"(\w{{{_LONGEST_WORD}}})\w+")


@dataclass(frozen=True, slots=True)
class Hit:
    """A symbol or page that the answer is about. ``id`` is a symbol path or a page slug."""

    id: str
    kind: str
    title: str
    score: float
    url: str = ""


@dataclass(frozen=True, slots=True)
class DocsAnswer:
    """What ``blender_docs`` returns. ``text`` is Markdown: part ``part`` of ``parts``, within the token budget."""

    kind: AnswerKind
    text: str
    hits: tuple[Hit, ...] = ()
    notes: tuple[str, ...] = ()
    part: int = 1
    parts: int = 1


@dataclass(frozen=True, slots=True)
class _Draft:
    """The whole answer, before it is cut into parts."""

    kind: AnswerKind
    hits: tuple[Hit, ...]
    notes: tuple[str, ...]
    blocks: tuple[AnswerBlock, ...]


class AnswerComposer:
    """Answers queries from one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._ranker = QueryRanker(reader)
        self._renderer = MarkdownRenderer(reader)
        self._topics = Topics(reader)
        self._draft = lru_cache(maxsize=256)(self._make_draft)

    def answer(self, query: str, limit: int, max_tokens: int, part: int) -> DocsAnswer:
        """Answers a query. Raises BadQuery for an empty one, a wrong limit, or a part that does not exist."""
        # No base holds lone surrogates.
        text = " ".join(query.encode(errors="ignore").decode().replace("\0", " ").split())
        text = _LONG_WORD.sub(r"\1", text)
        if not text:
            raise BadQuery(
                "The query is empty. Send a name (ClothSettings.quality), or say what you want to do."
            )
        if limit < 1 or part < 1:
            raise BadQuery(f"limit and part must be at least 1 (they are limit={limit}, part={part}).")
        if max_tokens < LEAST_TOKENS:
            raise BadQuery(
                f"max_tokens={max_tokens} is too small for an answer. Set it to {LEAST_TOKENS} or more."
            )
        draft = self._draft(text, min(limit, MAX_LIMIT))
        return _paged(text, draft, max_tokens, part)

    def _make_draft(self, text: str, limit: int) -> _Draft:
        ranking = self._ranker.rank(text, limit)
        topic = "" if self._reader.entry(text) else self._topics.find(text)
        if topic:
            return self._overview(topic, ranking, limit)
        hits = tuple(self._hit(row) for row in ranking.ranked[:limit])
        notes = (*ranking.notes, *self._source_notes(ranking, hits))
        if not hits:
            text = "Nothing in this knowledge base matches the query. Try other words, or a name as Blender writes it."
            known = AnswerBlock("" if ranking.recognition.removed else text)  # of those, the notes say it all
            return _Draft("none", (), notes, (known,))
        if ranking.named:
            blocks = tuple(self._whole(hits[0], ranking.ranked[0])) + self._others(hits[1:])
            return _Draft("page" if _is_page(hits[0]) else "schema", hits, notes, blocks)
        blocks = (*self._excerpt(ranking, hits[0]), *self._others(hits[1:]))
        return _Draft("candidates", hits, notes, blocks)

    def _source_notes(self, ranking: Ranking, hits: Sequence[Hit]) -> Iterator[str]:
        """Notes on the documentation behind the answer: pages of other versions, missing sources."""
        meta = self._reader.meta
        minor = meta.get("minor", "")
        pages = [page for hit in hits if _is_page(hit) and (page := self._reader.page_entry(hit.id))]
        for version in sorted({page.version for page in pages} - {minor, ""}):
            yield f"These pages are from the documentation of Blender {version}, not {minor}."
        missing = [row["role"] for row in json.loads(meta.get("missing", "[]"))]
        if missing and not ranking.named:
            yield f"This base was built without the {' and the '.join(missing)}; `simworlds kb info` says why."

    def _hit(self, row: RankedId) -> Hit:
        score = round(row.score, 3)
        page = self._reader.page_entry(row.id)
        if page:
            url = page.url + (f"#{row.anchor}" if row.anchor else "")
            return Hit(row.id, page.source, page.title, score, url)
        entry = self._reader.entry(row.id)
        if entry is None:
            return Hit(row.id, "unknown", row.id, score)
        return Hit(row.id, entry.kind, entry.label or entry.name, score, self._renderer.manual_page(row.id))

    # The text

    def _whole(self, hit: Hit, row: RankedId) -> Iterator[AnswerBlock]:
        symbol = self._reader.symbol(hit.id)
        if symbol is not None:
            yield from self._renderer.symbol(symbol)
        else:
            yield from self._renderer.page(hit.id, row.anchor)

    def _excerpt(self, ranking: Ranking, hit: Hit) -> Iterator[AnswerBlock]:
        """The beginning of the best hit: its description, or the heading and the section that matches."""
        first = ranking.ranked[0]
        yield from list(self._whole(hit, first))[:2]

    def _others(self, hits: Sequence[Hit]) -> tuple[AnswerBlock, ...]:
        if not hits:
            return ()
        lines = [f"- {self._line(hit)}" for hit in hits]
        return (AnswerBlock("**Also**\n" + "\n".join(lines), "further candidates"),)

    def _line(self, hit: Hit) -> str:
        entry = None if _is_page(hit) else self._reader.entry(hit.id)
        if entry is not None:
            owner = f"{entry.owner}." if entry.kind != "socket" else ""
            text = (
                entry.line.partition(" — ")[2]
                if entry.kind in {"operator", "function", "class"}
                else entry.line
            )
            text = text.removeprefix(f"`{entry.name}`").strip()
            return clip(f"`{owner + entry.name if owner else hit.id}` {text}", _LINE_TOKENS)
        page = self._reader.page_entry(hit.id)
        text = first_sentence(page.summary) if page else ""
        return clip(f"`{hit.id}` ({hit.title}) {text}", _LINE_TOKENS)

    def _overview(self, topic: str, ranking: Ranking, limit: int) -> _Draft:
        overview = self._topics.overview(topic)
        ids = dict.fromkeys((topic, *overview.members, *(row.id for row in ranking.ranked)))
        hits = tuple(self._hit(RankedId(i, 1.0 - 0.02 * n, "topic")) for n, i in enumerate(list(ids)[:limit]))
        return _Draft("page", hits, tuple(self._source_notes(ranking, hits)), overview.blocks)


def _is_page(hit: Hit) -> bool:
    return hit.kind in PAGE_SOURCES


def _paged(query: str, draft: _Draft, max_tokens: int, part: int) -> DocsAnswer:
    """Cuts a draft into parts, and adds to each what is left and how to get it. Raises BadQuery."""
    notes = clip("\n".join(f"> {note}" for note in draft.notes), max_tokens // 3)
    room = max_tokens - _FOOTER_TOKENS - (tokens(notes) + 1 if notes else 0)
    pages = paginate(draft.blocks, room)
    if part > len(pages):
        raise BadQuery(
            f"part={part} does not exist: this answer has {len(pages)} part(s) of {max_tokens} tokens."
        )
    text, left = pages[part - 1]
    pieces = [notes, text] if notes and part == 1 else [text]
    if part < len(pages):
        pieces.append(_footer(query, part, len(pages), left))
    return DocsAnswer(draft.kind, "\n\n".join(pieces), draft.hits, draft.notes, part, len(pages))


def _footer(query: str, part: int, parts: int, left: Sequence[str]) -> str:
    """What is left, and the call that gets it; with a blank line above it within ``_FOOTER_TOKENS``."""
    head = f"_Part {part} of {parts}. Left: "
    tail = f'. Next: blender_docs("{clip(query, _ASKED_TOKENS)}", part={part + 1})_'
    names = clip(", ".join(dict.fromkeys(left)), _FOOTER_TOKENS - 1 - tokens(head + tail))
    return head + names + tail
