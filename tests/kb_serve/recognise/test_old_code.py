"""Code written for other versions: whatever its form, the removed name in it is told, with version and successor."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import bpy
import pytest

from kb_build.symbols.paths import as_code
from kb_build.versions.successors import load_successors
from kb_serve.recognise.named.newer_nodes import INSTEAD

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
    ("import rna_info", "rna_info", "5.0"),
    ("import bpy, rna_xml", "rna_xml", "5.0"),
    ("from bl_ui_utils.layout import operator_context", "bl_ui_utils", "5.0"),
    ("from bge import logic", "bge", "2.80"),
    ("from rna_prop_ui import rna_idprop_ui_prop_get", "rna_prop_ui.rna_idprop_ui_prop_get", "3.0"),
    ("rna_idprop_ui_prop_get(bone, 'x')", "rna_prop_ui.rna_idprop_ui_prop_get", "3.0"),
    ("face_random_points(9, faces)", "bpy_extras.mesh_utils.face_random_points", "2.80"),
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
    ("ModuleNotFoundError: No module named 'bge'", "bge", "2.80"),
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
    notes = [
        note for note in kb.query(written).notes if f"`{as_code(gone)}` does not exist in Blender" in note
    ]
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
    assert f"Use `{as_code(instead)}`." in kb.query(written).notes[0]


@pytest.mark.parametrize(
    ("written", "socket"),
    [
        ('noise.outputs["Fac"]', 'ShaderNodeTexNoise.outputs["Factor"]'),
        ('noise_tex.outputs["Fac"]', 'ShaderNodeTexNoise.outputs["Factor"]'),
        ('mix_shader.inputs["Fac"].default_value = 0.3', 'ShaderNodeMixShader.inputs["Factor"]'),
    ],
)
def test_a_former_name_works_on_the_node_that_a_variable_is_named_after(
    kb: KnowledgeBase, written: str, socket: str
) -> None:
    answer = kb.query(written)
    assert answer.hits[0].id == T + socket
    assert answer.notes == (f"The former name still works here; the name is now `{T}{socket}`.",)


@pytest.mark.parametrize(
    ("written", "first"),
    [
        ('noise.outputs["Color"]', f'{T}ShaderNodeTexNoise.outputs["Color"]'),
        ('noise.inputs["Scale"]', f'{T}ShaderNodeTexNoise.inputs["Scale"]'),
        ("noise.random_vector()", "mathutils.noise.random_vector"),
    ],
)
def test_a_variable_that_is_called_like_a_module_is_it_only_where_that_has_the_member(
    kb: KnowledgeBase, written: str, first: str
) -> None:
    answer = kb.query(written)
    assert answer.hits[0].id == first
    assert answer.notes == ()


@pytest.mark.parametrize("written", ["mathutils.noise.outputs", "mathutils.noise.wobbliness()"])
def test_a_module_that_is_spelled_out_is_one(kb: KnowledgeBase, written: str) -> None:
    assert any("`mathutils.noise` has no" in note for note in kb.query(written).notes)


@pytest.mark.parametrize("written", ['color_mix.inputs["Color2"]', 'mix.inputs["Color2"].default_value = c'])
def test_a_socket_of_a_node_that_is_made_no_more_is_told_as_that_of_the_newer_one(
    kb: KnowledgeBase, written: str
) -> None:
    notes = kb.query(written).notes
    assert any('it is `inputs["B"]`, or `inputs[7]` at any time' in note for note in notes)
    assert not any("custom properties" in note for note in notes)


def test_the_newer_node_has_the_sockets_that_are_told(kb: KnowledgeBase) -> None:
    mix = bpy.data.node_groups.new("g", "ShaderNodeTree").nodes.new("ShaderNodeMix")
    for name, path in INSTEAD.items():
        said = "\n".join(kb.query(f'color_mix.inputs["{name}"]').notes)
        found = re.search(r"with `(.+?)` it is `(.+?)`, or `(.+?)` at any time", said)
        assert found
        setting, new, place = found.groups()
        assert name not in mix.inputs
        exec(f"mix.{setting}", {"mix": mix})
        by_name, by_place = (eval(f"mix.{one}", {"mix": mix}) for one in (new, place))
        assert by_name == by_place
        assert path == f'{T}{mix.bl_idname}.inputs["{by_place.identifier}"]'


@pytest.mark.parametrize(
    ("written", "instead"),
    [("gpu.shader.from_builtin('3D_UNIFORM_COLOR')", "UNIFORM_COLOR"), ("from_builtin('2D_IMAGE')", "IMAGE")],
)
def test_shaders_have_no_dimension_in_their_names(kb: KnowledgeBase, written: str, instead: str) -> None:
    assert any(
        f"Use `gpu.shader.from_builtin(shader_name={instead!r})`" in note for note in kb.query(written).notes
    )


@pytest.mark.parametrize(
    ("written", "instead"),
    [
        ("layout.label(icon='SEQUENCE_COLOR_01')", "(icon='STRIP_COLOR_01')`"),
        ("layout.operator('a.b', icon='OUTLINER_DATA_LAMP')", "(icon='OUTLINER_DATA_LIGHT')`"),
        ("layout.prop(ob, 'name', icon='LIGHTPROBE_CUBEMAP')", "(icon='LIGHTPROBE_SPHERE')`"),
        ("layout.label(icon='ZOOMIN')", "(icon='ADD')`"),
        ("bpy.types.Node.bl_icon = 'SEQUENCE_COLOR_05'", "bl_icon = 'STRIP_COLOR_05'`"),
        ("layout.label(icon='MATCAP_01')", "Nothing takes its place. Matcaps are no icons"),
    ],
)
def test_icons_have_successors_wherever_they_are_given(kb: KnowledgeBase, written: str, instead: str) -> None:
    assert any(instead in note for note in kb.query(written).notes)


def test_what_several_properties_tell_of_an_item_is_said_once(kb: KnowledgeBase) -> None:
    notes = kb.query("keymap_items.new('a.b', type='ACTIONMOUSE', value='PRESS')").notes
    assert sum(note.count("(type='LEFTMOUSE')") for note in notes) == 1


def test_passes_have_the_names_that_are_told(kb: KnowledgeBase) -> None:
    bpy.ops.wm.read_factory_settings()
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    tree = bpy.data.node_groups.new("c", "CompositorNodeTree")
    scene.compositing_node_group = tree
    node = tree.nodes.new("CompositorNodeRLayers")
    old = [row.old for row in load_successors() if row.old.startswith(f"{T}CompositorNodeRLayers.outputs[")]
    assert len(old) > 12
    for path in old:
        note = next(
            note for note in kb.query(f"{path.removeprefix(T)}").notes if "The output is called" in note
        )
        found = re.search(r'Use `bpy.types.(\w+)\.(\w+)`.*\. The output is called "([^"]+)"', note)
        assert found
        cycles = found[1] == "CyclesRenderLayerSettings"
        holder = bpy.context.view_layer.cycles if cycles else bpy.context.view_layer
        setattr(holder, found[2], False)
        assert not is_on(node, found[3])
        setattr(holder, found[2], True)
        assert is_on(node, found[3])


def is_on(node: bpy.types.Node, name: str) -> bool:
    """Whether a node of render layers has an output that can be used."""
    socket = node.outputs.get(name)
    return socket is not None and socket.enabled and not socket.is_unavailable


@pytest.mark.parametrize(
    ("written", "use"),
    [
        ("import imp", "Write it with `importlib.reload`"),
        ("imp.reload(module)", "Write it with `importlib.reload`"),
        ("ModuleNotFoundError: No module named 'imp'", "Write it with `importlib.reload`"),
        ("from cgi import escape", "Write it with `urllib.parse`"),
        ("import rna_info", "Write `_rna_info`"),
    ],
)
def test_where_something_is_to_be_used_instead_nothing_is_not_said(
    kb: KnowledgeBase, written: str, use: str
) -> None:
    note = next(note for note in kb.query(written).notes if "does not exist" in note)
    assert use in note
    assert "Nothing takes its place" not in note


@pytest.mark.parametrize("word", ["pipes", "chunk"])
def test_plain_words_that_modules_were_called_by_mean_no_modules(kb: KnowledgeBase, word: str) -> None:
    assert not any("Python" in note for note in kb.query(word).notes)


@pytest.mark.parametrize(
    "code", ["mask = nodes.new('CompositorNodeEllipseMask')\nmask.width = 0.8", "ellipse_mask.width = 0.8"]
)
def test_what_all_nodes_have_by_a_name_is_not_what_one_had(kb: KnowledgeBase, code: str) -> None:
    answer = kb.query(code)
    size = f'{T}CompositorNodeEllipseMask.inputs["Size"]'
    assert [hit.id for hit in answer.hits[:2]] == [size, f"{T}Node.width"]
    (note,) = answer.notes
    assert note.startswith(f"`{T}Node.width` is another thing than")
    assert note.endswith(f"that is `{size}` now.")


def test_the_name_of_a_variable_tells_what_data_its_object_has(kb: KnowledgeBase) -> None:
    answer = kb.query("rig = bpy.context.object\nrig.data.layers[0] = True")
    assert answer.hits[0].id == "bpy.types.Armature.collections"
    assert any("removed in 4.0" in note for note in answer.notes)


def test_a_keying_set_is_no_class_that_is_gone(kb: KnowledgeBase) -> None:
    assert not kb.query("bpy.ops.anim.keyframe_insert_menu(type='LocRotScale')").notes
