"""Names and prose together: one ranked list of ids for a query, and whether it was asked for by name."""

from __future__ import annotations

from dataclasses import dataclass, field

from kb_serve.identifiers import Identified, Identifier
from kb_serve.reader import Reader
from kb_serve.search import Found, Searcher

SURE = 0.8  # from here on, what was named comes before what was found
_FOUND = 40


@dataclass(frozen=True, slots=True)
class Ranked:
    """One id with the reason why it is here; ``score`` falls from 1 down the list."""

    id: str
    score: float
    why: str
    anchor: str = ""


@dataclass(slots=True)
class Ranking:
    """Everything a query leads to, best first. ``named`` when the first was asked for by its name."""

    ranked: list[Ranked]
    identified: Identified
    named: bool
    notes: list[str] = field(default_factory=list)


class Ranker:
    """Brings what a query names and what it describes into one order."""

    def __init__(self, reader: Reader) -> None:
        self._reader = reader
        self.identifier = Identifier(reader)
        self.searcher = Searcher(reader)

    def rank(self, query: str) -> Ranking:
        """The ids that a query leads to."""
        identified = self.identifier.identify(query)
        best = identified.best
        if best is not None and best.sure >= 1.0:
            ranked = [Ranked(match.id, match.sure, match.why) for match in identified.matches]
            return Ranking(ranked, identified, named=True)
        found = self.searcher.search(query, _FOUND)
        ranked = self._merged(identified, found)
        named = best is not None and best.sure >= 0.9
        return Ranking(ranked, identified, named)

    @staticmethod
    def _merged(identified: Identified, found: list[Found]) -> list[Ranked]:
        """Sure names first, then what was found; unsure names stand behind the first three found."""
        sure = [Ranked(match.id, match.sure, match.why) for match in identified.matches if match.sure >= SURE]
        maybe = [Ranked(match.id, match.sure, match.why) for match in identified.matches if match.sure < SURE]
        top = found[0].score if found else 1.0
        prose = [Ranked(f.ref, SURE * f.score / top, "found", f.anchor) for f in found]
        merged: dict[str, Ranked] = {}
        for row in (*sure, *prose[:3], *maybe, *prose[3:]):
            merged.setdefault(row.id, row)
        return list(merged.values())
