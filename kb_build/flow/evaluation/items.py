"""Reads items of every type: what an index or a key gives, and what a loop does."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import (
    ELEMENT,
    LAYER_ITEM,
    NODES_THAT_KEEP_NAMES,
    NODES_WITH_SOCKETS_OF_THEIR_OWN,
)
from kb_build.flow.state.core import Core
from kb_build.flow.values.types import (
    FLOAT,
    STR,
    UNKNOWN,
    Collection,
    Instance,
    Mapping,
    NoneValue,
    Plain,
    Sequence,
    Tuple,
    Type,
    Union,
    is_empty,
    literal,
    literal_text,
    union,
    without_none,
)
from kb_build.symbols.api_names import SIDES
from kb_build.symbols.api_names import TYPES as T

if TYPE_CHECKING:
    import ast

    from kb_build.flow.values.types import Resolution

# The last socket of nodes whose items scripts add: it makes room for each.
_MOVING = "NodeSocketVirtual"
_VECTORS = frozenset({"mathutils.Vector", "mathutils.Color", "mathutils.Euler", "mathutils.Quaternion"})


class Items(Core):
    """Reads items."""

    def item(self, kind: Type, key: Type, node: ast.AST) -> Type:
        """What an index or a key gives; ``node`` is where a socket is recorded."""
        if not isinstance(kind, Union):
            return self._item(kind, key, node)
        found: list[Type] = []
        rows: list[Resolution | None] = []
        for member in kind.members:
            if not isinstance(member, NoneValue):
                self.here.resolutions.pop(node, None)
                found.append(self._item(member, key, node))
                rows.append(self.here.resolutions.pop(node, None))
        known = [row for row in rows if row is not None]
        if known:
            self.here.resolutions[node] = replace(
                known[0],
                symbols=tuple(dict.fromkeys(path for row in known for path in row.symbols)),
                # It is missing if no member can have it.
                missing=tuple(path for row in known for path in row.missing)
                if len(known) == len(rows)
                else (),
                sure=all(row.sure for row in known),
            )
        return union(found)

    def _item(self, kind: Type, key: Type, node: ast.AST) -> Type:  # noqa: PLR0911 - one return a type
        if isinstance(kind, Collection):
            return self.collection_item(kind, key, node)
        if isinstance(kind, Sequence):
            return kind.element
        if isinstance(kind, Tuple):
            at = literal(key)
            if isinstance(at, int) and -len(kind.items) <= at < len(kind.items):
                return kind.items[at]
            return union(kind.items) if kind.items else UNKNOWN
        if isinstance(kind, Mapping):
            text = literal_text(key)
            return next((value for name, value in kind.items if name == text), kind.value)
        if isinstance(kind, Instance):
            return self._item_of_instance(kind, key)
        if isinstance(kind, Plain) and kind.kind == "str":
            return STR
        return UNKNOWN

    def _item_of_instance(self, kind: Instance, key: Type) -> Type:
        if kind.cls in _VECTORS:
            return FLOAT
        if kind.cls == "mathutils.Matrix":
            return Instance("mathutils.Vector")
        key = without_none(key)
        if isinstance(key, Instance) and key.cls == LAYER_ITEM and (held := key.trait(ELEMENT)):
            return held
        return self.api.element(kind)

    def collection_item(self, kind: Collection, key: Type, node: ast.AST) -> Type:
        """An item of a collection: its key may be a socket's, or the name that an item has by default."""
        text = literal_text(key)
        side = kind.path.rpartition(".")[2]
        if side in SIDES and isinstance(kind.owner, Instance):
            found = self._socket(kind.owner, side, key, node)
            if found is not None:
                return found
        element = kind.element
        if text and isinstance(element, Instance):
            classes = self._classes_by_name(element.cls, text) or [element.cls]
            return union(self.as_found(Instance(cls)) for cls in classes)
        return element

    def _classes_by_name(self, base: str, name: str) -> list[str]:
        """The classes of what may have a name among things of the class ``base``; none where that is not known."""
        classes = self.api.literals.classes_by_label(base, name)
        for thing in self.here.file.given_names.get(name, ()):
            kind = self.here.types.get(thing) if thing else None
            if not isinstance(kind, Instance):
                return []
            if self.api.descends(kind.cls, base):
                classes = [*classes, kind.cls]
        return list(dict.fromkeys(classes))

    def as_found(self, kind: Type) -> Type:
        """What is looked up anew: another class, as soon as something may have set what it is. Names keep theirs."""
        if isinstance(kind, Instance) and any(file.sets_types for file in self.sources):
            base = self.api.literals.settable_kind(kind.cls)
            return replace(kind, cls=base) if base else kind
        return kind

    def _socket(self, owner: Instance, side: str, key: Type, node: ast.AST) -> Type | None:
        """The type of a node's socket, which is recorded; None where the node's class is not known."""
        value = literal(key)
        if value is None or isinstance(value, (bool, float)):
            return None
        sockets = list(self.api.sockets(owner.cls, side))
        if not sockets:
            return None
        if isinstance(value, int):
            found = [socket for socket in sockets if f"{side}[{value}]" in socket.subscripts]
            if any(socket.target == _MOVING for socket in found):
                return None
        else:
            # Of several with one name the node's mode decides.
            found = [socket for socket in sockets if value in socket.socket_names]
            always = [socket for socket in found if f'{side}["{value}"]' in socket.subscripts]
            found = always[:1] or found
            found = found or [socket for socket in sockets if value in {socket.name, socket.identifier}]
        if not found:
            keeps_names = owner.cls in NODES_THAT_KEEP_NAMES or not has_sockets_of_its_own(owner.cls)
            if isinstance(value, str) and keeps_names:
                self.resolve(node, "item", value, missing=(owner.cls,), sure=owner.sure)
            return None
        self.resolve(node, "item", str(value), [symbol.path for symbol in found], sure=owner.sure)
        fixed = not has_sockets_of_its_own(owner.cls)
        return union(self.api.socket_type(symbol, fixed=fixed) for symbol in found)

    def iterated(self, kind: Type) -> Type:  # noqa: PLR0911 - one return a type
        """What a loop over a value gives."""
        if isinstance(kind, Union):
            return union(
                self.iterated(member)
                for member in kind.members
                if not isinstance(member, NoneValue) and not is_empty(member)
            )
        if isinstance(kind, Collection):
            return kind.element
        if isinstance(kind, Sequence):
            return kind.element
        if isinstance(kind, Tuple):
            return union(kind.items) if kind.items else UNKNOWN
        if isinstance(kind, Mapping):
            return kind.key
        if isinstance(kind, Instance):
            return self._item_of_instance(kind, UNKNOWN)
        return STR if isinstance(kind, Plain) and kind.kind == "str" else UNKNOWN

    def unpacked(self, kind: Type, count: int) -> list[Type]:
        """The types of ``count`` names that a value is unpacked into."""
        if isinstance(kind, Tuple) and len(kind.items) == count:
            return list(kind.items)
        if isinstance(kind, Union):
            rows = [self.unpacked(member, count) for member in kind.members]
            return [union(column) for column in zip(*rows, strict=True)]
        return [self.iterated(kind)] * count


def has_sockets_of_its_own(cls: str) -> bool:
    """Whether the sockets of a node depend on more than its class."""
    return not {cls.rpartition("Node")[2], cls.removeprefix(T)}.isdisjoint(NODES_WITH_SOCKETS_OF_THEIR_OWN)
