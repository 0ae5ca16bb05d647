"""What belongs to a thing in a file that does not say so (paper, appendix, "SPR cross-system fairness").

A file is grouped if at least half of its rendered geometry stands in groups: hierarchies of several objects, or
collections that are one thing's. There, nothing is inferred. Elsewhere the assembly of a thing is what hangs together
with it: meshes whose bounds touch (to a centimetre), and those that touch these. It stops

- at everything that is an actor's, or in a group: it can never take in what it is compared to;
- at what it stands on, and at what stands on it: what lies beneath (its top is below the other's lowest quarter) and is
  broader in plan than the other is long, as a floor, a rug or a table under a vase, though not a foot under its lamp;
- at what is more than three times as large as all that has been found: a wall is no part of the picture on it;
- at 500 meshes.

Small meshes join first, so that parts make a thing before anything is compared to its size. An assembly is looked at
only where a relation of contact or nearness does not hold without it: it can add to a score, and take nothing away.
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
class Box:
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

    def touches(self, other: Box) -> bool:
        """Whether they overlap, or are no further apart than touching along any axis."""
        sides = zip(self.low, self.high, other.low, other.high, strict=True)
        return all(a <= d + TOUCHING and c <= b + TOUCHING for a, b, c, d in sides)

    def with_(self, other: Box) -> Box:
        """What spans both."""
        (a, b, c), (d, e, f) = self.low, other.low
        (g, h, i), (j, k, m) = self.high, other.high
        return Box((min(a, d), min(b, e), min(c, f)), (max(g, j), max(h, k), max(i, m)))

    def carries(self, other: Box) -> bool:
        """Whether it is what the other stands on: beneath it, and broader than it is long."""
        height = other.high[2] - other.low[2]
        beneath = self.high[2] <= other.low[2] + _LOWEST * height + TOUCHING
        return beneath and self.breadth > other.diagonal


class Assemblies:
    """The assemblies of a scene. ``cast``: names of all objects that are some actor's."""

    def __init__(self, scene: Scene, cast: Iterable[str]) -> None:
        self.boxes = {one.name: box for one in _geometry(scene) if (box := _box(one)) is not None}
        groups = list(_groups(scene, self.boxes))
        in_groups = {name for group in groups for name in group}
        self.is_grouped = len(in_groups) >= _GROUPED * len(self.boxes)
        self._in_groups = in_groups
        taken = in_groups | set(cast)
        self._free = sorted(self.boxes.keys() - taken, key=lambda name: (self.boxes[name].diagonal, name))

    def grown(self, names: Iterable[str]) -> tuple[str, ...]:
        """A thing's objects with what else is its assembly; the same where the file, or the thing, is grouped."""
        own = tuple(names)
        seeds = [self.boxes[name] for name in own if name in self.boxes]
        if self.is_grouped or not seeds or any(name in self._in_groups for name in own):
            return own
        found, boxes, whole = list(own), list(seeds), seeds[0]
        for box in seeds:
            whole = whole.with_(box)
        waiting = [name for name in self._free if name not in own]
        while len(found) < MOST:
            joining = next((name for name in waiting if _joins(self.boxes[name], boxes, whole)), None)
            if joining is None:
                break
            waiting.remove(joining)
            found.append(joining)
            boxes.append(self.boxes[joining])
            whole = whole.with_(self.boxes[joining])
        return tuple(found)


def _joins(box: Box, parts: list[Box], whole: Box) -> bool:
    if box.diagonal > _LARGER * whole.diagonal or not box.touches(whole):
        return False
    if box.carries(whole) or whole.carries(box):
        return False
    return any(box.touches(part) for part in parts)


def _geometry(scene: Scene) -> Iterator[Object]:
    return (one for one in scene.objects if one.in_scene and one.renders and one.type in GEOMETRY)


def _box(one: Object) -> Box | None:
    moment = one.moments[0] if one.moments else None
    if moment is None or moment.low is None or moment.high is None:
        return None
    return Box(moment.low, moment.high)


def _groups(scene: Scene, boxes: dict[str, Box]) -> Iterator[frozenset[str]]:
    """The groups of a scene, as names of geometry. What holds most of several meshes groups nothing."""
    for group, several in (*_hierarchies(scene, boxes), *_collections(scene, boxes)):
        if several and group and (len(boxes) < 4 or len(group) <= _GROUPED * len(boxes)):
            yield group


def _hierarchies(scene: Scene, boxes: dict[str, Box]) -> list[tuple[frozenset[str], bool]]:
    parents = {one.name: one.parent for one in scene.objects if one.in_scene}
    trees: dict[str, list[str]] = {}
    for name in parents:
        top, seen = name, set[str]()
        while (above := parents.get(top)) is not None and above in parents and top not in seen:
            seen.add(top)
            top = above
        trees.setdefault(top, []).append(name)
    return [(frozenset(tree) & boxes.keys(), len(tree) > 1) for tree in trees.values()]


def _collections(scene: Scene, boxes: dict[str, Box]) -> list[tuple[frozenset[str], bool]]:
    """Collections that say of themselves that they are an object's, or whose geometry hangs together."""
    found: list[tuple[frozenset[str], bool]] = []
    for each in scene.collections:
        members = frozenset(each.objects) & boxes.keys()
        marked = any(value.casefold() == "object" for value in each.properties.values())
        if each.name.startswith(_BLENDERS_OWN) or len(members) > MOST:
            continue
        found.append((members, marked or _hangs_together([boxes[name] for name in sorted(members)])))
    return found


def _hangs_together(boxes: list[Box]) -> bool:
    reached, waiting = boxes[:1], boxes[1:]
    for here in reached:
        joining = [box for box in waiting if box.touches(here)]
        waiting = [box for box in waiting if not box.touches(here)]
        reached += joining
    return bool(boxes) and not waiting
