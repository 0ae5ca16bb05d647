"""Measures what clients are sent of the tools before anything is asked: bytes, and tokens of a public vocabulary.

The commands are started as clients start them, and asked for their tools by the real MCP client.
"""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass
from functools import cache
from typing import TYPE_CHECKING

import anyio
from bpe_openai import get_encoding
from mcp import StdioServerParameters
from mcp.client import Client
from mcp.client.stdio import stdio_client

from agents.blender.tool_profiles import PROFILES
from bench.markdown_tables import Table
from bench.sweep.command import simworlds_command
from measurements.report import ReportPart, TargetFigure
from measurements.setting import BLENDER, environment, say

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bpe_openai import Encoding
    from mcp_types import Tool

    from measurements.setting import Setting

VOCABULARY = "o200k_base"


@dataclass(frozen=True, slots=True)
class Listing:
    """What a client is sent: the number of tools, the bytes of their list and of the server's instructions; and the
    tokens of what models are told of it: names, descriptions, schemas of arguments, instructions.
    """

    tools: int
    bytes_listed: int
    bytes_instructions: int
    tokens: int


def measure(setting: Setting) -> ReportPart:
    """Measures ``simworlds serve``, and ``simworlds mcp`` with each profile."""
    commands = {"serve": ["serve", "--blender", BLENDER, "--no-rebuild"]}
    commands |= {f"mcp --tools {profile}": ["mcp", "--tools", profile] for profile in PROFILES}
    listings: dict[str, Listing] = {}
    for name, words in commands.items():
        say(f"schemas: simworlds {name}")
        listings[name] = anyio.run(_listing, setting, words)
    serve, build = listings["serve"], listings["mcp --tools build"]
    figures = (
        TargetFigure("listed_serve", serve.bytes_listed + serve.bytes_instructions, "with its instructions"),
        TargetFigure("listed_build", build.bytes_listed, f"{build.tools} tools"),
        TargetFigure("told_build", build.tokens, f"{VOCABULARY}, with instructions"),
    )
    data = {name: asdict(listing) for name, listing in listings.items()}
    return ReportPart("schemas", figures, (_table(listings),), data=data)


async def _listing(setting: Setting, words: Sequence[str]) -> Listing:
    command, *arguments = [*simworlds_command(), *words]
    server = StdioServerParameters(command=command, args=arguments, env=environment(setting.home))
    with open(os.devnull, "w", encoding="utf-8") as silence:  # noqa: PTH123 - it has no other name
        async with Client(stdio_client(server, errlog=silence)) as client:
            result = await client.list_tools()
            instructions = client.instructions or ""
    return Listing(
        tools=len(result.tools),
        bytes_listed=len(result.model_dump_json(by_alias=True, exclude_none=True).encode()),
        bytes_instructions=len(instructions.encode()),
        tokens=count_tokens("\n".join([instructions, *map(_told, result.tools)])),
    )


def _told(tool: Tool) -> str:
    """What a model is told of a tool."""
    entry = {"name": tool.name, "description": tool.description, "parameters": tool.input_schema}
    return json.dumps(entry, ensure_ascii=False, separators=(",", ":"))


@cache
def _encoding() -> Encoding:
    return get_encoding(VOCABULARY)


def count_tokens(text: str) -> int:
    """The tokens of a text in the vocabulary."""
    return len(_encoding().encode(text))


def _table(listings: dict[str, Listing]) -> Table:
    return Table(
        "Tools as they are sent to clients",
        ("command", "tools", "bytes", "instructions, bytes", "tokens for models"),
        tuple(
            (
                f"`simworlds {name}`",
                str(listing.tools),
                f"{listing.bytes_listed:,}",
                f"{listing.bytes_instructions:,}",
                f"{listing.tokens:,}",
            )
            for name, listing in listings.items()
        ),
    )
