"""A client of the MCP tools: a live Blender, and blender_docs.

The server runs in a thread of this process; calls and answers go through the protocol.
"""

from __future__ import annotations

import base64
import time
from concurrent.futures import CancelledError, Future, wait
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Self

import mcp_types as types
from anyio.from_thread import start_blocking_portal
from mcp.client import Client
from mcp.shared.exceptions import MCPError

from agents.blender.blender_sessions import BlenderSessions
from agents.blender.docs_client import NAME as DOCS
from agents.blender.docs_client import DocsClient
from agents.blender.server import make_server
from agents.loop.errors import RunError, Stopping
from simworlds.llm.messages import Picture, Text, Tool
from simworlds.schemas.json_schema import lean_arguments

if TYPE_CHECKING:
    import threading
    from collections.abc import Callable, Mapping, Sequence
    from types import TracebackType

    from anyio.from_thread import BlockingPortal

    from agents.blender.blender_sessions import SessionSetup

_TICK = 0.2  # seconds between two looks at whether to stop
Progress = "Callable[[str, float, float | None, str], object]"


@dataclass(frozen=True, slots=True)
class ToolOutcome:
    """The result of a call: what a model sees, the same as ``data``, and how long it took."""

    content: tuple[Text | Picture, ...]
    data: Mapping[str, Any] = field(default_factory=dict[str, Any])
    failed: bool = False
    seconds: float = 0.0

    @property
    def text(self) -> str:
        """The words."""
        return "\n\n".join(block.text for block in self.content if isinstance(block, Text))

    @property
    def pictures(self) -> tuple[Picture, ...]:
        """What there is to see."""
        return tuple(block for block in self.content if isinstance(block, Picture))


class ToolClient:
    """Works between entering and leaving. ``progress`` gets (tool, done, total, text) from another thread."""

    def __init__(
        self,
        setup: SessionSetup,
        docs_options: Sequence[str] = (),
        progress: Callable[[str, float, float | None, str], object] | None = None,
    ) -> None:
        self._setup = setup
        self._docs_options = docs_options
        self._progress = progress
        self._stack = ExitStack()
        self._portal: BlockingPortal
        self._client: Client
        self._tools: dict[str, types.Tool] = {}
        self._running: set[Future[types.CallToolResult]] = set()

    def __enter__(self) -> Self:
        """Starts Blender and the knowledge base's server. Raises RunError where there is none to start."""
        sessions = BlenderSessions(self._setup)
        sessions.start("")
        server = make_server(sessions, DocsClient(self._docs_options), profile="all")
        with ExitStack() as stack:
            self._portal = stack.enter_context(start_blocking_portal(name="tools"))
            self._client = stack.enter_context(self._portal.wrap_async_context_manager(Client(server)))
            listed = self._portal.call(self._client.list_tools).tools
            self._tools = {tool.name: tool for tool in listed}
            self._stack = stack.pop_all()
        if DOCS not in self._tools:
            self._stack.close()
            raise RunError(
                "The knowledge base does not answer. Build it with 'simworlds kb build', or run 'simworlds serve' "
                "to see what is wrong."
            )
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.close()

    @property
    def names(self) -> tuple[str, ...]:
        """All tools."""
        return tuple(self._tools)

    def offered(self, names: Sequence[str]) -> tuple[Tool, ...]:
        """The tools of these names, as a model is told of them."""
        tools = (self._tools[name] for name in names)
        return tuple(
            Tool(tool.name, tool.description or "", lean_arguments(tool.input_schema)) for tool in tools
        )

    def is_read_only(self, name: str) -> bool:
        """Whether a tool leaves the scene as it is; unknown tools do."""
        tool = self._tools.get(name)
        if tool is None or name == DOCS:
            return True
        return bool(tool.annotations and tool.annotations.read_only_hint)

    def checkpoint(self) -> int:
        """The number of the worker's checkpoint that holds the scene as it is, made if need be. Raises RunError."""
        return self._number("blender_save", {})

    def restore(self, checkpoint: int) -> int:
        """Puts the scene where a checkpoint of the worker's stands; the number of it as it is now. Raises RunError."""
        kept = self.call("blender_load", {}).data.get("checkpoints") or [0]
        return (
            checkpoint if kept[0] == checkpoint else self._number("blender_load", {"checkpoint": checkpoint})
        )

    def _number(self, name: str, arguments: Mapping[str, Any]) -> int:
        outcome = self.call(name, arguments)
        if outcome.failed:
            raise RunError(f"Blender's state could not be saved: {outcome.text}")
        return int(outcome.data["checkpoint"])

    def cancel_calls(self) -> None:
        """Cancels running calls, from any thread; Blender goes back to its state before them."""
        for future in tuple(self._running):
            future.cancel()

    def call(
        self, name: str, arguments: Mapping[str, Any], until: threading.Event | None = None
    ) -> ToolOutcome:
        """Calls a tool. An interrupt (Ctrl-C), and ``until``, give the call up, and Blender is put back.

        Raises Stopping.
        """
        began = time.monotonic()

        async def report(progress: float, total: float | None, message: str | None) -> None:
            if self._progress:
                self._progress(name, progress, total, message or "")

        async def ask() -> types.CallToolResult:
            return await self._client.call_tool(name, dict(arguments), progress_callback=report)

        future = self._portal.start_task_soon(ask)
        self._running.add(future)
        try:
            while until is not None and not wait((future,), _TICK).done:
                if until.is_set():
                    future.cancel()
                    break
            result = future.result()
        except MCPError as error:
            return ToolOutcome((Text(str(error)),), failed=True, seconds=time.monotonic() - began)
        except CancelledError as error:
            raise Stopping(f"{name} was cancelled.") from error
        except BaseException:
            future.cancel()
            raise
        finally:
            self._running.discard(future)
        content = tuple(block for given in result.content if (block := _block(given)) is not None)
        data = result.structured_content or {}
        return ToolOutcome(content, data, bool(result.is_error), time.monotonic() - began)


def _block(given: types.ContentBlock) -> Text | Picture | None:
    if isinstance(given, types.TextContent):
        return Text(given.text)
    if isinstance(given, types.ImageContent):
        return Picture(base64.b64decode(given.data), given.mime_type)
    return None
