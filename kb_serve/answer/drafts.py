"""Drafts of whole answers, and as many parts of one as fit, with how to get the others."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kb_serve.answer.budget import AnswerBlock, clip, cut, names_of, shown, tokens
from kb_serve.answer.docs_answer import DocsAnswer
from kb_serve.answer.next_call import next_call
from kb_serve.answer.said_twice import not_said
from kb_serve.errors import BadQuery
from simworlds.counting import counted
from simworlds.schemas.value_class import value_class

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kb_serve.answer.budget import AnswerPart
    from kb_serve.answer.docs_answer import AnswerKind
    from kb_serve.answer.hits import Hit

_FOOTER_TOKENS = 70
_REST = "the rest of the last line, "
_NOTES_TOKENS = 500


@value_class
class Draft:
    """The whole answer."""

    kind: AnswerKind
    hits: tuple[Hit, ...]
    notes: tuple[str, ...]
    parts: Sequence[AnswerPart]


def draft_of(
    kind: AnswerKind, hits: tuple[Hit, ...], notes: Sequence[str], blocks: Iterable[AnswerBlock]
) -> Draft:
    """A draft of some blocks. Notes stand above the answer."""
    return Draft(kind, hits, tuple(notes), cut((*_above(notes), *blocks)))


def with_notes(notes: Sequence[str], draft: Draft) -> Draft:
    """A draft with further notes, above its own, unless these say the same, or that the same value is none."""
    news = not_said(notes, draft.notes)
    if not news:
        return draft
    return replace(draft, notes=(*news, *draft.notes), parts=(*cut(_above(news)), *draft.parts))


def _above(notes: Sequence[str]) -> tuple[AnswerBlock, ...]:
    text = clip("\n".join(f"> {note}" for note in notes), _NOTES_TOKENS)
    return (AnswerBlock(text, "notes"),) if text else ()


def paged(query: str, draft: Draft, max_tokens: int, part: int, command: str) -> DocsAnswer:
    """As many parts of a draft as fit, from ``part`` on; what is left, and how to get it. Raises BadQuery."""
    parts = draft.parts
    if part > len(parts):
        raise BadQuery(f"part={part} does not exist: this answer has {counted(len(parts), 'part')}.")
    text, after = shown(parts, part - 1, max_tokens)
    if after == len(parts):
        return DocsAnswer(draft.kind, text, draft.hits, draft.notes, part, len(parts))
    text, after = shown(parts, part - 1, max_tokens - _FOOTER_TOKENS)
    call = next_call(query, after + 1, command)
    is_cut = "\n" not in parts[after].glue
    footer = _footer(call, range(part, after + 1), len(parts), names_of(parts[after:]), is_cut=is_cut)
    return DocsAnswer(draft.kind, f"{text}\n\n{footer}", draft.hits, draft.notes, part, len(parts), after + 1)


def _footer(call: str, seen: range, parts: int, left: Sequence[str], *, is_cut: bool) -> str:
    """What is left, the rest of a line that is cut, and the call that gets it; with a blank line above it within
    ``_FOOTER_TOKENS``.
    """
    span = f"Part {seen[0]}" if len(seen) == 1 else f"Parts {seen[0]} to {seen[-1]}"
    head = f"_{span} of {parts}. Left: {_REST if is_cut else ''}"
    tail = f". Next: {call}_"
    names = clip(", ".join(left), _FOOTER_TOKENS - 1 - tokens(head + tail))
    return head + names + tail
