"""Averages, intervals and tests, beside values that were worked out by hand or by brute force."""

from __future__ import annotations

from itertools import product

import numpy
import pytest

from bench.results.statistics import differences, interval, macro, permutation


def test_each_cell_weighs_the_same_however_many_scenes_it_has() -> None:
    assert macro({"a": [1.0, 0.0], "b": [1.0]}) == 0.75
    assert macro({"a": [1.0, 0.0], "b": [1.0], "c": []}) == 0.75
    assert macro({"a": []}) is None


def test_the_interval_is_that_of_all_resamples_within_cells() -> None:
    cells = {"a": [0.1, 0.5, 0.6], "b": [0.2, 0.9, 1.0]}
    means = [[sum(drawn) / 3 for drawn in product(values, repeat=3)] for values in cells.values()]
    every = [(first + second) / 2 for first, second in product(*means)]
    found = interval(cells, draws=100_000)
    assert found == pytest.approx(numpy.quantile(every, [0.025, 0.975]), abs=0.004)


def test_each_cell_is_resampled_separately() -> None:
    # Of [0, 1], the mean of two draws is 0 in one of four cases; the cell of one scene stays as it is.
    assert interval({"a": [0.0, 1.0], "b": [0.5]}) == (0.25, 0.75)


def test_constant_scores_have_a_zero_interval_and_single_scores_none() -> None:
    assert interval({"a": [0.5, 0.5]}) == (0.5, 0.5)
    assert interval({"a": [0.5], "b": [0.7]}) is None
    assert interval({}) is None


def test_the_same_scores_have_the_same_interval_on_every_run() -> None:
    cells = {"a": [0.1, 0.5, 0.6], "b": [0.2, 0.9, 1.0]}
    assert interval(cells) == interval(cells)
    assert interval(cells, seed=1, draws=50) != interval(cells, draws=50)


@pytest.mark.parametrize(
    ("cells", "p"),
    [
        # All of one sign: of 8 ways to swap, this one and its opposite are as far from 0.
        ({"a": [0.1, 0.1, 0.1]}, 2 / 8),
        ({"a": [0.1, 0.2, 0.3]}, 2 / 8),
        # Sums of three signs: ±3 twice, ±1 six times; none is nearer to 0 than the one that was seen.
        ({"a": [0.1, 0.1, -0.1]}, 1.0),
        # Weighted 1/2 and twice 1/4: 0.15, 0.025, 0.025, all of one sign.
        ({"a": [0.3], "b": [0.1, 0.1]}, 2 / 8),
        # 0.15 − 0.05 = 0.1: reached by the two signs of 0.15 ± 0.05.
        ({"a": [0.3], "b": [-0.1]}, 1.0),
        ({"a": [0.3], "b": [0.1]}, 2 / 4),
        # Scenes without a difference cannot be swapped.
        ({"a": [0.0, 0.0, 0.2]}, 1.0),
        ({"a": [0.0, 0.0]}, 1.0),
    ],
)
def test_p_is_the_share_of_swaps_that_are_as_far_from_zero(cells: dict[str, list[float]], p: float) -> None:
    assert permutation(cells) == (p, True)


def test_for_many_scenes_p_is_drawn_and_near_the_exact_one() -> None:
    values = [
        0.03,
        -0.01,
        0.05,
        0.02,
        -0.04,
        0.01,
        0.06,
        -0.02,
        0.03,
        0.04,
        -0.05,
        0.02,
        0.01,
        0.03,
        -0.01,
        0.02,
        0.05,
    ]
    sums = numpy.zeros(1)
    for value in values:
        sums = numpy.concatenate([sums + value, sums - value])
    exact = (abs(sums) >= abs(sum(values)) - 1e-12).mean()
    found = permutation({"a": values})
    assert found is not None
    assert found[0] == pytest.approx(exact, abs=0.01)
    assert not found[1]


def test_p_is_never_zero() -> None:
    assert permutation({"a": [0.1] * 40}) == (1 / 20_001, False)
    assert permutation({}) is None


def test_differences_are_of_scenes_that_both_have() -> None:
    cells = {"one": "a", "two": "a", "three": "b", "four": "b"}
    first, second = {"one": 0.5, "two": 0.25, "three": 1.0}, {"two": 0.5, "three": 0.5, "four": 1.0}
    assert differences(first, second, cells) == {"a": [-0.25], "b": [0.5]}
