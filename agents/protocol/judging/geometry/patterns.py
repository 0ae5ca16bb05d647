"""How well places fit a circle, a line, a grid or a mirror plane. Places are n × 3 arrays, in metres."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from agents.protocol.judging.geometry.vectors import Array

_LEVEL = 1e-3  # share of their extent that places may differ in height and still lie in a horizontal plane
_OTHER_DIRECTION = 0.5  # sine of the angle from which two steps count as different directions of a grid
_SAME_STEP = 0.3  # share of its length that a step may differ from another and still count as the same


@dataclass(frozen=True, slots=True)
class CircleFit:
    """Places around a centre, each with its distance from it and its height above their plane.

    ``order`` are the indices of the places around the centre, ``gaps`` the degrees from each of these to the next: for
    an arc one less than places, since it is open between its ends.
    """

    centre: Array
    normal: Array
    radii: Array
    heights: Array
    order: tuple[int, ...]
    gaps: Array


def fit_circle(
    places: Array, about: Array | None = None, *, closed: bool = True, arc: float | None = None
) -> CircleFit:
    """Fits a circle (``closed``) or an arc to places.

    ``about`` is the centre if that is known (projected onto the plane), ``arc`` the length of the arc in degrees.
    """
    middle = places.mean(axis=0)
    normal = _normal(places - middle)
    u = _axis_in(normal)
    v = np.cross(normal, u)
    flat = np.stack([(places - middle) @ u, (places - middle) @ v], axis=1)
    at = None if about is None else about - middle
    centre = _circle_through(flat) if at is None else np.array([at @ u, at @ v])
    arms = flat - centre
    turns = np.degrees(np.arctan2(arms[:, 1], arms[:, 0])) % 360
    order = np.argsort(turns, kind="stable")
    gaps = np.diff(np.append(turns[order], turns[order[0]] + 360))
    if not closed:
        start = _open_gap(gaps, arc) + 1
        order, gaps = np.roll(order, -start), np.roll(gaps, -start)[:-1]
    return CircleFit(
        middle + centre[0] * u + centre[1] * v,
        normal,
        np.linalg.norm(arms, axis=1),
        (places - middle) @ normal,
        tuple(int(place) for place in order),
        gaps,
    )


def _open_gap(gaps: Array, arc: float | None) -> int:
    """The index of an arc's open gap: the one without which the others are most even, else the widest."""

    def unevenness(place: int) -> tuple[float, float]:
        others = np.delete(gaps, place)
        even = arc / len(others) if arc else float(others.mean())
        return round(float(np.abs(others - even).max()), 6), -float(gaps[place])

    return min(range(len(gaps)), key=unevenness)


def _normal(spread: Array) -> Array:
    """The direction in which places spread least; up if they lie in a horizontal plane, or on a line."""
    up = np.array([0.0, 0.0, 1.0])
    extent = float(np.linalg.norm(np.ptp(spread, axis=0)))
    if len(spread) < 3 or float(np.ptp(spread[:, 2])) <= _LEVEL * extent:
        return up
    _, strengths, axes = np.linalg.svd(spread, full_matrices=True)
    if strengths[1] < 1e-9:
        return up
    return axes[2] if axes[2][2] >= 0 else -axes[2]


