"""Measures many clients at once over HTTP, and whether each gets the correct answer.

An answer is correct if it equals that to a single client before the others start, which must name the same ids as the
base in process.
"""

from __future__ import annotations

import contextlib
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import anyio
from httpx2 import AsyncClient
from mcp.client import Client
from mcp.client.streamable_http import streamable_http_client

from bench.markdown_tables import Table
from kb_serve.knowledge_base import KnowledgeBase
from measurements.http_server import running
from measurements.memory import resident_mb
from measurements.setting import brief, percentile, say

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Mapping, Sequence

    from measurements.setting import Setting

CLIENTS = 64
_TOOL = "blender_docs"
_PATIENCE_SECONDS = 30.0  # a call that takes longer is an error
_KEPT = 20  # errors and wrong answers that the report quotes


@dataclass(slots=True)
class LoadResult:
    """ms of every answered call, and a line for each error and each wrong answer.

    ``alone``: ms of a single client's calls before the others start.
    """

    alone: list[float] = field(default_factory=list[float])
    seconds: float = 0.0
    times: list[float] = field(default_factory=list[float])
    errors: list[str] = field(default_factory=list[str])
    wrong: list[str] = field(default_factory=list[str])


def measure(
    setting: Setting, serve: Sequence[str], queries: Sequence[str]
) -> tuple[LoadResult, float | None]:
    """Starts a server and all clients. Returns the result and the server's memory in MB.

    Raises NoServer.
    """
    seconds = min(5.0, setting.load_seconds) if setting.quick else setting.load_seconds
    say(f"load: {CLIENTS} HTTP clients for {seconds:g} s")
    result = LoadResult()
    with running(serve, setting) as (url, process):
        right = anyio.run(_alone, url, queries, result)
        anyio.run(_together, url, right, seconds, result)
        memory = resident_mb(process.pid)
    result.wrong += _not_as_in_process(setting, right)
    return result, memory


@contextlib.asynccontextmanager
async def connected(url: str, patience: float = _PATIENCE_SECONDS) -> AsyncGenerator[Client]:
    """A client of its own connection, which waits ``patience`` seconds for an answer. Certificates, which take long to
    load, are not needed on loopback.
    """
    async with (
        AsyncClient(timeout=patience, verify=False) as http,
        Client(streamable_http_client(url, http_client=http)) as client,
    ):
        yield client


async def _alone(url: str, queries: Sequence[str], result: LoadResult) -> dict[str, dict[str, Any]]:
    """query → structured answer, asked by one client."""
    right: dict[str, dict[str, Any]] = {}
    async with connected(url) as client:
        for query in queries:
            right[query] = await _ask(client, query, result.alone)
    return right


async def _ask(client: Client, query: str, times: list[float]) -> dict[str, Any]:
    began = time.perf_counter()
    result = await client.call_tool(_TOOL, {"query": query})
    times.append((time.perf_counter() - began) * 1e3)
    if result.is_error or result.structured_content is None:
        raise RuntimeError(f"an error instead of an answer: {result.content}")
    return result.structured_content


async def _together(
    url: str, right: Mapping[str, dict[str, Any]], seconds: float, result: LoadResult
) -> None:
    began = time.monotonic()
    async with anyio.create_task_group() as tasks:
        for number in range(CLIENTS):
            tasks.start_soon(_client, url, right, number, began + seconds, result)
    result.seconds = time.monotonic() - began


async def _client(
    url: str, right: Mapping[str, dict[str, Any]], number: int, until: float, result: LoadResult
) -> None:
    """Sends one query after another, each client from another start; reconnects after an error."""
    queries = list(right)
    place = number * len(queries) // CLIENTS
    while time.monotonic() < until:
        try:
            async with connected(url) as client:
                while time.monotonic() < until:
                    query = queries[place % len(queries)]
                    place += 1
                    if await _ask(client, query, result.times) != right[query]:
                        result.wrong.append(
                            f"{query[:60]!r} was answered differently than to a single client"
                        )
        except Exception as error:  # every failure counts, whatever its type
            result.errors.append(brief(error))
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


def table(result: LoadResult, memory: float | None) -> Table:
    """The result as a table."""
    alone = (
        (f"{percentile(result.alone, share):.1f}" for share in (0.5, 0.95)) if result.alone else ("–", "–")
    )
    times = result.times or [0.0]
    together = (
        str(CLIENTS),
        f"{len(result.times):,}",
        str(len(result.errors)),
        str(len(result.wrong)),
        f"{len(result.times) / result.seconds:.0f}" if result.seconds else "–",
        f"{percentile(times, 0.5):.1f}",
        f"{percentile(times, 0.95):.1f}",
        f"{memory:.0f}" if memory is not None else "–",
    )
    rows = (("1", f"{len(result.alone):,}", "0", "0", "–", *alone, "–"), together)
    header = ("clients", "calls", "errors", "wrong", "calls/s", "p50 ms", "p95 ms", "server MB")
    note = (
        f"{result.seconds:.0f} s. All clients run in one process on the server's machine: calls a second are theirs "
        "as much as the server's."
    )
    examples = list(dict.fromkeys([*result.errors, *result.wrong]))[:5]
    return Table("HTTP load", header, rows, "\n".join([note, *(f"- {example}" for example in examples)]))


def as_data(result: LoadResult) -> dict[str, Any]:
    """The result as data."""
    times, alone = result.times or [0.0], result.alone or [0.0]
    return {
        "clients": CLIENTS,
        "seconds": result.seconds,
        "calls": len(result.times),
        "alone_p50_ms": percentile(alone, 0.5),
        "p50_ms": percentile(times, 0.5),
        "p95_ms": percentile(times, 0.95),
        "errors": result.errors[:_KEPT],
        "wrong": result.wrong[:_KEPT],
    }
