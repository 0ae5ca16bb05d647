"""Where an item or argument stands with the brackets around it alone, which belong to no node of the tree."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_check.findings import Span

if TYPE_CHECKING:
    import ast

    from kb_check.script import Script

_COMMENT = re.compile(r"#.*")
# Behind what stands before: its own brackets, the comma or the call's bracket, and those of the item.
_LEAD = re.compile(r"[\s\\)]*[,(](?P<own>[\s\\(]*)", re.DOTALL)


def bracketed(script: Script, node: ast.expr, before: ast.expr) -> Span:
    """The span of an item or argument with its brackets; ``before`` is the item or argument before it, or the function
    that it is given to.
    """
    own, last = script.span(node), script.span(before)
    gap = Span(last.end_line, last.end_column, own.line, own.column)
    lead = _LEAD.fullmatch(_blank(script.text(gap)))
    count = lead["own"].count("(") if lead else 0
    if lead is None or not count:
        return own
    line, column = _place(script.text(gap), lead.start("own") + lead["own"].index("("), gap)
    rest = Span(own.end_line, own.end_column, len(script.lines), len(script.lines[-1]))
    text = script.text(rest)
    ends = [mark.end() for mark in re.finditer(r"\)", _blank(text))]
    end_line, end_column = _place(text, ends[count - 1], rest)
    return Span(line, column, end_line, end_column)


def _blank(text: str) -> str:
    """A text with blanks for its comments."""
    return _COMMENT.sub(lambda comment: " " * len(comment[0]), text)


def _place(text: str, offset: int, span: Span) -> tuple[int, int]:
    """The line and column of an offset in the text of a span."""
    before = text[:offset]
    lines = before.count("\n")
    return span.line + lines, offset - before.rindex("\n") - 1 if lines else span.column + offset
