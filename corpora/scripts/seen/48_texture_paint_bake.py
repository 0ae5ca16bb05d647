"""Create an image from numpy pixels, set it up for texture painting, and bake procedural noise into another image."""
import bpy
import numpy as np
import os
import tempfile

SIZE = 256
img = bpy.data.images.new("Gradient", SIZE, SIZE, alpha=True, float_buffer=False)
u, v = np.meshgrid(np.linspace(0, 1, SIZE), np.linspace(0, 1, SIZE))
px = np.dstack((u, v, 0.5 + 0.5 * np.sin(u * 20), np.ones_like(u))).astype(np.float32)
img.pixels.foreach_set(px.ravel())
img.update()
img.filepath_raw = os.path.join(tempfile.gettempdir(), "gradient.png")
img.file_format = 'PNG'
img.save()
img.pack()
img.colorspace_settings.name = 'sRGB'

bpy.ops.mesh.primitive_cube_add(size=2)
ob = bpy.context.object
mat = bpy.data.materials.new("Painted")
mat.use_nodes = True
ob.data.materials.append(mat)
nodes, links = mat.node_tree.nodes, mat.node_tree.links
bsdf = nodes["Principled BSDF"]

noise = nodes.new("ShaderNodeTexNoise")
noise.inputs["Scale"].default_value = 6
links.new(noise.outputs["Color"], bsdf.inputs["Base Color"])

bake_img = bpy.data.images.new("Baked", 128, 128)
tex = nodes.new("ShaderNodeTexImage")
tex.image = bake_img
tex.select = True
nodes.active = tex

scene = bpy.context.scene
scene.render.engine = 'CYCLES'
scene.cycles.samples = 4
scene.cycles.bake_type = 'DIFFUSE'
scene.render.bake.use_pass_direct = False
scene.render.bake.use_pass_indirect = False
scene.render.bake.margin = 8
bpy.ops.object.bake(type='DIFFUSE', pass_filter={'COLOR'}, use_clear=True)
print("mean of bake:", np.array(bake_img.pixels[:]).mean())

links.new(tex.outputs["Color"], bsdf.inputs["Base Color"])

ts = scene.tool_settings
ts.image_paint.mode = 'IMAGE'
ts.image_paint.canvas = img
ts.image_paint.seam_bleed = 4
ts.unified_paint_settings.use_unified_size = True
ts.unified_paint_settings.size = 40
brush = bpy.data.brushes.new("RedPaint", mode='TEXTURE_PAINT')
brush.color = (1, 0, 0)
brush.strength = 0.8
brush.blend = 'MIX'
ts.image_paint.brush = brush
bpy.ops.object.mode_set(mode='TEXTURE_PAINT')
bpy.ops.object.mode_set(mode='OBJECT')
