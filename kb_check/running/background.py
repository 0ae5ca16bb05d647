"""Which lines of a script run in the context that Blender starts with, without a window."""

from __future__ import annotations

import ast
from itertools import chain
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import APART, called_name, children, run_with
from kb_build.flow.values.types import Instance
from kb_check.running.line_ranges import LineRanges
from kb_check.script import once_per_script
from kb_check.syntax.bodies import bodies_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_check.script import Script

_BACKGROUND = "bpy.app.background"


def is_called_by_others(script: Script) -> bool:
    """Whether a script is an add-on or a module, which others call, or knows that there may be no window."""
    body = script.tree.body
    if any(isinstance(node, ast.FunctionDef) and node.name == "register" for node in body):
        return True
    if not _runs(script, body):
        return True
    return any(_BACKGROUND in row.symbols for row in script.resolutions("attribute", "name"))


def _runs(script: Script, body: Sequence[ast.stmt]) -> bool:
    """Whether a module calls anything, or sets something of Blender's data, when it is run."""
    return any(
        isinstance(getattr(node, "value", None), ast.Call)
        or _sets(script, node)
        or (not isinstance(node, APART) and any(_runs(script, inner) for inner in bodies_of(node)))
        for node in body
    )


def _sets(script: Script, node: ast.stmt) -> bool:
    targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
    return any(
        isinstance(target, ast.Attribute) and isinstance(script.type_of(target.value), Instance)
        for target in targets
    )


@once_per_script
def lines_of_others(script: Script) -> LineRanges:
    """The lines whose context others give."""
    return LineRanges([*_given_context(script), *_uncalled(script)])


def _given_context(script: Script) -> Iterator[tuple[int, int]]:
    """The lines that have a context of their own: classes, and what stands inside ``temp_override``."""
    for node in script.all(ast.ClassDef, ast.With, ast.AsyncWith):
        if isinstance(node, ast.ClassDef) or _overrides(node):
            yield node.lineno, node.end_lineno or node.lineno


def _uncalled(script: Script) -> Iterator[tuple[int, int]]:
    """The lines of functions that the script does not call itself when it is run."""
    called = _called(script)
    for node in script.all(ast.FunctionDef, ast.AsyncFunctionDef):
        if node.name not in called:
            yield node.lineno, node.end_lineno or node.lineno


def _called(script: Script) -> set[str]:
    """The functions that the module calls, outside of any, and those that these call."""
    defined: dict[str, list[ast.AST]] = {}
    for node in script.all(ast.FunctionDef, ast.AsyncFunctionDef):
        defined.setdefault(node.name, []).append(node)
    called: set[str] = set()
    waiting: list[ast.AST] = [script.tree]
    for each in waiting:
        names = {called_name(node) for node in run_with(children(each))} - called
        called |= names
        waiting += chain.from_iterable(defined.get(name, ()) for name in names)
    return called


def _overrides(node: ast.With | ast.AsyncWith) -> bool:
    calls_made = (item.context_expr for item in node.items)
    return any(
        isinstance(call, ast.Call)
        and isinstance(call.func, ast.Attribute)
        and call.func.attr == "temp_override"
        for call in calls_made
    )
