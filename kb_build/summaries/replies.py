"""The reply to the request for a page's summary and phrases (see prompt), and what makes it a good one."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING

from pydantic import BaseModel, ValidationError

from kb_build.summaries.store import MAX_TEXT

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.summaries.types import FailureReason

MAX_PHRASES = 12
_PHRASE = re.compile(r"[^;<>`|]{3,90}")
_MARKUP = re.compile(r"```|\*\*|\]\(|^\s*(?:#{1,6}|[-*>])\s|</?[a-zA-Z][^<>]*>")


class ReplyUsage(BaseModel):
    """The tokens that an answer is charged for."""

    input_tokens: int = 0
    output_tokens: int = 0
    cache_creation_input_tokens: int | None = None
    cache_read_input_tokens: int | None = None

    @property
    def all_input(self) -> int:
        """Every token that was read, cached or not."""
        return (
            self.input_tokens + (self.cache_creation_input_tokens or 0) + (self.cache_read_input_tokens or 0)
        )


class ReplyBlock(BaseModel):
    """One content block of an answer; only text matters."""

    type: str
    text: str = ""


class StopDetails(BaseModel):
    """Why the API says that an answer ended."""

    category: str | None = None
    explanation: str | None = None


class SummaryReply(BaseModel):
    """A message of Claude's, as far as a summary depends on it."""

    content: list[ReplyBlock] = []
    stop_reason: str | None = None
    stop_details: StopDetails | None = None
    usage: ReplyUsage = ReplyUsage()


class _Reply(BaseModel):
    summary: str
    phrases: list[str]


class NoSummaryError(Exception):
    """An answer holds no summary: ``reason`` says which kind of failure, the message says what was seen."""

    def __init__(self, reason: FailureReason, detail: str) -> None:
        super().__init__(detail)
        self.reason: FailureReason = reason


def read_reply(answer: SummaryReply) -> tuple[str, tuple[str, ...]]:
    """(the summary, its white space folded; the phrases) of an answer. Raises NoSummaryError where there is none."""
    if answer.stop_reason == "refusal":
        why = answer.stop_details and (answer.stop_details.explanation or answer.stop_details.category)
        raise NoSummaryError("refusal", f"Claude declined: {(why or 'no reason given')[:200]}")
    if answer.stop_reason not in ("end_turn", "stop_sequence"):
        raise NoSummaryError("malformed", f"the answer stopped early ({answer.stop_reason})")
    raw = "".join(block.text for block in answer.content if block.type == "text")
    try:
        reply = _Reply.model_validate(json.loads(raw), strict=True)
    except (ValueError, ValidationError, RecursionError):
        raise NoSummaryError("malformed", f"the answer is not the JSON asked for: {raw[:80]!r}") from None
    text = " ".join(reply.summary.split()).replace("`", "")
    if not text:
        raise NoSummaryError("malformed", "the summary is empty")
    if len(text) > MAX_TEXT:
        raise NoSummaryError("malformed", f"the summary has {len(text)} characters, {MAX_TEXT} are allowed")
    if not text.isprintable() or _MARKUP.search(text):
        raise NoSummaryError("malformed", f"the summary is not plain text: {text[:80]!r}")
    return text, sound_phrases(reply.phrases)


def sound_phrases(phrases: Iterable[str]) -> tuple[str, ...]:
    """Those of ``phrases`` that are short plain text, each once, in their order; MAX_PHRASES at most."""
    folded = (" ".join(phrase.lower().split()) for phrase in phrases)
    sound = (phrase for phrase in folded if _PHRASE.fullmatch(phrase) and phrase.isprintable())
    return tuple(dict.fromkeys(sound))[:MAX_PHRASES]
