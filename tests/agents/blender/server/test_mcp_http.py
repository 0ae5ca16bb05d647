"""``simworlds mcp --http``: who is let in, and that nobody gets another one's Blender."""

from __future__ import annotations

import json
import signal
from ast import literal_eval
from contextlib import asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import anyio
import anyio.to_thread
import httpx2
import pytest
from mcp import Client
from mcp.client.streamable_http import streamable_http_client
from mcp.shared.exceptions import MCPError
from serving import OverHttp, await_file, below, blenders, have_ended

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Iterator

    from anyio.abc import TaskGroup
    from built_base import Built
    from mcp_types import CallToolResult

pytestmark = [pytest.mark.blender, pytest.mark.anyio]

TOKEN = "a-secret-of-this-test"
WITH_TOKEN = {"Authorization": f"Bearer {TOKEN}"}
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
FOREVER = "while True: pass"


@pytest.fixture(scope="module")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def home(built_once: Built) -> Path:
    """One with a base, though nothing is looked up here: without one, each server would begin to build it."""
    return built_once.home


@pytest.fixture(scope="module")
def server(home: Path) -> Iterator[OverHttp]:
    with OverHttp(home, "--sessions", "2") as running:
        yield running


@pytest.fixture(scope="module")
def guarded(home: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Guarded]:
    folder = tmp_path_factory.mktemp("guarded")
    with OverHttp(home, "--run", str(folder), "--host", "0.0.0.0", SIMWORLDS_TOKEN=TOKEN) as running:
        yield Guarded(running, running.url.replace("0.0.0.0", "127.0.0.1"), folder)


class Guarded(NamedTuple):
    """A server that asks for a token, and works in one folder."""

    server: OverHttp
    url: str
    folder: Path

    @asynccontextmanager
    async def client(self) -> AsyncIterator[Client]:
        """One that has the token."""
        async with (
            httpx2.AsyncClient(headers=WITH_TOKEN) as http,
            Client(streamable_http_client(self.url, http_client=http)) as client,
        ):
            yield client


async def run(client: Client, code: str) -> CallToolResult:
    return await client.call_tool("blender_execute", {"code": code})


async def value(client: Client, code: str) -> str:
    answer = await run(client, code)
    assert not answer.is_error, said(answer)
    assert answer.structured_content is not None
    return answer.structured_content["value"]


def said(answer: CallToolResult) -> str:
    assert answer.content[0].type == "text"
    return answer.content[0].text


class Session:
    """A session that is spoken to request by request, and leaves nothing to a client's discretion."""

    def __init__(self, http: httpx2.AsyncClient, url: str, headers: dict[str, str]) -> None:
        self._http = http
        self._url = url
        self.headers = headers

    @classmethod
    async def begin(cls, http: httpx2.AsyncClient, url: str) -> Session:
        greeted = await http.post(url, json=HELLO, headers=ACCEPT)
        session = cls(http, url, {**ACCEPT, "Mcp-Session-Id": greeted.headers["mcp-session-id"]})
        await http.post(
            url, json={"jsonrpc": "2.0", "method": "notifications/initialized"}, headers=session.headers
        )
        return session

    async def run(self, code: str) -> str:
        """The value of a piece of code; "" if no answer comes."""
        parameters = {"name": "blender_execute", "arguments": {"code": code}}
        ask = {"jsonrpc": "2.0", "id": 2, "method": "tools/call", "params": parameters}
        try:
            answer = await self._http.post(self._url, json=ask, headers=self.headers)
        except httpx2.HTTPError:
            return ""
        events = [line.removeprefix("data: ") for line in answer.text.splitlines() if line[:6] == "data: "]
        return json.loads(events[-1])["result"]["structuredContent"]["value"] if events else ""

    async def occupy(self, calls: TaskGroup, workspace: Path) -> None:
        """Lets Blender run code without end; returns when it does."""
        calls.start_soon(self.run, f"open('begun', 'w').close()\n{FOREVER}")
        await anyio.to_thread.run_sync(await_file, workspace / "begun")


# Whose Blender it is


@pytest.mark.parametrize("mode", ["auto", pytest.param("legacy", marks=pytest.mark.whole)])
async def test_two_clients_at_once_each_have_a_scene_of_their_own(server: OverHttp, mode: Any) -> None:
    async def count(client: Client, name: str) -> None:
        for number in range(1, 6):
            code = f"s = bpy.context.scene\ns[{name!r}] = s.get({name!r}, 0) + 1\ndict(s)[{name!r}], len(s.keys())"
            assert await value(client, code) == f"({number}, 1)"

    async with Client(server.url, mode=mode) as one, Client(server.url, mode=mode) as other:
        async with anyio.create_task_group() as calls:
            calls.start_soon(count, one, "one")
            calls.start_soon(count, other, "other")
        folders = {await value(client, "import os; os.getcwd()") for client in (one, other)}
        assert len(folders) == 2


