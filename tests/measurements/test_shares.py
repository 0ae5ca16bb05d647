from __future__ import annotations

import pytest

from measurements.shares import count_of, share_figure, share_of


@pytest.mark.parametrize(
    ("met", "share", "count"),
    [([], 0.0, "0 of 0"), ([True, False, True, True], 0.75, "3 of 4"), ([True], 1.0, "1 of 1")],
)
def test_a_share_is_of_what_was_asked(met: list[bool], share: float, count: str) -> None:
    assert (share_of(met), count_of(met)) == (share, count)


def test_a_figure_says_what_its_share_was_made_of() -> None:
    figure = share_figure("told_names", (word > "b" for word in "abcd"))
    assert (figure.key, figure.value, figure.note) == ("told_names", 0.5, "2 of 4")
