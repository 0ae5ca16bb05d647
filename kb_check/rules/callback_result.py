"""What `execute`, `invoke` or `modal` returns, where it is not a set of what Blender knows.

Blender refuses anything but a set of `'FINISHED'`, `'CANCELLED'`, `'RUNNING_MODAL'`, `'PASS_THROUGH'` and
`'INTERFACE'`, None included: the call of the operator ends with a RuntimeError, after the work is done.

```python
class Grow(bpy.types.Operator):
    def invoke(self, context, event):  # reported: ends without a return
        context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        return "FINISHED"  # reported: {"FINISHED"}
```

A `poll` that never returns a value is a warning: it says no each time.

Not reported: a function that only may end without a return, results of the script's own functions, and functions that
the script calls itself without using what they return.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, NamedTuple

from kb_build.flow.syntax.trees import called_name, children
from kb_build.symbols.api_names import TYPES
from kb_check.calls.resolved import callee_path
from kb_check.calls.sites import callee_of
from kb_check.findings import Finding, Fix
from kb_check.registered.classes import own_classes
from kb_check.rule import Rule
from kb_check.script import once_per_script
from kb_check.syntax.bodies import bodies_of
from kb_check.syntax.literals import set_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.registered.classes import OwnClass
    from kb_check.script import Script
    from kb_check.syntax.definitions import FunctionDefinition

_Scope = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.Lambda
_SIMPLE = (
    ast.Expr,
    ast.Assign,
    ast.AugAssign,
    ast.AnnAssign,
    ast.Delete,
    ast.Pass,
    ast.Import,
    ast.ImportFrom,
)
_NO_SETS: dict[type[ast.expr], str] = {
    ast.JoinedStr: "a str", ast.Dict: "a dict", ast.DictComp: "a dict", ast.List: "a list", ast.ListComp: "a list",
    ast.Tuple: "a tuple", ast.Compare: "a truth value", ast.Lambda: "a function",
}  # fmt: skip

# Functions that may not come back, by name.
_MAY_END = frozenset({"exit", "_exit", "quit", "quit_blender", "abort", "fail"})


class _Ends(NamedTuple):
    """How a function ends: by its returns, ``yields`` values, or may run past its last statement."""

    returns: list[ast.Return]
    yields: bool
    raises: bool


def _check(script: Script) -> Iterator[Finding]:
    seen: set[ast.stmt] = set()
    for own in own_classes(script):
        for symbol, function in own.callbacks(script):
            if function in seen or not symbol.returns:
                continue
            seen.add(function)
            if symbol.returns[0].enum_items:
                if symbol.name not in _helpers(script):
                    yield from _judged(script, own, function, symbol)
            elif symbol.name == "poll" and _returns_nothing(_ends(function)):
                yield Finding(
                    RULE.id, "warning", script.name_span(function),
                    f"`poll` of {own.label} returns nothing, which Blender takes for no each time.", f"{own.path}.poll",
                )  # fmt: skip


@once_per_script
def _helpers(script: Script) -> frozenset[str]:
    """The methods that the script calls itself and whose results it drops: Blender need not call them."""
    return frozenset(
        node.value.func.attr
        for node in script.all(ast.Expr)
        if isinstance(node.value, ast.Call) and isinstance(node.value.func, ast.Attribute)
    )


def _judged(script: Script, own: OwnClass, function: FunctionDefinition, symbol: Symbol) -> Iterator[Finding]:
    values = [item.identifier for item in symbol.returns[0].enum_items]
    example = "{'FINISHED'}" if "FINISHED" in values else f"{{{values[0]!r}}}"
    refusal = f"`{function.name}` of {own.label} must return a set such as {example}"
    ends = _ends(function)
    if isinstance(function, ast.AsyncFunctionDef) or ends.yields:
        what = "a generator" if ends.yields else "a coroutine"
        yield Finding(
            RULE.id, "error", script.name_span(function), f"{refusal}, and this is {what}.", symbol.path
        )
        return
    for statement in ends.returns:
        for node in _results(statement.value):
            if isinstance(node, ast.Set):
                yield from _unknown(script, node, symbol, values)
            elif what := _no_set(script, node):
                yield Finding(
                    RULE.id, "error", script.span(node or statement), f"{refusal}, not {what}.", symbol.path, (),
                    _as_set(script, node, values),
                )  # fmt: skip
    if not (own.is_registered or own.given("bl_idname")):
        return  # it may be there to be derived from, and this function to be replaced
    if _runs_past(function.body) or (_returns_nothing(ends) and not ends.returns and not ends.raises):
        yield Finding(
            RULE.id, "error", script.name_span(function),
            f"{refusal}, and this one ends without a `return`.", symbol.path,
        )  # fmt: skip


def _ends(function: FunctionDefinition) -> _Ends:
    returns: list[ast.Return] = []
    yields = raises = False
    queue: list[ast.AST] = list(function.body)
    while queue:
        node = queue.pop()
        if isinstance(node, _Scope):
            continue
        yields = yields or isinstance(node, (ast.Yield, ast.YieldFrom))
        # A loop may have no end.
        raises = raises or isinstance(node, (ast.Raise, ast.While)) or called_name(node) in _MAY_END
        if isinstance(node, ast.Return):
            returns.append(node)
        queue.extend(children(node))
    return _Ends(sorted(returns, key=lambda node: node.lineno), yields, raises)


def _returns_nothing(ends: _Ends) -> bool:
    """Whether there is no value that a function returns."""
    no_values = all(
        node.value is None or (isinstance(node.value, ast.Constant) and node.value.value is None)
        for node in ends.returns
    )
    return no_values and not ends.yields and not ends.raises


def _runs_past(body: list[ast.stmt]) -> bool:
    """Whether a function's body surely can be run to its end: its last statement is no return, and none before is."""
    last = body[-1]
    return (
        isinstance(last, _SIMPLE)
        and not (isinstance(last, ast.Expr) and called_name(last.value) in _MAY_END)
        and not any(map(_may_leave, body))
    )


