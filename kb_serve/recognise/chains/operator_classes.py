"""Operators by the names of their classes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader


def operator_of_class(name: str) -> str:
    """The path of the operator whose class a name is, ``MESH_OT_rip``, by which macros hold its properties; empty for
    other names.
    """
    module, mark, own = name.partition("_OT_")
    return f"{OPERATORS}{module.lower()}.{own}" if mark else ""


def known_operator_of_class(name: str, reader: BaseReader) -> str:
    """The same of an operator that the base has; empty for others."""
    path = operator_of_class(name)
    return path if path and reader.entry(path) else ""
