"""The trees that nodes are made in: where each kind comes from."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbols.api_names import TYPES
from kb_serve.answer.steps.making.parts import parts

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.answer.steps.making.places import PlaceSteps
    from kb_serve.answer.steps.names.topic_names import TopicNames
    from kb_serve.answer.steps.scene.new_scene import NewScene

SHADER_TREE = f"{TYPES}ShaderNodeTree"
TEXTURE_TREE = f"{TYPES}TextureNodeTree"
WORLD_END = f"{TYPES}ShaderNodeOutputWorld"
# What is in the tree of a world rather than of a material.
OF_WORLDS = frozenset(
    {
        f"{TYPES}ShaderNodeTexSky",
        f"{TYPES}ShaderNodeTexEnvironment",
        f"{TYPES}ShaderNodeBackground",
        WORLD_END,
    }
)
# Trees that cannot be assigned: what has one of its own.
_EMBEDDED = {SHADER_TREE: (f"{TYPES}Material", "node_tree"), TEXTURE_TREE: (f"{TYPES}Texture", "node_tree")}
_WORLD = f"{TYPES}World"
_USUAL_TREE = f"{TYPES}GeometryNodeTree"
EMBEDDED_TREES = frozenset(_EMBEDDED)


class TreeReady(NamedTuple):
    """The class of a tree, empty where a node is in none; and the steps after which it is there."""

    cls: str
    steps: list[str]


class TreeSteps:
    """The trees of one list of steps."""

    def __init__(self, names: TopicNames, scene: NewScene, places: PlaceSteps) -> None:
        self._names = names
        self._scene = scene
        self._reader = scene.reader
        self._places = places

    def taking(self, node: str) -> TreeReady:
        """The tree that takes a node."""
        name = node.removeprefix(TYPES)
        own = sorted(
            self._trees_of(node),
            key=lambda tree: (
                not name.startswith(tree.removesuffix("Tree")),
                f"{TYPES}{tree}" != _USUAL_TREE,
            ),
        )
        tree = f"{TYPES}{own[0]}" if own else ""
        holder = _WORLD if node in OF_WORLDS else ""
        return TreeReady(tree, [] if tree in self._scene.shown else [*self._new(tree, holder)])

    def is_made_for(self, node: str) -> bool:
        """Whether a tree that is there takes a node."""
        return any(f"{TYPES}{tree}" in self._scene.shown for tree in self._trees_of(node))

    def any_for(self, call: str) -> Iterator[str]:
        """The steps that make the tree which a call on ``tree`` was written for, where no tree is there."""
        if not any(cls.endswith("NodeTree") for cls in self._scene.shown):
            kind = call.partition("_tree.")[0].capitalize()
            tree = f"{TYPES}{kind}NodeTree"
            yield from self.group(tree if self._reader.entry(tree) else _USUAL_TREE)

    def group(self, tree: str, holder: str = "") -> Iterator[str]:
        """A tree that is a data-block of its own. ``holder``: what it becomes the tree of, where that is known."""
        creation = self._reader.makers.creations([tree]).get(tree)
        if creation is None:
            return
        yield self._scene.making(tree, creation.call)
        variable = self._scene.variables.of(tree)
        if holder:
            yield f"`{holder} = {variable}`"
        else:
            yield from self._places.of(tree)
        if tree in self._names.classes:
            yield from parts(tree, variable, self._names, self._reader)

    def _new(self, tree: str, holder: str) -> Iterator[str]:
        usual, name = _EMBEDDED.get(tree, ("", ""))
        holder = holder or usual
        made = self._reader.makers.creations([holder]).get(holder)
        if made is None:
            yield from self.group(tree)
            return
        self._scene.shown.add(tree)
        yield self._scene.making(holder, made.call)
        yield from self._places.of(holder)
        variable = self._scene.variables.of(holder)
        self._scene.variables.add(holder, variable)
        if pointer := self._reader.symbol(f"{holder}.{name}"):
            yield from self._scene.pointers.steps(pointer, variable)
        yield f"`tree = {variable}.{name}`"

    def _trees_of(self, node: str) -> tuple[str, ...]:
        symbol = self._reader.symbol(node)
        return tuple(symbol.trees) if symbol else ()
