"""Files as Python reads them: encodings, line ends, notebooks."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest

from kb_check.text.reading import read_source

if TYPE_CHECKING:
    from kb_check.text.source import Source


@pytest.mark.parametrize(
    ("data", "text", "encoding"),
    [
        (b"x = 1\r\n", "x = 1\r\n", "utf-8"),
        (b"\xef\xbb\xbfx = 1\n", "x = 1\n", "utf-8-sig"),
        ("# coding: latin-1\nx = 'é'\n".encode("latin-1"), "# coding: latin-1\nx = 'é'\n", "iso-8859-1"),
        (b"BLENDER = 1\n", "BLENDER = 1\n", "utf-8"),
        (b"", "", "utf-8"),
    ],
)
def test_text_is_written_back_as_it_was(data: bytes, text: str, encoding: str) -> None:
    source = read_source(data, "a.py")
    assert (source.text, source.encoding, source.fault) == (text, encoding, "")
    assert source.text.encode(source.encoding) == data


@pytest.mark.parametrize(
    ("data", "fault", "line"),
    [
        (b"x = 1\ny = '\xe9'\nz\n", "byte 0xe9 is not valid utf-8", 2),
        (b"# coding: nothing\nx\n", "unknown encoding", 1),
        (b"# coding: rot13\nx\n", "the encoding rot13 cannot be read", 1),
        (b"# coding: zlib\nx\n", "the encoding zlib cannot be read", 1),
        (b"# coding: idna\n" + b"a" * 200_000, "the encoding idna is not supported", 1),
        (b"# coding: unicode-escape\n\\x41\n", "the encoding unicode-escape is not supported", 1),
        (b"\xef\xbb\xbf# coding: latin-1\nx\n", "encoding problem", 1),
        ("x\n".encode("utf-16"), "it is UTF-16: save it as UTF-8", 1),
        (b"BLENDER-v501\0", "it is a .blend file, which `simworlds verify` checks", 1),
        (b"\x28\xb5\x2f\xfd\0", "it is a compressed file, as .blend files are", 1),
        (b"PK\x03\x04\0", "it is a ZIP archive", 1),
    ],
)
def test_what_python_refuses_is_a_fault(data: bytes, fault: str, line: int) -> None:
    source = read_source(data, "a.py")
    assert fault in source.fault
    assert source.fault_line == line


def test_what_cannot_be_decoded_is_read_all_the_same() -> None:
    assert read_source(b"a = '\xe9'\nb\n", "a.py").text == "a = '\N{REPLACEMENT CHARACTER}'\nb\n"


def notebook(*cells: Any) -> Source:
    return read_source(json.dumps({"cells": cells, "nbformat": 4}).encode(), "a.ipynb")


def code(source: Any) -> dict[str, Any]:
    return {"cell_type": "code", "source": source}


def test_the_cells_of_a_notebook_are_one_text_with_places() -> None:
    source = notebook({"cell_type": "markdown", "source": "#"}, code(["a\n", "b"]), code("c"), code([]))
    assert source.text == "a\nb\nc\n"
    assert [source.place(line) for line in (1, 2, 3)] == [(2, 1), (2, 2), (3, 1)]


@pytest.mark.parametrize(
    ("cell", "text"),
    [
        ("%matplotlib inline\nx", "pass\nx\n"),
        ("if x:\n    !ls\n", "if x:\n    pass\n"),
        ("files = !ls\nfiles", "pass\nfiles\n"),
        ("bpy.data?", "pass\n"),
        ("%%bash\nls\n", "\n\n"),
        ("%%time\nx = 1\n", "pass\nx = 1\n"),
        ("x = ('%d'\n%y)\n", "x = ('%d'\n%y)\n"),
    ],
)
def test_only_what_ipython_alone_understands_is_left_out(cell: str, text: str) -> None:
    assert notebook(code(cell)).text == text


@pytest.mark.parametrize(
    "data",
    [
        b"", b"{", b"[" * 100_000, b"[]", b"{}", b'{"cells": 1}', b'"x"', b"\xff\xfe", b"null",
        b'{"worksheets": [{"cells": []}]}',
    ],
)  # fmt: skip
def test_what_is_no_notebook_is_a_fault(data: bytes) -> None:
    source = read_source(data, "a.ipynb")
    assert source.fault.startswith("it is not a notebook")
    assert source.text == ""


@pytest.mark.parametrize("cells", [[1], [None], [{"cell_type": "code"}], [code(1)], [code([1, None, "x"])]])
def test_strange_cells_are_passed_over(cells: list[Any]) -> None:
    source = notebook(*cells)
    assert source.fault == ""
    assert source.text in {"", "x\n"}
