"""The trees that nodes are in, where a script's own calls of ``nodes.new`` tell."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Collection, Instance
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.paths import last_name
from kb_check.calls.sites import calls_by_node
from kb_check.script import once_for_each
from kb_check.syntax.bindings import bindings

if TYPE_CHECKING:
    from kb_build.symbols.records import EnumItem
    from kb_check.calls.sites import CallSite
    from kb_check.script import Script

_NEW_NODE, _TREE = f"{T}Nodes.new", f"{T}NodeTree"


def tree_added_to(script: Script, call: CallSite) -> str:
    """The class of the tree whose nodes a call adds to; empty where that is not sure."""
    nodes = script.type_of(call.node.func.value) if isinstance(call.node.func, ast.Attribute) else None
    tree = nodes.owner if isinstance(nodes, Collection) else None
    if not isinstance(tree, Instance) or not tree.sure or tree.cls == _TREE:
        return ""
    return last_name(tree.cls) if script.api.descends(tree.cls, _TREE) else ""


def tree_of(script: Script, node: ast.expr) -> str:
    """The class of the tree in which a node was made; empty where that is not sure."""
    if isinstance(node, ast.Name):
        return _tree_of_name(script, node.id)
    return _tree_of_made(script, node)


@once_for_each
def _tree_of_name(script: Script, name: str) -> str:
    found = {_tree_of_made(script, value) for value in bindings(script).get(name, [])}
    return found.pop() if len(found) == 1 else ""


def _tree_of_made(script: Script, value: ast.expr | None) -> str:
    call = calls_by_node(script).get(value) if isinstance(value, ast.Call) else None
    return tree_added_to(script, call) if call and call.callee.symbol.path == _NEW_NODE else ""


def is_refused_in(tree: str, item: EnumItem) -> bool:
    """Whether it is known that nodes of a tree do not take an item; never of an empty one."""
    where = item.where
    if where is None or not where.places or not tree:
        return False
    return (tree in where.places) != (where.how == "only")
