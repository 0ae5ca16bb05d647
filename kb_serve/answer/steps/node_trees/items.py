"""The items of nodes, each of which gives the node a socket: those of a bundle, or what a Bake node keeps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.answer.steps.scene.new_scene import NewScene
    from kb_serve.lookups.records import Creation, SymbolEntry


class NodeItems:
    """The items in one list of steps."""

    def __init__(self, scene: NewScene) -> None:
        self._scene = scene
        self._reader = scene.reader
        self._names: dict[tuple[str, str], str] = {}  # (node, kind of socket) → the name that its items have

    def added(self, node: str, tree: str, kind: str = "", name: str = "", partner: str = "") -> Iterator[str]:
        """The steps that add an item to each of a node's collections: of a kind and of a name, if one is given that the
        collection takes in a tree. ``partner`` is the other end of a zone, which gets sockets by them, too.
        """
        variable = self._scene.variables.of(node)
        for entry in self._reader.members(node).values():
            creation = self._adding(entry)
            if creation is None:
                continue
            call = creation.call.partition(f".{entry.name}.")[2]
            if kind and self._takes(creation.maker, kind.upper(), tree):
                call = f"new('{kind.upper()}', \"{name}\")"
                self._names |= {(end, kind): name for end in (node, partner)}
            item = f"{TYPES}{entry.target}"
            self._scene.variables.add(item, self._scene.variables.of(item))
            yield self._scene.making(item, f"{variable}.{entry.name}.{call}")

    def socket(self, node: str, side: str, kinds: tuple[str, ...]) -> str:
        """The socket that an item has given a node on a side, of the first kind that one is of; empty for none."""
        if not self.may_extend(node, side):
            return ""
        names = (self._names.get((node, kind)) for kind in kinds)
        return next((f'{side}["{name}"]' for name in names if name), "")

    def may_extend(self, node: str, side: str) -> bool:
        """Whether a node gets sockets on a side by its items."""
        return self._reader.takes_more_sockets(node, side)

    def _adding(self, entry: SymbolEntry) -> Creation | None:
        """What adds an item to a collection; None for other members, and for a collection that nothing adds to."""
        item = f"{TYPES}{entry.target}"
        creation = self._reader.makers.creations([item]).get(item) if entry.type == "collection" else None
        own = f"{TYPES}{entry.collection}"
        return creation if creation and creation.maker.rpartition(".")[0] == own else None

    def _takes(self, maker: str, item_type: str, tree: str) -> bool:
        """Whether a call takes a type of sockets, where the node is in such a tree."""
        symbol = self._reader.symbol(maker)
        if symbol is None or not any(
            item.identifier == item_type for parameter in symbol.parameters for item in parameter.enum_items
        ):
            return False
        label = tree.removeprefix(TYPES).removesuffix("NodeTree").lower()
        refusals = (refusal for refusal in symbol.refusals if item_type in refusal.values)
        return all(any(f" {label} " in taking for taking in refusal.taken_by) for refusal in refusals)
