# SPDX-License-Identifier: GPL-3.0-or-later
"""Answers batches of measurements, frame by frame (see agents.protocol.measures.requests)."""

import itertools
import math

import bpy
import numpy

from ..geometry.contact_regions import labels
from ..geometry.distances import apart, gap
from ..geometry.penetration import crossing
from ..geometry.solids import NoSurface, NotNumbers, Solids, Unmeasurable
from .camera_view import view
from .containment import embedding, enclosure
from .frame_walk import FOLLOWED, Following, telling
from .openings import opening
from .position import axes_of, beside, over
from .support import depth, flush, support

_NOT_REACHED = "it was not reached"


def measure(arguments, report):
    """[{"value": …} or {"unmeasured": why}] for ``requests``, in their order.

    Frames are visited in order, each once for all that is measured there; where a simulation is not baked, they are
    stepped through from its start. The scene is left at the frame that it stood at.
    """
    requests = arguments["requests"]
    answers = [{"unmeasured": _NOT_REACHED} for _ in requests]
    following, by_frame = Following(requests, answers), {}
    for place, request in enumerate(requests):
        if request["kind"] not in FOLLOWED:
            by_frame.setdefault(request.get("frame"), []).append(place)
    # The frame that the scene stands at is visited too: what was moved since need not be what is keyed there.
    _answer(requests, by_frame.pop(None, []), answers)
    try:
        for frame in following.through(by_frame, report):
            _answer(requests, by_frame.get(frame, []), answers)
    except Unmeasurable as reason:
        for answer in answers:
            if answer.get("unmeasured") == _NOT_REACHED:
                answer["unmeasured"] = str(reason)
    following.tell()
    return answers


def _answer(requests, places, answers):
    if not places:
        return
    solids = Solids()
    for place in places:
        request = requests[place]
        with telling(answers, place):
            if request["kind"] not in MEASURED:
                raise Unmeasurable(f"nobody measures {request['kind']!r} here")
            answers[place] = {"value": MEASURED[request["kind"]](request, solids)}


def _gap(request, solids):
    ours, theirs = ([*_shown(solids, request[side])] for side in "ab")
    best = None
    for a, b in sorted(itertools.product(ours, theirs), key=lambda pair: apart(*pair)):
        best = gap(a, b, best[0] if best else math.inf, request["enough"]) or best
        if best[0] <= request["enough"]:
            break
    distance, here, there = best
    return {"distance": distance, "here": tuple(here), "there": tuple(there)}


def _shown(solids, names):
    """The solids of some names; of several, those that have a surface at this frame. Raises Unmeasurable."""
    found, missing = [], None
    for name in names:
        try:
            found.append(solids[name])
        except NoSurface as reason:
            missing = reason
    if not found:
        raise missing or Unmeasurable("nothing was named")
    return found


def _crossings(request, solids):
    found, undecided, made = [], [], []
    for name in request["names"]:
        try:
            made.append(solids[name])
        except NoSurface:
            continue
        except Unmeasurable as reason:
            undecided.append({"a": name, "b": name, "undecided": str(reason)})
    moving = None if request["moving"] is None else set(request["moving"])
    but = {tuple(sorted(pair)) for pair in request["but"]}
    for a, b in _near(made):
        if moving is not None and a.name not in moving and b.name not in moving:
            continue
        if tuple(sorted((a.name, b.name))) in but:
            continue
        try:
            told = crossing(a, b, request["noise"])
        except Exception as error:
            undecided.append({"a": a.name, "b": b.name, "undecided": f"{type(error).__name__}: {error}"})
            continue
        if told is not None:
            depth, place, reason = told
            told = {"a": a.name, "b": b.name, "depth": depth, "at": tuple(place), "undecided": reason}
            found.append(told | {"way": _way_out(a, b)})
    return {"pairs": found + undecided}


def _way_out(a, b):
    """The shortest move of a solid along an axis after which its box is beside another one's."""
    down, up = a.high - b.low, b.high - a.low
    axis = int(numpy.minimum(down, up).argmin())
    way = [0.0, 0.0, 0.0]
    way[axis] = float(up[axis] if up[axis] <= down[axis] else -down[axis])
    return way