async def test_refuses_clients_beyond_the_limit_until_one_leaves(server: OverHttp) -> None:
    async with Client(server.url) as stays, Client(server.url) as waits:
        async with Client(server.url) as leaves:
            assert [await value(client, "1") for client in (stays, leaves)] == ["1", "1"]
            refused = await run(waits, "1")
            assert refused.is_error
            assert "--sessions" in said(refused)
            assert len((await waits.list_tools()).tools) > 1
        assert await value(waits, "'in'") == "'in'"


async def test_a_client_that_ends_its_session_leaves_no_blender_behind(server: OverHttp) -> None:
    async with Client(server.url) as client:
        before = blenders(server.process.pid)
        await value(client, "1")
        its_own = blenders(server.process.pid) - before
        assert its_own
    assert have_ended(its_own)


async def test_closing_a_busy_session_ends_its_blender(server: OverHttp) -> None:
    async with httpx2.AsyncClient(timeout=60) as http, anyio.create_task_group() as calls:
        session = await Session.begin(http, server.url)
        before = blenders(server.process.pid)
        await session.occupy(calls, Path(literal_eval(await session.run("import os; os.getcwd()"))))
        its_own = blenders(server.process.pid) - before
        assert its_own
        assert (await http.delete(server.url, headers=session.headers)).status_code == 200
        assert have_ended(its_own)


async def test_a_cancelled_call_is_undone(server: OverHttp) -> None:
    async with Client(server.url) as client:
        await run(client, "bpy.context.scene['kept'] = 1")
        with anyio.move_on_after(1.0):
            await run(client, f"bpy.context.scene['kept'] = 2\n{FOREVER}")
        assert await value(client, "bpy.context.scene['kept']") == "1"


async def test_closes_an_idle_blender_and_continues_its_run_later(home: Path) -> None:
    with OverHttp(home, "--idle", "0.02") as server:
        async with Client(server.url) as client:
            await run(client, "bpy.ops.mesh.primitive_cone_add()\nbpy.context.object.name = 'Left'")
            first = blenders(server.process.pid)
            assert have_ended(first)
            assert await value(client, "[thing.name for thing in bpy.data.objects]") == "['Left']"
            assert blenders(server.process.pid) - first


async def test_named_run_folder_serves_one_client(guarded: Guarded) -> None:
    async with guarded.client() as second:
        async with guarded.client() as first:
            await run(first, "bpy.context.scene['by'] = 'first'")
            refused = await run(second, "1")
            assert refused.is_error
            assert "--run" in said(refused)
        assert await value(second, "bpy.context.scene['by']") == "'first'"


# Who is let in


def test_requests_without_a_session_are_refused(server: OverHttp) -> None:
    ask = {"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {"name": "blender_execute"}}
    for headers in ({}, {"Mcp-Session-Id": "0" * 32}):
        answer = httpx2.post(server.url, json=ask, headers={**ACCEPT, **headers})
        assert answer.status_code in {400, 404}


async def test_sessionless_protocol_is_refused_with_supported_versions(
    server: OverHttp,
) -> None:
    async with Client(server.url, mode="2026-07-28") as client:
        with pytest.raises(MCPError, match="has sessions") as refused:
            await client.call_tool("blender_execute", {"code": "1"})
    assert "2025-11-25" in refused.value.error.data["supported"]


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Host": "evil.example"}, 421),
        ({"Origin": "http://evil.example"}, 403),
        ({"Origin": "http://localhost:3000"}, 200),
    ],
)
def test_refuses_foreign_hosts_and_origins(server: OverHttp, headers: dict[str, str], status: int) -> None:
    answer = httpx2.post(server.url, json=HELLO, headers={**ACCEPT, **headers})
    assert answer.status_code == status
    if status == 200:
        session = {"Mcp-Session-Id": answer.headers["mcp-session-id"]}
        assert httpx2.delete(server.url, headers={**ACCEPT, **session}).status_code == 200


async def test_unfinished_initialisations_do_not_shut_clients_out(server: OverHttp) -> None:
    async with httpx2.AsyncClient() as http:
        for _ in range(150):
            assert (await http.post(server.url, json=HELLO, headers=ACCEPT)).status_code == 200
    async with Client(server.url, mode="legacy") as client:
        assert len((await client.list_tools()).tools) > 1


async def test_requires_the_token(guarded: Guarded) -> None:
    for wrong in ({}, {"Authorization": f"Bearer {TOKEN}x"}):
        assert httpx2.post(guarded.url, json=HELLO, headers={**ACCEPT, **wrong}).status_code == 401
    async with guarded.client() as client:
        assert len((await client.list_tools()).tools) > 1


# The end


async def test_signal_ends_the_server_and_a_busy_blender(guarded: Guarded) -> None:
    server = guarded.server
    async with (
        httpx2.AsyncClient(timeout=60, headers=WITH_TOKEN) as http,
        anyio.create_task_group() as calls,
    ):
        session = await Session.begin(http, guarded.url)
        await session.occupy(calls, guarded.folder / "workspace")
        started = below(server.process.pid)
        assert blenders(server.process.pid)
        code, out, err = server.end(signal.SIGTERM)
    assert (code, out) == (0, "")
    assert "Traceback" not in err
    assert have_ended(started)
