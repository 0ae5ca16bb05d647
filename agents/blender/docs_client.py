"""The agents' client of the knowledge base, whose MCP server runs in its own process."""

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

from agents.blender.tools.base import Knowledge, NotChecked
from simworlds.mcp_transport.tool_listing import SCHEMAS, tools_of

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Awaitable, Callable, Sequence

    from anyio.abc import TaskGroup, TaskStatus


NAME = "blender_docs"
CHECK = "blender_check"
NAMES = (NAME, CHECK)
HINT_SECONDS = 2.0
CHECK_SECONDS = 10.0  # the longest code takes three on a quiet machine
_ANSWER_SECONDS = 60.0
_LEAST_TOKENS = 150
_LONGEST_REASON = 400
# Loads what the first check needs, while Blender starts.
_WARM_UP = """\
bpy.ops.mesh.primitive_cube_add()
bpy.context.object.data.materials.append(bpy.data.materials.new(""))
bpy.context.scene.warm_up
"""
_SOURCE = Path(__file__).resolve().parent.parent.parent

_LOG = logging.getLogger(__name__)
_T = TypeVar("_T")


def _words(result: types.CallToolResult) -> str:
    return " ".join(block.text for block in result.content if isinstance(block, types.TextContent))[
        :_LONGEST_REASON
    ]


class DocsGone(Exception):  # noqa: N818 - reads as the state it names
    """The knowledge base's server does not run and cannot be started."""


class DocsClient:
    """A client of ``simworlds serve``, which is started when first needed, and again when it has ended.

    Works inside ``running``. All requests raise DocsGone, and MCPError for what the server refuses.
    """

    def __init__(self, options: Sequence[str] = ()) -> None:
        """``options`` are further options of ``simworlds serve``."""
        path = os.pathsep.join(filter(None, [str(_SOURCE), os.environ.get("PYTHONPATH")]))
        self._server = StdioServerParameters(
            command=sys.executable,
            args=["-P", "-m", "simworlds", "serve", *options],
            env={**os.environ, "PYTHONPATH": path},
        )
        self._tasks: TaskGroup | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._client: Client | None = None
        self._lost = anyio.Event()
        self._lock = anyio.Lock()

    @asynccontextmanager
    async def running(self) -> AsyncGenerator[None]:
        """Starts the server in the background; ends it on leaving."""
        async with anyio.create_task_group() as tasks:
            self._tasks, self._loop = tasks, asyncio.get_running_loop()
            tasks.start_soon(self._connect_early)
            try:
                yield
            finally:
                self._tasks = None
                tasks.cancel_scope.cancel()

    async def tools(self) -> list[types.Tool]:
        """The server's tools, with their whole schemas. Raises DocsGone."""
        try:
            return tools_of((await self.read(SCHEMAS.uri)).contents)
        except ValueError as error:
            raise DocsGone("The knowledge base's server does not tell its tools.") from error

    async def call(self, name: str, arguments: dict[str, Any] | None) -> types.CallToolResult:
        """The server's answer to a call of one of its tools, ``NAMES``."""
        result = await self._request(lambda client: client.call_tool(name, arguments or {}))
        return types.CallToolResult(
            content=result.content, structured_content=result.structured_content, is_error=result.is_error
        )

    async def resources(self) -> list[types.Resource]:
        """The server's resources."""
        return (await self._request(lambda client: client.list_resources())).resources

    async def templates(self) -> list[types.ResourceTemplate]:
        """The server's resource templates."""
        return (await self._request(lambda client: client.list_resource_templates())).resource_templates

    async def read(self, uri: str) -> types.ReadResourceResult:
        """A resource of the server."""
        result = await self._request(lambda client: client.read_resource(uri))
        return types.ReadResourceResult(contents=result.contents)

    def about(self, version: str) -> Knowledge:
        """What is known of a Blender version, for any other thread.

        Look-ups return "" after ``HINT_SECONDS``, checks raise NotChecked after ``CHECK_SECONDS``.
        """

        def docs(query: str, *, max_tokens: int = 400) -> str:
            arguments = {"query": query, "blender": version, "max_tokens": max_tokens}
            try:
                result = self._awaited(NAME, arguments, HINT_SECONDS)
            except NotChecked as error:
                _LOG.debug("no hint on %.100r: %s", query, error)
                return ""
            answer = result.structured_content or {}
            return "" if result.is_error or answer.get("kind") == "none" else str(answer.get("text", ""))

        def check(code: str) -> dict[str, Any]:
            # Lone surrogates cannot be sent; the code's places stay what they are.
            readable = code.encode(errors="replace").decode()
            arguments = {"code": readable, "blender": version, "max_tokens": _LEAST_TOKENS}
            result = self._awaited(CHECK, arguments, CHECK_SECONDS)
            if result.is_error or result.structured_content is None:
                raise NotChecked(_words(result))
            return result.structured_content

        return Knowledge(docs, check)

    def _awaited(self, name: str, arguments: dict[str, Any], seconds: float) -> types.CallToolResult:
        """The server's answer, waited for in another thread. Raises NotChecked."""
        if self._loop is None or self._tasks is None:
            raise NotChecked("The knowledge base's server does not run.")
        future = asyncio.run_coroutine_threadsafe(self.call(name, arguments), self._loop)
        try:
            return future.result(seconds)
        except TimeoutError:
            future.cancel()
            raise NotChecked(f"The knowledge base did not answer within {seconds:g} s.") from None
        except Exception as error:
            raise NotChecked(f"The knowledge base does not answer ({type(error).__name__}).") from error

    # The connection

    async def _request(self, ask: Callable[[Client], Awaitable[_T]]) -> _T:
        for last in (False, True):
            client = await self._connected()
            try:
                return await ask(client)
            except MCPError as error:
                if error.code != types.CONNECTION_CLOSED:
                    raise
                if last:
                    raise DocsGone("The knowledge base's server ended twice during one request.") from error
                self._forget(client)
        raise AssertionError  # never reached

    async def _connect_early(self) -> None:
        try:
            await self._connected()
            await self.call(CHECK, {"code": _WARM_UP})
        except DocsGone as error:
            _LOG.error("%s", error)
        except MCPError as error:
            _LOG.debug("the first check failed: %s", error)

    async def _connected(self) -> Client:
        async with self._lock:
            if self._client is not None:
                return self._client
            if self._tasks is None:
                raise DocsGone("The knowledge base's server has been stopped.")
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
        """Keeps one connection open until it is lost; the same task must open and close it."""
        lost = self._lost = anyio.Event()
        connected = False
        transport = stdio_client(self._server, errlog=sys.stderr)
        try:
            async with Client(transport, read_timeout_seconds=_ANSWER_SECONDS) as client:
                connected = True
                task_status.started(client)
                await lost.wait()
        except Exception:
            if not connected:
                raise
            _LOG.debug("the connection did not close properly", exc_info=True)
