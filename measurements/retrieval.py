"""How well queries are answered: hit rates over labelled sets, beside plain rankings and beside parts of ours."""

from __future__ import annotations

import json
import random
import re
import tempfile
import time
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unittest import mock

from bench.markdown_tables import Table
from kb_build import store
from kb_build.index.query_expansions import load_query_expansions
from kb_build.pipeline import BuildOptions, build
from kb_serve.answer.budget import tokens
from kb_serve.knowledge_base import KnowledgeBase
from kb_serve.rank import search
from kb_serve.rank.weights import WEIGHTS
from kb_serve.reader import BaseReader
from measurements.report import ReportPart, TargetFigure
from measurements.setting import corpora, percentile, say

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator, Sequence

    from kb_serve.answer.docs_answer import DocsAnswer
    from measurements.setting import Setting

LIMIT = 8
NAMED = frozenset({"exact", "member", "expression"})
TASK = "task"
FURTHER = ("check", "blind", "fourth", "fourth_kept")
PARAPHRASES = "paraphrases"  # of the set that is judged
KINDS = (
    "exact",
    "member",
    "expression",
    "enum",
    "error",
    "removed",
    "typo",
    "natural",
    "manual",
    "guide",
    "task",
    "names",
)
_SAMPLE = 400
_SOCKET = re.compile(r"\.(?:inputs|outputs)\[")
_FIELDS = {"id", "query", "kind", "expect_any", "expect_pages"}


@dataclass(frozen=True, slots=True)
class Query:
    """One labelled query. ``expect_any`` are symbol paths, ``expect_pages`` slugs; any of both is right."""

    id: str
    query: str
    kind: str
    expect_any: tuple[str, ...]
    expect_pages: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a system answered to one query, and how many milliseconds it took."""

    query: Query
    ids: tuple[str, ...]
    ms: float

    def hit(self, first: int) -> bool:
        """Whether one of the ``first`` ids is right."""
        return is_hit(self.query, self.ids[:first])


class BadQueries(Exception):  # noqa: N818 - reads as the state it names
    """A file of queries is not what it should be; the message says where and why."""


def read_queries(path: Path) -> list[Query]:
    """The queries of a JSON Lines file. Raises BadQueries, naming the line."""
    queries: list[Query] = []
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise BadQueries(
            f"{path}: cannot be read ({error}). Give a JSON Lines file with --queries"
        ) from error
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            row = json.loads(line)
            queries.append(
                Query(
                    row["id"], row["query"], row["kind"], tuple(row["expect_any"]), tuple(row["expect_pages"])
                )
            )
        except (ValueError, KeyError, TypeError) as error:
            wanted = ", ".join(sorted(_FIELDS))
            raise BadQueries(
                f"{path}, line {number}: no query ({error!r}). A line is an object with {wanted}"
            ) from error
    if not queries:
        raise BadQueries(f"{path}: holds no queries")
    return queries


def counts_for(identifier: str) -> Iterator[str]:
    """The ids that a found id counts for: itself; an enum item's property; a socket's node; a section's page."""
    yield identifier
    if socket := _SOCKET.search(identifier):
        yield identifier[: socket.start()]
        return
    yield identifier.partition(":")[0]
    yield identifier.partition("#")[0]


def is_hit(query: Query, ids: Sequence[str]) -> bool:
    """Whether one of ``ids`` is one that the query's label allows."""
    allowed = {*query.expect_any, *query.expect_pages}
    return any(counted in allowed for identifier in ids for counted in counts_for(identifier))


def share(outcomes: Sequence[Outcome], first: int) -> float:
    """The share of queries with a right id among the ``first``; NaN for no queries."""
    return sum(outcome.hit(first) for outcome in outcomes) / len(outcomes) if outcomes else float("nan")


def ask_all(ask: Callable[[str], Sequence[str]], queries: Sequence[Query]) -> list[Outcome]:
    """Asks every query once."""
    outcomes: list[Outcome] = []
    for query in queries:
        began = time.perf_counter()
        ids = ask(query.query)
        outcomes.append(Outcome(query, tuple(ids), (time.perf_counter() - began) * 1e3))
    return outcomes


def unknown_labels(queries: Sequence[Query], base: Path) -> list[str]:
    """Ids in the labels that the base does not have, as ``query id: label``."""
    with closing(BaseReader(base)) as reader:
        known = {row[0] for row in reader.rows("SELECT path FROM symbols UNION ALL SELECT slug FROM pages")}
    return [
        f"{query.id}: {label}"
        for query in queries
        for label in (*query.expect_any, *query.expect_pages)
        if known.isdisjoint(counts_for(label))
    ]


# The systems compared


def ids_of(answer: DocsAnswer) -> list[str]:
    """The ids of an answer, best first."""
    return [hit.id for hit in answer.hits]


