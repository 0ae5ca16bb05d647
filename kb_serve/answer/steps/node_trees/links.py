"""What nodes are linked to in a new tree: what comes in before them, and what goes out behind them.

Only sockets of one kind are joined. A group gets the sockets that it needs; a compositor's image comes from the render.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbols.api_names import SIDES, TYPES
from kb_serve.answer.steps.making.trees import SHADER_TREE, TEXTURE_TREE
from kb_serve.answer.steps.node_trees.shader_links import ShaderLinks

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.answer.steps.node_trees.items import NodeItems
    from kb_serve.answer.steps.node_trees.sockets import NodeSockets
    from kb_serve.answer.steps.scene.new_scene import NewScene

_GROUP_END = "group_output"
_TEXTURE_END = 'tree.nodes["Output"].inputs["Color"]'  # which a new texture's tree has


class _Group(NamedTuple):
    """What goes through a group: a socket's name and type, and the kinds of sockets that take it and give it.

    ``source``: the statement and expression for what comes in, where no input of the group does.
    """

    name: str
    socket: str
    given: tuple[str, ...]
    taken: tuple[str, ...]
    source: tuple[str, str] = ("", "")

    @property
    def kind(self) -> str:
        """The kind of sockets that it goes through."""
        return self.given[0]


_GROUPS = {
    f"{TYPES}GeometryNodeTree": _Group("Geometry", "NodeSocketGeometry", ("geometry",), ("geometry",)),
    f"{TYPES}CompositorNodeTree": _Group(
        "Image", "NodeSocketColor", ("rgba",), ("rgba", "value", "vector"),
        ('render_layers = tree.nodes.new("CompositorNodeRLayers")', 'render_layers.outputs["Image"]'),
    ),
}  # fmt: skip


# Kind of sockets → the type of the attribute that keeps what they give: the first is a new node's own.
_STORED = {
    "value": "FLOAT",
    "int": "INT",
    "boolean": "BOOLEAN",
    "vector": "FLOAT_VECTOR",
    "rgba": "FLOAT_COLOR",
    "rotation": "QUATERNION",
    "matrix": "FLOAT4X4",
}
_SOCKETS = {"value": "Float", "rgba": "Color", "boolean": "Bool"}  # kinds that their classes call otherwise
_GRID = "Grid"  # in the names of what takes or gives one
_STORE = f"{TYPES}GeometryNodeStoreNamedAttribute"
_INSTANCE = 'inputs["Instance"]'  # without it, points are all that goes in, and nothing comes out


class NodeLinks:
    """The links of one list of steps."""

    def __init__(self, scene: NewScene, items: NodeItems, sockets: NodeSockets) -> None:
        self._scene = scene
        self._items = items
        self._sockets = sockets
        self._shaders = ShaderLinks(scene, sockets)
        self._reader = scene.reader
        self._ended: set[str] = set()
        self._begun: set[str] = set()

    def of(self, tree: str, node: str) -> Iterator[str]:
        """The steps that link a node into its tree."""
        if tree == SHADER_TREE:
            yield from self._shaders.of(node)
            return
        variable = self._scene.variables.of(node)
        group = _GROUPS.get(tree)
        if group is None:
            taken = self._sockets.first(node, "outputs", ())
            end = _TEXTURE_END if tree == TEXTURE_TREE else f"{_GROUP_END}.inputs[0]"
            if taken and tree != TEXTURE_TREE:
                yield from self._ending(tree, None)
            if taken:
                yield f"`tree.links.new({variable}.{taken}, {end})`"
            return
        given = self._sockets.first(node, "inputs", group.given)
        taken = self._sockets.first(node, "outputs", group.taken)
        if not (given or taken) and (switch := self._sockets.type_switch(node, group.kind)):
            yield f"`{variable}.{switch} = '{group.kind.upper()}'`"
            given, taken = (self._sockets.typed(node, side, switch) for side in SIDES)
        by_items = self._items.may_extend(node, "inputs") or self._items.may_extend(node, "outputs")
        own_end = self._sockets.first(node, "outputs", ()) if by_items and given and not taken else ""
        source = ""
        if (given or not taken) and node.removeprefix(TYPES) not in group.source[0]:
            source = yield from self._beginning(tree, group)
        into = [f"`tree.links.new({source}, {variable}.{given})`"] if given and source else []
        if into and _INSTANCE in self._reader.members(node):
            into.append(f"`tree.links.new({source}, {variable}.{_INSTANCE})`")
        if by_items and taken and not given:
            into += self._from_group(node, variable)
        if own_end:
            yield from into
            yield from self._to_group(tree, node, variable, own_end)
            return
        yield from self._ending(tree, group)
        if not taken and group.kind == "geometry" and (own := self._sockets.first(node, "outputs", ())):
            yield from into
            yield from self._beside(node, f"{variable}.{own}", own, source)
            return
        yield from into
        if taken or source:
            told = f"{variable}.{taken}" if taken else source
            yield f"`tree.links.new({told}, {_GROUP_END}.inputs[0])`"

    def through_zone(self, tree: str, first: str, last: str) -> Iterator[str]:
        """The steps that link the two paired ends of a zone into their tree; of one that nothing comes into, as a
        closure, what is in it and what it gives.
        """
        group = _GROUPS.get(tree)
        if group is None:
            return
        sockets = [
            self._sockets.first(node, side, group.taken)
            for node, side in ((first, "inputs"), (first, "outputs"), (last, "inputs"), (last, "outputs"))
        ]
        begin, end = self._scene.variables.of(first), self._scene.variables.of(last)
        inner = f"`tree.links.new({begin}.{sockets[1]}, {end}.{sockets[2]})`"
        if all(sockets):
            source = yield from self._beginning(tree, group)
            yield from self._ending(tree, group)
            yield f"`tree.links.new({source}, {begin}.{sockets[0]})`"
            yield inner
            given = self._sockets.output_of(last, sockets[2]) or sockets[3]
            yield f"`tree.links.new({end}.{given}, {_GROUP_END}.inputs[0])`"
        elif all(sockets[1:3]) and (own := self._sockets.first(last, "outputs", ())):
            yield inner
            yield from self._to_group(tree, last, end, own)

    def lacks(self, node: str, tree: str, partner: str = "") -> str:
        """The kind of sockets that go through a tree, if a node, or a zone between it and its partner, has none where
        it may get some; empty otherwise.
        """
        group = _GROUPS.get(tree)
        if group is None:
            return ""
        ends = (partner, node) if partner else (node, node)
        sides = [(ends[0], "outputs"), (ends[1], "inputs")]
        open_sides = [(end, side) for end, side in sides if self._items.may_extend(end, side)]
        has_one = any(self._sockets.first(end, side, (group.kind,)) for end, side in open_sides)
        return group.kind if open_sides and not has_one else ""

    def name_in(self, tree: str) -> str:
        """What goes through a tree is called."""
        return _GROUPS[tree].name if tree in _GROUPS else ""

    def _from_group(self, node: str, variable: str) -> Iterator[str]:
        """The steps that give a node what it takes apart: a group has an input of its kind."""
        if own := self._sockets.first(node, "inputs", ()):
            yield from self._interface(node, own, "INPUT")
            yield '`group_input = tree.nodes.new("NodeGroupInput")`'
            yield f"`tree.links.new(group_input.outputs[0], {variable}.{own})`"

    def _beside(self, node: str, value: str, own: str, source: str) -> Iterator[str]:
        """The steps that give out what a node computes beside the geometry: in an attribute of it, where it may be in
        one, else in an output of its own.
        """
        members = self._reader.members(node)
        kind = members[own].type if own in members else ""
        # No attribute keeps a grid, whatever kind its values are of.
        if kind not in _STORED or any(_GRID in name for name in (node, *members)):
            yield f"`tree.links.new({source}, {_GROUP_END}.inputs[0])`"
            if steps := [*self._interface(node, own, "OUTPUT")]:
                yield from steps
                yield f"`tree.links.new({value}, {_GROUP_END}.inputs[1])`"
            return
        yield f'`store = tree.nodes.new("{_STORE.removeprefix(TYPES)}")`'
        if _STORED[kind] != next(iter(_STORED.values())):
            yield f"`store.data_type = '{_STORED[kind]}'`"
        yield '`store.inputs["Name"].default_value = "value"`'
        yield f'`tree.links.new({source}, store.inputs["Geometry"])`'
        yield f'`tree.links.new({value}, store.inputs["Value"])`'
        yield f'`tree.links.new(store.outputs["Geometry"], {_GROUP_END}.inputs[0])`'

    def _to_group(self, tree: str, node: str, variable: str, own: str) -> Iterator[str]:
        """The steps that give out what a node puts together: a group has an output of its kind, behind that of the
        geometry, which comes first in a group that a modifier uses.
        """
        group = _GROUPS.get(tree)
        if group is not None and group.kind == "geometry":
            source = yield from self._beginning(tree, group)
            yield from self._ending(tree, group)
            yield from self._beside(node, f"{variable}.{own}", own, source)
            return
        yield from self._interface(node, own, "OUTPUT")
        yield from self._ending(tree, None)
        yield f"`tree.links.new({variable}.{own}, {_GROUP_END}.inputs[0])`"

    def _interface(self, node: str, socket: str, side: str) -> Iterator[str]:
        """The step that makes a group's socket of the kind that a node's is of."""
        entry = self._reader.members(node).get(socket)
        cls = f"NodeSocket{_SOCKETS.get(entry.type, entry.type.title())}" if entry else ""
        if entry and self._reader.entry(f"{TYPES}{cls}"):
            name = entry.label or entry.type.title()
            yield f"`tree.interface.new_socket(\"{name}\", in_out='{side}', socket_type='{cls}')`"

    def _beginning(self, tree: str, group: _Group) -> Iterator[str]:
        """What comes into a tree; returns the expression for the socket that gives it."""
        statement, expression = group.source
        is_new = tree not in self._begun
        self._begun.add(tree)
        if statement:
            if is_new:
                yield f"`{statement}`"
            return expression
        if is_new:
            yield f"`tree.interface.new_socket(\"{group.name}\", in_out='INPUT', socket_type='{group.socket}')`"
            yield '`group_input = tree.nodes.new("NodeGroupInput")`'
        return "group_input.outputs[0]"

    def _ending(self, tree: str, group: _Group | None) -> Iterator[str]:
        """What ends a group that has no end yet."""
        if tree in self._ended:
            return
        self._ended.add(tree)
        if group:
            yield f"`tree.interface.new_socket(\"{group.name}\", in_out='OUTPUT', socket_type='{group.socket}')`"
        yield f'`{_GROUP_END} = tree.nodes.new("NodeGroupOutput")`'
