"""Wrong arguments in words."""

from __future__ import annotations

import pytest
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from simworlds.schemas.faults import describe_faults


class Part(BaseModel):
    model_config = ConfigDict(extra="forbid")
    size: float = 1.0


class Saved(BaseModel):
    model_config = ConfigDict(extra="forbid")
    name: str
    part: Part = Field(default_factory=Part)
    timeout: float = Field(default=1.0, ge=0)


def faults_of(at_most: int = 500, **arguments: object) -> str:
    with pytest.raises(ValidationError) as wrong:
        Saved.model_validate(arguments)
    return describe_faults(Saved, wrong.value, at_most=at_most)


def test_an_unknown_argument_is_answered_with_those_that_there_are() -> None:
    assert faults_of(name="a", path="b") == (
        "path: there is no such argument. The arguments are: name, part, timeout."
    )
    said = faults_of(path="b")
    assert "name: Field required; path: there is no such argument. The arguments are: name, part" in said


def test_other_faults_and_those_inside_an_argument_need_no_list() -> None:
    assert faults_of(name="a", timeout=-1) == "timeout: Input should be greater than or equal to 0"
    assert faults_of(name="a", part={"width": 1}) == "part.width: Extra inputs are not permitted"


def test_many_faults_are_cut_but_the_names_stay() -> None:
    said = faults_of(at_most=50, **{f"wrong_{n}": n for n in range(100)})
    assert len(said) < 120
    assert said.endswith("The arguments are: name, part, timeout.")