def _ours(base: Path, stack: ExitStack) -> Callable[[str], Sequence[str]]:
    knowledge = stack.enter_context(KnowledgeBase(base))
    return lambda text: ids_of(knowledge.query(text, limit=LIMIT))


def _words_only(base: Path, stack: ExitStack) -> Callable[[str], Sequence[str]]:
    searcher = search.Searcher(stack.enter_context(closing(BaseReader(base))))
    return lambda text: [found.ref for found in searcher.search(text, LIMIT)]


def _base_without_expansions(base: Path, home: Path, folder: Path) -> Path:
    """A base of the same version and sources, without query expansions."""
    with closing(BaseReader(base)) as reader:
        version = reader.meta["blender"]
    options = BuildOptions(corpora=corpora(), offline=True, output=folder / base.name)
    with without_expansions():
        return build(version, options=options, home=home).path


@contextmanager
def without_expansions() -> Generator[None]:
    """The store finds no query expansions while this lasts; what symbols weigh by them stays."""

    def weighing(*, plain: bool = True) -> dict[str, str]:
        return {} if plain else load_query_expansions(plain=False)

    with (
        mock.patch.object(store, "load_query_expansions", weighing),
        mock.patch.object(store, "page_expansions", return_value={}),
    ):
        yield


def compared(base: Path, home: Path, *, quick: bool) -> Iterator[tuple[str, Callable[[str], Sequence[str]]]]:
    """(name, what answers) for every system, ours first. Each is closed when the next is asked for."""
    with ExitStack() as stack:
        yield "SimWorlds", _ours(base, stack)
    if quick:
        return
    with ExitStack() as stack:
        yield "… words only, no names or topics", _words_only(base, stack)
    for name, constant in (("coverage", "COVERAGE"), ("the topic around a unit", "TOPIC_WEIGHT")):
        with ExitStack() as stack:
            stack.enter_context(mock.patch.object(search, constant, 0.0))
            yield f"… without {name}", _ours(base, stack)
    for signal in WEIGHTS:
        if signal != "text":
            with ExitStack() as stack:
                stack.enter_context(mock.patch.dict(WEIGHTS, {signal: 0.0}))
                yield f"… without the signal “{signal}”", _ours(base, stack)
    say("building a base without query expansions")
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="simworlds-bench-")))
        yield "… without query expansions", _ours(_base_without_expansions(base, home, folder), stack)
    from measurements.baselines import CANDIDATES, Baselines, read_units  # noqa: PLC0415 - takes seconds and memory

    say("making the flat indexes of the same documents")
    with closing(Baselines(read_units(base))) as flat:
        yield "FTS5, flat", flat.fts5
        yield "rank-bm25, flat", flat.rank_bm25
        yield f"rank-bm25 over FTS5's first {CANDIDATES}", flat.rank_bm25_over_fts5


# The part


def measure(setting: Setting) -> ReportPart:
    """Every system on every set. The first set is judged."""
    sets = {path.stem: read_queries(path) for path in setting.queries}
    results: dict[str, dict[str, list[Outcome]]] = {}
    for name, ask in compared(setting.base, setting.home, quick=setting.quick):
        say(f"retrieval: {name}")
        results[name] = {title: ask_all(ask, queries) for title, queries in sets.items()}
    ours = next(iter(results.values()))
    judged = next(iter(sets))
    unknown = [label for queries in sets.values() for label in unknown_labels(queries, setting.base)]
    skipped = [f"labels that this base does not know: {', '.join(unknown)}"] if unknown else []
    return ReportPart(
        "retrieval",
        (
            *_figures(ours[judged], judged),
            *_further(ours),
            *_paraphrased(ours, judged),
            *_promises(setting.base, sets[judged]),
        ),
        (_systems_table(results), _kinds_table(ours)),
        tuple(skipped),
        {"systems": _summaries(results), "queries": {title: _rows(found) for title, found in ours.items()}},
    )


def _figures(outcomes: Sequence[Outcome], title: str) -> Iterator[TargetFigure]:
    groups = {
        "hit1": ([o for o in outcomes if o.query.kind != TASK], 1),
        "hit5": ([o for o in outcomes if o.query.kind != TASK], 5),
        "task5": ([o for o in outcomes if o.query.kind == TASK], 5),
        "names1": ([o for o in outcomes if o.query.kind in NAMED], 1),
    }
    for key, (group, first) in groups.items():
        if group:
            yield TargetFigure(
                key, share(group, first), f"{title}: {sum(o.hit(first) for o in group)} of {len(group)}"
            )


def _further(ours: dict[str, list[Outcome]]) -> Iterator[TargetFigure]:
    """The sets that nothing was fitted on."""
    for title in FURTHER:
        if outcomes := [o for o in ours.get(title, ()) if o.query.kind != TASK]:
            for first in (1, 5):
                yield TargetFigure(
                    f"hit{first}_{title}",
                    share(outcomes, first),
                    f"{sum(o.hit(first) for o in outcomes)} of {len(outcomes)}",
                )


