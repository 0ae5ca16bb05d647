"""The boxes that planned objects fill, by their dimensions, positions and rotations. Metres, in the world."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.plan.part import owner_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.part import Vector
    from agents.plan.scene import PlannedObject, ScenePlan

# A description with one of these words may put the root elsewhere than in the middle of the underside.
_OTHER_ROOT = re.compile(r"\b(roots?|origins?|pivots?|hinges?|cent(er|re)d?)\b", re.IGNORECASE)
_SQUARE = 0.02  # sine of twice the angle from an axis
_PLACE, _PLACE_SHARE = 0.01, 0.05  # how far a root may be from its planned place, as the verifier has it


@dataclass(frozen=True, slots=True)
class PlannedBox:
    """The box of a planned object: its eight ``corners``, and ``low`` and ``high`` of the world's box around these.

    An object of the ground may have its root on its top: its box reaches as far below its position as above it.
    """

    planned: PlannedObject
    corners: tuple[Vector, ...]
    low: Vector
    high: Vector
    is_ground: bool

    @property
    def name(self) -> str:
        """The object's name."""
        return self.planned.name

    @property
    def centre(self) -> Vector:
        """The middle of the box."""
        x, y, z = ((low + high) / 2 for low, high in zip(self.low, self.high, strict=True))
        return (x, y, z)

    @property
    def slack(self) -> float:
        """How far the object may be from its planned place, and still pass."""
        return max(_PLACE, _PLACE_SHARE * math.hypot(*self.planned.dimensions))

    @property
    def is_square(self) -> bool:
        """Whether its sides are along the world's axes."""
        return all(abs(math.sin(math.radians(2 * angle))) < _SQUARE for angle in self.planned.rotation)

    def axis(self, number: int) -> Vector:
        """One of the object's own axes."""
        matrix = rotation(self.planned.rotation)
        return (matrix[0][number], matrix[1][number], matrix[2][number])


def boxes_of(plan: ScenePlan) -> dict[str, PlannedBox]:
    """The boxes of all objects whose root is, as far as the plan says, in the middle of their underside."""
    return {
        planned.name: _box(planned)
        for planned in plan.objects
        if planned.role != "force" and not _OTHER_ROOT.search(planned.description)
    }


def box_of(boxes: dict[str, PlannedBox], node: str) -> PlannedBox | None:
    """The box of the object that a node is, or is a part of; None where it is unknown."""
    return boxes.get(owner_of(node))


def _box(planned: PlannedObject) -> PlannedBox:
    width, depth, height = planned.dimensions
    is_ground = "ground" in planned.systems
    # Grounds are often planned by their top: their box reaches from there both ways.
    heights = (-height, height) if is_ground else (0.0, height)
    matrix = rotation(planned.rotation)
    corners = tuple(
        _moved(matrix, (x, y, z), planned.position)
        for x in (-width / 2, width / 2)
        for y in (-depth / 2, depth / 2)
        for z in heights
    )
    low, high = (tuple(pick(corner[axis] for corner in corners) for axis in range(3)) for pick in (min, max))
    return PlannedBox(planned, corners, (low[0], low[1], low[2]), (high[0], high[1], high[2]), is_ground)


def rotation(degrees: Vector) -> tuple[Vector, Vector, Vector]:
    """The rows of the matrix of a rotation about X, then Y, then Z."""
    (sx, cx), (sy, cy), (sz, cz) = (
        (math.sin(math.radians(angle)), math.cos(math.radians(angle))) for angle in degrees
    )
    return (
        (cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx),
        (sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx),
        (-sy, cy * sx, cy * cx),
    )


def _moved(matrix: tuple[Vector, Vector, Vector], place: Vector, by: Vector) -> Vector:
    x, y, z = (
        sum(part * value for part, value in zip(row, place, strict=True)) + step
        for row, step in zip(matrix, by, strict=True)
    )
    return (x, y, z)


def gaps(a: PlannedBox, b: PlannedBox) -> Vector:
    """The gap between two boxes along each axis; negative where they overlap."""
    x, y, z = (
        max(low - other_high, other_low - high)
        for low, high, other_low, other_high in zip(a.low, a.high, b.low, b.high, strict=True)
    )
    return (x, y, z)


def distance(a: PlannedBox, b: PlannedBox) -> float:
    """The distance of two boxes, 0 if they meet: what they hold is at least as far apart."""
    return math.hypot(*(max(0.0, gap) for gap in gaps(a, b)))


def pairs(boxes: dict[str, PlannedBox]) -> Iterator[tuple[PlannedBox, PlannedBox]]:
    """All pairs of boxes."""
    ordered = list(boxes.values())
    for place, box in enumerate(ordered):
        yield from ((box, other) for other in ordered[place + 1 :])
