"""Writes changes into statements: alone, or beside the old form under a condition on Blender's version."""

from __future__ import annotations

import ast
from bisect import bisect_right
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import children
from kb_check.findings import Edit, Span

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_check.migrate.change import Change, Version
    from kb_check.migrate.place import Place
    from kb_check.text.edits import Text

_BLOCKS = ("body", "orelse", "finalbody", "handlers", "cases")
_OPENS = (
    ast.If, ast.For, ast.While, ast.With, ast.Try, ast.TryStar, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef,
    ast.AsyncFor, ast.AsyncWith, ast.Match,
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Guarded:
    """A statement with the edits that need a guard: (first version with the new form, edit)."""

    statement: ast.stmt
    edits: tuple[tuple[Version, Edit], ...]

    @property
    def boundaries(self) -> tuple[Version, ...]:
        """The versions at which the statement changes, newest first."""
        return tuple(sorted({since for since, _ in self.edits}, reverse=True))


def innermost(place: Place, span: Span) -> ast.stmt | None:
    """The innermost statement that a span lies in."""
    found: ast.stmt | None = None
    level: Sequence[ast.AST] = place.script.tree.body
    while level:
        holder = _holder(place, level, span)
        if isinstance(holder, ast.stmt):
            found = holder
        level = _inner(holder) if holder is not None else ()
    return found


def _holder(place: Place, level: Sequence[ast.AST], span: Span) -> ast.AST | None:
    """The one of some nodes, in the order of the text, that a span lies in."""
    at = bisect_right(level, span.line, key=lambda node: getattr(node, "lineno", 0))
    while (
        at > 0
        and getattr(level[at - 1], "lineno", 0) == span.line
        and not _covers(place, level[at - 1], span)
    ):
        at -= 1  # several on a line
    candidate = level[at - 1] if at else None
    return candidate if candidate is not None and _covers(place, candidate, span) else None


def _inner(node: ast.AST) -> list[ast.AST]:
    """The statements, handlers and cases within a node, in the order of the text."""
    found: list[ast.AST] = []
    for name in _BLOCKS:
        for child in getattr(node, name, None) or ():
            if isinstance(child, ast.match_case):
                found += child.body
            elif isinstance(child, ast.AST):
                found.append(child)
    return sorted(found, key=lambda child: getattr(child, "lineno", 0))


def _covers(place: Place, node: ast.AST, span: Span) -> bool:
    own = place.script.span(node)
    start, end = (own.line, own.column), (own.end_line, own.end_column)
    return start <= (span.line, span.column) and (span.end_line, span.end_column) <= end


def can_be_guarded(place: Place, change: Change) -> bool:
    """Whether the old form can stay beside the new one."""
    for edit in change.edits:
        statement = innermost(place, edit.span)
        if statement is None or not place.knows_bpy(statement):
            return False
        if not _alone(place, statement) and _expression(place, statement, edit.span) is None:
            return False
    return True


def guarded_edits(place: Place, text: Text, changes: Sequence[Change]) -> list[Edit]:
    """The edits that write changes beside the old forms. Every change can be guarded."""
    by_statement: dict[ast.stmt, list[tuple[Version, Edit]]] = {}
    edits: list[Edit] = []
    for change in changes:
        for edit in change.edits:
            statement = innermost(place, edit.span)
            assert statement is not None
            if _alone(place, statement):
                by_statement.setdefault(statement, []).append((change.since, edit))
            else:
                edits.append(_conditional(place, text, statement, change.since, edit))
    statements = [Guarded(statement, tuple(held)) for statement, held in by_statement.items()]
    statements.sort(key=lambda one: one.statement.lineno)
    edits += [_branches(place, text, group) for group in _groups(place, statements)]
    return edits


def _alone(place: Place, statement: ast.stmt) -> bool:
    """Whether a simple statement has its lines for itself."""
    if isinstance(statement, _OPENS):
        return False
    return place.has_line(statement)


def _groups(place: Place, statements: Sequence[Guarded]) -> Iterator[list[Guarded]]:
    """Statements that follow each other, line upon line, and change at the same versions."""
    group: list[Guarded] = []
    for one in statements:
        if group and (
            one.boundaries != group[-1].boundaries
            or place.parent(one.statement) is not place.parent(group[-1].statement)
            or one.statement.lineno != (group[-1].statement.end_lineno or 0) + 1
            or place.body_of(one.statement) is not place.body_of(group[-1].statement)
        ):
            yield group
            group = []
        group.append(one)
    if group:
        yield group


def _branches(place: Place, text: Text, group: Sequence[Guarded]) -> Edit:
    """``if version >= …: new, else: old`` in the place of a group of statements."""
    first, last = place.script.span(group[0].statement), place.script.span(group[-1].statement)
    margin = place.margin(group[0].statement)
    unit = _unit(place)
    blocks: list[tuple[str, str]] = []
    for since in group[0].boundaries:
        made = [_written(place, text, one, since) for one in group]
        blocks.append(
            (f"{place.bpy}.app.version >= ({since[0]}, {since[1]}, 0)", _joined(made, margin, unit))
        )
    old = _joined([_written(place, text, one, None) for one in group], margin, unit)
    if len(blocks) == 1 and blocks[0][1].strip() == "pass":
        lines = [f"if {blocks[0][0].replace('>=', '<')}:", old]
    else:
        lines = []
        for word, (test, body) in zip(("if", *["elif"] * len(blocks)), blocks, strict=False):
            lines += [f"{margin if lines else ''}{word} {test}:", body]
        lines += [f"{margin}else:", old]
    return Edit(Span(first.line, first.column, last.end_line, last.end_column), "\n".join(lines))


def _written(place: Place, text: Text, one: Guarded, since: Version | None) -> str:
    """A statement with the edits that a version needs; as it was for None."""
    span = place.script.span(one.statement)
    chosen = [edit for version, edit in one.edits if since is not None and version <= since]
    return edited_part(text, span, chosen)


def edited_part(text: Text, span: Span, edits: Sequence[Edit]) -> str:
    """The text of a span after the edits within it."""
    start, end = text.offsets(span)
    code = text.code[start:end]
    for edit in sorted(edits, key=lambda one: text.offsets(one.span), reverse=True):
        first, last = text.offsets(edit.span)
        code = code[: first - start] + edit.text + code[last - start :]
    return code


def _joined(statements: Sequence[str], margin: str, unit: str) -> str:
    """Statements as the body of a branch; those that do nothing only where nothing else is there."""
    kept = [statement for statement in statements if statement != "pass"] or ["pass"]
    return "\n".join(_indented(statement, margin, unit) for statement in kept)


def _indented(statement: str, margin: str, unit: str) -> str:
    first, *rest = statement.split("\n")
    if any(mark in statement for mark in ('"""', "'''")):  # lines of a text must stay as they are
        return "\n".join([f"{margin}{unit}{first}", *rest])
    return "\n".join([f"{margin}{unit}{first}", *(unit + line if line.strip() else line for line in rest)])


def _unit(place: Place) -> str:
    """What the script indents by."""
    for node in place.script.tree.body:
        for child in _inner(node):
            lines = place.script.lines
            line = lines[child.lineno - 1] if isinstance(child, ast.stmt) else ""
            if indent := line[: len(line) - len(line.lstrip(" \t"))]:
                return indent
    return "    "


def _expression(place: Place, statement: ast.stmt, span: Span) -> ast.expr | None:
    """The smallest expression around a span that is read, not assigned, and stands outside of formatted text."""
    best: ast.expr | None = None
    stack: list[ast.AST] = [
        child for child in children(statement)
        if not isinstance(child, (ast.stmt, ast.excepthandler, ast.match_case))
    ]  # fmt: skip
    while stack:
        node = stack.pop()
        if isinstance(node, ast.JoinedStr):
            continue
        inside = not hasattr(node, "lineno") or _covers(place, node, span)
        if not inside:
            continue
        stored = isinstance(getattr(node, "ctx", None), (ast.Store, ast.Del))
        if isinstance(node, ast.expr) and not stored and not isinstance(node, ast.Starred):
            best = node
        stack.extend(children(node))
    return best


def _conditional(place: Place, text: Text, statement: ast.stmt, since: Version, edit: Edit) -> Edit:
    node = _expression(place, statement, edit.span)
    assert node is not None
    span = place.script.span(node)
    new, old = edited_part(text, span, [edit]), text.part(span)
    test = f"{place.bpy}.app.version >= ({since[0]}, {since[1]}, 0)"
    return Edit(span, f"({new} if {test} else {old})")


def plain_edits(place: Place, change: Change) -> list[Edit]:
    """The edits of a change that needs no guard; a statement that goes takes its line with it where it can."""
    return [_with_line(place, edit) if edit.text == "pass" else edit for edit in change.edits]


def _with_line(place: Place, edit: Edit) -> Edit:
    statement = innermost(place, edit.span)
    if statement is None or place.script.span(statement) != edit.span or not _alone(place, statement):
        return edit
    lines = place.script.lines
    span = edit.span
    if len(place.body_of(statement)) < 2 or lines[span.end_line - 1][span.end_column :].strip():
        return edit
    if not lines[span.end_line - 1].endswith("\n"):
        return edit
    return replace(edit, span=Span(span.line, 0, span.end_line + 1, 0), text="")
