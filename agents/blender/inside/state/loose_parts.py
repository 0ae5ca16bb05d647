# SPDX-License-Identifier: GPL-3.0-or-later
"""The sizes of the parts that a mesh consists of: legs, seat and back of a chair that is one mesh."""

import numpy

from ..geometry.evaluated_meshes import are_finite, coordinates
from ..geometry.topology import connected_labels, grouped
from .rna_values import number

MOST_SHOWN = 4  # parts of one mesh
_MOST_VERTICES = 100_000  # of one readout
_MOST_PARTS = 1_000  # of one mesh; with more, it is a heap of like things


class PartReader:
    """Measures the connected parts of evaluated meshes, up to a number of vertices."""

    def __init__(self):
        self._left = _MOST_VERTICES

    def entry(self, evaluated):
        """``parts``, the largest ones as [[size], [middle of its underside]], and how many ``more_parts`` there are.

        Along the object's axes, to a thousandth of the scene's unit. {} for what has a single part, or too many.
        """
        mesh = evaluated.data if evaluated is not None and evaluated.type == "MESH" else None
        if mesh is None or not len(mesh.edges) or len(mesh.vertices) > self._left:
            return {}
        count = len(mesh.vertices)
        self._left -= count
        ends = numpy.empty(2 * len(mesh.edges), numpy.int32)
        mesh.edges.foreach_get("vertices", ends)
        points = coordinates(mesh.vertices) * numpy.array(evaluated.matrix_world.to_scale())
        if not are_finite(points):
            return {}
        _, _, low, high = grouped(connected_labels(count, ends[::2], ends[1::2]), (points, points))
        if not 1 < len(low) <= _MOST_PARTS:
            return {}
        sizes = high - low
        faces = sizes * numpy.roll(sizes, 1, axis=1)
        order = numpy.argsort(-faces.sum(axis=1), kind="stable")[:MOST_SHOWN]
        places = (low + high) / 2
        places[:, 2] = low[:, 2]
        told = {"parts": [[_rounded(sizes[part]), _rounded(places[part])] for part in order.tolist()]}
        return told | ({"more_parts": len(low) - MOST_SHOWN} if len(low) > MOST_SHOWN else {})


def _rounded(lengths):
    return [number(round(length, 3) + 0.0) for length in lengths.tolist()]
