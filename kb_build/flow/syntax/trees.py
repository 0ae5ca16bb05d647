"""Goes through the syntax trees of scripts."""

from __future__ import annotations

import ast
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

# What stands in no place of its own: texts and numbers, how a name is used, operators.
_NO_NODES = frozenset(
    {
        "id",
        "name",
        "str",
        "attr",
        "arg",
        "kind",
        "level",
        "module",
        "asname",
        "rest",
        "type_comment",
        "tag",
        "conversion",
        "is_async",
        "simple",
        "ctx",
        "op",
        "ops",
    }
)


class _Fields(dict[type[ast.AST], tuple[str, ...]]):
    """Class of nodes → its fields that may hold nodes with a place of their own."""

    def __missing__(self, kind: type[ast.AST]) -> tuple[str, ...]:
        fields = self[kind] = tuple(name for name in kind._fields if name not in _NO_NODES)
        return fields


# Where fields of the same names hold texts, or a value.
_FIELDS = _Fields(dict.fromkeys((ast.Constant, ast.MatchSingleton, ast.Global, ast.Nonlocal), ()))
_FIELDS[ast.MatchClass] = ("cls", "patterns", "kwd_patterns")
if sys.version_info >= (3, 12):
    _FIELDS[ast.TypeAlias] = ("name", "type_params", "value")
# What is defined where it stands, and run elsewhere.
APART = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef)
# Methods that take something out of a list or a dictionary.
TAKING_OUT = frozenset({"clear", "pop", "popitem", "remove"})
# Lists in which None stands for what is not there; others hold nodes alone.
_WITH_GAPS = frozenset({"keys", "kw_defaults"})


def children(node: ast.AST) -> list[ast.AST]:
    """The nodes right below one, like ast.iter_child_nodes, which takes three times as long; without operators and
    without how names are used.
    """
    found: list[ast.AST] = []
    for name in _FIELDS[type(node)]:
        value = getattr(node, name, None)
        if value is None:
            continue
        if type(value) is not list:
            found.append(value)
        elif name in _WITH_GAPS:
            found += [each for each in value if each is not None]
        else:
            found += value
    return found


def called_name(node: ast.AST) -> str:
    """The last name of what a node calls: ``exit`` of ``sys.exit()``; empty where it calls nothing that has a name."""
    match node:
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)):
            return name
        case _:
            return ""


def walk(node: ast.AST) -> Iterator[ast.AST]:
    """A node and all below it, in the order of ast.walk; without operators and without how names are used, as
    :func:`children`. Those are fields of the nodes that have them: ``node.op``, ``node.ctx``.
    """
    waiting = [node]
    for each in waiting:
        waiting += children(each)
        yield each


def run_with(parts: Iterable[ast.AST]) -> Iterator[ast.AST]:
    """Some parts of a tree and all below them, but for what is only defined there: the bodies of functions, classes."""
    waiting = [*parts]
    for each in waiting:
        yield each
        if not isinstance(each, APART):
            waiting += children(each)


def nodes_in(parts: Iterable[ast.AST]) -> set[ast.AST]:
    """The nodes of some of a tree's parts, which may lie in each other, and of all below them."""
    found: set[ast.AST] = set()
    waiting = [*parts]
    while waiting:
        node = waiting.pop()
        if node not in found:
            found.add(node)
            waiting += children(node)
    return found


def taken_out_of(node: ast.AST) -> frozenset[str]:
    """The names that a function takes something out of: lists and dictionaries."""
    found: set[str] = set()
    for part in walk(node):
        match part:
            case ast.Attribute(value=ast.Name(id=name), attr=attr) if attr in TAKING_OUT:
                found.add(name)
            case ast.Subscript(value=ast.Name(id=name), ctx=ast.Del()):
                found.add(name)
            case _:
                pass
    return frozenset(found)


def default_values(arguments: ast.arguments) -> dict[str, ast.expr]:
    """Parameter → the value that it has by default, for those that have one."""
    found: dict[str, ast.expr] = {}
    positional = [*arguments.posonlyargs, *arguments.args]
    for argument, default in zip(reversed(positional), reversed(arguments.defaults), strict=False):
        found[argument.arg] = default
    for argument, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True):
        if default is not None:
            found[argument.arg] = default
    return found
