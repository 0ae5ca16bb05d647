"""A script as the rules see it: its text, what the analysis found, and what the base knows."""

from __future__ import annotations

import ast
from bisect import bisect_right
from collections import defaultdict
from dataclasses import dataclass, field
from functools import cached_property, wraps
from typing import TYPE_CHECKING, TypeVar, cast

from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.types import Instance
from kb_check.findings import Edit, Span
from kb_check.running.raised import raised_by
from kb_check.syntax.given_names import given_names
from kb_check.text.source import split_lines

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterator

    from kb_build.flow.analysis import Analysis
    from kb_build.flow.blender.api import Api
    from kb_build.flow.values.types import Resolution, ResolutionKind, Type
    from kb_check.names.known import KnownNames
    from kb_check.registered.package import Package

# The kinds of parts of a script that may stand for what an add-on registers.
REGISTERED: frozenset[ResolutionKind] = frozenset({"attribute", "store", "text", "button", "name"})
_VALUES: frozenset[ResolutionKind] = frozenset({"value", "compared"})
_SIMPLE = (
    ast.Assign, ast.AnnAssign, ast.AugAssign, ast.Expr, ast.Return, ast.Delete, ast.Import, ast.ImportFrom,
)  # fmt: skip
_T = TypeVar("_T")
_Key = TypeVar("_Key", bound="Hashable")
_Node = TypeVar("_Node", bound=ast.AST)


