"""Create view layers for foreground and background with passes, cryptomatte and file output nodes in EXR."""
import bpy
import os
import tempfile

scene = bpy.context.scene
scene.render.engine = 'CYCLES'

fg = bpy.data.collections.new("FG")
bg = bpy.data.collections.new("BG")
scene.collection.children.link(fg)
scene.collection.children.link(bg)

bpy.ops.mesh.primitive_monkey_add(location=(0, -1, 1))
ob = bpy.context.object
for c in ob.users_collection:
    c.objects.unlink(ob)
fg.objects.link(ob)
bpy.ops.mesh.primitive_plane_add(size=20)
ob = bpy.context.object
for c in ob.users_collection:
    c.objects.unlink(ob)
bg.objects.link(ob)

vl_fg = scene.view_layers.new("Foreground")
vl_bg = scene.view_layers.new("Background")
vl_fg.layer_collection.children["BG"].holdout = True
vl_bg.layer_collection.children["FG"].exclude = True

for vl in (vl_fg, vl_bg):
    vl.use_pass_combined = True
    vl.use_pass_z = True
    vl.use_pass_normal = True
    vl.use_pass_diffuse_color = True
    vl.use_pass_mist = True
    vl.use_pass_object_index = True
    vl.use_pass_cryptomatte_object = True
    vl.pass_cryptomatte_depth = 4
    vl.cycles.denoising_store_passes = True

scene.use_nodes = True
nt = scene.node_tree
nt.nodes.clear()
fo = nt.nodes.new("CompositorNodeOutputFile")
fo.base_path = os.path.join(tempfile.gettempdir(), "passes")
fo.format.file_format = 'OPEN_EXR_MULTILAYER'
fo.format.color_depth = '16'
fo.file_slots.clear()
fo.location = (500, 0)

y = 300
for vl in (vl_fg, vl_bg):
    rl = nt.nodes.new("CompositorNodeRLayers")
    rl.scene = scene
    rl.layer = vl.name
    rl.location = (0, y)
    y -= 500
    for pas in ("Image", "Depth", "Normal", "Mist"):
        fo.file_slots.new("%s_%s" % (vl.name, pas))
        nt.links.new(rl.outputs[pas], fo.inputs[-1])

print([s.path for s in fo.file_slots])
