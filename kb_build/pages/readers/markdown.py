"""Pieces of Markdown, composed the same way whatever form a page was read from.

A *block* is a string of one or more lines without surrounding blank lines; an *inline* is a string without
line breaks. The two readers walk different trees, but every piece of a page's text is put together here, so
that one page read twice is one text.
"""

from __future__ import annotations

import re
from bisect import insort
from typing import TYPE_CHECKING, NamedTuple

from kb_build.pages.page import Section

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

INDENT = "  "
_LONGEST = 400_000
_LARGE_TABLE = 50_000
_MOST_SPANS = 200

# RST sources are typed in ASCII and made typographic by Sphinx when it writes HTML. ASCII is what people type
# into a query, so both forms are brought back to it.
_STRAIGHT = str.maketrans(
    {"\ue000": "", "’": "'", "‘": "'", "“": '"', "”": '"', "–": "--", "—": "---", "…": "...", "\u200b": ""}
)
_LANGUAGES = {"default": "", "none": "", "text": "", "python3": "python", "py": "python"}
_BACKTICKS = re.compile("`+")
_LIST_MARKER = re.compile(r"(?:- |\d+\. )")
# Stands for an icon until the line is folded: brackets that held nothing else go with it, and the dash after it where a
# line begins.
ICON = "\ufffc"
# Surrounds an address within a text under way, at the end of the line that it leads to.
_MARK = "\ue000"
_SYMBOL = re.compile(r"bpy-[a-z0-9-]{1,200}")
_MARKED = re.compile(f"{_MARK}({_SYMBOL.pattern}){_MARK}")
_HOLLOW = re.compile(rf"\s*\(\s*{ICON}\s*\)|^\s*{ICON}\s*-+\s|{ICON}")


def straight(text: str) -> str:
    """Prose with typographic quotes, dashes and dots replaced by their ASCII spelling."""
    return text.translate(_STRAIGHT)


def marked(blocks: list[str], names: Iterable[str]) -> list[str]:
    """Blocks whose first line is where the addresses ``names`` lead to; others than symbols' are left out."""
    marks = "".join(f"{_MARK}{name}{_MARK}" for name in names if _SYMBOL.fullmatch(name))
    if not marks or not blocks:
        return blocks
    line, end, rest = blocks[0].partition("\n")
    return [f"{line}{marks}{end}{rest}", *blocks[1:]]


def section(anchor: str, title: str, level: int, blocks: list[str], names: Iterable[str]) -> Section:
    """A section of these blocks, to which the addresses ``names`` lead."""
    found: dict[str, int] = {name: -1 for name in names if _SYMBOL.fullmatch(name)}
    text = join(blocks)
    if _MARK in text:
        lines = text.split("\n")
        for number, line in enumerate(lines):
            if _MARK in line:
                found |= dict.fromkeys(_MARKED.findall(line), number)
                lines[number] = _MARKED.sub("", line)
        text = "\n".join(lines)
    return Section(anchor, title, level, text, tuple(found.items()))


def fold(text: str) -> str:
    """``text`` on one line, with single spaces and without icons."""
    if ICON in text:
        text = _HOLLOW.sub("", text)
    return " ".join(text.split())


def cut(text: str) -> str:
    """``text`` without what exceeds the length of any honest page."""
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def emphasis(text: str) -> str:
    """``*text*``; nothing when there is no text."""
    return _wrapped(text, "*")


def strong(text: str) -> str:
    """``**text**``; nothing when there is no text."""
    return _wrapped(text, "**")


def _wrapped(text: str, mark: str) -> str:
    inner = text.strip()
    if not inner:
        return text
    lead = text[: len(text) - len(text.lstrip())]
    tail = text[len(text.rstrip()) :]
    return f"{lead}{mark}{inner}{mark}{tail}"


def code(text: str) -> str:
    """An inline code span (also for keys); longer fences where the text itself holds backticks."""
    text = " ".join(text.split())
    if not text:
        return ""
    if "`" not in text:
        return f"`{text}`"
    fence = "`" * (max(map(len, _BACKTICKS.findall(text))) + 1)
    return f"{fence} {text} {fence}"


def link(text: str, url: str) -> str:
    """A link that leaves the documentation; links between pages stay plain text (see ``Page.links``)."""
    text = fold(text)
    if not text or text == url:
        return url
    return f"[{text}]({url})"


def abbreviation(text: str, explanation: str) -> str:
    """An abbreviation with what it stands for in brackets behind it."""
    return f"{text} ({straight(explanation)})" if explanation else text


def formula(latex: str) -> str:
    """An inline formula."""
    return f"${' '.join(latex.split())}$"


def formula_block(latex: str) -> str:
    """A displayed formula, without the wrappers that Sphinx adds for its HTML."""
    for wrapper in (r"\[", r"\]", r"\begin{split}", r"\end{split}"):
        latex = latex.replace(wrapper, "")
    lines = [line.strip() for line in latex.strip().splitlines()]
    return "\n".join(["$$", *(line for line in lines if line), "$$"])


