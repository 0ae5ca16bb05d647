"""Pieces of Markdown, composed the same way whatever form a page was read from.

A *block* is a string of one or more lines without surrounding blank lines; an *inline* is a string without
line breaks. The two readers walk different trees, but every piece of a page's text is put together here, so
that one page read twice is one text.
"""

from __future__ import annotations

import re
from itertools import zip_longest

INDENT = "  "

# RST sources are typed in ASCII and made typographic by Sphinx when it writes HTML. ASCII is what people type
# into a query, so both forms are brought back to it.
_STRAIGHT = str.maketrans(
    {"’": "'", "‘": "'", "“": '"', "”": '"', "–": "--", "—": "---", "…": "...", "\u200b": ""}
)
_LANGUAGES = {"default": "", "none": "", "text": "", "python3": "python", "py": "python"}
_LIST_MARKER = re.compile(r"(?:- |\d+\. )")
# Stands for an icon until the line is folded: brackets that held nothing else go with it.
ICON = "\ufffc"
_HOLLOW = re.compile(rf"\s*\(\s*{ICON}\s*\)|{ICON}")


def straight(text: str) -> str:
    """Prose with typographic quotes, dashes and dots replaced by their ASCII spelling."""
    return text.translate(_STRAIGHT)


def fold(text: str) -> str:
    """``text`` on one line, with single spaces and without icons."""
    if ICON in text:
        text = _HOLLOW.sub("", text)
    return " ".join(text.split())


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
    fence = "`" * (max(len(run) for run in re.findall(r"`+", text)) + 1)
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
    marks = "```"
    while marks in text:
        marks += "`"
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
    """Rows of a table being read. A cell that spans several is written once; the rest of it stays empty."""

    _MOST = 200  # a span in a hostile page may be any number

    def __init__(self) -> None:
        self.rows: list[list[str]] = []
        self._taken: set[tuple[int, int]] = set()

    def row(self) -> None:
        """Begin the next row."""
        self.rows.append([])

    def cell(self, text: str, columns: int = 1, rows: int = 1) -> None:
        """Add a cell to the row begun last, to the right of what is there."""
        at, line = len(self.rows) - 1, self.rows[-1]
        while (at, len(line)) in self._taken:
            line.append("")
        first = len(line)
        span = range(first, first + max(1, min(columns, self._MOST)))
        line += [text, *("" for _ in span[1:])]
        if rows > 1:
            self._taken |= {(at + down, x) for down in range(1, min(rows, self._MOST)) for x in span}


def table(rows: list[list[str]], *, header: bool, title: str = "") -> str:
    """A table whose cells hold inline text or blocks already joined; nothing when all cells are empty."""
    rows = [row for row in rows if any(cell.strip() for cell in row)]
    if not rows:
        return ""
    width = max(len(row) for row in rows)
    columns = list(zip_longest(*rows, fillvalue=""))
    # Galleries have columns of pictures without captions.
    keep = [index for index in range(width) if any(cell.strip() for cell in columns[index])]
    shown = [[_cell(row[index]) if index < len(row) else "" for index in keep] for row in rows]
    if not header:
        shown.insert(0, ["" for _ in keep])
    shown.insert(1, ["---" for _ in keep])
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
