# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes batches of measurements, frame by frame (see agents.protocol.measures.measure)."""

import itertools
import math

import bpy
import numpy

from ..geometry.distances import box_distance, gap
from ..geometry.penetration import penetration
from ..geometry.solids import NoSurface, NotNumbers, Solids, Unmeasurable
from ..geometry.topology import connected_labels
from ..physics.finite_check import Diverged
from .camera_visibility import camera_view
from .containment import embedding, enclosure
from .frame_loop import FOLLOWED, Followers, unmeasured_as_answer
from .matter import matter
from .openings import opening
from .relative_position import axes_of, beside, over
from .support import depth, flush, support

_NOT_REACHED = "the measurement stopped before its frame"


def measure(arguments, report):
    """[{"value": …} or {"unmeasured": why}] for ``requests``, in their order.

    Frames are visited in order, each once for all its requests; if a simulation is not baked, every frame from its
    start is visited. The scene ends at the frame where it was. If a simulation is not finite, no further frame is
    visited, and answers without a value have ``diverged`` as well: the ``object``, the ``frame`` and likely ``causes``.
    """
    requests = arguments["requests"]
    answers = [{"unmeasured": _NOT_REACHED} for _ in requests]
    followers, by_frame = Followers(requests, answers), {}
    for place, request in enumerate(requests):
        if request["kind"] not in FOLLOWED:
            by_frame.setdefault(request.get("frame"), []).append(place)
    # What is measured at the current frame, before changing it: objects may have been moved off their keys.
    _measure_here(requests, by_frame.pop(None, []), answers)
    try:
        for frame in followers.through(by_frame, report):
            _measure_here(requests, by_frame.get(frame, []), answers)
    except Unmeasurable as reason:
        _fill(answers, {"unmeasured": str(reason)})
    except Diverged as reason:
        diverged = {"object": reason.object, "frame": reason.frame, "causes": reason.causes}
        _fill(answers, {"unmeasured": reason.what, "diverged": diverged})
    followers.finish()
    return answers


def _fill(answers, answer):
    """Gives ``answer`` to all requests whose frame was not reached."""
    for other in answers:
        if other.get("unmeasured") == _NOT_REACHED:
            other.update(answer)


def _measure_here(requests, places, answers):
    if not places:
        return
    solids = Solids()
    for place in places:
        request = requests[place]
        with unmeasured_as_answer(answers, place):
            if request["kind"] not in MEASURED:
                raise Unmeasurable(f"there is no measurement {request['kind']!r}")
            answers[place] = {"value": MEASURED[request["kind"]](request, solids)}


def _gap(request, solids):
    ours, theirs = ([*_solids_with_surface(solids, request[side])] for side in "ab")
    best = None
    for a, b in sorted(itertools.product(ours, theirs), key=lambda pair: box_distance(*pair)):
        best = gap(a, b, best[0] if best else math.inf, request["enough"]) or best
        if best[0] <= request["enough"]:
            break
    distance, here, there = best
    return {"distance": distance, "here": tuple(here), "there": tuple(there)}


def _solids_with_surface(solids, names):
    """The solids of some names; of several, those that have a surface at this frame. Raises Unmeasurable."""
    with_surface, missing = [], None
    for name in names:
        try:
            with_surface.append(solids[name])
        except NoSurface as reason:
            missing = reason
    if not with_surface:
        raise missing or Unmeasurable("no object was named")
    return with_surface


def _crossings(request, solids):
    pairs, undecided, there = [], [], []
    for name in request["names"]:
        try:
            there.append(solids[name])
        except NoSurface:
            continue
        except Unmeasurable as reason:
            undecided.append({"a": name, "b": name, "undecided": str(reason)})
    moving = None if request["moving"] is None else set(request["moving"])
    but = {tuple(sorted(pair)) for pair in request["but"]}
    for a, b in _pairs_near(there):
        if moving is not None and a.name not in moving and b.name not in moving:
            continue
        if tuple(sorted((a.name, b.name))) in but:
            continue
        try:
            shared = penetration(a, b, request["noise"])
        except Exception as error:
            undecided.append({"a": a.name, "b": b.name, "undecided": f"{type(error).__name__}: {error}"})
            continue
        if shared is not None:
            depth, place, reason = shared
            shared = {"a": a.name, "b": b.name, "depth": depth, "at": tuple(place), "undecided": reason}
            pairs.append(shared | {"way": _way_out(a, b)})
    return {"pairs": pairs + undecided}


def _way_out(a, b):
    """The shortest move of ``a`` along an axis that takes its box out of that of ``b``."""
    down, up = a.high - b.low, b.high - a.low
    axis = int(numpy.minimum(down, up).argmin())
    way = [0.0, 0.0, 0.0]
    way[axis] = float(up[axis] if up[axis] <= down[axis] else -down[axis])
    return way


def _pairs_near(solids, within=0.0):
    """Pairs of solids whose boxes overlap, or are at most ``within`` apart."""
    solids = sorted(solids, key=lambda solid: solid.low[0])
    if len(solids) < 2:
        return
    lows = numpy.array([solid.low for solid in solids])
    highs = numpy.array([solid.high for solid in solids]) + within
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
        obj = bpy.context.scene.objects.get(name)
        if obj is None:
            raise Unmeasurable(f"there is no object {name!r} in the scene")
        numbers = [value for row in obj.evaluated_get(graph).matrix_world for value in row]
        if not all(map(math.isfinite, numbers)):
            raise Unmeasurable(f"the transform of {name!r} has values that are not finite")
        matrices[name] = numbers
    return {"matrices": matrices}


def _pieces(request, solids):
    there = _solids_with_surface(solids, request["names"])
    above = {solid.name: solid.name for solid in there}

    def top(name):
        while above[name] != name:
            above[name] = above[above[name]]
            name = above[name]
        return name

    for a, b in _pairs_near(there, request["most"]):
        if top(a.name) != top(b.name):
            share = request["share"] * min(a.diagonal, b.diagonal)
            within = min(request["most"], max(request["least"], share))
            if gap(a, b, within, within) is not None or penetration(a, b) is not None:
                above[top(a.name)] = top(b.name)
    groups = {}
    for solid in there:
        groups.setdefault(top(solid.name), []).append(solid.name)
    return {"pieces": sorted(groups.values())}


def _surface(request, solids):
    try:
        solid = solids[request["name"]]
    except NotNumbers:
        counts = ("vertices", "polygons", "open_edges", "parts", "volume", "area")
        return dict.fromkeys(counts, 0) | {"finite": False}
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
        "parts": len(numpy.unique(connected_labels(len(solid.welded[0]), *edges.T)[edges[:, 0]])),
    }


# Kind of request → function that measures it at the current frame.
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
    "view": camera_view,
    "matter": matter,
}
