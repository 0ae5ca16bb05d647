"""Add shape keys to a sphere (bulge, squash, twist), animate them and drive one with a custom property."""
import bpy
import math

bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=1)
ob = bpy.context.object
ob.name = "Morph"

basis = ob.shape_key_add(name="Basis", from_mix=False)


def add_key(name, func):
    kb = ob.shape_key_add(name=name, from_mix=False)
    kb.slider_min = 0.0
    kb.slider_max = 1.0
    for i, v in enumerate(basis.data):
        kb.data[i].co = func(v.co.copy())
    return kb


def bulge(co):
    f = 1 + 0.5 * math.exp(-(co.z ** 2) * 4)
    co.x *= f
    co.y *= f
    return co


def squash(co):
    co.z *= 0.4
    return co


def twist(co):
    a = co.z * math.pi / 2
    x, y = co.x, co.y
    co.x = x * math.cos(a) - y * math.sin(a)
    co.y = x * math.sin(a) + y * math.cos(a)
    return co


k1 = add_key("Bulge", bulge)
k2 = add_key("Squash", squash)
k3 = add_key("Twist", twist)

for frame, val in ((1, 0.0), (20, 1.0), (40, 0.0)):
    k1.value = val
    k1.keyframe_insert("value", frame=frame)

ob.data.shape_keys.key_blocks["Squash"].value = 0.3

ob["twist_amount"] = 0.0
ob.id_properties_ui("twist_amount").update(min=0.0, max=1.0)
drv = k3.driver_add("value").driver
drv.type = 'AVERAGE'
var = drv.variables.new()
var.targets[0].id = ob
var.targets[0].data_path = '["twist_amount"]'
ob["twist_amount"] = 0.75

action = ob.data.shape_keys.animation_data.action
for fc in action.fcurves:
    fc.modifiers.new('CYCLES')

ob.active_shape_key_index = 1
bpy.context.scene.frame_set(20)
print({k.name: round(k.value, 2) for k in ob.data.shape_keys.key_blocks})
