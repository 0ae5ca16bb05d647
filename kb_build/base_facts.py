"""The facts that a build writes into its base: numbers and origins, ready for JSON."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_build.blender.extract_reader import Extract
    from kb_build.pages.page import Page
    from kb_build.pages.sources import DocumentationSource
    from kb_build.summaries.types import SummaryRun


def counts(extract: Extract, pages: Sequence[Page]) -> dict[str, Any]:
    """How many symbols of each kind, classes of each group, pages of each source, sections, links."""
    return {
        "symbols": dict(Counter(symbol.kind for symbol in extract.symbols)),
        "classes": dict(
            Counter(symbol.group or "data" for symbol in extract.symbols if symbol.kind == "class")
        ),
        "pages": dict(Counter(page.source for page in pages)),
        "sections": sum(len(page.sections) for page in pages),
        "links": dict(Counter(link.kind for link in extract.links)),
    }


def source_facts(source: DocumentationSource, pages: Sequence[Page]) -> dict[str, Any]:
    """Where a source came from and what it gave."""
    kind = "manual" if source.role == "manual" else "guide"
    own = [page for page in pages if page.source == kind]
    return {
        "role": source.role,
        "version": source.version,
        "form": source.form,
        "origin": source.origin,
        "sha256": source.sha256,
        "given": source.given,
        "pages": len(own),
        "pages_with_warnings": sum(bool(page.warnings) for page in own),
    }


def summary_facts(run: SummaryRun | None) -> dict[str, Any]:
    """How many summaries were made by which method, and what they cost."""
    if run is None:
        return {"methods": {}}
    report = run.report
    facts: dict[str, Any] = {"methods": dict(Counter(summary.method for summary in run.by_slug.values()))}
    if report.method == "claude":
        facts |= {
            "models": dict(Counter(summary.model for summary in run.by_slug.values())),
            "cost_usd": round(report.cost, 4),
            "failed": [[failure.slug, failure.reason, failure.detail] for failure in report.failed],
        }
    return facts
