"""Unwrap the object, bake ambient occlusion to a new image and plug it in the material."""
import bpy
import os
import tempfile

scene = bpy.context.scene
scene.render.engine = 'CYCLES'
scene.cycles.samples = 16
scene.cycles.device = 'CPU'

bpy.ops.mesh.primitive_monkey_add(size=2, location=(0, 0, 1))
obj = bpy.context.object
obj.name = "BakeMonkey"

bpy.ops.object.mode_set(mode='EDIT')
bpy.ops.mesh.select_all(action='SELECT')
bpy.ops.uv.smart_project(angle_limit=66, island_margin=0.02)
bpy.ops.object.mode_set(mode='OBJECT')

img = bpy.data.images.new("AO_Bake", width=512, height=512, alpha=False, float_buffer=False)
img.colorspace_settings.name = 'Non-Color'

mat = bpy.data.materials.new("BakeMat")
mat.use_nodes = True
obj.data.materials.clear()
obj.data.materials.append(mat)
nodes = mat.node_tree.nodes
tex = nodes.new("ShaderNodeTexImage")
tex.image = img
tex.select = True
nodes.active = tex

bpy.ops.object.select_all(action='DESELECT')
obj.select_set(True)
bpy.context.view_layer.objects.active = obj

scene.render.bake.margin = 8
scene.render.bake.use_clear = True
scene.render.bake.use_selected_to_active = False
bpy.ops.object.bake(type='AO')

path = os.path.join(tempfile.gettempdir(), "ao_bake.png")
img.filepath_raw = path
img.file_format = 'PNG'
img.save()

bsdf = nodes.get("Principled BSDF")
mix = nodes.new("ShaderNodeMixRGB")
mix.blend_type = 'MULTIPLY'
mix.inputs["Fac"].default_value = 1.0
mix.inputs["Color1"].default_value = (0.8, 0.5, 0.3, 1)
mat.node_tree.links.new(tex.outputs["Color"], mix.inputs["Color2"])
mat.node_tree.links.new(mix.outputs["Color"], bsdf.inputs["Base Color"])
print("baked to", path)
