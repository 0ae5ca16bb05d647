# SPDX-License-Identifier: GPL-3.0-or-later
"""Sizes of what geometry nodes make: known numbers are followed from node to node, what is unknown counts as it stands.

Numbers that come from fields or attributes are unknown; a node with an unknown count makes what its socket says.
"""

import math
import operator
import sys
from dataclasses import replace

from .geometry_size import MOST_POINTS, Size, TooLarge, base_size, check_cells, quads, subdivided

_MOST_NODES = 200_000  # that are looked at for one file, groups counted as often as they are used
_DEEPEST = 32  # groups in groups
_RECURSION = 5_000
_REPEATS = 64  # iterations that are followed one by one; the rest grows as the last of them
_MOST = 2**53


class Trees:
    """The node trees of one file. ``setup``: as for ``geometry_size.grown``."""

    def __init__(self, setup):
        self.setup = setup
        self.left = _MOST_NODES
        self.known = {}

    def grown(self, size, modifier):
        """The size after a modifier of nodes. Raises TooLarge."""
        tree = modifier.node_group
        if tree is None:
            return size
        given = {}
        for item in tree.interface.items_tree:
            if item.item_type == "SOCKET" and item.in_out == "INPUT":
                given[item.identifier] = self._given(size, modifier, item)
        before = sys.getrecursionlimit()
        sys.setrecursionlimit(max(before, _RECURSION))
        try:
            return self.output(tree, given, 0)[0]
        finally:
            sys.setrecursionlimit(before)

    def _given(self, size, modifier, item):
        if item.socket_type == "NodeSocketGeometry":
            return size
        value = modifier.get(item.identifier, getattr(item, "default_value", None))
        return self.setup.high_of(modifier, f'["{item.identifier}"]', _number(value))

    def output(self, tree, given, depth):
        """The values of a tree's outputs, in their order. ``given``: identifier of an input → its Size or number."""
        key = (tree, tuple(sorted(given.items(), key=lambda pair: pair[0])))
        if key not in self.known:
            self.known[key] = [Size()]  # a tree that contains itself
            output = next((node for node in tree.nodes if node.bl_idname == "NodeGroupOutput"), None)
            walk = _Walk(self, tree, given, depth)
            self.known[key] = (
                [walk.value(socket) for socket in output.inputs if socket.identifier] if output else []
            )
        return self.known[key] or [Size()]

    def count(self):
        """Counts a node that is looked at. Raises TooLarge if there were too many."""
        self.left -= 1
        if self.left < 0:
            raise TooLarge("its node groups", _MOST_NODES + 1, "nodes or more", _MOST_NODES)


class _Walk:
    """The values at the sockets of one use of a tree."""

    def __init__(self, trees, tree, given, depth):
        self._trees, self._tree, self._given, self._depth = trees, tree, given, depth
        self.setup = trees.setup
        self._values = {}
        self._ways = trees.setup.once((_ways, tree), lambda: _ways(tree))

    def value(self, socket):
        """What arrives at an input: a Size for geometry, a number, or None where it is unknown."""
        ways = self._ways.get(socket, ())
        if socket.type == "GEOMETRY":
            size = Size()
            for node, start in ways:
                came = self._made(node, start)
                size = size.joined(came) if isinstance(came, Size) else size
            return size
        if ways:
            return self._made(*ways[0])
        if hasattr(socket, "default_value"):
            return _number(self.setup.high(socket, "default_value") if socket.type in _NUMBERS else None)
        return None

    def number(self, node, name, default=1):
        """The number at an input, never below 0; what its own setting says if it is unknown."""
        socket = node.inputs.get(name)
        value = None if socket is None else self.value(socket)
        if value is None and socket is not None:
            value = _number(getattr(socket, "default_value", None))
        if value is None or isinstance(value, Size) or math.isnan(value):
            value = default
        return max(0, min(value, _MOST))

    def whole(self, node, name, default=1):
        """The same as a whole number."""
        return int(self.number(node, name, default))

    def size(self, node, name=None):
        """The geometry at an input, by default at all of them together with the largest one's size."""
        if name is not None:
            socket = node.inputs.get(name)
            came = None if socket is None else self.value(socket)
            return came if isinstance(came, Size) else Size()
        sizes = [self.value(socket) for socket in node.inputs if socket.type == "GEOMETRY"]
        return max(sizes, key=lambda size: (size.points, size.instances), default=Size())

    def _made(self, node, socket):
        """The value at an output."""
        if socket not in self._values:
            self._trees.count()
            self._values[socket] = Size() if socket.type == "GEOMETRY" else None  # a circle of nodes
            self._values[socket] = self._make(node, socket)
        return self._values[socket]

    def _make(self, node, socket):
        if node.bl_idname == "NodeGroupInput":
            return self._given.get(socket.identifier)
        if node.bl_idname == "GeometryNodeGroup":
            return self._group(node, socket)
        if node.bl_idname == "NodeReroute":
            return self.value(node.inputs[0])
        if socket.type != "GEOMETRY":
            make = _VALUES.get(node.bl_idname)
            return None if make is None else make(self, node, socket)
        make = _GEOMETRY.get(node.bl_idname)
        if node.mute or make is None:
            return self.size(node)
        return make(self, node).checked(f"node {node.name[:60]!r}")

    def _group(self, node, socket):
        if node.node_tree is None or self._depth >= _DEEPEST:
            return None
        given = {each.identifier: self.value(each) for each in node.inputs if each.identifier}
        values = self._trees.output(node.node_tree, given, self._depth + 1)
        place = list(node.outputs).index(socket)
        return values[place] if place < len(values) else None

    def repeated(self, node):
        """What a repeat zone makes, followed from iteration to iteration."""
        start = self.setup.once((_zones, self._tree), lambda: _zones(self._tree)).get(node)
        body = next((socket for socket in node.inputs if socket.type == "GEOMETRY"), None)
        if start is None or body is None:
            return Size()
        size, times, outside = self.size(start), self.whole(start, "Iterations"), dict(self._values)
        for done in range(times):
            self._values = {socket: size for socket in start.outputs if socket.type == "GEOMETRY"}
            after = self.value(body)
            if after == size or after.points > MOST_POINTS:
                size = after
                break
            if done == _REPEATS:
                size = after.times(
                    (times - done) * max(1, after.points - size.points) // max(1, after.points) + 1
                )
                break
            size = after
        self._values = outside
        return size


