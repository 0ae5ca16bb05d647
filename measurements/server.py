"""Measures the server from outside: start, calls over stdio next to an echo tool, the cold command, HTTP load.

Everything uses the real MCP client and command. A first run that does not count writes byte code and fills the system's
file cache.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING

import anyio
from mcp import StdioServerParameters
from mcp.client import Client
from mcp.client.stdio import stdio_client

from bench.markdown_tables import Table
from bench.sweep.command import simworlds_command
from measurements import load
from measurements.echo import TOOL as ECHO
from measurements.memory import children, resident_mb
from measurements.report import ReportPart, TargetFigure, run_steps
from measurements.retrieval import read_queries
from measurements.setting import BLENDER, REPO, environment, percentile, say

if TYPE_CHECKING:
    from collections.abc import Sequence

    from measurements.setting import Setting

TOOL = "blender_docs"
STARTS = 3
COLD_RUNS = 7
_FIRST = "bpy.types.Scene.frame_end"
_COLD = ("ClothSettings.quality", "how do I bake a rigid body simulation")


@dataclass(slots=True)
class _Stdio:
    """Several starts of one server: seconds to the first answer, ms per call, MB at the end."""

    starts: list[float] = field(default_factory=list[float])
    calls: list[float] = field(default_factory=list[float])
    memory: list[float] = field(default_factory=list[float])


def measure(setting: Setting) -> ReportPart:
    """Measures all that a client or a shell experiences."""
    if reason := _unusable(setting):
        return ReportPart("server", skipped=(reason,))
    steps = {"over stdio": _over_stdio, "simworlds docs": _cold, "under HTTP load": _under_load}
    part = run_steps("server", {name: partial(step, setting) for name, step in steps.items()})
    memory = sorted((size, name) for name, data in part.data.items() for size in data.get("resident_mb", ()))
    return replace(part, figures=(*part.figures, *(TargetFigure("memory", *most) for most in memory[-1:])))


def _over_stdio(setting: Setting) -> ReportPart:
    queries = [query.query for query in read_queries(setting.queries[0])]
    say("server: calls over stdio")
    ours = anyio.run(_stdio, _serve(), TOOL, queries, setting)
    say("server: an echo tool, side by side")
    echo = anyio.run(_stdio, [sys.executable, "-m", "measurements.echo"], ECHO, queries, setting)
    data = {"simworlds": asdict(ours), "echo": asdict(echo), "resident_mb": ours.memory}
    figures = (
        TargetFigure(
            "mcp_p50", percentile(ours.calls, 0.5), f"echo here {percentile(echo.calls, 0.5):.1f} ms"
        ),
        TargetFigure(
            "mcp_times", percentile(ours.calls, 0.5) / percentile(echo.calls, 0.5), "in the same run"
        ),
        TargetFigure(
            "start", percentile(ours.starts, 0.5), f"echo here {percentile(echo.starts, 0.5):.2f} s"
        ),
    )
    tables = (_stdio_table({"simworlds serve": ours, "echo tool": echo}),)
    return ReportPart("over stdio", figures, tables, data=data)


def _under_load(setting: Setting) -> ReportPart:
    """Sends the queries of all sets: more than the server caches."""
    queries = dict.fromkeys(query.query for path in setting.queries for query in read_queries(path))
    result, resident = load.measure(setting, _serve(), list(queries))
    note = f"of {len(result.times):,} calls"
    figures = (
        TargetFigure("load_errors", len(result.errors), note),
        TargetFigure("load_wrong", len(result.wrong), note),
    )
    data = load.as_data(result) | {"resident_mb": [resident] if resident is not None else []}
    return ReportPart("under HTTP load", figures, (load.table(result, resident),), data=data)


def _serve() -> list[str]:
    """The command that serves; it must not rebuild the base in the background."""
    return [*simworlds_command(), "serve", "--blender", BLENDER, "--no-rebuild"]


def _unusable(setting: Setting) -> str:
    """The reason why the command cannot be measured; "" if it answers. Writes byte code."""
    try:
        _docs(setting, _FIRST)
        return ""
    except subprocess.CalledProcessError as error:
        lines = (error.stderr or error.stdout or "").strip().splitlines()
        output = lines[-1] if lines else "it printed nothing"
        return f"simworlds docs failed with exit code {error.returncode}: {output}"
    except (OSError, subprocess.SubprocessError) as error:
        return f"simworlds docs could not be run: {error}"


def _docs(setting: Setting, query: str) -> None:
    subprocess.run(
        [*simworlds_command(), "docs", "--blender", BLENDER, query],
        env=environment(setting.home), cwd=REPO, capture_output=True, text=True, check=True, timeout=120,
    )  # fmt: skip


def _cold(setting: Setting) -> ReportPart:
    """Measures seconds of whole processes."""
    say("server: simworlds docs, cold")
    times: dict[str, list[float]] = {query: [] for query in _COLD}
    for query, seconds in times.items():
        for _ in range(3 if setting.quick else COLD_RUNS):
            began = time.perf_counter()
            _docs(setting, query)
            seconds.append(time.perf_counter() - began)
    named, question = (percentile(times[query], 0.5) for query in _COLD)
    return ReportPart(
        "simworlds docs", (TargetFigure("docs", named, f"a question {question:.2f} s"),), data=times
    )


async def _stdio(command: Sequence[str], tool: str, queries: Sequence[str], setting: Setting) -> _Stdio:
    """Starts the server several times and sends every query; the first start does not count."""
    times = _Stdio()
    parameters = StdioServerParameters(
        command=command[0], args=list(command[1:]), cwd=REPO, env=environment(setting.home)
    )
    with open(os.devnull, "w", encoding="utf-8") as silence:  # noqa: PTH123 - it has no other name
        for number in range(1 + (1 if setting.quick else STARTS)):
            before = children()
            began = time.perf_counter()
            async with Client(stdio_client(parameters, errlog=silence)) as client:
                await _call(client, tool, _FIRST)
                if number == 0:
                    continue
                times.starts.append(time.perf_counter() - began)
                for query in queries:
                    began = time.perf_counter()
                    await _call(client, tool, query)
                    times.calls.append((time.perf_counter() - began) * 1e3)
                for pid in children() - before:
                    if (memory := resident_mb(pid)) is not None:
                        times.memory.append(memory)
    return times


async def _call(client: Client, tool: str, query: str) -> None:
    result = await client.call_tool(tool, {"query": query})
    if result.is_error:
        raise RuntimeError(f"{tool} refused {query[:60]!r}: {result.content}")


def _stdio_table(servers: dict[str, _Stdio]) -> Table:
    rows = tuple(
        (
            name,
            f"{percentile(server.starts, 0.5):.2f}",
            *(f"{percentile(server.calls, share):.1f}" for share in (0.5, 0.95, 1.0)),
            f"{max(server.memory):.0f}" if server.memory else "–",
        )
        for name, server in servers.items()
    )
    header = ("server", "first answer s", "call p50 ms", "p95", "slowest", "resident MB")
    note = (
        "Each dev query once in each of several processes; from before the start to the first tool's answer."
    )
    return Table("MCP over stdio", header, rows, note)
