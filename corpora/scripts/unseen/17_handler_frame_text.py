"""Use a frame change handler so a text object always shows the current frame and timecode."""
import bpy
from bpy.app.handlers import persistent

TEXT_NAME = "FrameCounter"


def ensure_text():
    ob = bpy.data.objects.get(TEXT_NAME)
    if ob is None:
        cu = bpy.data.curves.new(TEXT_NAME, 'FONT')
        cu.align_x = 'CENTER'
        cu.size = 0.5
        ob = bpy.data.objects.new(TEXT_NAME, cu)
        bpy.context.scene.collection.objects.link(ob)
        ob.location = (0, 0, 3)
        ob.rotation_euler.x = 1.5708
    return ob


def timecode(frame, fps):
    s, f = divmod(frame, fps)
    m, s = divmod(s, 60)
    h, m = divmod(m, 60)
    return "%02d:%02d:%02d:%02d" % (h, m, s, f)


@persistent
def update_counter(scene, depsgraph=None):
    ob = bpy.data.objects.get(TEXT_NAME)
    if ob is None:
        return
    fps = int(scene.render.fps / scene.render.fps_base)
    ob.data.body = "Frame %d\n%s" % (scene.frame_current, timecode(scene.frame_current, fps))


def register():
    ensure_text()
    handlers = bpy.app.handlers.frame_change_post
    for h in list(handlers):
        if h.__name__ == "update_counter":
            handlers.remove(h)
    handlers.append(update_counter)
    if update_counter not in bpy.app.handlers.render_pre:
        bpy.app.handlers.render_pre.append(update_counter)


register()
for f in (1, 25, 100):
    bpy.context.scene.frame_set(f)
    print(bpy.data.objects[TEXT_NAME].data.body)
