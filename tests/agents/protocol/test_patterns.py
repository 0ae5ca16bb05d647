"""How well places fit a pattern, against what geometry says."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from agents.protocol.judging.geometry.patterns import fit_circle, fit_grid, fit_line, mirror_error

if TYPE_CHECKING:
    import numpy.typing as npt

    Array = npt.NDArray[np.float64]

TILTED = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [0.0, 1.0, 1.0], [0.7, 0.0, 1.0]]))[0]
FAR = np.array([30.0, -12.0, 4.0])


def ring(*degrees: float, radius: float = 2.0) -> Array:
    """Places around the origin, in the XY plane."""
    turns = np.radians(degrees)
    return np.stack([radius * np.cos(turns), radius * np.sin(turns), np.zeros(len(turns))], axis=1)


def lattice(rows: int, columns: int, step: tuple[float, float]) -> Array:
    """A grid of places in the XY plane."""
    return np.array(
        [[row * step[0], column * step[1], 0.0] for row in range(rows) for column in range(columns)]
    )


# Circles and arcs


@pytest.mark.parametrize("turn", [np.eye(3), TILTED])
def test_a_circle_has_its_radius_its_centre_and_even_gaps_wherever_it_lies(turn: Array) -> None:
    found = fit_circle(ring(0, 60, 120, 180, 240, 300) @ turn.T + FAR)
    assert found.radii == pytest.approx([2.0] * 6)
    assert found.centre == pytest.approx(FAR)
    assert found.gaps == pytest.approx([60.0] * 6)
    assert found.heights == pytest.approx([0.0] * 6, abs=1e-9)


def test_the_order_of_the_members_is_of_no_account() -> None:
    found = fit_circle(ring(190, 10, 280, 100))
    assert found.gaps == pytest.approx([90.0] * 4)
    assert found.order == (1, 3, 0, 2)


def test_a_member_that_is_out_of_its_place_shows_in_the_gaps_beside_it() -> None:
    found = fit_circle(ring(0, 97, 180, 270), np.zeros(3))
    assert dict(zip(found.order, found.gaps, strict=True)) == pytest.approx({0: 97, 1: 83, 2: 90, 3: 90})


def test_a_member_nearer_to_a_known_centre_is_off_by_all_of_that() -> None:
    places = ring(0, 90, 180, 270)
    places[1] *= 0.9
    assert fit_circle(places, np.zeros(3)).radii == pytest.approx([2, 1.8, 2, 2])


def test_a_known_centre_counts_only_in_the_plane() -> None:
    found = fit_circle(ring(0, 90, 180, 270), np.array([0.0, 0.0, 5.0]))
    assert found.centre == pytest.approx([0, 0, 0])
    assert found.radii == pytest.approx([2.0] * 4)


def test_a_raised_member_is_out_of_the_plane_of_the_others() -> None:
    places = ring(*range(0, 360, 30))
    places[3, 2] = 0.1
    # The plane of twelve tilts a little towards one of them: by a quarter of what it is raised.
    assert np.abs(fit_circle(places).heights).max() == pytest.approx(0.075, rel=0.05)


def test_heights_that_hardly_differ_do_not_tilt_the_plane_of_a_short_arc() -> None:
    places = ring(0, 2, 4, 6)
    places[1, 2] = 2e-4
    found = fit_circle(places, closed=False)
    assert found.normal == pytest.approx([0, 0, 1])
    assert found.radii == pytest.approx([2.0] * 4, rel=1e-3)


@pytest.mark.parametrize(
    ("turns", "arc", "gaps"),
    [
        ((-45, 0, 45, 90), None, [45, 45, 45]),
        ((300, 340, 20, 60), None, [40, 40, 40]),
        # An arc may be longer than what it leaves open: even gaps tell, not the widest.
        ((0, 100, 200, 300), None, [100, 100, 100]),
        ((0, 150), None, [150]),
        ((0, 150), 210, [210]),
    ],
)
def test_an_arc_is_open_where_the_rest_is_even(
    turns: tuple[float, ...], arc: float | None, gaps: list[float]
) -> None:
    assert fit_circle(ring(*turns), np.zeros(3), closed=False, arc=arc).gaps == pytest.approx(gaps)


def test_an_arc_begins_after_its_opening() -> None:
    assert fit_circle(ring(20, 300, 60, 340), closed=False).order == (1, 3, 0, 2)


def test_places_on_a_line_are_no_circle() -> None:
    places = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]])
    found = fit_circle(places)
    assert np.ptp(found.radii) > 0.5 * found.radii.mean()


def test_places_on_one_spot_have_no_radius() -> None:
    assert fit_circle(np.tile(FAR, (4, 1))).radii == pytest.approx([0.0] * 4, abs=1e-6)


# Lines


@pytest.mark.parametrize("turn", [np.eye(3), TILTED])
def test_a_line_has_its_gaps_wherever_it_lies(turn: Array) -> None:
    places = np.array([[0.3, 0, 0], [0, 0, 0], [0.1, 0, 0]]) @ turn.T + FAR
    found = fit_line(places)
    assert found.beside == pytest.approx([0, 0, 0], abs=1e-9)
    assert sorted(found.gaps) == pytest.approx([0.1, 0.2])
    assert found.length == pytest.approx(0.3)
    assert found.order in {(1, 2, 0), (0, 2, 1)}


def test_the_middle_of_three_stands_beside_the_line_by_two_thirds_of_its_way() -> None:
    found = fit_line(np.array([[0.0, 0, 0], [1, 0.03, 0], [2, 0, 0]]))
    assert found.beside == pytest.approx([0.01, 0.02, 0.01], rel=1e-3)


def test_places_on_one_spot_have_no_length() -> None:
    assert fit_line(np.tile(FAR, (3, 1))).length == pytest.approx(0)


# Grids


@pytest.mark.parametrize("turn", [np.eye(3), TILTED])
@pytest.mark.parametrize("step", [(1.0, 1.0), (0.2, 1.0), (1.0, 0.15)])
def test_a_grid_has_its_steps_and_its_shape_wherever_it_lies(turn: Array, step: tuple[float, float]) -> None:
    found = fit_grid(np.random.default_rng(3).permutation(lattice(3, 5, step)) @ turn.T + FAR)
    assert found is not None
    assert found.full
    assert sorted(found.spacing) == pytest.approx(sorted(step))
    assert sorted(found.shape) == [3, 5]
    assert found.off == pytest.approx([0] * 15, abs=1e-9)


@pytest.mark.parametrize("shape", [(2, 2), (3, 3), (4, 6)])
def test_a_displaced_member_is_off_by_as_much_as_it_was_displaced(shape: tuple[int, int]) -> None:
    places = lattice(*shape, (1.0, 1.0))
    places[1, 2] += 0.08
    found = fit_grid(places)
    assert found is not None
    assert found.full
    assert found.off[1] == pytest.approx(0.08)
    assert found.off.max() == pytest.approx(0.08)


def test_a_long_grid_whose_places_waver_is_still_counted_right() -> None:
    wavering = np.random.default_rng(11).uniform(-0.02, 0.02, (60, 3))
    found = fit_grid(lattice(20, 3, (1.0, 1.3)) + wavering)
    assert found is not None
    assert found.full
    assert sorted(found.shape) == [3, 20]
    assert found.off.max() < 0.045


def test_a_grid_with_a_hole_is_not_full() -> None:
    found = fit_grid(np.delete(lattice(3, 4, (1.0, 1.0)), 5, axis=0))
    assert found is not None
    assert not found.full
    assert sorted(found.shape) == [3, 4]


def test_two_members_at_one_crossing_do_not_make_it_full() -> None:
    places = lattice(3, 3, (1.0, 1.0))
    places[4] = places[0] + 0.01
    found = fit_grid(places)
    assert found is not None
    assert not found.full


@pytest.mark.parametrize("places", [lattice(1, 4, (1.0, 1.0)), np.tile(FAR, (4, 1))])
def test_what_spans_no_plane_is_no_grid(places: Array) -> None:
    assert fit_grid(places) is None


# Mirrors


def test_pairs_are_found_whatever_their_order() -> None:
    places = np.array([[1.0, 0, 0], [2, 1, 0], [-2, 1, 0], [-1, 0, 0], [0, 5, 0]])
    assert mirror_error(places, np.zeros(3), np.array([3.0, 0, 0]))[0] == pytest.approx(0)


def test_the_plane_may_be_anywhere() -> None:
    normal = np.array([1.0, 1.0, 0.0])
    places = np.array([[4.0, 1.0, 2.0], [3.0, 0.0, 2.0]]) + FAR
    point = np.array([3.5, 0.5, 0.0]) + FAR
    assert mirror_error(places, point, normal)[0] == pytest.approx(0, abs=1e-9)


def test_a_member_beside_its_mirrored_place_is_told_with_its_distance() -> None:
    places = np.array([[1.0, 0, 0], [-1, 0, 0], [2, 0, 0], [-2, 0.25, 0]])
    off, who = mirror_error(places, np.zeros(3), np.array([1.0, 0, 0]))
    assert off == pytest.approx(0.25)
    assert who in {2, 3}


def test_a_member_without_a_partner_shows_even_in_the_pairing_that_is_best_for_the_worst() -> None:
    places = np.array([[1.0, 0, 0], [-1, 0, 0], [3, 0, 0]])
    off, _ = mirror_error(places, np.zeros(3), np.array([1.0, 0, 0]))
    assert off == pytest.approx(2)


def test_everybody_needs_a_partner_of_their_own() -> None:
    # Two on the right, near the mirror image of the one on the left: only one of them can have it.
    places = np.array([[-1.0, 0, 0], [1, 0, 0], [1, 0.1, 0]])
    off, _ = mirror_error(places, np.zeros(3), np.array([1.0, 0, 0]))
    assert off == pytest.approx(2)
