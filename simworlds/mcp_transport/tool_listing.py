"""What a server tells of its tools: in the list as little as a model needs to call them, in a resource everything."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from mcp_types import Resource, ResourceContents, TextResourceContents, Tool, ToolAnnotations

from simworlds.schemas.json_schema import lean_arguments

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

SCHEMAS = Resource(
    uri="blender://tools",
    name="tools",
    title="Whole schemas of the tools",
    description="Every tool with all bounds of its arguments and, where it has one, the schema of its result.",
    mime_type="application/json",
)


def as_listed(tool: Tool) -> Tool:
    """A tool's entry as clients list it: without bounds, which its answer to a wrong call names, without the schema of
    its result, without a title beside its name, and without hints that say what holds anyway.
    """
    return tool.model_copy(
        update={
            "input_schema": lean_arguments(tool.input_schema),
            "output_schema": None,
            "title": None,
            "annotations": _telling(tool.annotations) if tool.annotations else None,
        }
    )


def _telling(hints: ToolAnnotations) -> ToolAnnotations:
    """The hints that differ from what the protocol presumes; of a tool that only reads, that says enough."""
    if hints.read_only_hint:
        return ToolAnnotations(read_only_hint=True)
    return ToolAnnotations(
        destructive_hint=None if hints.destructive_hint else False,
        idempotent_hint=hints.idempotent_hint or None,
        open_world_hint=hints.open_world_hint,
    )


def schemas_text(tools: Iterable[Tool]) -> str:
    """The contents of ``SCHEMAS`` for these tools."""
    whole = [tool.model_dump(mode="json", by_alias=True, exclude_none=True) for tool in tools]
    return json.dumps(whole, ensure_ascii=False, indent=1)


def tools_of(contents: Sequence[ResourceContents]) -> list[Tool]:
    """The tools in the contents of ``SCHEMAS``. Raises ValueError if that is not what they are."""
    texts = [part.text for part in contents if isinstance(part, TextResourceContents)]
    return [Tool.model_validate(entry) for text in texts for entry in json.loads(text)]
