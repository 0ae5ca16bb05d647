"""Reads a file as Python reads it: its encoding, its line ends, and the cells of a notebook."""

from __future__ import annotations

import codecs
import io
import tokenize

from kb_check.text.notebook import read_notebook
from kb_check.text.source import NOTEBOOK, Source

# Codecs that take quadratic time, or that turn plain ASCII into something else.
_REFUSED_CODECS = frozenset(
    {"idna", "punycode", "unicode_escape", "raw_unicode_escape", "utf_7", "undefined"}
)


# What files begin with that are often taken for scripts.
_OTHER_FILES = {
    b"BLENDER": "it is a .blend file, which `simworlds verify` checks",
    b"\x28\xb5\x2f\xfd": "it is a compressed file, as .blend files are, which `simworlds verify` checks",
    b"\x1f\x8b": "it is a compressed file",
    b"PK\x03\x04": "it is a ZIP archive: unpack it, and check the folder",
}


def read_source(data: bytes, name: str) -> Source:
    """The Python in a file's bytes; ``name`` tells whether it is a notebook. Bad input ends in a ``fault``."""
    if name.endswith(NOTEBOOK):
        return read_notebook(data)
    return _other_file(data) or _script(data)


def _script(data: bytes) -> Source:
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


def _other_file(data: bytes) -> Source | None:
    """What is no script for sure: something else, with null bytes, which Python takes in no file."""
    if b"\0" not in data:
        return None
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return Source(data.decode("utf-16", "replace"), fault="it is UTF-16: save it as UTF-8")
    what = next((what for start, what in _OTHER_FILES.items() if data.startswith(start)), "")
    return Source("", fault=what) if what else None


def _salvaged(data: bytes, fault: str, line: int = 1) -> Source:
    return Source(data.decode("utf-8-sig", errors="replace"), fault=fault, fault_line=line)
