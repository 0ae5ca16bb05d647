# SPDX-License-Identifier: GPL-3.0-or-later
"""Facts about where objects are and what of them is to be seen (see agents.protocol.facts.ObjectFacts)."""

import math

import numpy

from ..geometry.evaluated import (
    AS_MESH,
    Instances,
    TooManyInstances,
    are_numbers,
    coordinates,
    mesh_of,
    rendered,
    transformed,
)

_WITHOUT = {"EMPTY", "LIGHT", "CAMERA", "SPEAKER", "LIGHT_PROBE"}


class GeometryFacts:
    """Measures the objects of a scene, of which nothing is changed."""

    def __init__(self, scene, graph):
        self._graph = graph
        self._rendered = rendered(scene)
        self._instances = Instances(graph)

    def of(self, thing):
        """What the facts say of an object's place and geometry."""
        found = thing.evaluated_get(self._graph)
        source = found if found.is_evaluated else thing
        told = {
            "evaluated": bool(found.is_evaluated),
            "rendered": thing in self._rendered,
            "scale": _numbers(thing.scale),
            "matrix": _numbers(value for row in source.matrix_world for value in row),
        }
        try:
            told.update(self._geometry(thing, source))
        except TooManyInstances as reason:
            told.update(surface=True, fault=f"what it makes instances of cannot be looked at: {reason}")
        except Exception as error:
            told.update(surface=True, fault=f"its geometry cannot be read: {type(error).__name__}: {error}")
        if not all(math.isfinite(value) for row in source.matrix_world for value in row):
            told["fault"] = "its transform has values that are not numbers"
            told.pop("box", None)
        return told

    def _geometry(self, thing, source):
        matrix, boxes, told = source.matrix_world, [], {"polygons": 0}
        points, told["polygons"] = _own(source)
        if points is not None:
            if not are_numbers(points):
                return told | {
                    "surface": told["polygons"] > 0,
                    "fault": "it has vertices at places that are not numbers",
                }
            lengths = numpy.linalg.norm(numpy.array(matrix, dtype=float)[:3, :3], axis=0)
            told["dimensions"] = _numbers((points.max(axis=0) - points.min(axis=0)) * lengths)
            boxes.append(transformed(points, matrix))
        for shape, where in self._instances.of(thing):
            told["polygons"] += shape.polygons
            boxes.append(transformed(shape.corners, where))
        told["surface"] = told["polygons"] > 0
        if boxes:
            low = numpy.min([box.min(axis=0) for box in boxes], axis=0)
            high = numpy.max([box.max(axis=0) for box in boxes], axis=0)
            if are_numbers([low, high]):
                told["box"] = {"low": low.tolist(), "high": high.tolist()}
                told.setdefault("dimensions", (high - low).tolist())
            else:
                told["fault"] = "what it makes instances of is at places that are not numbers"
        return told


def _own(source):
    """(points of an object in its own space, or corners around them; how many polygons it has); None for nothing."""
    if source.type in _WITHOUT:
        return None, 0
    with mesh_of(source) as mesh:
        if mesh is not None:
            return coordinates(mesh), len(mesh.polygons)
    if source.type in AS_MESH:
        return None, 0
    corners = numpy.array(source.bound_box, dtype=float)
    return (corners, 0) if (corners != corners[0]).any() else (None, 0)


def _numbers(values):
    """Floats; 0 for what is no number."""
    return [value if math.isfinite(value) else 0.0 for value in map(float, values)]
