"""Merges what a query names with what the search finds: one ranked list of ids, with notes."""

from __future__ import annotations

import builtins
import re
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.index.analysis import STOP_WORDS, stems_of, words
from kb_serve.rank.asked_words import SCRIPT_WORDS
from kb_serve.rank.deprecated import replacement
from kb_serve.rank.meant_names import MeantNames
from kb_serve.rank.nodes.asked_sockets import AskedSockets
from kb_serve.rank.nodes.named_nodes import named_nodes
from kb_serve.rank.opposites import opposites_last
from kb_serve.rank.ranked_id import RankedId
from kb_serve.rank.sections import asked_section
from kb_serve.recognise.chains.variables import is_short_form
from kb_serve.recognise.message_patterns import is_message, prose_of
from kb_serve.recognise.notes import Notes
from kb_serve.recognise.recogniser import Recogniser
from kb_serve.recognise.unwanted import without_unwanted

if TYPE_CHECKING:
    from collections.abc import Callable

    from kb_serve.rank.search import Searcher, SearchHit
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

SURE = 0.8  # from here on, named ids come before search hits
_FAR = 0.5  # share of the best hit's score below which another one is far from it
_ALWAYS = 5  # hits for a description that are listed however far they are
_NAMES = 4  # so many of those listed are symbols, if the search finds some that are not
_TOO_FAR = 0.25  # share of the best hit's score below which a symbol does not help either
_HARDLY_WORSE = 0.85  # share of the best page's score from which on a name comes before it
_NEAR = 8  # of the best ids
_LEAST_BESIDE = 3  # words beside code that are a question of their own
_MARKS = ".,:;?!()'\""
_ROOT = re.compile(r"(?<![\w.])([^\W\d]\w*)(?=(\.[^\W\d]|\[|\((?!\))))")  # of an expression, and what follows
_FUNCTIONS = frozenset(name for name in dir(builtins) if name.islower())
_OPERATORS = "bpy.ops"
_MOST_NODES = 2  # that a question calls by their labels, beside what was found
_LEAST_HITS = 20  # of the search, so that it also finds alternatives to a named class, and names beside pages


@dataclass(slots=True)
class Ranking:
    """The ids for a query, best first. ``named`` tells whether the query names the first, ``alike`` what else of its
    name may be meant.
    """

    ranked: list[RankedId]
    recognition: Recognition
    named: bool
    notes: list[str] = field(default_factory=list)
    alike: str = ""

    def listed(self, limit: int, is_page: Callable[[str], bool]) -> list[RankedId]:
        """The first ``limit`` ids, without what the search found far below its best.

        A description's first few are listed in any case, as the search may have misjudged it. What follows makes up
        for symbols that they lack: a page tells how, but code needs names. Those that are far from the best are of
        one chapter with one of the first: others have hardly ever to do with the question.
        """
        kept = 1 if self.named else _ALWAYS
        first, rest = self.ranked[: min(kept, limit)], self.ranked[kept:]
        room = max(0, limit - kept)
        lacking = 0 if self.named else _NAMES - sum(not is_page(row.id) for row in first)
        chapters = {row.chapter for row in first}
        names = [
            row
            for row in rest
            if row.score >= (_TOO_FAR if row.chapter in chapters else _FAR) * SURE and not is_page(row.id)
        ]
        names = names[: min(room, max(0, lacking))]
        near = [row for row in rest if row not in names and (row.why != "found" or row.score >= _FAR * SURE)]
        chosen = {row.id for row in (*names, *near[: room - len(names)])}
        return [*first, *(row for row in rest if row.id in chosen)]


def _without_code(prose: str, recognition: Recognition) -> tuple[str, str]:
    """(a question without the code in it that was recognised, that code): words beside code say what is wanted of it.

    A question that is little else stays whole.
    """
    code = [source for source, *_ in recognition.readings if source in prose]
    if not code:
        return prose, ""
    rest = prose
    for source in code:
        rest = rest.replace(source, " ")
    if sum(word not in STOP_WORDS for word in words(rest)) < _LEAST_BESIDE:
        return prose, ""
    return rest, " ".join(code)


def _without_roots(text: str) -> str:
    """A text without what its code begins with and no question is about: short names of variables, Python's own
    functions. As words, ``obj`` is a file format, and ``len`` a lens.
    """
    return _ROOT.sub(lambda root: " " if _tells_nothing(root[1], root[2]) else root[0], text)


def _tells_nothing(name: str, behind: str) -> bool:
    return name in _FUNCTIONS if behind == "(" else is_short_form(name)


