"""The parts of an object in a file without grouping (paper, appendix, "SPR cross-system fairness").

A file is grouped if at least half of its rendered geometry is in groups: hierarchies of several objects, or collections
that hold one object's parts. In such a file nothing is inferred. Otherwise, the assembly of an object is everything
connected to it: meshes whose bounds touch its own (to a centimetre), the meshes that touch those, and so on. It stops

- at objects of other actors and at groups, so that it never includes what it is compared to;
- at its support, and at what it supports: an object beneath (its top is in or below the other's lowest quarter) that is
  broader in plan than the other is long, like a floor, a rug, or a table under a vase, but not the foot of a lamp;
- at meshes more than three times as large as the assembly so far: a wall is not part of the picture on it;
- at 500 meshes.

Small meshes join first, so that parts add up before anything is compared to their size. An assembly is used only if a
relation of contact or nearness does not hold without it: it can raise a score, but not lower it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.audit.facts import GEOMETRY

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from bench.audit.facts import Object, Scene, Vector

TOUCHING = 0.01  # metres
MOST = 500
_GROUPED = 0.5
_LARGER = 3.0
_LOWEST = 0.25
# Collections that Blender makes for itself.
_BLENDERS_OWN = ("RigidBodyWorld", "RigidBodyConstraints")


@dataclass(frozen=True, slots=True)
class ObjectBounds:
    """Bounds of an object at the start, in metres."""

    low: Vector
    high: Vector

    @property
    def diagonal(self) -> float:
        """From corner to corner."""
        return sum((b - a) ** 2 for a, b in zip(self.low, self.high, strict=True)) ** 0.5

    @property
    def breadth(self) -> float:
        """From corner to corner in plan."""
        return sum((b - a) ** 2 for a, b in zip(self.low[:2], self.high[:2], strict=True)) ** 0.5

    def touches(self, other: ObjectBounds) -> bool:
        """Whether they overlap, or are at most a centimetre apart along each axis."""
        sides = zip(self.low, self.high, other.low, other.high, strict=True)
        return all(a <= d + TOUCHING and c <= b + TOUCHING for a, b, c, d in sides)

    def union(self, other: ObjectBounds) -> ObjectBounds:
        """The bounds of both."""
        (a, b, c), (d, e, f) = self.low, other.low
        (g, h, i), (j, k, m) = self.high, other.high
        return ObjectBounds((min(a, d), min(b, e), min(c, f)), (max(g, j), max(h, k), max(i, m)))

    def carries(self, other: ObjectBounds) -> bool:
        """Whether the other stands on it: it is beneath the other, and broader than the other is long."""
        height = other.high[2] - other.low[2]
        beneath = self.high[2] <= other.low[2] + _LOWEST * height + TOUCHING
        return beneath and self.breadth > other.diagonal


class Assemblies:
    """The assemblies of a scene. ``actor_objects``: names of all objects that belong to an actor."""

    def __init__(self, scene: Scene, actor_objects: Iterable[str]) -> None:
        self.boxes = {obj.name: box for obj in _geometry(scene) if (box := _bounds_of(obj)) is not None}
        groups = list(_groups(scene, self.boxes))
        in_groups = {name for group in groups for name in group}
        self.is_grouped = len(in_groups) >= _GROUPED * len(self.boxes)
        self._in_groups = in_groups
        taken = in_groups | set(actor_objects)
        self._free = sorted(self.boxes.keys() - taken, key=lambda name: (self.boxes[name].diagonal, name))

    def grown(self, names: Iterable[str]) -> tuple[str, ...]:
        """An object's parts (by name) with the rest of its assembly; unchanged if the file, or a part, is grouped."""
        own = tuple(names)
        seeds = [self.boxes[name] for name in own if name in self.boxes]
        if self.is_grouped or not seeds or any(name in self._in_groups for name in own):
            return own
        assembly, boxes, whole = list(own), list(seeds), seeds[0]
        for box in seeds:
            whole = whole.union(box)
        waiting = [name for name in self._free if name not in own]
        while len(assembly) < MOST:
            joining = next((name for name in waiting if _joins(self.boxes[name], boxes, whole)), None)
            if joining is None:
                break
            waiting.remove(joining)
            assembly.append(joining)
            boxes.append(self.boxes[joining])
            whole = whole.union(self.boxes[joining])
        return tuple(assembly)


def _joins(box: ObjectBounds, parts: list[ObjectBounds], whole: ObjectBounds) -> bool:
    if box.diagonal > _LARGER * whole.diagonal or not box.touches(whole):
        return False
    if box.carries(whole) or whole.carries(box):
        return False
    return any(box.touches(part) for part in parts)


def _geometry(scene: Scene) -> Iterator[Object]:
    return (obj for obj in scene.objects if obj.in_scene and obj.renders and obj.type in GEOMETRY)


def _bounds_of(obj: Object) -> ObjectBounds | None:
    moment = obj.moments[0] if obj.moments else None
    if moment is None or moment.low is None or moment.high is None:
        return None
    return ObjectBounds(moment.low, moment.high)


def _groups(scene: Scene, boxes: dict[str, ObjectBounds]) -> Iterator[frozenset[str]]:
    """The groups of a scene, as names of geometry; a group that holds more than half of it does not count."""
    for group, several in (*_hierarchies(scene, boxes), *_collections(scene, boxes)):
        if several and group and (len(boxes) < 4 or len(group) <= _GROUPED * len(boxes)):
            yield group


def _hierarchies(scene: Scene, boxes: dict[str, ObjectBounds]) -> list[tuple[frozenset[str], bool]]:
    parents = {obj.name: obj.parent for obj in scene.objects if obj.in_scene}
    trees: dict[str, list[str]] = {}
    for name in parents:
        top, seen = name, set[str]()
        while (above := parents.get(top)) is not None and above in parents and top not in seen:
            seen.add(top)
            top = above
        trees.setdefault(top, []).append(name)
    return [(frozenset(tree) & boxes.keys(), len(tree) > 1) for tree in trees.values()]


def _collections(scene: Scene, boxes: dict[str, ObjectBounds]) -> list[tuple[frozenset[str], bool]]:
    """Collections that a property marks as one object's, or whose geometry is connected."""
    groups: list[tuple[frozenset[str], bool]] = []
    for collection in scene.collections:
        members = frozenset(collection.objects) & boxes.keys()
        marked = any(value.casefold() == "object" for value in collection.properties.values())
        if collection.name.startswith(_BLENDERS_OWN) or len(members) > MOST:
            continue
        groups.append((members, marked or _is_connected([boxes[name] for name in sorted(members)])))
    return groups


def _is_connected(boxes: list[ObjectBounds]) -> bool:
    connected, waiting = boxes[:1], boxes[1:]
    for here in connected:
        joining = [box for box in waiting if box.touches(here)]
        waiting = [box for box in waiting if not box.touches(here)]
        connected += joining
    return bool(boxes) and not waiting
