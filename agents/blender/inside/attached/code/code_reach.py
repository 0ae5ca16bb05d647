# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a scene a piece of code reaches, as far as its text tells."""

import ast

_ALL = frozenset(
    {"objects", "all_objects", "meshes", "materials", "collections", "children", "all_objects_recursive"}
)
_SINGLE = frozenset({"new", "link", "unlink", "remove", "active", "load", "get", "find", "move"})
_OF_SELECTION = frozenset(
    {
        "object",
        "active_object",
        "selected_objects",
        "selected_editable_objects",
        "active",
        "ops",
        "selected_ids",
    }
)


class Reach:
    """``names``: texts in the code, which may be names of data-blocks. ``selection``: it may reach what is selected.

    ``everything``: why it may reach any object; "" if it does not.
    """

    def __init__(self, code):
        """Raises SyntaxError and ValueError for what is no code."""
        tree = ast.parse(code)
        self.names, self.selection, self.everything = set(), False, ""
        single = set()
        for node in ast.walk(tree):
            single |= _single(node)
        for node in ast.walk(tree):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                self.names.add(node.value)
            elif isinstance(node, ast.Attribute):
                self.selection = self.selection or node.attr in _OF_SELECTION
                if node.attr.startswith("select_") and "ops" in ast.unparse(node.value).split("."):
                    self.everything = f"line {node.lineno} selects by bpy.ops"
                elif node.attr in _ALL and node not in single:
                    self.everything = f"line {node.lineno} goes through {ast.unparse(node)}"


def _single(node):
    """The collections of which a node takes one member by a name that stands there, or to which it adds one."""
    if (
        isinstance(node, ast.Subscript)
        and isinstance(node.slice, ast.Constant)
        and isinstance(node.slice.value, str)
    ):
        return {node.value}
    if isinstance(node, ast.Compare) and isinstance(node.left, ast.Constant):
        return set(node.comparators)
    if isinstance(node, ast.Attribute) and node.attr in _SINGLE - {"get", "find"}:
        return {node.value}
    if (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr in {"get", "find"}
    ):
        return {node.func.value} if node.args and isinstance(node.args[0], ast.Constant) else set()
    return set()