def _ways(tree):
    """Socket → the nodes and sockets that lead to it."""
    ways = {}
    for link in tree.links:
        if link.is_valid and not link.is_muted:
            ways.setdefault(link.to_socket, []).append((link.from_node, link.from_socket))
    return ways


def _zones(tree):
    """The last node of a repeat zone → its first."""
    pairs = [(getattr(node, "paired_output", None), node) for node in tree.nodes]
    return {last: first for last, first in pairs if last is not None}


_NUMBERS = {"INT", "VALUE", "BOOLEAN"}


def _number(value):
    return value if isinstance(value, int | float) else None


# Nodes that make geometry


def _mesh_grid(walk, node):
    extent = (walk.number(node, "Size X"), walk.number(node, "Size Y"), 0.0)
    return quads(walk.whole(node, "Vertices X") * walk.whole(node, "Vertices Y"), extent)


def _cube(walk, node):
    x, y, z = (walk.whole(node, f"Vertices {axis}") for axis in "XYZ")
    return quads(2 * (x * y + y * z + z * x), (2.0, 2.0, 2.0))


def _sphere(walk, node):
    across = 2 * walk.number(node, "Radius")
    return quads(walk.whole(node, "Segments") * walk.whole(node, "Rings"), (across, across, across))


def _ico_sphere(walk, node):
    across = 2 * walk.number(node, "Radius")
    return quads(20 * 4 ** min(40, max(0, walk.whole(node, "Subdivisions") - 1)), (across, across, across))


def _cylinder(walk, node):
    rings = walk.whole(node, "Side Segments") + 2 * walk.whole(node, "Fill Segments") + 1
    return quads(walk.whole(node, "Vertices") * rings, (2.0, 2.0, 2.0))


def _line_of(name):
    def line(walk, node):
        count = walk.whole(node, name)
        return Size(count, count, 0, 0, (1.0, 1.0, 1.0))

    return line


def _subdivide(walk, node):
    return subdivided(walk.size(node), min(walk.whole(node, "Level"), 256))


def _cut(walk, node):
    return walk.size(node).times(1 + walk.whole(node, "Cuts"))


def _duplicate(walk, node):
    return walk.size(node).times(walk.whole(node, "Amount"))


def _extrude(walk, node):
    return walk.size(node).times(5)


def _joined(walk, node):
    size = Size()
    for socket in node.inputs:
        if socket.type == "GEOMETRY":
            size = size.joined(walk.value(socket))
    return size


def _tube(walk, node):
    curve, profile = walk.size(node, "Curve"), walk.size(node, "Profile Curve")
    return quads(curve.vertices * max(1, profile.vertices), curve.extent) if profile.vertices else curve


def _scattered(walk, node):
    x, y, z = walk.size(node).extent
    density = max(walk.number(node, "Density"), walk.number(node, "Density Max", 0))
    area = 2 * (x * y + y * z + z * x)
    return Size(int(min(area * density, _MOST)) if math.isfinite(area) else _MOST, extent=(x, y, z))


