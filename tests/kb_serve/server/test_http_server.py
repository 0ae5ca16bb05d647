"""The server over streamable HTTP: who is let in, and that everybody gets the right answer."""

from __future__ import annotations

import json
import os
import random
import signal
import socket
import subprocess
import sys
import time
from collections import Counter
from contextlib import ExitStack
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import anyio
import httpx2
import pytest
from mcp import Client
from mcp.client.streamable_http import streamable_http_client
from running import COMMAND, REPO, HttpServer, environment, run_here

from kb_serve.knowledge_base import KnowledgeBase
from simworlds.loopback import is_loopback
from simworlds.mcp_transport.http import Address, CannotServe, check

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

QUALITY = "bpy.types.ClothSettings.quality"
TOKEN = "a-secret-of-this-test"
CLIENTS = 64
SECONDS = float(os.environ.get("SIMWORLDS_LOAD_SECONDS", "2"))
ASK = {
    "jsonrpc": "2.0",
    "id": 1,
    "method": "tools/call",
    "params": {"name": "blender_docs", "arguments": {"query": QUALITY}},
}
ACCEPT = {"Accept": "application/json, text/event-stream"}


@pytest.fixture(scope="module")
def home_of_servers(base: Path) -> Path:
    return base.parent.parent


@pytest.fixture(scope="module")
def server(home_of_servers: Path) -> Iterator[HttpServer]:
    with HttpServer(home_of_servers, "--no-rebuild") as running:
        yield running


@pytest.fixture(scope="module")
def guarded(home_of_servers: Path) -> Iterator[HttpServer]:
    with HttpServer(home_of_servers, "--no-rebuild", SIMWORLDS_TOKEN=TOKEN) as running:
        yield running


def post(url: str, content: object = ASK, **headers: str) -> httpx2.Response:
    body = content if isinstance(content, bytes) else json.dumps(content).encode()
    given = {"Content-Type": "application/json", **ACCEPT, **headers}
    return httpx2.post(url, content=body, headers=given, timeout=60)


@pytest.mark.anyio
@pytest.mark.parametrize("mode", ["auto", "legacy"])
async def test_a_client_gets_answers_and_resources(server: HttpServer, mode: Any) -> None:
    async with Client(server.url, mode=mode) as client:
        assert [tool.name for tool in (await client.list_tools()).tools] == ["blender_docs", "blender_check"]
        result = await client.call_tool("blender_docs", {"query": "ClothSettings.quality"})
        page = await client.read_resource("blender://5.1/page/physics/cloth/introduction")
    assert result.structured_content is not None
    assert result.structured_content["hits"][0]["id"] == QUALITY
    assert page.contents


def test_an_answer_needs_no_session(server: HttpServer) -> None:
    answer = post(server.url)
    assert answer.status_code == 200
    assert answer.json()["result"]["structuredContent"]["hits"][0]["id"] == QUALITY


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:80", "127.0.0.1.evil.example", "10.0.0.1", ""]
)
def test_a_name_that_somebody_else_points_here_is_refused(server: HttpServer, host: str) -> None:
    assert post(server.url, Host=host).status_code in {400, 403, 421}


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1", "localhost:1234", "[::1]:1234"])
def test_names_of_this_machine_are_let_in(server: HttpServer, host: str) -> None:
    assert post(server.url, Host=host).status_code == 200


@pytest.mark.parametrize("origin", ["http://evil.example", "https://evil.example:8765", "null", "file://"])
def test_a_foreign_web_page_is_refused(server: HttpServer, origin: str) -> None:
    assert post(server.url, Origin=origin).status_code == 403


def test_a_page_of_this_machine_is_let_in(server: HttpServer) -> None:
    assert post(server.url, Origin="http://localhost:3000").status_code == 200


@pytest.mark.parametrize(
    "authorization",
    [
        None,
        "",
        "Bearer",
        "Bearer wrong",
        f"Bearer {TOKEN}x",
        f"Bearer {TOKEN[:-1]}",
        f"Basic {TOKEN}",
        TOKEN,
        "Bearer \xff\xfe",
    ],
)
def test_without_the_token_nothing_is_answered(guarded: HttpServer, authorization: str | None) -> None:
    headers = {} if authorization is None else {"Authorization": authorization.encode("latin-1")}
    given = {"Content-Type": "application/json", **ACCEPT, **headers}
    answer = httpx2.post(guarded.url, content=json.dumps(ASK), headers=given)
    assert answer.status_code == 401
    assert answer.headers["WWW-Authenticate"] == "Bearer"
    assert "result" not in answer.text
    assert TOKEN not in answer.text


