"""Summaries by Claude: which pages to ask about, what it may cost, and what came back.

Every page is asked about at most twice in a run, and a page whose answers were refused or malformed twice is
not asked about again with the same prompt and model. Batches of an earlier, interrupted run come first.

The cost is estimated with the API's own token counts of a few pages (or, when it cannot be reached for that,
three characters a token). A run whose estimate exceeds the limit sends nothing. Beyond that, no batch is sent
whose worst case (every answer of the greatest length) would not fit into what the limit leaves.
"""

from __future__ import annotations

import contextlib
import json
import secrets
import time
from typing import TYPE_CHECKING

from kb_build.errors import SummaryError
from kb_build.summaries.batches import BatchAPI, BatchGoneError, ItemResult
from kb_build.summaries.models import FALLBACK_CHARS_PER_TOKEN, batch_cost, facts, price_of
from kb_build.summaries.prompt import PROMPT_VERSION, request_for
from kb_build.summaries.replies import NoSummaryError, read_reply
from kb_build.summaries.store import BadAnswer, SentBatch, SummaryStore
from kb_build.summaries.types import (
    ClaudeOptions,
    Failure,
    FailureReason,
    PageSummary,
    Progress,
    SummaryReport,
    summary_key,
)
from simworlds.llm.apis.anthropic_client import Credentials
from simworlds.llm.errors import Rejected

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from anthropic.types.messages.batch_create_params import Request

    from kb_build.pages.page import Page

MIN_CHARS = 120
"""A page with less text than this is not worth a question: it is its own summary."""

_ATTEMPTS = 2
_SAMPLE = 4
_INPUT_MARGIN = 1.2
_BATCH_BYTES = 100_000_000
_RESULTS_KEPT_SECONDS = 29 * 24 * 3600.0
_ENDED_WITHOUT_ANSWER: dict[str, tuple[FailureReason, str]] = {
    "expired": ("expired", "the batch ended before this page's turn"),
    "canceled": ("canceled", "the batch was canceled before this page's turn"),
}


def claude_summaries(
    pages: Sequence[Page], store: SummaryStore, options: ClaudeOptions, progress: Progress
) -> tuple[dict[str, PageSummary], SummaryReport]:
    """The summaries that Claude wrote, by slug (pages without are absent), and the report.

    Raises SummaryError, see :func:`kb_build.summaries.methods.summarise`.
    """
    keys = {page.slug: summary_key(page.content_hash, PROMPT_VERSION, options.model) for page in pages}
    worthy = {keys[page.slug]: page for page in pages if len(page.text) >= MIN_CHARS}
    summaries = store.get(worthy)
    run = None
    reused = set(summaries)
    if len(summaries) < len(worthy):
        with store.exclusive(progress):
            summaries = store.get(worthy)  # another build may have made them while this one waited
            reused = set(summaries)
            missing = {key: page for key, page in worthy.items() if key not in summaries}
            if missing:
                run = _Run(missing, store, options, progress)
                with contextlib.closing(run.api):
                    run.run()
                summaries.update(run.made)
    by_slug = {slug: summaries[key] for slug, key in keys.items() if key in summaries}
    failed = [
        Failure(slug, bad.reason, bad.detail)
        for slug, key in keys.items()
        if run and key not in summaries and (bad := run.failures.get(key))
    ]
    notes = list(run.notes) if run else []
    small = sum(1 for key in keys.values() if key not in worthy)
    if small:
        notes.append(f"{small} pages are too short to be worth a question; theirs are extractive")
    report = SummaryReport(
        method="claude",
        made=sum(1 for slug in by_slug if keys[slug] not in reused),
        reused=sum(1 for slug in by_slug if keys[slug] in reused),
        failed=tuple(failed),
        input_tokens=run.input_tokens if run else 0,
        output_tokens=run.output_tokens if run else 0,
        estimated_cost=run.estimated_cost if run else 0.0,
        cost=run.cost if run else 0.0,
        notes=tuple(notes),
    )
    return by_slug, report


