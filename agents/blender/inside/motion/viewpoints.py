# SPDX-License-Identifier: GPL-3.0-or-later
"""Viewpoints for a motion: one fixed view of an actor's whole path, and close ones that follow it."""

import math

import numpy
from mathutils import Matrix, Vector

from ..preview.framing import BoundingBox, camera_rotation

# (azimuth, elevation) in degrees, preferred first; azimuth 0 looks along +Y, 90 along -X.
_ANGLES = ((30, 24), (-30, 24), (60, 24), (-60, 24), (0, 24), (90, 24), (30, 45), (-30, 45), (0, 65))
_ENOUGH = (
    0.85  # of what the best angle shows; a wide margin, so that the next trial is seen from the same side
)
_AROUND = 1.22  # size of the view, in sizes of what must be visible
_CLOSE_AROUND = 1.5
_FLATTEST, _TALLEST = 0.62, 1.25  # height of a picture, in widths
_CLOSE_HEIGHT = 0.72
_SMALL = 0.2  # an actor that takes less of the picture's width gets close views as well


class OrthographicView:
    """An orthographic camera: ``centre`` of the picture, ``width`` in metres, ``size`` in pixels; it sees everything
    behind ``depth``, metres from the centre towards the viewer, and nothing in front of that."""

    def __init__(self, angle, centre, width, size, depth):
        self.angle, self.centre, self.width, self.size, self.depth = angle, centre, width, size, depth

    @property
    def axes(self):
        """Unit vectors to the picture's right, up, and towards the viewer."""
        return _axes(self.angle)

    @property
    def box(self):
        """A box around what it frames."""
        half = Vector((1, 1, 1)) * (self.width * max(1.0, self.size[1] / self.size[0]) / 2)
        return BoundingBox(self.centre - half, self.centre + half)

    def as_dict(self):
        """The view as data for drawing on its pictures."""
        return {
            "axes": [list(axis) for axis in self.axes],
            "centre": list(self.centre),
            "metres_per_pixel": self.width / self.size[0],
            "size": list(self.size),
            "angle": list(self.angle),
        }


def path_view(tracks, tile):
    """The view of everything that some tracks cover, in pictures ``tile`` pixels wide; None if none ever exists."""
    boxes = [core for track in tracks for core in track.cores if core is not None]
    if not boxes:
        return None
    angle = _best_angle(_spread(tracks))
    centre, across, upward, depth = _fit(angle, boxes)
    size = max(_size(low, high) for low, high in boxes)
    across = max(across * _AROUND, size * _AROUND * 1.2, 1e-3)
    upward = upward * _AROUND
    height = min(max(upward / across, _FLATTEST), _TALLEST)
    width = max(across, upward / height)
    return OrthographicView(angle, centre, width, (tile, round(tile * height)), depth + 0.02 * width)


def wants_close_views(track, view):
    """Whether the actor is too small to be seen well in that view."""
    sizes = [_size(*core) for core in track.cores if core is not None]
    return track.actor.measured == "vertices" and 1e-4 * view.width < max(sizes) < _SMALL * view.width


def close_view(track, view, frame):
    """A view of the actor alone at a frame, at the same scale for every frame; None if it does not exist there."""
    at = track.frames.index(frame)
    if track.cores[at] is None:
        return None
    largest = max(_size(*core) for core in track.cores if core is not None)
    centre, _, _, depth = _fit(view.angle, [track.cores[at]])
    tile = view.size[0]
    width = largest * _CLOSE_AROUND
    return OrthographicView(
        view.angle, centre, width, (tile, round(tile * _CLOSE_HEIGHT)), depth + 0.02 * width
    )


def _size(low, high):
    return (high - low).length


def _axes(angle):
    azimuth, elevation = map(math.radians, angle)
    towards = (
        math.sin(azimuth) * math.cos(elevation),
        -math.cos(azimuth) * math.cos(elevation),
        math.sin(elevation),
    )
    return tuple(axis.copy() for axis in camera_rotation(towards, (0, 0, 1)).col)


def _spread(tracks):
    """How far all points of some tracks are spread, over all frames (3 × 3, m²)."""
    centres = numpy.array([centre for track in tracks for centre in track.centres if centre is not None])
    shapes = [shape for track in tracks for shape in track.covariances if shape is not None]
    return numpy.cov(centres, rowvar=False, bias=True) + numpy.mean(shapes, axis=0)


def _best_angle(spread):
    """The first angle that shows enough: a wide silhouette, and much of the way that is covered."""
    shown = {angle: _shown(spread, angle) for angle in _ANGLES}
    return next(angle for angle in _ANGLES if shown[angle] >= _ENOUGH * max(shown.values()))


def _shown(spread, angle):
    """How much of what is spread so is seen from an angle, in metres: the mean of the length and the area of it."""
    flat = numpy.array(_axes(angle)[:2])
    seen = flat @ spread @ flat.T
    length, area = (math.sqrt(max(0.0, float(part))) for part in (numpy.trace(seen), numpy.linalg.det(seen)))
    return math.sqrt(length * math.sqrt(area))


def _fit(angle, boxes):
    """(centre, width, height, half the depth) of the view that holds all boxes, from an angle."""
    turn = Matrix(_axes(angle))
    corners = [
        turn @ Vector((x, y, z))
        for low, high in boxes
        for x in (low.x, high.x)
        for y in (low.y, high.y)
        for z in (low.z, high.z)
    ]
    low, high = (Vector(pick(corner[axis] for corner in corners) for axis in range(3)) for pick in (min, max))
    across, upward, depth = high - low
    return turn.transposed() @ ((low + high) / 2), across, upward, depth / 2
