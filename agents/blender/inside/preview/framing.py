# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera directions and framing: what of the world a picture shows."""

import math
import statistics

from mathutils import Matrix, Vector

# Name, direction from the subject to the camera, up direction of the picture.
VIEWS = (
    ("front", (0, -1, 0), (0, 0, 1)),
    ("right", (1, 0, 0), (0, 0, 1)),
    ("top", (0, 0, 1), (0, 1, 0)),
    ("three-quarter", (0.62, -1.0, 0.68), (0, 0, 1)),
)
CLOSE, LOOSE, WIDE = 1.06, 1.25, 1.7  # size of the picture in sizes of what is framed
_FOOT = 0.09  # of the picture's height: kept free for the scale bar
_GROUND_TIMES, _SKY_TIMES, _FAR_TIMES = 1.7, 8.0, 6.0  # against what is framed
_FLAT = 0.05
_SPARE = 0.01  # of what is framed: so much more is in the picture
_VAST_TIMES = 6.0  # against the middle one of all others: of what is larger, a whole picture shows no surface
_PATCH, _LEAST_PATCH = 0.5, 0.02  # width of a patch, in diagonals of that other one, and in its own
_UPRIGHT = 0.3  # how much of an axis is level, below which it says nothing of the turn
_TURNED = 0.01  # radians
SMALLEST = 1e-9  # metres across that can still be drawn


class BoundingBox:
    """A box along the world's axes."""

    def __init__(self, low, high):
        self.low, self.high = Vector(low), Vector(high)

    @classmethod
    def around(cls, boxes):
        """The smallest box that holds all of them."""
        boxes = list(boxes)
        return cls(
            [min(box.low[axis] for box in boxes) for axis in range(3)],
            [max(box.high[axis] for box in boxes) for axis in range(3)],
        )

    @property
    def size(self):
        """The lengths of its edges."""
        return self.high - self.low

    @property
    def diagonal(self):
        """The length of its diagonal."""
        return self.size.length

    @property
    def centre(self):
        """Its middle."""
        return (self.low + self.high) / 2

    def grown(self, by):
        """The box, larger by so much on every side."""
        return BoundingBox(self.low - Vector((by,) * 3), self.high + Vector((by,) * 3))

    def meets(self, other):
        """Whether they have a point in common."""
        return all(
            self.low[axis] <= other.high[axis] and other.low[axis] <= self.high[axis] for axis in range(3)
        )

    def contains(self, other):
        """Whether all of the other is inside."""
        return all(
            self.low[axis] <= other.low[axis] and other.high[axis] <= self.high[axis] for axis in range(3)
        )

    def holds(self, other):
        """Whether the other's centre is inside, and at most one of its sides is outside."""
        inside = sum(self.low[axis] <= other.low[axis] for axis in range(3))
        inside += sum(self.high[axis] >= other.high[axis] for axis in range(3))
        return inside >= 5 and self.distance(other.centre) == 0

    def distance(self, place):
        """From a place to the nearest point of the box."""
        return Vector(
            max(self.low[axis] - place[axis], place[axis] - self.high[axis], 0) for axis in range(3)
        ).length


def boxes_of(pieces):
    """The box of each owner, by name."""
    grouped = {}
    for piece in pieces:
        grouped.setdefault(piece.owner, []).append(piece)
    return {owner: BoundingBox.around(group) for owner, group in grouped.items()}


def without_size(pieces, groups):
    """The names of those groups (sets of owners, by name) that lie in one point, as what is scaled to 0."""
    boxes = boxes_of(pieces)
    return [
        name
        for name, owners in groups.items()
        if BoundingBox.around(boxes[owner] for owner in owners).diagonal < SMALLEST
    ]


