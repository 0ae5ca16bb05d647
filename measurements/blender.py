"""Measures the live Blender: start, calls, reading and previewing a scene, restart.

Calls use the real MCP client and command, next to an echo tool. Tools that a version does not have are skipped and
named.
"""

from __future__ import annotations

import os
import signal
import sys
import tempfile
import textwrap
import time
from contextlib import asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anyio
from mcp import StdioServerParameters
from mcp.client import Client
from mcp.client.stdio import stdio_client

from agents.blender.files.run_folder import RunFolder
from agents.blender.launch import make_launch
from agents.blender.supervisor import Supervisor
from agents.blender.tool_catalogue import BY_NAME
from bench.markdown_tables import Table
from bench.sweep.command import simworlds_command
from measurements.echo import TOOL as ECHO
from measurements.report import ReportPart, TargetFigure, run_steps
from measurements.setting import REPO, environment, percentile, say
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Sequence

    from measurements.setting import Setting

EXECUTE, STATE, PREVIEW = "blender_execute", "blender_scene_state", "blender_scene_layout_preview"
_ONE = {"code": "1+1"}
_OBJECTS, _SEEN, _KEPT = 500, 50, 100
# Typical objects: a few kinds, with materials and modifiers, some of them animated.
_SCENE = """
import math
materials = [bpy.data.materials.new(f"Paint {number}") for number in range(8)]
add = (bpy.ops.mesh.primitive_cube_add, bpy.ops.mesh.primitive_uv_sphere_add, bpy.ops.mesh.primitive_cone_add)
side = math.ceil(COUNT ** 0.5)
for number in range(COUNT):
    add[number % 3](location=(3 * (number % side), 3 * (number // side), 1))
    thing = bpy.context.object
    thing.name = f"Piece {number}"
    thing.data.materials.append(materials[number % 8])
    if number % 2:
        thing.modifiers.new("Bevel", "BEVEL").width = 0.05
    if number % 10 == 0:
        thing.keyframe_insert("location", frame=1)
        thing.location.z += 2
        thing.keyframe_insert("location", frame=40)
len(bpy.data.objects)
"""
# A hundred lines to check that are not run: a function that nobody calls.
_CHECKED = "def build():\n" + textwrap.indent(_SCENE.replace("COUNT", "100") * 6, "    ") + "\n"


def measure(setting: Setting) -> ReportPart:
    """Measures all that an agent waits for."""
    return run_steps(
        "blender",
        {
            "worker": lambda: _worker(setting),
            "over MCP": lambda: anyio.run(_over_mcp, setting),
            "scenes": lambda: anyio.run(_scenes, setting),
        },
    )


# The worker by itself


def _worker(setting: Setting) -> ReportPart:
    say("blender: start, and restart after a kill")
    starts: list[float] = []
    restarts: list[float] = []
    for _ in range(2 if setting.quick else 5):
        with tempfile.TemporaryDirectory() as place:
            folder = RunFolder.make(Path(place))
            began = time.perf_counter()
            with Supervisor(make_launch(folder.workspace), folder) as blender:
                _run(blender, "1+1")
                starts.append(time.perf_counter() - began)
                _run(blender, _SCENE.replace("COUNT", str(_KEPT)))
                blender.keep("the scene")
                pid = blender.inner_pid
                assert pid is not None
                began = time.perf_counter()
                os.kill(pid, signal.SIGKILL)
                count = _run(blender, "len(bpy.data.objects)")
                restarts.append(time.perf_counter() - began)
                if count != str(_KEPT):
                    raise RuntimeError(f"{count} of {_KEPT} objects were restored")
    figures = (
        TargetFigure("worker_start", percentile(starts, 0.5), f"median of {len(starts)}"),
        TargetFigure("restart", percentile(restarts, 0.5), f"slowest {max(restarts):.2f} s"),
    )
    return ReportPart("worker", figures, data={"starts": starts, "restarts": restarts})


def _run(blender: Supervisor, code: str) -> str:
    reply = blender.call("execute", {"code": code}, unread, timeout=60, changes=True)
    if reply.value["error"] is not None:
        raise RuntimeError(reply.value["error"]["message"])
    return reply.value["value"]


# Over MCP


@asynccontextmanager
async def _client(setting: Setting, command: Sequence[str]) -> AsyncGenerator[Client]:
    parameters = StdioServerParameters(
        command=command[0], args=list(command[1:]), cwd=REPO, env=environment(setting.home)
    )
    with open(os.devnull, "w", encoding="utf-8") as silence:  # noqa: PTH123 - it has no other name
        async with Client(stdio_client(parameters, errlog=silence)) as client:
            yield client


