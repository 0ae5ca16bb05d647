"""Where the names of a script are bound, as Python's scopes have it."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_check.syntax.literals import bound_names

if TYPE_CHECKING:
    from collections.abc import Iterator

_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)


@dataclass(slots=True, eq=False)
class _Scope:
    """A module, class, function or comprehension: what it binds, what it reads, and the scope around it."""

    name: str
    around: _Scope | None
    is_class: bool = False
    is_comprehension: bool = False
    bound: set[str] = field(default_factory=set[str])
    elsewhere: set[str] = field(default_factory=set[str])  # said to be global or of a function around
    read: list[ast.Name] = field(default_factory=list[ast.Name])

    def sees(self, name: str) -> bool:
        """Whether a name that is read here is bound here or around, where this looks."""
        scope: _Scope | None = self
        while scope is not None:
            if name in scope.bound and (scope is self or not scope.is_class):
                return True
            scope = scope.around
        return False


@dataclass(frozen=True, slots=True)
class Holder:
    """A function or class that binds a name."""

    name: str
    is_class: bool


def read_out_of_scope(tree: ast.Module) -> Iterator[tuple[ast.Name, list[Holder]]]:
    """Each name that is read where nothing binds it, though other functions or classes bind it: with these."""
    scopes = [_Scope("", None)]
    _fill(scopes[0], tree, scopes)
    module, *others = scopes
    for scope in others:
        module.bound |= scope.elsewhere
    for scope in scopes:
        for node in scope.read:
            if not scope.sees(node.id):
                holders = [
                    Holder(other.name, other.is_class)
                    for other in others
                    if node.id in other.bound and other.name
                ]
                if holders:
                    yield node, [*dict.fromkeys(holders)]


def _fill(scope: _Scope, node: ast.AST, scopes: list[_Scope]) -> None:
    """Adds to a scope what the parts of a node bind and read in it, and to ``scopes`` those within."""
    for part in ast.iter_child_nodes(node):
        _add(scope, part, scopes)


def _add(scope: _Scope, part: ast.AST, scopes: list[_Scope]) -> None:
    match part:
        case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.Lambda():
            _add_function(scope, part, scopes)
        case ast.ClassDef(name=name):
            scope.bound.add(name)
            for outer in (*part.decorator_list, *part.bases, *part.keywords):
                _add(scope, outer, scopes)
            inner = _within(scope, name, scopes)
            inner.is_class = True
            for statement in part.body:
                _add(inner, statement, scopes)
        case ast.ListComp() | ast.SetComp() | ast.DictComp() | ast.GeneratorExp():
            inner = _within(scope, "", scopes)
            inner.is_comprehension = True
            _add(scope, part.generators[0].iter, scopes)
            for child in ast.iter_child_nodes(part):
                _add_of_comprehension(inner, child, part.generators[0].iter, scopes)
        case ast.Global(names=names) | ast.Nonlocal(names=names):
            scope.elsewhere.update(names)
        case ast.NamedExpr(target=target, value=value):
            holder = scope
            while holder.is_comprehension and holder.around is not None:
                holder = holder.around
            holder.bound.add(target.id)
            _add(scope, value, scopes)
        case ast.Name(ctx=ast.Load()):
            scope.read.append(part)
        case _:
            scope.bound.update(bound_names(part))
            _fill(scope, part, scopes)


def _add_of_comprehension(inner: _Scope, child: ast.AST, first: ast.expr, scopes: list[_Scope]) -> None:
    """Adds a part of a comprehension, of which the ``first`` thing to go through belongs to the scope around."""
    if not isinstance(child, ast.comprehension):
        _add(inner, child, scopes)
        return
    for part in ast.iter_child_nodes(child):
        if part is not first:
            _add(inner, part, scopes)


def _add_function(scope: _Scope, function: ast.AST, scopes: list[_Scope]) -> None:
    assert isinstance(function, _FUNCTIONS)
    given = function.args
    parameters = [*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg]
    outer: list[ast.AST | None] = [*given.defaults, *given.kw_defaults]
    name = "" if isinstance(function, ast.Lambda) else function.name
    if not isinstance(function, ast.Lambda):
        scope.bound.add(name)
        outer += [*function.decorator_list, function.returns]
    outer += [parameter.annotation for parameter in parameters if parameter]
    for part in outer:
        if part is not None:
            _add(scope, part, scopes)
    inner = _within(scope, name, scopes)
    inner.bound.update(parameter.arg for parameter in parameters if parameter)
    body = [function.body] if isinstance(function, ast.Lambda) else function.body
    for statement in body:
        _add(inner, statement, scopes)


def _within(scope: _Scope, name: str, scopes: list[_Scope]) -> _Scope:
    """A new scope in another one."""
    inner = _Scope(name, scope)
    scopes.append(inner)
    return inner
