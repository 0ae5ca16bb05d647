"""What nodes are linked to in a new tree: what comes in before them, and what goes out behind them.

Only sockets of one kind are joined. A group gets the sockets that it needs; a compositor's image comes from the
render; a material's and a world's new trees have their usual nodes already.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbols.api_names import SIDES, TYPES
from kb_build.symbols.lines import written
from kb_build.symbols.records import HIDDEN, PAIRS
from kb_serve.reader import EXTEND

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from kb_serve.answer.steps.new_scene import NewScene
    from kb_serve.answer.steps.node_trees.node_items import NodeItems

SHADER_TREE = f"{TYPES}ShaderNodeTree"
_WORLD_END, _LIGHT_END = f"{TYPES}ShaderNodeOutputWorld", f"{TYPES}ShaderNodeOutputLight"
OF_WORLDS = frozenset(
    {
        f"{TYPES}ShaderNodeTexSky",
        f"{TYPES}ShaderNodeTexEnvironment",
        f"{TYPES}ShaderNodeBackground",
        _WORLD_END,
    }
)
_END = "tree.get_output_node('ALL')"
_END_NODE = f"{TYPES}ShaderNodeOutputMaterial"  # what that gives
_GROUP_END = "group_output"
_DISPLACES = "displacement_method = 'DISPLACEMENT'"
_PRINCIPLED = 'tree.nodes["Principled BSDF"]'
_BACKGROUND = 'tree.nodes["Background"].inputs["Color"]'
# What goes into a node that takes shaders: what ended the tree before, of a material mostly; then a further shader.
_FIRST_SHADER = f'{_PRINCIPLED}.outputs["BSDF"]'
_FIRST_SHADER_OF = {_WORLD_END: 'tree.nodes["Background"].outputs["Background"]', _LIGHT_END: ""}
_MORE_SHADERS = ('emission = tree.nodes.new("ShaderNodeEmission")', 'emission.outputs["Emission"]')


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

    def __init__(self, scene: NewScene, items: NodeItems) -> None:
        self._scene = scene
        self._items = items
        self._reader = scene.reader
        self._ended: set[str] = set()
        self._begun: set[str] = set()

    def partner(self, node: str) -> str:
        """The class of the node at the other end of a zone; empty for other nodes."""
        first = node.replace("Output", "Input")
        is_zone = f"{first}.{PAIRS}" in {entry.path for entry in self._reader.members(first).values()}
        return (first if node != first else node.replace("Input", "Output")) if is_zone else ""

    def of(self, tree: str, node: str) -> Iterator[str]:
        """The steps that link a node into its tree."""
        variable = self._scene.variables.of(node)
        if tree == SHADER_TREE:
            yield from self._to_end(node, variable)
            return
        group = _GROUPS.get(tree)
        if group is None:
            if taken := self._socket(node, "outputs", ()):
                yield from self._ending(tree, None)
                yield f"`tree.links.new({variable}.{taken}, {_GROUP_END}.inputs[0])`"
            return
        given, taken = self._socket(node, "inputs", group.given), self._socket(node, "outputs", group.taken)
        if not (given or taken) and (switch := self._type_switch(node, group)):
            yield f"`{variable}.{switch} = '{group.kind.upper()}'`"
            given, taken = (self._typed(node, side, switch) for side in SIDES)
        by_items = self._items.may_extend(node, "inputs") or self._items.may_extend(node, "outputs")
        own_end = self._socket(node, "outputs", ()) if by_items and given and not taken else ""
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
        if not taken and group.kind == "geometry" and (own := self._socket(node, "outputs", ())):
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
            self._socket(node, side, group.taken)
            for node, side in ((first, "inputs"), (first, "outputs"), (last, "inputs"), (last, "outputs"))
        ]
        begin, end = self._scene.variables.of(first), self._scene.variables.of(last)
        inner = f"`tree.links.new({begin}.{sockets[1]}, {end}.{sockets[2]})`"
        if all(sockets):
            source = yield from self._beginning(tree, group)
            yield from self._ending(tree, group)
            yield f"`tree.links.new({source}, {begin}.{sockets[0]})`"
            yield inner
            yield f"`tree.links.new({end}.{self._given_out(last, sockets)}, {_GROUP_END}.inputs[0])`"
        elif all(sockets[1:3]) and (own := self._socket(last, "outputs", ())):
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
        has_one = any(self._socket(end, side, (group.kind,)) for end, side in open_sides)
        return group.kind if open_sides and not has_one else ""

    def name_in(self, tree: str) -> str:
        """What goes through a tree is called."""
        return _GROUPS[tree].name if tree in _GROUPS else ""

    def _given_out(self, last: str, sockets: list[str]) -> str:
        """The output of a zone for what comes in at its end: the one of the same identifier, if there is one."""
        identifiers = self._identifiers(last, "inputs").get(sockets[2], "")
        outputs = {name: socket for socket, name in self._identifiers(last, "outputs").items()}
        return outputs.get(identifiers) or sockets[3]

    def _identifiers(self, node: str, side: str) -> dict[str, str]:
        """Socket as it is written → its identifier."""
        found: dict[str, str] = {}
        for name, entry in self._reader.members(node).items():
            symbol = self._reader.symbol(entry.path) if name.startswith(f"{side}[") else None
            if symbol is not None:
                found[written(symbol)[len(node) + 1 :]] = symbol.identifier
        return found

    def _type_switch(self, node: str, group: _Group) -> str:
        """The property that makes sockets of the kind which goes through a tree; empty for none."""
        for name, entry in self._reader.members(node).items():
            symbol = self._reader.symbol(entry.path) if entry.type == "enum" else None
            items = symbol.enum_items if symbol else ()
            types = {item.identifier for item in items if item.is_taken}
            is_taken = group.kind.upper() in types
            if is_taken and all(self._typed(node, side, name) for side in SIDES):
                return name
        return ""

    def _typed(self, node: str, side: str, switch: str) -> str:
        """The first socket of a side whose type a property says; empty for none."""
        for name, entry in self._reader.members(node).items():
            symbol = self._reader.symbol(entry.path) if name.startswith(f"{side}[") else None
            if symbol is not None and switch in symbol.type_settings:
                return written(symbol)[len(node) + 1 :]
        return ""

    def _from_group(self, node: str, variable: str) -> Iterator[str]:
        """The steps that give a node what it takes apart: a group has an input of its kind."""
        if own := self._socket(node, "inputs", ()):
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
        if tree not in self._ended:
            self._ended.add(tree)
            yield f'`{_GROUP_END} = tree.nodes.new("NodeGroupOutput")`'
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

    def _to_end(self, node: str, variable: str) -> Iterator[str]:
        """The links of a shader node: from the shaders that it takes, and to the tree's end, or to the usual shader's
        input of the kind of its output.
        """
        takes = yield from self._shaders_into(node, variable)
        if shader := self._socket(node, "outputs", ("shader",)):
            called = shader.replace("outputs", "inputs", 1)
            known = self._reader.members(_END_NODE)
            taken = called if called in known else 'inputs["Surface"]'
            yield f"`tree.links.new({variable}.{shader}, {_END}.{taken})`"
            return
        members = self._reader.members(node)
        if 'outputs["Displacement"]' in members:
            yield f'`tree.links.new({variable}.outputs["Displacement"], {_END}.inputs["Displacement"])`'
            if material := self._scene.variables.there(f"{TYPES}Material"):
                yield f"`{material}.{_DISPLACES}` — a new one has 'BUMP', by which nothing is moved"
        elif takes and (color := self._socket(node, "outputs", ("rgba",))):
            yield f'`tree.links.new({variable}.{color}, {_END}.inputs["Surface"])`'
        elif color := self._socket(node, "outputs", ("rgba",)):
            to = _BACKGROUND if node in OF_WORLDS else f'{_PRINCIPLED}.inputs["Base Color"]'
            yield f"`tree.links.new({variable}.{color}, {to})`"
        elif 'outputs["Normal"]' in members:
            yield f'`tree.links.new({variable}.outputs["Normal"], {_PRINCIPLED}.inputs["Normal"])`'
        elif value := self._socket(node, "outputs", ("value",)):
            yield f'`tree.links.new({variable}.{value}, {_PRINCIPLED}.inputs["Roughness"])`'

    def _shaders_into(self, node: str, variable: str) -> Generator[str, None, bool]:
        """The steps that link shaders to a node which takes some: one to the first input, and another to each further
        one that is called alike, as those of a mix are. Returns whether it takes any.
        """
        first = self._socket(node, "inputs", ("shader",))
        before = _FIRST_SHADER_OF.get(node, _FIRST_SHADER)
        if not (first and before):
            return False
        yield f"`tree.links.new({before}, {variable}.{first})`"
        alike = [name for name in self._reader.members(node) if name.startswith(f"{first[:-2]}_")]
        if alike:
            yield f"`{_MORE_SHADERS[0]}`"
            yield from (f"`tree.links.new({_MORE_SHADERS[1]}, {variable}.{name})`" for name in alike)
        return True

    def _socket(self, node: str, side: str, kinds: tuple[str, ...]) -> str:
        """The first socket of a side that is there in a new node and of the first kind that one is of; of any, if none
        is named.
        """
        entries = [
            entry
            for name, entry in self._reader.members(node).items()
            if entry.kind == "socket" and name.startswith(f"{side}[") and EXTEND not in name
        ]
        for kind in kinds or ("",):
            for entry in entries:
                symbol = self._reader.symbol(entry.path) if not kind or entry.type == kind else None
                if symbol is not None and HIDDEN not in symbol.flags:
                    return written(symbol)[len(node) + 1 :]
        return self._items.socket(node, side, kinds)
