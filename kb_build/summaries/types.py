"""Options, results and reports of making summaries."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

Method = Literal["shipped", "extractive", "claude"]
"""``shipped``: what a language model wrote for this project, where a page is unchanged since; else extractive."""
Origin = Literal["extractive", "claude"]
Progress = Callable[[int, int, str], None]
"""Called with pages done, pages in all, and a line for people."""

FailureReason = Literal["refusal", "malformed", "errored", "expired", "canceled", "missing", "not sent"]


@dataclass(frozen=True, slots=True)
class PageSummary:
    """One page's summary: plain text, at most 600 characters, without line breaks.

    ``model`` is the model that wrote it, ``"extractive"`` where the page's own sentences were chosen. ``phrases`` are
    what people would search for who need the page; only a language model writes them.
    """

    key: str
    text: str
    method: Origin
    model: str
    prompt_version: str
    phrases: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class TokenPrice:
    """What a model costs without any discount, in US dollars per million tokens."""

    input_usd: float
    output_usd: float


@dataclass(frozen=True, slots=True)
class ClaudeOptions:
    """How Claude is asked.

    ``max_cost`` is the most that one run may spend, in US dollars (None: no limit). ``price`` replaces the
    built-in price of ``model`` (and is required for a model without one). ``api_key`` and ``base_url``
    default to the environment's ANTHROPIC_API_KEY and ANTHROPIC_BASE_URL. ``timeout`` bounds one HTTP
    exchange, in seconds; ``retries`` are the client's own, with its backoff; ``patience`` is how often in a
    row the API may be out of reach before the run gives up (what was sent is not lost). A running batch is
    looked at after ``poll_seconds``, then ever less often, up to ``poll_max_seconds``; ``max_wait`` (seconds)
    is longer than the day after which Anthropic ends every batch.
    """

    model: str = "claude-haiku-5-5"
    max_cost: float | None = 5.0
    price: TokenPrice | None = None
    api_key: str | None = None
    base_url: str | None = None
    timeout: float = 120.0
    retries: int = 4
    patience: int = 20
    poll_seconds: float = 5.0
    poll_max_seconds: float = 60.0
    max_wait: float = 26 * 3600.0
    batch_size: int = 2500


@dataclass(frozen=True, slots=True)
class Failure:
    """A page that Claude did not summarise, and why; ``detail`` is a sentence for people."""

    slug: str
    reason: FailureReason
    detail: str


@dataclass(frozen=True, slots=True)
class SummaryReport:
    """What a run made, reused and spent.

    ``made`` and ``reused`` count pages with a summary of the method asked for; ``failed`` are the pages that
    got an extractive one instead. ``estimated_cost`` is what was expected before anything was sent,
    ``cost`` follows from the tokens that the API reports; both in US dollars. Batches of an earlier run that
    this one picked up count in ``cost`` and in the tokens, not in the estimate.
    """

    method: Method
    made: int = 0
    reused: int = 0
    failed: tuple[Failure, ...] = ()
    input_tokens: int = 0
    output_tokens: int = 0
    estimated_cost: float = 0.0
    cost: float = 0.0
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class SummaryRun:
    """The summaries by page slug, and the report."""

    by_slug: dict[str, PageSummary]
    report: SummaryReport


def summary_key(content_hash: str, prompt_version: str, model: str) -> str:
    """The address of a summary: the same page text, prompt and model always give the same 64 hex digits."""
    return hashlib.sha256("\n".join((content_hash, prompt_version, model)).encode()).hexdigest()


def silent(done: int, total: int, message: str) -> None:
    """Ignores progress."""
    del done, total, message
