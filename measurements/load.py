"""Many clients at once over HTTP: does every one get the right answer?

What is right is what the server tells a single client before the others come, and that must name the same ids as
the base asked in process.
"""

from __future__ import annotations

import contextlib
import queue
import subprocess
import threading
import time
from dataclasses import dataclass, field
from typing import IO, TYPE_CHECKING, Any

import anyio
from httpx2 import AsyncClient
from mcp.client import Client
from mcp.client.streamable_http import streamable_http_client

from bench.markdown_tables import Table
from kb_serve.knowledge_base import KnowledgeBase
from measurements.memory import resident_mb
from measurements.setting import REPO, brief, environment, percentile, say

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Generator, Mapping, Sequence

    from measurements.setting import Setting

CLIENTS = 64
_TOOL = "blender_docs"
_START_SECONDS = 30
_PATIENCE_SECONDS = 30.0  # a call that takes longer is an error
_KEPT = 20  # errors and wrong answers that the report quotes


class NoServer(Exception):  # noqa: N818 - reads as the state it names
    """The HTTP server did not start; the message holds what it said."""


@dataclass(slots=True)
class Loaded:
    """What came of it: ms for every call that was answered, and a line for each error and each wrong answer.

    ``alone`` are the ms of a single client's calls before the others come.
    """

    alone: list[float] = field(default_factory=list[float])
    seconds: float = 0.0
    times: list[float] = field(default_factory=list[float])
    errors: list[str] = field(default_factory=list[str])
    wrong: list[str] = field(default_factory=list[str])


def measure(setting: Setting, serve: Sequence[str], queries: Sequence[str]) -> tuple[Loaded, float | None]:
    """Serves over HTTP, lets the clients ask, returns what came of it and the server's memory in MB.

    Raises NoServer.
    """
    seconds = min(5.0, setting.load_seconds) if setting.quick else setting.load_seconds
    say(f"load: {CLIENTS} HTTP clients for {seconds:g} s")
    loaded = Loaded()
    with _server(serve, setting) as (url, pid):
        right = anyio.run(_alone, url, queries, loaded)
        anyio.run(_together, url, right, seconds, loaded)
        memory = resident_mb(pid)
    loaded.wrong += _not_as_in_process(setting, right)
    return loaded, memory


