"""Access paths: for each class the expression over RNA pointers by which scripts come to an instance."""

from __future__ import annotations

import heapq
import json
import math
from collections import defaultdict
from dataclasses import dataclass, field
from itertools import takewhile
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import NARROWER
from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flag_names import EVALUATED, HIDDEN, ITERATED
from kb_build.symbols.lineages import lineage
from kb_build.symbols.lines import item_of, of_evaluated

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kb_build.symbols.records import Symbol


# Where scripts start. Other context members depend on the editor under the mouse.
_ROOTS = (("bpy.context", "Context", 0), ("bpy.context.object", "ID", 1), ("bpy.data", "BlendData", 2))
_EVERYWHERE = frozenset({"object", "scene", "view_layer", "collection"})
# What leads through the interface or the undo of a library is rarely the way a script goes.
_DETOURS = frozenset(
    {
        "window_manager", "window", "screen", "workspace", "area", "region", "preferences", "space_data", "library",
        "original", "override_library", "asset_data", "asset", "rigidbody_world",
        "blend_data", "nla_tracks", "material_override", "preview", "id_root", "parent", "tool_settings",
        "next_node", "prev_node", "texture", "active_strip", "compositing_node_group", "region_popup",
    }
)  # fmt: skip
_DETOUR_COST = 6
_KIND_BY_CHANCE = (
    5  # of a class that only some have which a pointer or collection leads to; a name tells which
)
_LAST_RESORT = {"drivers": 30.0}  # holds curves as animation does, but hardly anybody looks for them there
# What a step costs in addition that Blender's own scripts take less often than this.
_RARE = ((20, 0.0), (5, 0.5), (1, 1.5), (0, 4.0))
_ACTIVE_GAIN = 1.1  # the active element is what scripts begin with; any other one is found by its name
# What scripts come to through the active object; other data-blocks they take from ``bpy.data``.
_OBJECT_DATA = ("Mesh", "Armature")
_NOWHERE = (math.inf, "")  # what costs more than every way
_TOLD_COST = 5  # of what Blender tells how to reach: the preferences of an add-on
# What is reached as RNA does not tell, with what that costs: a driver is on a curve of its own kind, and interfaces
# that scripts make are those of groups.
_TOLD = {
    "Driver": ('bpy.context.object.animation_data.drivers.find("location", index=0).driver', _TOLD_COST),
    "Depsgraph": ("bpy.context.evaluated_depsgraph_get()", 1),  # a view layer's own is None, or stale
    "UILayout": ("self.layout", 1),  # where a class of the script's own draws
    "NodeTreeInterface": ('bpy.data.node_groups["Geometry Nodes"].interface', 1),
}
_SOCKET = "NodeSocket"
_MATERIAL = "Material"
_OF_WORLDS = frozenset({"ShaderNodeTexEnvironment", "ShaderNodeTexSky"})
_ENDS_OF_GROUPS = frozenset({"NodeGroupInput", "NodeGroupOutput"})  # no material's own tree has them
_NEVER_ACTIVE = frozenset({"Nodes"})  # none is, of those that scripts make
# What several classes have, as modifiers that few objects take, and scripts set on a node: class → (node, property).
_OF_NODES = {"ColorRamp": ("ShaderNodeValToRGB", "color_ramp")}
# Objects have them too, but only chains of bones are moved by them.
_OF_BONES = ("KinematicConstraint", "SplineIKConstraint")


@dataclass(frozen=True, slots=True)
class _Step:
    """A property that leads to another class. ``container`` is the class of a collection, which may have ``active``;
    ``evaluated``: only evaluated objects have it filled; ``iterated``: only a loop gives its elements.
    """

    name: str
    target: str
    cost: float
    many: bool = False
    container: str = ""
    evaluated: bool = False
    iterated: bool = False


@dataclass(slots=True)
class _Graph:
    """class → the properties of its own that lead to others."""

    edges: dict[str, list[_Step]] = field(default_factory=lambda: defaultdict(list[_Step]))
    base: dict[str, str] = field(default_factory=dict)
    derived: dict[str, list[str]] = field(default_factory=lambda: defaultdict(list))
    names: Mapping[str, str] = field(default_factory=dict[str, str])
    trees: dict[str, tuple[str, ...]] = field(default_factory=dict)
    descendants: dict[str, list[str]] = field(default_factory=dict)
    told: dict[str, str] = field(default_factory=dict)
    # Class of sockets → (class of nodes, subscript) of those that new nodes have.
    sockets: dict[str, list[tuple[str, str]]] = field(default_factory=lambda: defaultdict(list))

    def below(self, cls: str) -> list[str]:
        """Every class below one, each before its own."""
        if cls not in self.descendants:
            found = self.descendants[cls] = []
            for child in self.derived.get(cls, ()):
                found += [child, *self.below(child)]
        return self.descendants[cls]


