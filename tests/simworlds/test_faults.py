"""Data that does not fit, in words."""

from __future__ import annotations

from typing import Annotated, Literal

import pytest
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from simworlds.schemas.faults import describe_faults, every_fault, first_fault


class Part(BaseModel):
    model_config = ConfigDict(extra="forbid")
    size: float = 1.0


class Saved(BaseModel):
    model_config = ConfigDict(extra="forbid")
    name: str
    part: Part = Field(default_factory=Part)
    timeout: float = Field(default=1.0, ge=0)


class Deep(BaseModel):
    inside: dict[str, Deep] | None = None
    kind: Literal["a", "b"] = "a"


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


def error_of(data: bytes) -> ValidationError:
    with pytest.raises(ValidationError) as wrong:
        Saved.model_validate_json(data)
    return wrong.value


def test_the_first_fault_is_told_with_its_place() -> None:
    error = error_of(b'{"part": {"size": "big"}}')
    assert first_fault(error) == "name: Field required"
    assert every_fault(error) == (
        "name: Field required; part.size: Input should be a valid number, unable to parse string as a number"
    )


def test_a_fault_of_the_whole_has_the_name_that_the_caller_gives_it() -> None:
    error = error_of(b"{")
    assert first_fault(error, whole="the file").startswith("the file: Invalid JSON: EOF")
    assert first_fault(error).startswith("Invalid JSON: EOF")


def test_hostile_names_and_messages_are_cut_and_values_are_left_out() -> None:
    data: dict[str, object] = {"kind": "secret"}
    for n in range(20):
        data = {"inside": {f"{n}" + "x" * 10_000: data}}
    with pytest.raises(ValidationError) as wrong:
        Deep.model_validate(data)
    said = first_fault(wrong.value)
    assert len(said) < 8 * 61 + 202
    assert "secret" not in every_fault(wrong.value)
    with pytest.raises(ValidationError) as wrong:
        TypeAdapter(Annotated[str, Field(pattern="x" * 1000)]).validate_python("secret")
    assert len(first_fault(wrong.value)) == 200
