"""How code written for other versions is answered: removed names dated and replaced, names that work left alone.

Its queries (``corpora/queries/old_code.jsonl``) are lines of scripts of Blender 2.7 to 4.x and the messages that they
give today. ``is`` tells what of a line is wrong: ``removed`` (``path`` went in version ``removed``; ``instead`` takes
its place, nothing if empty, not judged if absent), ``never`` (no version had the name) or nothing: it ``works``.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from bench.markdown_tables import Table
from kb_serve.knowledge_base import KnowledgeBase
from measurements.report import ReportPart, TargetFigure
from measurements.setting import REPO

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from kb_serve.answer.docs_answer import DocsAnswer
    from measurements.setting import Setting

QUERIES = REPO / "corpora" / "queries" / "old_code.jsonl"
_GONE = "does not exist in Blender"
_NEVER = "never had it"
_NOTHING = "Nothing takes its place"
_READ_AS = "read as"
_COLUMNS = ("gone", "version", "first", "five", "nothing", "never", "works")


@dataclass(frozen=True, slots=True)
class Verdict:
    """Which demands (``_COLUMNS``) a query makes, and whether its answer meets them."""

    query: str
    half: str
    met: dict[str, bool]


def judge(row: dict[str, Any], answer: DocsAnswer) -> Verdict:
    """Compares an answer with what is true of the query."""
    gone = [note for note in answer.notes if _GONE in note]
    met: dict[str, bool] = {}
    if row["is"] == "works":
        met["works"] = not any(_GONE in note or _NEVER in note or _READ_AS in note for note in answer.notes)
    elif row["is"] == "never":
        met["never"] = not gone and any(_NEVER in note for note in answer.notes)
    else:
        met["gone"] = bool(gone)
        met["version"] = any(row["removed"] in note for note in gone)
        met |= _replaced(row, answer)
    return Verdict(row["query"], row["half"], met)


def _replaced(row: dict[str, Any], answer: DocsAnswer) -> Iterator[tuple[str, bool]]:
    ids = [hit.id for hit in answer.hits]
    instead = row.get("instead")
    if instead:
        yield "first", ids[:1] != [] and ids[0] in instead
        yield "five", not set(instead).isdisjoint(ids[:5])
    elif instead is not None:
        stands_in = ids[:1] != [] and not row["path"].startswith(ids[0])
        yield "nothing", any(_NOTHING in note for note in answer.notes) and not stands_in


def judge_all(base: Path, queries: Path = QUERIES) -> list[Verdict]:
    """Asks every query once."""
    rows = [json.loads(line) for line in queries.read_text(encoding="utf-8").splitlines()]
    with KnowledgeBase(base) as knowledge:
        return [judge(row, knowledge.query(row["query"])) for row in rows]


def _share(verdicts: Iterable[Verdict], column: str) -> tuple[int, int]:
    met = [verdict.met[column] for verdict in verdicts if column in verdict.met]
    return sum(met), len(met)


def _cell(verdicts: Sequence[Verdict], column: str) -> str:
    met, count = _share(verdicts, column)
    return f"{met / count:.3f} ({count})" if count else "–"


def measure(setting: Setting) -> ReportPart:
    """Both halves of the set: written before the code that answers them, and afterwards."""
    verdicts = judge_all(setting.base)
    halves = {half: [v for v in verdicts if v.half == half] for half in ("before", "after")} | {
        "all": verdicts
    }
    table = Table(
        "Code of other versions",
        (
            "half",
            "said to be gone",
            "right version",
            "successor first",
            "in five",
            "nothing instead",
            "never was",
            "works",
        ),
        tuple((name, *(_cell(rows, column) for column in _COLUMNS)) for name, rows in halves.items()),
        "Share of the queries (their number). *before* was written before the code that answers, *after* afterwards.",
    )
    figures = (
        TargetFigure(f"old_{column}", met / count, f"{met} of {count}")
        for column in _COLUMNS
        for met, count in [_share(verdicts, column)]
        if count
    )
    misses = [
        {"query": v.query, "missed": [c for c, met in v.met.items() if not met]}
        for v in verdicts
        if not all(v.met.values())
    ]
    return ReportPart("old_code", tuple(figures), (table,), (), {"misses": misses})