def _paraphrased(ours: dict[str, list[Outcome]], judged: str) -> Iterator[TargetFigure]:
    if PARAPHRASES not in ours:
        return
    first, again = (
        share([o for o in ours[title] if o.query.kind != TASK], 5) for title in (judged, PARAPHRASES)
    )
    yield TargetFigure("paraphrased5", first - again, f"{judged} {first:.3f}, {PARAPHRASES} {again:.3f}")


def _promises(base: Path, queries: Sequence[Query]) -> Iterator[TargetFigure]:
    """What holds for every answer: names resolve, and none is longer than its budget."""
    with closing(BaseReader(base)) as reader:
        members = reader.rows(
            "SELECT path FROM symbols WHERE kind IN ('property', 'function') AND owner LIKE 'bpy.types.%' ORDER BY path"
        )
    sample = random.Random(0).sample([path for (path,) in members], min(_SAMPLE, len(members)))
    with KnowledgeBase(base) as knowledge:
        found = [ids_of(knowledge.query(path, limit=1))[:1] == [path] for path in sample]
        if found:
            yield TargetFigure(
                "members", sum(found) / len(found), f"{sum(found)} of {len(found)}, sampled from this base"
            )
        longest = max(tokens(knowledge.query(query.query).text) for query in queries)
    yield TargetFigure("longest", longest, "a token for every 3 bytes")


def _cells(outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    rest = [o for o in outcomes if o.query.kind != TASK]
    tasks = [o for o in outcomes if o.query.kind == TASK]
    return (_two(share(rest, 1)), _two(share(rest, 5)), _two(share(tasks, 5)))


def _two(value: float) -> str:
    return "–" if value != value else f"{value:.3f}"  # noqa: PLR0124 - NaN


def _systems_table(results: dict[str, dict[str, list[Outcome]]]) -> Table:
    titles = list(next(iter(results.values())))
    header = ["system"]
    for title in titles:
        header += [f"{title} @1", "@5", "task @5"]
    rows = [
        (
            name,
            *(cell for title in titles for cell in _cells(found[title])),
            f"{percentile([o.ms for title in titles for o in found[title]], 0.5):.2f}",
        )
        for name, found in results.items()
    ]
    note = (
        "All kinds but task, then task alone. The flat indexes hold the same documents and words as ours; "
        "their milliseconds are for ranking alone, those of SimWorlds for the whole answer."
    )
    return Table("Retrieval by system", (*header, "p50 ms"), tuple(rows), note)


def _kinds_table(ours: dict[str, list[Outcome]]) -> Table:
    present = [kind for kind in KINDS if any(o.query.kind == kind for found in ours.values() for o in found)]
    others = {o.query.kind for found in ours.values() for o in found} - set(KINDS)
    groups: dict[str, Callable[[Outcome], bool]] = {
        kind: (lambda o, kind=kind: o.query.kind == kind) for kind in (*present, *sorted(others))
    }
    groups["all but task"] = lambda o: o.query.kind != TASK
    groups["all"] = lambda _: True
    rows: list[tuple[str, ...]] = []
    for name, belongs in groups.items():
        row = [name]
        for found in ours.values():
            group = [o for o in found if belongs(o)]
            row += [str(len(group)), _two(share(group, 1)), _two(share(group, 5))]
        rows.append(tuple(row))
    header = ["kind"]
    for title in ours:
        header += [f"{title} n", "@1", "@5"]
    return Table("SimWorlds by kind of query", tuple(header), tuple(rows))


def _summaries(results: dict[str, dict[str, list[Outcome]]]) -> dict[str, Any]:
    return {
        name: {
            title: {
                "hit1": share([o for o in found if o.query.kind != TASK], 1),
                "hit5": share([o for o in found if o.query.kind != TASK], 5),
                "task5": share(tasks, 5) if (tasks := [o for o in found if o.query.kind == TASK]) else None,
                "p50_ms": percentile([o.ms for o in found], 0.5),
            }
            for title, found in sets.items()
        }
        for name, sets in results.items()
    }


def _rows(outcomes: Sequence[Outcome]) -> list[dict[str, Any]]:
    return [
        {
            "id": o.query.id, "query": o.query.query, "kind": o.query.kind, "ids": list(o.ids),
            "expected": [*o.query.expect_any, *o.query.expect_pages], "hit1": o.hit(1), "hit5": o.hit(5),
        }
        for o in outcomes
    ]  # fmt: skip


def misses(part: ReportPart) -> str:
    """The queries without a right id among the first five, with what was found and what was expected."""
    lines = ["## Misses", ""]
    for title, found in part.data.get("queries", {}).items():
        for row in found:
            if not row["hit5"]:
                lines.append(f"- {title} {row['id']} — {row['query']}")
                lines.append(f"  - found {', '.join(row['ids'][:4]) or 'nothing'}")
                lines.append(f"  - expected {', '.join(row['expected'][:4])}")
    return "\n".join(lines)
