"""Pydantic models in a short notation of types, for prompts: a third as long as their JSON Schema."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, cast

from simworlds.schemas.json_schema import BOUND_SIGNS, LARGEST_BOUND, SHORT_TEXT, Untitled

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping

    from pydantic import BaseModel

HOW_TO_READ = (
    "Written as types: `name?` may be left out and is then the value behind `=`, or null; what stands behind `//` is "
    "its meaning. No other fields are taken."
)
_NAMES = {"integer": "int", "number": "number", "string": "string", "boolean": "bool", "null": "null"}


def _name(reference: str) -> str:
    return reference.rpartition("/")[2]


def shape_of(*models: type[BaseModel], before: str = "", without: Collection[str] = ()) -> str:
    """Models in the notation of types that programmers know, a third as long as their JSON Schema.

    ``name?: type = default`` is a field that may be left out; its meaning follows ``//``.
    A model that several use is written once; a description that ``before`` contains is not repeated; fields that
    ``without`` names (``Model.field``) are left out.
    """
    writer = _Writer(before, without)
    for model in models:
        writer.add(model)
    return "\n\n".join(writer.texts)


class _Writer:
    """Writes models one after the other, each and each longer description once."""

    def __init__(self, before: str, without: Collection[str]) -> None:
        self.texts: list[str] = []
        self._without = without
        self._before = before
        self._written: set[str] = set()
        self._described: set[str] = set()

    def add(self, model: type[BaseModel]) -> None:
        """Writes a model, and behind it those that it uses."""
        schema = model.model_json_schema(schema_generator=Untitled)
        parts = schema.pop("$defs", {})
        waiting = [(model.__name__, schema)]
        while waiting:
            name, part = waiting.pop(0)
            if name not in self._written:
                self._written.add(name)
                self.texts.append(self._model(name, part))
                waiting += [(used, parts[used]) for used in _references(part)]

    def _model(self, name: str, schema: Mapping[str, Any]) -> str:
        meaning = _one_line(schema.get("description", ""))
        lines = [f"{name} {{{'' if meaning in self._before else _comment(meaning)}"]
        required = schema.get("required", ())
        for field, below in schema["properties"].items():
            if f"{name}.{field}" in self._without:
                continue
            mark = "" if field in required else "?"
            lines.append(f"  {field}{mark}: {_type(below)}{_default(below)}{self._meaning(below)}")
        return "\n".join([*lines, "}"])

    def _meaning(self, schema: Mapping[str, Any]) -> str:
        text = _one_line(next(_descriptions(schema), ""))
        if len(text) > SHORT_TEXT and text in self._described:
            return ""
        self._described.add(text)
        return _comment(text)


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
        for item in cast("list[Any]", schema):
            yield from _references(item)
    elif isinstance(schema, dict):
        named = cast("dict[str, Any]", schema)
        if "$ref" in named:
            yield _name(named["$ref"])
        for key, below in named.items():
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
        return " | ".join(_type(option) for option in schema.get("anyOf", schema.get("oneOf")))
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
    known = {key: schema[key] for key in BOUND_SIGNS if abs(schema.get(key, LARGEST_BOUND)) < LARGEST_BOUND}
    if set(known) == {"minimum", "maximum"}:
        return f" {known['minimum']:g}..{known['maximum']:g}"
    return "".join(f" {BOUND_SIGNS[key]}{value:g}" for key, value in known.items())


def _default(schema: Mapping[str, Any]) -> str:
    default = schema.get("default")
    return "" if default in (None, "", [], {}) else f" = {json.dumps(default)}"
