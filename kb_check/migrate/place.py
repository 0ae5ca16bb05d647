"""A script as the rewrites see it: what is gone from it, and ways to write the edits."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import children, walk
from kb_build.flow.values.types import Instance, members, without_none
from kb_check.findings import Edit, Span
from kb_check.migrate.change import Change, Version
from kb_check.syntax.bodies import bodies_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_build.flow.values.types import Resolution
    from kb_check.findings import Finding
    from kb_check.script import Script

_NEWEST = (99, 0)
_ATOMS = (ast.Name, ast.Constant, ast.Attribute, ast.Call, ast.Subscript, ast.Tuple, ast.List, ast.Dict)


class Place:
    """One script, what the rules found in it, and the oldest Blender that it seems to be written for; ``source`` is the
    one that it is said to be written for.
    """

    def __init__(
        self, script: Script, findings: Sequence[Finding], written_for: Version, source: Version | None = None
    ) -> None:
        self.script = script
        self.findings = findings
        self.written_for = written_for
        self.source = source
        self.target: Version = (script.version[0], script.version[1])

    @cached_property
    def parents(self) -> dict[ast.AST, ast.AST]:
        """Node → the node around it; not of operators, nor of what says how a node is used."""
        return {child: node for node in walk(self.script.tree) for child in children(node)}

    def stores(self, name: str) -> list[ast.Name]:
        """Where the script gives a name a value."""
        return [
            node for node in self.script.all(ast.Name) if node.id == name and isinstance(node.ctx, ast.Store)
        ]

    @cached_property
    def _gone(self) -> dict[str, list[Resolution]]:
        """Symbol that a finding is about → the parts of the script that name it."""
        rows = {self.script.name_span(row.node): row for row in self.script.resolutions() if row.missing}
        found: dict[str, list[Resolution]] = defaultdict(list)
        for finding in self.findings:
            if finding.symbol and (row := rows.get(finding.span)):
                found[finding.symbol].append(row)
        return found

    def gone(self, *symbols: str) -> Iterator[tuple[Resolution, str]]:
        """The parts of the script that name one of some symbols which this Blender lacks."""
        for symbol in symbols:
            for row in self._gone.get(symbol, ()):
                yield row, symbol

    def gone_like(self, pattern: str) -> Iterator[tuple[Resolution, re.Match[str]]]:
        """The same for the symbols that match a regular expression as a whole."""
        for symbol, rows in self._gone.items():
            if match := re.fullmatch(pattern, symbol):
                for row in rows:
                    yield row, match

    # What is where.

    def parent(self, node: ast.AST) -> ast.AST | None:
        """The node around a node."""
        return self.parents.get(node)

    def statement(self, node: ast.AST) -> ast.stmt:
        """The innermost statement around a node."""
        found: ast.AST | None = node
        while found is not None and not isinstance(found, ast.stmt):
            found = self.parents.get(found)
        assert found is not None
        return found

    def stored_value(self, node: ast.AST) -> ast.expr | None:
        """What a node is set to where that is all that its statement does; else None."""
        statement = self.parents.get(node)
        if isinstance(statement, ast.Assign) and statement.targets == [node]:
            return statement.value
        return None

    def thrown_away(self, node: ast.AST) -> ast.Expr | None:
        """The statement that is nothing but this call; else None."""
        statement = self.parents.get(node)
        return statement if isinstance(statement, ast.Expr) else None

    def body_of(self, statement: ast.AST) -> list[ast.stmt]:
        """The statements that a statement stands among."""
        around = self.parents.get(statement)
        return next((body for body in bodies_of(around) if statement in body), []) if around else []

    def is_a(self, node: ast.expr, *classes: str) -> bool:
        """Whether an expression is surely an instance of one of some classes, or of what derives from them."""
        kind = self.script.type_of(node)
        if kind is None:
            return False
        found = members(without_none(kind))
        return bool(found) and all(
            isinstance(member, Instance)
            and member.sure
            and any(self.script.api.descends(member.cls, cls) for cls in classes)
            for member in found
        )

    def has_line(self, statement: ast.stmt) -> bool:
        """Whether a statement begins its line, and nothing but a comment follows it."""
        span = self.script.span(statement)
        lines = self.script.lines
        after = lines[span.end_line - 1][span.end_column :].strip()
        return not self.margin(statement).strip() and (not after or after.startswith("#"))

    def margin(self, statement: ast.stmt) -> str:
        """What stands before a statement on its line."""
        span = self.script.span(statement)
        return self.script.lines[span.line - 1][: span.column]

    # Text.

    def text(self, node: ast.AST) -> str:
        """A node as it is written."""
        return self.script.text(self.script.span(node))

    def operand(self, node: ast.expr) -> str:
        """An expression as it can be written where an operand or the owner of an attribute is expected."""
        text = self.text(node)
        plain = isinstance(node, _ATOMS) and not (
            isinstance(node, ast.Constant) and not isinstance(node.value, str)
        )
        return text if plain else f"({text})"

    def argument(self, node: ast.expr) -> str:
        """An expression as it can be written as an argument."""
        text = self.text(node)
        spread = isinstance(node, (ast.Tuple, ast.NamedExpr, ast.GeneratorExp, ast.Yield))
        return f"({text})" if spread and not text.startswith("(") else text

    def write(self, node: ast.AST, text: str) -> Edit:
        """The edit that writes something else in the place of a node."""
        return Edit(self.script.span(node), text)

    def delete(self, statement: ast.stmt) -> Edit:
        """The edit that leaves a statement out. (``pass`` vanishes where something else stands beside it.)"""
        return self.write(statement, "pass")

    def between(self, first: ast.AST, second: ast.AST) -> tuple[Span, str]:
        """The text between two nodes."""
        one, two = self.script.span(first), self.script.span(second)
        span = Span(one.end_line, one.end_column, two.line, two.column)
        return span, self.script.text(span)

    def without_keyword(self, call: ast.Call, keyword: ast.keyword) -> Edit | None:
        """The edit that takes a keyword out of a call, with its comma."""
        parts = in_order([*call.args, *call.keywords])
        at = parts.index(keyword)
        here = self.script.span(keyword)
        if at:
            span = self.script.span(parts[at - 1])
            span = Span(span.end_line, span.end_column, here.end_line, here.end_column)
            skipped, _ = self.between(parts[at - 1], keyword)
        elif len(parts) > 1:
            after = self.script.span(parts[1])
            span = Span(here.line, here.column, after.line, after.column)
            skipped, _ = self.between(keyword, parts[1])
        else:
            return Edit(here, "")
        return Edit(span, "") if self.script.text(skipped).strip() == "," else None

    @property
    def bpy(self) -> str:
        """The name by which the script's own top level knows ``bpy``; empty if it does not."""
        return self._bpy_import[0]

    def knows_bpy(self, statement: ast.stmt) -> bool:
        """Whether a statement stands below the import that brings ``bpy``."""
        return bool(self.bpy) and statement.lineno > self._bpy_import[1]

    @cached_property
    def _bpy_import(self) -> tuple[str, int]:
        """The name of ``bpy`` at the top level, and the line of its import."""
        for node in self.script.tree.body:
            if isinstance(node, ast.Import):
                for alias in node.names:
                    if alias.name == "bpy" or (alias.name.startswith("bpy.") and not alias.asname):
                        return alias.asname or "bpy", node.lineno
        return "", 0

    def add_import(self, line: str) -> tuple[Edit, ...]:
        """The edit that adds an import below the script's first one; none where it is there already."""
        imports = [node for node in self.script.tree.body if isinstance(node, (ast.Import, ast.ImportFrom))]
        if not imports or any(self.text(node) == line for node in imports):
            return ()
        last = imports[0]
        for node in imports:
            if isinstance(node, ast.Import) and any(alias.name == "bpy" for alias in node.names):
                last = node
        return (Edit.behind(self.script.span(last), f"\n{line}"),)

    # Changes.

    def change(  # noqa: PLR0913 - what a change is
        self,
        rule: str,
        symbol: str,
        edits: Sequence[Edit],
        *,
        reason: str = "",
        targets: Sequence[str] = (),
        additions: Sequence[Edit] = (),
        is_deprecated: bool = False,
    ) -> Change:
        """A change because of a symbol that is gone, or deprecated; its reason and source are the base's where none is
        given.
        """
        reader = self.script.names.reader
        successors = reader.history.successors(symbol)
        removed = reader.history.removed(symbol)
        told = reason or next((row.how for row in successors if row.how), "") or f"{symbol} is gone."
        source = successors[0].source if successors else ""
        uses = tuple(targets) or tuple(row.target for row in successors if row.target)[:1]
        since: Version = (0, 0)
        if removed:
            since = version_of(successors[0].version if successors else removed[2])
        else:
            since = max(
                (version_of(reader.history.arrival(path)[0] or "0.0") for path in uses), default=since
            )
        return Change(
            rule, tuple(edits), told, source, since, uses, tuple(additions), not is_deprecated, symbol
        )


def in_order(nodes: Iterable[ast.expr | ast.keyword]) -> list[ast.expr | ast.keyword]:
    """Arguments as they are written, one after the other."""
    return sorted(nodes, key=lambda node: (node.lineno, node.col_offset))


def version_of(text: str) -> Version:
    """``(5, 0)`` of ``5.0``; of what is no version one that no Blender has yet."""
    found = re.match(r"(\d+)\.(\d+)", text)
    return (int(found[1]), int(found[2])) if found else _NEWEST
