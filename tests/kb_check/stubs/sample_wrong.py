"""What Blender's API does not have: type checkers must find a mistake in every line that ends in # wrong."""

# ruff: noqa: B018, RUF005, RUF012 - wrong on purpose

from __future__ import annotations

import bmesh
import bpy
import mathutils

obj = bpy.data.objects["Cube"]
cloth = obj.modifiers.new("Cloth", "CLOTH")
shader = bpy.data.materials["Material"].node_tree.nodes["Principled BSDF"]
noise = bpy.data.materials["Material"].node_tree.nodes.new("ShaderNodeTexNoise")
bm = bmesh.new()

obj.rotation_eulr = (0, 0, 1)  # wrong
obj.location = "up"  # wrong
obj.location = 3  # wrong
obj.bound_box = []  # wrong
obj.type = "MESH"  # wrong
obj.rotation_mode = "XYX"  # wrong
obj.data.verticess  # wrong
obj.modifiers[0].levelz = 2  # wrong
obj.modifiers.new("Cloth", "CLOTHES")  # wrong
obj.modifiers.add("Cloth")  # wrong
obj.keyframe_insert(path="location")  # wrong
obj.ray_cast((0, 0, 0))  # wrong
cloth.settings.stiffness = 3  # wrong
shader.inputs["Specular"].default_value = 0.5  # wrong
noise.inputs["Octaves"].default_value = 2  # wrong
bpy.data.lamps["Lamp"]  # wrong
bpy.data.lights.new("Light", "AREA").area = 2  # wrong
bpy.context.scene.update()  # wrong
bpy.context.selected_object  # wrong
bpy.context.scene.render.engine = "BLENDER_RENDER"  # wrong
bpy.ops.mesh.primitive_cube_add(radius=2)  # wrong
bpy.ops.mesh.primitive_cubes_add()  # wrong
bpy.ops.object.origin_set(type="CENTER")  # wrong
bpy.props.FloatProperty(defaults=2)  # wrong
bpy.types.Panels  # wrong
bmesh.ops.create_cube(bm, radius=1)  # wrong
bmesh.ops.create_cube(bm, size=1)["vertices"]  # wrong
bm.verts.create((0, 0, 1))  # wrong
mathutils.Vector((1, 2, 3)).normalize().x  # wrong
mathutils.Vector((1, 2, 3)) + (1, 2, 3)  # wrong
mathutils.Matrix.Rotate(1, 4, "X")  # wrong


class Wrong(bpy.types.Operator):
    bl_options = {"REGISTERED"}  # wrong

    def execute(self, context):
        context.scene.objects.link(obj)  # wrong
        return {"FINISHED"}
