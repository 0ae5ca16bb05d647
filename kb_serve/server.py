"""The MCP server: the tools that answer from knowledge bases, and resources for symbols and pages."""

from __future__ import annotations

import json
import logging
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

import anyio
import anyio.to_thread
import mcp_types as types
from mcp.server.lowlevel import Server
from mcp.shared.exceptions import MCPError
from mcp.shared.uri_template import UriTemplate
from starlette.responses import Response

from kb_build.symbols.records import to_json
from kb_serve.errors import KBServeError
from kb_serve.served_tools import TOOL_NAMES, answer, is_quick, listing
from simworlds.installed import own_version
from simworlds.mcp_transport.tool_listing import SCHEMAS, as_listed, schemas_text

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator

    from mcp.server.context import ServerRequestContext
    from mcp.server.transport_security import TransportSecuritySettings
    from starlette.types import ASGIApp, Receive, Scope, Send

    from kb_serve.service import Service

    _Context = ServerRequestContext[None]
    _Listing = types.PaginatedRequestParams | None

BASES = "blender://bases"
SYMBOL = UriTemplate.parse("blender://{version}/symbol/{+path}")
PAGE = UriTemplate.parse("blender://{version}/page/{+slug}")

INSTRUCTIONS = (
    "blender_docs answers from the schemas and the manual of the Blender version in use. Query it before you "
    "use a name of Blender's Python API that you have not looked up for that version, at the start of each "
    "stage of work (with its topic: cloth, materials, compositor), and with every error message from Blender. "
    "blender_check finds what that version lacks in code that you have written: check it before it runs."
)

_LOG = logging.getLogger(__name__)
_JSON, _MARKDOWN = "application/json", "text/markdown"
_LARGEST_REQUEST = 640 * 1024  # the longest script that is checked, if JSON escapes all of it
_LONGEST_URI = 2_000
_FOR_ERRORS = 500


class _Requests:
    """What clients ask for, answered by a service that gets ready while the server runs."""

    def __init__(self, service: Service) -> None:
        self._service = service
        # Answers wait for this; the handshake does not.
        self._ready = anyio.Event()
        # One thread beside the event loop: more would only wait for each other.
        self._thread = anyio.CapacityLimiter(1)

    @asynccontextmanager
    async def lifespan(self, _server: Server[None]) -> AsyncGenerator[None]:
        """Opens the base, and sees to it as long as the server runs."""
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(self._prepare)
            try:
                yield
            finally:
                self._service.upkeep.stop()
                tasks.cancel_scope.cancel()

    async def _prepare(self) -> None:
        try:
            await anyio.to_thread.run_sync(self._service.warm)
        finally:
            self._ready.set()
        await anyio.to_thread.run_sync(self._service.load_search)
        await anyio.to_thread.run_sync(self._service.upkeep.run, abandon_on_cancel=True)

    async def call_tool(
        self, _context: _Context, params: types.CallToolRequestParams
    ) -> types.CallToolResult:
        """A tool's answer; what it refuses, or fails on, is told to the model. Raises MCPError for an unknown tool."""
        name = params.name
        if name not in TOOL_NAMES:
            raise MCPError(
                types.INVALID_PARAMS, f"There is no tool {name[:80]!r}. Available: {', '.join(TOOL_NAMES)}."
            )
        if not self._ready.is_set():
            await self._ready.wait()
        service, thread = self._service, self._thread
        try:
            # Handing a short call over to a thread and back costs more than others gain. A thread that is at work
            # may keep the base locked.
            if is_quick(name, params.arguments) and not thread.borrowed_tokens:
                return answer(name, service, params.arguments)
            return await anyio.to_thread.run_sync(answer, name, service, params.arguments, limiter=thread)
        except KBServeError as error:
            return _failed(str(error))
        except Exception as error:
            _LOG.exception("%s failed on %.300r", name, params.arguments)
            return _failed(
                f"{name} failed on this call ({type(error).__name__}). Change the call, or report it."
            )

    async def read_resource(
        self, _context: _Context, params: types.ReadResourceRequestParams
    ) -> types.ReadResourceResult:
        """A resource's text. Raises MCPError where it cannot be read."""
        uri = str(params.uri)
        if uri == SCHEMAS.uri:
            return _contents(uri, schemas_text(listing()), _JSON)
        await self._ready.wait()
        try:
            text, kind = await anyio.to_thread.run_sync(_resource, self._service, uri, limiter=self._thread)
        except KBServeError as error:
            raise MCPError(types.INVALID_PARAMS, str(error), {"uri": uri[:_FOR_ERRORS]}) from error
        return _contents(uri, text, kind)


