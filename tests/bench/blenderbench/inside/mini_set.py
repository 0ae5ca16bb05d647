"""Builds a miniature BlenderBench in the official layout: ``mini_set.py SET RESULT``; needs bpy.

A table with two things on it, in each task seen by two cameras; the official renders are taken with Camera1, which is
not the scene's. As in the official set, a raw file may already be what is asked for: that of the camera task holds the
goal's camera, and that of the others the goal's attributes in part, and only start.py makes the task of it.
"""

import json
import sys
from pathlib import Path

import bpy
from mathutils import Matrix, Vector

SIZE = (48, 32)
SAMPLES = 4
_NEAR, _FAR, _LOW = (1.6, -1.8, 1.3), (3.0, -2.2, 2.4), (-1.8, -2.4, 0.7)

# Level and task → instruction, start.py, goal.py.
_PLACE = """\
import bpy
from mathutils import Vector

camera = bpy.data.objects["Camera1"]
camera.location = {at}
camera.rotation_euler = (Vector((0, 0, 0.2)) - camera.location).to_track_quat("-Z", "Y").to_euler()
"""
_LOOKS = """\
import bpy

bpy.data.lights["Lamp"].energy = {energy}
bpy.data.objects["Mug"].scale = (1, 1, {height})
bpy.data.materials["Glaze"].node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = {colour}
"""
_DIM = _LOOKS.format(energy=60, height=1, colour=(0.05, 0.05, 0.6, 1))
_BRIGHT = _LOOKS.format(energy=400, height=2, colour=(0.7, 0.05, 0.02, 1))
TASKS = {
    ("level1", "table1"): (
        "Move the camera until the table is seen as in the goal.",
        _PLACE.format(at=_FAR),
        _PLACE.format(at=_NEAR),
    ),
    ("level1", "table2"): (
        "--low: set the camera lower and to the left, as in the goal.",
        _PLACE.format(at=_FAR),
        _PLACE.format(at=_LOW),
    ),
    ("level2", "mug1"): ("Make the lamp brighter, then the mug taller and red.", _DIM, _BRIGHT),
    ("level3", "mug1"): (
        "Make the lamp brighter, then the mug taller and red. Find a camera that shows it.",
        _PLACE.format(at=_FAR) + _DIM,
        _PLACE.format(at=_NEAR) + _BRIGHT,
    ),
}


def block(name, size, at, colour):
    bpy.ops.mesh.primitive_cube_add(size=1, location=at)
    made = bpy.context.object
    made.name = made.data.name = name
    made.data.transform(Matrix.Diagonal((*size, 1)))
    material = bpy.data.materials.new("Glaze" if name == "Mug" else f"{name} paint")
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*colour, 1)
    made.data.materials.append(material)
    return made


def camera(name, at):
    made = bpy.data.objects.new(name, bpy.data.cameras.new(name))
    made.location = at
    made.rotation_euler = (Vector((0, 0, 0.2)) - made.location).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(made)
    return made


def build(folder):
    """The raw scene: bright and near, as the goals are, but for the mug's height."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    block("Table", (2, 2, 0.1), (0, 0, -0.05), (0.4, 0.3, 0.2))
    block("Mug", (0.3, 0.3, 0.3), (-0.2, 0, 0.15), (0.7, 0.05, 0.02))
    block("Jar", (0.2, 0.2, 0.5), (0.4, 0.3, 0.25), (0.1, 0.5, 0.2))
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.data.energy = 400
    lamp.location = (1.5, -1.0, 3.0)
    scene.collection.objects.link(lamp)
    scene.world = bpy.data.worlds.new("Sky")
    camera("Camera1", _NEAR)
    scene.camera = camera("Overview", (0, 0, 9))
    image = bpy.data.images.new("Label", 4, 4)
    image.filepath_raw, image.file_format = str(folder / "label.png"), "PNG"
    image.save()
    image.filepath = "//label.png"
    image.use_fake_user = True
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.render.resolution_percentage = 50


def render(path):
    scene = bpy.context.scene
    scene.camera = bpy.data.objects["Camera1"]
    scene.render.filepath = str(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    bpy.ops.render.render(write_still=True)


def settle():
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = SAMPLES
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    scene.render.image_settings.color_mode = "RGB"


def main(root, result):
    for (level, name), (instruction, start, goal) in TASKS.items():
        folder = root / level / name
        folder.mkdir(parents=True)
        (folder / "task.txt").write_text(f"{instruction}\n")
        (folder / "start.py").write_text(start)
        (folder / "goal.py").write_text(goal)
        build(folder)
        raw = str(folder / "blender_file.blend")
        bpy.context.preferences.filepaths.save_version = 0
        bpy.ops.wm.save_as_mainfile(filepath=raw)
        settle()
        for kind, code in (("start", start), ("goal", start + goal)):
            exec(compile(code, kind, "exec"), {"__name__": "__main__"})
            render(folder / "renders" / kind / "render1.png")
            if kind == "goal" and level == "level2":
                render(folder / "renders" / kind / "visprompt1.png")
    result.write_text(json.dumps({"size": SIZE, "samples": SAMPLES}))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