async def _call(client: Client, tool: str, **arguments: Any) -> float:
    """Times a call in seconds. Raises RuntimeError if it fails."""
    began = time.perf_counter()
    result = await client.call_tool(tool, arguments)
    seconds = time.perf_counter() - began
    if result.is_error:
        raise RuntimeError(f"{tool} failed: {result.content}")
    return seconds


async def _over_mcp(setting: Setting) -> ReportPart:
    starts, calls = await _timed(setting, [*simworlds_command(), "mcp"], EXECUTE, **_ONE)
    say("blender: an echo tool for comparison")
    echo_starts, echoes = await _timed(
        setting, [sys.executable, "-m", "measurements.echo"], ECHO, query="1+1"
    )
    figures = (
        TargetFigure("mcp_start", percentile(starts, 0.5), f"echo here {percentile(echo_starts, 0.5):.2f} s"),
        TargetFigure("execute_p50", percentile(calls, 0.5), f"echo here {percentile(echoes, 0.5):.1f} ms"),
    )
    checked, unchecked = await _preflight(setting)
    cost = percentile(checked, 0.5) - percentile(unchecked, 0.5)
    figures += (
        TargetFigure("preflight", cost, f"{percentile(unchecked, 0.5):.1f} ms without, of the same lines"),
    )
    rows = tuple(
        (
            name,
            f"{percentile(first, 0.5):.2f}",
            *(f"{percentile(times, share):.1f}" for share in (0.5, 0.95, 1.0)),
        )
        for name, first, times in (
            ('blender_execute("1+1")', starts, calls),
            ("echo tool", echo_starts, echoes),
        )
    )
    header = ("tool", "first answer s", "call p50 ms", "p95", "slowest")
    note = "From before the server's start to the first answer. Every call of blender_execute leaves a checkpoint."
    table = Table("Blender over MCP, on stdio", header, rows, note)
    data = {
        "starts": starts, "calls": calls, "echo_starts": echo_starts, "echo_calls": echoes,
        "checked": checked, "unchecked": unchecked,
    }  # fmt: skip
    return ReportPart("over MCP", figures, (table,), data=data)


async def _timed(
    setting: Setting, command: Sequence[str], tool: str, **arguments: Any
) -> tuple[list[float], list[float]]:
    """Times several starts, in seconds to the first answer (the first is not counted), and calls in ms."""
    say(f"blender: calls of {tool} over stdio")
    starts: list[float] = []
    calls: list[float] = []
    for number in range(1 + (1 if setting.quick else 3)):
        with tempfile.TemporaryDirectory() as run:
            began = time.perf_counter()
            words = [*command, "--run", run] if tool == EXECUTE else command
            async with _client(setting, words) as client:
                await _call(client, tool, **arguments)
                if number:
                    starts.append(time.perf_counter() - began)
                    calls += [await _call(client, tool, **arguments) * 1e3 for _ in range(200)]
    return starts, calls


async def _preflight(setting: Setting) -> tuple[list[float], list[float]]:
    """Times calls with a hundred lines that are not run, in ms: checked before, and not."""
    say("blender: the check of code before it runs")
    times: dict[str, list[float]] = {"on": [], "off": []}
    with tempfile.TemporaryDirectory() as run:
        async with _client(setting, [*simworlds_command(), "mcp", "--run", run]) as client:
            await _call(client, EXECUTE, code=_CHECKED)
            for _ in range(20 if setting.quick else 100):
                for preflight, calls in times.items():
                    calls.append(await _call(client, EXECUTE, code=_CHECKED, preflight=preflight) * 1e3)
    return times["on"], times["off"]


async def _scenes(setting: Setting) -> ReportPart:
    say("blender: reading and seeing scenes")
    wanted = {STATE: ("state", _OBJECTS, 1e3), PREVIEW: ("preview", _SEEN, 1.0)}
    figures: list[TargetFigure] = []
    data: dict[str, list[float]] = {}
    for tool, (key, count, unit) in wanted.items():
        if tool not in BY_NAME:
            continue
        with tempfile.TemporaryDirectory() as run:
            async with _client(setting, [*simworlds_command(), "mcp", "--run", run]) as client:
                await _call(client, EXECUTE, code=_SCENE.replace("COUNT", str(count)))
                times = [await _call(client, tool) * unit for _ in range(3 if setting.quick else 6)]
        data[tool] = times
        figures.append(
            TargetFigure(key, percentile(times[1:], 0.5), f"first {times[0]:.{0 if unit > 1 else 2}f}")
        )
    skipped = tuple(f"there is no {tool}" for tool in wanted if tool not in BY_NAME)
    return ReportPart("scenes", tuple(figures), skipped=skipped, data=data)
