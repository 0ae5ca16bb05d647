"""Solids of many closed pieces: where pieces touch, and where small ones are all around a large one."""

from __future__ import annotations

import numpy
import pytest

pytest.importorskip("bpy", exc_type=ImportError)

from agents.blender.inside.geometry.contact_points import contact_points
from agents.blender.inside.geometry.solids import Solid

pytestmark = pytest.mark.blender

Span = tuple[tuple[float, float, float], tuple[float, float, float]]
FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def solid(*spans: Span) -> Solid:
    """Boxes between two corners, as closed pieces of one mesh."""
    points: list[tuple[float, float, float]] = []
    triangles: list[tuple[int, int, int]] = []
    for low, high in spans:
        first = len(points)
        points += [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
        for a, b, c, d in FACES:
            triangles += [(first + a, first + b, first + c), (first + a, first + c, first + d)]
    return Solid("Boxes", numpy.array(points), numpy.array(triangles))


# A frame, and a sash in it, whose members lie flush against each other.
SASH = solid(
    ((-0.05, 0.0, 0.9), (0.05, 0.05, 2.2)),
    ((-0.05, 0.05, 2.15), (0.05, 1.25, 2.2)),
    ((-0.028, 0.05, 0.95), (0.028, 0.09, 2.15)),
    ((-0.028, 0.09, 2.11), (0.028, 0.58, 2.15)),
)


@pytest.mark.parametrize(
    ("place", "inside"),
    [
        ((-0.002, 0.0998, 2.099), False),  # two of three rays from here pass where members touch
        ((-0.002, 0.07, 1.5), True),
        ((-0.002, 0.04, 1.5), True),
        ((-0.002, 0.3, 1.5), False),
        ((-0.002, 0.3, 2.14), True),
        ((0.0, -0.01, 1.5), False),
    ],
)
def test_a_place_beside_pieces_that_touch_is_outside(place: tuple[float, float, float], inside: bool) -> None:
    assert SASH.holds(place) == inside


def test_a_hollow_of_reversed_faces_stays_a_hollow() -> None:
    outer, inner = solid(((0, 0, 0), (3, 3, 3))), solid(((1, 1, 1), (2, 2, 2)))
    shell = Solid(
        "Shell",
        numpy.concatenate([outer.points, inner.points]),
        numpy.concatenate([outer.triangles, inner.triangles[:, ::-1] + len(outer.points)]),
    )
    assert shell.holds((0.5, 1.5, 1.5))
    assert not shell.holds((1.5, 1.5, 1.5))


def test_a_fringe_does_not_hide_the_slab_that_it_hangs_on() -> None:
    threads: list[Span] = []
    for number in range(500):
        y = -1 + number / 250
        threads += [((1, y, 0.0004), (1.05, y + 0.001, 0.004)), ((-1.05, y, 0.0004), (-1, y + 0.001, 0.004))]
    carpet = solid(((-1, -1, 0), (1, 1, 0.015)), *threads)
    carpet.points[8:, 2] += (
        numpy.arange(len(carpet.points) - 8) % 4 // 2 * 0.002
    )  # one edge of each is higher
    contacts = contact_points(carpet, solid(((-3, -3, -0.1), (3, 3, 0))), 0.001)
    on_slab = contacts.places[contacts.places[:, 2] == 0]
    assert {(round(x), round(y)) for x, y, _ in on_slab.tolist()} >= {(1, 1), (1, -1), (-1, 1), (-1, -1)}
