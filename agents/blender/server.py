"""The MCP server of the tool suite: every client with a Blender of its own, and the knowledge base beside it."""

from __future__ import annotations

import base64
import logging
from contextlib import asynccontextmanager
from functools import partial
from importlib import metadata
from typing import TYPE_CHECKING, Any

import anyio
import anyio.to_thread
import mcp_types as types
from mcp.server.lowlevel import Server
from mcp.shared.exceptions import MCPError
from mcp_types.version import HANDSHAKE_PROTOCOL_VERSIONS, MODERN_PROTOCOL_VERSIONS
from starlette.datastructures import Headers

from agents.blender import docs_client
from agents.blender.docs_client import DocsGone
from agents.blender.tool_catalogue import BY_NAME, TOOLS
from agents.blender.tools.base import Call
from simworlds.sandbox.errors import BlenderError, Lost, ToolBroke
from simworlds.schemas.json_schema import schema_of

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Awaitable, Callable, Iterable

    from mcp.server.context import CallNext, HandlerResult, ServerRequestContext
    from mcp.server.transport_security import TransportSecuritySettings
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

    from agents.blender.blender_sessions import BlenderSessions
    from agents.blender.docs_client import DocsClient
    from agents.blender.team import Team
    from agents.blender.tools.base import BlenderTool, Result

    _Context = ServerRequestContext[None]
    _Listing = types.PaginatedRequestParams | None
    _Use = Callable[..., Awaitable[Result]]

_HABITS = (
    ("blender_plan_check", "for a whole scene: write its plan first, and check it; the prompt make_scene says how"),
    ("blender_docs", "before you use an API name that you have not looked up for this version, at the start of a "
     "stage of work (with its topic: cloth, materials), and on any error that is still unclear"),
    ("blender_execute", "to build, in small steps: one object or one idea a call, meaningful names"),
    ("blender_scene_state", "for the numbers: what is where, how large, which modifiers and caches"),
    ("blender_single_mesh_preview", "to see one mesh from all sides before it is used"),
    ("blender_scene_layout_preview", "to see the scene; look after every step that changes its looks"),
    ("blender_bake", "for physics, before you judge motion; never jump to a frame of an unbaked simulation"),
    ("blender_motion_sheet_preview", "to see and measure motion over time"),
    ("blender_save", "when a stage is done"),
    ("blender_render", "last, when everything stands; start with a still"),
)  # fmt: skip
_PROGRESS_SECONDS = 0.25
_LIST_SECONDS = 20.0  # what a list waits for the knowledge base
_MANY_CLIENTS = 64
_SESSION = "mcp-session-id"

_LOG = logging.getLogger(__name__)


def instructions(more: Iterable[str] = ()) -> str:
    """What an agent is told of how to work with the tools there are, ``more`` of which the server has beside them."""
    known = {*BY_NAME, *more, docs_client.NAME}
    habits = [f"- {name}: {when}." for name, when in _HABITS if name in known]
    return "\n".join(
        [
            "You have a live Blender of your own, without a window. What you make stays from call to call; if "
            "Blender crashes or hangs, it is started again where the last checkpoint stands, and the error says "
            "which: read where the scene stands before you go on. Lengths are metres, angles in Python radians.",
            *habits,
            "Do not trust a step that you have not checked: read what a call says it changed, then look.",
        ]
    )


