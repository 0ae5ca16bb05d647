"""What nodes are linked to in a new tree: what comes in before them, and what goes out behind them.

Only sockets of one kind are joined. A group gets the sockets that it needs; a compositor's image comes from the
render; a material's and a world's new trees have their usual nodes already.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.records import PAIRS
from kb_build.symbol_lines import written
from kb_serve.reader import TYPES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.answer.steps.new_scene import NewScene

SHADER_TREE = f"{TYPES}ShaderNodeTree"
OF_WORLDS = frozenset(
    {f"{TYPES}ShaderNodeTexSky", f"{TYPES}ShaderNodeTexEnvironment", f"{TYPES}ShaderNodeBackground"}
)
_END = "tree.get_output_node('ALL')"
_END_NODE = f"{TYPES}ShaderNodeOutputMaterial"  # what that gives
_GROUP_END = "group_output"
_PRINCIPLED = 'tree.nodes["Principled BSDF"]'
_BACKGROUND = 'tree.nodes["Background"].inputs["Color"]'


class _Group(NamedTuple):
    """What goes through a group: a socket's name and type, and the kinds of sockets that take it and give it.

    ``source``: the statement and expression for what comes in, where no input of the group does.
    """

    name: str
    socket: str
    given: tuple[str, ...]
    taken: tuple[str, ...]
    source: tuple[str, str] = ("", "")


_GROUPS = {
    f"{TYPES}GeometryNodeTree": _Group("Geometry", "NodeSocketGeometry", ("geometry",), ("geometry",)),
    f"{TYPES}CompositorNodeTree": _Group(
        "Image", "NodeSocketColor", ("rgba",), ("rgba", "value", "vector"),
        ('render_layers = tree.nodes.new("CompositorNodeRLayers")', 'render_layers.outputs["Image"]'),
    ),
}  # fmt: skip


class NodeLinks:
    """The links of one list of steps."""

    def __init__(self, scene: NewScene) -> None:
        self._scene = scene
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
        taken = self._socket(node, "outputs", group.taken if group else ())
        if group is None:
            if taken:
                yield from self._ending(tree, None)
                yield f"`tree.links.new({variable}.{taken}, {_GROUP_END}.inputs[0])`"
            return
        given = self._socket(node, "inputs", group.given)
        source = ""
        if (given or not taken) and node.removeprefix(TYPES) not in group.source[0]:
            source = yield from self._beginning(tree, group)
        yield from self._ending(tree, group)
        if given and taken and source:
            yield f"`tree.links.new({source}, {variable}.{given})`"
        if taken or source:
            told = f"{variable}.{taken}" if taken else source
            yield f"`tree.links.new({told}, {_GROUP_END}.inputs[0])`"

    def through_zone(self, tree: str, first: str, last: str) -> Iterator[str]:
        """The steps that link the two paired ends of a zone into their tree."""
        group = _GROUPS.get(tree)
        sockets = [
            self._socket(node, side, group.taken if group else ())
            for node, side in ((first, "inputs"), (first, "outputs"), (last, "inputs"), (last, "outputs"))
        ]
        if group is None or not all(sockets):
            return
        source = yield from self._beginning(tree, group)
        yield from self._ending(tree, group)
        begin, end = self._scene.variables.of(first), self._scene.variables.of(last)
        for left, right in (
            (source, f"{begin}.{sockets[0]}"),
            (f"{begin}.{sockets[1]}", f"{end}.{sockets[2]}"),
            (f"{end}.{sockets[3]}", f"{_GROUP_END}.inputs[0]"),
        ):
            yield f"`tree.links.new({left}, {right})`"

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
        """The link from a shader node: to the tree's end, or to the usual shader's input of the kind of its output."""
        if shader := self._socket(node, "outputs", ("shader",)):
            called = shader.replace("outputs", "inputs", 1)
            known = self._reader.members(_END_NODE)
            taken = called if called in known else 'inputs["Surface"]'
            yield f"`tree.links.new({variable}.{shader}, {_END}.{taken})`"
            return
        members = self._reader.members(node)
        if 'outputs["Displacement"]' in members:
            yield f'`tree.links.new({variable}.outputs["Displacement"], {_END}.inputs["Displacement"])`'
        elif color := self._socket(node, "outputs", ("rgba",)):
            to = _BACKGROUND if node in OF_WORLDS else f'{_PRINCIPLED}.inputs["Base Color"]'
            yield f"`tree.links.new({variable}.{color}, {to})`"
        elif 'outputs["Normal"]' in members:
            yield f'`tree.links.new({variable}.outputs["Normal"], {_PRINCIPLED}.inputs["Normal"])`'
        elif value := self._socket(node, "outputs", ("value",)):
            yield f'`tree.links.new({variable}.{value}, {_PRINCIPLED}.inputs["Roughness"])`'

    def _socket(self, node: str, side: str, kinds: tuple[str, ...]) -> str:
        """The first socket of a side that is there in a new node and of the first kind that one is of; of any, if none
        is named.
        """
        entries = [
            entry
            for name, entry in self._reader.members(node).items()
            if entry.kind == "socket" and name.startswith(f"{side}[") and "__extend__" not in name
        ]
        for kind in kinds or ("",):
            for entry in entries:
                symbol = self._reader.symbol(entry.path) if not kind or entry.type == kind else None
                if symbol is not None and "hidden-by-default" not in symbol.flags:
                    return written(symbol)[len(node) + 1 :]
        return ""
