"""Files whose frames can be told apart by their colours: what is where, under a light of its own."""

import bpy
from making import add, bake, cloth_on, empty, finish, keys, new, save

FRAMES = 9
RED, GREEN, BLUE, WHITE = (1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 1), (1, 1, 1, 1)


def glowing(thing, colour):
    """Has it shine in a colour, whatever the light."""
    material = bpy.data.materials.new(thing.name)
    tree = material.node_tree
    tree.nodes.clear()
    shine = tree.nodes.new("ShaderNodeEmission")
    shine.inputs["Color"].default_value = colour
    tree.links.new(shine.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    thing.data.materials.append(material)
    return thing


def stage(*, camera=True):
    """A scene that is seen straight from above, 16 by 9 metres."""
    scene = new(FRAMES)
    scene.view_settings.view_transform = "Raw"
    if camera:
        thing = bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye"))
        scene.collection.objects.link(thing)
        thing.location.z = 10
        thing.data.type, thing.data.ortho_scale = "ORTHO", 16
        scene.camera = thing
    return scene


def keyed():
    """A red tile goes from the left to the right, evenly."""
    stage()
    tile = glowing(add("plane", "Tile", size=2), RED)
    keys(tile, "location", [(-7, 0, 0), (7, 0, 0)], [1, FRAMES])
    for curve in tile.animation_data.action.layers[0].strips[0].channelbags[0].fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def falling(*, baked):
    """A green cloth falls through a blue pane: seen while it is above."""
    stage()
    glowing(add("plane", "Pane", size=30), BLUE)
    cloth_on(glowing(add("grid", "Cloth", (0, 0, 0.2), size=4, x_subdivisions=4), GREEN), FRAMES)
    if baked:
        bake()


def unbaked():
    falling(baked=False)


def baked():
    falling(baked=True)


def endless():
    falling(baked=False)
    bpy.context.scene.frame_end = 9000


def no_camera():
    """Three tiles in a row, and ground that is far larger."""
    stage(camera=False)
    glowing(add("plane", "Ground", size=2000), BLUE)
    for place, colour in ((-3, RED), (0, GREEN), (3, WHITE)):
        glowing(add("cube", f"Tile {place}", (place, 0, 0.5), size=2), colour)


def strips():
    """What an editor's strip shows is not the scene."""
    scene = stage()
    glowing(add("plane", "Tile", size=20), RED)
    editor = scene.sequence_editor_create()
    editor.strips.new_effect("Cover", "COLOR", 1, 1, length=FRAMES).color = (0, 1, 0)


def square():
    scene = stage()
    scene.render.resolution_x = scene.render.resolution_y = 4000
    scene.render.use_border, scene.render.border_max_x = True, 0.1
    glowing(add("plane", "Tile", size=20), RED)
    empty("Nothing")


def main():
    for make in (keyed, baked, unbaked, endless, no_camera, strips, square):
        make()
        save(make.__name__)
    finish({})


main()
