"""What happens when a script is run as a whole: which of its parts that surely comes to, and whether it may add to the
API.

A name that does not exist is an error only where the run comes by. It need not come to what stands behind a condition,
in a loop that may have no turn, or behind what may leave before; nor to what Blender calls (an operator's ``execute``,
a handler) and what nobody calls. What is tried is not counted either: the script is ready for its errors.
"""

from __future__ import annotations

import ast
import sys
from bisect import bisect_right
from typing import TYPE_CHECKING, NamedTuple

from kb_build.flow.evaluation.expressions import is_decided
from kb_build.flow.syntax.trees import APART, called_name, children, run_with, walk
from kb_build.flow.values.types import UNKNOWN, LocalClass, LocalFunction, literal
from kb_check.running.computing import RUNNING, STORING
from kb_check.running.context_managers import passes_errors
from kb_check.syntax.definitions import FunctionDefinition

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from kb_build.flow.analysis import Analysis
    from kb_build.flow.values.types import Type


# Names that can give Blender's API more than the text shows.
_BRINGING = RUNNING | STORING | frozenset(
    {
        # code that is not in the text
        "import_module", "run_path", "run_module", "exec_module", "python_file_run",
        # a class whose name is not written down
        "new_class",
        # add-ons and extensions
        "addon_utils", "addon_enable", "addon_install", "addon_refresh", "extensions", "load_scripts",
        "modules_from_path",
    }
)  # fmt: skip
_PACKAGES = frozenset({"numpy", "__future__"})  # that Blender brings, and that leave its API alone
_LEAVING = frozenset({"exit", "quit", "_exit", "quit_blender"})
_LOOPS = (ast.For, ast.AsyncFor, ast.While)


class RunReach:
    """Which parts a run of a script surely comes to, as far as its text tells.

    With its analysis, calls of methods are known, and the conditions that this Blender decides.
    """

    def __init__(self, tree: ast.Module, analysis: Analysis | None = None) -> None:
        self._tree = tree
        self._analysis = analysis
        self._functions = _plain_functions(tree)
        self._leaving = _leaving(tree)
        self._sure: set[ast.AST] = {tree}
        self._bodies: list[Sequence[ast.stmt]] = [tree.body]
        self._called: set[FunctionDefinition] = set()
        self._parts: dict[ast.AST, list[_Part]] = {}
        while self._bodies:
            self._block(self._bodies.pop())

    def comes_to(self, line: int, column: int) -> bool:
        """Whether the run surely comes to a place; its column counts in bytes of UTF-8, as Python's trees do."""
        node: ast.AST | None = self._tree
        while node is not None:
            if node not in self._sure:
                return False
            node = self._part_at(node, (line, column))
        return True

    def _part_at(self, node: ast.AST, place: tuple[int, int]) -> ast.AST | None:
        """The node right below one that holds a place."""
        if (parts := self._parts.get(node)) is None:
            parts = self._parts[node] = sorted(map(_Part.of, _placed(node)), key=_Part.begin)
        at = bisect_right(parts, place, key=_Part.begin) - 1
        return parts[at].node if at >= 0 and place < parts[at].end else None

    def _block(self, statements: Sequence[ast.stmt]) -> None:
        """Marks what is surely come to of statements that follow each other, the first of which is."""
        for statement in statements:
            self._statement(statement)
            if statement in self._leaving:
                return

    def _statement(self, node: ast.stmt) -> None:
        self._sure.add(node)
        blocks: list[Sequence[ast.stmt]] = []
        match node:
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                self._expressions([*node.decorator_list, *node.args.defaults, *node.args.kw_defaults])
                return
            case ast.If():
                holds = self._truth(node.test)
                blocks = [] if holds is None else [node.body if holds else node.orelse]
            case ast.While():
                blocks = [node.body] if self._truth(node.test) else []
            case ast.For():
                blocks = [node.body] if self._has_turns(node.iter) else []
            case ast.With():
                blocks = [node.body] if passes_errors(node) else []
            case ast.Try() | ast.TryStar():
                blocks = [node.finalbody] if node.handlers else [node.body, node.finalbody]
            case ast.ClassDef():
                blocks = [node.body]
            case _:
                pass
        self._expressions(_own_expressions(node))
        self._bodies += blocks

    def _expressions(self, nodes: Iterable[ast.AST | None]) -> None:
        """Marks expressions that are surely evaluated, with those in them that are."""
        waiting = [node for node in nodes if node is not None]
        while waiting:
            node = waiting.pop()
            self._sure.add(node)
            match node:
                case ast.BoolOp():
                    waiting.append(node.values[0])
                case ast.IfExp():
                    holds = self._truth(node.test)
                    waiting += [node.test, *([] if holds is None else [node.body if holds else node.orelse])]
                case ast.Compare():
                    waiting += [node.left, node.comparators[0]]
                case ast.Lambda():
                    waiting += (part for part in (*node.args.defaults, *node.args.kw_defaults) if part)
                case ast.ListComp() | ast.SetComp() | ast.DictComp() | ast.GeneratorExp():
                    waiting += self._of_comprehension(node)
                case ast.Call():
                    waiting += children(node)
                    self._call(node)
                case _:
                    waiting += children(node)

    def _of_comprehension(
        self, node: ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp
    ) -> list[ast.expr]:
        first, *others = node.generators
        if isinstance(node, ast.GeneratorExp) or others or first.ifs or not self._has_turns(first.iter):
            return [first.iter]
        held = [node.key, node.value] if isinstance(node, ast.DictComp) else [node.elt]
        return [first.iter, first.target, *held]

    def _call(self, node: ast.Call) -> None:
        """Has the body of a function of the script looked at that is surely called."""
        function = self._callee(node.func)
        if isinstance(function, ast.FunctionDef) and function not in self._called and not _yields(function):
            self._called.add(function)
            self._bodies.append(function.body)

    def _callee(self, node: ast.expr) -> ast.AST | None:
        kind = self._type(node)
        if self._analysis is not None and isinstance(kind, LocalFunction):
            return self._analysis.functions[kind.number]
        if self._analysis is not None and isinstance(kind, LocalClass):
            body = self._analysis.classes[kind.number].body
            return next(
                (item for item in body if isinstance(item, FunctionDefinition) and item.name == "__init__"),
                None,
            )
        return self._functions.get(node.id) if isinstance(node, ast.Name) else None

    def _type(self, node: ast.expr) -> Type:
        return self._analysis.types.get(node, UNKNOWN) if self._analysis is not None else UNKNOWN

    def _truth(self, test: ast.expr) -> bool | None:
        """Whether a condition surely holds, or surely does not."""
        match test:
            case ast.Constant():
                return bool(test.value)
            case ast.Compare(
                left=ast.Name(id="__name__"), ops=[ast.Eq()], comparators=[ast.Constant(value="__main__")]
            ):
                return True
            case _:
                kind = self._type(test)
                return literal(kind) is True if is_decided(kind) else None

    def _has_turns(self, node: ast.expr) -> bool:
        """Whether a loop over a value surely has a turn."""
        match node:
            case ast.Tuple(elts=items) | ast.List(elts=items) | ast.Set(elts=items):
                return any(not isinstance(item, ast.Starred) for item in items)
            case ast.Call(func=ast.Name(id="range"), args=[_, *_] as bounds, keywords=[]):
                numbers = [
                    bound.value if isinstance(bound, ast.Constant) else literal(self._type(bound))
                    for bound in bounds
                ]
                whole = [number for number in numbers if isinstance(number, int)]
                return len(whole) == len(numbers) and 0 not in whole[2:] and len(range(*whole[:3])) > 0
            case ast.Call(
                func=ast.Name(id="enumerate" | "reversed" | "sorted" | "list" | "tuple"), args=[first, *_]
            ):
                return self._has_turns(first)
            case _:
                return False


