"""Access paths: for each class the shortest expression over RNA pointers that leads to an instance."""

from __future__ import annotations

import heapq
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.records import Symbol

TYPES = "bpy.types."

# Where scripts start. Other context members depend on the editor under the mouse.
_ROOTS = (("bpy.context", "Context", 0), ("bpy.data", "BlendData", 2))
_EVERYWHERE = frozenset({"object", "scene", "view_layer", "collection"})
# What leads through the interface or the undo of a library is rarely the way a script goes.
_DETOURS = frozenset(
    {
        "window_manager", "window", "screen", "workspace", "area", "region", "preferences", "space_data", "library",
        "original", "override_library", "asset_data", "asset", "drivers", "rigidbody_world",
        "blend_data", "node_groups", "nla_tracks", "material_override", "preview", "id_root", "parent", "tool_settings",
    }
)  # fmt: skip
_DETOUR_COST = 6
_TOLD_COST = 5  # of what Blender tells how to reach: the preferences of an add-on


@dataclass(slots=True)
class _Graph:
    """class → (property name, target class, is a collection), own properties only."""

    edges: dict[str, list[tuple[str, str, bool]]] = field(default_factory=lambda: defaultdict(list))
    base: dict[str, str] = field(default_factory=dict)
    derived: dict[str, list[str]] = field(default_factory=lambda: defaultdict(list))
    label: dict[str, str] = field(default_factory=dict)
    trees: dict[str, tuple[str, ...]] = field(default_factory=dict)
    named: set[str] = field(default_factory=set)
    told: dict[str, str] = field(default_factory=dict)


def _graph(symbols: Iterable[Symbol]) -> _Graph:
    graph = _Graph()
    for symbol in symbols:
        if symbol.kind == "class" and symbol.owner == "bpy.types":
            name, base = symbol.path.removeprefix(TYPES), symbol.base.removeprefix(TYPES)
            graph.base[name] = base
            graph.label[name] = symbol.label
            if symbol.reached:
                graph.told[name] = symbol.reached
            if symbol.trees:
                graph.trees[name] = symbol.trees
            if base != "bpy_struct":
                graph.derived[base].append(name)
        elif symbol.kind == "property" and symbol.name == "name":
            graph.named.add(symbol.owner.removeprefix(TYPES))
        elif symbol.kind in {"property", "context"} and symbol.target:
            if symbol.kind == "context" and symbol.name not in _EVERYWHERE:
                continue
            owner = "Context" if symbol.kind == "context" else symbol.owner.removeprefix(TYPES)
            graph.edges[owner].append((symbol.name, symbol.target, symbol.type == "collection"))
    return graph


def _key(target: str, graph: _Graph) -> str:
    """The subscript of a collection: the name Blender gives by default, or an index."""
    if graph.named.isdisjoint(_lineage(target, graph)):
        return "[0]"
    label = graph.label.get(target, "") or target
    return f'["{label.removesuffix(" Modifier").removesuffix(" Constraint")}"]'


def _lineage(cls: str, graph: _Graph) -> Iterable[str]:
    while cls and cls != "bpy_struct":
        yield cls
        cls = graph.base.get(cls, "")


def _steps(cls: str, graph: _Graph) -> Iterable[tuple[str, str, bool]]:
    """The properties of a class, inherited ones last."""
    for ancestor in _lineage(cls, graph):
        yield from graph.edges.get(ancestor, ())


def _descendants(cls: str, graph: _Graph) -> Iterable[str]:
    for child in graph.derived.get(cls, ()):
        yield child
        yield from _descendants(child, graph)


def reached_expressions(symbols: Iterable[Symbol]) -> dict[str, str]:
    """class name → an expression that gives an instance, for every class that pointers lead to.

    ``ClothSettings`` → ``bpy.context.object.modifiers["Cloth"].settings``: the names in brackets are the
    default ones, to be replaced by the scene's own.
    """
    graph = _graph(symbols)
    expressions: dict[str, str] = {}
    queue: list[tuple[int, int, str, str]] = []
    order = 0
    for root, cls, cost in _ROOTS:
        heapq.heappush(queue, (cost, order := order + 1, cls, root))
    for cls, expression in graph.told.items():
        heapq.heappush(queue, (_TOLD_COST, order := order + 1, cls, expression))
    while queue:
        cost, _, cls, expression = heapq.heappop(queue)
        if cls in expressions:
            continue
        expressions[cls] = expression
        for name, target, many in _steps(cls, graph):
            step = cost + 1 + (1 if many else 0) + (_DETOUR_COST if name in _DETOURS else 0)
            here = f"{expression}.{name}"
            if target not in expressions:
                order += 1
                heapq.heappush(queue, (step, order, target, here + (_key(target, graph) if many else "")))
            # ``Object.data`` is any data-block to RNA; the collections of ``bpy.data`` say which.
            for child in _descendants(target, graph) if target != "ID" else ():
                # Every tree's ``nodes`` takes every node as far as RNA knows.
                if child not in expressions and cls in graph.trees.get(child, (cls,)):
                    order += 1
                    heapq.heappush(
                        queue, (step + 1, order, child, here + (_key(child, graph) if many else ""))
                    )
    # A shader's nodes live in a material, where there are others like it.
    for cls in (cls for cls, trees in graph.trees.items() if "ShaderNodeTree" in trees):
        expressions[cls] = f"{expressions.get('Material', 'material')}.node_tree.nodes{_key(cls, graph)}"
    return expressions
