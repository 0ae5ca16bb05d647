"""What is given to Blender to be called, and cannot be: a result instead of a function, or one with other arguments.

```python
def tick():
    return 1.0


def follow():
    pass


bpy.app.timers.register(tick())  # reported: bpy.app.timers.register(tick)
bpy.app.handlers.frame_change_post.append(follow)  # reported: def follow(scene, depsgraph)


@bpy.app.handlers.persistent()  # reported: @bpy.app.handlers.persistent
def loaded(path):
    pass
```

Blender calls a handler with two arguments, or with one if it has one; a timer with none. `bpy.msgbus` takes nothing but
functions in Python and lambdas: no method, no class, no `functools.partial`. Not reported: how many arguments are taken
by functions that the script does not define itself, by methods, and by what decorators may have changed.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.types import (
    NONE,
    UNKNOWN,
    Builtin,
    ClassObject,
    Function,
    Instance,
    LocalClass,
    LocalFunction,
    LocalInstance,
    Module,
    NoneValue,
    Operator,
    Plain,
    Sequence,
    Tuple,
    Type,
    members,
)
from kb_build.index.analysis import split_arguments
from kb_build.symbols.api_names import HANDLERS
from kb_build.symbols.handlers import NUMBERS_OF_ARGUMENTS
from kb_check.calls.sites import calls
from kb_check.findings import Edit, Finding, Fix, Span
from kb_check.registered.handler_lists import handler_list
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.syntax.bindings import once_bound
from kb_check.values.misfits import describe
from simworlds.counting import counted

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_ADDING = frozenset({"append", "insert"})
_NOT_CALLING = frozenset({"is_registered", "unregister"})  # they look for what was given before
# What tells how many arguments a function gets, as the base has it: ``Callable[[int], bool] | None``.
_CALLABLE = re.compile(r"Callable\[\[(.*)\], [^\]]*\](?: \| None)?")
_DECLARING = "bpy.props."  # has a rule of its own
_PERSISTENT = "persistent"
_PERSISTENT_PATH = f"{HANDLERS}{_PERSISTENT}"
# Parameters that take only functions in Python, and lambdas.
_FUNCTIONS_ONLY = frozenset({"bpy.msgbus.subscribe_rna(notify)"})
_OTHERS: dict[type[Type], str] = {
    Builtin: "a function in C", ClassObject: "a class", Function: "a method", LocalClass: "a class",
    LocalFunction: "a method", LocalInstance: "an instance of a class", NoneValue: "None", Operator: "an operator",
}  # fmt: skip
_PARTIAL = frozenset({"functools.partial", "partial"})
_PARTIAL_TYPE = Builtin("functools.partial")


def _check(script: Script) -> Iterator[Finding]:
    for call in calls(script):
        path = call.callee.symbol.path
        is_empty = not (call.node.args or call.node.keywords)
        if path == _PERSISTENT_PATH and is_empty and not is_tried(script, call.node):
            told = f"`{path}` is the decorator itself, and is not called: `@{_PERSISTENT}`."
            yield Finding(
                RULE.id, "error", script.span(call.node), told, path, (), _without_call(script, call.node)
            )
        for parameter, node in () if path.startswith(_DECLARING) else call.arguments():
            form = _CALLABLE.fullmatch(parameter.type)
            if form and path.rpartition(".")[2] not in _NOT_CALLING:
                count = len([*split_arguments(form[1])])
                yield from _judged(script, node, path, (count,), may_be_none=parameter.type.endswith("None"))
            elif f"{path}({parameter.name})" in _FUNCTIONS_ONLY and (given := _other(script, node)):
                yield Finding(
                    RULE.id, "error", script.span(node),
                    f"`{path}` takes for `{parameter.name}` a function in Python or a `lambda`, not {given}.", path,
                    (), _uncalled(script, node),
                )  # fmt: skip
    for node in script.all(ast.Call):
        match node:
            case ast.Call(func=ast.Attribute(value=handlers, attr=name), args=[*_, given]) if name in _ADDING:
                if path := handler_list(script, handlers):
                    yield from _judged(script, given, path, NUMBERS_OF_ARGUMENTS, may_be_none=False)
            case _:
                pass


def _judged(
    script: Script, node: ast.expr, path: str, counts: tuple[int, ...], *, may_be_none: bool
) -> Iterator[Finding]:
    """What is wrong with what is given to be called with one of some numbers of arguments."""
    kind = script.type_of(node)
    if is_tried(script, node) or kind is None:
        return
    if isinstance(kind, LocalFunction):
        function = script.analysis.functions[kind.number] if kind.receiver is None else None
        if function is not None and (wanted := _refused(function, counts)):
            yield Finding(RULE.id, "error", script.span(node), f"`{path}` calls it with {wanted}.", path)
    elif _is_no_function(kind) or (_gives_none(script, node) and not may_be_none):
        fix = _uncalled(script, node)
        told = "a function, not what it returns" if isinstance(node, ast.Call) else "a function"
        yield Finding(RULE.id, "error", script.span(node), f"`{path}` takes {told}.", path, (), fix)


def _other(script: Script, node: ast.expr) -> str:
    """What a value is in words, where it surely is no function in Python; empty where it may be one."""
    if is_tried(script, node):
        return ""
    source = once_bound(script, node)
    if isinstance(source, ast.Call) and ast.unparse(source.func) in _PARTIAL:
        return "a `functools.partial`" if script.type_of(source.func) in {UNKNOWN, _PARTIAL_TYPE} else ""
    if _gives_none(script, node):
        return "None"
    found = {_in_words(kind) for kind in members(script.type_of(node) or UNKNOWN)}
    return "" if "" in found else " or ".join(sorted(found))


def _in_words(kind: Type) -> str:
    """What a type is, if not one of functions in Python; empty for those, and for what may be one."""
    match kind:
        case LocalFunction(receiver=None) | Function(receiver=Module()) | Instance(sure=False):
            return ""
        case _:
            return _OTHERS.get(type(kind)) or describe(kind)


def _refused(function: ast.AST, counts: tuple[int, ...]) -> str:
    """How many arguments a function is called with, where it takes no such number; empty where it does."""
    if not isinstance(function, (ast.FunctionDef, ast.Lambda)):
        return ""
    names = getattr(function, "decorator_list", [])
    if any(getattr(name, "id", getattr(name, "attr", "")) != _PERSISTENT for name in names):
        return ""
    arguments = function.args
    most = len(arguments.posonlyargs) + len(arguments.args)
    fewest = most - len(arguments.defaults)
    if any(fewest <= count and (count <= most or arguments.vararg) for count in counts):
        return ""
    last = counted(counts[-1], "argument") if counts[-1] else "no argument"
    return f"{last}, or with one if it takes one" if counts == NUMBERS_OF_ARGUMENTS else last


def _is_no_function(kind: Type) -> bool:
    """Whether a value surely cannot be called: a number, a text, a list."""
    return all(
        isinstance(member, (Plain, Sequence, Tuple)) or member == NONE for member in members(kind)
    ) and any(member != NONE for member in members(kind))


def _gives_none(script: Script, node: ast.expr) -> bool:
    """Whether a call is of a function of the script that returns nothing."""
    kind = script.type_of(node.func) if isinstance(node, ast.Call) else None
    function = script.analysis.functions[kind.number] if isinstance(kind, LocalFunction) else None
    if not isinstance(function, ast.FunctionDef) or function.decorator_list:
        return False
    return not any(
        isinstance(part, (ast.Yield, ast.YieldFrom))
        or (isinstance(part, ast.Return) and part.value is not None)
        for part in walk(function)
    )


def _uncalled(script: Script, node: ast.expr) -> Fix | None:
    """``register(tick())`` → ``register(tick)``."""
    match node:
        case ast.Call(func=ast.Name() as function, args=[], keywords=[]):
            is_own = isinstance(script.type_of(function), LocalFunction)
            return _without_call(script, node) if is_own else None
        case _:
            return None


def _without_call(script: Script, call: ast.Call) -> Fix | None:
    called, whole = script.span(call.func), script.span(call)
    behind = Span(called.end_line, called.end_column, whole.end_line, whole.end_column)
    return Fix("Give the function", (Edit(behind, ""),), sure=True) if script.text(behind) == "()" else None


RULE = Rule("given-callback", "error", "What Blender is given to call, and cannot", _check)
