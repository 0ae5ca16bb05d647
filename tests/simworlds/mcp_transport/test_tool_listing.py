"""What a list of tools leaves out, and what it keeps."""

from __future__ import annotations

from typing import Literal

from mcp_types import TextResourceContents, Tool, ToolAnnotations
from pydantic import BaseModel, Field

from simworlds.mcp_transport.tool_listing import SCHEMAS, as_listed, schemas_text, tools_of
from simworlds.schemas.json_schema import schema_of


class Move(BaseModel):
    """The arguments."""

    where: str = Field(min_length=1, max_length=9, description="A place.")
    speed: float | None = Field(default=None, le=3)
    gait: Literal["walk", "run"] | None = Field(json_schema_extra={"description": "null stops it."})
    retries: int = Field(default=2, ge=0)


def tool(*, reads: bool = False, destroys: bool = True) -> Tool:
    hints = ToolAnnotations(
        title="Move",
        read_only_hint=reads,
        destructive_hint=destroys,
        idempotent_hint=reads,
        open_world_hint=False,
    )
    schema = schema_of(Move)
    return Tool(name="move", title="Move", input_schema=schema, output_schema=schema, annotations=hints)


def test_bounds_and_meaningless_null_go_and_defaults_and_meaningful_null_stay() -> None:
    fields = as_listed(tool()).input_schema["properties"]
    assert fields["where"] == {"description": "A place.", "type": "string"}
    assert fields["speed"] == {"type": "number"}
    assert {"type": "null"} in fields["gait"]["anyOf"]
    assert fields["retries"]["default"] == 2
    assert as_listed(tool()).output_schema is None


def hints(entry: Tool) -> dict[str, object]:
    assert entry.annotations is not None
    return entry.annotations.model_dump(by_alias=True, exclude_none=True)


def test_hints_mean_the_same_by_what_the_protocol_presumes() -> None:
    assert hints(as_listed(tool(reads=True, destroys=False))) == {"readOnlyHint": True}
    assert hints(as_listed(tool())) == {"openWorldHint": False}
    assert hints(as_listed(tool(destroys=False))) == {"destructiveHint": False, "openWorldHint": False}


def test_whole_schemas_come_back_as_they_went() -> None:
    text = schemas_text([tool()])
    contents = [TextResourceContents(uri=SCHEMAS.uri, text=text, mime_type=SCHEMAS.mime_type)]
    assert tools_of(contents) == [tool()]
