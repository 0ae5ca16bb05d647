"""Reports of builds and bases, as lines of text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kb_build.base_file import described, read_meta
from kb_build.errors import StoreError
from simworlds.how_to_get_bases import how_to_get, how_to_get_again
from simworlds.releases import USUAL

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from kb_build.pipeline import BuildReport
    from kb_build.versions.history_builder import HistoryReport

_PLURALS = {
    "class": "classes", "property": "properties", "data": "constants", "context": "context members",
    "enum": "shared enumerations", "guide": "guides", "template": "templates", "manual": "manual",
}  # fmt: skip
_SHOWN_FAILURES = 5


def base_facts(path: Path) -> dict[str, Any]:
    """All facts of a base's meta, with ``path`` and ``bytes``; ``fault`` where it cannot be read."""
    try:
        meta = described(read_meta(path))
        facts = {"path": str(path), "bytes": path.stat().st_size, **meta}
        for _ in base_lines(facts):
            pass  # all that is told of a base has to be in it
    except (StoreError, OSError) as error:
        return {"path": str(path), "fault": str(error)}
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        fault = f"{path}: damaged (its facts: {type(error).__name__}: {error}). {how_to_get_again(path)}"
        return {"path": str(path), "fault": fault}
    return facts


def base_lines(facts: Mapping[str, Any]) -> Iterator[str]:
    """Describes one base that can be read in full."""
    yield f"Blender {facts['blender']} (build {facts['build_hash']})"
    yield _row("file", f"{facts['path']}, {_megabytes(facts['bytes'])}")
    yield _row("built", f"{facts['built_at']} by SimWorlds {facts['simworlds']}")
    yield _row("fingerprint", facts["fingerprint"])
    yield from _content(facts)
    for missing in facts["missing"]:
        yield _row("MISSING", f"{missing['role']}: {missing['reason']}")
    yield _row("add-ons", ", ".join(facts["addons"]) or "none")
    for fault in facts["faults"]:
        yield _row("fault", str(fault).strip().splitlines()[-1])


def _content(facts: Mapping[str, Any]) -> Iterator[str]:
    counts = facts["counts"]
    symbols = counts["symbols"]
    yield _row("symbols", f"{sum(symbols.values()):,}: {_numbers(symbols)}")
    yield _row("classes", _numbers(counts["classes"], plain=True))
    pages = counts["pages"]
    yield _row("pages", f"{sum(pages.values()):,}: {_numbers(pages)}; {counts['sections']:,} sections")
    yield _row("links", _numbers(counts["links"], plain=True) or "none")
    for source in facts["sources"]:
        yield _row("source", _source(source))
    if not facts["options"]["pages"]:
        yield _row("source", "built without pages (--no-pages)")
    yield _row("summaries", _summaries(facts["summaries"]))
    if warned := facts.get("page_warnings"):
        some = "1 page has some" if len(warned) == 1 else f"{len(warned):,} pages have some"
        yield _row("warnings", f"{some}; kb info --json lists them")


def _source(source: Mapping[str, Any]) -> str:
    by_path = ", given by path" if source["given"] else ""
    return (
        f"{source['role']} {source['version']} ({source['form'].upper()}{by_path}): {source['pages']:,} pages "
        f"from {source['origin']}, sha256 {source['sha256'][:16]}…"
    )


def _summaries(facts: Mapping[str, Any]) -> str:
    text = _numbers(facts["methods"], plain=True) or "none"
    if "cost_usd" in facts:
        text += f"; this build cost ${facts['cost_usd']:.2f}, {len(facts['failed']):,} pages failed"
    return text


def bases_lines(bases: Sequence[Mapping[str, Any]], home: Path) -> Iterator[str]:
    """Lists the bases that can be read, one on a line."""
    if not bases:
        yield f"No knowledge base in {home} yet. {how_to_get(USUAL)}"
    for facts in bases:
        if "fault" in facts:
            continue
        counts = facts["counts"]
        symbols, pages = (sum(counts[kind].values()) for kind in ("symbols", "pages"))
        missing = ", ".join(one["role"] for one in facts["missing"])
        yield (
            f"{facts['blender']:<8} {symbols:>7,} symbols {pages:>6,} pages {_megabytes(facts['bytes']):>9}"
            f"  {facts['path']}" + (f"  (missing: {missing})" if missing else "")
        )


def build_lines(report: BuildReport) -> Iterator[str]:
    """Describes the outcome of a build."""
    facts = base_facts(report.path)
    if not report.built:
        yield (
            f"Nothing has changed: the knowledge base of Blender {report.version} is up to date "
            f"(built {report.meta['built_at']})."
        )
        yield _row("file", f"{report.path}, {_megabytes(facts.get('bytes', 0))}")
        return
    yield f"Built the knowledge base of Blender {report.version} in {report.seconds:.1f} s."
    yield _row("file", f"{report.path}, {_megabytes(facts.get('bytes', 0))}")
    yield from _content(described(dict(report.meta)))


def warning_lines(report: BuildReport) -> Iterator[str]:
    """The warnings of a build that succeeded."""
    for warning in report.warnings:
        yield f"Warning: {warning}"
    if report.summaries is not None:
        for note in report.summaries.notes:
            yield f"Note: {note}"
        failed = report.summaries.failed
        for failure in failed[:_SHOWN_FAILURES]:
            yield f"Warning: no summary by Claude for {failure.slug} ({failure.reason}): {failure.detail}"
        if len(failed) > _SHOWN_FAILURES:
            yield f"Warning: … and {len(failed) - _SHOWN_FAILURES:,} more; kb info --json lists them"


def history_lines(report: HistoryReport) -> Iterator[str]:
    """Describes the outcome of ``kb history``."""
    yield (
        f"{'Wrote' if report.written else 'Nothing to change in'} {report.path}: {report.symbols:,} symbols, "
        f"{report.size / 1e3:.0f} kB."
    )
    yield _row("extracted", ", ".join(report.extracted) or "none")
    if report.kept:
        yield _row("kept", f"{', '.join(report.kept)} (from the file as it was)")
    if report.from_stubs:
        yield _row("from stubs", ", ".join(report.from_stubs))
    for kind, count in sorted(report.agreement.items(), key=lambda entry: -entry[1].both):
        surplus, lacking = (count.both / (count.both + other or 1) for other in (count.extra, count.lacking))
        yield _row(
            "", f"{kind}: {count.both:,} agree, {surplus:.2%} of the stubs', {lacking:.2%} of Blender's"
        )
    for version, reason in report.missing.items():
        yield _row("MISSING", f"{version}: {reason}")
    for fault in report.faults:
        yield _row("fault", fault.strip().splitlines()[-1])


def _numbers(counts: Mapping[str, int], *, plain: bool = False) -> str:
    """``10,921 properties, 6,622 functions``, the largest first."""
    ordered = sorted(counts.items(), key=lambda item: -item[1])
    return ", ".join(f"{n:,} {name if plain else _PLURALS.get(name, name + 's')}" for name, n in ordered)


def _row(name: str, text: str) -> str:
    return f"  {name:<12} {text}"


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.1f} MB"
