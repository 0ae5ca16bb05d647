"""Clients that begin sessions and do not come back: others are served all the while."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import httpx2
import pytest
import session_server
from mcp import Client
from session_server import SESSIONS, UNFINISHED
from small_server import SmallServer

if TYPE_CHECKING:
    from pathlib import Path

SECONDS = 0.5
ACCEPT = {"Accept": "application/json, text/event-stream", "Content-Type": "application/json"}
HELLO = {
    "jsonrpc": "2.0",
    "id": 1,
    "method": "initialize",
    "params": {
        "protocolVersion": "2025-06-18",
        "capabilities": {},
        "clientInfo": {"name": "test", "version": "1"},
    },
}


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


class Sessions:
    """A server with sessions, and a client that speaks to it request by request."""

    def __init__(self, tmp_path: Path, seconds: float = 1_000) -> None:
        self.server = SmallServer(tmp_path / "log", patience=seconds, script=session_server.__file__)
        self.url = f"http://127.0.0.1:{self.server.port}/mcp"

    def __enter__(self) -> Sessions:
        return self

    def __exit__(self, *_: object) -> None:
        self.server.__exit__()

    def begin(self) -> str:
        """The id of a new session; \"\" if it was refused."""
        answer = httpx2.post(self.url, json=HELLO, headers=ACCEPT)
        return answer.headers.get("mcp-session-id", "") if answer.status_code == 200 else ""

    def use(self, session: str) -> bool:
        """Whether a session still exists."""
        message = {"jsonrpc": "2.0", "method": "notifications/initialized"}
        answer = httpx2.post(self.url, json=message, headers={**ACCEPT, "Mcp-Session-Id": session})
        assert answer.status_code in {202, 404}
        return answer.status_code == 202


@pytest.mark.anyio
async def test_unfinished_sessions_do_not_shut_others_out(tmp_path: Path) -> None:
    with Sessions(tmp_path) as sessions:
        async with Client(sessions.url, mode="legacy") as stays:
            for _ in range(5 * SESSIONS):
                assert sessions.begin()
                await stays.list_tools()
            async with Client(sessions.url, mode="legacy") as comes:
                await comes.list_tools()


def test_the_oldest_unfinished_session_ends_where_there_are_too_many(tmp_path: Path) -> None:
    with Sessions(tmp_path) as sessions:
        begun = [sessions.begin() for _ in range(UNFINISHED + 1)]
        assert [sessions.use(session) for session in begun] == [False, *[True] * UNFINISHED]


def test_sessions_that_were_used_are_left_alone(tmp_path: Path) -> None:
    with Sessions(tmp_path) as sessions:
        used = [sessions.begin() for _ in range(2)]
        assert all(sessions.use(session) for session in used)
        for _ in range(2 * SESSIONS):
            sessions.begin()
        assert all(sessions.use(session) for session in used)


def test_an_unfinished_session_ends_after_a_while_and_a_used_one_does_not(tmp_path: Path) -> None:
    with Sessions(tmp_path, SECONDS) as sessions:
        used = ""
        while not (used and sessions.use(used)):  # until it was used in time
            used = sessions.begin()
        unfinished = sessions.begin()
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            assert sessions.use(used)
        assert sessions.use(used)  # any request after that ends what is overdue
        assert not sessions.use(unfinished)
        assert sessions.use(used)
