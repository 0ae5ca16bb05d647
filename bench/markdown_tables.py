"""Tables of text cells, and their Markdown."""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True, slots=True)
class Table:
    """A table of text cells; columns of numbers are aligned right."""

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""


def format_table(table: Table) -> str:
    """The Markdown of a table, aligned in its source too."""
    columns = list(zip(table.header, *table.rows, strict=True))
    widths = [max(3, *(_width(cell) for cell in column)) for column in columns]
    right = [all(_is_number(cell) for cell in column[1:]) and len(column) > 1 for column in columns]
    lines = [_line(table.header, widths, right)]
    lines.append(
        "|"
        + "|".join(
            f"{'-' * (width + 1)}{':' if to_right else '-'}"
            for width, to_right in zip(widths, right, strict=True)
        )
        + "|"
    )
    lines += [_line(row, widths, right) for row in table.rows]
    text = f"## {table.title}\n\n" + "\n".join(lines)
    return f"{text}\n\n{table.note}" if table.note else text


def _line(cells: Sequence[str], widths: Sequence[int], right: Sequence[bool]) -> str:
    padded: list[str] = []
    for cell, width, to_right in zip(cells, widths, right, strict=True):
        space = " " * (width - _width(cell))
        padded.append(space + _escaped(cell) if to_right else _escaped(cell) + space)
    return f"| {' | '.join(padded)} |"


def _escaped(cell: str) -> str:
    return cell.replace("|", "\\|").replace("\n", " ")


def _width(cell: str) -> int:
    """The width of a cell on a terminal."""
    wide = sum(unicodedata.east_asian_width(char) in "WF" for char in cell)
    return len(_escaped(cell)) + wide


def _is_number(cell: str) -> bool:
    head = cell.split(" ", maxsplit=1)[0].replace(",", "").replace("−", "-")
    try:
        float(head)
    except ValueError:
        return cell in {"", "–"}
    return True
