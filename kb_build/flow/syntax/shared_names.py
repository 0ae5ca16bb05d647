"""The names that functions share: one binds or fills what belongs to the module, or to a function around it."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from kb_build.flow.syntax.trees import called_name, children

if TYPE_CHECKING:
    from collections.abc import Mapping

_FILLING = frozenset({"append", "appendleft", "add", "insert", "extend", "update", "setdefault"})
_GLOBALS = "globals"
_ANY = "*"


class SharedNames(NamedTuple):
    """The names of a module or a function that functions bind or fill though they are not their own: what one holds
    depends on which functions were called before. Those that are ``filled`` and not bound hold another thing only if it
    is a list or a dictionary.
    """

    bound: frozenset[str] = frozenset()
    filled: frozenset[str] = frozenset()


NONE_SHARED = SharedNames()


@dataclass(slots=True)
class _Part:
    """A module or a function. ``own`` are the names that it binds, ``outer`` those that it binds or fills in parts
    around it, ``bound`` those that it binds in a function around it, ``in_module`` those that it says are the module's,
    ``filled`` those whose items it sets or adds to, ``written`` those that it puts into ``globals()``, ``_ANY`` for
    computed ones.
    """

    node: ast.AST
    around: _Part | None
    own: set[str] = field(default_factory=set[str])
    outer: set[str] = field(default_factory=set[str])
    bound: set[str] = field(default_factory=set[str])
    in_module: set[str] = field(default_factory=set[str])
    filled: set[str] = field(default_factory=set[str])
    written: set[str] = field(default_factory=set[str])
    shared: set[str] = field(default_factory=set[str])


def shared_names(tree: ast.Module) -> Mapping[ast.AST, SharedNames]:
    """Module, function or lambda → the names there that functions share."""
    module = _Part(tree, None)
    parts = [module]
    for part in parts:  # it grows
        parts += _read(part)
    for part in reversed(parts):
        part.shared |= part.outer
        if part.around is not None:
            part.around.shared |= part.outer
            # It is shared on the way to whose name it is, too.
            part.around.outer |= part.outer - part.around.own
            module.shared |= part.in_module
        module.shared |= module.own if _ANY in part.written else part.written
    for part in parts:
        if part.around is not None:
            part.shared |= part.in_module | (part.around.shared - part.own)
    bound = set[str]().union(*(part.bound | part.in_module | part.written for part in parts))
    bound |= module.own if _ANY in bound else set()
    return {
        part.node: SharedNames(frozenset(part.shared & bound), frozenset(part.shared - bound))
        for part in parts
    }


def _read(part: _Part) -> list[_Part]:
    """Notes what a part does with names. Returns the functions right within it."""
    inner: list[_Part] = []
    waiting = children(part.node)
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Name):
            if isinstance(node.ctx, ast.Store):
                part.own.add(node.id)
            continue
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
            inner.append(_Part(node, part))
            continue
        if isinstance(node, (ast.Subscript, ast.Attribute)):
            _note_filled(node, part)
        elif isinstance(node, ast.arg):
            part.own.add(node.arg)
        elif isinstance(node, ast.Global):
            part.in_module.update(node.names)
        elif isinstance(node, ast.Nonlocal):
            part.bound.update(node.names)
        waiting += children(node)
    part.own -= part.bound | part.in_module
    if part.around is not None:
        part.outer |= part.bound | (part.filled - part.own - part.in_module)
    return inner


def _note_filled(node: ast.Subscript | ast.Attribute, part: _Part) -> None:
    """Notes what an item is set of, or the method of which adds to it."""
    key = _ANY
    if isinstance(node, ast.Attribute):
        if node.attr not in _FILLING:
            return
    elif isinstance(node.ctx, ast.Load):
        return
    elif isinstance(node.slice, ast.Constant) and isinstance(node.slice.value, str):
        key = node.slice.value
    if isinstance(node.value, ast.Name):
        part.filled.add(node.value.id)
    elif called_name(node.value) == _GLOBALS:
        part.written.add(key)