def _leaving(tree: ast.Module) -> set[ast.AST]:
    """The nodes after which what follows them may be left out, without an error."""
    returning: set[ast.AST] = set()
    breaking: set[ast.AST] = set()
    for node in reversed([*walk(tree)]):  # inner ones come before those around them
        if isinstance(node, APART):
            continue
        below = children(node)
        if isinstance(node, ast.Return) or called_name(node) in _LEAVING or not returning.isdisjoint(below):
            returning.add(node)
        if isinstance(node, (ast.Break, ast.Continue)) or (
            not isinstance(node, _LOOPS) and not breaking.isdisjoint(below)
        ):
            breaking.add(node)
    return returning | breaking


def _plain_functions(tree: ast.Module) -> dict[str, FunctionDefinition]:
    """The functions of the module itself whose name is given once, by name."""
    found: dict[str, list[FunctionDefinition | None]] = {}
    for node in walk(tree):
        match node:
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name):
                is_plain = node in tree.body and not node.decorator_list
                found.setdefault(name, []).append(node if is_plain else None)
            case ast.ClassDef(name=name) | ast.Name(id=name, ctx=ast.Store()) | ast.arg(arg=name):
                found.setdefault(name, []).append(None)
            case ast.alias():
                found.setdefault(node.asname or node.name, []).append(None)
            case _:
                pass
    return {name: rows[0] for name, rows in found.items() if len(rows) == 1 and rows[0] is not None}


def _own_expressions(node: ast.stmt) -> Iterator[ast.AST]:
    """What a statement evaluates itself, before the statements in it."""
    if isinstance(node, ast.Match):
        yield node.subject
        return
    for part in children(node):
        if isinstance(part, ast.withitem):
            yield from children(part)
        elif isinstance(part, (ast.expr, ast.keyword, ast.alias)):
            yield part


def _placed(node: ast.AST) -> Iterator[ast.AST]:
    """The nodes right below one that have a place of their own."""
    waiting = children(node)
    while waiting:
        part = waiting.pop()
        if hasattr(part, "lineno"):
            yield part
        else:
            waiting += children(part)


class _Part(NamedTuple):
    """A node, and where it begins, with what decorates it, and ends. Those right below another one lie side by side."""

    start: tuple[int, int]
    end: tuple[int, int]
    node: ast.AST

    @classmethod
    def of(cls, node: ast.AST) -> _Part:
        first = min([node, *getattr(node, "decorator_list", ())], key=lambda part: getattr(part, "lineno", 0))
        start: tuple[int, int] = getattr(first, "lineno", 0), getattr(first, "col_offset", 0)
        end: tuple[int, int] = getattr(node, "end_lineno", 0), getattr(node, "end_col_offset", 0)
        return cls(start, end, node)

    def begin(self) -> tuple[int, int]:
        return self.start


def _yields(function: ast.FunctionDef) -> bool:
    """Whether a call only makes an iterator."""
    return any(isinstance(node, (ast.Yield, ast.YieldFrom)) for node in run_with(function.body))


def may_bring_names(tree: ast.Module, is_known: Callable[[str], bool]) -> bool:
    """Whether a script may give Blender's API names that its text does not show: by an add-on that it enables, say.

    ``is_known`` tells whether a module is one of Blender's.
    """
    return any(_brings(node, is_known) for node in walk(tree))


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
