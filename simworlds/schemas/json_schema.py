"""The JSON Schema of a model, as every MCP client and language model understands it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from pydantic.json_schema import GenerateJsonSchema

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from pydantic import BaseModel

LARGEST_BOUND = 10_000  # bounds beyond it only keep nonsense out
SHORT_TEXT = 12  # characters of a description that is repeated wherever it stands, as a unit is
BOUND_SIGNS = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
_CHECKS = frozenset({"additionalProperties", "discriminator", "maxLength", "minLength", "pattern", "title"})
_BOUNDS = frozenset({*BOUND_SIGNS, "maxItems", "minItems"})


class Untitled(GenerateJsonSchema):
    """Schemas without titles that only repeat the names of fields."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        """Never."""
        del schema
        return False


def schema_of(model: type[BaseModel]) -> dict[str, Any]:
    """The JSON Schema of a model, with every reference replaced by what it refers to.

    Not every model's provider follows references, and clients that check results against them take longer.
    """
    schema = model.model_json_schema(schema_generator=Untitled)
    parts = schema.pop("$defs", {})
    return cast("dict[str, Any]", _inlined(schema, parts))


def _inlined(schema: Any, parts: Mapping[str, Any]) -> Any:
    if isinstance(schema, list):
        return [_inlined(item, parts) for item in cast("list[Any]", schema)]
    if not isinstance(schema, dict):
        return schema
    own = dict(cast("dict[str, Any]", schema))
    reference = own.pop("$ref", None)
    named = parts[reference.rpartition("/")[2]] if reference else {}
    return {key: _inlined(value, parts) for key, value in {**named, **own}.items()}


def lean_schema_of(model: type[BaseModel]) -> dict[str, Any]:
    """A model's JSON Schema for data that is checked elsewhere too: without generous bounds, patterns and repeated
    descriptions.
    """
    return cast("dict[str, Any]", _lean(schema_of(model), set()))


def lean_arguments(schema: Mapping[str, Any]) -> dict[str, Any]:
    """A JSON Schema of arguments that are checked elsewhere, as a model needs it: without bounds, without defaults of
    nothing (false, 0, an empty text or list), and without null where that only says that an argument is left out.
    """
    return cast("dict[str, Any]", _lean(_without_null(schema), set()))


def _without_null(schema: Any) -> Any:
    if isinstance(schema, list):
        return [_without_null(item) for item in cast("list[Any]", schema)]
    if not isinstance(schema, dict):
        return schema
    kept = {
        key: value
        for key, value in _below(cast("dict[str, Any]", schema), _without_null).items()
        if key not in _BOUNDS and not (key == "default" and value is not None and not value)
    }
    choices = [one for one in kept.get("anyOf", ()) if one != {"type": "null"}]
    if len(choices) == 1 and kept.get("default", "") is None:
        del kept["anyOf"]
        kept |= choices[0]
    return kept


def _lean(schema: Any, described: set[str]) -> Any:
    if isinstance(schema, list):
        return [_lean(item, described) for item in cast("list[Any]", schema)]
    if not isinstance(schema, dict):
        return schema
    kept = {
        key: value
        for key, value in cast("dict[str, Any]", schema).items()
        if not (key in _CHECKS or _is_needless(key, value))
    }
    meaning = kept.get("description")
    if isinstance(meaning, str):
        if len(meaning) > SHORT_TEXT and meaning in described:
            del kept["description"]
        described.add(meaning)
    lean = _below(kept, lambda part: _lean(part, described))
    items = lean.get("prefixItems")
    if items and all(item == items[0] for item in items):  # a vector
        lean["items"] = lean.pop("prefixItems")[0]
    return lean


def _below(schema: Mapping[str, Any], change: Callable[[Any], Any]) -> dict[str, Any]:
    """A schema with all that stands below it changed. Properties may have names that are words of schemas."""
    return {
        key: {name: change(part) for name, part in value.items()} if key == "properties" else change(value)
        for key, value in schema.items()
    }


def _is_needless(key: str, value: Any) -> bool:
    return (key == "default" and value is None) or (key in BOUND_SIGNS and abs(value) >= LARGEST_BOUND)
