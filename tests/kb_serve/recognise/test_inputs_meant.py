"""What a node, or what is made of nodes, is asked for as if it were a property of its own is an input of a node."""

from __future__ import annotations

import re
import warnings
from typing import TYPE_CHECKING, Any

import pytest

from kb_serve.recognise.elsewhere.inputs_meant import input_meant

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

bpy: Any = pytest.importorskip("bpy")
T = "bpy.types."


@pytest.mark.parametrize(
    ("owner", "name", "path"),
    [
        ("ShaderNodeTexNoise", "scale", 'ShaderNodeTexNoise.inputs["Scale"]'),
        ("ShaderNodeBsdfPrincipled", "base_color", 'ShaderNodeBsdfPrincipled.inputs["Base Color"]'),
        ("ShaderNodeBsdfPrincipled", "emission", 'ShaderNodeBsdfPrincipled.inputs["Emission Color"]'),
        ("GeometryNodeRepeatOutput", "iterations", 'GeometryNodeRepeatInput.inputs["Iterations"]'),
        ("Material", "ior", 'ShaderNodeBsdfPrincipled.inputs["IOR"]'),
        ("World", "strength", 'ShaderNodeBackground.inputs["Strength"]'),
    ],
)
def test_an_input_is_found_by_its_label_or_how_that_begins(
    reader: BaseReader, owner: str, name: str, path: str
) -> None:
    found = input_meant(f"{T}{owner}", name, reader)
    assert found is not None
    assert found.path == f"{T}{path}"


@pytest.mark.parametrize(
    ("owner", "name"), [("Material", "texture"), ("Mesh", "color"), ("ShaderNodeMix", "_"), ("World", "")]
)
def test_no_input_is_meant_by_other_names(reader: BaseReader, owner: str, name: str) -> None:
    assert input_meant(f"{T}{owner}", name, reader) is None


@pytest.mark.blender
@pytest.mark.parametrize(("owner", "name"), [("Material", "emission_strength"), ("World", "strength")])
def test_what_a_thing_is_made_of_is_told_and_can_be_set(kb: KnowledgeBase, owner: str, name: str) -> None:
    answer = kb.query(f"AttributeError: '{owner}' object has no attribute '{name}'")
    assert answer.hits[0].id.endswith('Strength"]')
    access = re.search(rf"`{owner.lower()}\.(node_tree.+?)`", "\n".join(answer.notes))
    assert access is not None
    thing = getattr(bpy.data, f"{owner.lower()}s").new("made")
    with warnings.catch_warnings(action="ignore", category=DeprecationWarning):
        thing.use_nodes = True  # which it always is from 5.0
    assert eval(f"thing.{access[1]}", {"thing": thing}) >= 0


@pytest.mark.parametrize("code", ["mat.emission_strength = 2", "bsdf.emission_strength = 2"])
def test_it_comes_before_what_else_has_that_name(kb: KnowledgeBase, code: str) -> None:
    assert kb.query(code).hits[0].id == f'{T}ShaderNodeBsdfPrincipled.inputs["Emission Strength"]'
