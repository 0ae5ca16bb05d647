"""What leaves the active object, and the mode that it is in, alone."""

from __future__ import annotations

import ast
import builtins
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import SET_ACTIVE
from kb_build.flow.syntax.trees import APART, children
from kb_check.calls.sites import calls_by_node
from kb_check.running.computing import CALLING, RUNNING, STORING
from kb_check.running.out_of_sight import knows_all
from kb_check.script import once_per_script
from kb_check.syntax.bindings import bindings
from kb_check.syntax.definitions import FUNCTIONS, FunctionDefinition
from kb_check.syntax.words import stored_names

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

LEFT = (ast.Yield, ast.YieldFrom, ast.Await)  # lets others run meanwhile
SWITCHED = frozenset({"scene", "view_layer", "workspace", "hide_viewport", "exclude"})
REMOVING = frozenset(
    {
        "remove",
        "batch_remove",
        "unlink",
        "clear",
        "orphans_purge",
        "user_clear",
        "user_remap",
        "hide_set",
        "load",
    }
)
_BUILTINS = frozenset(dir(builtins)) - RUNNING - STORING - CALLING


def keeps_mode(script: Script, node: ast.AST) -> bool:
    """Whether a statement or expression surely leaves the active object and its mode alone, with all that it calls."""
    return _keeps(script, node, _changing(script))


@once_per_script
def _changing(script: Script) -> frozenset[str]:
    """The script's own functions that may change the mode or the active object."""
    found: dict[str, None] = {}
    callers: dict[str, list[str]] = {}
    for name, function in own_functions(script).items():
        for statement in function.body:
            for called in _own_calls(script, statement):
                callers.setdefault(called, []).append(name)
            if not _keeps(script, statement, frozenset()):
                found[name] = None
    waiting = [*found]
    for name in waiting:  # which grows
        for caller in callers.get(name, ()):
            if caller not in found:
                found[caller] = None
                waiting.append(caller)
    return frozenset(found)


def _keeps(script: Script, root: ast.AST, changing: frozenset[str]) -> bool:
    for node in run_in(root):
        match node:
            case ast.Call(func=ast.Name(id=name)) if name in own_functions(script):
                known = name not in changing
            case ast.Call():
                known = is_harmless(script, node)
            case ast.Attribute(ctx=ast.Store() | ast.Del()):
                known = node.attr not in SWITCHED and not sets_active(script, node)
            case _:
                known = not isinstance(node, LEFT)
        if not known:
            return False
    return True


def _own_calls(script: Script, root: ast.AST) -> Iterator[str]:
    """The script's own functions that a statement may call."""
    for node in run_in(root):
        match node:
            case ast.Call(func=ast.Name(id=name)) if name in own_functions(script):
                yield name
            case _:
                pass


def run_in(root: ast.AST) -> Iterator[ast.AST]:
    """The parts of a statement or expression that may run with it: not those of what it defines."""
    waiting = [root]
    while waiting:
        node = waiting.pop()
        if not isinstance(node, APART):
            yield node
            waiting += children(node)


def sets_active(script: Script, node: ast.Attribute) -> bool:
    """Whether what is stored in an attribute may become the active object."""
    if node.attr != "active":
        return False
    row = script.analysis.resolutions.get(node)
    return row is None or SET_ACTIVE in row.symbols or not row.symbols


def is_harmless(script: Script, node: ast.Call) -> bool:
    """Whether a call leaves the active object and its mode alone; the script's own functions are not followed."""
    if is_operator(node):
        return isinstance(node.func, ast.Attribute) and node.func.attr == "poll"
    own = own_names(script)
    if any(_is_run(value, own) for value in (*node.args, *(word.value for word in node.keywords))):
        return False
    call = calls_by_node(script).get(node)
    if isinstance(node.func, ast.Name):
        name = node.func.id
        known = name in _BUILTINS or (call is not None and call.callee.symbol.kind != "operator")
        return name not in own and (known or (name in _imported(script) and knows_all(script)))
    if not isinstance(node.func, ast.Attribute) or node.func.attr in REMOVING:
        return False
    if call:
        return call.callee.symbol.kind != "operator"
    return knows_all(script) and node.func.attr not in own and node.func.attr not in stored_names(script)


def _is_run(value: ast.expr, own: frozenset[str]) -> bool:
    """Whether what is given to a call is something that it may run."""
    return isinstance(value, ast.Lambda) or (isinstance(value, ast.Name) and value.id in own)


def is_operator(call: ast.Call) -> bool:
    """Whether what is called is written as an operator of Blender, or as something of one."""
    node = call.func
    names: list[str] = []
    while isinstance(node, ast.Attribute):
        names.append(node.attr)
        node = node.value
    return isinstance(node, ast.Name) and node.id != "bmesh" and (names[-1:] == ["ops"] or node.id == "ops")


@once_per_script
def own_names(script: Script) -> frozenset[str]:
    """The names of the script's functions and classes."""
    return frozenset(node.name for node in script.all(*FUNCTIONS, ast.ClassDef))


@once_per_script
def own_functions(script: Script) -> dict[str, FunctionDefinition]:
    """The script's functions that a name surely calls: plain ones, defined once, that nothing else is called like."""
    found: dict[str, list[FunctionDefinition]] = {}
    methods = {item for node in script.all(ast.ClassDef) for item in node.body}
    for node in script.all(*FUNCTIONS):
        if node not in methods:
            found.setdefault(node.name, []).append(node)
    yields = [node.lineno for node in script.all(ast.Yield, ast.YieldFrom)]
    return {
        name: nodes[0]
        for name, nodes in found.items()
        if len(nodes) == 1
        and name not in bindings(script)
        and not nodes[0].decorator_list
        and isinstance(nodes[0], ast.FunctionDef)
        and not any(nodes[0].lineno <= line <= (nodes[0].end_lineno or 0) for line in yields)
    }


@once_per_script
def _imported(script: Script) -> frozenset[str]:
    """The names that imports bind."""
    found: set[str] = set()
    for node in script.all(ast.Import, ast.ImportFrom):
        found.update((alias.asname or alias.name).partition(".")[0] for alias in node.names)
    return frozenset(found)
