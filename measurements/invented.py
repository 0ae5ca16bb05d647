"""Whether who writes a name that no Blender has is told the one that is meant."""

from __future__ import annotations

import re
from contextlib import closing
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_serve.knowledge_base import KnowledgeBase
from measurements.report import ReportPart
from measurements.retrieval import is_hit, read_queries, unknown_labels
from measurements.setting import QUERIES, say
from measurements.shares import count_of, share_figure, share_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from measurements.retrieval import Query
    from measurements.setting import Setting

SETS = ("invented", "invented_kept", "held", "held_kept")
FEW = 5
_NAMED = re.compile(r"`([^`]+)`")
_FORMS = {"member": "a class and its member", "expression": "code", "error": "messages"}
_HEADER = ("names that no Blender has", "asked", "meant one first", f"among {FEW}", *_FORMS.values())
_NOTE = f"The meant one is among {FEW} if it is one of the first {FEW} ids or named above them. By form: first, of all."

# Of a query: its first ids, and the names that are told above them.
_Told = tuple[list[str], list[str]]


def measure(setting: Setting) -> ReportPart:
    """Asks every query of all sets."""
    say("invented: asking by names that no Blender has")
    sets = {name: read_queries(QUERIES / f"{name}.jsonl") for name in SETS}
    with KnowledgeBase(setting.base) as base:

        def told(text: str) -> _Told:
            answer = base.query(text)
            named = [name for note in answer.notes for name in _NAMED.findall(note)]
            return [hit.id for hit in answer.hits], named

        found = {name: [(query, told(query.query)) for query in queries] for name, queries in sets.items()}
    rows = [(f"{name}: SimWorlds", *_cells(outcomes)) for name, outcomes in found.items()]
    if not setting.quick:
        rows += _flat(setting.base, sets)
    unknown = [label for queries in sets.values() for label in unknown_labels(queries, setting.base)]
    figures = [
        share_figure(f"{name}_{key}", map(is_told, outcomes))
        for name, outcomes in found.items()
        for key, is_told in (("first", _is_first), ("five", _is_among))
    ]
    return ReportPart(
        "invented",
        tuple(figures),
        (Table("Names that no Blender has", _HEADER, tuple(rows), _NOTE),),
        (f"labels that this base does not know: {', '.join(unknown)}",) if unknown else (),
    )


def _is_first(outcome: tuple[Query, _Told]) -> bool:
    query, (ids, _) = outcome
    return is_hit(query, ids[:1])


def _is_among(outcome: tuple[Query, _Told]) -> bool:
    query, (ids, named) = outcome
    return is_hit(query, [*ids[:FEW], *named])


def _cells(outcomes: Sequence[tuple[Query, _Told]]) -> tuple[str, ...]:
    first, among = list(map(_is_first, outcomes)), list(map(_is_among, outcomes))
    forms = [
        count_of(
            [is_first for is_first, (query, _) in zip(first, outcomes, strict=True) if query.kind == form]
        )
        for form in _FORMS
    ]
    return (str(len(outcomes)), f"{share_of(first):.3f}", f"{share_of(among):.3f}", *forms)


def _flat(base: Path, sets: dict[str, list[Query]]) -> list[tuple[str, ...]]:
    """The rows of a flat index, which names nothing above its ids."""
    from measurements.baselines import Baselines, read_units  # noqa: PLC0415 - takes seconds and memory

    say("invented: making the flat index of the same documents")
    with closing(Baselines(read_units(base))) as flat:
        ask: Callable[[str], list[str]] = flat.fts5
        return [
            (f"{name}: FTS5, flat", *_cells([(query, (ask(query.query), [])) for query in queries]))
            for name, queries in sets.items()
        ]
