"""Whether the planned camera sees its subjects at the first frame, by their boxes; one that moves starts there.

How much of the picture they cover is what the verifier measures, the convex outline: as of the whole box. Whatever is
built in that place covers no more.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

from agents.plan.boxes import box_of, boxes_of
from agents.plan.faults import Fault
from agents.plan.outlines import covered_share

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.plan.boxes import PlannedBox
    from agents.plan.part import Vector
    from agents.plan.scene import ScenePlan

_SENSOR = 36.0  # millimetres, along the picture's longer side
_OUTSIDE = (
    0.4  # share of a subject's box that may be outside the picture; boxes are larger than what they hold
)
_COVER = 0.01  # share of the picture that a subject must fill
_GROWING = frozenset({"fluid", "emitter"})  # at first there may be nothing of them
_SHARES = (0.1, 0.5, 0.9)


def camera_axes(plan: ScenePlan) -> tuple[Vector, Vector, Vector] | None:
    """The camera's right, its view direction made level, and up; None where it looks straight up or down."""
    towards = _towards(plan, boxes_of(plan))
    if towards is None:
        return None
    length = math.hypot(towards[0], towards[1])
    if length < 1e-6:
        return None
    level = (towards[0] / length, towards[1] / length, 0.0)
    return (level[1], -level[0], 0.0), level, (0.0, 0.0, 1.0)


def camera_doubts(plan: ScenePlan, boxes: dict[str, PlannedBox]) -> Iterator[Fault]:
    """Subjects that are outside the picture or too small in it."""
    camera, towards = plan.camera, _towards(plan, boxes)
    if towards is None:
        return
    width, height = plan.render.resolution
    aspect = (1.0, width / height) if width >= height else (height / width, 1.0)
    scale = 2 * camera.lens / _SENSOR
    basis = _basis(towards)
    for place, subject in enumerate(camera.subjects):
        box = boxes.get(subject)
        if box is None or box.planned.role in _GROWING:
            continue
        seen, outline = (
            [
                (across * scale * aspect[0] / ahead, up * scale * aspect[1] / ahead) if ahead > 1e-6 else None
                for across, up, ahead in (_in_view(basis, camera.position, point) for point in points)
            ]
            for points in (_samples(box), box.corners)
        )
        outside = sum(point is None or max(map(abs, point)) > 1 for point in seen) / len(seen)
        path = f"camera.subjects[{place}]"
        if outside > _OUTSIDE:
            yield Fault(
                path,
                f"{outside:.0%} of {subject!r} is outside the picture at the first frame, by its size and position; "
                "move the camera back, turn it, or use a shorter lens.",
            )
            continue
        flat = [point for point in outline if point is not None]
        if len(flat) < len(outline):  # it reaches behind the camera, so it is near
            continue
        if (cover := covered_share(flat)) < _COVER:
            yield Fault(
                path,
                f"{subject!r} fills at most {cover:.2%} of the picture's area; at least {_COVER:.0%} is needed: move "
                "the camera nearer, or use a longer lens.",
            )


def _towards(plan: ScenePlan, boxes: dict[str, PlannedBox]) -> Vector | None:
    target = plan.camera.target
    if isinstance(target, str):
        box = box_of(boxes, target)
        if box is None:
            return None
        target = box.centre
    x, y, z = (end - start for start, end in zip(plan.camera.position, target, strict=True))
    return (x, y, z) if math.hypot(x, y, z) > 1e-6 else None


def _basis(towards: Vector) -> tuple[Vector, Vector, Vector]:
    """Right, up and ahead of a camera that looks that way and is level."""
    length = math.hypot(*towards)
    ahead = (towards[0] / length, towards[1] / length, towards[2] / length)
    level = math.hypot(ahead[0], ahead[1])
    right = (ahead[1] / level, -ahead[0] / level, 0.0) if level > 1e-6 else (1.0, 0.0, 0.0)
    up = (
        right[1] * ahead[2] - right[2] * ahead[1],
        right[2] * ahead[0] - right[0] * ahead[2],
        right[0] * ahead[1] - right[1] * ahead[0],
    )
    return right, up, ahead


def _in_view(basis: tuple[Vector, Vector, Vector], eye: Vector, point: Vector) -> Vector:
    """How far a point is to the right of the camera's axis, above it, and ahead."""
    away = [end - start for start, end in zip(eye, point, strict=True)]
    x, y, z = (sum(part * step for part, step in zip(axis, away, strict=True)) for axis in basis)
    return (x, y, z)


def _samples(box: PlannedBox) -> list[Vector]:
    """Points throughout a box, a little inside its sides."""
    first = box.corners[0]
    sides = [
        tuple(end - start for start, end in zip(first, box.corners[number], strict=True))
        for number in (4, 2, 1)
    ]
    points: list[Vector] = []
    for shares in itertools.product(_SHARES, repeat=3):
        x, y, z = (
            start + sum(share * side[axis] for share, side in zip(shares, sides, strict=True))
            for axis, start in enumerate(first)
        )
        points.append((x, y, z))
    return points
