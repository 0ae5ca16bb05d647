"""The groups of nodes that a script makes, and the names that it gives to their inputs."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import ID
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import called_operators, callee_path
from kb_check.running.out_of_sight import knows_all
from kb_check.scene.made_here import is_new
from kb_check.scene.opening import OPENING
from kb_check.script import once_per_script
from kb_check.syntax.words import attributes, keywords_and_texts, members_taken, named_words

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.script import Script

_GROUPS, _GROUPS_NEW, _TREE = "node_groups", f"{T}BlendDataNodeTrees.new", f"{T}NodeTree"
# Maker of a socket → the place of the name among its arguments.
_SOCKET_MAKERS = {f"{T}NodeTreeInterface.new_socket": 0, f"{T}NodeTreeInputs.new": 1}
# What brings groups out of other files.
_BRINGING = OPENING | {
    "bpy.ops.wm.append", "bpy.ops.wm.link", "bpy.ops.node.add_group_asset", "bpy.ops.node.swap_group_asset",
    "bpy.ops.object.modifier_add_node_group", "bpy.ops.object.drop_geometry_nodes",
}  # fmt: skip
# Pointers that are known by their names where it is not known whose they are.
_POINTERS = frozenset({"node_group", "edit_tree"})
# How the inputs and outputs of groups were called that were made before 4.0; these keep it.
_FORMER = re.compile(r"(?:Input|Output)_(\d+)(?:_use_attribute|_attribute_name)?")
_RENAMED_IN = (4, 0)
# Members of a group that are one themselves.
_ANOTHER = frozenset({"copy", "evaluated_get", "make_local", "original", "override_create"})


@once_per_script
def makes_all_groups(script: Script) -> bool:
    """Whether a script makes groups of nodes, and takes none out of a file or from what has one already."""
    if not knows_all(script) or called_operators(script) & _BRINGING:
        return False
    if "libraries" in named_words(script) or not _POINTERS.isdisjoint(keywords_and_texts(script)):
        return False
    makers = {
        call.func.value
        for call in script.all(ast.Call)
        if isinstance(call.func, ast.Attribute) and callee_path(script, call) == _GROUPS_NEW
    }
    used = attributes(script).get(_GROUPS, [])
    taken = members_taken(script)
    return (
        bool(makers)
        and makers.issuperset(used)
        and not any(taken.get(node, "copy") in _ANOTHER for node in _groups_of_others(script))
    )


def _groups_of_others(script: Script) -> Iterator[ast.Attribute]:
    """Where the script reads which group something has."""
    for row in script.resolutions("attribute"):
        if isinstance(row.node, ast.Attribute) and isinstance(row.node.ctx, ast.Load):
            symbols = (script.api.symbols.symbol(path) for path in row.symbols)
            if row.node.attr in _POINTERS or any(
                symbol and _holds_groups(script, symbol) for symbol in symbols
            ):
                yield row.node


def _holds_groups(script: Script, symbol: Symbol) -> bool:
    """Whether a pointer may lead to a group; the tree of a material, or of a scene, is its own."""
    is_tree = symbol.type == "pointer" and script.api.descends(f"{T}{symbol.target}", _TREE)
    return is_tree and not script.api.descends(symbol.owner, ID)


@once_per_script
def named_inputs(script: Script) -> frozenset[str]:
    """The names that the script gives to the sockets of groups."""
    found: set[str] = set()
    for node in script.all(ast.Call):
        place = _SOCKET_MAKERS.get(callee_path(script, node))
        if place is None:
            continue
        given = [*node.args[place : place + 1], *(word.value for word in node.keywords if word.arg == "name")]
        found.update(
            part.value for part in given if isinstance(part, ast.Constant) and isinstance(part.value, str)
        )
    return frozenset(found)


def input_now(script: Script, node: ast.Subscript, modifier: ast.expr) -> str:
    """The identifier that Blender now gives to the input which a modifier made here is asked for by one of before 4.0:
    ``Socket_2`` for ``modifier["Input_2"]``. Empty where it may be that of a group of before, or a name.
    """
    if (
        script.version < _RENAMED_IN
        or not isinstance(node.slice, ast.Constant)
        or not makes_all_groups(script)
    ):
        return ""
    key = node.slice.value
    former = _FORMER.fullmatch(key) if isinstance(key, str) else None
    if former is None or key in named_inputs(script) or not is_new(script, modifier):
        return ""
    return f"Socket_{former[1]}"