def _graph(symbols: Iterable[Symbol], uses: Mapping[str, int], names: Mapping[str, str]) -> _Graph:
    graph = _Graph(names=names)
    for symbol in symbols:
        if symbol.kind == "class" and symbol.owner == "bpy.types":
            name, base = symbol.path.removeprefix(TYPES), symbol.base.removeprefix(TYPES)
            graph.base[name] = base
            if symbol.reached:
                graph.told[name] = symbol.reached
            if symbol.trees:
                graph.trees[name] = _usual_trees(name, symbol.trees)
            if base != "bpy_struct":
                graph.derived[base].append(name)
        elif symbol.kind in {"property", "context"} and symbol.target:
            if symbol.kind == "context" and symbol.name not in _EVERYWHERE:
                continue
            owner = "Context" if symbol.kind == "context" else symbol.owner.removeprefix(TYPES)
            detour = _LAST_RESORT.get(symbol.name, _DETOUR_COST if symbol.name in _DETOURS else 0.0)
            cost = 1.0 + detour + _rarity(symbol.path, uses)
            many = symbol.type == "collection"
            target = NARROWER.get(symbol.path, symbol.target)
            graph.edges[owner].append(
                _Step(
                    symbol.name,
                    target,
                    cost,
                    many,
                    symbol.collection,
                    evaluated=EVALUATED in symbol.flags,
                    iterated=ITERATED in symbol.flags,
                )
            )
            if symbol.path == f"{TYPES}Object.data":
                graph.edges[owner] += [_Step(symbol.name, name, cost) for name in _OBJECT_DATA]
        elif symbol.kind == "socket" and symbol.subscripts and HIDDEN not in symbol.flags:
            # Those with a pointer have the class that it leads to as target.
            cls = symbol.target if symbol.target.startswith(_SOCKET) else f"{_SOCKET}{symbol.type.title()}"
            graph.sockets[cls].append((symbol.owner.removeprefix(TYPES), symbol.subscripts[0]))
    for name in graph.below("Node") if graph.trees else ():
        if not graph.derived.get(name):
            graph.trees.setdefault(name, ())  # RNA has the class, and no tree takes it
    return graph


def _usual_trees(node: str, trees: tuple[str, ...]) -> tuple[str, ...]:
    """Of the trees that take a node, the one that it is called after; all where there is none."""
    family = "GeometryNodeTree" if node.startswith("FunctionNode") else ""
    own = [tree for tree in trees if tree == family or node.startswith(tree.removesuffix("Tree"))]
    return tuple(own) or trees


def _rarity(path: str, uses: Mapping[str, int]) -> float:
    """What is added for a property that scripts seldom use; nothing where no use of anything is known."""
    count = uses.get(path, 0)
    return next(cost for least, cost in _RARE if count >= least) if uses else 0.0


def _key(target: str, graph: _Graph) -> str:
    """The subscript of a collection: the name that Blender itself gives, or an index."""
    name = graph.names.get(target, "")
    return f"[{json.dumps(name, ensure_ascii=False)}]" if name else "[0]"


def _lineage(cls: str, graph: _Graph) -> Iterable[str]:
    return takewhile(lambda each: each != "bpy_struct", lineage(cls, graph.base))


def _steps(cls: str, graph: _Graph) -> Iterable[_Step]:
    """The properties of a class, inherited ones last."""
    for ancestor in _lineage(cls, graph):
        yield from graph.edges.get(ancestor, ())


def _told(graph: _Graph) -> Iterator[tuple[str, str, int]]:
    """(class, expression, cost) of what is told rather than found; of the classes that this Blender has."""
    yield from ((cls, *told) for cls, told in _TOLD.items() if cls in graph.base)
    yield from ((cls, expression, _TOLD_COST) for cls, expression in graph.told.items())


def _active(step: _Step, graph: _Graph) -> _Step | None:
    """``active`` of a collection, where it leads to one of its elements."""
    if step.container in _NEVER_ACTIVE:
        return None
    found = (inner for inner in graph.edges.get(step.container, ()) if inner.name == "active")
    return next((inner for inner in found if inner.target == step.target and not inner.many), None)


