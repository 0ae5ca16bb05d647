# SPDX-License-Identifier: GPL-3.0-or-later
"""Facts about objects' transforms and visible geometry (see agents.protocol.facts.ObjectFacts)."""

import math

import numpy

from ..geometry.evaluated_meshes import (
    AS_MESH,
    Instances,
    TooManyInstances,
    are_finite,
    coordinates,
    mesh_of,
    rendered,
    transformed,
)

_WITHOUT = {"EMPTY", "LIGHT", "CAMERA", "SPEAKER", "LIGHT_PROBE"}


class GeometryFacts:
    """Measures the objects of a scene, without changing it."""

    def __init__(self, scene, graph):
        self._graph = graph
        self._rendered = rendered(scene)
        self._instances = Instances(graph)

    def of(self, obj):
        """The facts about an object's transform and geometry."""
        evaluated = obj.evaluated_get(self._graph)
        source = evaluated if evaluated.is_evaluated else obj
        facts = {
            "evaluated": bool(evaluated.is_evaluated),
            "rendered": obj in self._rendered,
            "scale": _numbers(obj.scale),
            "matrix": _numbers(value for row in source.matrix_world for value in row),
        }
        try:
            facts.update(self._geometry(obj, source))
        except TooManyInstances as reason:
            facts.update(surface=True, fault=f"its instances cannot be read: {reason}")
        except Exception as error:
            facts.update(surface=True, fault=f"its geometry cannot be read: {type(error).__name__}: {error}")
        if not all(math.isfinite(value) for row in source.matrix_world for value in row):
            facts["fault"] = "its transform has values that are not finite"
            facts.pop("box", None)
        return facts

    def _geometry(self, obj, source):
        matrix, boxes, facts = source.matrix_world, [], {"polygons": 0}
        points, facts["polygons"] = _own(source)
        if points is not None:
            if not are_finite(points):
                return facts | {
                    "surface": facts["polygons"] > 0,
                    "fault": "it has vertices with coordinates that are not finite",
                }
            lengths = numpy.linalg.norm(numpy.array(matrix, dtype=float)[:3, :3], axis=0)
            facts["dimensions"] = _numbers((points.max(axis=0) - points.min(axis=0)) * lengths)
            boxes.append(transformed(points, matrix))
        for shape, where in self._instances.of(obj):
            facts["polygons"] += shape.polygons
            boxes.append(transformed(shape.corners, where))
        facts["surface"] = facts["polygons"] > 0
        if boxes:
            low = numpy.min([box.min(axis=0) for box in boxes], axis=0)
            high = numpy.max([box.max(axis=0) for box in boxes], axis=0)
            if are_finite([low, high]):
                facts["box"] = {"low": low.tolist(), "high": high.tolist()}
                facts.setdefault("dimensions", (high - low).tolist())
            else:
                facts["fault"] = "its instances have coordinates that are not finite"
        return facts


def _own(source):
    """(points of an object in its own space or corners of its box, number of polygons); (None, 0) without geometry."""
    if source.type in _WITHOUT:
        return None, 0
    with mesh_of(source) as mesh:
        if mesh is not None:
            return coordinates(mesh.vertices), len(mesh.polygons)
    if source.type in AS_MESH:
        return None, 0
    corners = numpy.array(source.bound_box, dtype=float)
    return (corners, 0) if (corners != corners[0]).any() else (None, 0)


def _numbers(values):
    """Floats; 0 for what is not finite."""
    return [value if math.isfinite(value) else 0.0 for value in map(float, values)]
