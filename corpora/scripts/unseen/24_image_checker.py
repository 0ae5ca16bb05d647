"""Generate a checkerboard image with numpy pixels, save it as PNG, pack it and show it on a plane."""
import bpy
import numpy as np
import os
import tempfile

W, H, N = 512, 512, 8

ys, xs = np.mgrid[0:H, 0:W]
check = ((xs * N // W) + (ys * N // H)) % 2
px = np.empty((H, W, 4), dtype=np.float32)
px[..., 0] = np.where(check, 0.9, 0.1)
px[..., 1] = np.where(check, 0.4, 0.1)
px[..., 2] = xs / W
px[..., 3] = 1.0

img = bpy.data.images.new("Checker", W, H, alpha=True)
img.pixels.foreach_set(px.ravel())
img.update()

img.filepath_raw = os.path.join(tempfile.gettempdir(), "checker.png")
img.file_format = 'PNG'
img.save()
img.pack()

mat = bpy.data.materials.new("CheckerMat")
mat.use_nodes = True
mat.blend_method = 'BLEND'
mat.shadow_method = 'NONE'
nodes = mat.node_tree.nodes
tex = nodes.new("ShaderNodeTexImage")
tex.image = img
tex.interpolation = 'Closest'
tex.extension = 'REPEAT'
tex.location = (-350, 250)
bsdf = nodes["Principled BSDF"]
mat.node_tree.links.new(tex.outputs["Color"], bsdf.inputs["Base Color"])
mat.node_tree.links.new(tex.outputs["Alpha"], bsdf.inputs["Alpha"])

bpy.ops.mesh.primitive_plane_add(size=4)
plane = bpy.context.object
plane.data.materials.append(mat)

uv = plane.data.uv_layers.active
for loop in uv.data:
    loop.uv = loop.uv * 2.0

print(img.size[:], img.packed_file is not None, img.filepath_raw)
