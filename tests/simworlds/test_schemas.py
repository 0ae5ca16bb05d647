"""What models are told of data: JSON Schema without references, and types in a notation of a few lines."""

from __future__ import annotations

import json
from typing import Any, Literal

import pytest
from jsonschema import Draft202012Validator
from pydantic import BaseModel, Field
from small_plan import small_plan

from agents.blender.tool_catalogue import TOOLS
from agents.plan.scene import ScenePlan
from simworlds.mcp_transport.schemas import schema_of
from simworlds.schema_notation import lean_schema_of, shape_of


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


def test_types_are_told_in_a_few_lines_each_meaning_once() -> None:
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


def test_what_is_told_elsewhere_is_not_told_again() -> None:
    assert "Wheel {\n" in shape_of(Cart, told="There is this: A wheel; `size` is in metres. And more.")


def test_a_model_that_two_use_is_told_once() -> None:
    assert shape_of(Cart, Wheel) == shape_of(Cart)


@pytest.mark.parametrize("model", [ScenePlan, *(tool.arguments for tool in TOOLS)])
def test_schemas_refer_to_nothing_and_are_schemas(model: type[BaseModel]) -> None:
    for schema in (schema_of(model), lean_schema_of(model)):
        assert "$ref" not in json.dumps(schema)
        Draft202012Validator.check_schema(schema)


def test_the_lean_schema_takes_what_the_plan_takes_and_still_knows_its_fields() -> None:
    lean = Draft202012Validator(lean_schema_of(ScenePlan))
    assert list(lean.iter_errors(small_plan())) == []
    broken: dict[str, Any] = small_plan() | {"fps": "many"}
    broken["objects"][0]["dimensions"] = [1, 2]
    broken["objects"][1]["role"] = "furniture"
    del broken["objects"][2]["name"]
    assert {"/".join(map(str, error.path)) for error in lean.iter_errors(broken)} == {
        "fps",
        "objects/0/dimensions",
        "objects/1/role",
        "objects/2",
    }


def test_the_lean_schema_is_much_shorter() -> None:
    assert len(json.dumps(lean_schema_of(ScenePlan))) < 0.7 * len(json.dumps(schema_of(ScenePlan)))
    assert len(shape_of(ScenePlan)) < 0.4 * len(json.dumps(schema_of(ScenePlan)))
