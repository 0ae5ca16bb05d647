"""Which pointers a script reads something from."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, NamedTuple

from kb_check.calls.resolved import member_path
from kb_check.running.tried import is_tried
from kb_check.syntax.bindings import bindings
from kb_check.syntax.words import asked_names

if TYPE_CHECKING:
    from collections.abc import Container, Iterator

    from kb_build.flow.values.types import Resolution
    from kb_check.script import Script


def read_pointer(script: Script, node: ast.expr) -> ast.Attribute | None:
    """The attribute that an expression reads, itself or by the only value of a name that is only read from."""
    if isinstance(node, ast.Name) and node.id not in asked_names(script):
        values = bindings(script).get(node.id, [])
        value = values[0] if len(values) == 1 else None
        return value if isinstance(value, ast.Attribute) else None
    return node if isinstance(node, ast.Attribute) else None


class PointerRead(NamedTuple):
    """What is read from or set on a pointer; ``path`` is the pointer's."""

    row: Resolution
    node: ast.Attribute
    pointer: ast.Attribute
    path: str


def read_from(script: Script, pointers: Container[str]) -> Iterator[PointerRead]:
    """What is read from or set on pointers of some paths, where no error is awaited."""
    for row in script.resolutions("attribute", "store"):
        node = row.node
        pointer = read_pointer(script, node.value) if isinstance(node, ast.Attribute) else None
        path = member_path(script, pointer) if pointer else ""
        if pointer and path in pointers and isinstance(node, ast.Attribute) and not is_tried(script, node):
            yield PointerRead(row, node, pointer, path)
