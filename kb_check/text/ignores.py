"""Comments that ignore findings: ``# simworlds: ignore[rule]`` on a line, ``ignore-file[rule]`` near the top."""

from __future__ import annotations

import io
import re
import tokenize
from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_check.findings import Edit, Finding, Fix, Span
from kb_check.text.source import split_lines

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

UNUSED = "unused-ignore"
_UNREADABLE = (
    tokenize.TokenError,
    SyntaxError,
    ValueError,
    SystemError,
)  # the last by a fault of CPython 3.13.0's
_MOST_TOP_LINES = 10  # among which a whole file can be ignored
_COMMENT = re.compile(
    r"#\s*+simworlds:\s*+(?P<kind>ignore-file|ignore)(?![\w-])(?:\[(?P<rules>[\w\s,-]*+)\])?"
)


@dataclass(slots=True)
class _Comment:
    """``rules`` is None where all are ignored; ``used`` are those that were found on its lines."""

    span: Span
    text: str
    whole_file: bool
    rules: frozenset[str] | None
    used: set[str]

    def ignores(self, finding: Finding) -> bool:
        """Whether it names the finding's rule, or all."""
        if finding.rule == UNUSED:  # a comment that ignores everything does not hide itself
            return self.rules is not None and UNUSED in self.rules
        return self.rules is None or finding.rule in self.rules


class Ignores:
    """The comments of one script."""

    def __init__(self, code: str) -> None:
        self._comments = list(_comments(code)) if "simworlds:" in code else []
        self._whole_file = [comment for comment in self._comments if comment.whole_file]
        self._lines = split_lines(code) if self._comments else []

    def kept(self, findings: list[Finding]) -> list[Finding]:
        """The findings that no comment ignores."""
        return [finding for finding in findings if not self._ignored(finding)]

    def unused(self, known: Collection[str]) -> Iterator[Finding]:
        """A finding for each comment that ignored nothing; to be asked last. ``known`` are the ids of all rules."""
        for comment in self._comments:
            unused = sorted((comment.rules or set()) - comment.used - {UNUSED})
            if (comment.rules and not unused) or (comment.rules is None and comment.used):
                continue
            message = "This comment has nothing to ignore."
            if strange := [name for name in unused if name not in known]:
                message = f"There is no rule {', '.join(strange)} to ignore."
            elif unused:
                message = f"This comment ignores what is not found here: {', '.join(unused)}."
            edit = Edit(comment.span, _without(comment, unused))
            if not edit.text:
                edit = Edit(self._with_blanks(comment.span), "")
            yield Finding(UNUSED, "note", comment.span, message, fix=Fix("Remove it", (edit,), sure=True))

    def _with_blanks(self, span: Span) -> Span:
        """The span of a comment and of the blanks before it, where the line ends with it."""
        line = self._lines[span.line - 1]
        if line[span.end_column :].strip():
            return span
        return Span(span.line, len(line[: span.column].rstrip()), span.line, span.end_column)

    def _ignored(self, finding: Finding) -> bool:
        first = bisect_left(self._comments, finding.span.line, key=_line)
        last = bisect_right(self._comments, finding.span.end_line, key=_line)
        near = [*self._whole_file, *self._comments[first:last]]
        found = [comment for comment in near if comment.ignores(finding)]
        for comment in found:
            comment.used.add(finding.rule)
        return bool(found)


def _line(comment: _Comment) -> int:
    return comment.span.line


def _without(comment: _Comment, unused: list[str]) -> str:
    """The comment without the rules that it does not need; empty if it needs none."""
    if not comment.used or comment.rules is None:
        return ""
    kept = ", ".join(sorted(comment.rules - set(unused)))
    return re.sub(r"\[.*\]", lambda _: f"[{kept}]", comment.text, flags=re.DOTALL)


def _comments(code: str) -> Iterator[_Comment]:
    for line, column, text in _comment_tokens(code):
        for found in _COMMENT.finditer(text):
            whole_file = found["kind"] == "ignore-file"
            if whole_file and line > _MOST_TOP_LINES:
                continue
            names = found["rules"]
            rules = None if names is None else frozenset(filter(None, map(str.strip, names.split(","))))
            span = Span(line, column + found.start(), line, column + found.end())
            yield _Comment(span, found[0], whole_file, rules, set())


def _comment_tokens(code: str) -> Iterator[tuple[int, int, str]]:
    """(line, column, text) of the comments; where Python cannot tell them, whatever follows a ``#``."""
    last = 0
    try:
        for token in tokenize.generate_tokens(io.StringIO(code).readline):
            if token.type == tokenize.COMMENT:
                yield *token.start, token.string
            last = token.end[0]
    except _UNREADABLE:
        for number, line in enumerate(split_lines(code)[last:], last + 1):
            if "#" in line:
                yield number, line.index("#"), line[line.index("#") :].rstrip("\r\n")
