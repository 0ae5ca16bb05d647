"""Measures both servers under mixed load for a long time: whether they keep their memory, processes and manners.

Beside clients that ask one thing after another there are some that vanish in mid-call, cancel, and send what is not
MCP. The polite ones must be answered all along. Memory of the last third is compared with that of the second, by when
all is loaded; what is left of the servers' processes afterwards is counted by a mark in their environment.
"""

from __future__ import annotations

import contextlib
import itertools
import json
import secrets
import statistics
import time
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import anyio
from httpx2 import AsyncClient, HTTPError

from bench.markdown_tables import Table
from bench.sweep.command import simworlds_command
from measurements.http_server import running
from measurements.load import connected
from measurements.memory import resident_mb
from measurements.report import ReportPart, TargetFigure, run_steps
from measurements.retrieval import read_queries
from measurements.setting import BLENDER, brief, percentile, say

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Iterator, Sequence

    from measurements.setting import Setting

    _Call = tuple[str, dict[str, Any]]

_MARK = "SIMWORLDS_SOAK"
_SAMPLE_SECONDS = 5.0
_PAUSE_SECONDS = 0.25  # between the calls of a client: a soak is long, not heavy
_RUDE_PAUSE_SECONDS = 0.5
_PATIENCE_SECONDS = 60.0
_QUOTED = 20
_NO_MCP = (
    b"",
    b"{",
    b"[]",
    b'{"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {"name": "blender_nothing"}}',
    b'{"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {"name": "blender_docs", "arguments": []}}',
    b'{"jsonrpc": "1.0", "id": {}, "method": "\xff"}',
    b'{"id": ' + b"[" * 20_000,
    b"x" * 3_000_000,
)
_CODE = (
    "import bpy\nbpy.ops.mesh.primitive_cube_add(location=(0, 0, 1))\nlen(bpy.data.objects)",
    "bpy.context.object.location.x += 1.0",
    "bpy.context.object.no_such_thing",
    "for one in list(bpy.data.objects): bpy.data.objects.remove(one)",
    "bpy.ops.outliner.orphans_purge(do_recursive=True)",
)


@dataclass(slots=True)
class _Soaked:
    """ms of every polite call; a line for each that failed; MB and number of the server's processes over time."""

    times: list[float] = field(default_factory=list[float])
    errors: list[str] = field(default_factory=list[str])
    rude: int = 0
    memory: list[float] = field(default_factory=list[float])
    processes: list[int] = field(default_factory=list[int])
    orphans: int = 0

    def growth(self) -> float:
        """The last third's memory by the second's, medians; NaN for too few samples."""
        third = len(self.memory) // 3
        if not third:
            return float("nan")
        return statistics.median(self.memory[-third:]) / statistics.median(self.memory[third : 2 * third])


def measure(setting: Setting) -> ReportPart:
    """Soaks both servers one after the other, each for ``setting.load_seconds``."""
    return run_steps(
        "soak",
        {"simworlds serve": lambda: _of_documents(setting), "simworlds mcp": lambda: _of_blender(setting)},
    )


def _of_documents(setting: Setting) -> ReportPart:
    queries = [query.query for path in setting.queries for query in read_queries(path)]
    calls = [("blender_docs", {"query": query}) for query in queries]
    calls[::20] = [
        ("blender_check", {"code": code})
        for code, _ in zip(itertools.cycle(_CODE), calls[::20], strict=False)
    ]
    command = [*simworlds_command(), "serve", "--blender", BLENDER, "--no-rebuild"]
    return _soak("simworlds serve", command, calls, 8, setting)


def _of_blender(setting: Setting) -> ReportPart:
    calls: list[_Call] = [("blender_execute", {"code": code}) for code in _CODE]
    calls += [("blender_scene_state", {}), ("blender_docs", {"query": "ClothSettings.quality"})]
    command = [*simworlds_command(), "mcp", "--sessions", "4", "--idle", "0.5"]
    return _soak("simworlds mcp", command, calls, 2, setting)


def _soak(
    name: str, command: Sequence[str], calls: Sequence[_Call], polite: int, setting: Setting
) -> ReportPart:
    say(f"soak: {name} for {setting.load_seconds / 60:g} min")
    soaked = _Soaked()
    mark = secrets.token_hex(8)
    with running(command, setting, {_MARK: mark}) as (url, process):
        anyio.run(_together, (url, process.pid), calls, polite, setting.load_seconds, soaked)
        if process.poll() is not None:
            soaked.errors.append(f"the server ended with exit code {process.returncode}")
    time.sleep(1.0)  # for what was told to end
    soaked.orphans = sum(1 for _ in _marked(mark))
    figures = (
        TargetFigure("soak_errors", len(soaked.errors), f"{name}: of {len(soaked.times):,} calls"),
        TargetFigure("soak_growth", soaked.growth(), f"{name}: {_range(soaked.memory)} MB"),
        TargetFigure("soak_orphans", soaked.orphans, name),
    )
    return ReportPart(name, figures, (_table(name, soaked, setting.load_seconds),), data=asdict(soaked))


def _range(memory: Sequence[float]) -> str:
    return f"{min(memory):.0f} to {max(memory):.0f}" if memory else "no"


