"""The Python in a Jupyter notebook: its code cells, one below the other. What only IPython understands is left out."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any, cast

from kb_check.text.salvage import parses
from kb_check.text.source import Cell, Source, split_lines

if TYPE_CHECKING:
    from collections.abc import Iterator

# Cell magics whose cell is Python all the same.
_PYTHON_MAGICS = frozenset({"%%time", "%%timeit", "%%capture", "%%prun", "%%python", "%%python3"})
_MAGIC = re.compile(r"(\s*+)(?:[%!?]|[\w.,\s]*+=\s*+[%!]|[\w.]++\?{1,2}\s*+$)")


def read_notebook(data: bytes) -> Source:
    """The code cells as one text. What is no notebook ends in a ``fault``."""
    try:
        notebook: Any = json.loads(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        return Source("", fault=f"it is not a notebook: {error}")
    cells: Any = cast("dict[str, Any]", notebook).get("cells") if isinstance(notebook, dict) else None
    if not isinstance(cells, list):
        return Source("", fault="it is not a notebook of the format 4: it has no list of cells")
    lines: list[str] = []
    places: list[Cell] = []
    for number, code in _code_cells(cast("list[Any]", cells)):
        places.append(Cell(number, len(lines) + 1))
        lines += _python_lines(code)
    return Source("".join(lines), cells=tuple(places))


def _code_cells(cells: list[Any]) -> Iterator[tuple[int, str]]:
    for number, cell in enumerate(cells, 1):
        if not isinstance(cell, dict) or cast("dict[str, Any]", cell).get("cell_type") != "code":
            continue
        source: Any = cast("dict[str, Any]", cell).get("source")
        if isinstance(source, list):
            source = "".join(part for part in cast("list[Any]", source) if isinstance(part, str))
        if isinstance(source, str):
            yield number, source


def _python_lines(code: str) -> Iterator[str]:
    """The lines of a cell, each with its end; what IPython alone understands becomes ``pass``."""
    lines = split_lines(code)
    is_python = parses(code)
    words = lines[0].split() if lines else []
    foreign = bool(words) and words[0].startswith("%%") and words[0] not in _PYTHON_MAGICS
    for line in lines:
        text = line.rstrip("\r\n")
        if foreign:
            text = ""
        elif not is_python and (found := _MAGIC.match(text)):
            text = f"{found[1]}pass"
        yield f"{text}\n"