def _may_leave(statement: ast.stmt) -> bool:
    """Whether a statement may return on all of its ways."""
    if isinstance(statement, (ast.Return, ast.Raise, ast.While, ast.Try, ast.TryStar, ast.Match)):
        return True
    bodies = [body for body in bodies_of(statement) if body]
    both = not isinstance(statement, ast.If) or len(bodies) > 1
    inner = isinstance(statement, (ast.If, ast.With, ast.AsyncWith)) and both
    return inner and all(any(map(_may_leave, body)) for body in bodies)


def _results(value: ast.expr | None) -> Iterator[ast.expr | None]:
    if isinstance(value, ast.IfExp):
        yield from _results(value.body)
        yield from _results(value.orelse)
    else:
        yield value


def _no_set(script: Script, node: ast.expr | None) -> str:
    """What a result is instead of a set; empty where it may be one."""
    if node is None:
        return "None"
    if isinstance(node, ast.Constant):
        return repr(node.value)
    if isinstance(node, ast.Call):
        path = callee_path(script, node)
        symbol = script.api.symbols.symbol(path) if path.startswith(TYPES) else None
        if symbol is None or symbol.kind != "function" or not callee_of(symbol).is_rna:
            return ""
        kind = symbol.returns[0].type if symbol.returns else "None"
        return (
            f"what `{path}` returns, {kind}" if kind in {"None", "boolean", "int", "float", "string"} else ""
        )
    return _NO_SETS.get(type(node), "")


def _as_set(script: Script, node: ast.expr | None, values: list[str]) -> Fix | None:
    """Writes a set in the place of the one value in it."""
    if not isinstance(node, ast.Constant) or node.value not in values:
        return None
    return set_of(script, node)


def _unknown(script: Script, node: ast.Set, symbol: Symbol, values: list[str]) -> Iterator[Finding]:
    for part in node.elts:
        if isinstance(part, ast.Constant) and part.value not in values:
            lacking = script.names.value(f"{symbol.path}()", str(part.value), values)
            edit = script.renamed(part, lacking.replacement) if lacking.replacement else None
            yield Finding(
                RULE.id, "error", script.span(part), lacking.message, symbol.path, (),
                Fix(f"Write {lacking.replacement}", (edit,)) if edit else None,
            )  # fmt: skip


RULE = Rule("callback-result", "error", "A result that Blender refuses", _check)
