"""The sockets of nodes as steps write them: ``inputs["Geometry"]``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import SIDES
from kb_build.symbols.flag_names import HIDDEN, PAIRS
from kb_build.symbols.lines import written
from kb_serve.lookups.symbols import EXTEND

if TYPE_CHECKING:
    from kb_serve.answer.steps.node_trees.items import NodeItems
    from kb_serve.reader import BaseReader


class NodeSockets:
    """The sockets in one list of steps, those that items have given nodes included."""

    def __init__(self, reader: BaseReader, items: NodeItems) -> None:
        self._reader = reader
        self._items = items

    def first(self, node: str, side: str, kinds: tuple[str, ...]) -> str:
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

    def type_switch(self, node: str, kind: str) -> str:
        """The property that makes sockets of a kind on both sides of a node; empty for none."""
        for name, entry in self._reader.members(node).items():
            symbol = self._reader.symbol(entry.path) if entry.type == "enum" else None
            items = symbol.enum_items if symbol else ()
            types = {item.identifier for item in items if item.is_taken}
            is_taken = kind.upper() in types
            if is_taken and all(self.typed(node, side, name) for side in SIDES):
                return name
        return ""

    def typed(self, node: str, side: str, switch: str) -> str:
        """The first socket of a side whose type a property says; empty for none."""
        for name, entry in self._reader.members(node).items():
            symbol = self._reader.symbol(entry.path) if name.startswith(f"{side}[") else None
            if symbol is not None and switch in symbol.type_settings:
                return written(symbol)[len(node) + 1 :]
        return ""

    def output_of(self, node: str, taken: str) -> str:
        """The output of a node with the identifier of an input; empty for none."""
        identifier = self._identifiers(node, "inputs").get(taken, "")
        outputs = {name: socket for socket, name in self._identifiers(node, "outputs").items()}
        return outputs.get(identifier, "")

    def _identifiers(self, node: str, side: str) -> dict[str, str]:
        """Socket as it is written → its identifier."""
        found: dict[str, str] = {}
        for name, entry in self._reader.members(node).items():
            symbol = self._reader.symbol(entry.path) if name.startswith(f"{side}[") else None
            if symbol is not None:
                found[written(symbol)[len(node) + 1 :]] = symbol.identifier
        return found

    def partner(self, node: str) -> str:
        """The class of the node at the other end of a zone; empty for other nodes."""
        first = node.replace("Output", "Input")
        is_zone = f"{first}.{PAIRS}" in {entry.path for entry in self._reader.members(first).values()}
        return (first if node != first else node.replace("Input", "Output")) if is_zone else ""
