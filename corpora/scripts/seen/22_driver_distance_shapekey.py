"""Drive a shape key from the distance between two objects and limit it with a driver F-curve modifier."""
import bpy
from mathutils import Vector

bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=1)
ob = bpy.context.object
ob.name = "Blob"
ob.shape_key_add(name="Basis")
key = ob.shape_key_add(name="Spike")
for i, v in enumerate(ob.data.vertices):
    if i % 7 == 0:
        key.data[i].co = v.co * 1.6
key.slider_min = 0.0
key.slider_max = 1.0

near = bpy.data.objects.new("Proximity", None)
near.empty_display_type = 'SPHERE'
near.location = Vector((4, 0, 0))
bpy.context.scene.collection.objects.link(near)

fcurve = ob.data.shape_keys.driver_add('key_blocks["Spike"].value')
driver = fcurve.driver
driver.type = 'SCRIPTED'
driver.expression = "max(0, 1 - (dist - 1.5) / 3)"
var = driver.variables.new()
var.name = "dist"
var.type = 'LOC_DIFF'
var.targets[0].id = ob
var.targets[1].id = near

mod = fcurve.modifiers.new('LIMITS')
mod.use_max_y = True
mod.max_y = 0.8
if fcurve.modifiers and fcurve.modifiers[0].type == 'GENERATOR':
    fcurve.modifiers.remove(fcurve.modifiers[0])

for f, x in ((1, 6.0), (40, 1.5), (80, 6.0)):
    near.location.x = x
    near.keyframe_insert("location", index=0, frame=f)

scene = bpy.context.scene
for f in (1, 20, 40, 60):
    scene.frame_set(f)
    print(f, round(key.value, 3))
print("driver valid:", driver.is_valid)
