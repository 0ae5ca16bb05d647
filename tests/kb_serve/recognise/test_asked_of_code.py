"""Of code and the words around it, what is asked comes first: not what leads there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

T = "bpy.types."
P = f"{T}ShaderNodeBsdfPrincipled.inputs"


@pytest.mark.parametrize(
    ("query", "first"),
    [
        # A member that is named beside its module.
        (
            "from bpy_extras.mesh_utils import mesh_linked_triangles",
            "bpy_extras.mesh_utils.mesh_linked_triangles",
        ),
        ("what does recalc_face_normals of bmesh.ops take", "bmesh.ops.recalc_face_normals"),
        ("the save_post list of bpy.app.handlers", "bpy.app.handlers.save_post"),
        ("from bpy.app import handlers", "bpy.app.handlers"),
        ("from mathutils.kdtree import KDTree", "mathutils.kdtree.KDTree"),
        ("from mathutils import Euler, Matrix", "mathutils.Euler"),
        ("import aud", "aud"),
        ("import bpy\nob = bpy.context.object\nob.show_name = True", f"{T}Object.show_name"),
        ("from mathutils import Vector\nob.location = Vector((1, 2, 3))", f"{T}Object.location"),
        ("quality of ClothSettings", f"{T}ClothSettings.quality"),
        ("rotation mode of PoseBone", f"{T}PoseBone.rotation_mode"),
        # Other packages are none of Blender's classes.
        ("a = np.empty(9); mesh.vertices.foreach_get('co', a)", f"{T}bpy_prop_collection.foreach_get"),
        # What is compared or set tells which object data are meant.
        ("if ob.data.type == 'SPOT': print()", f"{T}Light.type"),
        ("ob.data.type = 'ORTHO'", f"{T}Camera.type"),
        # What a variable was bound to leads on to what is done with it.
        ("spl = curve.splines[0]; spl.use_cyclic_u = True", f"{T}Spline.use_cyclic_u"),
        ("for kp in fcurve.keyframe_points: kp.handle_left_type", f"{T}Keyframe.handle_left_type"),
        # What is got by its name is what the name tells.
        ('nodes.get("Mix Shader").inputs', f"{T}Node.inputs"),
        (
            'n = tree.nodes.get("Noise Texture"); n.inputs["Detail"].default_value = 3',
            f'{T}ShaderNodeTexNoise.inputs["Detail"]',
        ),
        ('obj.modifiers.get("Wave").height', f"{T}WaveModifier.height"),
        ('tree.nodes["Principled BSDF"].inputs[0].default_value = c', f'{P}["Base Color"]'),
        ('w.node_tree.nodes["Background"].inputs[1]', f'{T}ShaderNodeBackground.inputs["Strength"]'),
        # What the words ask of an expression.
        ("insert a keyframe on cam.data.lens", f"{T}bpy_struct.keyframe_insert"),
        ("rotation_euler of bpy.context.object", f"{T}Object.rotation_euler"),
        ("copy of obj.active_material", f"{T}ID.copy"),
        ("name of bpy.context.scene.camera", f"{T}ID.name"),
        # An operator without ``bpy.ops``, whatever else has a function of that name.
        ("wm.link of one collection", "bpy.ops.wm.link"),
        ("text.save()", "bpy.ops.text.save"),
    ],
)
def test_what_is_asked_comes_first(kb: KnowledgeBase, query: str, first: str) -> None:
    assert kb.query(query).hits[0].id == first


@pytest.mark.parametrize(
    ("query", "removed", "first"),
    [
        ("SceneEEVEE use_ssr is missing", "SceneEEVEE.use_ssr", f"{T}SceneEEVEE.use_raytracing"),
        ("groups of bpy.context.active_action", "Action.groups", f"{T}ActionChannelbag.groups"),
        ('modifiers.new("s", "SMOKE")', "ObjectModifiers.new(type='SMOKE')", f"{T}ObjectModifiers.new"),
        ("fcurves of Action", "Action.fcurves", f"{T}ActionChannelbag.fcurves"),
        # The last part of a variable's name tells what it is.
        ("title_strip.align_y = 'TOP'", "TextSequence.align_y", f"{T}TextStrip.anchor_y"),
    ],
)
def test_removed_names_are_told_beside_what_had_them(
    kb: KnowledgeBase, query: str, removed: str, first: str
) -> None:
    answer = kb.query(query)
    assert f"`bpy.types.{removed}` does not exist in Blender 5.1" in answer.text
    assert answer.hits[0].id == first


@pytest.mark.parametrize(
    ("message", "first", "note"),
    [
        (
            "    if ob.animation_data.action is None:\nAttributeError: 'NoneType' object has no attribute 'action'",
            f"{T}Object.animation_data",
            "is None before",
        ),
        (
            "ob.rigid_body.friction: NoneType has no attribute friction",
            f"{T}Object.rigid_body",
            "is None before",
        ),
        (
            "    w = scene.rigidbody_world\n    w.enabled = True\n"
            "AttributeError: 'NoneType' object has no attribute 'enabled'",
            f"{T}Scene.rigidbody_world",
            "is None before",
        ),
        (
            "    e = bm.edges[i]\nIndexError: BMElemSeq[index]: outdated internal index table, run "
            "ensure_lookup_table() first",
            "bmesh.types.BMEdgeSeq.ensure_lookup_table",
            "`bm.edges.ensure_lookup_table()`, then `bm.edges[index]`",
        ),
        (
            "BMElemSeq[index]: outdated internal index table, run ensure_lookup_table() first",
            "bmesh.types.BMVertSeq.ensure_lookup_table",
            "`bm.verts.ensure_lookup_table()`",
        ),
        (
            "why does bpy.ops.object.duplicate(override, linked=True) fail",
            f"{T}Context.temp_override",
            "temp_override",
        ),
        (
            "ValueError: 1-2 args execution context is supported\nbpy.ops.mesh.dissolve_edges(ctx)",
            f"{T}Context.temp_override",
            "temp_override",
        ),
    ],
)
def test_what_a_message_is_about_comes_before_what_it_stopped_at(
    kb: KnowledgeBase, message: str, first: str, note: str
) -> None:
    answer = kb.query(message)
    assert answer.hits[0].id == first
    assert any(note in one for one in answer.notes)


@pytest.mark.parametrize(
    ("query", "cls"),
    [
        ("limit distance between two objects", "LimitDistanceConstraint"),
        ("let the eyes damped track a target", "DampedTrackConstraint"),
        ("wave speed of that modifier", "WaveModifier"),
        ("track to constraint for a camera", "TrackToConstraint"),
    ],
)
def test_the_label_of_a_constraint_or_modifier_is_found_in_a_question(
    kb: KnowledgeBase, query: str, cls: str
) -> None:
    assert f"{T}{cls}" in [hit.id.removesuffix(".speed") for hit in kb.query(query).hits[:5]]


@pytest.mark.parametrize(
    ("code", "cls", "name"),
    [
        ('m = obj.modifiers["Bevel"]; m.thickness = 0.2', "BevelModifier", "thickness"),
        ('c = obj.constraints["Track To"]; c.use_x = True', "TrackToConstraint", "use_x"),
        ('n = tree.nodes.get("Noise Texture"); n.strength = 2', "ShaderNodeTexNoise", "strength"),
    ],
)
def test_what_an_element_lacks_is_told_though_others_have_it(
    kb: KnowledgeBase, code: str, cls: str, name: str
) -> None:
    answer = kb.query(code)
    assert f"`bpy.types.{cls}` has no `{name}`" in answer.text
    assert f"{T}{cls}" in [hit.id for hit in answer.hits[:4]]


@pytest.mark.parametrize(
    "code",
    [
        'g = tree.nodes.new("GeometryNodeGroup"); g.inputs["Anything"].default_value = 2',
        'g = mat.node_tree.nodes["Group"]; g.outputs["Anything"]',
        'tree.nodes["Group Input"].outputs["Anything"]',
        'links.new(noise.outputs["Color"], bsdf.inputs["Base Color"])',
    ],
)
def test_sockets_that_may_be_there_are_not_denied(kb: KnowledgeBase, code: str) -> None:
    answer = kb.query(code)
    assert not any("has no" in note or "does not exist" in note for note in answer.notes)


@pytest.mark.parametrize(
    ("code", "told"),
    [
        (
            'n = nodes.new("ShaderNodeTexNoise"); links.new(n.outputs["Colour"], bsdf.inputs[0])',
            '`outputs["Colour"]` does not exist; read as `outputs["Color"]`',
        ),
        (
            'e = nodes.new("ShaderNodeEmission"); tree.links.new(e.outputs["BSDF"], o.inputs["Surface"])',
            '`bpy.types.ShaderNodeEmission` has no `outputs["BSDF"]`',
        ),
    ],
)
def test_sockets_in_a_call_are_looked_at(kb: KnowledgeBase, code: str, told: str) -> None:
    assert any(told in note for note in kb.query(code).notes)


def test_what_a_new_value_makes_follows_it(kb: KnowledgeBase) -> None:
    hits = kb.query('obj.modifiers.new("s", "SMOKE")').hits
    assert [hit.id for hit in hits[:2]] == [f"{T}ObjectModifiers.new", f"{T}FluidModifier"]


def test_a_value_in_capitals_is_no_name_in_other_letters(kb: KnowledgeBase) -> None:
    hits = kb.query("HIDE_HEADER DEFAULT_CLOSED of a panel").hits
    assert hits[0].id == f"{T}Panel.bl_options"
    assert f"{T}NodeTreeInterfacePanel.default_closed" not in [hit.id for hit in hits[:3]]


def test_words_beside_code_are_searched_for_by_themselves(kb: KnowledgeBase) -> None:
    answer = kb.query('write an fbx file, with obj.data.shape_keys.key_blocks["A"].value in it')
    assert "bpy.ops.export_scene.fbx" in [hit.id for hit in answer.hits]
