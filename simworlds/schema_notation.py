"""What data has to look like, as models are told it: JSON Schema for tools, and a shorter notation for prompts."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, cast

from simworlds.mcp_transport.schemas import Untitled, schema_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from pydantic import BaseModel

_OBVIOUS = 10_000  # bounds beyond it only keep nonsense out
_SHORT = 12  # characters of a description that is told wherever it stands, as a unit is
_POLICING = frozenset({"additionalProperties", "discriminator", "maxLength", "minLength", "pattern", "title"})
_SIGNS = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
_NAMES = {"integer": "int", "number": "number", "string": "string", "boolean": "bool", "null": "null"}


def lean_schema_of(model: type[BaseModel]) -> dict[str, Any]:
    """A model's JSON Schema for what is checked anyway: without what only keeps nonsense out, each longer description
    once.
    """
    return cast("dict[str, Any]", _lean(schema_of(model), set()))


def _lean(schema: Any, told: set[str]) -> Any:
    if isinstance(schema, list):
        return [_lean(one, told) for one in cast("list[Any]", schema)]
    if not isinstance(schema, dict):
        return schema
    given = {
        key: value
        for key, value in cast("dict[str, Any]", schema).items()
        if not (key in _POLICING or _is_obvious(key, value))
    }
    meaning = given.get("description")
    if isinstance(meaning, str):
        if len(meaning) > _SHORT and meaning in told:
            del given["description"]
        told.add(meaning)
    lean = {
        key: {name: _lean(below, told) for name, below in value.items()}
        if key == "properties"
        else _lean(value, told)
        for key, value in given.items()
    }
    items = lean.get("prefixItems")
    if items and all(item == items[0] for item in items):  # a vector
        lean["items"] = lean.pop("prefixItems")[0]
    return lean


def _is_obvious(key: str, value: Any) -> bool:
    return (key == "default" and value is None) or (key in _SIGNS and abs(value) >= _OBVIOUS)


def _name(reference: str) -> str:
    return reference.rpartition("/")[2]


# The shorter notation


def shape_of(*models: type[BaseModel], told: str = "") -> str:
    """Models in the notation of types that programmers know, a third as long as their JSON Schema.

    ``name?: type = default`` is a field that may be left out; what a field or model means stands behind ``//``.
    A model that several use is told once; what ``told`` says of one already is not repeated.
    """
    writer = _Writer(told)
    for model in models:
        writer.add(model)
    return "\n\n".join(writer.texts)


class _Writer:
    """Writes models one after the other, each and each longer description once."""

    def __init__(self, told: str) -> None:
        self.texts: list[str] = []
        self._before = told
        self._written: set[str] = set()
        self._told: set[str] = set()

    def add(self, model: type[BaseModel]) -> None:
        """Writes a model, and behind it those that it uses."""
        schema = model.model_json_schema(schema_generator=Untitled)
        parts = schema.pop("$defs", {})
        waiting = [(model.__name__, schema)]
        while waiting:
            name, one = waiting.pop(0)
            if name not in self._written:
                self._written.add(name)
                self.texts.append(self._model(name, one))
                waiting += [(found, parts[found]) for found in _references(one)]

    def _model(self, name: str, schema: Mapping[str, Any]) -> str:
        meaning = _one_line(schema.get("description", ""))
        lines = [f"{name} {{{'' if meaning in self._before else _comment(meaning)}"]
        required = schema.get("required", ())
        for field, below in schema["properties"].items():
            mark = "" if field in required else "?"
            lines.append(f"  {field}{mark}: {_type(below)}{_default(below)}{self._meaning(below)}")
        return "\n".join([*lines, "}"])

    def _meaning(self, schema: Mapping[str, Any]) -> str:
        told = _one_line(next(_descriptions(schema), ""))
        if len(told) > _SHORT and told in self._told:
            return ""
        self._told.add(told)
        return _comment(told)


def _one_line(text: str) -> str:
    return " ".join(text.replace("``", "`").split())


def _comment(text: str) -> str:
    return f"  // {text}" if text else ""


def _descriptions(schema: Mapping[str, Any]) -> Iterator[str]:
    if "description" in schema:
        yield schema["description"]
    for below in (*schema.get("anyOf", ()), *([schema["items"]] if "items" in schema else ())):
        yield from _descriptions(below)


def _references(schema: Any) -> Iterator[str]:
    """The names that a schema refers to, in order."""
    if isinstance(schema, list):
        for one in cast("list[Any]", schema):
            yield from _references(one)
    elif isinstance(schema, dict):
        given = cast("dict[str, Any]", schema)
        if "$ref" in given:
            yield _name(given["$ref"])
        for key, below in given.items():
            if key != "discriminator":
                yield from _references(below)


def _type(schema: Mapping[str, Any]) -> str:  # noqa: PLR0911 - one for each kind of schema
    if "$ref" in schema:
        return _name(schema["$ref"])
    if "const" in schema:
        return json.dumps(schema["const"])
    if "enum" in schema:
        return " | ".join(map(json.dumps, schema["enum"]))
    if "anyOf" in schema or "oneOf" in schema:
        return " | ".join(_type(one) for one in schema.get("anyOf", schema.get("oneOf")))
    if "prefixItems" in schema:
        return f"[{', '.join(map(_type, schema['prefixItems']))}]"
    if schema.get("type") == "array":
        inner = _type(schema["items"])
        least = schema.get("minItems", 0)
        return f"{f'({inner})' if ' ' in inner else inner}[{f'at least {least}' if least else ''}]"
    if schema.get("type") == "object":
        return f"{{name: {_type(schema['additionalProperties'])}}}"
    return _NAMES.get(schema.get("type", ""), "any") + _bounds(schema)


def _bounds(schema: Mapping[str, Any]) -> str:
    known = {key: schema[key] for key in _SIGNS if abs(schema.get(key, _OBVIOUS)) < _OBVIOUS}
    if set(known) == {"minimum", "maximum"}:
        return f" {known['minimum']:g}..{known['maximum']:g}"
    return "".join(f" {_SIGNS[key]}{value:g}" for key, value in known.items())


def _default(schema: Mapping[str, Any]) -> str:
    default = schema.get("default")
    return "" if default in (None, "", [], {}) else f" = {json.dumps(default)}"
