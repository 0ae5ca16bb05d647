"""Old code, and what becomes of it: one case or more for every rewrite."""

from __future__ import annotations

from dataclasses import dataclass
from textwrap import dedent


@dataclass(frozen=True)
class Case:
    """``old`` runs in the Blender ``written_for`` and not in this one; ``new`` is what a migration makes of it."""

    rewrite: str
    written_for: str
    old: str
    new: str

    @property
    def name(self) -> str:
        return f"{self.rewrite}: {self.old.strip().splitlines()[-1].strip()}"


HEAD = """\
import bpy
import math
from mathutils import Matrix, Quaternion, Vector
ob = bpy.context.object
scene = bpy.context.scene
"""


def case(rewrite: str, written_for: str, old: str, new: str) -> Case:
    return Case(rewrite, written_for, HEAD + dedent(old).lstrip("\n"), HEAD + dedent(new).lstrip("\n"))


CASES = (
    case("renamed-import", "3.4",
         """
         from bpy.types import (
             Operator, MetaSequence,
             Sequence as Strip)
         print(Operator, MetaSequence, Strip)
         """,
         """
         from bpy.types import (
             Operator, MetaStrip as MetaSequence,
             Strip as Strip)
         print(Operator, MetaSequence, Strip)
         """),
    case("object-state", "2.79", "ob.select = True\n", "ob.select_set(True)\n"),
    case("object-state", "2.79", "ob.hide = not ob.select\n", "ob.hide_set(not ob.select_get())\n"),
    case("object-state", "2.79", "seen = [o for o in scene.objects if o.select]\n",
         "seen = [o for o in scene.objects if o.select_get()]\n"),
    case("view-layer", "2.79", "scene.objects.active = ob\n", "bpy.context.view_layer.objects.active = ob\n"),
    case("view-layer", "2.79", "other = bpy.data.scenes.new('B')\nother.update()\n",
         "other = bpy.data.scenes.new('B')\nother.view_layers[0].update()\n"),
    case("scene-objects", "2.79", "new = bpy.data.objects.new('E', None)\nscene.objects.link(new)\n",
         "new = bpy.data.objects.new('E', None)\nscene.collection.objects.link(new)\n"),
    case("scene-objects", "2.79", "scene.objects.unlink(ob)\n",
         """
         for collection in tuple(ob.users_collection):
             collection.objects.unlink(ob)
         """),
    case("moved-member", "2.79", "scene.cursor_location = (1, 2, 3)\n", "scene.cursor.location = (1, 2, 3)\n"),
    case("moved-member", "2.79", "bpy.data.cameras[0].dof_distance = 3\n",
         "bpy.data.cameras[0].dof.focus_distance = 3\n"),
    case("moved-member", "2.79", "layer = scene.render.layers[0]\n", "layer = scene.view_layers[0]\n"),
    case("keyword-value", "2.79", "bpy.ops.mesh.primitive_cube_add(radius=1.5, view_align=False)\n",
         'bpy.ops.mesh.primitive_cube_add(size=3.0, align="WORLD")\n'),
    case("keyword-value", "2.79", "r = 2\nbpy.ops.mesh.primitive_plane_add(radius=r + 1, layers=[True] * 20)\n",
         "r = 2\nbpy.ops.mesh.primitive_plane_add(size=2 * (r + 1))\n"),
    case("keyword-value", "2.79", "bpy.ops.transform.resize(value=(2, 2, 2), proportional='DISABLED')\n",
         "bpy.ops.transform.resize(value=(2, 2, 2), use_proportional_edit=False)\n"),
    case("keyword-value", "2.79", "bpy.ops.object.lamp_add(type='SUN', view_align=False, layers=[True] * 20)\n",
         "bpy.ops.object.light_add(type='SUN', align=\"WORLD\")\n"),
    case("keyword-value", "2.83",
         "ob.modifiers.new('B', 'BEVEL')\nbpy.ops.object.modifier_apply(apply_as='DATA', modifier='B')\n",
         "ob.modifiers.new('B', 'BEVEL')\nbpy.ops.object.modifier_apply(modifier='B')\n"),
    case("keyword-value", "2.79", "bpy.ops.transform.rotate(value=1.0, axis=(0, 0, 1))\n",
         'bpy.ops.transform.rotate(value=1.0, orient_axis="Z")\n'),
    case("keyword-value", "3.4",
         """
         strips = scene.sequence_editor_create().sequences
         strips.new_effect("C", "COLOR", 1, frame_start=5, frame_end=20)
         """,
         """
         strips = scene.sequence_editor_create().strips
         strips.new_effect("C", "COLOR", 1, frame_start=5, length=15)
         """),
    case("moved-member", "2.79", "scene.render.alpha_mode = 'TRANSPARENT'\n", "scene.render.film_transparent = True\n"),
    case("moved-member", "2.79", "scene.cycles.film_transparent = True\n", "scene.render.film_transparent = True\n"),
    case("moved-member", "2.79", "empty = bpy.data.objects.new('E', None)\nempty.dupli_type = 'GROUP'\n",
         "empty = bpy.data.objects.new('E', None)\nempty.instance_type = \"COLLECTION\"\n"),
    case("moved-member", "2.93", "ob.cycles_visibility.shadow = False\n", "ob.visible_shadow = False\n"),
    case("moved-member", "2.93",
         """
         arm = bpy.data.objects.new("A", bpy.data.armatures.new("A"))
         scene.collection.objects.link(arm)
         bpy.context.view_layer.objects.active = arm
         bpy.ops.object.mode_set(mode="EDIT")
         arm.data.edit_bones.new("B").tail = (0, 0, 1)
         bpy.ops.object.mode_set(mode="OBJECT")
         arm.pose.bones["B"].custom_shape_scale = 2.0
         """,
         """
         arm = bpy.data.objects.new("A", bpy.data.armatures.new("A"))
         scene.collection.objects.link(arm)
         bpy.context.view_layer.objects.active = arm
         bpy.ops.object.mode_set(mode="EDIT")
         arm.data.edit_bones.new("B").tail = (0, 0, 1)
         bpy.ops.object.mode_set(mode="OBJECT")
         arm.pose.bones["B"].custom_shape_scale_xyz = (2.0, 2.0, 2.0)
         """),
    case("moved-member", "2.79",
         """
         tex = bpy.data.materials.new("M").node_tree.nodes.new("ShaderNodeTexImage")
         tex.image = bpy.data.images.new("I", 4, 4)
         tex.color_space = "NONE"
         """,
         """
         tex = bpy.data.materials.new("M").node_tree.nodes.new("ShaderNodeTexImage")
         tex.image = bpy.data.images.new("I", 4, 4)
         tex.image.colorspace_settings.name = "Non-Color"
         """),
    case("socket-place", "3.4",
         """
         tree = bpy.data.node_groups.new("t", "ShaderNodeTree")
         principled = tree.nodes.new("ShaderNodeBsdfPrincipled")
         principled.inputs[9].default_value = 0.25
         tree.links.new(tree.nodes.new("ShaderNodeValue").outputs[0], principled.inputs[7])
         """,
         """
         tree = bpy.data.node_groups.new("t", "ShaderNodeTree")
         principled = tree.nodes.new("ShaderNodeBsdfPrincipled")
         principled.inputs["Roughness"].default_value = 0.25
         tree.links.new(tree.nodes.new("ShaderNodeValue").outputs[0], principled.inputs["Specular IOR Level"])
         """),
    case("scaled-socket", "3.4",
         """
         material = bpy.data.materials.new("M")
         material.use_nodes = True
         bsdf = material.node_tree.nodes["Principled BSDF"]
         bsdf.inputs["Clearcoat"].default_value = 0.5
         """,
         """
         material = bpy.data.materials.new("M")
         material.use_nodes = True
         bsdf = material.node_tree.nodes["Principled BSDF"]
         bsdf.inputs["Coat Weight"].default_value = 0.125
         """),
    case("scaled-socket", "3.4",
         """
         material = bpy.data.materials.new("M")
         material.use_nodes = True
         bsdf = material.node_tree.nodes["Principled BSDF"]
         bsdf.inputs["Subsurface"].default_value = 0.1
         """,
         """
         material = bpy.data.materials.new("M")
         material.use_nodes = True
         bsdf = material.node_tree.nodes["Principled BSDF"]
         bsdf.inputs["Subsurface Weight"].default_value = 1.0
         bsdf.inputs["Subsurface Scale"].default_value = 0.1
         """),
    case("auto-smooth", "3.4",
         """
         mesh = ob.data
         mesh.normals_split_custom_set([(0, 0, 1)] * len(mesh.loops))
         mesh.use_auto_smooth = True
         """,
         """
         mesh = ob.data
         mesh.normals_split_custom_set([(0, 0, 1)] * len(mesh.loops))
         """),
    case("action-channels", "3.4",
         """
         ob.animation_data_create()
         ob.animation_data.action = bpy.data.actions.new("A")
         action = ob.animation_data.action
         action.fcurves.new("location", index=1, action_group="G")
         ob.animation_data.action.fcurves.new(data_path="location", index=2)
         """,
         """
         ob.animation_data_create()
         ob.animation_data.action = bpy.data.actions.new("A")
         action = ob.animation_data.action
         action.fcurve_ensure_for_datablock(ob, "location", index=1, group_name="G")
         ob.animation_data.action.fcurve_ensure_for_datablock(ob, data_path="location", index=2)
         """),
    case("matrix-product", "2.79", "place = ob.matrix_world * Vector((1, 2, 3))\n",
         "place = ob.matrix_world @ Vector((1, 2, 3))\n"),
    case("matrix-product", "2.79", "ob.select = True\nob.matrix_world *= Matrix.Rotation(1.0, 4, 'X')\n",
         "ob.select_set(True)\nob.matrix_world @= Matrix.Rotation(1.0, 4, 'X')\n"),
    case("opaque-color", "2.79", "m = bpy.data.materials.new('M')\nm.diffuse_color = (1, 0, 0)\n",
         "m = bpy.data.materials.new('M')\nm.diffuse_color = (1, 0, 0, 1.0)\n"),
    case("annotated-property", "2.79",
         """
         class Tool(bpy.types.Operator):
             bl_idname = "object.tool"
             bl_label = "Tool"
             size = bpy.props.FloatProperty(default=1)
         bpy.utils.register_class(Tool)
         assert "size" in bpy.ops.object.tool.get_rna_type().properties
         """,
         """
         class Tool(bpy.types.Operator):
             bl_idname = "object.tool"
             bl_label = "Tool"
             size: bpy.props.FloatProperty(default=1)
         bpy.utils.register_class(Tool)
         assert "size" in bpy.ops.object.tool.get_rna_type().properties
         """),
    case("registered-module", "2.79",
         """
         class First(bpy.types.Operator):
             bl_idname = "object.first"
             bl_label = "First"
         def register():
             bpy.utils.register_module(__name__)
         register()
         """,
         """
         class First(bpy.types.Operator):
             bl_idname = "object.first"
             bl_label = "First"
         def register():
             for cls in (First,):
                 bpy.utils.register_class(cls)
         register()
         """),
    case("auto-smooth", "3.4", "ob.data.use_auto_smooth = True\nob.data.auto_smooth_angle = math.radians(40)\n",
         "ob.data.set_sharp_from_angle(angle=math.radians(40))\n"),
    case("auto-smooth", "3.4", "mesh = bpy.data.meshes.new('M')\nmesh.use_auto_smooth = True\n",
         "mesh = bpy.data.meshes.new('M')\nmesh.set_sharp_from_angle(angle=0.523599)\n"),
    case("needless-call", "3.4", "mesh = bpy.data.meshes.new('M')\nmesh.calc_normals()\nmesh.update()\n",
         "mesh = bpy.data.meshes.new('M')\nmesh.update()\n"),
    case("interface-socket", "3.4",
         """
         group = bpy.data.node_groups.new("G", "GeometryNodeTree")
         group.inputs.new("NodeSocketFloat", "Height")
         group.outputs.new(name="Mesh", type="NodeSocketGeometry")
         """,
         """
         group = bpy.data.node_groups.new("G", "GeometryNodeTree")
         group.interface.new_socket(name="Height", in_out="INPUT", socket_type="NodeSocketFloat")
         group.interface.new_socket(name="Mesh", in_out="OUTPUT", socket_type="NodeSocketGeometry")
         """),
    case("context-override", "3.4", "bpy.ops.object.shade_smooth({'object': ob, 'selected_objects': [ob]})\n",
         """
         with bpy.context.temp_override(object=ob, selected_objects=[ob]):
             bpy.ops.object.shade_smooth()
         """),
    case("context-override", "3.4",
         """
         if ob:
             members = bpy.context.copy()
             done = bpy.ops.object.modifier_add(members, 'EXEC_DEFAULT', type='BEVEL')
         """,
         """
         if ob:
             members = bpy.context.copy()
             with bpy.context.temp_override(**members):
                 done = bpy.ops.object.modifier_add('EXEC_DEFAULT', type='BEVEL')
         """),
    case("action-channels", "3.4",
         """
         ob.keyframe_insert("location", frame=1)
         moved = ob.animation_data
         for curve in moved.action.fcurves:
             curve.extrapolation = "LINEAR"
         """,
         """
         ob.keyframe_insert("location", frame=1)
         moved = ob.animation_data
         for curve in anim_utils.action_ensure_channelbag_for_slot(moved.action, moved.action_slot).fcurves:
             curve.extrapolation = "LINEAR"
         """),
    case("action-channels", "3.4",
         """
         ob.keyframe_insert("location", frame=1)
         action = ob.animation_data.action
         count = len(action.fcurves)
         """,
         """
         ob.keyframe_insert("location", frame=1)
         action = ob.animation_data.action
         count = len(anim_utils.action_ensure_channelbag_for_slot(action, action.slots[0]).fcurves)
         """),
    case("unknown-value", "4.2", "scene.render.engine = 'BLENDER_EEVEE_NEXT'\n",
         "scene.render.engine = 'BLENDER_EEVEE'\n"),
    case("split-factor", "2.79",
         """
         class Side(bpy.types.Panel):
             bl_label = "Side"
             bl_space_type = "VIEW_3D"
             bl_region_type = "UI"
             def draw(self, context):
                 self.layout.label("Text", icon='NONE')
                 self.layout.prop(context.object, "name", "Title")
                 self.layout.split(percentage=0.3)
         bpy.utils.register_class(Side)
         parameters = bpy.types.UILayout.bl_rna.functions["label"].parameters
         assert not parameters["text"].is_required
         """,
         """
         class Side(bpy.types.Panel):
             bl_label = "Side"
             bl_space_type = "VIEW_3D"
             bl_region_type = "UI"
             def draw(self, context):
                 self.layout.label(text="Text", icon='NONE')
                 self.layout.prop(context.object, "name", text="Title")
                 self.layout.split(factor=0.3)
         bpy.utils.register_class(Side)
         parameters = bpy.types.UILayout.bl_rna.functions["label"].parameters
         assert not parameters["text"].is_required
         """),
    case("moved-operator", "3.4",
         "import os\nbpy.ops.export_scene.obj(filepath=os.devnull, use_selection=True)\n",
         "import os\nbpy.ops.wm.obj_export(filepath=os.devnull, export_selected_objects=True)\n"),
    case("moved-operator", "3.4",
         "import os\nbpy.ops.export_mesh.stl(filepath=os.devnull, use_selection=True, axis_up='-Y')\n",
         'import os\nbpy.ops.wm.stl_export(filepath=os.devnull, export_selected_objects=True, up_axis="NEGATIVE_Y")\n'),
    case("keyword-value", "3.4",
         "import os\nbpy.ops.export_scene.obj(filepath=os.devnull, axis_forward='-Z', axis_up='Y')\n",
         'import os\nbpy.ops.wm.obj_export(filepath=os.devnull, forward_axis="NEGATIVE_Z", up_axis="Y")\n'),
    case("unknown-socket", "3.4",
         "m = bpy.data.materials.new('M')\nm.use_nodes = True\n"
         "m.node_tree.nodes['Principled BSDF'].inputs['Specular'].default_value = 0.2\n",
         "m = bpy.data.materials.new('M')\nm.use_nodes = True\n"
         "m.node_tree.nodes['Principled BSDF'].inputs['Specular IOR Level'].default_value = 0.2\n"),
)  # fmt: skip
