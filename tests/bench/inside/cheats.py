"""Motion that is recorded, and motion that is not: one scene each, with one object, ``Thing``."""

import os

import bpy
from making import PLACE, add, body, empty, finish, get, keys, new, read, save

EVERY = range(1, 13)


def thing():
    new()
    return add("cube", "Thing")


def rising(one, frames=EVERY):
    keys(one, "location", [(0, 0, 0.1 * frame) for frame in frames], frames)


def each_frame():
    rising(thing())


def turned_each_frame():
    keys(thing(), "rotation_euler", [(0, 0, 0.1 * frame) for frame in EVERY], EVERY)


def layered_strip():
    one = thing()
    rising(one)
    action = one.animation_data.action
    slot = one.animation_data.action_slot
    one.animation_data.action = None
    strip = one.animation_data.nla_tracks.new().strips.new("Rise", 1, action)
    strip.action_slot = slot


def driven_by_time():
    thing().driver_add("location", 2).driver.expression = "frame * 0.1"


def driven_to_a_constant():
    thing().driver_add("location", 2).driver.expression = "2.5"


def driven_by_python():
    thing().driver_add("location", 2).driver.expression = "__import__('math').sin(frame)"


def noisy():
    one = thing()
    keys(one, "location", [(0, 0, 0)], [1])
    curves(one)[2].modifiers.new("NOISE")


def curves(one):
    animated = one.animation_data
    return animated.action.layers[0].strips[0].channelbag(animated.action_slot).fcurves


def sampled():
    one = thing()
    keys(one, "location", [(0, 0, 0), (0, 0, 5)], [1, 12])
    for curve in curves(one):
        curve.convert_to_samples(1, 12)


def carried():
    one, carrier = thing(), empty("Carrier")
    one.parent = carrier
    rising(carrier)


def carried_and_simulated():
    one, carrier = thing(), empty("Carrier")
    one.parent = carrier
    rising(carrier)
    body(one)


def simulated_and_recorded():
    one = thing()
    rising(one)
    body(one)


def copied():
    one, leader = thing(), empty("Leader")
    rising(leader)
    one.constraints.new("COPY_LOCATION").target = leader


def on_a_path():
    one = thing()
    bpy.ops.curve.primitive_nurbs_path_add()
    path = bpy.context.object
    constraint = one.constraints.new("FOLLOW_PATH")
    constraint.target, constraint.use_fixed_location = path, True
    keys(one, 'constraints["Follow Path"].offset_factor', [0.0, 1.0], [1, 12])


def posed():
    keys(thing(), "location", [(0, 0, 0), (0, 0, 1), (0, 0, 2)], [1, 6, 12])


def pushed():
    keys(thing(), "location", [(0, 0, 0), (0.1, 0, 0), (0.2, 0, 0), (0.4, 0, 0)], [1, 2, 3, 4])


def held_still():
    keys(thing(), "location", [(0, 0, 1)] * 12, EVERY)


def beyond_the_clip():
    one = thing()
    rising(one, range(40, 80))


def muted():
    one = thing()
    rising(one)
    for curve in curves(one):
        curve.mute = True


# The surface


def shaped():
    one = thing()
    one.shape_key_add(name="Basis")
    key = one.shape_key_add(name="Squashed")
    key.data[0].co.z -= 1
    return one, key


def blended():
    keys(shaped()[1], "value", [0.0, 1.0], [1, 12])


def blended_by_a_driver():
    shaped()[1].driver_add("value").driver.expression = "frame * 0.05"


def run_through():
    one, _ = shaped()
    shapes = one.data.shape_keys
    shapes.use_relative = False
    keys(shapes, "eval_time", [0.0, 10.0], [1, 12])


def shaped_and_still():
    shaped()[1].value = 0.5


def points_keyed():
    one = thing()
    keys(one.data.vertices[0], "co", [(0, 0, 0), (0, 0, 3)], [1, 12])


def from_a_mesh_cache():
    modifier = thing().modifiers.new("Cache", "MESH_CACHE")
    modifier.filepath = os.path.join(PLACE, "none.mdd")


def from_a_hidden_mesh_cache():
    from_a_mesh_cache()
    modifier = get("Thing").modifiers[0]
    modifier.show_viewport = modifier.show_render = False


def from_alembic():
    one = thing()
    rising(one)
    path = os.path.join(PLACE, "thing.abc")
    bpy.ops.wm.alembic_export(filepath=path, start=1, end=12)
    new()
    bpy.ops.wm.alembic_import(filepath=path)
    imported = next(one for one in bpy.data.objects if one.type == "MESH")
    imported.name = "Thing"


SCENES = (
    *(
        each_frame,
        turned_each_frame,
        layered_strip,
        driven_by_time,
        driven_to_a_constant,
        driven_by_python,
        noisy,
    ),
    *(
        sampled,
        carried,
        carried_and_simulated,
        simulated_and_recorded,
        copied,
        on_a_path,
        posed,
        pushed,
        held_still,
    ),
    *(beyond_the_clip, muted, blended, blended_by_a_driver, run_through, shaped_and_still, points_keyed),
    *(from_a_mesh_cache, from_a_hidden_mesh_cache, from_alembic),
)


def main():
    found = {}
    for make in SCENES:
        make()
        found[make.__name__] = read(save(make.__name__))
    finish(found)


main()