def choose_framed(boxes, templates=()):
    """(names to frame, names that are larger than the picture, names that are outside it), of boxes by name.

    Framing grounds, skies, what is far away, and ``templates`` for instances that are aside would make everything else
    a dot.
    """
    outside = _templates_aside(boxes, templates)
    outside = sorted({*outside, *_far_away({name: boxes[name] for name in boxes if name not in outside})})
    beyond, core = [], None
    for name in sorted(boxes.keys() - set(outside), key=lambda name: boxes[name].diagonal):
        box = boxes[name]
        if core is not None and core.diagonal > 0:
            times = box.diagonal / core.diagonal
            is_flat = min(box.size) <= _FLAT * max(box.size)
            if (is_flat and times > _GROUND_TIMES and box.grown(core.diagonal).meets(core)) or (
                times > _SKY_TIMES and box.holds(core)
            ):
                beyond.append(name)
                continue
        core = box if core is None else BoundingBox.around((core, box))
    # What is framed may have grown since by something that is no ground: then all of a ground may be in the picture.
    beyond = [name for name in beyond if not core.grown(_SPARE * core.diagonal).contains(boxes[name])]
    return sorted(boxes.keys() - {*outside, *beyond}), sorted(beyond), outside


def patch_of(box, others):
    """(place near which to look, width in metres) of a close picture of what is far larger than all ``others``.

    None for what is not, or if there are no others.
    """
    if not others:
        return None
    usual = statistics.median_low(other.diagonal for other in others)
    if box.diagonal <= _VAST_TIMES * usual:
        return None
    middle = Vector(statistics.median(other.centre[axis] for other in others) for axis in range(3))
    return middle, max(_PATCH * usual, _LEAST_PATCH * box.diagonal)


def _templates_aside(boxes, templates):
    """Names of the templates that are farther from everything else than its diagonal."""
    rest = [box for name, box in boxes.items() if name not in templates]
    if not rest:
        return []
    middle = BoundingBox.around(rest)
    near = middle.grown(middle.diagonal)
    return [name for name in boxes if name in templates and not near.meets(boxes[name])]


def _far_away(boxes):
    """Names of the few boxes that are far from nearly all others."""
    if len(boxes) < 4:
        return []
    middle = Vector(statistics.median(box.centre[axis] for box in boxes.values()) for axis in range(3))
    away = {name: box.distance(middle) for name, box in boxes.items()}
    reach = statistics.median(away[name] + boxes[name].diagonal for name in boxes)
    far = sorted(name for name in boxes if away[name] > _FAR_TIMES * reach)
    return far if len(far) <= max(1, len(boxes) // 10) else []


def camera_rotation(towards, up):
    """A camera's rotation matrix; its columns are right, up and towards the viewer."""
    z = Vector(towards).normalized()
    x = Vector(up).cross(z).normalized()
    return Matrix((x, z.cross(x), z)).transposed()


def turned_views(turn):
    """The fixed views, turned about the vertical by so much (radians)."""
    if not turn:
        return VIEWS
    around = Matrix.Rotation(turn, 3, "Z")
    return tuple(
        (name, tuple(around @ Vector(towards)), tuple(around @ Vector(up))) for name, towards, up in VIEWS
    )


def turn_of(matrix):
    """By how much an object is turned about the vertical, in radians: along its X axis, or, if that is upright, Y."""
    along_x, along_y, _ = matrix.to_3x3().normalized().transposed()
    if math.hypot(along_x.x, along_x.y) > _UPRIGHT:
        turn = math.atan2(along_x.y, along_x.x)
    else:
        turn = math.atan2(-along_y.x, along_y.y)
    return turn if abs(turn) > _TURNED and math.isfinite(turn) else 0.0


def fit(points, rotation, margin):
    """(place in the world, width in metres) of a square orthographic picture that holds the points."""
    flat = [rotation.transposed() @ point for point in points]
    low, high = (Vector(f(point[axis] for point in flat) for axis in range(3)) for f in (min, max))
    size = high - low
    across = max(size.x, size.y / (1 - _FOOT), size.length * 1e-3) * margin
    middle = (low + high) / 2
    middle.y -= across * _FOOT / 2
    return rotation @ middle, across
