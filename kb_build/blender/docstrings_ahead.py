"""Reads docstrings while Blender is still writing its answer: half of what reading that answer takes."""

from __future__ import annotations

import contextlib
import json
import threading
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator
    from pathlib import Path

_PAUSE = 0.05
_DOCUMENTED = b'"docstring":"'


@contextlib.contextmanager
def docstrings_ahead(extract: Path) -> Generator[None]:
    """Reads the docstrings in ``extract`` as it grows, in a thread that ends with the body.

    They are kept (see extract_reader.read_docstring): whoever reads the whole extract then has most of them already.
    """
    ended = threading.Event()
    thread = threading.Thread(target=_read, args=(extract, ended), daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def _read(extract: Path, ended: threading.Event) -> None:
    from kb_build.blender.extract_reader import read_docstring  # noqa: PLC0415 - loaded while Blender starts

    for line in _lines(extract, ended):
        if _DOCUMENTED in line:
            read_docstring(json.loads(line))


def _lines(extract: Path, ended: threading.Event) -> Iterator[bytes]:
    """The whole lines of a file that grows, until ``ended``."""
    while not extract.is_file():
        if ended.wait(_PAUSE):
            return
    with extract.open("rb") as file:
        cut = b""
        while not ended.is_set():
            line = cut + file.readline()
            if line.endswith(b"\n"):
                cut = b""
                yield line
            else:
                cut = line
                ended.wait(_PAUSE)
