"""Whether who writes code and asks in plain words is told the names that the code needs."""

from __future__ import annotations

import re
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_serve.answer.budget import tokens
from kb_serve.knowledge_base import KnowledgeBase
from measurements.report import ReportPart
from measurements.retrieval import is_hit, read_queries, unknown_labels
from measurements.setting import QUERIES, say
from measurements.shares import share_figure

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from measurements.retrieval import Query
    from measurements.setting import Setting

SETS = ("names", "names_kept", "names_third")
LIMIT = 8
SHORT_TOKENS = 600
_TYPES = "bpy.types."
_HEADER = ("questions", "asked", "listed", "told", f"told in {SHORT_TOKENS} tokens", "tokens of an answer")
_NOTE = (
    f"A right name is listed if it is one of the first {LIMIT} ids, and told if it stands in the answer, "
    "with its class. The flat index holds the same documents and words."
)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a question got: whether a right name is among the ids, in the answer, in a short answer; and its tokens."""

    listed: bool
    told: bool
    told_briefly: bool
    tokens: int


def is_told(path: str, text: str) -> bool:
    """Whether an answer has a name: the path without ``bpy.types.``, or its last part as code and its owner."""
    owner, _, name = path.removeprefix(_TYPES).rpartition(".")
    if path.removeprefix(_TYPES) in text:
        return True
    return (not owner or owner in text) and re.search(rf"`\.?{re.escape(name)}[`(]", text) is not None


def measure(setting: Setting) -> ReportPart:
    """Asks every question of all sets."""
    sets = {name: read_queries(QUERIES / f"{name}.jsonl") for name in SETS}
    say("names: asking plain questions")
    found = {name: _ask(setting.base, queries) for name, queries in sets.items()}
    rows = [(f"{name}: SimWorlds", *_cells(outcomes)) for name, outcomes in found.items()]
    if not setting.quick:
        say("names: making the flat index of the same documents")
        rows += [(f"{name}: FTS5, flat", *cells) for name, cells in _flat(setting.base, sets).items()]
    unknown = [label for queries in sets.values() for label in unknown_labels(queries, setting.base)]
    return ReportPart(
        "names",
        tuple(share_figure(f"told_{name}", (o.told for o in outcomes)) for name, outcomes in found.items()),
        (Table("Names that code needs, asked for in plain words", _HEADER, tuple(rows), _NOTE),),
        (f"labels that this base does not know: {', '.join(unknown)}",) if unknown else (),
    )


def _ask(base: Path, queries: Sequence[Query]) -> list[Outcome]:
    outcomes: list[Outcome] = []
    with KnowledgeBase(base) as knowledge:
        for query in queries:
            answer = knowledge.query(query.query, limit=LIMIT)
            brief = knowledge.query(query.query, limit=LIMIT, max_tokens=SHORT_TOKENS)
            outcomes.append(
                Outcome(
                    is_hit(query, [hit.id for hit in answer.hits]),
                    any(is_told(path, answer.text) for path in query.expect_any),
                    any(is_told(path, brief.text) for path in query.expect_any),
                    tokens(answer.text),
                )
            )
    return outcomes


def _cells(outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    number = len(outcomes)
    shares = (
        sum(o.listed for o in outcomes), sum(o.told for o in outcomes), sum(o.told_briefly for o in outcomes)
    )  # fmt: skip
    mean = sum(o.tokens for o in outcomes) / number
    return (str(number), *(f"{count / number:.3f}" for count in shares), f"{mean:.0f}")


def _flat(base: Path, sets: dict[str, list[Query]]) -> dict[str, tuple[str, ...]]:
    """The cells of a flat index, which gives ids alone."""
    from measurements.baselines import Baselines, read_units  # noqa: PLC0415 - takes seconds and memory

    cells: dict[str, tuple[str, ...]] = {}
    with closing(Baselines(read_units(base))) as flat:
        for name, queries in sets.items():
            listed = sum(is_hit(query, flat.fts5(query.query)[:LIMIT]) for query in queries)
            cells[name] = (str(len(queries)), f"{listed / len(queries):.3f}", "–", "–", "–")
    return cells