def make_server(sessions: BlenderSessions, docs: DocsClient, team: Team | None = None) -> Server[None]:
    """The server, without a transport. Closes the studios when it ends.

    ``team`` offers what a model needs to plan and review too; a caller with roles of its own does without.
    """

    @asynccontextmanager
    async def lifespan(_server: Server[None]) -> AsyncGenerator[None]:
        try:
            async with docs.running(), anyio.create_task_group() as tasks:
                tasks.start_soon(sessions.watch)
                try:
                    yield
                finally:
                    tasks.cancel_scope.cancel()
        finally:
            with anyio.CancelScope(shield=True):
                await anyio.to_thread.run_sync(sessions.close)

    async def call_tool(context: _Context, asked: types.CallToolRequestParams) -> types.CallToolResult:
        if asked.name == docs_client.NAME:
            return await _looked_up(docs, asked.arguments)
        if team is not None and (answer := team.use(asked.name, asked.arguments or {})) is not None:
            return answer
        tool = BY_NAME.get(asked.name)
        if tool is None:
            names = ", ".join([*BY_NAME, *(team.names if team is not None else ()), docs_client.NAME])
            raise MCPError(types.INVALID_PARAMS, f"There is no tool {asked.name[:80]!r}; there are {names}.")
        try:
            session = await sessions.get(_client(context))
        except BlenderError as error:
            return _failed(str(error))
        use = partial(session.use, tool, asked.arguments, about=docs.about)
        return await _watched(context, tool.name, use)

    async def list_tools(_context: _Context, _page: _Listing) -> types.ListToolsResult:
        listed = [*map(entry, TOOLS), *(team.tools() if team is not None else ())]
        try:
            with anyio.fail_after(_LIST_SECONDS):
                listed += await docs.tools()
        except (DocsGone, MCPError, TimeoutError) as error:
            _LOG.error("%s cannot be listed: %s", docs_client.NAME, error or "it does not answer")
        return types.ListToolsResult(tools=listed)

    async def list_resources(_context: _Context, _page: _Listing) -> types.ListResourcesResult:
        return types.ListResourcesResult(resources=await _or_none(docs.resources))

    async def list_templates(_context: _Context, _page: _Listing) -> types.ListResourceTemplatesResult:
        return types.ListResourceTemplatesResult(resource_templates=await _or_none(docs.templates))

    async def read_resource(
        _context: _Context, asked: types.ReadResourceRequestParams
    ) -> types.ReadResourceResult:
        try:
            return await docs.read(str(asked.uri))
        except DocsGone as error:
            raise MCPError(types.INTERNAL_ERROR, str(error)) from error

    return Server(
        "simworlds-blender",
        version=_own_version(),
        title="SimWorlds: live Blender",
        instructions=instructions(team.names if team is not None else ()),
        lifespan=lifespan,
        get_tool_input_schema=lambda name: entry(BY_NAME[name]).input_schema if name in BY_NAME else None,
        on_list_tools=list_tools,
        on_call_tool=call_tool,
        on_list_resources=list_resources,
        on_list_resource_templates=list_templates,
        on_read_resource=read_resource,
        **(_prompting(team) if team is not None else {}),
    )


def _prompting(team: Team) -> dict[str, Any]:
    """The handlers of prompts, and of their arguments as they are typed."""

    async def list_prompts(_context: _Context, _page: _Listing) -> types.ListPromptsResult:
        return types.ListPromptsResult(prompts=team.prompts())

    async def get_prompt(_context: _Context, asked: types.GetPromptRequestParams) -> types.GetPromptResult:
        return team.prompt(asked.name, asked.arguments or {})

    async def complete(_context: _Context, asked: types.CompleteRequestParams) -> types.CompleteResult:
        values = team.completions(asked.argument.name, asked.argument.value)
        return types.CompleteResult(completion=types.Completion(values=values, total=len(values)))

    return {"on_list_prompts": list_prompts, "on_get_prompt": get_prompt, "on_completion": complete}


def _own_version() -> str:
    try:
        return metadata.version("simworlds")
    except metadata.PackageNotFoundError:  # run from its source
        return ""


def _client(context: _Context) -> str:
    """Who asks: over HTTP a session that the transport has checked, else the only one."""
    return context.request.headers.get(_SESSION, "") if context.request is not None else ""


# Tools


def entry(tool: BlenderTool) -> types.Tool:
    """A tool's entry in the list of tools."""
    schema = schema_of(tool.arguments)
    schema.pop("description", None)  # the tool's own says it
    return types.Tool(
        name=tool.name,
        title=tool.title,
        description=tool.description,
        input_schema=schema | {"title": tool.name},
        annotations=types.ToolAnnotations(
            title=tool.title,
            read_only_hint=tool.read_only,
            destructive_hint=tool.destructive,
            idempotent_hint=tool.read_only,
            open_world_hint=False,
        ),
    )


class _Latest:
    """The last progress that a tool reported, from whichever thread."""

    def __init__(self) -> None:
        self._reported: tuple[float, float | None, str] | None = None
        self._sent = float("-inf")

    def __call__(self, done: float, total: float | None, text: str) -> None:
        """Notes it."""
        self._reported = (done, total, text)

    @asynccontextmanager
    async def told(self, context: _Context) -> AsyncGenerator[None]:
        """Tells the client meanwhile, a few times a second, and once at the end."""

        async def keep_telling() -> None:
            while True:
                await anyio.sleep(_PROGRESS_SECONDS)
                await self._tell(context)

        async with anyio.create_task_group() as tasks:
            tasks.start_soon(keep_telling)
            yield
            await self._tell(context)
            tasks.cancel_scope.cancel()

    async def _tell(self, context: _Context) -> None:
        # What does not get further than before is no progress to the protocol.
        if self._reported is not None and self._reported[0] > self._sent:
            self._sent, total, text = self._reported
            await context.session.report_progress(self._sent, total, text or None)


