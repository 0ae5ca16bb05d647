"""Names and prose together: one ranked list of ids for a query, and whether it was asked for by name."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_serve.rank.search import Found, Searcher
from kb_serve.recognise.identifiers import Identifier
from kb_serve.recognise.message_forms import is_message, prose_of

if TYPE_CHECKING:
    from kb_serve.reader import Reader
    from kb_serve.recognise.corrections import Drift
    from kb_serve.recognise.identified import Identified

SURE = 0.8  # from here on, what was named comes before what was found
_FOUND = 12  # at least: what stands in for a class that is named already must be found too
_CLOSE = 0.6  # share of the closest one's score down to which others are said to be close too


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


def _span_text(drift: Drift) -> str:
    if drift.first == drift.last:
        return f"seen in {drift.last} only"
    return f"seen from {drift.first} to {drift.last}"


class Ranker:
    """Brings what a query names and what it describes into one order."""

    def __init__(self, reader: Reader) -> None:
        self._reader = reader
        self.identifier = Identifier(reader)
        self.searcher = Searcher(reader)

    def rank(self, query: str, limit: int = _FOUND) -> Ranking:
        """The ids that a query leads to; the first ``limit`` of them will be used."""
        identified = self.identifier.identify(query)
        best = identified.best
        if best is not None and best.sure >= 1.0:
            ranked = [Ranked(match.id, match.sure, match.why) for match in identified.matches]
            return Ranking(ranked, identified, named=True, notes=self._notes(identified))
        found = self.searcher.search(prose_of(query), max(limit, _FOUND), failed=is_message(query))
        ranked = self._merged(identified, found)
        named = best is not None and best.sure >= 0.9 and best.why not in {"enum item", "replacement"}
        return Ranking(ranked, identified, named, self._notes(identified))

    def _notes(self, identified: Identified) -> list[str]:
        """What the caller should know about the names that were typed."""
        version = self._reader.meta.get("minor", "this version")
        notes: list[str] = []
        for correction in identified.corrections:
            if correction.similarity < 1:
                notes.append(f"`{correction.written}` does not exist; read as `{correction.meant}`.")
        for drift in identified.drifts:
            close = _CLOSE * max((score for _, score in drift.instead), default=0.0)
            instead = ", ".join(f"`{target}`" for target, score in drift.instead[:3] if score >= close)
            closest = f" Closest in {version}: {instead}." if instead else ""
            notes.append(f"`{drift.path}` does not exist in Blender {version}; {_span_text(drift)}.{closest}")
        former = {drift.path.rpartition(".")[2] for drift in identified.drifts}
        similar = [f"`{match.id}`" for match in identified.matches if match.why == "similar name"][:3]
        closest = f" Closest: {', '.join(similar)}." if similar else ""
        for missing in identified.missing:
            if missing.owner and missing.name not in former:
                notes.append(f"`{missing.owner}` has no `{missing.name}`.{closest}")
        return list(dict.fromkeys((*notes, *identified.said)))

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
