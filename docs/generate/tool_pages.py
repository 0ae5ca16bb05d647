"""The pages of the MCP tools: those of the knowledge base, and those of a live Blender with its prompts."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from agents.blender.attached.tool_catalogue import TOOLS as ATTACHED_TOOLS
from agents.blender.checks import plan_check
from agents.blender.server import Suite, first_profiles
from agents.blender.team import PROMPTS, Team
from agents.blender.tool_catalogue import FOR_CLIENTS, ONLINE, TOOLS, WITH_ASSETS
from agents.blender.tool_profiles import DEFAULT, PROFILES, is_within
from agents.plan.scene import ScenePlan
from docs.generate.markdown import GENERATED, page, schema_table, table
from kb_serve.served_tools import TOOL_NAMES, listing
from kb_serve.server import BASE_LIST, INSTRUCTIONS, TEMPLATES
from simworlds.mcp_transport.tool_listing import SCHEMAS
from simworlds.schemas.notation import shape_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from mcp_types import PromptArgument, Tool

    from agents.blender.tools.base import BlenderTool


_CHANGES = (
    "Both tools answer from knowledge bases, and change nothing of yours. Clients are told so by one hint, "
    "`readOnlyHint`. One query does more: `kb build 5.1`, asked of `blender_docs`, builds the base of a version that "
    "has none. It does so in the background, in SimWorlds' own folder, and fetches the `bpy` package first where that "
    "Blender is not at hand (350 MB). `simworlds serve --no-rebuild` turns this off."
)


def docs_tool_page() -> str:
    """The tools of the knowledge base, their arguments and results, and the resources, as Markdown."""
    return page(
        "# MCP tools and resources",
        GENERATED,
        f"The server's instructions to clients: {INSTRUCTIONS}",
        "## What the tools change",
        _CHANGES,
        *(part for entry in listing() for part in _tool(entry)),
        "## Errors",
        "Errors (a call that cannot be answered, a version that was not built, a damaged base) are results marked as "
        "errors; their text says what to do.",
        "## Resources",
        _resources(),
    )


def _tool(entry: Tool) -> Iterator[str]:
    assert entry.description
    assert entry.output_schema
    yield f"## `{entry.name}`"
    yield entry.description
    yield "### Arguments"
    yield schema_table(entry.input_schema)
    yield "### Result"
    yield "The Markdown is the result's text; the structured content, whose schema the list of tools leaves out, is:"
    yield schema_table(entry.output_schema)
    yield "### Schemas"
    yield _schema("Arguments", entry.input_schema)
    yield _schema("Result", entry.output_schema)


def _schema(title: str, schema: Mapping[str, Any]) -> str:
    return f"{title}:\n\n```json\n{json.dumps(schema, indent=2, ensure_ascii=False)}\n```"


def _resources() -> str:
    rows = [(f"`{one.uri}`", str(one.mime_type), str(one.description)) for one in (BASE_LIST, SCHEMAS)]
    rows += [
        (f"`{template.uri_template}`", str(template.mime_type), str(template.description))
        for template in TEMPLATES
    ]
    return table(("URI", "type", "what"), rows)


def blender_tools_page() -> str:
    """The tools that work in a live Blender, with their arguments, and the prompts beside them, as Markdown."""
    parts = [
        "# The Blender tools",
        GENERATED,
        "`simworlds mcp` serves these, and `blender_docs` and `blender_check` ([tools.md](tools.md)) beside them.",
        *_profiles(),
    ]
    for entry in (*TOOLS, *FOR_CLIENTS, WITH_ASSETS, ONLINE):
        parts += _blender_tool(entry)
    own = {entry.name for entry in (*TOOLS, *FOR_CLIENTS)}
    shared = [entry.name for entry in ATTACHED_TOOLS if entry.name in own and entry.name != "blender_execute"]
    attached = [part for tool in ATTACHED_TOOLS if tool.name not in shared for part in _blender_tool(tool)]
    return page(
        *parts,
        f"## `{plan_check.NAME}`",
        plan_check.DESCRIPTION,
        "It reads only, and needs no Blender. Its one argument, `plan`, is JSON of this shape (`name?` may be left "
        "out; its default stands behind `=`, or is null):",
        f"```\n{shape_of(ScenePlan)}\n```",
        "# In the Blender that is open",
        "`simworlds mcp --attach` serves these instead ([live-blender.md](live-blender.md)): as above "
        f"{', '.join(f'`{name}`' for name in shared)}, `blender_docs` and `blender_check`; and",
        *attached,
        "# The prompts",
        "Clients offer these to their users, as commands or in a menu. With them a model acts as the team that "
        "`simworlds make` has: it plans, builds stage by stage, verifies, reviews and renders.",
        *(
            f"## `{prompt.name}`\n\n{prompt.description}\n\n{_arguments(prompt.arguments)}"
            for prompt in PROMPTS
        ),
    )


def _profiles() -> Iterator[str]:
    yield "## Profiles"
    yield (
        "`--tools` says which tools a client is offered; each profile has those of the one before it too. The list "
        "of tools has what a model needs to call them. Bounds, which the answer to a wrong call names, and schemas of "
        f"results are in the resource `{SCHEMAS.uri}`, the plan's is in `{plan_check.SCHEMA.uri}`; `--tools all` "
        "lists tools with their bounds."
    )
    names = [*TOOL_NAMES, *(tool.name for tool in (*TOOLS, *FOR_CLIENTS)), plan_check.NAME]
    first = first_profiles(Suite((*TOOLS, *FOR_CLIENTS)), Team())
    yield table(
        ("profile", "tools", "those that it adds"),
        [
            (
                f"`{profile}`" + (" (default)" if profile == DEFAULT else ""),
                str(sum(is_within(first[name], profile) for name in names)),
                ", ".join(f"`{name}`" for name in names if first[name] == profile),
            )
            for profile in PROFILES
        ],
    )
    yield f"`--assets` adds `{WITH_ASSETS.name}`, `--online` also `{ONLINE.name}`."


def _blender_tool(entry: BlenderTool) -> list[str]:
    kind = "reads only" if entry.read_only else "changes the scene or writes files"
    table_of = schema_table(entry.arguments.model_json_schema())
    return [f"## `{entry.name}`", entry.description, f"It {kind}.", table_of]


def _arguments(arguments: Iterable[PromptArgument]) -> str:
    rows = [
        (f"`{argument.name}`", "required" if argument.required else "optional", str(argument.description))
        for argument in arguments
    ]
    return table(("name", "", "meaning"), rows)
