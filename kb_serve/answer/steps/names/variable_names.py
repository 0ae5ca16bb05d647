"""What scripts call the instances that they work on."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import BLEND_DATA, OBJECT, TYPES

if TYPE_CHECKING:
    from collections.abc import Callable

    from kb_serve.reader import BaseReader

MESH, TREE = f"{TYPES}Mesh", f"{TYPES}NodeTree"
OBJ = "obj"
DATA = "object_data"
# What every script has, or writes without a step that makes it.
_THERE = {
    OBJECT: OBJ,
    f"{TYPES}Scene": "scene",
    f"{TYPES}ViewLayer": "view_layer",
    BLEND_DATA: "bpy.data",
    TREE: "tree",
}
_ROOTS = {name: cls for cls, name in _THERE.items()} | {"mesh": MESH}
_HUMPS = re.compile(r"[A-Z]+[a-z0-9]*")


def class_called(name: str) -> str:
    """The class of what every script calls so; empty for another name."""
    return _ROOTS.get(name, "")


class VariableNames:
    """The names of instances in one list of steps."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._expressions: dict[str, str] = {}

    def add(self, cls: str, expression: str) -> None:
        """Notes that an instance is there."""
        self._expressions[cls] = expression

    def restoring(self) -> Callable[[], None]:
        """What makes undone all that is noted from now on."""
        before = dict(self._expressions)

        def restore() -> None:
            self._expressions = before

        return restore

    def there(self, cls: str) -> str:
        """The expression for an instance of a class that is there already; empty for none."""
        known = (name for made, name in self._expressions.items() if self._reader.descends(made, cls))
        return next(known, "") or _THERE.get(cls, "")

    def is_made(self, cls: str) -> bool:
        """Whether a step has made an instance of a class."""
        return cls in self._expressions

    def class_of(self, expression: str) -> str:
        """The class of the instance that an expression is noted for; empty for none."""
        return next((cls for cls, name in self._expressions.items() if name == expression), "")

    def within(self, reached: str) -> str:
        """An expression over a new scene as one that begins with an instance which is there; else as it is."""
        for cls, name in self._expressions.items():
            symbol = self._reader.symbol(cls)
            if (
                symbol
                and symbol.reached
                and reached.startswith(f"{symbol.reached}.")
                and "[" in symbol.reached
            ):
                return name + reached[len(symbol.reached) :]
        return reached

    def of(self, cls: str) -> str:
        """What a script calls an instance: ``object_data``, or the name's last word; its last two if another is so."""
        if cls == OBJECT:
            return OBJ
        if self._reader.is_object_data(cls):
            return DATA
        *before, last = _HUMPS.findall(cls.removeprefix(TYPES)) or ["it"]
        name = last.lower()
        return "_".join((*map(str.lower, before[-1:]), name)) if self._is_taken(name, cls) else name

    def _is_taken(self, name: str, cls: str) -> bool:
        """Whether a variable of this name is another class's instance."""
        return any(own == name and made != cls for made, own in self._expressions.items())
