"""What Blender's API allows, as scripts write it: type checkers must find nothing here."""

# ruff: noqa: RUF012, T201 - as scripts are written

from __future__ import annotations

import aud
import bmesh
import bpy
import mathutils


class Scatter(bpy.types.Operator):
    bl_idname = "object.scatter"
    bl_label = "Scatter"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.object is not None

    def invoke(self, context, event):
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"} if event.type == "TIMER" else self.execute(context)

    def execute(self, context):
        self.report({"INFO"}, context.object.name)
        self.layout.prop(context.scene, "gravity", text="Gravity", icon="WORLD")
        return {"FINISHED"}


def values(obj: bpy.types.Object) -> None:
    obj.location = (1, 2, 3)
    obj.location.x += 1
    obj.matrix_world = mathutils.Matrix.Translation((0, 0, 1)) @ mathutils.Matrix.Rotation(1, 4, "X")
    obj.matrix_world.translation = obj.location @ obj.matrix_world + mathutils.Vector((0, 0, 1)) * 2
    obj.color[0] = 0.5
    obj["weight"] = {"of": [1, 2]}
    obj.parent = None
    if obj.parent is None:
        obj.parent = bpy.data.objects.get("Parent")
    obj.keyframe_insert("location", index=2, frame=5)
    obj.copy().rotation_euler = mathutils.Euler((0, 0, 1))
    mesh = obj.data
    if isinstance(mesh, bpy.types.Mesh):
        mesh.vertices[0].co = (0, 0, 1)
    else:
        mesh.name = "no mesh"
    bpy.types.Scene.weight = bpy.props.FloatProperty(default=2.0, options={"ANIMATABLE"})
    del bpy.types.Scene.weight


def literals(obj: bpy.types.Object, kind) -> None:
    cloth = obj.modifiers.new("Cloth", "CLOTH")
    cloth.settings.quality = 12
    obj.modifiers.new("any", kind)
    for modifier in obj.modifiers:
        if modifier.type == "SUBSURF":
            modifier.levels = 2
    bpy.data.lights.new("Light", "AREA").size = 2
    material = bpy.data.materials.new("Material")
    tree = material.node_tree
    noise = tree.nodes.new("ShaderNodeTexNoise")
    shader = tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (1, 0, 0, 1)
    tree.links.new(noise.outputs[0], shader.inputs["Roughness"])
    tree.nodes["My Group"].inputs["My Input"].default_value = 3


def operators() -> None:
    bpy.ops.mesh.primitive_cube_add("INVOKE_DEFAULT", size=2, location=(0, 0, 1))
    if bpy.ops.object.delete.poll() and bpy.ops.object.delete(use_global=False) == {"FINISHED"}:
        with bpy.context.temp_override(active_object=bpy.context.object):
            bpy.ops.object.mode_set(mode="EDIT")


def meshes() -> None:
    bm = bmesh.new()
    made = bmesh.ops.create_cube(bm, size=1, matrix=mathutils.Matrix())
    made["verts"][0].co.xy = (1, 2)
    layer = bm.loops.layers.uv.verify()
    for face in bm.faces:
        for loop in face.loops:
            loop[layer].uv = (0.0, 1.0)
    bmesh.ops.bevel(bm, geom=bm.edges[:], offset=0.1, affect="EDGES")


def sounds() -> None:
    device = aud.Device("None")
    device.play(aud.Sound.sine(440))


@bpy.app.handlers.persistent
def on_load(path):
    print(path)


bpy.app.handlers.load_post.append(on_load)
