"""A variable's name tells which classes it may hold."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_serve.recognise.chains.variables import Variables, usual_classes, variable_fit

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader


@pytest.mark.parametrize(
    ("variable", "cls", "low", "high"),
    [
        ("object", "Object", 1, 1), ("obj", "Object", 0.8, 0.99), ("ob", "Object", 0.8, 0.99),
        ("mat", "Material", 0.8, 0.99),
        ("psys", "ParticleSystem", 0, 0.9), ("my_object", "Object", 0.7, 0.99), ("obj2", "Object", 0.8, 0.99),
        ("x", "Object", 0, 0), ("", "Object", 0, 0), ("cloth", "Object", 0, 0), ("m", "Material", 0.1, 0.5),
        ("t", "Object", 0, 0), ("mtrl", "Material", 0.5, 0.7),
    ],
)  # fmt: skip
def test_a_variable_fits_the_class_whose_name_it_bears(
    variable: str, cls: str, low: float, high: float
) -> None:
    assert low <= variable_fit(variable, cls) <= high


@pytest.mark.parametrize(
    ("variable", "classes"),
    [
        ("ob", ["Object"]), ("my_obj", ["Object"]), ("obj2", ["Object"]),
        ("OBJ", ["Object"]), ("cam", ["Camera", "Object"]), ("scn", ["Scene"]), ("pb", ["PoseBone"]),
        ("fcu", ["FCurve"]), ("ng", ["NodeTree"]), ("bsdf", ["ShaderNodeBsdfPrincipled"]), ("x", []), ("", []),
        ("result", []),
    ],
)  # fmt: skip
def test_the_names_that_scripts_use_are_known(variable: str, classes: list[str]) -> None:
    assert usual_classes(variable) == [f"bpy.types.{cls}" for cls in classes]


def test_every_usual_class_exists_here(reader: BaseReader) -> None:
    """A misspelt class in the table would be ignored without a word."""
    from kb_serve.recognise.chains import variables

    paths = {path for paths in variables._BY_NAME.values() for path in paths}
    assert [path for path in sorted(paths) if reader.entry(path) is None] == []


def test_classes_come_once_and_the_likeliest_first(reader: BaseReader) -> None:
    variables = Variables(reader)
    for name in ("cam", "object", "mat", "node_group", "scene", "strip"):
        rows = variables.classes(name)
        fits = [fit for _, fit in rows]
        assert fits == sorted(fits, reverse=True)
        assert len({path for path, _ in rows}) == len(rows)
    assert variables.classes("cam")[0][0] == "bpy.types.Camera"
    assert variables.classes("qwertz") == []


@pytest.mark.parametrize(
    ("query", "first"),
    [("v.co", "bpy.types.MeshVertex.co"), ("f.normal", "bpy.types.MeshPolygon.normal")],
)
def test_a_letter_is_read_as_scripts_use_it(kb: KnowledgeBase, query: str, first: str) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == first
    assert not answer.notes


@pytest.mark.parametrize("query", ["p.co", "m.foo_bar", "v.nothing_such", "cl.foo_bar"])
def test_a_guess_from_one_or_two_letters_denies_nothing(kb: KnowledgeBase, query: str) -> None:
    assert not [note for note in kb.query(query).notes if "has no" in note]


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("text.align_x", "bpy.types.TextCurve.align_x"), ("text.lines", "bpy.types.Text.lines"),
        ("text.font", "bpy.types.TextCurve.font"),
        ("layer.frames.new(1)", "bpy.types.GreasePencilFrames.new"),
        ("layer.use_pass_z", "bpy.types.ViewLayer.use_pass_z"),
        ("stroke.points", "_bpy_internal.grease_pencil.stroke.GreasePencilStroke.points"),
        ("frame.drawing", "bpy.types.GreasePencilFrame.drawing"),
    ],
)  # fmt: skip
def test_of_several_classes_the_one_of_today_that_has_the_member_is_meant(
    kb: KnowledgeBase, query: str, first: str
) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == first
    assert not [note for note in answer.notes if "does not exist" in note or "has no" in note]


@pytest.mark.parametrize(
    ("query", "first", "other"),
    [
        ("mod.thickness", "SolidifyModifier.thickness", "WireframeModifier.thickness"),
        ("mod.levels = 2", "SubsurfModifier.levels", "MultiresModifier.levels"),
        ("node.operation", "ShaderNodeMath.operation", "ShaderNodeVectorMath.operation"),
    ],
)
def test_of_many_cases_the_most_used_opens_and_others_are_named(
    kb: KnowledgeBase, query: str, first: str, other: str
) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == f"bpy.types.{first}"
    (note,) = [note for note in answer.notes if note.startswith("The variable may also stand for")]
    assert f"`{other}`" in note


@pytest.mark.parametrize("query", ["ob.location", "scene.camera", "GreasePencilLayer.hide"])
def test_what_is_sure_names_no_others(kb: KnowledgeBase, query: str) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id.startswith("bpy.types.")
    assert not [note for note in answer.notes if "may also stand" in note]


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("plane.rotation_euler", "Object.rotation_euler"), ("thing.modifiers.new('x', 'BEVEL')", "ObjectModifiers.new"),
        ("anything.keyframe_points", "FCurve.keyframe_points"), ("left.select_set(True)", "Object.select_set"),
        ("child.matrix_parent_inverse", "Object.matrix_parent_inverse"), ("par.matrix_world", "Object.matrix_world"),
        ("bone_dest.bbone_segments", "Bone.bbone_segments"), ("kmi_toolbar.type", "KeyMapItem.type"),
    ],
)  # fmt: skip
def test_a_member_tells_what_a_variable_is_whose_name_does_not(
    kb: KnowledgeBase, query: str, first: str
) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id == f"bpy.types.{first}"
    assert not [note for note in answer.notes if "has no" in note]


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("self.obj.location", "Object.location"), ("self.rig.pose.bones", "Pose.bones"),
        ("self.report({'INFO'}, 'done')", "Operator.report"), ("self.layout.prop(ob, 'name')", "UILayout.prop"),
    ],
)  # fmt: skip
def test_an_attribute_of_a_scripts_own_class_is_like_a_variable(
    kb: KnowledgeBase, query: str, first: str
) -> None:
    assert kb.query(query).hits[0].id == f"bpy.types.{first}"


def test_what_else_such_a_variable_may_be_is_named(kb: KnowledgeBase) -> None:
    assert [note for note in kb.query("plane.scale").notes if "`PoseBone.scale`" in note]


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("l[uv_layer].uv", "bmesh.types.BMLoopUV.uv"), ("loop[layer].pin_uv", "bmesh.types.BMLoopUV.pin_uv"),
        ("v[deform_layer].keys()", "bmesh.types.BMDeformVert.keys"),
    ],
)  # fmt: skip
def test_an_element_of_a_bmesh_is_indexed_by_its_layers(kb: KnowledgeBase, query: str, first: str) -> None:
    assert kb.query(query).hits[0].id == first


@pytest.mark.parametrize("query", ["random.seed(3)", "math.floor(9.5)", "os.path.join(a, b)", "time.time()"])
def test_pythons_own_modules_are_no_variables(kb: KnowledgeBase, query: str) -> None:
    answer = kb.query(query)
    assert not answer.notes
    assert answer.kind == "candidates"


def test_a_variable_called_as_a_module_of_python_is_known(kb: KnowledgeBase) -> None:
    assert kb.query("math.operation = 'ADD'").hits[0].id.endswith("NodeMath.operation")


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("img.interpolation = 'Closest'", "ShaderNodeTexImage.interpolation"),
        ("bag = strip.channelbag(slot)", "ActionKeyframeStrip.channelbag"),
        ("coll.assign(bone)", "BoneCollection.assign"), ("s.type = 'IK'", "Constraint.type"),
    ],
)  # fmt: skip
def test_a_name_denies_nothing_that_another_class_has(kb: KnowledgeBase, query: str, first: str) -> None:
    answer = kb.query(query)
    assert first in [hit.id.removeprefix("bpy.types.") for hit in answer.hits[:2]]
    assert not [note for note in answer.notes if "has no" in note and not note.startswith("If ")]


def test_what_a_class_calls_otherwise_is_believed_of_a_variable_named_after_it(kb: KnowledgeBase) -> None:
    assert kb.query("light.power = 100").hits[0].id == "bpy.types.PointLight.energy"


@pytest.mark.parametrize("query", ["scene.bl_rna.properties", "bpy.context.object.rna_type.identifier"])
def test_every_instance_tells_of_its_class(kb: KnowledgeBase, query: str) -> None:
    answer = kb.query(query)
    assert answer.hits[0].id.startswith("bpy.types.Struct.")
    assert not answer.notes
