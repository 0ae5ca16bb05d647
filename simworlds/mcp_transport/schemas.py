"""The JSON Schema of a model, as every MCP client and language model understands it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from pydantic.json_schema import GenerateJsonSchema

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pydantic import BaseModel


class Untitled(GenerateJsonSchema):
    """Schemas without titles that only repeat the names of fields."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        """Never."""
        del schema
        return False


def schema_of(model: type[BaseModel]) -> dict[str, Any]:
    """The JSON Schema of a model, what it refers to written out in place.

    Not every model's provider follows references, and clients that check results against them take longer.
    """
    schema = model.model_json_schema(schema_generator=Untitled)
    parts = schema.pop("$defs", {})
    return cast("dict[str, Any]", _written_out(schema, parts))


def _written_out(schema: Any, parts: Mapping[str, Any]) -> Any:
    if isinstance(schema, list):
        return [_written_out(one, parts) for one in cast("list[Any]", schema)]
    if not isinstance(schema, dict):
        return schema
    given = cast("dict[str, Any]", schema)
    named = parts[given["$ref"].rpartition("/")[2]] if "$ref" in given else {}
    own = {key: value for key, value in given.items() if key != "$ref"}
    return {key: _written_out(value, parts) for key, value in {**named, **own}.items()}
