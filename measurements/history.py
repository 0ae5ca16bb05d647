"""What a base knows of other versions: removed symbols by version, and how many have a sourced successor.

Its list (``corpora/queries/removed.jsonl``) has names that scripts of 2.7x to 4.x use, with the version that removed
each and what is right instead.
"""

from __future__ import annotations

import json
from collections import Counter
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from bench.markdown_tables import Table
from kb_build.symbols.paths import split_path
from kb_serve.knowledge_base import KnowledgeBase
from kb_serve.reader import BaseReader
from measurements.report import ReportPart
from measurements.setting import QUERIES
from measurements.shares import share_figure
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kb_serve.answer.docs_answer import DocsAnswer
    from measurements.setting import Setting

LIST = QUERIES / "removed.jsonl"
_NOTHING = "Nothing takes its place"


@dataclass(frozen=True, slots=True)
class ListVerdict:
    """Whether the base has a symbol's version and successor right, and whether the answer to its query does."""

    query: str
    half: str
    dated: bool
    first: bool
    answered: bool


def judge(row: dict[str, Any], reader: BaseReader, answer: DocsAnswer) -> ListVerdict:
    """Compares the base's rows about a path, and the answer to a line of code with it, with what is true."""
    removed = reader.history.removed(row["path"])
    dated = removed is not None and removed[2] == row["removed"]
    targets = [successor.target for successor in reader.history.successors(row["path"])]
    first = (
        targets[0] in row["instead"] if row["instead"] and targets else targets == [""] and not row["instead"]
    )
    said = any(row["removed"] in note for note in answer.notes)
    if row["instead"]:
        right = bool(answer.hits) and answer.hits[0].id in {
            shown for path in row["instead"] for shown in _shown(path)
        }
    else:
        right = any(_NOTHING in note for note in answer.notes)
    return ListVerdict(row["query"], row["half"], dated, first, said and right)


def _shown(path: str) -> Iterator[str]:
    """The ids of hits that show a path: its own; for an enum item its property, for a parameter its function."""
    yield path
    above, mark, _ = split_path(path)
    if mark in {":", "("}:
        yield from _shown(above)


def judge_list(base: Path, queries: Path = LIST) -> list[ListVerdict]:
    """Asks for every symbol of the list."""
    rows = [json.loads(line) for line in queries.read_text(encoding="utf-8").splitlines()]
    with KnowledgeBase(base) as knowledge, closing(BaseReader(base)) as reader:
        return [judge(row, reader, knowledge.query(row["query"])) for row in rows]


def measure(setting: Setting) -> ReportPart:
    """The base's removed symbols, and the list."""
    verdicts = judge_list(setting.base)
    columns = ("dated", "first", "answered")
    halves = ("before", "after")
    rows = [
        (half, *(_share([getattr(v, column) for v in verdicts if v.half == half]) for column in columns))
        for half in halves
    ]
    figures = [
        share_figure(f"history_{column}", (getattr(verdict, column) for verdict in verdicts))
        for column in columns
    ]
    listed = Table(
        "Removed symbols of scripts",
        ("half", "version right", "successor first", "answered so"),
        tuple(rows),
        "Share of the names (their number). *before* was written before the table of successors, *after* afterwards.",
    )
    misses = [
        verdict.query for verdict in verdicts if not (verdict.dated and verdict.first and verdict.answered)
    ]
    return ReportPart("history", tuple(figures), (_by_version(setting.base), listed), (), {"misses": misses})


def _by_version(base: Path) -> Table:
    """Symbols removed in each version, and how many of them have a sourced successor or are known to have none."""
    with closing(BaseReader(base)) as reader:
        gone = Counter(version for (version,) in reader.rows("SELECT gone FROM removed WHERE gone != ''"))
        sourced, nothing = (
            Counter(
                version
                for (version,) in reader.rows(
                    "SELECT gone FROM removed JOIN successors USING (path) "
                    f"WHERE gone != '' AND position = 0 AND target {sign} ''"
                )
            )
            for sign in ("!=", "=")
        )
    versions = sorted(gone, key=version_key)
    rows = [(version, gone[version], sourced[version], nothing[version]) for version in versions]
    rows.append(("all", gone.total(), sourced.total(), nothing.total()))
    return Table(
        "Symbols removed in each version",
        ("version", "symbols", "with a successor", "known to have none"),
        tuple(tuple(map(str, row)) for row in rows),
        "Successors are those with a source; similar names are not counted.",
    )


def _share(met: list[bool]) -> str:
    return f"{sum(met) / len(met):.3f} ({len(met)})" if met else "–"
