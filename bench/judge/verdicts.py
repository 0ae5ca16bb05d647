"""Verdicts on items, and the judgement that they make together (paper, "Itemized VLM judge")."""

from __future__ import annotations

from collections import Counter
from statistics import fmean
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, NonNegativeFloat, computed_field

from bench.judge.questions import Verdict, Verdicts
from bench.judge.usage import Spent, Usage
from simworlds.llm.structured import AnswerReader, fits

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

_DIGITS = 6
_LONGEST_EVIDENCE = 1000


class Item(BaseModel):
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
    dimensions: dict[str, tuple[Item, ...]]
    usage: Usage
    cost: NonNegativeFloat | None
    items_by: str
    items_usage: Usage
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


class Given(BaseModel):
    """Verdicts as they are cached: with the model that gave them, and their cost."""

    model_config = ConfigDict(frozen=True)

    by: str
    verdicts: tuple[Verdict, ...]
    spent: Spent


def reader_of(ids: Collection[str], frames: int) -> AnswerReader[Verdicts]:
    """Accepts exactly one verdict for each item, with evidence in existing frames."""
    shaped = fits(Verdicts)

    def reader(data: Any) -> tuple[Verdicts | None, Sequence[object]]:
        found, wrong = shaped(data)
        if found is None:
            return None, wrong
        faults = list(_faults(found, ids, frames))
        return (None, faults) if faults else (found, [])

    return reader


def _faults(found: Verdicts, ids: Collection[str], frames: int) -> Iterator[str]:
    given = Counter(one.id for one in found.verdicts)
    yield from (f"{name!r}: the verdict for this item is missing." for name in ids if name not in given)
    yield from (f"{name[:80]!r}: there is no such item." for name in given if name not in ids)
    yield from (f"{name!r}: there are {times} verdicts for it." for name, times in given.items() if times > 1)
    for one in found.verdicts:
        if one.id in ids:
            yield from (f"{one.id!r}: {fault}" for fault in _faults_of(one, frames))


def _faults_of(one: Verdict, frames: int) -> Iterator[str]:
    if not one.evidence.strip():
        yield "the evidence is missing."
    if len(one.evidence) > _LONGEST_EVIDENCE:
        yield f"the evidence is too long ({len(one.evidence)} characters; one or two sentences)."
    if none := sorted({number for number in one.frames if not 1 <= number <= frames}):
        yield f"there is no frame {', '.join(map(str, none))}; they are numbered from 1 to {frames}."
    elif one.holds and not one.frames:
        yield "it holds, but no frame that shows it is named."
    elif one.holds and one.id.startswith("actions_visible.") and len(set(one.frames)) < 2:
        yield "one frame shows no motion; name at least two that differ."


def _share(items: Sequence[Item]) -> float | None:
    return round(fmean(item.holds for item in items), _DIGITS) if items else None
