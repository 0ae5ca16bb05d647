"""Shape keys: make smile/blink/puff keys on Suzanne, animate them, and blend a new key from the mix."""
import bpy
import numpy as np
from mathutils import noise

bpy.ops.mesh.primitive_monkey_add(size=2)
ob = bpy.context.object
me = ob.data

basis = ob.shape_key_add(name="Basis", from_mix=False)
me.shape_keys.use_relative = True
n = len(me.vertices)
base = np.empty(n * 3, dtype=np.float32)
basis.data.foreach_get("co", base)
base = base.reshape(-1, 3)


def add_key(name, func):
    kb = ob.shape_key_add(name=name, from_mix=False)
    co = func(base.copy())
    kb.data.foreach_set("co", co.ravel())
    kb.slider_min = -1.0
    kb.slider_max = 1.0
    kb.interpolation = 'KEY_LINEAR'
    return kb


def puff(co):
    return co * np.array([1.2, 1.1, 1.0], dtype=np.float32)


def smile(co):
    mouth = (co[:, 2] < -0.3) & (co[:, 1] < 0)
    co[mouth, 2] += np.abs(co[mouth, 0]) * 0.4
    return co


def bumpy(co):
    for i in range(len(co)):
        co[i] += np.array(noise.noise_vector(co[i] * 3.0)) * 0.08
    return co


keys = [add_key("Puff", puff), add_key("Smile", smile), add_key("Bumpy", bumpy)]

for i, kb in enumerate(keys):
    kb.value = 0.0
    kb.keyframe_insert("value", frame=1 + i * 20)
    kb.value = 1.0
    kb.keyframe_insert("value", frame=11 + i * 20)
    kb.value = 0.0
    kb.keyframe_insert("value", frame=21 + i * 20)

action = me.shape_keys.animation_data.action
print("curves:", [fc.data_path for fc in action.fcurves])

keys[0].value = 0.5
keys[1].value = 0.5
mix = ob.shape_key_add(name="PuffSmile", from_mix=True)
mix.relative_key = basis
ob.active_shape_key_index = me.shape_keys.key_blocks.find("PuffSmile")
ob.show_only_shape_key = False
ob.shape_key_remove(me.shape_keys.key_blocks["Bumpy"])
vg = ob.vertex_groups.new(name="Left")
vg.add([v.index for v in me.vertices if v.co.x > 0], 1.0, 'REPLACE')
mix.vertex_group = "Left"
print([k.name for k in me.shape_keys.key_blocks])