async def _watched(context: _Context, name: str, use: _Use) -> types.CallToolResult:
    """What came of a call; meanwhile the client is told how far it is, if that wants to know."""
    if context.meta is None or context.meta.get("progress_token") is None:
        return await _answered(name, use(call=Call()))
    latest = _Latest()
    async with latest.told(context):
        return await _answered(name, use(call=Call(progress=latest)))


async def _answered(name: str, call: Awaitable[Result]) -> types.CallToolResult:
    try:
        return _shown(await call)
    except Lost as error:
        said = error.printed.strip()
        return _failed(
            f"{error}\n\nThe end of what Blender printed:\n```\n{said}\n```" if said else str(error)
        )
    except ToolBroke as error:
        _LOG.error("%s failed in Blender: %s\n%s", name, error, error.details)
        return _failed(f"{name} itself failed, which is no fault of yours: {error}. Blender goes on.")
    except BlenderError as error:
        return _failed(str(error))
    except Exception as error:
        _LOG.exception("%s failed", name)
        return _failed(f"{name} failed on this call ({type(error).__name__}). Ask it otherwise.")


def _shown(result: Result) -> types.CallToolResult:
    pictures = [
        types.ImageContent(data=base64.b64encode(picture.png).decode(), mime_type="image/png")
        for picture in result.pictures
    ]
    return types.CallToolResult(
        content=[_text(result.text), *pictures],
        structured_content=result.data or None,
        is_error=result.failed,
    )


def _failed(message: str) -> types.CallToolResult:
    return types.CallToolResult(content=[_text(message)], is_error=True)


def _text(text: str) -> types.TextContent:
    # Halves of characters, as in names of files that are no text, cannot be sent.
    return types.TextContent(text=text.encode(errors="replace").decode())


# The knowledge base


async def _looked_up(docs: DocsClient, arguments: dict[str, Any] | None) -> types.CallToolResult:
    try:
        return await docs.call(arguments)
    except DocsGone as error:
        return _failed(str(error))


async def _or_none(listed: Callable[[], Any]) -> list[Any]:
    try:
        return await listed()
    except DocsGone as error:
        _LOG.error("%s", error)
        return []


# HTTP


def make_app(
    server: Server[None],
    sessions: BlenderSessions,
    idle: float,
    path: str,
    security: TransportSecuritySettings,
) -> ASGIApp:
    """The server as an ASGI application that keeps a session for every client; ``idle`` in seconds."""
    server.middleware.append(_only_with_sessions)
    app = server.streamable_http_app(
        streamable_http_path=path,
        session_idle_timeout=idle,
        max_sessions=_MANY_CLIENTS,
        transport_security=security,
    )
    return _Leaving(app, sessions)


async def _only_with_sessions(ctx: ServerRequestContext[Any, Any], call_next: CallNext) -> HandlerResult:
    """The protocol of 2026 has no sessions over HTTP, by which a Blender could be told to be a client's own.

    Clients then shake hands as before.
    """
    if ctx.protocol_version in MODERN_PROTOCOL_VERSIONS:
        raise MCPError(
            types.UNSUPPORTED_PROTOCOL_VERSION,
            "Every session has a Blender of its own here: use a version of the protocol that has sessions.",
            {"supported": list(HANDSHAKE_PROTOCOL_VERSIONS), "requested": ctx.protocol_version},
        )
    return await call_next(ctx)


class _Leaving:
    """Closes the studio of a client that ends its session."""

    def __init__(self, app: ASGIApp, sessions: BlenderSessions) -> None:
        self._app = app
        self._sessions = sessions

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """ASGI."""
        if scope["type"] != "http" or scope["method"] != "DELETE":
            await self._app(scope, receive, send)
            return
        ended = False

        async def watched(message: Message) -> None:
            nonlocal ended
            ended = ended or message.get("status") == 200
            await send(message)

        await self._app(scope, receive, watched)
        if ended:
            await self._sessions.end(Headers(scope=scope).get(_SESSION, ""))
