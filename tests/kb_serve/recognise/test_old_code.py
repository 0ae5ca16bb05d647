"""Code written for other versions: whatever its form, the removed name in it is told, with version and successor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

T = "bpy.types."
# What is written, what of it is gone, and the version that lost it.
CODE = [
    ("obj.draw_type = 'WIRE'", f"{T}Object.draw_type", "2.80"),
    ("my_ob2.draw_type", f"{T}Object.draw_type", "2.80"),
    ("x.dupli_faces_scale = 2", f"{T}Object.dupli_faces_scale", "2.80"),
    ("if o.select: pass", f"{T}Object.select", "2.80"),
    ("C.scene.cursor_location", f"{T}Scene.cursor_location", "2.80"),
    ("scn.update()", f"{T}Scene.update", "2.80"),
    ("bpy.context.scene.objects.link(ob)", f"{T}SceneObjects.link", "2.80"),
    ("bpy.data.groups['A'].objects", f"{T}BlendData.groups", "2.80"),
    ("bpy.data.scenes[0].render.layers", f"{T}RenderSettings.layers", "2.80"),
    ("node_group.inputs.new('NodeSocketFloat', 'x')", f"{T}NodeTree.inputs", "4.0"),
    ("ob.data.uv_textures.active", f"{T}Mesh.uv_textures", "2.80"),
    ("mat.use_shadeless", f"{T}Material.use_shadeless", "2.80"),
    ("cam.data.dof_object = ob", f"{T}Camera.dof_object", "2.80"),
    ("pb.bone_group", f"{T}PoseBone.bone_group", "4.0"),
    ("rbw.steps_per_second = 60", f"{T}RigidBodyWorld.steps_per_second", "2.91"),
    ("action.fcurves.new('location')", f"{T}Action.fcurves", "5.0"),
    ("scene.node_tree.nodes", f"{T}Scene.node_tree", "5.0"),
    ("mesh.use_auto_smooth = True", f"{T}Mesh.use_auto_smooth", "4.1"),
    ("bpy.context.scene.sequence_editor.sequences", f"{T}SequenceEditor.sequences", "5.0"),
    ("bgl.glEnable(bgl.GL_BLEND)", "bgl.glEnable", "5.0"),
    ("bpy.ops.wm.addon_enable(module='x')", "bpy.ops.wm.addon_enable", "2.80"),
    ("bpy.utils.register_module(__name__)", "bpy.utils.register_module", "2.80"),
    ("bpy.types.INFO_MT_file_import.append(f)", f"{T}INFO_MT_file_import", "2.80"),
    ("import bgl, blf", "bgl", "5.0"),
    ("from bgl import glEnable, glDisable", "bgl.glDisable", "5.0"),
    ("steps_per_second", f"{T}RigidBodyWorld.steps_per_second", "2.91"),
    # keyword arguments, by name and by place
    ("bpy.ops.mesh.primitive_cube_add(radius=2)", "bpy.ops.mesh.primitive_cube_add(radius)", "2.80"),
    ("bpy.ops.transform.rotate(value=1, axis=(0, 0, 1))", "bpy.ops.transform.rotate(axis)", "2.80"),
    ("ob.to_mesh(scene, True, 'PREVIEW')", f"{T}Object.to_mesh(scene)", "2.80"),
    # names in strings
    (
        "bsdf.inputs['Transmission'].default_value = 1",
        f'{T}ShaderNodeBsdfPrincipled.inputs["Transmission"]',
        "",
    ),
    ("nodes.new('ShaderNodeTexMusgrave')", f"{T}ShaderNodeTexMusgrave", "4.1"),
    ("layout.operator('wm.addon_enable')", "bpy.ops.wm.addon_enable", "2.80"),
    ("row.prop(ob, 'draw_type')", f"{T}Object.draw_type", "2.80"),
    ("ob.keyframe_insert(data_path='hide', frame=1)", f"{T}Object.hide", "2.80"),
    ("getattr(mat, 'use_shadeless', False)", f"{T}Material.use_shadeless", "2.80"),
    ("ob.type == 'LAMP'", f"{T}Object.type:LAMP", "2.80"),
    ("ob.type in {'MESH', 'LAMP'}", f"{T}Object.type:LAMP", "2.80"),
    ("bpy.ops.object.add(type='LAMP')", "bpy.ops.object.add(type):LAMP", "2.80"),
    # messages
    ("AttributeError: 'Object' object has no attribute 'select'", f"{T}Object.select", "2.80"),
    ("AttributeError: 'ShaderNodeTree' object has no attribute 'inputs'", f"{T}NodeTree.inputs", "4.0"),
    ("AttributeError: 'RNA_Types' object has no attribute 'Lamp'", f"{T}Lamp", "2.80"),
    ("AttributeError: module 'bpy.types' has no attribute 'Lamp'", f"{T}Lamp", "2.80"),
    ("ModuleNotFoundError: No module named 'bgl'", "bgl", "5.0"),
    (
        'TypeError: Converting py args to operator properties: keyword "view_align" unrecognized\n'
        "    bpy.ops.mesh.primitive_cone_add(view_align=True)",
        "bpy.ops.mesh.primitive_cone_add(view_align)",
        "2.80",
    ),
    (
        'Traceback (most recent call last):\n  File "a.py", line 3, in <module>\n    C.scene.objects.link(o)\n'
        "AttributeError: 'bpy_prop_collection' object has no attribute 'link'",
        f"{T}SceneObjects.link",
        "2.80",
    ),
]


@pytest.mark.parametrize(("written", "gone", "version"), CODE)
def test_a_name_of_another_version_is_told(kb: KnowledgeBase, written: str, gone: str, version: str) -> None:
    notes = [note for note in kb.query(written).notes if f"`{gone}` does not exist in Blender" in note]
    assert len(notes) == 1
    assert version in notes[0]


@pytest.mark.parametrize(
    "written",
    [
        "lamp.energy = 3", "light.energy", "cam.location", "arm.pose.bones", "bone.use_deform", "col.objects.link(ob)",
        "col.prop(ob, 'name')", "node.index", "f.write('x')", "m.type", "parent.hide", "self.draw_type",
        "draw_type = 3", "bsdf.inputs['Color']", "bpy.types.Scene.my_tool = bpy.props.BoolProperty()",
        "ob.name.startswith('x')",
        "ob.type == 'MESH'", "scene.render.engine = 'CYCLES'", "bpy.ops.mesh.primitive_cube_add(size=2)",
        "context.mode == 'EDIT_MESH'", "nodes.new('ShaderNodeEmission')", "MyPanel.draw_type",
        "ob.keyframe_insert('location')", "layout.operator('object.delete')", "open('notes.txt')",
    ],
)  # fmt: skip
def test_what_works_or_is_the_scripts_own_is_left_alone(kb: KnowledgeBase, written: str) -> None:
    assert [note for note in kb.query(written).notes if "does not exist" in note or "never" in note] == []


@pytest.mark.parametrize(
    "written",
    [
        "ob.frobnicate()",
        "bpy.context.object.wobbliness",
        "AttributeError: 'Object' object has no attribute 'velocity'",
    ],
)
def test_a_name_that_never_was_is_told_so(kb: KnowledgeBase, written: str) -> None:
    (note,) = kb.query(written).notes
    assert "never had it from 2.79" in note


@pytest.mark.parametrize(
    ("written", "first", "second"),
    [
        ("bpy.data.groups.new('x')", "BlendData.collections", "BlendDataCollections.new"),
        ("bpy.data.groups['x'].objects", "BlendData.collections", "Collection.objects"),
        (
            "node_group.inputs.new('NodeSocketFloat', 'x')",
            "NodeTree.interface",
            "NodeTreeInterface.new_socket",
        ),
    ],
)
def test_the_rest_of_an_expression_is_followed_from_the_successor(
    kb: KnowledgeBase, written: str, first: str, second: str
) -> None:
    assert [hit.id for hit in kb.query(written).hits[:2]] == [T + first, T + second]


def test_an_assignment_means_the_setter(kb: KnowledgeBase) -> None:
    assert kb.query("ob.select = True").hits[0].id == f"{T}Object.select_set"
    assert kb.query("print(ob.select)").hits[0].id == f"{T}Object.select_get"


@pytest.mark.parametrize(
    ("written", "instead"),
    [
        ("obj.modifiers.new('Smoke', 'SMOKE')", "bpy.types.ObjectModifiers.new(type):FLUID"),
        ("bpy.ops.object.modifier_add(type='FLUID_SIMULATION')", "bpy.ops.object.modifier_add(type):FLUID"),
        ("FLUID_SIMULATION", "bpy.types.Modifier.type:FLUID"),
    ],
)
def test_an_item_of_an_argument_has_the_successor_of_the_property_with_these_items(
    kb: KnowledgeBase, written: str, instead: str
) -> None:
    assert f"Use `{instead}`." in kb.query(written).notes[0]
