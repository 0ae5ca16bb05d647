"""Whether an object is balanced: its centre of mass against its support area, seen from above. Metres."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agents.protocol.facts import Vector


def balance(bearing: Iterable[Vector], centre: Vector) -> tuple[float, float]:
    """(distance of the centre from the edge of the support area, negative outside; the support area in m²).

    The support area is the hull of the ``bearing`` places; if these are on a line, the distance is at most 0.
    """
    hull = _hull(sorted({(place[0], place[1]) for place in bearing}))
    corners = np.array(hull, dtype=float)
    at = np.array(centre[:2], dtype=float)
    sides = np.roll(corners, -1, axis=0) - corners
    lengths = np.linalg.norm(sides, axis=1)
    area = 0.5 * float(np.sum(corners[:, 0] * sides[:, 1] - corners[:, 1] * sides[:, 0]))
    away = at - corners
    along = np.einsum("ij,ij->i", away, sides) / np.maximum(lengths**2, 1e-30)
    off = away - np.clip(along, 0.0, 1.0)[:, None] * sides
    nearest = float(np.linalg.norm(off, axis=1).min())
    left = sides[:, 0] * away[:, 1] - sides[:, 1] * away[:, 0]
    inside = len(corners) > 2 and bool((left >= 0).all())
    return (nearest if inside else -nearest), area


def _hull(places: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The corners of the convex hull of sorted places, counter-clockwise."""
    if len(places) < 3:
        return places
    halves: list[list[tuple[float, float]]] = []
    for order in (places, places[::-1]):
        half: list[tuple[float, float]] = []
        for place in order:
            while len(half) > 1 and _turn(half[-2], half[-1], place) <= 0:
                half.pop()
            half.append(place)
        halves.append(half[:-1])
    return halves[0] + halves[1]


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
