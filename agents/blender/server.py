"""The MCP server of the tool suite: a Blender for every client, and the knowledge base beside it."""

from __future__ import annotations

import base64
import logging
from contextlib import asynccontextmanager
from dataclasses import dataclass
from functools import partial
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
from agents.blender.tool_catalogue import FOR_CLIENTS, HABITS, ONLINE, OPENING, TOOLS, WITH_ASSETS
from agents.blender.tool_profiles import DEFAULT, Profile, is_within
from agents.blender.tools.base import Call
from agents.blender.tools.failures import describe_failure
from simworlds.installed import own_version
from simworlds.mcp_transport.sessions import SESSION, UNFINISHED, EndUnfinishedSessions
from simworlds.mcp_transport.tool_listing import SCHEMAS, as_listed, schemas_text
from simworlds.sandbox.errors import BlenderError
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

_CARE = "Check every step: read what the call says it changed, then look at the scene."
_PROGRESS_SECONDS = 0.25
_LIST_SECONDS = 20.0  # what a list waits for the knowledge base
_MANY_CLIENTS = 64

_LOG = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Suite:
    """Tools that a server has. ``opening`` and ``habits`` (tool, when to use it) tell models how to work."""

    tools: tuple[BlenderTool, ...] = TOOLS
    opening: str = OPENING
    habits: tuple[tuple[str, str], ...] = HABITS

    def named(self, name: str) -> BlenderTool | None:
        """The tool of that name."""
        return next((tool for tool in self.tools if tool.name == name), None)


def _own_suite(sessions: BlenderSessions, *, for_clients: bool) -> Suite:
    """The tools of a Blender of the server's own."""
    more = FOR_CLIENTS if for_clients else ()
    assets = (WITH_ASSETS,) if sessions.has_assets else ()
    return Suite((*TOOLS, *more, *assets, *((ONLINE,) if sessions.is_online else ())))


def first_profiles(suite: Suite, team: Team | None) -> dict[str, Profile]:
    """The smallest profile that has each tool: of the suite, of the team, and of the knowledge base."""
    return {
        **{tool.name: tool.profile for tool in suite.tools},
        **dict.fromkeys(team.names if team is not None else (), "build"),
        **dict.fromkeys(docs_client.NAMES, "docs"),
    }


def instructions(known: Iterable[str], suite: Suite | None = None) -> str:
    """The server's instructions for models: how to work with the tools of these names, of the suite and others."""
    suite = suite or Suite()
    known = set(known)
    habits = [f"- {name}: {when}." for name, when in suite.habits if name in known]
    return "\n".join(
        [
            *([suite.opening] if any(tool.name in known for tool in suite.tools) else []),
            *habits,
            *([_CARE] if "blender_execute" in known else []),
        ]
    )


