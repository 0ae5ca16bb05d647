"""The definition lists in the Markdown of pages."""

from __future__ import annotations

import re
import textwrap
from itertools import dropwhile, takewhile
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

# Quotes, tables, lists, code, formulas, headings, definitions and what is nested in them, captions.
_NOT_PROSE = re.compile(r"$|\s|[>|$#]|[-*] |```|\*\*[^\n]*\*\*:?\s*(?:\n|$)|Figure: ")
_BULLET = re.compile(r"\s*- \*\*.+?\*\*\s*")
_EXAMPLES = re.compile(r"(?:For )?examples?\b", re.IGNORECASE)


def term_lines(text: str) -> Iterator[tuple[int, str]]:
    """(line, term) of every definition in a section's Markdown."""
    for number, line in enumerate(text.split("\n")):
        if "**" in line and (term := term_of(line)):
            yield number, term


def term_of(line: str) -> str:
    """The term that a line of a section's Markdown defines; empty for none."""
    term = line.strip()
    is_one = term.startswith("**") and term.rstrip(":").endswith("**")
    return term.strip("*: ") if is_one else ""


def with_names(text: str, section: int, names: Mapping[tuple[int, int], str]) -> str:
    """A section's text, the names that scripts have for its labels beside them, by section and line."""
    if not names:
        return text
    return "\n".join(
        _named(line, name) if (name := names.get((section, number))) else line
        for number, line in enumerate(text.split("\n"))
    )


def _named(line: str, names: str) -> str:
    """A line of a section with names: beside the term of a list, else at its end."""
    bullet = _BULLET.match(line)
    if bullet is None or bullet.end() == len(line):
        return f"{line} · {names}"
    return f"{bullet[0].rstrip()} {names} · {line[bullet.end() :]}"


def passage_text(text: str, line: int) -> str:
    """What stands at a line of a section's Markdown: a term's definition, or a paragraph; at -1 its first paragraph,
    with the list that it announces or the examples of it.
    """
    lines = text.split("\n")
    if line < 0:
        blocks = list(dropwhile(_NOT_PROSE.match, text.split("\n\n")))
        announcing = next((n for n, block in enumerate(blocks[:2]) if _announces(block, n)), -1)
        return "\n\n".join(blocks[: announcing + 2])
    if line >= len(lines):
        return ""
    if lines[line].startswith(">"):
        quoted = takewhile(lambda each: each.startswith(">"), lines[line:])
        return passage_text("\n".join(each.removeprefix(">").removeprefix(" ") for each in quoted), 0)
    depth = _depth(lines[line])
    if not lines[line].strip().startswith("**"):
        return "\n".join(takewhile(str.strip, lines[line:]))
    while (
        line + 1 < len(lines) and lines[line + 1].startswith("**", depth) and _depth(lines[line + 1]) == depth
    ):
        line += 1  # several terms share the definition
    below = takewhile(lambda each: not each.strip() or _depth(each) > depth, lines[line + 1 :])
    return textwrap.dedent("\n".join(below)).strip()


def _announces(block: str, place: int) -> bool:
    return block.endswith(":") and (place == 0 or _EXAMPLES.match(block) is not None)


def _depth(line: str) -> int:
    return len(line) - len(line.lstrip())