class _Run:
    """One run over the pages (by summary key) that have no summary yet."""

    def __init__(
        self, pages: Mapping[str, Page], store: SummaryStore, options: ClaudeOptions, progress: Progress
    ) -> None:
        try:
            credentials = Credentials.found(options.api_key)
        except Rejected as error:
            raise SummaryError(str(error)) from error
        if credentials is None:
            raise SummaryError(
                f"Summaries by Claude are missing for {len(pages)} pages, and there is no key to ask for "
                "them. Set ANTHROPIC_API_KEY, or use the method 'extractive', which needs none."
            )
        if options.max_cost is not None and not options.max_cost >= 0:
            raise SummaryError(
                f"The spending limit {options.max_cost} is not valid. Give US dollars, 0 or more."
            )
        self.price = price_of(options.model, options.price)
        self.facts = facts(options.model)
        self.api = BatchAPI(credentials, options, lambda line: progress(len(self.made), len(pages), line))
        self.pages = pages
        self.store = store
        self.options = options
        self.progress = progress
        self.made: dict[str, PageSummary] = {}
        self.failures: dict[str, BadAnswer] = {}
        self.notes: list[str] = []
        self.input_tokens = 0
        self.output_tokens = 0
        self.estimated_cost = 0.0
        self.cost = 0.0
        self._sizes: dict[str, int] = {}
        self._chars_per_token = FALLBACK_CHARS_PER_TOKEN

    def run(self) -> None:
        """Collect what earlier runs sent, then ask about the rest."""
        self._collect_earlier()
        for attempt in range(_ATTEMPTS):
            queue = self._to_ask()
            if queue and attempt == 0:
                self._estimate(queue)
            while queue:
                part = self._affordable(queue)
                if not part:
                    self._leave_unsent(queue)
                    return
                self._ask(part)
                queue = queue[len(part) :]

    def _to_ask(self) -> list[str]:
        bad = self.store.failures(self.pages)
        self.failures.update({key: answers[-1] for key, answers in bad.items()})
        return [key for key in self.pages if key not in self.made and len(bad.get(key, ())) < _ATTEMPTS]

    def _collect_earlier(self) -> None:
        """Keep what batches of interrupted runs have given; wait for those that hold pages of this run."""
        batches = self.store.under_way(self.api.base_url)
        known = {batch.batch_id for batch in batches if batch.batch_id}
        for batch in batches:
            wanted = not self.pages.keys().isdisjoint(batch.items.values())
            batch_id = batch.batch_id
            try:
                if batch_id is None:
                    found = self.api.find(batch.nonce, len(batch.items), batch.sent, known)
                    if found is None:  # it was never received
                        self.store.settle(batch.nonce, (), ())
                        continue
                    batch_id = found.id
                    self.store.identify(batch.nonce, batch_id)
                if wanted or self.api.look(batch_id).processing_status == "ended":
                    self._collect(batch, batch_id)
            except BatchGoneError:
                # Perhaps another key's: kept as long as its results would be.
                if time.time() - batch.sent > _RESULTS_KEPT_SECONDS:
                    self.store.settle(batch.nonce, (), ())
                self.notes.append(f"batch {batch_id} of an earlier build is not to be had with this key")

    def _estimate(self, queue: Sequence[str]) -> None:
        by_size = sorted(queue, key=lambda key: len(self.pages[key].text))
        step = max(1, len(by_size) // _SAMPLE)
        chars = tokens = 0
        for key in by_size[step // 2 :: step][:_SAMPLE]:
            counted = self.api.count_tokens(request_for(self.pages[key], self.options.model))
            if not counted:
                break
            chars += self._size(key)
            tokens += counted
        if tokens:
            self._chars_per_token = chars / tokens
        self.estimated_cost = sum(self._expected_cost(key) for key in queue)
        limit = self.options.max_cost
        self.progress(
            0,
            len(queue),
            f"{len(queue)} pages to be summarised by {self.options.model}, for about "
            f"${self.estimated_cost:.2f}" + (f" (limit ${limit:.2f})" if limit is not None else ""),
        )
        if limit is not None and self.cost + self.estimated_cost > limit:
            raise SummaryError(
                f"Summaries of {len(queue)} pages by {self.options.model} would cost about "
                f"${self.estimated_cost:.2f}, more than the limit of ${limit:.2f} leaves; nothing was sent. "
                "Raise the limit, choose a cheaper model, or use the method 'extractive'."
            )

    def _affordable(self, queue: Sequence[str]) -> list[str]:
        """The longest beginning of ``queue`` that one batch can hold and that is paid for in any case."""
        left = float("inf") if self.options.max_cost is None else self.options.max_cost - self.cost
        size = 0
        part: list[str] = []
        for key in queue[: max(1, self.options.batch_size)]:
            left -= self._worst_cost(key)
            size += self._size(key)
            if left < 0 or (part and size > _BATCH_BYTES):
                break
            part.append(key)
        return part

    def _leave_unsent(self, queue: Sequence[str]) -> None:
        detail = f"the limit of ${self.options.max_cost:.2f} does not allow for another batch"
        for key in queue:
            self.failures.setdefault(key, BadAnswer(key, "not sent", detail))
        self.notes.append(f"{len(queue)} pages were left out: {detail}")

    def _ask(self, keys: Sequence[str]) -> None:
        nonce = secrets.token_hex(6)
        items = {f"{nonce}-{key[:48]}": key for key in keys}
        requests: list[Request] = [
            {"custom_id": custom_id, "params": request_for(self.pages[key], self.options.model)}
            for custom_id, key in items.items()
        ]
        known = {batch.batch_id for batch in self.store.under_way(self.api.base_url) if batch.batch_id}
        batch = SentBatch(
            nonce, None, self.api.base_url, self.options.model, PROMPT_VERSION, time.time(), items
        )
        self.store.announce(batch)
        try:
            batch_id = self.api.send(requests, nonce, batch.sent, known).id
        except BatchGoneError as error:
            raise SummaryError(f"{self.api.base_url} has no Message Batches API: {error}") from error
        self.store.identify(nonce, batch_id)
        self.progress(len(self.made), len(self.pages), f"batch {batch_id} sent: {len(keys)} pages")
        try:
            self._collect(batch, batch_id)
        except BatchGoneError:
            for key in keys:
                self.failures[key] = BadAnswer(key, "missing", f"batch {batch_id} was deleted")
            self.store.settle(nonce, (), ())

    def _collect(self, batch: SentBatch, batch_id: str) -> None:
        """Wait for a batch and keep what came of it. Raises BatchGoneError."""
        self.progress(len(self.made), len(self.pages), f"waiting for batch {batch_id}")
        self.api.wait(batch_id)
        results = self.api.results(batch_id, len(batch.items))
        summaries: list[PageSummary] = []
        failures: list[BadAnswer] = []
        for custom_id, key in batch.items.items():
            result = results.get(custom_id)
            self._account(result, batch.model)
            try:
                text, phrases = _reply_of(result)
            except NoSummaryError as error:
                failures.append(BadAnswer(key, error.reason, str(error)))
            else:
                summaries.append(PageSummary(key, text, "claude", batch.model, batch.prompt_version, phrases))
        lasting = [bad for bad in failures if bad.reason in ("refusal", "malformed")]
        self.store.settle(batch.nonce, summaries, lasting)
        self.made.update((one.key, one) for one in summaries if one.key in self.pages)
        self.failures.update((bad.key, bad) for bad in failures)
        self.progress(len(self.made), len(self.pages), f"batch {batch_id}: {len(summaries)} summaries")

    def _account(self, result: ItemResult | None, model: str) -> None:
        if result is None or result.message is None:
            return
        usage = result.message.usage
        self.input_tokens += usage.all_input
        self.output_tokens += usage.output_tokens
        price = self.price if model == self.options.model else facts(model).price or self.price
        self.cost += batch_cost(price, usage.all_input, usage.output_tokens)

    def _size(self, key: str) -> int:
        if key not in self._sizes:
            request = request_for(self.pages[key], self.options.model)
            self._sizes[key] = len(json.dumps(request, ensure_ascii=False))
        return self._sizes[key]

    def _expected_cost(self, key: str) -> float:
        return batch_cost(self.price, self._size(key) / self._chars_per_token, self.facts.expected_tokens)

    def _worst_cost(self, key: str) -> float:
        tokens = self._size(key) / self._chars_per_token * _INPUT_MARGIN
        return batch_cost(self.price, tokens, self.facts.max_tokens)


def _reply_of(result: ItemResult | None) -> tuple[str, tuple[str, ...]]:
    """The summary and phrases in one request's result. Raises NoSummaryError."""
    if result is None:
        raise NoSummaryError("missing", "the batch's results do not mention this page")
    if result.type == "succeeded" and result.message:
        return read_reply(result.message)
    if result.type == "errored":
        error = result.error.error if result.error else None
        raise NoSummaryError(
            "errored", f"{error.type}: {error.message}"[:300] if error else "no reason given"
        )
    reason, detail = _ENDED_WITHOUT_ANSWER.get(
        result.type, ("malformed", f"an unknown type of result ({result.type[:40]})")
    )
    raise NoSummaryError(reason, detail)
