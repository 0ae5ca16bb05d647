# SPDX-License-Identifier: GPL-3.0-or-later
"""How actors move: measured frame by frame, and summed up over ranges of frames.

A speed is between two measured frames: at frame f, the distance since the frame measured before, over the time between.
"""

import math

import numpy
from mathutils import Vector

from .actors import round_to

DEFORMED = 2e-3  # share of its size that an actor's points must move against each other for it to deform
REPEATS = 0.01  # share of its size that an actor may be off when a frame is visited again
LINE = 1e-6  # how much worse, relatively, any other rotation must fit for the best one to count


class Track:
    """The measured motion of one actor: lists with an entry for each of ``frames``.

    ``centres`` (None where it does not exist), ``lows`` and ``highs`` are places in metres, ``cores`` and
    ``covariances`` those of its states, ``counts`` says how many points are there; ``speeds`` (of the centre),
    ``point_speeds`` and ``velocities`` (vectors; both means over what is followed) are in m/s, ``rotations`` are axes
    as long as the angle in radians; each since the frame before, None if unknown. ``deforms``: its points move
    against each other.
    """

    def __init__(self, actor, fps):
        self.actor, self.fps = actor, fps
        self.frames, self.centres, self.lows, self.highs, self.counts = [], [], [], [], []
        self.cores, self.covariances = [], []
        self.speeds, self.point_speeds, self.velocities, self.rotations = [], [], [], []
        self.deforms = False
        self.strays = {}
        self.last = self._first = None

    def add(self, frame, state):
        """Adds the actor's state at the next frame."""
        last = self.last
        seconds = (frame - self.frames[-1]) / self.fps if self.frames else 0.0
        speed = point_speed = velocity = rotation = None
        if state is not None and last is not None:
            speed = (state.centre - last.centre).length / seconds
            if state.is_followed and len(state.places) == len(last.places):
                both = state.alive & last.alive
                before, after = last.places[both], state.places[both]
                if len(before):
                    areas = None if state.areas is None else state.areas[both]
                    ways = after - before
                    lengths = numpy.linalg.norm(ways, axis=1)
                    point_speed = float(numpy.average(lengths, weights=areas)) / seconds
                    velocity = Vector(numpy.average(ways, axis=0, weights=areas)) / seconds
                if self.actor.measured != "particles":
                    rotation = best_rotation(before, after)
                    self.deforms = self.deforms or self._is_deformed(state)
        self.frames.append(frame)
        self.centres.append(state and state.centre)
        self.lows.append(state and state.low)
        self.highs.append(state and state.high)
        self.cores.append(state and state.core)
        self.covariances.append(state and state.covariance)
        self.speeds.append(speed)
        self.counts.append(0 if state is None else int(state.alive.sum()))
        self.point_speeds.append(point_speed)
        self.velocities.append(velocity)
        self.rotations.append(rotation)
        self.last, self._first = state, self._first or state

    def check(self, frame, state):
        """Compares the actor's state when a frame is visited again; ``strays`` gets the distance if it is elsewhere."""
        at = self.frames.index(frame)
        centre = self.centres[at]
        if (centre is None) != (state is None):
            self.strays[frame] = None
        elif centre is not None:
            off = (state.centre - centre).length
            if off > REPEATS * max((state.high - state.low).length, 1e-3):
                self.strays[frame] = off

    def _is_deformed(self, state):
        first, half = self._first.places, len(state.places) // 2
        if len(first) != len(state.places) or not half:
            return False
        before, after = (
            numpy.linalg.norm(places[:half] - places[half : 2 * half], axis=1)
            for places in (first, state.places)
        )
        size = (self._first.high - self._first.low).length
        return bool((abs(after - before) > DEFORMED * size).any())

    @property
    def turns(self):
        """The angles of the rotations, in radians."""
        return [None if rotation is None else rotation.length for rotation in self.rotations]

    @property
    def speed_name(self):
        """Which speed describes it best: that of its ``centre``, or the mean of its ``vertices`` or ``particles``."""
        if self.actor.measured == "particles":
            return "particles"
        return "vertices" if self.deforms else "centre"

    @property
    def main_speeds(self):
        """The speeds that ``speed_name`` names; where points cannot be followed, those of the centre."""
        if self.speed_name == "centre":
            return self.speeds
        return [
            own if own is not None else other
            for own, other in zip(self.point_speeds, self.speeds, strict=True)
        ]

    @property
    def path(self):
        """How far it has moved in all, by its main speeds, in metres."""
        steps = zip(self.main_speeds[1:], self.frames[1:], self.frames[:-1], strict=True)
        return sum((now - before) * speed for speed, now, before in steps if speed is not None) / self.fps

    @property
    def moved(self):
        """How far the centre moved up to the last measured frame, from the one before, in metres."""
        return self._distance(len(self.frames) - 1) if len(self.frames) > 1 else 0.0

    def changes_by(self, frame):
        """How much the centre's velocity after a frame differs from that before it, in m/s; 0 if unknown."""
        at = self.frames.index(frame)
        around = self.centres[at - 1 : at + 2] if at else []
        if len(around) < 3 or None in around:
            return 0.0
        before, after = (
            (around[step + 1] - around[step]) / (self.frames[at + step] - self.frames[at + step - 1])
            for step in (0, 1)
        )
        return (after - before).length * self.fps

    def displacements(self):
        """The distance of the centre from its first place, in metres, at each frame."""
        first = next((centre for centre in self.centres if centre is not None), None)
        return [None if centre is None else (centre - first).length for centre in self.centres]

    def summary(self, start, end):
        """A summary of the motion from frame ``start`` to ``end``, as data (metres, m/s, degrees)."""
        inside = [at for at, frame in enumerate(self.frames) if start <= frame <= end]
        there = [at for at in inside if self.centres[at] is not None]
        if not there:
            return {"present": False}
        first, last = there[0], there[-1]
        way = self.centres[last] - self.centres[first]
        steps = [at for at in there if at > first]
        speeds = [(self.main_speeds[at], self.frames[at]) for at in steps if self.main_speeds[at] is not None]
        peak, peak_frame = max(speeds, default=(None, None), key=lambda pair: pair[0])
        turns = [self.turns[at] for at in steps if self.turns[at] is not None]
        result = {
            "present": True,
            "displacement": round_to(way.length),
            "displacement_vector": [round_to(part) for part in way],
            "path_length": round_to(sum(self._distance(at) for at in steps)),
            "peak_speed": round_to(peak),
            "peak_frame": peak_frame,
            "final_speed": round_to(speeds[-1][0]) if speeds else None,
            "speed_of": self.speed_name,
            "turn": round_to(sum(turns) * 57.29578, 0.01) if turns else None,  # pyright: ignore[reportCallIssue]
            "start_position": [round_to(part) for part in self.centres[first]],
            "end_position": [round_to(part) for part in self.centres[last]],
        }
        if first != inside[0] or last != inside[-1]:
            result["there"] = [self.frames[first], self.frames[last]]
        return result

    def _distance(self, at):
        before, after = self.centres[at - 1], self.centres[at]
        return (after - before).length if before is not None and after is not None else 0.0


def best_rotation(before, after):
    """The rotation that best maps places (n × 3) to other ones: its axis, as long as the angle in radians.

    None if the places do not determine it.

    Horn's solution: that rotation, as a quaternion, is the largest eigenvector of a matrix of the products' sums.
    """
    if len(before) < 3:
        return None
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = (before - before.mean(axis=0)).T @ (after - after.mean(axis=0))
    values, vectors = numpy.linalg.eigh(
        [
            [xx + yy + zz, yz - zy, zx - xz, xy - yx],
            [yz - zy, xx - yy - zz, xy + yx, zx + xz],
            [zx - xz, xy + yx, yy - xx - zz, yz + zy],
            [xy - yx, zx + xz, yz + zy, zz - xx - yy],
        ]
    )
    if values[-1] - values[-2] <= LINE * max(values[-1], 1e-18):
        return None  # another rotation fits as well: the points are on a line
    half, axis = float(vectors[0, -1]), Vector(vectors[1:, -1])
    angle = 2 * math.atan2(axis.length, abs(half))
    return axis.normalized() * math.copysign(angle, half)
