"""Types as docstrings and signatures spell them."""

from __future__ import annotations

import pytest

from kb_build.flow.blender.type_text import read_type
from kb_build.flow.values.types import STR, UNKNOWN, Instance, Sequence

STRIPS = "bpy.types.Sequence"


@pytest.mark.parametrize(
    ("text", "has_strips", "kind"),
    [
        ("Sequence", True, Instance(STRIPS)),  # what strips were called until Blender 4.5
        ("Sequence", False, Sequence("list", UNKNOWN)),
        ("Sequence[str]", True, Sequence("list", STR)),
        ("list", True, Sequence("list", UNKNOWN)),
    ],
)
def test_a_class_of_blender_comes_before_pythons_word(text: str, has_strips: bool, kind: object) -> None:
    assert read_type(text, lambda name: STRIPS if has_strips and name == "Sequence" else "") == kind


@pytest.mark.parametrize("text", ["Layers[Item]", "Layers of Item", "x.Layers of x.Item"])
def test_what_a_class_holds_is_read_in_each_form(text: str) -> None:
    read = read_type(text, lambda name: f"x.{name.removeprefix('x.')}")
    assert read == Instance("x.Layers", (("[]", Instance("x.Item")),))
