"""What rests on nothing but what the script says of it: on an annotation, which Python does not check."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.types import LocalFunction
from kb_check.script import once_for_each
from kb_check.syntax.literals import bound_names

if TYPE_CHECKING:
    from kb_check.script import Script
    from kb_check.syntax.definitions import FunctionDefinition

ONE_IS_WRONG = "the annotation or the use is wrong"
_DEEPEST = 6  # elements of elements
_WORD = re.compile(r"\w+")


def annotated(script: Script, node: ast.expr, cls: str) -> str:
    """Where the script says that an expression is of a class, if nothing but that tells: the annotation of a parameter
    that it is, or is an element of, or of what the function returns that it comes of. Empty where more is known.
    """
    name, called = _whole(script, node), cls.rpartition(".")[2]
    if name is not None and called in _annotation_around(script, name):
        return f"`{ast.unparse(node)}` is annotated as `{cls}`"
    for call in [node] if isinstance(node, ast.Call) else _calls_around(script, name) if name else ():
        if called in _annotation_of_result(script, call):
            return f"`{ast.unparse(call.func)}` is annotated to return `{cls}`"
    return ""


def _whole(script: Script, node: ast.expr) -> ast.Name | None:
    """The name of what something is, or is an element of: of ``each`` in ``for each in meshes``, ``meshes``."""
    for _ in range(_DEEPEST):
        match node:
            case ast.Name():
                iterated = _iterated(script, node)
                if iterated is None:
                    return node
                node = iterated
            case ast.Subscript(value=owner):
                node = owner
            case _:
                return None
    return None


@once_for_each
def _iterated(script: Script, node: ast.Name) -> ast.expr | None:
    """What the innermost loop around a name gives it, if nothing else does there."""
    found: tuple[int, ast.expr] | None = None
    for loop in script.all(ast.For, ast.AsyncFor, ast.ListComp, ast.SetComp, ast.GeneratorExp, ast.DictComp):
        if loop.lineno <= node.lineno <= (loop.end_lineno or 0) and (
            found is None or loop.lineno >= found[0]
        ):
            turns = [loop] if isinstance(loop, (ast.For, ast.AsyncFor)) else loop.generators
            given = [
                one.iter for one in turns if isinstance(one.target, ast.Name) and one.target.id == node.id
            ]
            bound = [name for part in walk(loop) for name in bound_names(part)] if given else []
            if bound.count(node.id) == 1:
                found = loop.lineno, given[0]
    return found[1] if found else None


@once_for_each
def _annotation_around(script: Script, node: ast.Name) -> frozenset[str]:
    """The words of the annotation of the parameter that a name stands for; none where the name holds more than that."""
    function = _function_around(script, node)
    argument = _parameters(function).get(node.id) if function else None
    if function is None or argument is None or argument.annotation is None:
        return frozenset()
    return _words(argument.annotation) if _bound_in(script, function).count(node.id) == 1 else frozenset()


@once_for_each
def _calls_around(script: Script, node: ast.Name) -> list[ast.Call]:
    """The calls whose results a name stands for where it is used; none if something else gives it as well."""
    function = _function_around(script, node)
    if function is None:
        return []
    bound = _bound_in(script, function).count(node.id) - (node.id in _parameters(function))
    calls = _calls_in(script, function).get(node.id, [])
    return calls if len(calls) == bound else []


@once_for_each
def _calls_in(_script: Script, function: FunctionDefinition) -> dict[str, list[ast.Call]]:
    """Name → the calls whose results a function gives it."""
    found: dict[str, list[ast.Call]] = {}
    for part in walk(function):
        match part:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call() as call):
                found.setdefault(name, []).append(call)
            case _:
                pass
    return found


def _annotation_of_result(script: Script, call: ast.Call) -> frozenset[str]:
    """The words of the annotation of what a function of the script's own returns."""
    kind = script.type_of(call.func)
    match script.analysis.functions[kind.number] if isinstance(kind, LocalFunction) else None:
        case ast.FunctionDef(returns=ast.expr() as said) | ast.AsyncFunctionDef(returns=ast.expr() as said):
            return _words(said)
        case _:
            return frozenset()


@once_for_each
def _function_around(script: Script, node: ast.Name) -> FunctionDefinition | None:
    """The innermost function around a name that binds it."""
    around = [
        function
        for function in script.all(ast.FunctionDef, ast.AsyncFunctionDef)
        if function.lineno <= node.lineno <= (function.end_lineno or 0)
    ]
    for function in sorted(around, key=lambda one: -one.lineno):
        if node.id in _bound_in(script, function):
            return function
    return None


@once_for_each
def _bound_in(_script: Script, function: FunctionDefinition) -> list[str]:
    """The names that a function binds, its parameters among them, each as often as it does."""
    return [name for part in walk(function) if part is not function for name in bound_names(part)]


def _parameters(function: FunctionDefinition) -> dict[str, ast.arg]:
    given = function.args
    return {argument.arg: argument for argument in (*given.posonlyargs, *given.args, *given.kwonlyargs)}


def _words(annotation: ast.expr) -> frozenset[str]:
    """The last names in an annotation: ``Camera`` of ``bpy.types.Camera | None``, of a quoted one too."""
    found: set[str] = set()
    for part in walk(annotation):
        match part:
            case ast.Name(id=name) | ast.Attribute(attr=name):
                found.add(name)
            case ast.Constant(value=str(text)):
                found.update(_WORD.findall(text))
            case _:
                pass
    return frozenset(found)
