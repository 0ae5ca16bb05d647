"""The knowledge base as the agents reach it: a server in a process of its own, spoken to like any other over MCP."""

from __future__ import annotations

import asyncio
import logging
import os
import sys
from contextlib import asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import anyio
import mcp_types as types
from mcp.client import Client
from mcp.client.stdio import StdioServerParameters, stdio_client
from mcp.shared.exceptions import MCPError

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Awaitable, Callable, Sequence

    from anyio.abc import TaskGroup, TaskStatus

    from agents.blender.tools.base import Docs

NAME = "blender_docs"
HINT_SECONDS = 2.0
_ANSWER_SECONDS = 60.0
_SOURCE = Path(__file__).resolve().parent.parent.parent
_COMMAND = "from simworlds.cli import main; main(prog_name='simworlds')"

_LOG = logging.getLogger(__name__)
_T = TypeVar("_T")


class DocsGone(Exception):  # noqa: N818 - reads as the state it names
    """The knowledge base's server does not run and cannot be started."""


class DocsClient:
    """``simworlds serve``, started when it is first needed, and again when it has ended.

    Works between entering and leaving ``running``. Everything that asks raises DocsGone, and MCPError for what the
    server refuses.
    """

    def __init__(self, options: Sequence[str] = ()) -> None:
        """``options`` are further words for ``simworlds serve``."""
        path = os.pathsep.join(filter(None, [str(_SOURCE), os.environ.get("PYTHONPATH")]))
        self._server = StdioServerParameters(
            command=sys.executable,
            args=["-P", "-c", _COMMAND, "serve", *options],
            env={**os.environ, "PYTHONPATH": path},
        )
        self._tasks: TaskGroup | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._client: Client | None = None
        self._lost = anyio.Event()
        self._door = anyio.Lock()

    @asynccontextmanager
    async def running(self) -> AsyncGenerator[None]:
        """Starts the server in the background; ends it on leaving."""
        async with anyio.create_task_group() as tasks:
            self._tasks, self._loop = tasks, asyncio.get_running_loop()
            tasks.start_soon(self._greet)
            try:
                yield
            finally:
                self._tasks = None
                tasks.cancel_scope.cancel()

    async def tools(self) -> list[types.Tool]:
        """What the server lists."""
        return (await self._asked(lambda client: client.list_tools())).tools

    async def call(self, arguments: dict[str, Any] | None) -> types.CallToolResult:
        """``blender_docs``, as the server answers it."""
        found = await self._asked(lambda client: client.call_tool(NAME, arguments or {}))
        return types.CallToolResult(
            content=found.content, structured_content=found.structured_content, is_error=found.is_error
        )

    async def resources(self) -> list[types.Resource]:
        """The server's resources."""
        return (await self._asked(lambda client: client.list_resources())).resources

    async def templates(self) -> list[types.ResourceTemplate]:
        """The server's resource templates."""
        return (await self._asked(lambda client: client.list_resource_templates())).resource_templates

    async def read(self, uri: str) -> types.ReadResourceResult:
        """A resource of the server's."""
        found = await self._asked(lambda client: client.read_resource(uri))
        return types.ReadResourceResult(contents=found.contents)

    def about(self, version: str) -> Docs:
        """A way to ask about a Blender version from any thread but the server's own; "" after ``HINT_SECONDS``."""

        def docs(query: str, *, max_tokens: int = 400) -> str:
            if self._loop is None or self._tasks is None:
                return ""
            arguments = {"query": query, "blender": version, "max_tokens": max_tokens}
            asked = asyncio.run_coroutine_threadsafe(self._hint(arguments), self._loop)
            try:
                return asked.result(HINT_SECONDS)
            except TimeoutError:
                asked.cancel()
            except Exception:
                _LOG.debug("no hint on %.100r", query, exc_info=True)
            return ""

        return docs

    async def _hint(self, arguments: dict[str, Any]) -> str:
        found = await self.call(arguments)
        answer = found.structured_content or {}
        return "" if found.is_error or answer.get("kind") == "none" else str(answer.get("text", ""))

    # The connection

    async def _asked(self, ask: Callable[[Client], Awaitable[_T]]) -> _T:
        for last in (False, True):
            client = await self._connected()
            try:
                return await ask(client)
            except MCPError as error:
                if error.code != types.CONNECTION_CLOSED:
                    raise
                if last:
                    raise DocsGone("The knowledge base's server ended twice while it was asked.") from error
                self._forget(client)
        raise AssertionError  # never reached

    async def _greet(self) -> None:
        try:
            await self._connected()
        except DocsGone as error:
            _LOG.error("%s", error)

    async def _connected(self) -> Client:
        async with self._door:
            if self._client is not None:
                return self._client
            if self._tasks is None:
                raise DocsGone("The knowledge base's server has been ended.")
            try:
                client: Client = await self._tasks.start(self._hold)
            except Exception as error:
                raise DocsGone(f"The knowledge base's server cannot be started: {error}") from error
            self._client = client
            return client

    def _forget(self, client: Client) -> None:
        if self._client is client:
            self._client = None
            self._lost.set()

    async def _hold(self, *, task_status: TaskStatus[Client]) -> None:
        """Keeps one connection open until it is lost: what opens it must close it too."""
        lost = self._lost = anyio.Event()
        greeted = False
        transport = stdio_client(self._server, errlog=sys.stderr)
        try:
            async with Client(transport, read_timeout_seconds=_ANSWER_SECONDS) as client:
                greeted = True
                task_status.started(client)
                await lost.wait()
        except Exception:
            if not greeted:
                raise
            _LOG.debug("the connection did not close as it should", exc_info=True)