def fence(text: str, language: str = "") -> str:
    """A code block; ``language`` is dropped where it names none."""
    text = text.strip("\n").rstrip()
    if not text:
        return ""
    marks = "`" * max(3, 1 + max(map(len, _BACKTICKS.findall(text)), default=0))
    name = _LANGUAGES.get(language, language)
    return f"{marks}{name}\n{text}\n{marks}"


def indent(text: str, by: str = INDENT) -> str:
    """Every line of ``text`` that is not empty, moved to the right."""
    return "\n".join(by + line if line else line for line in text.split("\n"))


def quote(blocks: list[str], label: str = "") -> str:
    """A block quote; with ``label``, a note: ``> **Label:** text``."""
    blocks = [block for block in blocks if block]
    if label and blocks:
        head = f"**{label}:**"
        if _is_prose(blocks[0]):
            blocks[0] = f"{head} {blocks[0]}"
        elif _is_list(blocks[0]):
            blocks[0] = f"{head}\n{blocks[0]}"
        else:
            blocks.insert(0, head)
    return "\n".join(f"> {line}".rstrip() for line in join(blocks).split("\n")) if blocks else ""


def _is_list(block: str) -> bool:
    return _LIST_MARKER.match(block) is not None


def _is_prose(block: str) -> bool:
    return not _is_list(block) and not block.startswith((">", "|", "```", "$$", "**"))


def listing(items: list[list[str]], *, start: int | None = None) -> str:
    """A bullet list, or with ``start`` a numbered one. Each item is a list of blocks."""
    lines: list[str] = []
    loose = False
    for number, blocks in enumerate((item for item in items if any(item)), start or 0):
        marker = "- " if start is None else f"{number}. "
        body = blocks[0]
        for block in blocks[1:]:
            tight = _is_list(block)
            loose = loose or not tight
            body += ("\n" if tight else "\n\n") + block
        lines.append(marker + indent(body, " " * len(marker)).lstrip(" "))
    return ("\n\n" if loose else "\n").join(lines)


def field(name: str, body: list[str]) -> list[str]:
    """One entry of a field list (``:Panel: …``, the values of an enumeration) as a list item's blocks."""
    body = [block for block in body if block]
    if body and _is_prose(body[0]):
        return [f"**{name}:** {body[0]}", *body[1:]]
    return [f"**{name}:**", *body]


def definition(terms: list[str], body: list[str]) -> str:
    """A term in bold, or several, with its definition indented below."""
    heads = [strong(term) if "**" not in term else term for term in map(fold, terms) if term]
    text = join(body)
    return "\n".join([*heads, *([indent(text)] if text else [])])


class MarkdownGrid:
    """Rows of a table being read, each with its cells by column. A cell that spans several stands in the first.

    A span in a hostile page may be any number: it is remembered, never filled in.
    """

    def __init__(self) -> None:
        self.rows: list[dict[int, str]] = []
        self._column = 0
        self._spans: list[_Span] = []

    def row(self) -> None:
        """Begin the next row."""
        self.rows.append({})
        self._column = 0
        self._spans = [span for span in self._spans if span.until >= len(self.rows)]

    def cell(self, text: str, columns: int = 1, rows: int = 1) -> None:
        """Add a cell to the row begun last, to the right of what is there."""
        if len(self._spans) == _MOST_SPANS:
            rows = 1
        for span in self._spans:
            if span.first <= self._column <= span.last:
                self._column = span.last + 1
        first, self._column = self._column, self._column + max(1, columns)
        if text.strip():
            self.rows[-1][first] = text
        if rows > 1:
            insort(self._spans, _Span(first, self._column - 1, len(self.rows) - 1 + rows))


class _Span(NamedTuple):
    """Columns that a cell above takes, until a row (counted from 1)."""

    first: int
    last: int
    until: int


def table(rows: Iterable[Mapping[int, str]], *, header: bool, title: str = "") -> str:
    """A table of rows that have a text in some of their columns; nothing when none has any.

    Columns in which no row has a text are left out, as galleries have them for pictures. A large table whose cells are
    nearly all empty is not filled up: there each row has its texts alone.
    """
    filled = [row for row in rows if row]
    if not filled:
        return ""
    columns = sorted({column for row in filled for column in row})
    if len(columns) * len(filled) <= max(_LARGE_TABLE, 4 * sum(map(len, filled))):
        shown = [[_cell(row.get(column, "")) for column in columns] for row in filled]
    else:
        shown = [[_cell(text) for _, text in sorted(row.items())] for row in filled]
    width = max(map(len, shown))
    if not header:
        shown.insert(0, [""] * width)
    shown.insert(1, ["---"] * width)
    text = "\n".join("| " + " | ".join(row) + " |" for row in shown)
    return f"{strong(title)}\n\n{text}" if title else text


def _cell(text: str) -> str:
    return re.sub(r"\s*\n\s*", "<br>", text.strip()).replace("|", "\\|")


def figure(caption: str, legend: list[str], alternative: str = "") -> list[str]:
    """What remains of a picture: its caption, else its alternative text; and the legend."""
    text = caption or alternative
    return [*([f"Figure: {text}"] if text else []), *legend]


def join(blocks: list[str]) -> str:
    """Blocks as one text, with a blank line between."""
    return "\n\n".join(block for block in blocks if block)