class QueryRanker:
    """Ranks the ids that a query names or describes."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._recogniser = Recogniser(reader)
        self._notes = Notes(reader)
        self._meant = MeantNames(reader, lambda: self.searcher)
        self._sockets = AskedSockets(reader)

    @cached_property
    def searcher(self) -> Searcher:
        """The search in plain words; loaded, with numpy, by the first query that is not just a name."""
        from kb_serve.rank.search import Searcher  # noqa: PLC0415

        return self._reader.shared(Searcher)

    def rank(self, query: str, limit: int = _LEAST_HITS, about: str = "") -> Ranking:
        """The ids for a query, at least ``limit`` of them if there are; ``about``: see Searcher.search."""
        query, operators, without = without_unwanted(query)
        recognition = self._recogniser.recognise(query)
        best = recognition.best
        if best is not None and best.sure >= 1.0 and best.why != "successor":
            ranked = [RankedId(match.id, match.sure, match.why) for match in recognition.matches]
            return Ranking(ranked, recognition, named=True, notes=self._notes.on(recognition))
        # What the words find would pass for the successor, or has nothing to do with it.
        if recognition.dead_end or recognition.says_all:
            by_chance = {"enum item"} if recognition.says_all else set[str]()
            sure = (m for m in recognition.matches if m.sure >= SURE and m.why not in by_chance)
            ranked = [RankedId(m.id, m.sure, m.why) for m in sure]
            return Ranking(ranked, recognition, named=False, notes=self._notes.on(recognition))
        self._meant.add(recognition)
        prose = prose_of(query)
        self._sockets.add(prose, recognition)
        asked, code = _without_code(prose, recognition)
        hits = self.searcher.search(
            _without_roots(asked),
            max(limit, _LEAST_HITS),
            failed=is_message(query),
            about=f"{about} {code}".strip(),
        )
        ranked = opposites_last(self._replaced(self._merged(recognition, hits)), asked)
        if not SCRIPT_WORDS.isdisjoint(word.strip(_MARKS) for word in query.lower().split()):
            ranked = self._name_first(ranked)
        if not operators:
            ranked.sort(key=self._far_from_functions)
        if without:
            ranked.sort(key=lambda row: without in stems_of(row.id))
        ranked[:1] = [self._at_its_section(row, prose) for row in ranked[:1]]
        named = best is not None and best.sure >= 0.9 and best.why not in {"enum item", "replacement"}
        named = named and not recognition.is_open
        alike = self._notes.alike(recognition) if named else ""
        if not is_message(query):
            ranked = self._with_named_nodes(ranked, asked)
        return Ranking(ranked, recognition, named, self._notes.on(recognition), alike)

    def _with_named_nodes(self, ranked: list[RankedId], asked: str) -> list[RankedId]:
        """The same ids, with the nodes that the question calls by their labels behind the first of them."""
        first = max(_ALWAYS, sum(row.why != "found" for row in ranked))
        told = {row.id for row in ranked[:first]}
        nodes = [node for node in named_nodes(asked, self._reader) if node not in told][:_MOST_NODES]
        last = ranked[:first][-1].score if ranked else SURE
        rest = [row for row in ranked[first:] if row.id not in nodes]
        return [*ranked[:first], *(RankedId(path, last, "beside") for path in nodes), *rest]

    def _replaced(self, ranked: list[RankedId]) -> list[RankedId]:
        """The same ids, each deprecated one that was found behind what takes its place."""
        rows: dict[str, RankedId] = {}
        for row in ranked:
            other = replacement(row.id, self._reader) if row.why == "found" and row.id not in rows else ""
            if other:
                rows.setdefault(other, row._replace(id=other))
            rows.setdefault(row.id, row)
        return list(rows.values())

    def _name_first(self, ranked: list[RankedId]) -> list[RankedId]:
        """The same ids; where a page of the manual is the best, after the first name that is hardly worse: who writes a
        script reads what to call first, and then what the window has for it.
        """
        if not ranked or ranked[0].why != "found" or not self._is_of_manual(ranked[0].id):
            return ranked
        least = _HARDLY_WORSE * ranked[0].score
        near = (
            row for row in ranked[1:_NEAR] if row.score >= least and not self._reader.manual.is_page(row.id)
        )
        if (first := next(near, None)) is None:
            return ranked
        rest = (row for row in ranked if row is not first)
        return [first._replace(score=ranked[0].score), *rest]

    def _is_of_manual(self, slug: str) -> bool:
        page = self._reader.manual.page_entry(slug) if self._reader.manual.is_page(slug) else None
        return page is not None and page.source == "manual"

    def _far_from_functions(self, row: RankedId) -> int:
        """Where an id stands for who wants no operators: what a script can use instead, what explains it, the rest."""
        if row.id.startswith(_OPERATORS):
            return 2
        return int(row.score < _FAR * SURE or self._reader.manual.is_page(row.id))

    def _at_its_section(self, row: RankedId, prose: str) -> RankedId:
        """A page that was found as a whole, with the section that is asked for."""
        is_whole = row.why == "found" and not row.anchor and self._reader.manual.is_page(row.id)
        page = self._reader.manual.page(row.id) if is_whole else None
        if page is None or len(page.sections) == 1:
            return row
        return row._replace(anchor=asked_section(page, self.searcher.words.concepts(prose)))

    @staticmethod
    def _merged(recognition: Recognition, hits: list[SearchHit]) -> list[RankedId]:
        """Sure names first, then the search hits, with unsure names after the first three."""
        sure = [
            RankedId(match.id, match.sure, match.why) for match in recognition.matches if match.sure >= SURE
        ]
        maybe = [
            RankedId(match.id, match.sure, match.why) for match in recognition.matches if match.sure < SURE
        ]
        top = hits[0].score if hits else 1.0
        prose = [
            RankedId(hit.ref, SURE * hit.score / top, "found", hit.anchor, hit.members, hit.chapter)
            for hit in hits
        ]
        merged: dict[str, RankedId] = {}
        for row in (*sure, *prose[:3], *maybe, *prose[3:]):
            merged.setdefault(row.id, row)
        return list(merged.values())
