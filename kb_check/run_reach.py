"""What happens when a script is run as a whole: which of its lines that comes to, and whether it may add to the API.

A name that does not exist is an error only where the run comes by. What Blender calls (an operator's ``execute``, a
handler) and what nobody calls is not come by; nor is what is called in a ``try``, whose errors the script is ready for.
"""

from __future__ import annotations

import ast
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

_Function = ast.FunctionDef | ast.AsyncFunctionDef

# Names that can give Blender's API more than the text shows.
_BRINGING = frozenset(
    {
        # code that is not in the text, or is only a text
        "exec", "eval", "import_module", "__import__", "run_path", "run_module", "exec_module", "python_file_run",
        # a property or a class whose name is not written down
        "setattr", "new_class",
        # add-ons and extensions
        "addon_utils", "addon_enable", "addon_install", "addon_refresh", "extensions", "load_scripts",
        "modules_from_path",
    }
)  # fmt: skip
_PACKAGES = frozenset({"numpy", "__future__"})  # that Blender brings, and that leave its API alone


class RunReach:
    """Which lines a run of the script comes to, as far as its text tells."""

    def __init__(self, tree: ast.Module) -> None:
        self._functions: list[_Function] = []
        self._by_name: dict[str, list[_Function]] = {}
        for node in ast.walk(tree):
            if isinstance(node, _Function):
                self._functions.append(node)
                self._by_name.setdefault(node.name, []).append(node)
            elif isinstance(node, ast.ClassDef):
                makers = (
                    item for item in node.body if isinstance(item, _Function) and item.name == "__init__"
                )
                self._by_name.setdefault(node.name, []).extend(makers)
        self._reached: set[_Function] = set()
        waiting: list[ast.stmt] = [*tree.body]
        while waiting:
            for name in set(_names(waiting.pop())):
                for function in self._by_name.get(name, ()):
                    if function not in self._reached:
                        self._reached.add(function)
                        waiting += function.body

    def comes_to(self, line: int) -> bool:
        """Whether the run comes to a line; it may still be left out by a condition."""
        around = [
            function
            for function in self._functions
            if function.body[0].lineno <= line <= (function.end_lineno or line)
        ]
        return not around or max(around, key=lambda function: function.body[0].lineno) in self._reached


def _names(statement: ast.stmt) -> Iterator[str]:
    """The names that running a statement uses, without those in functions that it defines and in what is tried."""
    waiting: list[ast.AST] = [statement]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Attribute):
            yield node.attr
        if isinstance(node, _Function):
            waiting += [*node.decorator_list, node.args]
        elif isinstance(node, ast.Try | ast.TryStar) and node.handlers:
            waiting += [*node.handlers, *node.orelse, *node.finalbody]
        elif isinstance(node, ast.With) and any(_suppresses(item.context_expr) for item in node.items):
            continue
        else:
            waiting += ast.iter_child_nodes(node)


def _suppresses(manager: ast.expr) -> bool:
    return isinstance(manager, ast.Call) and "suppress" in (
        getattr(manager.func, "attr", ""),
        getattr(manager.func, "id", ""),
    )


def may_bring_names(tree: ast.Module, is_known: Callable[[str], bool]) -> bool:
    """Whether a script may give Blender's API names that its text does not show: by an add-on that it enables, say.

    ``is_known`` tells whether a module is one of Blender's.
    """
    return any(_brings(node, is_known) for node in ast.walk(tree))


def _brings(node: ast.AST, is_known: Callable[[str], bool]) -> bool:
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return name in _BRINGING
        case ast.Import():
            return not all(_is_harmless(alias.name, is_known) for alias in node.names)
        case ast.ImportFrom():
            known = not node.level and _is_harmless(node.module or "", is_known)
            return not known or any(alias.name in _BRINGING for alias in node.names)
        case ast.Call(func=ast.Name(id="type"), args=[_, _, _]):
            return True
        case ast.Assign(targets=[ast.Name(id="bl_idname")], value=value):
            return not isinstance(value, ast.Constant)
        case _:
            return False


def _is_harmless(module: str, is_known: Callable[[str], bool]) -> bool:
    top = module.partition(".")[0]
    return top in sys.stdlib_module_names or top in _PACKAGES or (top not in _BRINGING and is_known(top))
