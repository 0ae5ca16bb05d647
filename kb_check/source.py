"""Reads a file as Python reads it: its encoding, its line ends, and the cells of a notebook."""

from __future__ import annotations

import io
import tokenize
from bisect import bisect_right
from dataclasses import dataclass, field

MOST_BYTES = 16 << 20
NOTEBOOK = ".ipynb"
# Codecs that take quadratic time, or that turn plain ASCII into something else.
_REFUSED_CODECS = frozenset(
    {"idna", "punycode", "unicode_escape", "raw_unicode_escape", "utf_7", "undefined"}
)


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


def read_source(data: bytes, name: str) -> Source:
    """The Python in a file's bytes; ``name`` tells whether it is a notebook. Bad input ends in a ``fault``."""
    if name.endswith(NOTEBOOK):
        from kb_check.notebook import read_notebook  # noqa: PLC0415 - few have any

        return read_notebook(data)
    try:
        encoding, _ = tokenize.detect_encoding(io.BytesIO(data).readline)
    except SyntaxError as error:
        return _salvaged(data, error.msg)
    if encoding.replace("-", "_") in _REFUSED_CODECS:
        return _salvaged(data, f"the encoding {encoding} is not supported")
    try:
        return Source(data.decode(encoding), encoding)
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        return _salvaged(data, f"byte 0x{data[error.start]:02x} is not valid {encoding}", line)
    except Exception as error:  # noqa: BLE001, RUF100 - a codec that the file names may raise anything
        return _salvaged(data, f"the encoding {encoding} cannot be read ({type(error).__name__})")


def _salvaged(data: bytes, fault: str, line: int = 1) -> Source:
    return Source(data.decode("utf-8-sig", errors="replace"), fault=fault, fault_line=line)
