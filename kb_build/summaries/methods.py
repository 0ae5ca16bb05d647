"""The two methods of making summaries.

``extractive`` (the default) chooses sentences of the page itself: no key, no network, no cost. ``claude`` asks a
language model through Anthropic's message batches and keeps what it paid for in a
:class:`~kb_build.summaries.store.SummaryStore`, outside the knowledge base.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.errors import SummaryError
from kb_build.summaries.extractive import extractive_summaries
from kb_build.summaries.types import ClaudeOptions, Method, Progress, SummaryReport, SummaryRun, silent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_build.records import Page
    from kb_build.summaries.store import SummaryStore


def summarise(
    pages: Sequence[Page],
    *,
    method: Method = "extractive",
    store: SummaryStore | None = None,
    options: ClaudeOptions | None = None,
    progress: Progress = silent,
) -> SummaryRun:
    """Summarises every one of ``pages``; returns the summaries by slug and a report.

    Only ``claude`` needs ``store``: extractive summaries are made again each time, which is quicker than keeping
    them and never stale. With ``claude``, a page that the model refused, answered badly or was not asked about
    (because of the spending limit) gets an extractive summary, marked as such, and is named in the report.

    Raises SummaryError when ``claude`` cannot be used: no key, a limit below the estimate, an API that rejects the
    requests or stays out of reach. A batch that was sent by then is picked up by the next call with the same store.
    """
    extractive = extractive_summaries(pages)
    if method == "extractive":
        return SummaryRun(extractive, SummaryReport(method=method, made=len(extractive)))
    if store is None:
        raise SummaryError(
            "Summaries by Claude need a SummaryStore to keep what was paid for. "
            "Pass store=SummaryStore(path), or use the method 'extractive'."
        )
    from kb_build.summaries.claude import claude_summaries  # noqa: PLC0415 - the client takes a second to load

    by_claude, report = claude_summaries(pages, store, options or ClaudeOptions(), progress)
    return SummaryRun({**extractive, **by_claude}, report)
