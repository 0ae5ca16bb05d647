"""Agreement statistics, against values computed by hand."""

from __future__ import annotations

import pytest

from bench.judge.agreement import agreement, fleiss_kappa, observed_agreement
from bench.judge.usage import TokenUsage
from bench.judge.verdicts import JudgedItem, Judgement


def judgement(held: dict[str, str], number: int = 0) -> Judgement:
    """A judgement written as dimension → a sign for each item, + or -."""
    dimensions = {
        name: tuple(
            JudgedItem(
                id=f"{name}.{place}", text=f"item {place}", holds=sign == "+", evidence="Seen.", frames=(1,)
            )
            for place, sign in enumerate(signs, 1)
        )
        for name, signs in held.items()
    }
    return Judgement(
        scene="",
        provider="anthropic",
        model="m",
        answered_by="m",
        prompt_version="v",
        repetition=number,
        dimensions=dimensions,
        usage=TokenUsage(),
        cost=None,
        items_by="m",
        items_usage=TokenUsage(),
        items_cost=None,
    )


@pytest.mark.parametrize(
    ("held", "count", "observed", "kappa"),
    [
        # Items of which 3, 0, 2 and 1 of 3 judgements are positive: of the 3 pairs agree 3, 3, 1 and 1, so 8/12; half
        # of the verdicts are positive, so chance is 1/2; (2/3 - 1/2) / (1/2) = 1/3.
        ((3, 0, 2, 1), 3, 2 / 3, 1 / 3),
        # 4, 3, 4 of 4: pairs 6, 3, 6 of 6, so 5/6; 11 of 12 positive: chance 122/144; (120 - 122) / 22 = -1/11.
        ((4, 3, 4), 4, 5 / 6, -1 / 11),
        # Two judgements that always agree, half yes: kappa 1. That never agree: -1.
        ((2, 0), 2, 1.0, 1.0),
        ((1, 1, 1), 2, 0.0, -1.0),
        # 1 of 5 and 4 of 5: pairs 6 of 10 each; half positive: (0.6 - 0.5) / 0.5 = 0.2.
        ((1, 4), 5, 0.6, 0.2),
        # All the same: chance explains it, kappa is not defined.
        ((3, 3, 3), 3, 1.0, None),
        ((0,), 2, 1.0, None),
        # Nothing to compare.
        ((), 3, None, None),
        ((1, 0), 1, None, None),
    ],
)
def test_kappa_and_observed_agreement_are_those_computed_by_hand(held, count, observed, kappa):
    assert observed_agreement(held, count) == (None if observed is None else pytest.approx(observed))
    assert fleiss_kappa(held, count) == (None if kappa is None else pytest.approx(kappa))


def test_judgements_are_compared_item_by_item_and_score_by_score():
    three = [
        judgement({"objects_present": "++-+", "aesthetics": "++"}),
        judgement({"objects_present": "+--+", "aesthetics": "++"}),
        judgement({"objects_present": "+--+", "aesthetics": "++"}),
    ]
    found = agreement(three)
    assert found.judgements == 3
    assert found.shares["objects_present.1"] == 1.0
    assert found.shares["objects_present.2"] == pytest.approx(1 / 3, abs=1e-6)
    assert found.shares["objects_present.3"] == 0.0
    objects = found.dimensions["objects_present"]
    # 3, 1, 0, 3 of 3: pairs 3, 1, 3, 3 of 3 = 5/6; 7 of 12 positive: chance 74/144; (120 - 74) / (144 - 74) = 46/70.
    assert (objects.items, objects.pairwise) == (4, pytest.approx(5 / 6, abs=1e-6))
    assert objects.kappa == pytest.approx(46 / 70, abs=1e-6)
    # Scores 3/4, 1/2, 1/2: mean 7/12, deviations 2, -1, -1 twelfths: sd of a sample √(6/144 / 2) = √3/12.
    assert objects.mean == pytest.approx(7 / 12, abs=1e-6)
    assert objects.sd == pytest.approx(3**0.5 / 12, abs=1e-6)
    taste = found.dimensions["aesthetics"]
    assert (taste.kappa, taste.pairwise, taste.mean, taste.sd) == (None, 1.0, 1.0, 0.0)
    # The score is the mean of both dimensions, so it deviates half as much.
    assert found.overall.sd == pytest.approx(3**0.5 / 24, abs=1e-6)
    assert found.overall.items == 6


def test_a_dimension_without_items_has_no_agreement():
    found = agreement([judgement({"objects_present": "+", "spatial_relations": ""})] * 2)
    none = found.dimensions["spatial_relations"]
    assert (none.items, none.kappa, none.pairwise, none.mean, none.sd) == (0, None, None, None, None)


@pytest.mark.parametrize(
    "judgements",
    [
        [judgement({"objects_present": "+"})],
        [judgement({"objects_present": "+"}), judgement({"objects_present": "++"})],
        [judgement({"objects_present": "+"}), judgement({"aesthetics": "+"})],
    ],
)
def test_one_judgement_or_judgements_of_other_items_are_not_compared(judgements):
    with pytest.raises(ValueError, match="agreement needs"):
        agreement(judgements)