def _table(name: str, soaked: _Soaked, seconds: float) -> Table:
    times = soaked.times or [0.0]
    row = (
        f"{seconds / 60:g}",
        f"{len(soaked.times):,}",
        *(f"{percentile(times, share):.1f}" for share in (0.5, 0.95, 1.0)),
        f"{soaked.rude:,}",
        str(len(soaked.errors)),
        _range(soaked.memory),
        f"{soaked.growth():.3f}",
        str(max(soaked.processes, default=0)),
        str(soaked.orphans),
    )
    header = (
        *(
            "minutes",
            "calls",
            "p50 ms",
            "p95",
            "slowest",
            "rude",
            "errors",
            "MB",
            "growth",
            "processes at most",
        ),
        "left over",
    )
    quoted = "; ".join(dict.fromkeys(soaked.errors[:_QUOTED]))
    note = (
        "Rude: clients that vanished in mid-call, cancelled, or sent what is not MCP. MB: resident memory of the "
        "server's own process. Growth: of the last third by the second."
        + (f" Errors: {quoted}" if quoted else "")
    )
    return Table(f"Soak of {name}", header, (row,), note)


# The server


def _marked(mark: str) -> Iterator[int]:
    """The ids of the processes that have the mark in their environment."""
    wanted = f"{_MARK}={mark}".encode()
    for folder in Path("/proc").iterdir():
        with contextlib.suppress(OSError):
            if folder.name.isdigit() and wanted in (folder / "environ").read_bytes().split(b"\0"):
                yield int(folder.name)


def _descendants(pid: int) -> list[int]:
    """The ids of a process's children, their children and so on."""
    found: list[int] = []
    for folder in Path(f"/proc/{pid}/task").glob("*"):
        with contextlib.suppress(OSError, ValueError):
            for child in (folder / "children").read_text(encoding="ascii").split():
                found += [int(child), *_descendants(int(child))]
    return found


# Its clients


async def _together(
    server: tuple[str, int], calls: Sequence[_Call], polite: int, seconds: float, soaked: _Soaked
) -> None:
    """All clients at a server (address, process id) for some time."""
    url, pid = server
    until = time.monotonic() + seconds
    ways: list[Callable[[str, _Call], Coroutine[Any, Any, None]]] = [_vanish, _cancel, _babble]
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(_watch, pid, soaked)
        async with anyio.create_task_group() as clients:
            for number in range(polite):
                clients.start_soon(_polite, url, calls, number, until, soaked)
            for way in ways:
                clients.start_soon(_rude, partial(way, url), calls, until, soaked)
        tasks.cancel_scope.cancel()


async def _watch(pid: int, soaked: _Soaked) -> None:
    """Samples the server's memory and processes until it is cancelled."""
    while True:
        await anyio.sleep(_SAMPLE_SECONDS)
        if (memory := resident_mb(pid)) is not None:
            soaked.memory.append(memory)
            soaked.processes.append(1 + len(_descendants(pid)))


async def _polite(url: str, calls: Sequence[_Call], number: int, until: float, soaked: _Soaked) -> None:
    """One call after another, each client from another start. Wrong code may fail; that the server does may not."""
    order = itertools.cycle([*calls[number:], *calls[:number]])
    while time.monotonic() < until:
        try:
            async with connected(url, _PATIENCE_SECONDS) as client:
                while time.monotonic() < until:
                    tool, arguments = next(order)
                    began = time.perf_counter()
                    await client.call_tool(tool, arguments)
                    soaked.times.append((time.perf_counter() - began) * 1e3)
                    await anyio.sleep(_PAUSE_SECONDS)
        except Exception as error:  # every failure counts, whatever its type
            soaked.errors.append(brief(error))
            await anyio.sleep(_PAUSE_SECONDS)


async def _rude(
    way: Callable[[_Call], Coroutine[Any, Any, None]], calls: Sequence[_Call], until: float, soaked: _Soaked
) -> None:
    for call in itertools.cycle(calls):
        if time.monotonic() >= until:
            return
        with contextlib.suppress(Exception):  # whatever a server answers to this is right
            await way(call)
        soaked.rude += 1
        await anyio.sleep(_RUDE_PAUSE_SECONDS)


async def _vanish(url: str, call: _Call) -> None:
    """Sends a request, or half of one, and closes the connection without reading."""
    place = urlsplit(url)
    tool, arguments = call
    body = json.dumps(
        {"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {"name": tool, "arguments": arguments}}
    )
    head = (
        f"POST {place.path} HTTP/1.1\r\nHost: {place.netloc}\r\nContent-Type: application/json\r\n"
        f"Accept: application/json, text/event-stream\r\nContent-Length: {len(body)}\r\n\r\n"
    )
    async with await anyio.connect_tcp(str(place.hostname), place.port or 80) as stream:
        whole = (head + body).encode()
        await stream.send(whole[: secrets.randbelow(len(whole)) + 1])
        await anyio.sleep(secrets.randbelow(50) / 1e3)


async def _cancel(url: str, call: _Call) -> None:
    """Calls, and has no patience."""
    async with connected(url, _PATIENCE_SECONDS) as client:
        with anyio.move_on_after(secrets.randbelow(100) / 1e3):
            await client.call_tool(*call)


async def _babble(url: str, _call: _Call) -> None:
    """Sends what is no MCP."""
    async with AsyncClient(timeout=_PATIENCE_SECONDS, verify=False) as http:
        with contextlib.suppress(HTTPError):
            await http.post(
                url, content=secrets.choice(_NO_MCP), headers={"Content-Type": "application/json"}
            )
