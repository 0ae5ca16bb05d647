"""What a check finds: where, what is wrong, and the edit that mends it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Sequence

Severity = Literal["error", "warning", "note"]


@dataclass(frozen=True, slots=True)
class Span:
    """A part of a text: lines count from 1, columns (in characters) from 0; the end is the first place behind it."""

    line: int
    column: int
    end_line: int
    end_column: int


@dataclass(frozen=True, slots=True)
class Edit:
    """Text to put in the place of a span."""

    span: Span
    text: str

    @classmethod
    def before(cls, span: Span, text: str) -> Edit:
        """The edit that writes a text before a span, which stays."""
        return cls(Span(span.line, span.column, span.line, span.column), text)

    @classmethod
    def behind(cls, span: Span, text: str) -> Edit:
        """The edit that writes a text behind a span, which stays."""
        return cls(Span(span.end_line, span.end_column, span.end_line, span.end_column), text)


@dataclass(frozen=True, slots=True)
class Fix:
    """What mends a finding. ``sure``: the code then does what it was meant to, and nothing else changes."""

    title: str
    edits: tuple[Edit, ...]
    sure: bool = False


@dataclass(frozen=True, slots=True)
class Finding:
    """Something wrong in a script.

    ``rule`` is the rule's id, ``symbol`` the path of what the finding is about (a removed symbol's own path, or the
    owner's path and the name that it lacks), ``instead`` the paths that take its place. ``absent`` are the paths that
    the finding says do not exist: in a Blender that has one of them, by an add-on say, it does not hold.
    """

    rule: str
    severity: Severity
    span: Span
    message: str
    symbol: str = ""
    instead: tuple[str, ...] = ()
    fix: Fix | None = None
    absent: tuple[str, ...] = ()


def told_once(places: Sequence[Finding]) -> Finding:
    """The first of some findings that all say the same, which counts the others."""
    first, *others = places
    more = f" The same holds for {len(others)} more in this file." if others else ""
    return replace(first, message=first.message + more)