def test_the_token_guards_every_path(guarded: HttpServer) -> None:
    for path in ("/", "/mcp/", "/.well-known/oauth-protected-resource", "/docs"):
        assert httpx2.get(guarded.url.removesuffix("/mcp") + path).status_code == 401


@pytest.mark.parametrize("scheme", ["Bearer", "bearer"])
def test_with_the_token_there_is_an_answer(guarded: HttpServer, scheme: str) -> None:
    assert post(guarded.url, Authorization=f"{scheme} {TOKEN}").status_code == 200


@pytest.mark.anyio
async def test_a_client_with_the_token_gets_answers(guarded: HttpServer) -> None:
    async with (
        httpx2.AsyncClient(headers={"Authorization": f"Bearer {TOKEN}"}) as http,
        Client(streamable_http_client(guarded.url, http_client=http)) as client,
    ):
        result = await client.call_tool("blender_docs", {"query": QUALITY})
    assert not result.is_error


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.1.5", "::", "example.org", "", "127.0.0.1.example.org"])
def test_no_other_address_without_a_token(home_of_servers: Path, host: str) -> None:
    words = ["serve", "--http", "--host", host, "--port", "0"]
    done = run_here(words, environment(home_of_servers), REPO)
    assert done.returncode == 2
    assert done.stdout == b""
    assert b"SIMWORLDS_TOKEN" in done.stderr


def test_with_a_token_any_address_will_do() -> None:
    check(Address("0.0.0.0", token=TOKEN))
    for token in ("", " \n"):
        with pytest.raises(CannotServe):
            check(Address("0.0.0.0", token=token))


@pytest.mark.parametrize(
    "name", ["docs.example.org", "docs.example.org:8443", "10.0.0.7", "[fe80::1]", "MY_PC"]
)
def test_names_that_clients_may_send_are_let_in(name: str) -> None:
    check(Address(names=(name,)))


def test_loopback_is_decided_by_address_not_by_name() -> None:
    assert [host for host in ("127.0.0.1", "127.8.9.1", "::1", "localhost") if not is_loopback(host)] == []
    assert [
        host
        for host in ("0.0.0.0", "::", "localhost.example.org", "127.0.0.1.nip.io", "")
        if is_loopback(host)
    ] == []


def test_on_all_addresses_names_are_still_checked(home_of_servers: Path) -> None:
    authorization = f"Bearer {TOKEN}"
    with HttpServer(
        home_of_servers,
        "--no-rebuild",
        "--host",
        "0.0.0.0",
        "--allow-host",
        "Docs.Example",
        SIMWORLDS_TOKEN=TOKEN,
    ) as running:
        port = running.url.rpartition(":")[2].removesuffix("/mcp")
        url = f"http://127.0.0.1:{port}/mcp"
        assert post(url).status_code == 401
        assert post(url, Authorization=authorization).status_code == 200
        assert (
            post(url, Authorization=authorization, Host=f"{socket.gethostname()}:{port}").status_code == 200
        )
        assert running.url == url
        name = f"{socket.gethostname().upper()}:{port}"
        assert post(url, Authorization=authorization, Host=name).status_code == 200
        assert post(url, Authorization=authorization, Host="docs.example").status_code == 200
        assert post(url, Authorization=authorization, Host="DOCS.EXAMPLE").status_code == 200
        assert post(url, Authorization=authorization, Host="evil.example").status_code == 421


@pytest.mark.skipif(not socket.has_dualstack_ipv6(), reason="this system keeps IPv4 and IPv6 apart")
def test_all_addresses_of_version_6_are_those_of_version_4_too(home_of_servers: Path) -> None:
    # As a file of secrets often has it.
    with HttpServer(home_of_servers, "--no-rebuild", "--host", "::", SIMWORLDS_TOKEN=f"{TOKEN}\n") as running:
        port = running.url.rpartition(":")[2].removesuffix("/mcp")
        assert running.url == f"http://127.0.0.1:{port}/mcp"
        assert post(running.url, Authorization=f"Bearer {TOKEN}").status_code == 200
        assert post(f"http://[::1]:{port}/mcp", Authorization=f"Bearer {TOKEN}").status_code == 200