@contextlib.contextmanager
def _server(serve: Sequence[str], setting: Setting) -> Generator[tuple[str, int]]:
    """A server on a free port: its address and process id."""
    process = subprocess.Popen(
        [*serve, "--http", "--port", "0"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=environment(setting.home),
        cwd=REPO,
    )
    try:
        assert process.stderr is not None
        yield _address(process.stderr), process.pid
    finally:
        process.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(10)
        process.kill()
        process.wait()


def _address(stream: IO[str]) -> str:
    """The address that the server tells on stderr; what follows there is read on, and dropped."""
    told: queue.Queue[str] = queue.Queue()
    said: list[str] = []

    def read() -> None:
        for line in stream:
            said.append(line.strip())
            if "http://" in line:
                told.put("http://" + line.split("http://", 1)[1].split()[0])
        told.put("")

    threading.Thread(target=read, daemon=True).start()
    try:
        url = told.get(timeout=_START_SECONDS)
    except queue.Empty:
        url = ""
    if not url:
        raise NoServer(f"simworlds serve --http told no address: {' '.join(said[-3:]) or 'it said nothing'}")
    return url


@contextlib.asynccontextmanager
async def _connected(url: str) -> AsyncGenerator[Client]:
    """A client of its own connection. Certificates, which take long to load, are not needed on loopback."""
    async with (
        AsyncClient(timeout=_PATIENCE_SECONDS, verify=False) as http,
        Client(streamable_http_client(url, http_client=http)) as client,
    ):
        yield client


async def _alone(url: str, queries: Sequence[str], loaded: Loaded) -> dict[str, dict[str, Any]]:
    """query → structured answer, asked by one client."""
    right: dict[str, dict[str, Any]] = {}
    async with _connected(url) as client:
        for query in queries:
            right[query] = await _ask(client, query, loaded.alone)
    return right


async def _ask(client: Client, query: str, times: list[float]) -> dict[str, Any]:
    began = time.perf_counter()
    result = await client.call_tool(_TOOL, {"query": query})
    times.append((time.perf_counter() - began) * 1e3)
    if result.is_error or result.structured_content is None:
        raise RuntimeError(f"an error instead of an answer: {result.content}")
    return result.structured_content


async def _together(url: str, right: Mapping[str, dict[str, Any]], seconds: float, loaded: Loaded) -> None:
    began = time.monotonic()
    async with anyio.create_task_group() as tasks:
        for number in range(CLIENTS):
            tasks.start_soon(_client, url, right, number, began + seconds, loaded)
    loaded.seconds = time.monotonic() - began


async def _client(
    url: str, right: Mapping[str, dict[str, Any]], number: int, until: float, loaded: Loaded
) -> None:
    """Asks one query after the other, each client from another place; connects again after an error."""
    queries = list(right)
    place = number * len(queries) // CLIENTS
    while time.monotonic() < until:
        try:
            async with _connected(url) as client:
                while time.monotonic() < until:
                    query = queries[place % len(queries)]
                    place += 1
                    if await _ask(client, query, loaded.times) != right[query]:
                        loaded.wrong.append(f"{query[:60]!r} was answered otherwise than to a client alone")
        except Exception as error:  # every failure counts, whatever its type
            loaded.errors.append(brief(error))
            await anyio.sleep(0.1)


def _not_as_in_process(setting: Setting, right: Mapping[str, dict[str, Any]]) -> list[str]:
    """The queries for which the server names other ids than the base asked directly."""
    wrong: list[str] = []
    with KnowledgeBase(setting.base) as knowledge:
        for query, answer in right.items():
            here = [hit.id for hit in knowledge.query(query).hits]
            if [hit["id"] for hit in answer["hits"]] != here:
                wrong.append(f"{query[:60]!r} names other ids over HTTP than in process")
    return wrong


def table(loaded: Loaded, memory: float | None) -> Table:
    """What came of it, as a table."""
    alone = (
        (f"{percentile(loaded.alone, share):.1f}" for share in (0.5, 0.95)) if loaded.alone else ("–", "–")
    )
    times = loaded.times or [0.0]
    together = (
        str(CLIENTS),
        f"{len(loaded.times):,}",
        str(len(loaded.errors)),
        str(len(loaded.wrong)),
        f"{len(loaded.times) / loaded.seconds:.0f}" if loaded.seconds else "–",
        f"{percentile(times, 0.5):.1f}",
        f"{percentile(times, 0.95):.1f}",
        f"{memory:.0f}" if memory is not None else "–",
    )
    rows = (("1", f"{len(loaded.alone):,}", "0", "0", "–", *alone, "–"), together)
    header = ("clients", "calls", "errors", "wrong", "calls/s", "p50 ms", "p95 ms", "server MB")
    note = (
        f"{loaded.seconds:.0f} s. All clients run in one process on the server's machine: calls a second are theirs "
        "as much as the server's."
    )
    examples = list(dict.fromkeys([*loaded.errors, *loaded.wrong]))[:5]
    return Table("HTTP load", header, rows, "\n".join([note, *(f"- {example}" for example in examples)]))


def as_data(loaded: Loaded) -> dict[str, Any]:
    """What came of it, as data."""
    times, alone = loaded.times or [0.0], loaded.alone or [0.0]
    return {
        "clients": CLIENTS,
        "seconds": loaded.seconds,
        "calls": len(loaded.times),
        "alone_p50_ms": percentile(alone, 0.5),
        "p50_ms": percentile(times, 0.5),
        "p95_ms": percentile(times, 0.95),
        "errors": loaded.errors[:_KEPT],
        "wrong": loaded.wrong[:_KEPT],
    }
