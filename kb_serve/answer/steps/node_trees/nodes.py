"""The nodes of trees: how they are made, joined and completed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flag_names import PAIRS
from kb_serve.answer.facts.members_in_brief import call_of, inputs_of, is_machinery
from kb_serve.answer.steps.node_trees.items import NodeItems
from kb_serve.answer.steps.node_trees.links import NodeLinks
from kb_serve.answer.steps.node_trees.sockets import NodeSockets
from kb_serve.answer.steps.scene.pointer_fills import stays_empty

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kb_serve.answer.steps.making.creation_calls import CreationCalls
    from kb_serve.answer.steps.making.trees import TreeSteps
    from kb_serve.answer.steps.scene.new_scene import NewScene
    from kb_serve.lookups.records import Creation, SymbolEntry

_FUNCTIONS = 3  # of one node
# Those whose new trees have a node that ends them, and the nodes that these end take of those of shaders.
_WITH_OUTPUT = {
    f"{TYPES}Material": frozenset[str](),
    f"{TYPES}World": frozenset({f"{TYPES}ShaderNodeBackground"}),
}


class NodeSteps:
    """The nodes of one list of steps."""

    def __init__(self, scene: NewScene, calls: CreationCalls, trees: TreeSteps) -> None:
        self._scene = scene
        self._reader = scene.reader
        self._calls = calls
        self._trees = trees
        self._items = NodeItems(scene)
        self._sockets = NodeSockets(scene.reader, self._items)
        self._links = NodeLinks(scene, self._items, self._sockets)

    def made(self, creations: Mapping[str, Creation]) -> Iterator[str]:
        """Nodes, in the tree that takes the first of them: one that stands alone, unless most are ends of zones."""
        ends = [node for node in creations if self._sockets.partner(node)]
        if len(ends) < len(creations) / 2:
            creations = {node: creations[node] for node in sorted(creations, key=ends.__contains__)}
        tree = self._trees.taking(next(iter(creations)))
        yield from tree.steps
        yield from self._joined(creations, tree.cls)
        yield from self._functions(creations)

    @staticmethod
    def decide(holder: str) -> bool:
        """Whether what is rendered of a thing is what the nodes in its tree say, rather than its own settings."""
        return holder in _WITH_OUTPUT

    def in_own_tree(self, cls: str) -> Iterator[str]:
        """The nodes of what holds a tree, as a material does."""
        if self._reader.is_object_data(cls):
            return
        for entry in self._reader.members(cls).values():
            if entry.type == "pointer" and entry.target.endswith("NodeTree"):
                yield from self._in_tree(entry, cls)

    def _in_tree(self, pointer: SymbolEntry, holder: str) -> Iterator[str]:
        """The nodes of the tree that a pointer of a holder leads to."""
        kinds = self._reader.descendants(f"{TYPES}{pointer.target.removesuffix('Tree')}")
        nodes = [node.path for node in self._reader.usage.heaviest(kinds)]
        known = self._reader.makers.creations(nodes)
        only = _WITH_OUTPUT.get(holder)
        creations = {node: known[node] for node in nodes if node in known and (not only or node in only)}
        tree, variable = f"{TYPES}{pointer.target}", self._scene.variables.of(holder)
        is_given = not pointer.is_read_only  # there is none yet
        if not creations or (is_given and not self._reader.makers.creations([tree])):
            return
        self._scene.shown.add(tree)
        if is_given:
            yield from self._trees.group(tree, f"{variable}.{pointer.name}")
        else:
            symbol = self._reader.symbol(pointer.path)
            if symbol is None or stays_empty(symbol):
                return
            yield from self._scene.pointers.steps(symbol, variable)
            yield f"`tree = {variable}.{pointer.name}`"
        main, *others = creations
        if place := self._place(main, pointer) if holder in _WITH_OUTPUT else "":
            yield from self._there(main, place)
            if others:
                yield from self._calls.making({node: creations[node] for node in others})
        elif is_given or holder in _WITH_OUTPUT:
            yield from self._joined(creations, tree)
        else:
            yield from self._calls.making(creations)

    def _place(self, node: str, pointer: SymbolEntry) -> str:
        """Where a new tree that a pointer leads to has a node: ``nodes["Background"]``; empty where it has none."""
        symbol = self._reader.symbol(node)
        way, _, place = symbol.reached.partition(f".{pointer.name}.nodes[") if symbol else ("", "", "")
        return f"nodes[{place}" if way and place else ""

    def _there(self, node: str, place: str) -> Iterator[str]:
        """A node that new trees have, and its main inputs."""
        variable = self._scene.variables.of(node)
        self._scene.variables.add(node, variable)
        self._scene.shown.add(node)
        yield f"`{variable} = tree.{place}` → `{node.removeprefix(TYPES)}`, which a new one has"
        if inputs := inputs_of(node, self._reader):
            yield f"set on `{variable}`: {inputs}"

    def _joined(self, creations: Mapping[str, Creation], tree: str) -> Iterator[str]:
        """How nodes are made, and the first of them joined to what is before and behind it in the tree."""
        main = next(iter(creations))
        yield from self._calls.making(creations)
        if partner := self._sockets.partner(main):
            first, last = sorted((main, partner))  # Input before Output
            yield from self._zone(first, last, tree)
        else:
            yield from self._with_items(main, tree)
            yield from self._links.of(tree, main)

    def _zone(self, first: str, last: str, tree: str) -> Iterator[str]:
        """How the two ends of a zone are made where they are not there, paired and linked."""
        known = self._reader.makers.creations([first, last])
        for node in (first, last):
            if node not in self._scene.shown and node in known:
                yield from self._calls.making({node: known[node]})
        begin, end = self._scene.variables.of(first), self._scene.variables.of(last)
        yield f"`{begin}.{PAIRS}({end})`"
        yield from self._with_items(last, tree, first)
        yield from self._links.through_zone(tree, first, last)

    def _with_items(self, node: str, tree: str, partner: str = "") -> Iterator[str]:
        """How a node gets sockets: what goes through the tree goes through the node, too, if that may have such."""
        kind = self._links.lacks(node, tree, partner)
        yield from self._items.added(node, tree, kind, self._links.name_in(tree), partner)

    def _functions(self, creations: Mapping[str, Creation]) -> Iterator[str]:
        """The functions that nodes themselves have, as those at the ends of zones do."""
        told: set[str] = set()
        for node, creation in creations.items():
            entries = self._reader.members(node).values()
            functions = [entry for entry in entries if entry.kind == "function" and not is_machinery(entry)]
            # Of several zones one is enough.
            is_told = not functions or functions[0].name in told or self._sockets.partner(node)
            if is_told or not self._trees.is_made_for(node):
                continue
            if node not in self._scene.shown:
                yield from self._calls.making({node: creation})
            partner = node.replace("Input", "Output")
            for entry in functions[:_FUNCTIONS]:
                told.add(entry.name)
                call = call_of(entry)
                if partner in self._scene.shown:
                    call = call.replace("output_node", self._scene.variables.of(partner))
                yield f"`{self._scene.variables.of(node)}.{call}`"