@dataclass(frozen=True)
class Script:
    """One script, analysed for one Blender. ``package`` is what the files beside it register, ``path`` its place among
    them, if it has one.

    ``error`` says why Python cannot parse it; ``tree`` and ``analysis`` are then of the part that could be read.
    ``kept`` is what :func:`once_per_script` and :func:`once_for_each` have found; it goes with the script.
    """

    code: str
    tree: ast.Module
    analysis: Analysis
    api: Api
    names: KnownNames
    package: Package
    version: tuple[int, ...] = field(default=())
    error: SyntaxError | None = None
    path: str = ""
    kept: dict[object, object] = field(
        default_factory=dict[object, object], init=False, repr=False, compare=False
    )

    @cached_property
    def lines(self) -> list[str]:
        """The lines as Python counts them, with their ends."""
        return split_lines(self.code) or [""]

    def all(self, *types: type[_Node]) -> list[_Node]:
        """The nodes of the tree that are of exactly these types, type by type; an outer one before those in it."""
        return [node for kind in types for node in cast("list[_Node]", self._by_type.get(kind, []))]

    @cached_property
    def _by_type(self) -> dict[type[ast.AST], list[ast.AST]]:
        """Every node, but for operators and what only says how another one is used."""
        found: defaultdict[type[ast.AST], list[ast.AST]] = defaultdict(list)
        for node in walk(self.tree):
            found[type(node)].append(node)
        return found

    def resolutions(self, *kinds: ResolutionKind) -> Iterator[Resolution]:
        """What parts of the script stand for, of some kinds (see :class:`flow.types.Resolution`), in order."""
        yield from (row for row in self._in_order if not kinds or row.kind in kinds)

    @cached_property
    def _in_order(self) -> list[Resolution]:
        rows = [*self.analysis.resolutions.values(), *self.analysis.carried]
        return sorted(rows, key=lambda row: (_start(row.node), row.kind))

    def missing(self, *kinds: ResolutionKind) -> Iterator[Resolution]:
        """The parts that surely stand for nothing that this Blender, or the package, has."""
        for row in self.resolutions(*kinds):
            lacking = row.missing and not row.symbols and not row.possible
            if row.kind in _VALUES and row.value in self.package.identifiers:
                continue
            if (
                lacking
                and not row.is_ready_for(*raised_by(row))
                and (row.sure or self._is_former(row))
                and not self._is_given(row)
                and not self._is_of_enabled(row)
            ):
                yield row

    def _is_former(self, row: Resolution) -> bool:
        """Whether a name is one that the likely class of a value, or one below it, has lost, and that nothing in this
        Blender has.
        """
        return (
            row.kind in {"attribute", "store", "text", "button"}
            and row.value not in self.own_names
            and self.names.is_nowhere(row.value)
            and all(self._had(owner, row.value) for owner in row.missing)
        )

    def _had(self, owner: str, name: str) -> bool:
        return any(self.names.had(cls, name) for cls in (owner, *self.api.descendants(owner)))

    @cached_property
    def own_names(self) -> frozenset[str]:
        """The names that the script gives to its classes and their instances."""
        return given_names(self.tree)

    def _is_of_enabled(self, row: Resolution) -> bool:
        """Whether it is what an add-on registers that Blender brings and that a file of the package enables."""
        if row.kind not in REGISTERED:
            return False
        addons = {self.names.addon_of(owner, row.value) for owner in row.missing}
        return "" not in addons and addons <= self.package.brought_addons

    def _is_given(self, row: Resolution) -> bool:
        """Whether the package has it. A name that is put together is hardly one that Blender has lost."""
        if not self.package.has(row.missing, row.value):
            return False
        certain = self.package.has(row.missing, row.value, computed=False)
        return certain or not any(self.names.was(owner, row.value) for owner in row.missing)

    @cached_property
    def calls_of(self) -> dict[ast.expr, ast.Call]:
        """What is called → the call."""
        return {call.func: call for call in self.all(ast.Call)}

    def type_of(self, node: ast.expr) -> Type | None:
        """The type of an expression; None if it was not reached."""
        return self.analysis.types.get(node)

    def class_of(self, node: ast.expr) -> str:
        """The class of the API that an expression surely is an instance of; empty where it may be another."""
        kind = self.type_of(node)
        return kind.cls if isinstance(kind, Instance) and kind.sure else ""

    def is_doubted(self, span: Span) -> bool:
        """Whether what stands here may be for another Blender: the script asks for the version in an open way."""
        at = bisect_right(self._doubted, (span.line, span.column), key=_begin) - 1
        return at >= 0 and (span.end_line, span.end_column) <= _end(self._doubted[at])

    @cached_property
    def _doubted(self) -> list[Span]:
        """The doubted parts in order, without those that lie in others."""
        found: list[Span] = []
        parts = (*self.analysis.doubted, *self._behind_failures())
        for span in sorted(map(self.span, parts), key=lambda one: (_begin(one), [-n for n in _end(one)])):
            if not found or _end(span) > _end(found[-1]):
                found.append(span)
        return found

    def _behind_failures(self) -> Iterator[ast.stmt]:
        """The statements that this Blender does not reach: the handlers of their ``try`` catch an error before them."""
        failing = {
            row.statement
            for row in self._in_order
            if row.missing and row.sure and row.caught and not (row.symbols or row.possible)
            if row.is_ready_for(*raised_by(row))
        }
        for node in self.all(ast.Try, ast.TryStar) if failing else ():
            at = next((at for at, statement in enumerate(node.body) if statement in failing), len(node.body))
            yield from node.body[at + 1 :]

    def span(self, node: ast.AST) -> Span:
        """Where a node stands."""
        line, column = _start(node)
        end_line: int = getattr(node, "end_lineno", None) or line
        end: int = getattr(node, "end_col_offset", None) or column
        return Span(line, self._characters(line, column), end_line, self._characters(end_line, end))

    def name_span(self, node: ast.AST) -> Span:
        """Where the name stands that a node ends with (an attribute's), begins with (a keyword's), or defines."""
        whole = self.span(node)
        if isinstance(node, ast.Attribute):
            return Span(whole.end_line, whole.end_column - len(node.attr), whole.end_line, whole.end_column)
        if isinstance(node, ast.keyword) and node.arg:
            return Span(whole.line, whole.column, whole.line, whole.column + len(node.arg))
        if isinstance(node, ast.alias):
            return Span(whole.line, whole.column, whole.line, whole.column + len(node.name))
        if isinstance(node, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
            start = self.lines[whole.line - 1].find(node.name, whole.column + len("def"))
            return Span(whole.line, start, whole.line, start + len(node.name)) if start >= 0 else whole
        return whole

    def text(self, span: Span) -> str:
        """The text of a span."""
        if span.line == span.end_line:
            return self.lines[span.line - 1][span.column : span.end_column]
        first, *middle = self.lines[span.line - 1 : span.end_line]
        return "".join([first[span.column :], *middle[:-1], middle[-1][: span.end_column]])

    def renamed(self, node: ast.AST, name: str) -> Edit | None:
        """The edit that writes another name in the place of a node's; a literal keeps its quotes.

        Of an item its key is written. None where the text is not as plain as it should be.
        """
        if isinstance(node, ast.Subscript):
            node = node.slice
        span = self.name_span(node)
        text = self.text(span)
        if isinstance(node, ast.Constant):
            quote = text[:1]
            plain = len(text) > 1 and quote in "\"'" and text == f"{quote}{node.value}{quote}"
            return Edit(span, f"{quote}{name}{quote}") if plain and quote not in name else None
        written = node.attr if isinstance(node, ast.Attribute) else getattr(node, "arg", None)
        return Edit(span, name) if text == written else None

    def line_before(self, statement: ast.stmt | None, code: str) -> Edit | None:
        """The edit that writes a line of its own before a statement; None where it does not begin a line."""
        if not isinstance(statement, _SIMPLE):
            return None
        start = self.span(statement)
        indent = self.lines[start.line - 1][: start.column]
        return None if indent.strip() else Edit.before(start, f"{code}\n{indent}")

    def as_attribute(self, item: ast.Subscript, name: str) -> Edit:
        """The edit that writes an attribute in the place of an item's brackets."""
        owner, whole = self.span(item.value), self.span(item)
        return Edit(Span(owner.end_line, owner.end_column, whole.end_line, whole.end_column), f".{name}")

    def _characters(self, line: int, column: int) -> int:
        """A column as a number of characters; Python counts the bytes of UTF-8."""
        if line > len(self.lines) or self.lines[line - 1].isascii():
            return column
        ends, extra = self._wide_characters(line)
        before = bisect_right(ends, column)
        return column - (extra[before - 1] if before else 0)

    def _wide_characters(self, line: int) -> tuple[list[int], list[int]]:
        """Where characters of a line end that take several bytes of UTF-8, and how many bytes too many that makes."""
        if line not in self._wide:
            ends: list[int] = []
            extra: list[int] = []
            for place, character in enumerate(self.lines[line - 1], start=1):
                if not character.isascii():
                    more = len(character.encode(errors="surrogatepass")) - 1
                    extra.append(more + (extra[-1] if extra else 0))
                    ends.append(place + extra[-1])
            self._wide[line] = ends, extra
        return self._wide[line]

    @cached_property
    def _wide(self) -> dict[int, tuple[list[int], list[int]]]:
        return {}


def once_per_script(find: Callable[[Script], _T]) -> Callable[[Script], _T]:
    """Has something found once for each script, whichever rules ask for it."""

    @wraps(find)
    def found(script: Script) -> _T:
        if find not in script.kept:
            script.kept[find] = find(script)
        return cast("_T", script.kept[find])

    return found


def once_for_each(find: Callable[[Script, _Key], _T]) -> Callable[[Script, _Key], _T]:
    """Has something found once for each thing in a script that it is asked of, whichever rules ask for it."""

    @wraps(find)
    def found(script: Script, key: _Key) -> _T:
        kept = cast("dict[_Key, _T]", script.kept.setdefault(find, {}))
        if key not in kept:
            kept[key] = find(script, key)
        return kept[key]

    return found


def _begin(span: Span) -> tuple[int, int]:
    return span.line, span.column


def _end(span: Span) -> tuple[int, int]:
    return span.end_line, span.end_column


def _start(node: ast.AST) -> tuple[int, int]:
    return getattr(node, "lineno", 1), getattr(node, "col_offset", 0)
