"""App handlers: frame change updates an object, depsgraph logging, a load_post persistent handler and a timer."""
import bpy
import math
from bpy.app.handlers import persistent

LOG = []


@persistent
def on_frame_change(scene, depsgraph=None):
    ob = scene.objects.get("Orbiter")
    if ob:
        t = scene.frame_current / 24
        ob.location = (3 * math.cos(t), 3 * math.sin(t), 1)


def on_depsgraph_update(scene, depsgraph):
    for up in depsgraph.updates:
        if isinstance(up.id, bpy.types.Object) and up.is_updated_transform:
            LOG.append((scene.frame_current, up.id.name))


@persistent
def on_load(dummy):
    print("Loaded:", bpy.data.filepath)


def on_render_pre(scene):
    print("rendering frame", scene.frame_current)


def on_save_pre(*args):
    bpy.context.scene["saved_count"] = bpy.context.scene.get("saved_count", 0) + 1


def tick():
    print("tick", len(LOG))
    return None if len(LOG) > 100 else 2.0


def add_handler(handlers, func):
    for h in [h for h in handlers if h.__name__ == func.__name__]:
        handlers.remove(h)
    handlers.append(func)


def register():
    h = bpy.app.handlers
    add_handler(h.frame_change_post, on_frame_change)
    add_handler(h.depsgraph_update_post, on_depsgraph_update)
    add_handler(h.load_post, on_load)
    add_handler(h.render_pre, on_render_pre)
    add_handler(h.save_pre, on_save_pre)
    if not bpy.app.timers.is_registered(tick):
        bpy.app.timers.register(tick, first_interval=1.0, persistent=True)


register()
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.3)
bpy.context.object.name = "Orbiter"
for f in range(1, 25, 6):
    bpy.context.scene.frame_set(f)
    print(f, bpy.data.objects["Orbiter"].location[:])
bpy.context.view_layer.update()
print("log entries:", len(LOG))
print("handlers:", len(bpy.app.handlers.frame_change_post))