class _Requests:
    """What clients ask for: tools of a suite, of a team and of the knowledge base, as far as a profile has them."""

    def __init__(
        self, sessions: BlenderSessions, docs: DocsClient, team: Team | None, profile: Profile, suite: Suite
    ) -> None:
        self._sessions = sessions
        self._docs = docs
        self._team = team
        self._profile: Profile = profile
        self._suite = suite
        self._first = first_profiles(suite, team)
        own = [tool.name for tool in suite.tools]
        known = (*own, *(team.names if team is not None else ()), *docs_client.NAMES)
        self.names = [name for name in known if is_within(self._first[name], profile)]

    @asynccontextmanager
    async def lifespan(self, _server: Server[None]) -> AsyncGenerator[None]:
        """Runs the knowledge base beside the server, and closes the Blenders when it ends."""
        try:
            async with self._docs.running(), anyio.create_task_group() as tasks:
                tasks.start_soon(self._sessions.watch)
                try:
                    yield
                finally:
                    tasks.cancel_scope.cancel()
        finally:
            with anyio.CancelScope(shield=True):
                await anyio.to_thread.run_sync(self._sessions.close)

    async def call_tool(self, context: _Context, params: types.CallToolRequestParams) -> types.CallToolResult:
        """A tool's result. Raises MCPError for one that is not offered."""
        name, team = params.name, self._team
        if name not in self.names:
            raise self._not_offered(name)
        if name in docs_client.NAMES:
            return await _look_up(self._docs, name, params.arguments)
        if team is not None and name in team.names:
            # A large plan takes seconds, in which other clients are not to wait.
            return await anyio.to_thread.run_sync(team.use, name, params.arguments or {})
        tool = self._suite.named(name)
        if tool is None:
            raise self._not_offered(name)
        try:
            session = await self._sessions.get(_client(context))
        except BlenderError as error:
            return _failed(str(error))
        use = partial(session.use, tool, params.arguments, about=self._docs.about)
        return await _call_with_progress(context, tool.name, use)

    def _not_offered(self, name: str) -> MCPError:
        text = _not_offered(name, self.names, self._profile, self._first.get(name))
        return MCPError(types.INVALID_PARAMS, text)

    async def _whole_entries(self) -> list[types.Tool]:
        """The tools with their whole schemas; without the knowledge base's where it does not answer."""
        team = self._team
        entries = [*map(entry, self._suite.tools), *(team.tools() if team is not None else ())]
        try:
            with anyio.fail_after(_LIST_SECONDS):
                entries += await self._docs.tools()
        except (DocsGone, MCPError, TimeoutError) as error:
            _LOG.error("%s cannot be listed: %s", " and ".join(docs_client.NAMES), error or "no reply")
        return [tool for tool in entries if tool.name in self.names]

    async def list_tools(self, _context: _Context, _page: _Listing) -> types.ListToolsResult:
        """The tools that there are, as they are listed."""
        entries = await self._whole_entries()
        is_whole = self._profile == "all"
        return types.ListToolsResult(tools=entries if is_whole else list(map(as_listed, entries)))

    async def list_resources(self, _context: _Context, _page: _Listing) -> types.ListResourcesResult:
        """The knowledge base's resources and the team's."""
        own = self._team.resources() if self._team is not None else []
        # The knowledge base's server has SCHEMAS too, which are here those of all tools.
        return types.ListResourcesResult(resources=[*(await _or_empty(self._docs.resources)), *own])

    async def list_templates(self, _context: _Context, _page: _Listing) -> types.ListResourceTemplatesResult:
        """The knowledge base's templates."""
        return types.ListResourceTemplatesResult(resource_templates=await _or_empty(self._docs.templates))

    async def read_resource(
        self, _context: _Context, params: types.ReadResourceRequestParams
    ) -> types.ReadResourceResult:
        """A resource's text. Raises MCPError where it cannot be read."""
        uri = str(params.uri)
        text = self._team.read(uri) if self._team is not None else None
        if uri == SCHEMAS.uri:
            text = schemas_text(await self._whole_entries())
        if text is not None:
            contents = types.TextResourceContents(uri=uri, text=text, mime_type="application/json")
            return types.ReadResourceResult(contents=[contents])
        try:
            return await self._docs.read(uri)
        except DocsGone as error:
            raise MCPError(types.INTERNAL_ERROR, str(error)) from error


def make_server(
    sessions: BlenderSessions,
    docs: DocsClient,
    team: Team | None = None,
    profile: Profile = DEFAULT,
    suite: Suite | None = None,
) -> Server[None]:
    """The server, without a transport. Closes the sessions when it ends.

    ``team`` adds what a model needs to plan and review as well; None for a caller with its own roles, who also waits as
    long as it takes and so has no use for jobs. ``profile`` says which tools there are, of ``suite``: by default those
    of a Blender of the server's own.
    """
    served = suite or _own_suite(sessions, for_clients=team is not None)
    requests = _Requests(sessions, docs, team, profile, served)
    return Server(
        "simworlds-blender",
        version=own_version(),
        title="SimWorlds: live Blender",
        instructions=instructions(requests.names, served),
        lifespan=requests.lifespan,
        get_tool_input_schema=lambda name: entry(tool).input_schema if (tool := served.named(name)) else None,
        on_list_tools=requests.list_tools,
        on_call_tool=requests.call_tool,
        on_list_resources=requests.list_resources,
        on_list_resource_templates=requests.list_templates,
        on_read_resource=requests.read_resource,
        **(_prompting(team) if team is not None else {}),
    )


def _prompting(team: Team) -> dict[str, Any]:
    """The handlers of prompts and of argument completion."""

    async def list_prompts(_context: _Context, _page: _Listing) -> types.ListPromptsResult:
        return types.ListPromptsResult(prompts=team.prompts())

    async def get_prompt(_context: _Context, params: types.GetPromptRequestParams) -> types.GetPromptResult:
        return team.prompt(params.name, params.arguments or {})

    async def complete(_context: _Context, params: types.CompleteRequestParams) -> types.CompleteResult:
        values = team.completions(params.argument.name, params.argument.value)
        return types.CompleteResult(completion=types.Completion(values=values, total=len(values)))

    return {"on_list_prompts": list_prompts, "on_get_prompt": get_prompt, "on_completion": complete}


