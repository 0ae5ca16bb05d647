"""What the tests of the server share: home folders with real bases, a service over them."""

from __future__ import annotations

import json
import os
import shutil
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from pathlib import Path

import pytest

from kb_serve.bases import Bases
from kb_serve.rebuild import Upkeep
from kb_serve.service import Service

MakeBase = Callable[..., Path]


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture
def home(base: Path, tmp_path: Path) -> Path:
    """A home folder of its own with the base of this environment's Blender."""
    (tmp_path / "kb").mkdir()
    os.link(base, tmp_path / "kb" / base.name)
    return tmp_path


@pytest.fixture
def make_base(base: Path, home: Path) -> MakeBase:
    """Puts a further base into ``home``: this environment's, passing for another version's."""

    def make(version: str, name: str | None = None, **meta: object) -> Path:
        minor = version.rpartition(".")[0]
        target = home / "kb" / (name or f"blender-{minor}.sqlite")
        draft = target.with_suffix(".draft")
        shutil.copy(base, draft)
        with closing(sqlite3.connect(draft)) as file, file:
            for field, value in {"blender": version, "minor": minor, **meta}.items():
                text = value if isinstance(value, str) else json.dumps(value)
                file.execute("UPDATE meta SET value = ? WHERE name = ?", (text, field))
        return draft.replace(target)

    return make


@pytest.fixture
def serve_from() -> Iterator[Callable[..., Service]]:
    """Makes services over home folders, which build nothing unless told to; closes their bases."""
    with ExitStack() as opened:

        def make(
            home: Path, *, blender_exe: Path | None = None, rebuild: bool = False, default: str | None = None
        ) -> Service:
            bases = Bases(home, default=default, blender_exe=blender_exe)
            opened.callback(bases.close)
            return Service(bases, Upkeep(bases, blender_exe, enabled=rebuild))

        yield make


@pytest.fixture
def service(home: Path, serve_from: Callable[..., Service]) -> Service:
    """The service over ``home``."""
    return serve_from(home)
