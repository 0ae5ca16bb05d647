"""The tool ``blender_docs`` as a client sees it: description, arguments, the shape of what it returns, and a call."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

from mcp_types import CallToolResult, TextContent, Tool, ToolAnnotations
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from kb_serve.answer.docs_answer import AnswerKind
from kb_serve.errors import BadQuery
from kb_serve.query_limits import LEAST_TOKENS, LIMIT, LONGEST_QUERY, MAX_TOKENS
from simworlds.schemas.faults import describe_faults
from simworlds.schemas.json_schema import schema_of

if TYPE_CHECKING:
    from kb_serve.answer.docs_answer import DocsAnswer
    from kb_serve.service import Service

NAME = "blender_docs"
_QUICK_CHARACTERS = 300
_Arguments = TypeVar("_Arguments", bound=BaseModel)

DESCRIPTION = """\
Look up the Python API and manual of the Blender in use: exact schemas (types, defaults, ranges, enum values, \
units), operators with their arguments, node sockets, manual pages. Facts come from that Blender itself. \
Query before you write a name you are not sure of: what you remember may belong to another version.

`query`, one thing at a time:
- a name: `ClothSettings.quality`, `bpy.ops.object.modifier_add`, `ShaderNodeBsdfPrincipled`
- lines of your code: `bpy.context.object.modifiers["Cloth"].settings.quality`; wrong names are answered with what \
took their place, wrong values with what fits
- an error message, whole: `AttributeError: …`; an enum value
- plain words: `make cloth collide with itself`
- a topic, when you begin a stage of work (`cloth`, `rigid body`, `uv`): how it is done, pages, classes, operators

The best hit is shown in full, others by `id`; query an id to see it. A long answer ends with the part to go on with, \
as `part=23`. `blender="4.5"` asks another version's base."""


class DocsArguments(BaseModel):
    """The arguments of a call."""

    model_config = ConfigDict(extra="forbid", coerce_numbers_to_str=True, title="blender_docs")

    # Checked where the query is answered, in words of its own.
    query: str = Field(
        description="One name, question or topic.", json_schema_extra={"maxLength": LONGEST_QUERY}
    )
    blender: str | None = Field(
        default=None,
        description="Default: the version in use.",
    )
    limit: int = Field(default=LIMIT, ge=1, description="Hits at most.")
    max_tokens: int = Field(default=MAX_TOKENS, ge=LEAST_TOKENS, description="Of the answer, at most.")
    part: int = Field(default=1, ge=1, description="The part to begin with.")


class DocsHit(BaseModel):
    """A symbol or page that the answer is about."""

    id: str = Field(description="Symbol path or page slug; also a query that finds exactly this.")
    kind: str = Field(description="class, property, operator, …, or manual, guide, template for pages.")
    title: str
    score: float = Field(description="Higher is better; comparable within one answer only.")
    url: str = Field(description="The public manual page, where there is one.")


class DocsReply(BaseModel):
    """The structured content of a result."""

    model_config = ConfigDict(title="blender_docs answer")

    kind: AnswerKind = Field(
        description="How well the query was met: by one symbol or page, by several candidates, or not at all."
    )
    text: str = Field(description="The answer in Markdown.")
    hits: list[DocsHit] = Field(description="The symbols and pages found, best first.")
    notes: list[str] = Field(description="Corrections, missing sources, differences between versions.")
    part: int = Field(description="The part that the text begins with.")
    parts: int = Field(description="How many parts the whole answer has; a part is a few lines.")
    next_part: int = Field(description="The part to ask for next, 0 when this was all.")
    blender: str = Field(description="The Blender version that the answer holds for.")


@cache
def tool() -> Tool:
    """The tool as the list of tools has it."""
    return reading_tool(NAME, "Blender documentation", DESCRIPTION, DocsArguments, DocsReply)


def reading_tool(
    name: str, title: str, description: str, arguments: type[BaseModel], reply: type[BaseModel]
) -> Tool:
    """A tool that is marked as one that only reads; then the protocol's other hints say nothing more."""
    schema = schema_of(arguments)
    schema.pop("description", None)  # the tool has its own
    return Tool(
        name=name,
        title=title,
        description=description,
        input_schema=schema,
        output_schema=schema_of(reply),
        annotations=ToolAnnotations(title=title, read_only_hint=True),
    )


def parsed(model: type[_Arguments], name: str, arguments: dict[str, Any] | None) -> _Arguments:
    """The arguments of a call of a tool, checked. Raises BadQuery, which names each wrong one."""
    try:
        return model.model_validate(arguments or {})
    except ValidationError as error:
        wrong = describe_faults(model, error, at_most=500)
        raise BadQuery(f"The arguments do not fit {name}: {wrong}") from error


def answer(service: Service, arguments: dict[str, Any] | None) -> CallToolResult:
    """The result of a call. Raises KBServeError."""
    query = parsed(DocsArguments, NAME, arguments)
    found, version = service.ask(
        query.query, blender=query.blender, limit=query.limit, max_tokens=query.max_tokens, part=query.part
    )
    reply = _reply(found, version)
    return CallToolResult(
        content=[TextContent(text=reply.text)], structured_content=reply.model_dump(mode="json")
    )


def _reply(found: DocsAnswer, version: str) -> DocsReply:
    return DocsReply(
        kind=found.kind,
        text=found.text,
        hits=[
            DocsHit(id=hit.id, kind=hit.kind, title=hit.title, score=hit.score, url=hit.url)
            for hit in found.hits
        ],
        notes=list(found.notes),
        part=found.part,
        parts=found.parts,
        next_part=found.next_part,
        blender=version,
    )


def is_quick(arguments: dict[str, Any] | None) -> bool:
    """Whether a call takes milliseconds: its query is short, and it names no Blender, whose base may not be open."""
    given = arguments or {}
    return len(str(given.get("query", ""))) <= _QUICK_CHARACTERS and not given.get("blender")
