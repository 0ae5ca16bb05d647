"""The methods of making summaries, and the phrases that pages are searched by.

``shipped`` (the default) takes what a language model wrote for this project, page by page as long as the page is
unchanged; ``extractive`` chooses sentences of the page itself and gives no phrases. Both need neither key nor network.
``claude`` asks a language model about the pages for which nothing ships, through Anthropic's message batches, and keeps
what it paid for in a :class:`~kb_build.summaries.store.SummaryStore`, outside the knowledge base.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.errors import SummaryError
from kb_build.summaries.extractive import extractive_summaries
from kb_build.summaries.shipped import shipped_summaries
from kb_build.summaries.types import ClaudeOptions, Method, Progress, SummaryReport, SummaryRun, silent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_build.pages.page import Page
    from kb_build.summaries.store import SummaryStore


def summarise(
    pages: Sequence[Page],
    *,
    method: Method = "shipped",
    store: SummaryStore | None = None,
    options: ClaudeOptions | None = None,
    progress: Progress = silent,
) -> SummaryRun:
    """Summarises every one of ``pages``; returns the summaries by slug and a report.

    Only ``claude`` needs ``store``: extractive summaries are made again each time, which is quicker than keeping
    them and never stale. A page for which nothing ships, or that the model refused, answered badly or was not asked
    about (because of the spending limit), gets an extractive summary, marked as such; the latter are named in the
    report.

    Raises SummaryError when ``claude`` cannot be used: no key, a limit below the estimate, an API that rejects the
    requests or stays out of reach. A batch that was sent by then is picked up by the next call with the same store.
    """
    shipped = shipped_summaries(pages) if method != "extractive" else {}
    extractive = extractive_summaries(pages, besides=shipped)
    by_slug = {page.slug: shipped.get(page.slug) or extractive[page.slug] for page in pages}
    if method != "claude":
        report = SummaryReport(method=method, made=len(extractive), reused=len(shipped))
        return SummaryRun(by_slug, report)
    if store is None:
        raise SummaryError(
            "Summaries by Claude need a SummaryStore to keep what was paid for. "
            "Pass store=SummaryStore(path), or use the method 'shipped'."
        )
    from kb_build.summaries.claude import claude_summaries  # noqa: PLC0415 - the client takes a second to load

    others = [page for page in pages if page.slug not in shipped]
    by_claude, report = claude_summaries(others, store, options or ClaudeOptions(), progress)
    return SummaryRun({**by_slug, **by_claude}, report)
