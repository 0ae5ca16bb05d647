# SPDX-License-Identifier: GPL-3.0-or-later
"""Follows what moving objects touch and pass through (see agents.protocol.measures.motion). Metres."""

import numpy
from mathutils import Vector

from ..geometry.solids import Unmeasurable
from ..motion.contacts import surface_distance

_PASSED = 0.25  # share of an object's samples that must change sides for it to count as having passed through
_TESTED = 16  # of the points that seem deepest inside, how many are tested exactly
_STILL = 1e-9
_UPRIGHT = 0.9  # least cosine between the way from a surface and its normal


class TouchFollower:
    """The frames at which objects touch, or will have touched on the way from the frame before."""

    def __init__(self, request):
        self.start, self.end = request["start"], request["end"]
        self._request = request
        self._frames = set()
        self._places, self._boxes = {}, {}
        self._looked_at = set()

    def look(self, frame, graph, tracker):
        """Measures a frame."""
        del graph
        if self._request["once"] and self._frames:
            return
        for name in self._request["a"]:
            own = tracker.body(name)
            places = own.to_world(own.samples)
            last = self._places.get(name)
            self._places[name] = places
            speed = 0.0
            if last is not None and len(last) == len(places):
                speed = float(numpy.linalg.norm(places - last, axis=1).max())
            else:
                last = None
            for other in self._request["b"]:
                self._pair(frame, tracker, (own, places, last, speed), other)

    def _pair(self, frame, tracker, mine, name):
        own, places, last, speed = mine
        if frame in self._frames or name in self._request["a"]:
            return
        mine, other = tracker.surface(own.name), tracker.surface(name)
        if not (mine.exists and other.exists):
            return
        self._looked_at.add(name)
        box, self._boxes[name] = self._boxes.get(name), numpy.array([other.low, other.high])
        speed += 0.0 if box is None else float(numpy.abs(self._boxes[name] - box).max()) * 3**0.5
        reach = self._request["within"] + mine.slack + other.slack
        if not other.is_near(mine.low, mine.high, reach + speed):
            return
        if surface_distance(mine, other, reach) <= reach:
            self._frames.add(frame)
        elif last is not None and _will_meet(own, tracker.body(name), places, last, reach):
            self._frames.add(frame + 1)

    def result(self):
        """The result as data."""
        if not self._looked_at:
            raise Unmeasurable("there are no polygons that could touch, or too many of them")
        return {"frames": sorted(frame for frame in self._frames if frame <= self.end)}


def _will_meet(own, other, places, last, reach):
    """Whether two objects meet within the next frame if both go on moving as in the last one."""
    ways = (
        (other, other.to_own_space(last, before=True), other.to_own_space(places)),
        (
            own,
            own.to_own_space(other.to_world(other.samples, before=True), before=True),
            own.to_own_space(other.to_world(other.samples)),
        ),
    )
    return any(_line_hits(body, now, now + (now - before), reach=reach) for body, before, now in ways)


def _line_hits(body, starts, ends, *, reach=0.0, least=_STILL):
    """Which lines from starts to ends in a body's own space meet its surface, and where: [(number, place), …].

    Each is extended by ``reach``; those shorter than ``least`` are ignored.
    """
    low, high = body.solid.low - reach, body.solid.high + reach
    near = ((numpy.minimum(starts, ends) <= high) & (numpy.maximum(starts, ends) >= low)).all(axis=1)
    near &= numpy.linalg.norm(ends - starts, axis=1) > least
    hits = []
    for number in numpy.nonzero(near)[0].tolist():
        start, way = Vector(starts[number]), Vector(ends[number] - starts[number])
        place = body.solid.tree.ray_cast(start, way.normalized(), way.length + reach)[0]
        if place is not None:
            hits.append((number, place))
    return hits