def _instances(walk, node):
    points, shown = walk.size(node, "Points"), walk.size(node, "Instance")
    times = points.vertices
    return Size(
        instances=times * (1 + shown.instances),
        inside=times * (shown.points + shown.inside),
        extent=points.extent,
    )


def _as_instance(walk, node):
    size = _joined(walk, node)
    return Size(instances=1 + size.instances, inside=size.points + size.inside, extent=size.extent)


def _realized(walk, node):
    size = walk.size(node)
    more = quads(size.inside, size.extent)
    return replace(size.joined(more), instances=0, inside=0)


def _of_object(walk, node):
    obj = node.inputs["Object"].default_value if "Object" in node.inputs else None
    return Size() if obj is None else base_size(obj, walk.setup)


def _of_collection(walk, node):
    collection = node.inputs["Collection"].default_value if "Collection" in node.inputs else None
    if collection is None:
        return Size()
    return walk.setup.once((_of_collection, collection), lambda: Size(instances=len(collection.all_objects)))


def _volume(walk, node):
    x, y, z = (walk.whole(node, f"Resolution {axis}") for axis in "XYZ")
    check_cells(f"node {node.name[:60]!r}", x * y * z)
    return Size()


def _mesh_to_volume(walk, node):
    check_cells(f"node {node.name[:60]!r}", walk.whole(node, "Voxel Amount") ** 3)
    return Size()


_GEOMETRY = {
    "GeometryNodeMeshGrid": _mesh_grid,
    "GeometryNodeMeshCube": _cube,
    "GeometryNodeMeshUVSphere": _sphere,
    "GeometryNodeMeshIcoSphere": _ico_sphere,
    "GeometryNodeMeshCylinder": _cylinder,
    "GeometryNodeMeshCone": _cylinder,
    "GeometryNodeMeshCircle": _line_of("Vertices"),
    "GeometryNodeMeshLine": _line_of("Count"),
    "GeometryNodePoints": _line_of("Count"),
    "GeometryNodeCurvePrimitiveCircle": _line_of("Resolution"),
    "GeometryNodeCurvePrimitiveBezierSegment": _line_of("Resolution"),
    "GeometryNodeCurveQuadraticBezier": _line_of("Resolution"),
    "GeometryNodeCurveArc": _line_of("Resolution"),
    "GeometryNodeCurveSpiral": _line_of("Resolution"),
    "GeometryNodeCurveStar": _line_of("Points"),
    "GeometryNodeResampleCurve": _line_of("Count"),
    "GeometryNodeSubdivideMesh": _subdivide,
    "GeometryNodeSubdivisionSurface": _subdivide,
    "GeometryNodeSubdivideCurve": _cut,
    "GeometryNodeDuplicateElements": _duplicate,
    "GeometryNodeExtrudeMesh": _extrude,
    "GeometryNodeJoinGeometry": _joined,
    "GeometryNodeMeshBoolean": _joined,
    "GeometryNodeCurveToMesh": _tube,
    "GeometryNodeDistributePointsOnFaces": _scattered,
    "GeometryNodeInstanceOnPoints": _instances,
    "GeometryNodeGeometryToInstance": _as_instance,
    "GeometryNodeRealizeInstances": _realized,
    "GeometryNodeObjectInfo": _of_object,
    "GeometryNodeCollectionInfo": _of_collection,
    "GeometryNodeVolumeCube": _volume,
    "GeometryNodeMeshToVolume": _mesh_to_volume,
    "GeometryNodeRepeatOutput": _Walk.repeated,
}


# Nodes that make numbers


def _integer(_walk, node, _socket):
    return node.integer


def _output(walk, _node, socket):
    return walk.setup.high(socket, "default_value")


def _calculated(walk, node, _socket):
    """The result of the operations that let numbers grow."""
    first, second = ([walk.value(socket) for socket in node.inputs] + [None, None])[:2]
    if not all(isinstance(value, int | float) for value in (first, second)):
        return None
    work = _OPERATIONS.get(node.operation)
    try:
        return None if work is None else max(-_MOST, min(work(float(first), float(second)), _MOST))
    except ArithmeticError:
        return _MOST
    except TypeError:  # a power of a negative number may be complex
        return None


_OPERATIONS = {
    "ADD": operator.add,
    "SUBTRACT": operator.sub,
    "MULTIPLY": operator.mul,
    "DIVIDE": operator.truediv,
    "POWER": operator.pow,
}
_VALUES = {
    "FunctionNodeInputInt": _integer,
    "ShaderNodeValue": _output,
    "ShaderNodeMath": _calculated,
    "FunctionNodeIntegerMath": _calculated,
}