def _axis_in(normal: Array) -> Array:
    """A unit vector in the plane of a normal."""
    start = np.array([1.0, 0.0, 0.0]) if abs(normal[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    flat = start - (start @ normal) * normal
    return flat / np.linalg.norm(flat)


def _circle_through(flat: Array) -> Array:
    """The centre of the circle that best fits places in a plane (least squares)."""
    if len(flat) < 3:
        return flat.mean(axis=0)
    system = np.concatenate([2 * flat, np.ones((len(flat), 1))], axis=1)
    solution, *_ = np.linalg.lstsq(system, (flat**2).sum(axis=1), rcond=None)
    return solution[:2]


@dataclass(frozen=True, slots=True)
class LineFit:
    """Places along a line: the distance of each from it, and the gaps along it in ``order``."""

    beside: Array
    order: tuple[int, ...]
    gaps: Array

    @property
    def length(self) -> float:
        """From the first to the last."""
        return float(self.gaps.sum())


def fit_line(places: Array) -> LineFit:
    """Fits a line to places."""
    middle = places.mean(axis=0)
    along = np.linalg.svd(places - middle, full_matrices=False)[2][0]
    at = (places - middle) @ along
    beside = np.linalg.norm(places - middle - np.outer(at, along), axis=1)
    order = np.argsort(at, kind="stable")
    return LineFit(beside, tuple(int(place) for place in order), np.diff(at[order]))


@dataclass(frozen=True, slots=True)
class GridFit:
    """Places on a grid: ``off`` is the distance of each from the grid point that the others imply for it, ``spacing``
    the two steps. ``full``: every grid point has exactly one place.
    """

    off: Array
    spacing: tuple[float, float]
    shape: tuple[int, int]
    full: bool


def fit_grid(places: Array) -> GridFit | None:
    """Fits a grid to places; None if they are on one line, or at one point."""
    steps = places[None, :, :] - places[:, None, :]
    first = _step(steps, None)
    second = _step(steps, first) if first is not None else None
    if first is None or second is None:
        return None
    fitted = np.stack([first, second, places[0]])
    cells, system = _cells(places, fitted)
    for _ in range(4):  # the steps came from some neighbours: fit them to all places
        fitted = np.linalg.pinv(system) @ places
        cells, system = _cells(places, fitted)
    spacing = np.linalg.norm(fitted[:2], axis=1)
    if not (spacing > 1e-9).all():
        return None
    # Each place pulls the fit towards itself; dividing by this gives its distance from the fit of the others.
    pull = np.clip(1 - np.einsum("ij,ji->i", system, np.linalg.pinv(system)), 1e-6, 1.0)
    off = np.linalg.norm(places - system @ fitted, axis=1)
    off = np.where(off < 1e-9, 0.0, off / pull)
    cells -= cells.min(axis=0)
    shape = (int(cells[:, 0].max()) + 1, int(cells[:, 1].max()) + 1)
    distinct = len({(int(row), int(column)) for row, column in cells})
    full = distinct == len(places) == shape[0] * shape[1]
    return GridFit(off, (float(spacing[0]), float(spacing[1])), shape, full)


def _cells(places: Array, grid: Array) -> tuple[Array, Array]:
    """(the grid point nearest to each place, in steps; the same with a column of ones for the origin)."""
    cells = np.rint((places - grid[2]) @ np.linalg.pinv(grid[:2]))
    return cells, np.concatenate([cells, np.ones((len(cells), 1))], axis=1)


def _step(steps: Array, but: Array | None) -> Array | None:
    """The typical step from a place to its nearest neighbour, or to the nearest in another direction than ``but``."""
    lengths = np.linalg.norm(steps, axis=2)
    allowed = lengths > 1e-9
    if but is not None:
        across = np.linalg.norm(np.cross(steps, but), axis=2)
        allowed &= across > _OTHER_DIRECTION * lengths * np.linalg.norm(but)
    lengths = np.where(allowed, lengths, np.inf)
    nearest = lengths.argmin(axis=1)
    rows = [row for row in range(len(steps)) if allowed[row, nearest[row]]]
    if not rows:
        return None
    rows.sort(key=lambda row: lengths[row, nearest[row]])
    middle = rows[(len(rows) - 1) // 2]
    typical = steps[middle, nearest[middle]]
    same = np.linalg.norm(steps - typical, axis=2) <= _SAME_STEP * np.linalg.norm(typical)
    return steps[same].mean(axis=0)


def mirror_error(places: Array, point: Array, normal: Array) -> tuple[float, int]:
    """(largest distance of a place from its partner's mirror image, in the best pairing; the index of the place)."""
    unit = normal / np.linalg.norm(normal)
    images = places - 2 * np.outer((places - point) @ unit, unit)
    distances = np.linalg.norm(places[:, None, :] - images[None, :, :], axis=2)
    # The best pairing: the smallest distance within which every place finds a partner of its own.
    limits = np.unique(distances)
    low, high = 0, len(limits) - 1
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if _all_paired(distances <= limits[middle]) else (middle + 1, high)
    return float(limits[low]), int(np.argwhere(distances == limits[low])[0][0])


def _all_paired(allowed: npt.NDArray[np.bool_]) -> bool:
    """Whether each row can be matched with its own column (augmenting paths)."""
    partner: dict[int, int] = {}

    def finds(row: int, seen: set[int]) -> bool:
        for column in np.flatnonzero(allowed[row]).tolist():
            if column not in seen:
                seen.add(column)
                if column not in partner or finds(partner[column], seen):
                    partner[column] = row
                    return True
        return False

    return all(finds(row, set()) for row in range(len(allowed)))
