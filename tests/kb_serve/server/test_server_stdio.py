"""The server as a client starts it: a process that speaks on stdin and stdout."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest
from mcp import Client, StdioServerParameters
from running import COMMAND, REPO, Wire, environment

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

QUALITY = "bpy.types.ClothSettings.quality"


def command(home: Path, *arguments: str) -> StdioServerParameters:
    words = [*COMMAND, "serve", *arguments]
    return StdioServerParameters(command=words[0], args=words[1:], env=environment(home), cwd=REPO)


@pytest.mark.anyio
@pytest.mark.parametrize("mode", ["auto", "legacy"])
async def test_a_client_gets_answers_from_the_process_it_starts(home: Path, mode: Any) -> None:
    async with Client(command(home), mode=mode) as client:
        assert "blender_docs" in [tool.name for tool in (await client.list_tools()).tools]
        result = await client.call_tool("blender_docs", {"query": "ClothSettings.quality"})
    assert result.structured_content is not None
    assert result.structured_content["hits"][0]["id"] == QUALITY


@pytest.mark.anyio
async def test_without_a_base_the_handshake_works_and_the_answer_says_what_to_do(tmp_path: Path) -> None:
    async with Client(command(tmp_path)) as client:
        result = await client.call_tool("blender_docs", {"query": QUALITY})
    assert result.is_error
    text = result.content[0].text  # pyright: ignore[reportAttributeAccessIssue]
    assert "There is no knowledge base" in text
    assert "try again in a minute" in text


@pytest.fixture
def wire(home: Path) -> Iterator[Wire]:
    one = Wire([*COMMAND, "serve"], home)
    with one.process:
        yield one
        one.process.kill()


def test_the_handshake_tells_a_model_when_to_ask(wire: Wire) -> None:
    greeting = wire.shake_hands()
    assert greeting["serverInfo"]["name"] == "simworlds"
    assert "blender_docs" in greeting["instructions"]
    assert set(greeting["capabilities"]) >= {"tools", "resources"}


def test_the_server_ends_when_the_client_closes_stdin(wire: Wire) -> None:
    wire.shake_hands()
    wire.ask(QUALITY)
    assert wire.close() == b""
    assert wire.process.wait(timeout=60) == 0


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_the_server_though_it_waits_for_stdin(wire: Wire, number: signal.Signals) -> None:
    wire.shake_hands()
    wire.process.send_signal(number)
    assert wire.process.wait(timeout=60) == 0


def test_lines_that_are_no_messages_do_not_end_the_server(wire: Wire) -> None:
    wire.shake_hands()
    for line in ("", "not json", "{}", "[]", "\0", '"\\ud800"', "[" * 10_000, '{"jsonrpc": "2.0"}'):
        wire.send(line)
    number = 99
    wire.send({"id": number, "method": "ping"})
    while wire.receive().get("id") != number:
        pass
    assert not wire.ask(QUALITY)["isError"]


def test_stdin_and_stdout_may_be_files(home: Path, tmp_path: Path) -> None:
    asked, answered = tmp_path / "asked", tmp_path / "answered"
    asked.write_text('{"jsonrpc": "2.0", "id": 1, "method": "ping"}\n', encoding="utf-8")
    with asked.open("rb") as stdin, answered.open("wb") as stdout:
        done = subprocess.run(
            [*COMMAND, "serve"],
            stdin=stdin,
            stdout=stdout,
            env=environment(home),
            cwd=REPO,
            timeout=60,
            check=False,
        )
    assert done.returncode == 0
    assert json.loads(answered.read_bytes())["id"] == 1


def test_the_server_ends_when_nobody_reads_its_answers(wire: Wire) -> None:
    wire.shake_hands()
    assert wire.process.stdout is not None
    wire.process.stdout.close()
    wire.send({"id": 1, "method": "ping"})
    assert wire.process.wait(timeout=60) == 0


NOISY = r"""
import os, threading, time
wire = os.fstat(1).st_ino
def flood():
    while os.fstat(1).st_ino == wire:
        time.sleep(0.001)
    while True:
        os.write(1, b"noise from C\n" * 20)
        print("noise from Python")
        time.sleep(0.001)
threading.Thread(target=flood, daemon=True).start()
from simworlds.cli import main
main(["serve"])
"""


def test_whatever_else_is_printed_does_not_reach_the_protocol(home: Path) -> None:
    """A thread floods file descriptor 1, as Blender would, from when the server has taken it to the very end."""
    one = Wire([sys.executable, "-c", NOISY], home)
    with one.process:
        one.shake_hands()
        for _ in range(30):
            assert one.ask(QUALITY)["structuredContent"]["hits"][0]["id"] == QUALITY
        assert one.close() == b""