def test_a_port_that_is_taken_is_named(home_of_servers: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        done = subprocess.run(
            [*COMMAND, "serve", "--http", "--port", port],
            env=environment(home_of_servers),
            cwd=REPO,
            capture_output=True,
            text=True,
            check=False,
            timeout=30,
        )
    assert done.returncode == 2
    assert port in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_the_server_cleanly_though_a_connection_is_open(
    home_of_servers: Path, number: int
) -> None:
    with HttpServer(home_of_servers, "--no-rebuild") as running:
        assert post(running.url).status_code == 200
        host, _, port = running.url.removeprefix("http://").removesuffix("/mcp").rpartition(":")
        with socket.create_connection((host, int(port))) as kept:
            kept.sendall(f"GET /mcp HTTP/1.1\r\nHost: {host}\r\nAccept: text/event-stream\r\n\r\n".encode())
            assert kept.recv(100).startswith(b"HTTP/1.1 ")
            code, out, err = running.end(number)
    assert (code, out) == (0, "")
    assert "Traceback" not in err


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"not json",
        b"[]",
        b"{}",
        b"\0",
        b"\xff\xfe",
        b"[" * 100_000,
        b'{"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {"name": "blender_docs"}}',
        b'{"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": []}',
        b'{"jsonrpc": "2.0", "id": 1, "method": "no/such"}',
        b'{"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {"name": "blender_docs", "arguments": '
        b'{"query": "\\ud800"}}}',
    ],
)
def test_requests_that_make_no_sense_are_refused_and_others_still_served(
    server: HttpServer, content: bytes
) -> None:
    answer = post(server.url, content)
    assert answer.status_code in {200, 202, 400, 404}
    assert "Traceback" not in answer.text
    assert post(server.url).status_code == 200


def test_there_are_no_streams_that_could_be_held_open(server: HttpServer) -> None:
    answer = httpx2.get(server.url, headers={"Accept": "text/event-stream"}, timeout=60)
    assert answer.status_code == 405
    assert answer.headers["Allow"] == "POST"


def test_half_open_connections_shut_nobody_out(home_of_servers: Path) -> None:
    with HttpServer(home_of_servers, "--no-rebuild", descriptors=128) as running, ExitStack() as opened:
        port = int(running.url.rpartition(":")[2].removesuffix("/mcp"))
        for number in range(300):
            connection = opened.enter_context(socket.create_connection(("127.0.0.1", port)))
            connection.sendall(b"POST /mcp HTTP/1.1\r\n")
            if number % 50 == 49:
                assert post(running.url).status_code == 200


def test_a_request_too_large_is_refused(server: HttpServer) -> None:
    assert post(server.url, b" " * (2 * 1024 * 1024)).status_code == 413


QUERIES = (
    "ClothSettings.quality",
    "bpy.ops.object.modifier_add",
    'bpy.context.object.modifiers["Cloth"].settings.quality',
    "make cloth collide with itself",
    "bake rigid body simulation",
    "cloth",
    "qualty steps",
    "AttributeError: 'Mesh' object has no attribute 'use_auto_smooth'",
    "subdivision surface levels",
    "BLENDER_EEVEE",
    "how to add a keyframe to the location of an object",
    "no such thing at all xyzzy",
)


@pytest.mark.anyio
async def test_many_clients_at_once_all_get_the_right_answers(
    server: HttpServer, home_of_servers: Path
) -> None:
    """For SIMWORLDS_LOAD_SECONDS, two by default; pytest -s shows how many and how fast."""
    with KnowledgeBase.open(home=home_of_servers) as direct:
        version = direct.meta["blender"]
        right = {
            query: json.loads(json.dumps({**asdict(direct.query(query, max_tokens=600)), "blender": version}))
            for query in QUERIES
        }
    seen: Counter[str] = Counter()
    times: list[float] = []
    answered: set[int] = set()  # every client gets an answer, however long a busy machine takes
    deadline = time.monotonic() + SECONDS

    async def client(number: int) -> None:
        choose = random.Random(number)
        async with Client(server.url) as connected:
            while number not in answered or time.monotonic() < deadline:
                query = choose.choice(QUERIES)
                began = time.perf_counter()
                result = await connected.call_tool("blender_docs", {"query": query, "max_tokens": 600})
                times.append(time.perf_counter() - began)
                kind = (
                    "error"
                    if result.is_error
                    else "right"
                    if result.structured_content == right[query]
                    else "wrong"
                )
                seen[kind] += 1
                answered.add(number)

    async with anyio.create_task_group() as clients:
        for number in range(CLIENTS):
            clients.start_soon(client, number)
    times.sort()
    p50, p95 = (times[int(len(times) * part)] * 1000 for part in (0.5, 0.95))
    sys.stdout.write(f"{len(times) / SECONDS:.0f} answers a second; p50 {p50:.0f} ms, p95 {p95:.0f} ms\n")
    assert set(seen) == {"right"}, seen
    assert seen["right"] >= CLIENTS