async def _list_tools(_context: _Context, _page: _Listing) -> types.ListToolsResult:
    return types.ListToolsResult(tools=list(map(as_listed, listing())))


async def _list_resources(_context: _Context, _page: _Listing) -> types.ListResourcesResult:
    return types.ListResourcesResult(resources=[BASE_LIST, SCHEMAS])


async def _list_templates(_context: _Context, _page: _Listing) -> types.ListResourceTemplatesResult:
    return types.ListResourceTemplatesResult(resource_templates=TEMPLATES)


def make_server(service: Service) -> Server[None]:
    """The MCP server, without a transport. It opens bases, and rebuilds outdated ones, while it runs."""
    requests = _Requests(service)
    return Server(
        "simworlds",
        version=own_version(),
        title="SimWorlds: Blender documentation",
        instructions=INSTRUCTIONS,
        lifespan=requests.lifespan,
        get_tool_input_schema=lambda name: next((t.input_schema for t in listing() if t.name == name), None),
        on_list_tools=_list_tools,
        on_call_tool=requests.call_tool,
        on_list_resources=_list_resources,
        on_list_resource_templates=_list_templates,
        on_read_resource=requests.read_resource,
    )


def make_app(service: Service, path: str, security: TransportSecuritySettings) -> ASGIApp:
    """The server as an ASGI application, without sessions: every request is answered by itself."""
    app = make_server(service).streamable_http_app(
        streamable_http_path=path,
        json_response=True,
        stateless_http=True,
        max_request_body_size=_LARGEST_REQUEST,
        transport_security=security,
    )
    return _WithoutStreams(app)


class _WithoutStreams:
    """Refuses GET, which would open a stream: without sessions there is nothing to send, and it would never end."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """ASGI."""
        is_stream = scope["type"] == "http" and scope["method"] == "GET"
        await (_NO_STREAM if is_stream else self._app)(scope, receive, send)


_NO_STREAM = Response("This server has no streams: use POST.\n", status_code=405, headers={"Allow": "POST"})


def _failed(message: str) -> types.CallToolResult:
    return types.CallToolResult(content=[types.TextContent(text=message)], is_error=True)


# Resources

BASE_LIST = types.Resource(
    uri=BASES,
    name="bases",
    title="Knowledge bases",
    description="The Blender versions that have a knowledge base.",
    mime_type=_JSON,
)
TEMPLATES = [
    types.ResourceTemplate(
        uri_template="blender://{version}/symbol/{+path}",
        name="symbol",
        title="API symbol",
        description="The whole record of an identifier: blender://5.1/symbol/bpy.types.ClothSettings.quality",
        mime_type=_JSON,
    ),
    types.ResourceTemplate(
        uri_template="blender://{version}/page/{+slug}",
        name="page",
        title="Manual page, guide or script template",
        description="A page, whole: blender://5.1/page/physics/cloth/introduction",
        mime_type=_MARKDOWN,
    ),
]


def _contents(uri: str, text: str, kind: str) -> types.ReadResourceResult:
    return types.ReadResourceResult(contents=[types.TextResourceContents(uri=uri, text=text, mime_type=kind)])


def _resource(service: Service, uri: str) -> tuple[str, str]:
    """A resource's text and MIME type. Raises MCPError for an unknown one, and KBServeError."""
    if uri == BASES:
        return json.dumps(service.built(), indent=2), _JSON
    beginning = uri[:_LONGEST_URI]  # of the few that are longer, none exists
    if (parts := SYMBOL.match(beginning)) is not None:
        symbol = service.symbol(str(parts["version"]), str(parts["path"]))
        if symbol is not None:
            return json.dumps(to_json(symbol), ensure_ascii=False, indent=2), _JSON
    if (parts := PAGE.match(beginning)) is not None:
        page = service.page(str(parts["version"]), str(parts["slug"]))
        if page is not None:
            return page.text, _MARKDOWN
    raise MCPError(
        types.INVALID_PARAMS,
        "There is no such resource. Write identifiers and slugs as in hits[].id of blender_docs: "
        "blender://5.1/symbol/bpy.types.ClothSettings.quality, blender://5.1/page/physics/cloth/introduction",
        {"uri": uri[:_FOR_ERRORS]},
    )
