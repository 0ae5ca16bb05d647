"""Reads a finished base for the commands that build and check it."""

from __future__ import annotations

import json
import sqlite3
from contextlib import closing
from typing import TYPE_CHECKING, Any

from kb_build.errors import StoreError
from kb_build.schema import NoBase, open_read_only
from simworlds.how_to_get_bases import how_to_get_again, how_to_get_at

if TYPE_CHECKING:
    from pathlib import Path


def open_base(path: Path) -> sqlite3.Connection:
    """Opens a base read-only. Raises StoreError when it is absent, damaged, foreign or of another schema."""
    try:
        return open_read_only(path)
    except FileNotFoundError:
        raise StoreError(f"{path}: no knowledge base here. {how_to_get_at(path)}") from None
    except NoBase as error:
        raise StoreError(f"{path}: {error}. {how_to_get_again(path)}") from error


def refuse_folder(path: Path) -> None:
    """Raises StoreError where a folder is in the place of a base that is to be written: before the work, not after."""
    if path.is_dir():
        raise StoreError(
            f"{path} is a folder, where the base is to be a file. Remove it, or give another place"
        )


def read_meta(path: Path) -> dict[str, str]:
    """Reads the facts that a base holds about itself. Raises StoreError as :func:`open_base`."""
    with closing(open_base(path)) as connection:
        try:
            return dict(connection.execute("SELECT name, value FROM meta"))
        except sqlite3.Error as error:
            raise StoreError(f"{path}: damaged ({error}). {how_to_get_again(path)}") from error


def described(meta: dict[str, str]) -> dict[str, Any]:
    """Parses the structured values of meta: sources, missing, options, counts, faults, …"""
    facts: dict[str, Any] = {}
    for name, value in meta.items():
        try:
            facts[name] = json.loads(value) if value[:1] in {"{", "["} else value
        except ValueError:
            facts[name] = value
    return facts
