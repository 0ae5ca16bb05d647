"""Parameters whose type rests on nothing but what the script says of it: an annotation, which Python does not check."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.trees import walk
from kb_check.script import once_for_each
from kb_check.syntax.literals import bound_names

if TYPE_CHECKING:
    from kb_check.script import Script
    from kb_check.syntax.definitions import FunctionDefinition

ONE_IS_WRONG = "the annotation or the use is wrong"
_DEEPEST = 6  # elements of elements
_WORD = re.compile(r"\w+")


def is_annotated(script: Script, node: ast.expr, cls: str) -> bool:
    """Whether an expression is a parameter, or an element of one, that is of a class by its annotation alone."""
    name = _whole(script, node)
    return name is not None and cls.rpartition(".")[2] in _annotation_around(script, name)


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
    around = [
        function
        for function in script.all(ast.FunctionDef, ast.AsyncFunctionDef)
        if function.lineno <= node.lineno <= (function.end_lineno or 0)
    ]
    for function in sorted(around, key=lambda one: -one.lineno):
        if node.id in _bound_in(script, function):
            argument = _parameters(function).get(node.id)
            once = _bound_in(script, function).count(node.id) == 1
            return _words(argument.annotation) if argument and argument.annotation and once else frozenset()
    return frozenset()


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
