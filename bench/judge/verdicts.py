"""Verdicts on items, and the judgement that they make together (paper, "Itemized VLM judge")."""

from __future__ import annotations

from collections import Counter
from statistics import fmean
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, NonNegativeFloat, computed_field

from bench.judge.ask import checked_reader
from bench.judge.questions import Verdict, Verdicts
from bench.judge.usage import AnswerCost, TokenUsage

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from simworlds.llm.structured import AnswerReader


_DIGITS = 6
_LONGEST_EVIDENCE = 1000


class JudgedItem(BaseModel):
    """An item and its verdict: ``frames`` (counted from 1) show what ``evidence`` says."""

    model_config = ConfigDict(frozen=True)

    id: str
    text: str
    holds: bool
    evidence: str
    frames: tuple[int, ...] = ()


class Judgement(BaseModel):
    """The judgement of one result. ``dimensions`` are in their order; one without items has no score.

    ``scene`` is a label that no model saw. ``answered_by`` is the model as the provider names it, ``items_by`` who
    listed the items. ``usage`` and ``cost`` (US dollars, None if no price is known) are those of the verdicts;
    ``items_usage`` and ``items_cost`` of the list of items, which is made once for all results of a prompt.
    """

    model_config = ConfigDict(frozen=True)

    scene: str
    provider: str
    model: str
    answered_by: str
    prompt_version: str
    repetition: int
    dimensions: dict[str, tuple[JudgedItem, ...]]
    usage: TokenUsage
    cost: NonNegativeFloat | None
    items_by: str
    items_usage: TokenUsage
    items_cost: NonNegativeFloat | None

    @computed_field
    @property
    def scores(self) -> dict[str, float | None]:
        """Dimension → the share of its items that hold; None without items."""
        return {name: _share(items) for name, items in self.dimensions.items()}

    @computed_field
    @property
    def score(self) -> float | None:
        """The mean over the dimensions that have items."""
        known = [score for score in self.scores.values() if score is not None]
        return round(fmean(known), _DIGITS) if known else None


class CachedVerdicts(BaseModel):
    """Verdicts as they are cached: with the model that gave them, and their cost."""

    model_config = ConfigDict(frozen=True)

    by: str
    verdicts: tuple[Verdict, ...]
    spent: AnswerCost


def verdicts_reader(ids: Collection[str], frames: int) -> AnswerReader[Verdicts]:
    """Accepts exactly one verdict for each item, with evidence in existing frames."""
    return checked_reader(Verdicts, lambda verdicts: _faults(verdicts, ids, frames))


def _faults(verdicts: Verdicts, ids: Collection[str], frames: int) -> Iterator[str]:
    counts = Counter(verdict.id for verdict in verdicts.verdicts)
    yield from (f"{name!r}: the verdict for this item is missing." for name in ids if name not in counts)
    yield from (f"{name[:80]!r}: there is no such item." for name in counts if name not in ids)
    yield from (
        f"{name!r}: there are {times} verdicts for it." for name, times in counts.items() if times > 1
    )
    for verdict in verdicts.verdicts:
        if verdict.id in ids:
            yield from (f"{verdict.id!r}: {fault}" for fault in _faults_of(verdict, frames))


def _faults_of(verdict: Verdict, frames: int) -> Iterator[str]:
    if not verdict.evidence.strip():
        yield "the evidence is missing."
    if len(verdict.evidence) > _LONGEST_EVIDENCE:
        yield f"the evidence is too long ({len(verdict.evidence)} characters; one or two sentences)."
    if missing := sorted({number for number in verdict.frames if not 1 <= number <= frames}):
        yield f"there is no frame {', '.join(map(str, missing))}; they are numbered from 1 to {frames}."
    elif verdict.holds and not verdict.frames:
        yield "it holds, but no frame that shows it is named."
    elif verdict.holds and verdict.id.startswith("actions_visible.") and len(set(verdict.frames)) < 2:
        yield "one frame shows no motion; name at least two that differ."


def _share(items: Sequence[JudgedItem]) -> float | None:
    return round(fmean(item.holds for item in items), _DIGITS) if items else None