class PassageFollower:
    """How deep objects get into colliders, or whether they pass through within a frame."""

    def __init__(self, request):
        self.start, self.end = request["start"], request["end"]
        self._request = request
        self._seen = {}
        self._at_first = {}  # pair → how deep it is at the first frame: a hinge in its leaf, say, which others judge
        self._passed = {}
        self._result = {"depth": 0.0, "through": False, "frame": None, "at": None, "pair": None}

    def look(self, frame, graph, tracker):
        """Measures a frame."""
        del graph
        for name in self._request["a"]:
            own = tracker.body(name)
            places = own.to_world(own.samples)
            for other in self._request["b"]:
                self._pair(frame, own, places, tracker.body(other))

    def _pair(self, frame, own, places, other):
        beyond = self._request["beyond"]
        pair = own.name, other.name
        now, before = other.to_own_space(places), self._seen.get(pair)
        self._seen[pair] = now
        is_first = before is None
        if before is None or len(before) != len(now):
            before = now
        if not _may_be_inside(other.solid, numpy.minimum(now, before), numpy.maximum(now, before), beyond):
            return
        if _stays_clear(other.solid, before, now, beyond):
            return
        depths = [_depth(other, now, beyond)]
        if own.solid.closed and other.solid.closed:
            inside = _depth(own, own.to_own_space(other.to_world(other.samples)), beyond)
            depths.append(
                inside and (inside[0], other.to_own_space(own.to_world(numpy.array([inside[1]])))[0])
            )
        deepest = max((deep for deep in depths if deep is not None), default=None, key=lambda deep: deep[0])
        if is_first and deepest is not None and self._request["but_first"]:
            self._at_first[pair] = deepest[0]
        elif deepest is not None and deepest[0] > self._at_first.get(pair, 0.0) + beyond:
            self._note(frame, (own, other), deepest, through=False)
        self._sweep(frame, (own, other), (before, now))

    def _sweep(self, frame, bodies, ways):
        """Counts the samples that changed sides since the frame before."""
        own, other = bodies
        before, now = ways
        passed = self._passed.setdefault((own.name, other.name), set())
        behind = []
        for number, place in _line_hits(other, before, now, least=self._request["beyond"]):
            if self._is_through(other.solid, Vector(before[number]), Vector(now[number]), place):
                passed.add(number)
                behind.append(((Vector(now[number]) - place).length, now[number]))
        if behind and len(passed) >= _PASSED * len(now):
            self._note(frame, bodies, max(behind, key=lambda hit: hit[0]), through=True)
            passed.clear()

    def _is_through(self, solid, start, end, place):
        """Whether a line that meets a solid ends behind it, rather than only cutting a corner."""
        beyond = self._request["beyond"]
        if solid.nearest(end)[3] <= beyond:
            return False
        if not solid.closed:
            return True
        if solid.holds(end):
            return False
        out = solid.tree.ray_cast(end, start - end)[0]
        is_thin = float((solid.high - solid.low).min()) <= 2 * beyond
        return is_thin or out is None or solid.nearest((place + out) / 2)[3] > beyond

    def _note(self, frame, bodies, deepest, *, through):
        own, other = bodies
        depth, place = deepest
        if depth > self._result["depth"]:
            at = other.to_world(numpy.array([place]))[0].tolist()
            pair = [own.name, other.name]
            self._result.update(depth=depth, through=through, frame=frame, at=at, pair=pair)

    def result(self):
        """The result as data."""
        return self._result


def _may_be_inside(solid, lows, highs, beyond):
    """Whether points between lows and highs may be ``beyond`` deep in a solid, judging by its box.

    Of a flat one: that far on both sides.
    """
    low, high = lows.min(axis=0), highs.max(axis=0)
    flat = (solid.high - solid.low) <= 2 * beyond
    deep = (low <= solid.high - beyond) & (high >= solid.low + beyond)
    on_both = (low <= solid.low - beyond) & (high >= solid.high + beyond)
    return bool(numpy.where(flat, on_both, deep).all())


def _stays_clear(solid, before, now, beyond):
    """Whether an object stays so far from a solid that no point of it, nor its path, can be ``beyond`` deep in it.

    For a rolling ball, say, this saves the exact test.
    """
    middles = before.mean(axis=0), now.mean(axis=0)
    reach = max(
        float(numpy.linalg.norm(places - middle, axis=1).max())
        for places, middle in zip((before, now), middles, strict=True)
    )
    away = min(solid.nearest(middle)[3] for middle in middles)
    half = float(numpy.linalg.norm(middles[1] - middles[0])) / 2
    if reach > beyond and (away <= half or away**2 - half**2 < (reach - beyond) ** 2):
        return False
    return not (solid.closed and solid.holds(middles[1]))


def _depth(body, places, beyond):
    """The deepest of some places (own space) in a body, if deeper than ``beyond``: (depth, place), or None.

    For an open one, which has no inside, the depth is how far the places reach on its shallower side.
    """
    solid = body.solid
    if not solid.closed:
        return _sheet_depth(solid, places, beyond)
    inside = ((places >= solid.low + beyond) & (places <= solid.high - beyond)).all(axis=1)
    depths = []
    for place in places[inside].tolist():
        foot, normal, _, away = solid.nearest(place)
        if foot is not None and away > beyond and (Vector(place) - foot).dot(normal) * body.inwards > 0:
            depths.append((away, place))
    depths.sort(key=lambda deep: deep[0], reverse=True)
    return next((deep for deep in depths[:_TESTED] if solid.holds(deep[1])), None)


def _sheet_depth(sheet, places, beyond):
    sides = {True: (0.0, None), False: (0.0, None)}
    for place in places.tolist():
        foot, normal, _, away = sheet.nearest(place)
        along = 0.0 if foot is None else (Vector(place) - foot).dot(normal)
        if abs(along) >= _UPRIGHT * away and abs(along) > sides[along > 0][0]:
            sides[along > 0] = abs(along), place
    least = min(sides.values(), key=lambda side: side[0])
    return least if least[0] > beyond else None
