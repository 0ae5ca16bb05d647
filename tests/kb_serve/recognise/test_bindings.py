"""Variables that a query's own code binds stand for what they were bound to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.chains.bindings import with_bindings
from kb_serve.recognise.chains.chains import find_chains

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


def bound(text: str) -> list[str]:
    """The names in each chain with steps; ``[]`` stands for an index."""
    return [
        ".".join((chain.root, *(step.text if step.kind == "attr" else "[]" for step in chain.steps)))
        for chain in with_bindings(text, find_chains(text))
        if chain.steps
    ]


@pytest.mark.parametrize(
    ("text", "last"),
    [
        ("x = a.b\nx.c", "a.b.c"), ("x = a.b x.c", "a.b.c"), ("x = a.b\ny = x.c\ny.d", "a.b.c.d"),
        ("x = a.b; x = x.c; x.d", "a.b.c.d"), ("for x in a.b:\n    x.c", "a.b.[].c"),
        ("for i, x in enumerate(a.b): x.c", "a.b.[].c"), ("with a.b as x: x.c", "a.b.c"),
        ("x = N('ShaderNodeMath')\nx.c", "nodes.new.[].c"), ("x = N('Math')\nx.c", "N.[].c"),
        ('File "s.py", line 2\n    x = a.b\n    x.c', "a.b.c"),
    ],
)  # fmt: skip
def test_what_a_variable_is_bound_to_takes_its_place(text: str, last: str) -> None:
    assert bound(text)[-1] == last


def test_an_element_may_be_used_before_it_is_bound() -> None:
    assert bound("[x.c for x in a.b]") == ["a.b.[].c", "a.b"]


@pytest.mark.parametrize(
    "text",
    [
        "x = a.b + 1\nx.c",
        "x = a.b if t else d.e\nx.c",
        "y, x = a.b, d.e\nx.c",
        "x = a.b\nx = 3\nx.c",
        "x == a.b\nx.c",
    ],
)
def test_a_part_of_what_is_assigned_is_not_what_is_bound(text: str) -> None:
    assert bound(text)[-1] == "x.c"


@pytest.mark.parametrize(
    ("code", "path"),
    [
        ("a = bpy.data.lights.new('l', 'SUN')\na.angle = 1", "bpy.types.SunLight.angle"),
        ("a = ob.modifiers.new('b', 'BEVEL')\na.width = 1", "bpy.types.BevelModifier.width"),
        ("a = t.nodes.new('ShaderNodeTexNoise')\na.noise_dimensions", "bpy.types.ShaderNodeTexNoise.noise_dimensions"),
        ("for a in bm.faces: a.normal_flip()", "bmesh.types.BMFace.normal_flip"),
        ("a = bpy.context.object.data\na.dimensions", "bpy.types.Curve.dimensions"),
        ("a = rv3d.view_matrix\na[1].normalized()", "mathutils.Vector.normalized"),
    ],
)  # fmt: skip
def test_a_bound_variable_leads_to_its_members(kb: KnowledgeBase, code: str, path: str) -> None:
    assert path in [hit.id for hit in kb.query(code).hits[:3]]


@pytest.mark.parametrize(
    ("code", "meant"),
    [
        ("a = bpy.data.lights.new('l', 'SUN')\na.angel = 1", "bpy.types.SunLight.angle"),
        ("a = ob.modifiers.new('b', 'BEVEL')\na.widht = 1", "bpy.types.BevelModifier.width"),
    ],
)
def test_what_is_wrong_in_code_comes_before_what_is_right(kb: KnowledgeBase, code: str, meant: str) -> None:
    answer = kb.query(code)
    assert answer.hits[0].id == meant
    assert [note for note in answer.notes if "read as" in note]


@pytest.mark.parametrize(
    "code",
    [
        "m = ob.modifiers.new('R', 'REMESH')\nm.mode = 'VOXEL'\n"
        "m = ob.modifiers.new('W', 'WELD')\nm.mode = 'CONNECTED'",
        "n = t.nodes.new('GeometryNodeFillCurve')\nn.inputs['Mode'].default_value = 'N-gons'\n"
        "n = t.nodes.new('GeometryNodeMergeByDistance')\nn.inputs['Mode'].default_value = 'All'",
        "for m in ob.modifiers[:]:\n    if m.type == 'ARRAY':\n        ob.modifiers.remove(m)",
        "verts = bm.verts[:]\nverts[0].co.x = 1",
        "n = t.nodes.new('GeometryNodeMenuSwitch')\nn.data_type = 'FLOAT'\nn.inputs['A'].default_value = 0.3",
        "import _rna_xml as rna_xml\nrna_xml.xml_file_write(context, path, x)",
        "import bpy_extras.wm_utils",
    ],
)
def test_right_code_is_not_denied(kb: KnowledgeBase, code: str) -> None:
    assert kb.query(code).notes == ()


def test_each_value_is_judged_by_what_the_variable_is_there(kb: KnowledgeBase) -> None:
    code = (
        "m = ob.modifiers.new('R', 'REMESH')\nm.mode = 'CONNECTED'\n"
        "m = ob.modifiers.new('W', 'WELD')\nm.mode = 'CONNECTED'"
    )
    (note,) = kb.query(code).notes
    assert "bpy.types.RemeshModifier.mode" in note