def _near(solids, within=0.0):
    """Pairs whose boxes overlap, or come so near."""
    solids = sorted(solids, key=lambda one: one.low[0])
    if len(solids) < 2:
        return
    lows = numpy.array([one.low for one in solids])
    highs = numpy.array([one.high for one in solids]) + within
    ends = numpy.searchsorted(lows[:, 0], highs[:, 0], side="right")
    for at, end in enumerate(ends.tolist()):
        others = slice(at + 1, end)
        meets = (lows[others] <= highs[at]).all(axis=1) & (highs[others] >= lows[at]).all(axis=1)
        for other in (numpy.nonzero(meets)[0] + at + 1).tolist():
            yield solids[at], solids[other]


def _boxes(request, solids):
    boxes = {}
    for name in request["names"]:
        solid = solids[name]
        boxes[name] = {"low": solid.low.tolist(), "high": solid.high.tolist()}
    return {"boxes": boxes}


def _extents(request, solids):
    axes = numpy.array(request["axes"], dtype=float)
    if request["of"]:
        axes = axes @ axes_of(request["of"])
    reach = solids.joined(request["names"]).points @ axes.T
    return {"low": reach.min(axis=0).tolist(), "high": reach.max(axis=0).tolist()}


def _poses(request, _solids):
    graph = bpy.context.evaluated_depsgraph_get()
    matrices = {}
    for name in request["names"]:
        thing = bpy.context.scene.objects.get(name)
        if thing is None:
            raise Unmeasurable(f"there is no object {name!r} in the scene")
        numbers = [value for row in thing.evaluated_get(graph).matrix_world for value in row]
        if not all(map(math.isfinite, numbers)):
            raise Unmeasurable(f"the transform of {name!r} has values that are no numbers")
        matrices[name] = numbers
    return {"matrices": matrices}


def _pieces(request, solids):
    made = _shown(solids, request["names"])
    above = {one.name: one.name for one in made}

    def top(name):
        while above[name] != name:
            above[name] = above[above[name]]
            name = above[name]
        return name

    for a, b in _near(made, request["most"]):
        if top(a.name) != top(b.name):
            share = request["share"] * min(a.diagonal, b.diagonal)
            within = min(request["most"], max(request["least"], share))
            if gap(a, b, within, within) is not None or crossing(a, b) is not None:
                above[top(a.name)] = top(b.name)
    groups = {}
    for one in made:
        groups.setdefault(top(one.name), []).append(one.name)
    return {"pieces": sorted(groups.values())}


def _surface(request, solids):
    try:
        solid = solids[request["name"]]
    except NotNumbers:
        return dict.fromkeys(("vertices", "polygons", "open_edges", "parts"), 0) | {
            "finite": False,
            "volume": 0,
            "area": 0,
        }
    corners = solid.points[solid.triangles]
    normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    edges, counts = solid.edges
    volume = float(numpy.einsum("ij,ij->i", corners[:, 0], normals).sum() / 6) if solid.closed else 0.0
    return {
        "vertices": len(solid.points),
        "polygons": len(solid.triangles),
        "finite": True,
        "open_edges": int((counts != 2).sum()),
        "volume": abs(volume) if math.isfinite(volume) else 0.0,
        "area": float(numpy.linalg.norm(normals, axis=1).sum() / 2),
        "parts": len(numpy.unique(labels(len(solid.welded[0]), *edges.T)[edges[:, 0]])),
    }


# Kind of request → what measures it at the current frame.
MEASURED = {
    "gap": _gap,
    "crossings": _crossings,
    "boxes": _boxes,
    "extents": _extents,
    "poses": _poses,
    "surface": _surface,
    "pieces": _pieces,
    "depth": depth,
    "support": support,
    "flush": flush,
    "opening": opening,
    "enclosure": enclosure,
    "embedding": embedding,
    "over": over,
    "beside": beside,
    "view": view,
}
