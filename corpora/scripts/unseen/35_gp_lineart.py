"""Add a Line Art grease pencil object for the whole scene with black strokes and thickness modifier."""
import bpy

scene = bpy.context.scene

bpy.ops.mesh.primitive_monkey_add(location=(0, 0, 1))
bpy.ops.mesh.primitive_cube_add(location=(3, 1, 1))

if scene.camera is None:
    bpy.ops.object.camera_add(location=(7, -7, 5), rotation=(1.1, 0, 0.785))
    scene.camera = bpy.context.object

bpy.ops.object.gpencil_add(type='EMPTY', location=(0, 0, 0))
gp = bpy.context.object
gp.name = "LineArt"

mat = bpy.data.materials.new("InkBlack")
bpy.data.materials.create_gpencil_data(mat)
mat.grease_pencil.color = (0, 0, 0, 1)
gp.data.materials.append(mat)

if not gp.data.layers:
    layer = gp.data.layers.new("Lines")
else:
    layer = gp.data.layers[0]
    layer.info = "Lines"
layer.frames.new(1)

mod = gp.grease_pencil_modifiers.new("Line Art", 'GP_LINEART')
mod.source_type = 'SCENE'
mod.target_layer = layer.info
mod.target_material = mat
mod.use_contour = True
mod.use_crease = True
mod.crease_threshold = 2.4
mod.use_intersection = True
mod.use_material = False
mod.thickness = 3
mod.opacity = 1.0

thick = gp.grease_pencil_modifiers.new("Thickness", 'GP_THICK')
thick.use_custom_curve = True
thick.thickness_factor = 1.5

gp.data.stroke_depth_order = '3D'
gp.show_in_front = True
print(gp.name, [m.type for m in gp.grease_pencil_modifiers])
