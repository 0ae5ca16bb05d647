"""Blenders for tests that send calls to one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from live_session import LiveSession
from running import HttpServer
from shared_docs import share_docs

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from built_base import Built


@pytest.fixture(scope="session")
def _one_session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveSession]:
    session = LiveSession(tmp_path_factory.mktemp("run"))
    yield session
    session.blender.close()


@pytest.fixture
def session(_one_session: LiveSession) -> LiveSession:
    """A Blender with an empty scene; the same process for all tests that ask for one."""
    _one_session.empty()
    return _one_session


@pytest.fixture
def own_session(tmp_path: Path) -> Iterator[LiveSession]:
    """A Blender of the test's own, to be treated badly."""
    session = LiveSession(tmp_path / "run")
    yield session
    session.blender.close()


@pytest.fixture
def make_session(tmp_path: Path) -> Iterator[Callable[[str], LiveSession]]:
    """Makes Blenders of the test's own, by a folder's name."""
    made: list[LiveSession] = []

    def make(name: str) -> LiveSession:
        made.append(LiveSession(tmp_path / name))
        return made[-1]

    yield make
    for session in made:
        session.blender.close()


@pytest.fixture(scope="session")
def docs_url(built_once: Built) -> Iterator[str]:
    """Where the documentation of ``base`` is served."""
    with HttpServer(built_once.home) as server:
        yield server.url


@pytest.fixture
def shared_docs(docs_url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Sessions of this process ask that server, and start none."""
    share_docs(monkeypatch, docs_url)
