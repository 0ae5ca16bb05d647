"""A home with a knowledge base, a server for the team, and runs that several tests read."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
import teams
from commands import Command
from made_once import made_once
from run_sessions import DOCS, answered, asked_of, sit
from team import Team

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from fake_messages_api import FakeMessagesAPI
    from run_sessions import Played


@pytest.fixture(scope="session")
def home(base: Path, docs_url: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A home folder with the base's knowledge, and runs of its own; its documentation is served to all sessions."""
    folder = tmp_path_factory.mktemp("home")
    (folder / "kb").symlink_to(base.parent)
    (folder / DOCS).write_text(docs_url)
    return folder


@pytest.fixture
def api(home: Path) -> Iterator[FakeMessagesAPI]:
    """The server that answers live runs; a test gives it its team as ``api.answer``."""
    with answered(home, Team()) as server:
        yield server


@pytest.fixture
def command(home: Path) -> Iterator[Callable[..., Command]]:
    """Starts ``simworlds``; nothing of it outlives the test."""
    started: list[Command] = []

    def command(*words: object, url: str = "") -> Command:
        started.append(Command(home, *words, url=url))
        return started[-1]

    yield command
    for one in started:
        one.kill()


def _play(home: Path, folder: Path, team: Team, *faults: object, **options: object) -> Played:
    with answered(home, team) as server:
        server.fail("POST /v1/messages", *faults)  # type: ignore[arg-type]
        played = sit(folder / "run", **options)
        return replace(played, requests=asked_of(server))


@pytest.fixture(scope="session")
def play(home: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Played]:
    """Plays a team's run, for all tests that ask for it."""

    def play(team: Team, *faults: object, **options: object) -> Played:
        return _play(home, tmp_path_factory.mktemp("played"), team, *faults, **options)

    return play


@pytest.fixture(scope="session")
def mended(home: Path, tmp_path_factory: pytest.TempPathFactory) -> Played:
    """A run in which much is sent back, and mended. Never go on with it, or write to it: others read it."""
    return made_once(tmp_path_factory, "mended", lambda folder: _play(home, folder, teams.mended()))


@pytest.fixture(scope="session")
def falling(home: Path, tmp_path_factory: pytest.TempPathFactory) -> Played:
    """A crate that falls: faked at first, then simulated. Never write to it."""
    return made_once(tmp_path_factory, "falling", lambda folder: _play(home, folder, teams.falling()))


@pytest.fixture(scope="session")
def troubled(home: Path, tmp_path_factory: pytest.TempPathFactory) -> Played:
    """A run in which models and server do all that they should not, and which ends well. Never write to it."""
    return made_once(
        tmp_path_factory, "troubled", lambda folder: _play(home, folder, teams.troubled(), *teams.outages())
    )
