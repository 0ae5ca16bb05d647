"""Code as a page shows it: highlighted, and as what changed since the last attempt."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from markupsafe import Markup
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import DiffLexer, JsonLexer, PythonLexer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pygments.lexer import Lexer

    from agents.loop.record.run_state import Attempt

LONGEST = 40_000  # letters of one text
_LINES = 3000  # of a script that is compared
_ALIKE = 0.35  # from here on, a script is a new version of another
_LEXERS: dict[str, type[Lexer]] = {"python": PythonLexer, "diff": DiffLexer, "json": JsonLexer}


@dataclass(frozen=True, slots=True)
class ScriptChange:
    """A script, as a difference to the one that it came from; ``is_new``: it came from none."""

    diff: str
    added: int
    removed: int
    is_new: bool


def clipped(text: str) -> str:
    """The text, or its beginning and what was left out."""
    left = len(text) - LONGEST
    return text if left <= 0 else f"{text[:LONGEST]}\n… and {left:,} letters more, in the journal"


def highlighted(text: str, language: str) -> Markup:
    """The text as HTML; ``language`` is python, diff or json."""
    made = highlight(clipped(text), _LEXERS[language](stripnl=False), _formatter())
    return Markup(made)  # noqa: S704 - pygments escapes what it is given


@cache
def _formatter() -> HtmlFormatter[str]:
    return HtmlFormatter(nowrap=True)


def changes(before: Sequence[Attempt], attempt: Attempt) -> list[ScriptChange]:
    """The scripts of an attempt that worked, each against the one of earlier attempts that is most like it."""
    earlier = [script for one in before for script in _scripts(one)]
    made: list[ScriptChange] = []
    for script in _scripts(attempt):
        likeness, model = max(((_alike(one, script), one) for one in earlier), default=(0.0, ""))
        if likeness < 1.0:
            made.append(_change(model if likeness >= _ALIKE else "", script))
    return made


def _scripts(attempt: Attempt) -> list[str]:
    return [call.code for call in attempt.tools("coder") if call.code and not call.failed]


def _alike(one: str, other: str) -> float:
    lines, others = one.splitlines()[:_LINES], other.splitlines()[:_LINES]
    return difflib.SequenceMatcher(None, lines, others, autojunk=True).ratio()


def _change(model: str, script: str) -> ScriptChange:
    lines = list(
        difflib.unified_diff(
            model.splitlines()[:_LINES], script.splitlines()[:_LINES], "before", "now", lineterm="", n=3
        )
    )[2:]
    added = sum(line.startswith("+") for line in lines)
    removed = sum(line.startswith("-") for line in lines)
    return ScriptChange("\n".join(lines), added, removed, not model)
