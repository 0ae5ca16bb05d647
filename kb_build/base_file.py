"""A finished base, looked at by those who build and check it."""

from __future__ import annotations

import json
import sqlite3
from contextlib import closing
from typing import TYPE_CHECKING, Any

from kb_build.errors import StoreError
from kb_build.schema import APPLICATION_ID, SCHEMA_VERSION, read_only_uri

if TYPE_CHECKING:
    from pathlib import Path

_AGAIN = "Build it again: simworlds kb build --force"


def open_base(path: Path) -> sqlite3.Connection:
    """Opens a base read-only. Raises StoreError when it is absent, damaged, foreign or of another schema."""
    if not path.is_file():
        raise StoreError(f"{path}: no knowledge base here. Build it first: simworlds kb build")
    try:
        connection = sqlite3.connect(read_only_uri(path), uri=True)
    except sqlite3.Error as error:
        raise StoreError(f"{path}: cannot be opened ({error}). {_AGAIN}") from error
    try:
        _check(connection, path)
    except BaseException:
        connection.close()
        raise
    return connection


def _check(connection: sqlite3.Connection, path: Path) -> None:
    try:
        application, schema = (
            int(connection.execute(f"PRAGMA {name}").fetchone()[0])
            for name in ("application_id", "user_version")
        )
    except sqlite3.Error as error:
        raise StoreError(f"{path}: not readable as a knowledge base ({error}). {_AGAIN}") from error
    if application != APPLICATION_ID:
        raise StoreError(f"{path}: an SQLite file of something else, not a knowledge base. {_AGAIN}")
    if schema != SCHEMA_VERSION:
        raise StoreError(
            f"{path}: its layout is number {schema}, and this SimWorlds knows {SCHEMA_VERSION}. {_AGAIN}"
        )


def read_meta(path: Path) -> dict[str, str]:
    """The facts that a base carries about itself. Raises StoreError as :func:`open_base`."""
    with closing(open_base(path)) as connection:
        try:
            return dict(connection.execute("SELECT name, value FROM meta"))
        except sqlite3.Error as error:
            raise StoreError(f"{path}: damaged ({error}). {_AGAIN}") from error


def described(meta: dict[str, str]) -> dict[str, Any]:
    """Meta with its structured values read: sources, missing, options, counts, faults, …"""
    found: dict[str, Any] = {}
    for name, value in meta.items():
        try:
            found[name] = json.loads(value) if value[:1] in {"{", "["} else value
        except ValueError:
            found[name] = value
    return found
