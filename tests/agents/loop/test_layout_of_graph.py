"""Boxes are laid out in layers, without overlap, the same way each time."""

from __future__ import annotations

from itertools import combinations

import pytest

from agents.views.report.graph_layout import LayoutBox, lay_out


def test_higher_ranks_are_higher_and_nothing_overlaps() -> None:
    boxes = [LayoutBox(80, 40, rank) for rank in (0, 1, 1, 1, 2, 2, 2)]
    edges = [(0, 1), (0, 2), (0, 3), (1, 6), (2, 5), (3, 4)]
    laid = lay_out(boxes, edges)
    for (one, (x, y)), (other, (u, v)) in combinations(zip(boxes, laid.centres, strict=True), 2):
        if one.rank < other.rank:
            assert y - one.height / 2 > v + other.height / 2
        elif one.rank == other.rank:
            assert abs(x - u) >= (one.width + other.width) / 2


def test_crossings_are_undone() -> None:
    boxes = [
        LayoutBox(50, 20, 0),
        LayoutBox(50, 20, 0),
        LayoutBox(50, 20, 0),
        LayoutBox(50, 20, 1),
        LayoutBox(50, 20, 1),
        LayoutBox(50, 20, 1),
    ]
    edges = [(0, 5), (1, 4), (2, 3)]
    laid = lay_out(boxes, edges)
    assert all(line[0][0] == pytest.approx(line[-1][0]) for line in laid.lines), "all lines run straight"


def test_a_line_past_a_rank_keeps_clear_of_its_boxes() -> None:
    boxes = [LayoutBox(60, 20, 0), LayoutBox(60, 20, 1), LayoutBox(60, 20, 2)]
    laid = lay_out(boxes, [(0, 1), (1, 2), (0, 2)])
    passing = laid.lines[2][1]
    assert abs(passing[0] - laid.centres[1][0]) > boxes[1].width / 2


def test_lines_begin_and_end_at_the_sides_of_their_boxes() -> None:
    boxes = [LayoutBox(60, 20, 0), LayoutBox(60, 30, 1)]
    (start, end), _ = lay_out(boxes, [(0, 1), (0, 1)]).lines
    (_, low), (_, high) = lay_out(boxes, [(0, 1), (0, 1)]).centres
    assert start[1] == low - 10
    assert end[1] == high + 15


def test_lines_that_leave_a_box_together_leave_it_side_by_side() -> None:
    laid = lay_out(
        [LayoutBox(200, 20, 0), *(LayoutBox(40, 20, 1) for _ in range(4))], [(0, n) for n in range(1, 5)]
    )
    starts = [line[0][0] for line in laid.lines]
    assert len(set(starts)) == 4
    ends = [line[-1][0] for line in laid.lines]
    assert sorted(range(4), key=starts.__getitem__) == sorted(range(4), key=ends.__getitem__)


def test_everything_is_within_the_drawing() -> None:
    boxes = [LayoutBox(30.0 + 7 * n % 50, 20, n % 4) for n in range(30)]
    edges = [(a, b) for a in range(30) for b in range(a) if (a * b) % 7 == 3 and a % 4 != b % 4]
    laid = lay_out(boxes, edges)
    for box, (x, y) in zip(boxes, laid.centres, strict=True):
        assert x - box.width / 2 >= -1e-6
        assert x + box.width / 2 <= laid.width + 1e-6
        assert y - box.height / 2 >= -1e-6
        assert y + box.height / 2 <= laid.height + 1e-6
    assert lay_out(boxes, edges) == laid


def test_nothing_is_laid_out_as_nothing() -> None:
    assert lay_out([], []).lines == ()
