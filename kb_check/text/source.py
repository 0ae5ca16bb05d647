"""A file's Python: its text, how it is written back, and the cells of a notebook."""

from __future__ import annotations

import io
from bisect import bisect_right
from dataclasses import dataclass, field

MOST_BYTES = 16 << 20
NOTEBOOK = ".ipynb"


@dataclass(frozen=True, slots=True)
class Cell:
    """A code cell: its place among all cells of the notebook, from 1, and the line of the text at which it begins."""

    number: int
    line: int


@dataclass(frozen=True, slots=True)
class Source:
    """A file's Python, without a byte order mark and with the file's own line ends.

    ``fault`` says why Python refuses the file before it parses it (at ``fault_line``); the text is then what could
    be read all the same. ``encoding`` writes the text back. ``cells`` are those of a notebook.
    """

    text: str
    encoding: str = "utf-8"
    fault: str = ""
    fault_line: int = 1
    cells: tuple[Cell, ...] = field(default=())

    @property
    def lines(self) -> list[str]:
        """The lines as Python counts them, with their ends."""
        return split_lines(self.text)

    def place(self, line: int) -> tuple[int, int]:
        """(number of the cell, line in it) of a line of the text; the cell is 0 where there are none."""
        number = bisect_right(self.cells, line, key=lambda cell: cell.line)
        if not number:
            return 0, line
        cell = self.cells[number - 1]
        return cell.number, line - cell.line + 1


def split_lines(text: str) -> list[str]:
    """The lines as Python counts them, with their ends: form feeds and the like end none."""
    return io.StringIO(text, newline="").readlines()