def _place(expressions: dict[str, str], graph: _Graph, places: Mapping[str, str]) -> None:
    """Corrects the ways to what is looked for elsewhere than where RNA's shortest way leads."""
    for cls in _OF_BONES:
        if cls in expressions and "PoseBone" in expressions:
            expressions[cls] = f"{expressions['PoseBone']}.constraints{_key(cls, graph)}"
    # A shader's nodes live in a material, where there are others like it; some in the tree of another data-block.
    for cls in (cls for cls, trees in graph.trees.items() if "ShaderNodeTree" in trees):
        holder = places.get(cls, "World" if cls in _OF_WORLDS else _MATERIAL)
        expressions[cls] = f"{expressions.get(holder, holder.lower())}.node_tree.nodes{_key(cls, graph)}"
    for cls in _ENDS_OF_GROUPS & expressions.keys():
        expressions[cls] = f"bpy.data.node_groups[0].nodes{_key(cls, graph)}"
    for cls, (node, name) in _OF_NODES.items():
        if cls in expressions and node in expressions:
            _move(expressions, expressions[cls], f"{expressions[node]}.{name}")
    # A socket, on a node that has one like it: RNA's way leads to any node. Those of no node have no way.
    for cls in graph.below(_SOCKET):
        known = [
            (owner, subscript) for owner, subscript in graph.sockets.get(cls, ()) if owner in expressions
        ]
        if cls in expressions and known:
            owner, subscript = min(known, key=lambda found: _distance(*found, graph, places))
            expressions[cls] = f"{expressions[owner]}.{subscript}"
        elif not graph.derived.get(cls) and graph.sockets:
            expressions.pop(cls, None)


def _move(expressions: dict[str, str], before: str, after: str) -> None:
    """Gives another way to what one way leads to, and to all that is reached through it."""
    for cls, expression in expressions.items():
        if expression == before or expression.startswith((f"{before}.", f"{before}[")):
            expressions[cls] = after + expression.removeprefix(before)


def _distance(node: str, subscript: str, graph: _Graph, places: Mapping[str, str]) -> tuple[bool, ...]:
    """How far a socket of a node is from being the one to show: those of nodes that are there from the start are best,
    a material's first, then those of shaders, and inputs.
    """
    is_of_shaders = "ShaderNodeTree" in graph.trees.get(node, ())
    return places.get(node) != _MATERIAL, node not in places, not is_of_shaders, "inputs" not in subscript


def reached_expressions(
    symbols: Iterable[Symbol],
    uses: Mapping[str, int] | None = None,
    names: Mapping[str, str] | None = None,
    places: Mapping[str, str] | None = None,
) -> dict[str, str]:
    """class name → an expression that gives an instance, for every class that pointers lead to, and every collection's.

    ``ClothSettings`` → ``bpy.context.object.modifiers["Cloth"].settings``: the names in brackets are those that
    Blender itself gives (``names``, by class), to be replaced by the scene's own; where it gives none, there is an
    index. What only a loop gives is what that calls it: ``object_instance``. ``uses`` tells how often Blender's own
    scripts use a property: of several ways the one is taken that they take. ``places``: class of nodes → class of the
    data-block in whose tree such a node stands from the start.
    """
    graph = _graph(symbols, uses or {}, names or {})
    expressions: dict[str, str] = {}
    containers: dict[str, tuple[float, str]] = {}
    items: dict[str, str] = {}
    queue: list[tuple[float, int, str, str]] = []
    order = 0

    def offer(cost: float, cls: str, expression: str, *, many: bool = False) -> None:
        nonlocal order
        if cls not in expressions:
            key = _key(cls, graph) if many else ""
            heapq.heappush(queue, (cost, order := order + 1, cls, expression + key))

    for root, cls, cost in _ROOTS:
        offer(cost, cls, root)
    for cls, expression, cost in _told(graph):
        # What RNA's own way leads to may be None: not each add-on has preferences.
        for each in _lineage(cls, graph):
            offer(cost, each, expression)
    while queue:
        cost, _, cls, expression = heapq.heappop(queue)
        if cls in expressions:
            continue
        expressions[cls] = expression
        for step in _steps(cls, graph):
            if step.iterated:
                items[step.target] = item_of(step.name)
                continue
            here = f"{of_evaluated(expression) if step.evaluated else expression}.{step.name}"
            reached = cost + step.cost + (1 if step.many else 0)
            if step.container:
                containers[step.container] = min((reached, here), containers.get(step.container, _NOWHERE))
            offer(reached, step.target, here, many=step.many)
            active = _active(step, graph) if step.many else None
            if active is not None:
                offer(cost + step.cost + active.cost - _ACTIVE_GAIN, step.target, f"{here}.active")
            # ``Object.data`` is any data-block to RNA; the collections of ``bpy.data`` say which.
            for child in graph.below(step.target) if step.target != "ID" else ():
                # Every tree's ``nodes`` takes every node as far as RNA knows.
                if cls in graph.trees.get(child, (cls,)):
                    by_chance = 0 if step.many and child in graph.names else _KIND_BY_CHANCE
                    offer(reached + 1 + by_chance, child, here, many=step.many)
    # Last, because no way leads through them.
    expressions = {cls: here for cls, (_, here) in containers.items()} | items | expressions
    _place(expressions, graph, places or {})
    return expressions
