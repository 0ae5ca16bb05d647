"""A minimal MCP server over stdio: one tool that returns its argument."""

from __future__ import annotations

import anyio
import mcp_types as types
from mcp.server.lowlevel import Server
from mcp.server.stdio import stdio_server

TOOL = "echo"


async def _list_tools(_context: object, _page: object) -> types.ListToolsResult:
    return types.ListToolsResult(tools=[types.Tool(name=TOOL, input_schema={"type": "object"})])


async def _call_tool(_context: object, request: types.CallToolRequestParams) -> types.CallToolResult:
    text = str((request.arguments or {}).get("query", ""))
    return types.CallToolResult(content=[types.TextContent(text=text)])


async def _serve() -> None:
    server = Server("echo", on_list_tools=_list_tools, on_call_tool=_call_tool)
    async with stdio_server() as (read, write):
        await server.run(read, write, server.create_initialization_options())


if __name__ == "__main__":
    anyio.run(_serve)
