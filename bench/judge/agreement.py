"""How far repeated judgements of the same frames agree: by item, by dimension, and overall.

Fleiss' kappa for two categories: with n judgements of each of N items, and k_i of them positive, observed agreement is
the mean over items of (k_i (k_i - 1) + (n - k_i)(n - k_i - 1)) / (n (n - 1)), agreement by chance p² + (1 - p)² with p
the share of all verdicts that are positive, and kappa is (observed - chance) / (1 - chance). If all verdicts are the
same, kappa is not defined while observed agreement is 1, so both are reported.
(J. L. Fleiss, "Measuring nominal scale agreement among many raters", 1971.)
"""

from __future__ import annotations

from statistics import fmean, stdev
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from bench.judge.verdicts import JudgedItem, Judgement

_DIGITS = 6


class AgreementScores(BaseModel):
    """The agreement on one dimension, or on all items.

    ``pairwise``: the share of pairs of judgements that agree on an item, over all items. ``mean`` and ``sd`` (of a
    sample) are those of the score. None: not defined.
    """

    model_config = ConfigDict(frozen=True)

    items: int
    kappa: float | None
    pairwise: float | None
    mean: float | None
    sd: float | None


class Agreement(BaseModel):
    """The agreement of repeated judgements. ``shares``: item → the share of judgements in which it holds."""

    model_config = ConfigDict(frozen=True)

    judgements: int
    shares: dict[str, float]
    dimensions: dict[str, AgreementScores]
    overall: AgreementScores


def agreement(judgements: Sequence[Judgement]) -> Agreement:
    """The agreement of at least two judgements of the same items. Raises ValueError otherwise."""
    if len(judgements) < 2:
        raise ValueError("agreement needs at least two judgements")
    first = judgements[0]
    if any(_items_asked(judgement.dimensions) != _items_asked(first.dimensions) for judgement in judgements):
        raise ValueError("agreement needs judgements of the same items")
    count = len(judgements)
    held_by_dimension = {
        name: [
            sum(judgement.dimensions[name][place].holds for judgement in judgements)
            for place in range(len(items))
        ]
        for name, items in first.dimensions.items()
    }
    shares = {
        item.id: round(times / count, _DIGITS)
        for name, items in first.dimensions.items()
        for item, times in zip(items, held_by_dimension[name], strict=True)
    }
    return Agreement(
        judgements=count,
        shares=shares,
        dimensions={
            name: _scores_of(times, count, [judgement.scores[name] for judgement in judgements])
            for name, times in held_by_dimension.items()
        },
        overall=_scores_of(
            [count_held for times in held_by_dimension.values() for count_held in times],
            count,
            [judgement.score for judgement in judgements],
        ),
    )


def observed_agreement(held: Sequence[int], count: int) -> float | None:
    """The mean share of pairs of judgements that agree on an item, of which ``held[i]`` of ``count`` are positive."""
    if count < 2 or not held:
        return None
    pairs = count * (count - 1)
    return fmean((times * (times - 1) + (count - times) * (count - times - 1)) / pairs for times in held)


def fleiss_kappa(held: Sequence[int], count: int) -> float | None:
    """Fleiss' kappa of binary verdicts: for item i, ``held[i]`` of ``count`` are positive. None if not defined."""
    observed = observed_agreement(held, count)
    verdicts = count * len(held)
    if observed is None or sum(held) in (0, verdicts):
        return None
    share = sum(held) / verdicts
    chance = share**2 + (1 - share) ** 2
    return (observed - chance) / (1 - chance)


def _scores_of(held: Sequence[int], count: int, scores: Sequence[float | None]) -> AgreementScores:
    known = [score for score in scores if score is not None]
    return AgreementScores(
        items=len(held),
        kappa=_rounded(fleiss_kappa(held, count)),
        pairwise=_rounded(observed_agreement(held, count)),
        mean=_rounded(fmean(known) if known else None),
        sd=_rounded(stdev(known) if len(known) > 1 else None),
    )


def _items_asked(judged: Mapping[str, Sequence[JudgedItem]]) -> dict[str, list[tuple[str, str]]]:
    return {name: [(item.id, item.text) for item in items] for name, items in judged.items()}


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, _DIGITS)
