"""A local server for the real client, and clients that wait for nothing."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING, Any

import pytest
from fake_messages_api import FakeMessagesAPI

from simworlds.llm.apis.attempts import Settings
from simworlds.llm.apis.claude import Claude

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from simworlds.llm.apis.retries import Retry


class Told:
    """What a client told, and how long it wanted to wait."""

    def __init__(self) -> None:
        self.retries: list[Retry] = []
        self.pauses: list[float] = []


@pytest.fixture(autouse=True)
def _no_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("ANTHROPIC_API_KEY", "ANTHROPIC_AUTH_TOKEN", "ANTHROPIC_BASE_URL"):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def api() -> Iterator[FakeMessagesAPI]:
    with FakeMessagesAPI() as server:
        yield server


@pytest.fixture
def told() -> Told:
    return Told()


@pytest.fixture
def make_claude(api: FakeMessagesAPI, told: Told) -> Iterator[Callable[..., Claude]]:
    """Makes clients of ``api``; keywords are settings."""
    made: list[Claude] = []

    def make(**settings: Any) -> Claude:
        given = {"api_key": "key", "base_url": api.base_url, "silence": 10.0, **settings}
        made.append(
            Claude(Settings(**given), told.retries.append, pause=told.pauses.append, chance=random.Random(1))
        )
        return made[-1]

    yield make
    for claude in made:
        claude.close()


@pytest.fixture
def claude(make_claude: Callable[..., Claude]) -> Claude:
    return make_claude()
