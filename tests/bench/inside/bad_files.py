"""Files that mean harm, or are broken: each under its name, with its cache beside it where it has one."""

import os
import shutil

import bpy
from making import PLACE, add, bake, cloth_on, empty, finish, get, into, new, save

MARK = os.path.join(PLACE, "executed")


def sheet():
    new()
    add("cube", "Table").modifiers.new("Collision", "COLLISION")
    cloth_on(add("grid", "Tablecloth", (0, 0, 1.3), size=2, x_subdivisions=6, y_subdivisions=6))
    bake()


def good():
    sheet()


def script_on_load():
    sheet()
    text = bpy.data.texts.new("start.py")
    text.write(f"open({MARK!r}, 'w').close()")
    text.use_module = True


def python_driver():
    sheet()
    driver = get("Table").driver_add("location", 0).driver
    driver.expression = f"open({MARK!r}, 'w').close() or 0.0"


def other_frames():
    """The clip is somewhere else than the bake."""
    sheet()
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 500, 700


def unbaked():
    new()
    cloth_on(add("grid", "Tablecloth", (0, 0, 1.3), size=2))
    add("cube", "Table")


def missing_library():
    new()
    add("cube", "Table")
    save("library")
    sheet()
    with bpy.data.libraries.load(os.path.join(PLACE, "library.blend"), link=True) as (theirs, ours):
        ours.objects = list(theirs.objects)
    for thing in ours.objects:
        bpy.context.scene.collection.objects.link(thing)


def many_instances():
    """Collections of ten, in six storeys: a million things to draw."""
    sheet()
    shown = into("Storey 0", add("cube", "Brick"))
    bpy.context.scene.collection.children.unlink(shown)
    for storey in range(1, 7):
        things = [empty(f"Storey {storey} {number}", (number, 0, 0)) for number in range(10)]
        for thing in things:
            thing.instance_type, thing.instance_collection = "COLLECTION", shown
        shown = into(f"Storey {storey}", *things)
        if storey < 6:
            bpy.context.scene.collection.children.unlink(shown)


def heavy():
    """Six million faces, once it is looked at: just few enough to be opened."""
    new()
    table = add("cube", "Table")
    for levels in (6, 4):
        table.modifiers.new("Fine", "SUBSURF").levels = levels


def on_disk():
    new()
    modifier = cloth_on(add("grid", "Tablecloth", size=2))
    add("cube", "Table")
    save("on_disk")
    modifier.point_cache.use_disk_cache = True
    bake()


def fluid():
    new(6)
    flow = add("ico_sphere", "Tap", (0, 0, 0.5), radius=0.3).modifiers.new("Fluid", "FLUID")
    flow.fluid_type = "FLOW"
    flow.flow_settings.flow_type = "LIQUID"
    modifier = add("cube", "Water", size=2).modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    domain = modifier.domain_settings
    domain.domain_type, domain.resolution_max, domain.use_mesh = "LIQUID", 16, True
    domain.cache_type, domain.cache_frame_end = "ALL", 6
    save("fluid")
    domain.cache_directory = "//water"
    bpy.ops.fluid.bake_all()


FILES = (
    *(
        good,
        script_on_load,
        python_driver,
        other_frames,
        unbaked,
        missing_library,
        many_instances,
        heavy,
        on_disk,
    ),
    fluid,
)


def main():
    for make in FILES:
        make()
        save(make.__name__)
    os.unlink(os.path.join(PLACE, "library.blend"))
    # The fluid's file where its cache has been moved beside it, and says that it is elsewhere.
    moved = os.path.join(PLACE, "moved")
    os.mkdir(moved)
    get("Water").modifiers[0].domain_settings.cache_directory = os.path.join(PLACE, "gone", "water")
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(moved, "fluid.blend"), copy=True)
    shutil.copytree(os.path.join(PLACE, "water"), os.path.join(moved, "water"))
    for name in os.listdir(PLACE):
        if name == "executed" or name.endswith(".blend1"):
            os.unlink(os.path.join(PLACE, name))
    finish({})


main()
