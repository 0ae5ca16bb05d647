"""Pydantic models as JSON Schema without references, and in a short notation of types."""

from __future__ import annotations

import json
from typing import Any, Literal

import pytest
from jsonschema import Draft202012Validator
from pydantic import BaseModel, Field

from simworlds.schemas.json_schema import lean_arguments, lean_schema_of, schema_of
from simworlds.schemas.notation import shape_of


class Wheel(BaseModel):
    """A wheel; ``size`` is in metres."""

    size: float = Field(gt=0, le=1e6)
    spin: Literal["left", "right"] | None = None


class Cart(BaseModel):
    name: str = Field(max_length=20, description="What it is called, in a few words.")
    owner: str = Field(default="", description="What it is called, in a few words.")
    load: float = Field(default=0.5, ge=0, le=1)
    place: tuple[float, float]
    wheels: tuple[Wheel, ...] = Field(min_length=2)
    spare: Wheel | None = None
    kinds: list[Literal["a", "b"]] = []
    marks: dict[str, int] = {}


def test_notation_is_short_and_has_each_description_once() -> None:
    assert shape_of(Cart) == "\n".join(
        [
            "Cart {",
            "  name: string  // What it is called, in a few words.",
            "  owner?: string",
            "  load?: number 0..1 = 0.5",
            "  place: [number, number]",
            "  wheels: Wheel[at least 2]",
            "  spare?: Wheel | null",
            '  kinds?: ("a" | "b")[]',
            "  marks?: {name: int}",
            "}",
            "",
            "Wheel {  // A wheel; `size` is in metres.",
            "  size: number >0",
            '  spin?: "left" | "right" | null',
            "}",
        ]
    )


def test_descriptions_given_before_are_not_repeated() -> None:
    assert "Wheel {\n" in shape_of(Cart, before="There is this: A wheel; `size` is in metres. And more.")


def test_what_is_lean_keeps_arguments_of_any_name_and_defaults_that_say_something() -> None:
    fields: dict[str, Any] = {
        name: {"type": "integer", "default": 1}
        for name in ("start", "minimum", "default", "title", "properties")
    }
    assert lean_arguments({"properties": fields}) == {"properties": fields}
    empty = {"a": {"default": False}, "b": {"default": ""}, "c": {"default": []}, "d": {"default": 0}}
    assert lean_arguments({"properties": empty}) == {"properties": {"a": {}, "b": {}, "c": {}, "d": {}}}


def test_fields_that_are_left_out_are_not_told() -> None:
    lines = shape_of(Cart).splitlines()
    assert shape_of(Cart, without={"Wheel.spin"}).splitlines() == [one for one in lines if "spin" not in one]


def test_a_shared_model_is_written_once() -> None:
    assert shape_of(Cart, Wheel) == shape_of(Cart)


@pytest.mark.parametrize("schema", [schema_of(Cart), lean_schema_of(Cart)])
def test_schemas_are_valid_and_have_no_references(schema: dict[str, Any]) -> None:
    assert "$ref" not in json.dumps(schema)
    Draft202012Validator.check_schema(schema)


def test_lean_schema_has_each_description_once_and_no_generous_bounds() -> None:
    lean = lean_schema_of(Cart)["properties"]
    assert "description" in lean["name"]
    assert "description" not in lean["owner"]
    assert "maxLength" not in lean["name"]
    assert lean["place"] == {"maxItems": 2, "minItems": 2, "items": {"type": "number"}, "type": "array"}
    assert lean["wheels"]["items"]["properties"]["size"] == {"exclusiveMinimum": 0, "type": "number"}
