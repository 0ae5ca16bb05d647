"""Lines of text: a symbol described on one line, and the definition lists in a page's lines."""

from __future__ import annotations

import textwrap
from itertools import dropwhile, takewhile
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.records import Symbol

_SHOWN_VALUES = 8
_SHOWN_ELEMENTS = 16


def literal(value: object) -> str:
    """A value as Python source; long sequences are shortened."""
    if isinstance(value, list):
        shown = ", ".join(map(literal, value[:_SHOWN_ELEMENTS]))
        return f"({shown}{', …' if len(value) > _SHOWN_ELEMENTS else ''})"
    return repr(value)


def type_text(symbol: Symbol) -> str:
    """``float[3]``, ``enum``, ``pointer → Mesh``, ``collection of Modifier``."""
    if symbol.type == "collection" and symbol.target:
        return f"collection of {symbol.target}"
    if symbol.type == "pointer" and symbol.target:
        return f"pointer → {symbol.target}"
    if "enum-flag" in symbol.flags:
        return "set of enum items"
    return symbol.type + "".join(f"[{n}]" for n in symbol.array)


def first_sentence(text: str) -> str:
    """The first sentence of a description, on one line, without its full stop."""
    line = " ".join(text.split())
    end = line.find(". ")
    return (line[:end] if end > 0 else line).rstrip(".")


def member_line(symbol: Symbol) -> str:
    """Name, type, default, first values and first sentence of a member, as its owner lists it."""
    name = symbol.path[len(symbol.owner) + 1 :] if symbol.owner else symbol.path
    if symbol.kind in {"function", "operator"}:
        call = symbol.signature
        arguments = call[call.index("(") :] if "(" in call else "()"
        head = f"`{name}{arguments}`"
    else:
        head = f"`{name}`"
    notes = [type_text(symbol)] if symbol.type else []
    if symbol.default is not None and symbol.kind in {"property", "socket"}:
        notes.append(f"= {literal(symbol.default)}")
    if symbol.enum_items:
        values = "|".join(item.identifier for item in symbol.enum_items[:_SHOWN_VALUES])
        notes.append(values + ("|…" if len(symbol.enum_items) > _SHOWN_VALUES else ""))
    if "readonly" in symbol.flags:
        notes.append("read-only")
    if symbol.modes:
        notes.append("when " + " and ".join(symbol.modes))
    said = first_sentence(symbol.description) or (symbol.label if symbol.label != symbol.name else "")
    return " ".join([head, *notes]) + (f" — {said}" if said else "")


def term_lines(text: str) -> Iterator[tuple[int, str]]:
    """(line, term) of every definition in a section's Markdown."""
    for number, line in enumerate(text.split("\n")):
        term = line.strip()
        if term.startswith("**") and term.rstrip(":").endswith("**"):
            yield number, term.strip("*: ")


def passage_text(text: str, line: int) -> str:
    """What stands at a line of a section's Markdown: a term's definition, or a paragraph; at -1 its first paragraph."""
    lines = text.split("\n")
    if line < 0:
        blocks = list(dropwhile(lambda block: not _is_prose(block), text.split("\n\n")))
        announces = blocks and blocks[0].endswith(":")
        return "\n\n".join(blocks[: 2 if announces else 1])
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


def _is_prose(paragraph: str) -> bool:
    return paragraph[:1] not in {"", ">", "|", "-", "*", "`", "$", "#"} and not paragraph.startswith(
        "Figure: "
    )


def _depth(line: str) -> int:
    return len(line) - len(line.lstrip())
