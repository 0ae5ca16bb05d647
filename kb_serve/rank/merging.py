"""Names and prose together: one ranked list of ids for a query, and whether it was asked for by name."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from kb_serve.recognise.message_patterns import is_message, prose_of
from kb_serve.recognise.recogniser import Recogniser

if TYPE_CHECKING:
    from kb_serve.rank.search import Searcher, SearchHit
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.corrections import RemovedSymbol
    from kb_serve.recognise.recognition import Recognition

SURE = 0.8  # from here on, what was named comes before what was found
_FOUND = 12  # at least: what stands in for a class that is named already must be found too
_CLOSE = 0.6  # share of the closest one's score down to which others are said to be close too


@dataclass(frozen=True, slots=True)
class RankedId:
    """One id with the reason why it is here; ``score`` falls from 1 down the list."""

    id: str
    score: float
    why: str
    anchor: str = ""


@dataclass(slots=True)
class Ranking:
    """Everything a query leads to, best first. ``named`` when the first was asked for by its name."""

    ranked: list[RankedId]
    recognition: Recognition
    named: bool
    notes: list[str] = field(default_factory=list)


def _span_text(removed: RemovedSymbol) -> str:
    if removed.first == removed.last:
        return f"seen in {removed.last} only"
    return f"seen from {removed.first} to {removed.last}"


class QueryRanker:
    """Brings what a query names and what it describes into one order."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._recogniser = Recogniser(reader)

    @cached_property
    def searcher(self) -> Searcher:
        """The search in plain words; loaded, with numpy, by the first query that is not just a name."""
        from kb_serve.rank.search import Searcher  # noqa: PLC0415

        return Searcher(self._reader)

    def rank(self, query: str, limit: int = _FOUND) -> Ranking:
        """The ids that a query leads to; the first ``limit`` of them will be used."""
        recognition = self._recogniser.recognise(query)
        best = recognition.best
        if best is not None and best.sure >= 1.0:
            ranked = [RankedId(match.id, match.sure, match.why) for match in recognition.matches]
            return Ranking(ranked, recognition, named=True, notes=self._notes(recognition))
        found = self.searcher.search(prose_of(query), max(limit, _FOUND), failed=is_message(query))
        ranked = self._merged(recognition, found)
        named = best is not None and best.sure >= 0.9 and best.why not in {"enum item", "replacement"}
        return Ranking(ranked, recognition, named, self._notes(recognition))

    def _notes(self, recognition: Recognition) -> list[str]:
        """What the caller should know about the names that were typed."""
        version = self._reader.meta.get("minor", "this version")
        notes: list[str] = []
        for correction in recognition.corrections:
            if correction.similarity < 1:
                notes.append(f"`{correction.written}` does not exist; read as `{correction.meant}`.")
        for removed in recognition.removed:
            close = _CLOSE * max((score for _, score in removed.instead), default=0.0)
            instead = ", ".join(f"`{target}`" for target, score in removed.instead[:3] if score >= close)
            closest = f" Closest in {version}: {instead}." if instead else ""
            notes.append(
                f"`{removed.path}` does not exist in Blender {version}; {_span_text(removed)}.{closest}"
            )
        former = {removed.path.rpartition(".")[2] for removed in recognition.removed}
        similar = [f"`{match.id}`" for match in recognition.matches if match.why == "similar name"][:3]
        closest = f" Closest: {', '.join(similar)}." if similar else ""
        for missing in recognition.missing:
            if missing.owner and missing.name not in former:
                notes.append(f"`{missing.owner}` has no `{missing.name}`.{closest}")
        return list(dict.fromkeys((*notes, *recognition.notes)))

    @staticmethod
    def _merged(recognition: Recognition, found: list[SearchHit]) -> list[RankedId]:
        """Sure names first, then what was found; unsure names stand behind the first three found."""
        sure = [
            RankedId(match.id, match.sure, match.why) for match in recognition.matches if match.sure >= SURE
        ]
        maybe = [
            RankedId(match.id, match.sure, match.why) for match in recognition.matches if match.sure < SURE
        ]
        top = found[0].score if found else 1.0
        prose = [RankedId(f.ref, SURE * f.score / top, "found", f.anchor) for f in found]
        merged: dict[str, RankedId] = {}
        for row in (*sure, *prose[:3], *maybe, *prose[3:]):
            merged.setdefault(row.id, row)
        return list(merged.values())
