"""Whether who asks for several names at once, in the middle of work, is told all of them in one answer."""

from __future__ import annotations

import json
import re
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_serve.knowledge_base import KnowledgeBase
from measurements.names import is_told
from measurements.report import ReportPart
from measurements.setting import QUERIES, say
from measurements.shares import share_figure, share_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from measurements.setting import Setting

SETS = ("compound", "compound_kept")
LIMIT = 8
OPTION = re.compile(r"(bpy\.ops\.\w+\.\w+)\.(\w+)")
_HEADER = ("questions", "asked", "names wanted", "told", "questions told all")
_NOTE = (
    "A name is told if it stands in the answer, with its class; an argument, if its operator does and it is shown. "
    f"Of the flat index, which holds the same documents and words, the first {LIMIT} ids count."
)


@dataclass(frozen=True, slots=True)
class CompoundQuery:
    """A question, and all that it wants: of each the names any of which would do."""

    query: str
    expect_all: tuple[tuple[str, ...], ...]


def measure(setting: Setting) -> ReportPart:
    """Asks every question of both sets."""
    say("compound: asking for several names at once")
    sets = {name: read_compound(QUERIES / f"{name}.jsonl") for name in SETS}
    with KnowledgeBase(setting.base) as base:

        def told(query: str) -> Callable[[str], bool]:
            text = base.query(query, limit=LIMIT).text
            return lambda name: is_given(name, text)

        found = {
            name: [_told(query, told(query.query)) for query in queries] for name, queries in sets.items()
        }
    rows = [(f"{name}: SimWorlds", *_cells(outcomes)) for name, outcomes in found.items()]
    if not setting.quick:
        say("compound: making the flat index of the same documents")
        rows += _flat(setting.base, sets)
    return ReportPart(
        "compound",
        tuple(share_figure(f"told_all_{name}", map(all, outcomes)) for name, outcomes in found.items()),
        (Table("Several names asked for at once", _HEADER, tuple(rows), _NOTE),),
    )


def read_compound(path: Path) -> list[CompoundQuery]:
    """The questions of a file (corpora/queries/README.md has its format)."""
    rows = [json.loads(line) for line in path.read_text("utf-8").splitlines()]
    return [CompoundQuery(row["query"], tuple(map(tuple, row["expect_all"]))) for row in rows]


def _told(query: CompoundQuery, is_given: Callable[[str], bool]) -> list[bool]:
    """For each thing that a question wants, whether a name of it is given."""
    return [any(map(is_given, names)) for names in query.expect_all]


def is_given(name: str, text: str) -> bool:
    """Whether an answer tells a name, or an argument of an operator."""
    if (option := OPTION.fullmatch(name)) is None:
        return is_told(name, text)
    operator, argument = option.groups()
    return operator in text and re.search(rf"`{argument}`|\b{argument}=", text) is not None


def _cells(outcomes: Sequence[Sequence[bool]]) -> tuple[str, ...]:
    names = [is_given for each in outcomes for is_given in each]
    whole = list(map(all, outcomes))
    return (str(len(outcomes)), str(len(names)), f"{share_of(names):.3f}", f"{share_of(whole):.3f}")


def _flat(base: Path, sets: dict[str, list[CompoundQuery]]) -> list[tuple[str, ...]]:
    """The rows of a flat index, which gives ids alone."""
    from measurements.baselines import Baselines, read_units  # noqa: PLC0415 - takes seconds and memory

    with closing(Baselines(read_units(base))) as flat:

        def listed(query: str) -> Callable[[str], bool]:
            ids = set(flat.fts5(query)[:LIMIT])
            return lambda name: (
                name in ids or ((option := OPTION.fullmatch(name)) is not None and option[1] in ids)
            )

        return [
            (f"{name}: FTS5, flat", *_cells([_told(query, listed(query.query)) for query in queries]))
            for name, queries in sets.items()
        ]
