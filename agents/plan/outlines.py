"""Convex outlines in a picture, whose sides are at -1 and 1."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

Point = tuple[float, float]
_SIDES = ((0, -1), (0, 1), (1, -1), (1, 1))  # axis and end


def covered_share(points: Iterable[Point]) -> float:
    """The share of the picture inside the convex outline of some points."""
    outline = _clipped(_hull(points))
    ends = [*outline[1:], *outline[:1]]
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(outline, ends, strict=True))) / 2 / 4


def _hull(points: Iterable[Point]) -> list[Point]:
    """The corners of the convex outline, counter-clockwise."""
    ordered = sorted(set(points))
    corners: list[Point] = []
    for line in (ordered, ordered[::-1]):
        half: list[Point] = []
        for point in line:
            while len(half) > 1 and _turn(half[-2], half[-1], point) <= 0:
                half.pop()
            half.append(point)
        corners += half[:-1]
    return corners


def _turn(a: Point, b: Point, c: Point) -> float:
    """Positive if the way from a by b to c turns to the left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _clipped(outline: list[Point]) -> list[Point]:
    """The part of a convex outline that is inside the picture."""
    for axis, end in _SIDES:
        kept: list[Point] = []
        for a, b in zip(outline, [*outline[1:], *outline[:1]], strict=True):
            over_a, over_b = end * a[axis] - 1, end * b[axis] - 1
            if over_a <= 0:
                kept.append(a)
            if over_a * over_b < 0:
                share = over_a / (over_a - over_b)
                kept.append((a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])))
        outline = kept
    return outline
