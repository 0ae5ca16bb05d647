"""The scene plan's schemas, as models get them: valid, without references, short."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest
from jsonschema import Draft202012Validator
from small_plan import small_plan

from agents.blender.tool_catalogue import TOOLS
from agents.plan.scene import ScenePlan
from simworlds.schemas.json_schema import lean_schema_of, schema_of
from simworlds.schemas.notation import shape_of

if TYPE_CHECKING:
    from pydantic import BaseModel


@pytest.mark.parametrize("model", [ScenePlan, *(tool.arguments for tool in TOOLS)])
def test_schemas_are_valid_and_have_no_references(model: type[BaseModel]) -> None:
    for schema in (schema_of(model), lean_schema_of(model)):
        assert "$ref" not in json.dumps(schema)
        Draft202012Validator.check_schema(schema)


def test_lean_schema_accepts_plans_and_rejects_wrong_fields() -> None:
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


def test_lean_schema_and_notation_are_much_shorter() -> None:
    assert len(json.dumps(lean_schema_of(ScenePlan))) < 0.7 * len(json.dumps(schema_of(ScenePlan)))
    assert len(shape_of(ScenePlan)) < 0.4 * len(json.dumps(schema_of(ScenePlan)))