def _not_offered(name: str, offered: Iterable[str], profile: Profile, first: Profile | None) -> str:
    """Why there is no such tool; ``first`` is the smallest profile that has it, None for a name of no tool at all."""
    if first is not None:
        return (
            f"{name} is not among the tools that this server was started with (--tools {profile}). Restart it with "
            f"--tools {first}."
        )
    return f"There is no tool {name[:80]!r}. Available: {', '.join(offered)}."


def _client(context: _Context) -> str:
    """The client's id: over HTTP its session, which the transport has checked; else \"\"."""
    return context.request.headers.get(SESSION, "") if context.request is not None else ""


# Tools


def entry(tool: BlenderTool) -> types.Tool:
    """A tool's entry in the list of tools."""
    schema = schema_of(tool.arguments)
    schema.pop("description", None)  # the tool has its own
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
            open_world_hint=tool.open_world,
        ),
    )


class _ProgressReporter:
    """Passes the progress that a tool reports, from any thread, on to the client."""

    def __init__(self) -> None:
        self._reported: tuple[float, float | None, str] | None = None
        self._sent = float("-inf")

    def __call__(self, done: float, total: float | None, text: str) -> None:
        """Takes a report of the tool."""
        self._reported = (done, total, text)

    @asynccontextmanager
    async def reporting(self, context: _Context) -> AsyncGenerator[None]:
        """Sends the latest report a few times a second during the body, and once at the end."""

        async def keep_sending() -> None:
            while True:
                await anyio.sleep(_PROGRESS_SECONDS)
                await self._send(context)

        async with anyio.create_task_group() as tasks:
            tasks.start_soon(keep_sending)
            yield
            await self._send(context)
            tasks.cancel_scope.cancel()

    async def _send(self, context: _Context) -> None:
        # The protocol wants progress to increase.
        if self._reported is not None and self._reported[0] > self._sent:
            self._sent, total, text = self._reported
            await context.session.report_progress(self._sent, total, text or None)


async def _call_with_progress(context: _Context, name: str, use: _Use) -> types.CallToolResult:
    """The result of a call; its progress goes to a client that asked for it."""
    reporter = _ProgressReporter()
    async with reporter.reporting(context):
        return await _result_of(name, use(call=Call(progress=reporter)))


async def _result_of(name: str, call: Awaitable[Result]) -> types.CallToolResult:
    try:
        return _as_mcp(await call)
    except Exception as error:
        return _failed(describe_failure(name, error))


def _as_mcp(result: Result) -> types.CallToolResult:
    images = [
        types.ImageContent(data=base64.b64encode(image.png).decode(), mime_type="image/png")
        for image in result.pictures
    ]
    return types.CallToolResult(
        content=[_text(result.text), *images],
        structured_content=result.data or None,
        is_error=result.failed,
    )


def _failed(message: str) -> types.CallToolResult:
    return types.CallToolResult(content=[_text(message)], is_error=True)


def _text(text: str) -> types.TextContent:
    # Lone surrogates, as from file names that are not UTF-8, cannot be sent.
    return types.TextContent(text=text.encode(errors="replace").decode())


# The knowledge base


async def _look_up(docs: DocsClient, name: str, arguments: dict[str, Any] | None) -> types.CallToolResult:
    try:
        return await docs.call(name, arguments)
    except DocsGone as error:
        return _failed(str(error))


async def _or_empty(list_them: Callable[[], Any]) -> list[Any]:
    try:
        return await list_them()
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
    """The server as an ASGI application with a session for every client, which ends after ``idle`` seconds."""
    server.middleware.append(_only_with_sessions)
    app = server.streamable_http_app(
        streamable_http_path=path,
        session_idle_timeout=idle,
        max_sessions=_MANY_CLIENTS + UNFINISHED,
        transport_security=security,
    )
    return _EndOnDelete(EndUnfinishedSessions(app, path), sessions)


async def _only_with_sessions(ctx: ServerRequestContext[Any, Any], call_next: CallNext) -> HandlerResult:
    """Refuses the protocol of 2026, which has no sessions over HTTP to tell whose Blender is whose.

    Clients then fall back to an older version.
    """
    if ctx.protocol_version in MODERN_PROTOCOL_VERSIONS:
        raise MCPError(
            types.UNSUPPORTED_PROTOCOL_VERSION,
            "This server has a Blender for every session: use a protocol version that has sessions.",
            {"supported": list(HANDSHAKE_PROTOCOL_VERSIONS), "requested": ctx.protocol_version},
        )
    return await call_next(ctx)


class _EndOnDelete:
    """Closes the Blender of a client that ends its session with DELETE."""

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
            await self._sessions.end(Headers(scope=scope).get(SESSION, ""))
