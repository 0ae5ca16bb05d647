"""Paths to animate and to drive are reported that Blender refuses, and no others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_CODE = """\
import bpy
ob = bpy.data.objects["Cube"]
scene = bpy.context.scene
material = bpy.data.materials.new("material")
light = bpy.data.objects["Light"]
camera = bpy.data.cameras.new("camera")
world = bpy.data.worlds.new("world")
mesh = bpy.data.meshes.new("mesh")
array = ob.modifiers.new("Array", "ARRAY")
ob["prop"] = 1.0
track = ob.constraints.new("TRACK_TO")
rig = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
bpy.context.collection.objects.link(rig)
bpy.context.view_layer.objects.active = rig
bpy.ops.object.mode_set(mode="EDIT")
rig.data.edit_bones.new("Bone").tail = (0, 0, 1)
bpy.ops.object.mode_set(mode="OBJECT")
bone = rig.pose.bones["Bone"]
image = bpy.data.images.new("image", 4, 4)
brush = bpy.data.brushes.new("brush")
ob.keyframe_insert("location")
ob.keyframe_insert(data_path="location", index=2)
ob.keyframe_insert(data_path="location", index=3)
ob.keyframe_insert("location", index=-1)
ob.keyframe_insert("location", index=-2)
ob.keyframe_insert("location", index=1.0)
ob.keyframe_insert("rotation_quaternion", index=3)
ob.keyframe_insert("rotation_euler", index=3)
ob.keyframe_insert("hide_viewport", index=0)
ob.keyframe_insert("hide_viewport", index=-1)
ob.keyframe_insert("scale.x")
ob.keyframe_insert("scale[0]")
ob.keyframe_insert("scale[7]")
ob.keyframe_insert("scale.q")
ob.keyframe_insert("scale[0]", index=0)
ob.keyframe_insert("color.r")
ob.keyframe_insert("color.a")
ob.keyframe_insert("color", index=3)
ob.keyframe_insert("rotation_quaternion.w")
ob.keyframe_insert("rotation_axis_angle.w")
ob.keyframe_insert("lock_location.x")
ob.keyframe_insert("hide_viewport.x")
ob.keyframe_insert(("location", "scale"))
ob.keyframe_insert(["location"])
ob.keyframe_insert("name")
ob.keyframe_insert("parent")
ob.keyframe_insert("data")
ob.keyframe_insert("modifiers")
ob.keyframe_insert("matrix_world")
ob.keyframe_insert("dimensions")
ob.keyframe_insert("rotation_mode")
ob.keyframe_insert("hide_select")
ob.keyframe_insert("type")
ob.keyframe_insert("keyframe_insert")
ob.keyframe_insert("users_collection")
ob.keyframe_insert("children")
ob.keyframe_insert("bound_box")
ob.keyframe_insert("pass_index")
ob.keyframe_insert('["prop"]')
ob.keyframe_insert("['prop']")
ob.keyframe_insert('modifiers["Array"].count')
ob.keyframe_insert("modifiers['Array'].count")
ob.keyframe_insert('modifiers["Array"].number')
ob.keyframe_insert('modifiers[0].count')
ob.keyframe_insert('modifiers["Array"].relative_offset_displace', index=2)
ob.keyframe_insert('modifiers["Array"].relative_offset_displace', index=3)
ob.keyframe_insert('modifiers["Array"].relative_offset_displace.x')
ob.keyframe_insert('modifiers["Array"].relative_offset_displace[0]')
ob.keyframe_insert('modifiers["Array"].name')
ob.keyframe_insert('modifiers["Array"].show_viewport')
ob.keyframe_insert('modifiers["Array"].count', index=0)
ob.keyframe_insert("modifiers.active.count")
ob.keyframe_insert('constraints["Track To"].influence')
ob.keyframe_insert('constraints["Track To"].target')
ob.keyframe_insert('constraints["Track To"].subtarget')
ob.keyframe_insert('constraints["Track To"].mute')
array.keyframe_insert("count")
array.keyframe_insert("name")
array.keyframe_insert("relative_offset_displace.x")
array.keyframe_insert("relative_offset_displace", index=1)
track.keyframe_insert("influence")
track.keyframe_insert("influence", index=0)
light.data.keyframe_insert("energy")
light.keyframe_insert("data.energy")
light.driver_add("data.energy")
light.keyframe_delete("data.energy")
camera.keyframe_insert("lens")
camera.keyframe_insert("dof.focus_distance")
camera.keyframe_insert("dof.focus_object")
camera.keyframe_insert("dof.focus_object.location")
scene.keyframe_insert("camera.location")
scene.keyframe_insert("world.color")
scene.driver_add("world.color")
scene.keyframe_insert("frame_current")
scene.keyframe_insert("eevee.taa_samples")
scene.keyframe_insert("render.resolution_x")
scene.keyframe_insert("render.engine")
scene.keyframe_insert("render.filepath")
scene.keyframe_insert("collection.hide_render")
scene.keyframe_insert("gravity")
scene.keyframe_insert("gravity.x")
scene.driver_add("gravity", 2)
scene.driver_add("gravity", 3)
scene.keyframe_insert("view_settings.exposure")
scene.keyframe_insert("view_settings.look")
scene.keyframe_insert("collection.name")
scene.keyframe_insert('view_layers[0].use')
scene.keyframe_insert('view_layers["ViewLayer"].use')
scene.keyframe_insert("camera")
scene.keyframe_insert("use_gravity")
material.keyframe_insert("diffuse_color")
material.keyframe_insert("diffuse_color", index=3)
material.keyframe_insert("diffuse_color", index=4)
material.keyframe_insert("diffuse_color.g")
material.keyframe_insert("metallic")
material.keyframe_insert('node_tree.nodes["Principled BSDF"].inputs[0].default_value')
material.keyframe_insert('node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value')
material.node_tree.keyframe_insert('nodes["Principled BSDF"].inputs[0].default_value')
material.node_tree.keyframe_insert('nodes["Principled BSDF"].inputs[0].default_value', index=3)
material.node_tree.keyframe_insert('nodes["Principled BSDF"].inputs["Roughness"].default_value')
material.node_tree.keyframe_insert("nodes['Principled BSDF'].inputs[0].default_value")
material.node_tree.keyframe_insert('nodes["Principled BSDF"].location')
material.node_tree.nodes["Principled BSDF"].inputs["Roughness"].keyframe_insert("default_value")
material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].keyframe_insert("default_value", index=3)
material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].keyframe_insert("default_value", index=4)
material.node_tree.nodes["Principled BSDF"].inputs["Roughness"].keyframe_insert("default_value", index=0)
world.keyframe_insert("color")
world.keyframe_insert("node_tree.name")
rig.keyframe_insert('pose.bones["Bone"].location')
rig.keyframe_insert('pose.bones["Bone"].location', index=2)
rig.keyframe_insert('pose.bones["Bone"].location.x')
rig.keyframe_insert('pose.bones["Bone"].rotation_quaternion', index=4)
rig.keyframe_insert('pose.bones["Bone"].matrix')
rig.keyframe_insert("pose.bones['Bone'].location")
rig.keyframe_insert('data.bones["Bone"].hide')
bone.keyframe_insert("location")
bone.keyframe_insert("location.x")
bone.keyframe_insert("rotation_quaternion", index=4)
bone.keyframe_insert("matrix")
bone.keyframe_insert("head")
rig.data.keyframe_insert('bones["Bone"].bbone_curveinx')
rig.data.keyframe_insert('bones["Bone"].head')
mesh.keyframe_insert("shape_keys.eval_time")
mesh.keyframe_insert("texspace_location")
mesh.keyframe_insert("texspace_location.x")
ob.shape_key_add(name="Basis")
ob.shape_key_add(name="Key")
ob.data.shape_keys.keyframe_insert('key_blocks["Key"].value')
ob.data.shape_keys.key_blocks["Key"].keyframe_insert("value")
ob.data.shape_keys.key_blocks["Key"].keyframe_insert("name")
ob.data.keyframe_insert('shape_keys.key_blocks["Key"].value')
ob.keyframe_insert('data.shape_keys.key_blocks["Key"].value')
ob.driver_add("location", 3)
ob.driver_add("location", 2)
ob.driver_add("location", -1)
ob.driver_add("location", -2)
ob.driver_add("hide_render", 0)
ob.driver_add("hide_render")
ob.driver_add("name")
ob.driver_add("scale.y")
ob.driver_add("scale[1]")
ob.driver_add("matrix_world")
ob.driver_add('modifiers["Array"].count')
ob.driver_add('modifiers["Array"].number')
ob.driver_remove("name")
ob.driver_remove("lock_location.x")
ob.keyframe_delete("location", index=5)
ob.keyframe_delete("location", index=2)
ob.keyframe_delete("name")
ob.keyframe_delete("hide_viewport", index=0)
ob.keyframe_delete("scale.x")
ob.keyframe_insert("animation_data.action")
ob.keyframe_insert("active_material.diffuse_color")
ob.keyframe_insert('material_slots[0].material.diffuse_color')
ob.keyframe_insert("game.x")
ob.keyframe_insert("visible_camera")
ob.keyframe_insert("delta_location", index=0, frame=1)
ob.keyframe_insert("lock_rotations_4d")
image.keyframe_insert("alpha_mode")
image.keyframe_insert("pixels", index=0)
image.driver_add("alpha_mode")
brush.keyframe_insert("strength")
bpy.data.texts.new("text").keyframe_insert("indentation")
bpy.context.preferences.view.keyframe_insert("ui_scale")
scene.keyframe_insert("display.shading.light")
scene.keyframe_insert("cycles.samples")
ob.keyframe_insert("show_axis")
ob.keyframe_insert("animation_data.drivers[0].mute")
ob.animation_data.drivers[0].keyframe_insert("mute")
ob.animation_data.action.layers[0].strips[0].channelbags[0].fcurves[0].keyframe_insert("extrapolation")
"""


def test_what_is_refused_is_reported_and_nothing_else(check: Check, tmp_path: Path) -> None:
    lines: list[str] = [*_CODE.splitlines()]
    answers = run_statements(tmp_path, lines)
    refused = {place for place, (error, _, _) in enumerate(answers, start=1) if error}
    assert {finding.span.line for finding in check("refused-path", _CODE)} == refused


def test_what_is_animated_in_the_place_of_what_is_computed_is_told(check: Check, tmp_path: Path) -> None:
    start = "import bpy\ncamera = bpy.data.cameras.new('c')\n"
    codes = [
        f"{start}camera.keyframe_insert('angle')",
        f"{start}camera.keyframe_insert('angle_x')",
        f"{start}camera.keyframe_insert('lens')",
    ]
    errors = [bool(error) for error, *_ in run_statements(tmp_path, codes)]
    assert errors == [True, True, False]
    for code in codes[:2]:
        (found,) = check("refused-path", code)
        assert "Animate `lens`" in found.message
    assert check("refused-path", codes[2]) == []


def test_a_data_block_without_animation_data_is_told(check: Check) -> None:
    code = "import bpy\nbpy.data.images.new('i', 4, 4).keyframe_insert('alpha_mode')\n"
    (found,) = check("refused-path", code)
    assert found.message.endswith("cannot be animated. A `bpy.types.Image` has no animation data.")
    (other,) = check("refused-path", "import bpy\nbpy.data.objects['Cube'].keyframe_insert('name')\n")
    assert other.message == "`bpy.types.ID.name` cannot be animated."


@pytest.mark.parametrize(
    ("code", "fixed"),
    [
        ('ob.keyframe_insert("location.z")', 'ob.keyframe_insert("location", index=2)'),
        (
            "ob.keyframe_insert(data_path='scale[1]', frame=3)",
            "ob.keyframe_insert(data_path='scale', index=1, frame=3)",
        ),
        ('ob.driver_add("rotation_quaternion.w")', 'ob.driver_add("rotation_quaternion", 0)'),
        ('ob.driver_add("color.a")', 'ob.driver_add("color", 3)'),
        ('ob.keyframe_insert("data.name")', 'ob.data.keyframe_insert("name")'),
        ("ob.keyframe_insert(\"modifiers['A'].count\")", "ob.keyframe_insert('modifiers[\"A\"].count')"),
        ('(ob or None).keyframe_insert("data.energy")', '(ob or None).keyframe_insert("data.energy")'),
    ],
)
def test_fixes_write_what_is_meant(check: Check, code: str, fixed: str) -> None:
    start = 'import bpy\nob = bpy.data.objects["Cube"]\n'
    found = check("refused-path", start + code)
    assert len(found) == 1
    assert apply_fixes(Source(start + code), found).text == start + fixed


@pytest.mark.parametrize(
    "code",
    [
        "ob.keyframe_insert(path)",
        'ob.keyframe_insert(*("location.x",))',
        'ob.keyframe_insert(f"location.{axis}")',
        'try:\n    ob.keyframe_insert("location.x")\nexcept ValueError:\n    pass',
        'with suppress(ValueError):\n    ob.keyframe_insert("location.x")',
        "if bpy.app.version < (2, 80):\n    ob.keyframe_insert('modifiers[\"A\"].number')",
        'if hasattr(modifier, "number"):\n    ob.keyframe_insert(\'modifiers["A"].number\')',
        'modifier.keyframe_insert("levels")',
        "ob.keyframe_insert('modifiers[\"A\"].levels')",
        'ob.keyframe_insert(\'modifiers["A"]["Socket_2"]\', index=1)',
        "ob.keyframe_insert('[\"values\"]', index=7)",
        'ob.data.keyframe_insert("energy")',
        'ob.data.keyframe_insert("splines[0].points[0].co", index=3)',
        'node.keyframe_insert("inputs[0].default_value", index=3)',
        'socket.keyframe_insert("default_value", index=2)',
        'ob.keyframe_insert("mine.x")',
        'ob.keyframe_insert("mine.many", index=3)',
        'ob.mine.keyframe_insert("many", index=3)',
        'ob.keyframe_insert("matrix", index=15)',
        'ob.driver_remove("location.x")',
        'anything.keyframe_insert("location.x")',
    ],
)
def test_what_may_be_taken_is_left_alone(check: Check, code: str) -> None:
    start = """\
import bpy
from contextlib import suppress

class Mine(bpy.types.PropertyGroup):
    x: bpy.props.FloatProperty()
    many: bpy.props.FloatVectorProperty(size=4)

bpy.types.Object.mine = bpy.props.PointerProperty(type=Mine)
bpy.types.Object.matrix = bpy.props.FloatVectorProperty(size=16)
ob = bpy.data.objects["Cube"]
modifier = ob.modifiers["A"]
node = bpy.data.node_groups["A"].nodes["B"]
socket = node.inputs[0]
"""
    assert not check("refused-path", start + code)
