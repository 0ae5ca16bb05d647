"""For each predicate a scene in which it holds, and one after a change that ends that: ``NAME``, ``NAME/broken``."""

import os
import shutil

import bpy
from making import FRAMES, PLACE, add, bake, body, cloth_on, empty, finish, get, keys, new, read, save

from bench.validity.mutations.inside import changes


def weigh(thing, name):
    """A vertex group with weights."""
    group = thing.vertex_groups.new(name=name)
    group.add([0, 1], 1.0, "REPLACE")
    return name


def cloth():
    new()
    add("cube", "Table").modifiers.new("Collision", "COLLISION")
    sheet = add("grid", "Sheet", (0, 0, 1.3), size=2, x_subdivisions=8, y_subdivisions=8)
    modifier = cloth_on(sheet)
    modifier.settings.vertex_group_mass = weigh(sheet, "Pins")
    modifier.collision_settings.use_self_collision = True
    bake()


def soft():
    new()
    jelly = add("cube", "Jelly")
    jelly.data.edges.add(1)
    jelly.data.edges[-1].vertices = 0, 7  # a strut, from corner to corner
    modifier = jelly.modifiers.new("Softbody", "SOFT_BODY")
    modifier.point_cache.frame_end = FRAMES
    modifier.settings.vertex_group_goal = weigh(jelly, "Held")
    modifier.settings.use_goal = True
    block = add("cube", "Block", (0, 0, 3))
    body(block)
    block.modifiers.new("Collision", "COLLISION")
    bake()


def rigid():
    new()
    body(add("plane", "Floor", size=10), "PASSIVE")
    for name, x in (("Left", -2), ("Right", 2)):
        thing = add("cube", name, (x, 0, 3))
        body(thing).mass = 2
        thing.rigid_body.collision_shape = "BOX"
        thing.modifiers.new("Collision", "COLLISION")
    joint = empty("Hinge", (0, 0, 3))
    bpy.ops.rigidbody.constraint_add(type="HINGE")
    tie = joint.rigid_body_constraint
    tie.object1, tie.object2, tie.disable_collisions = get("Left"), get("Right"), True
    bake()


def particles():
    new()
    flag = add("grid", "Flag", size=2, x_subdivisions=8, y_subdivisions=8)
    cloth_on(flag).settings.vertex_group_mass = weigh(flag, "Pins")
    flag.modifiers.new("Dust", "PARTICLE_SYSTEM")
    system = flag.particle_systems[0]
    system.settings.count, system.settings.lifetime = 30, 20
    system.settings.frame_start, system.settings.frame_end = 4, 8
    system.point_cache.frame_end = FRAMES
    add("cube", "Wall", (3, 0, 0)).modifiers.new("Collision", "COLLISION")
    bpy.ops.object.effector_add(type="WIND", location=(0, 0, -2))
    bpy.context.object.name = "Wind"
    bpy.ops.object.effector_add(type="TURBULENCE")
    bpy.context.object.name = "Gust"
    keys(get("Gust"), "field.strength", [0.0, 5.0], [1, FRAMES])
    bpy.context.scene.frame_set(1)
    bake()


def fluid():
    new(8)
    tap = add("ico_sphere", "Tap", (0, 0, 0.5), radius=0.3)
    flow = tap.modifiers.new("Fluid", "FLUID")
    flow.fluid_type = "FLOW"
    flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = "LIQUID", "INFLOW"
    paddle = add("cube", "Paddle", (0, 0, -0.5), size=0.4)
    effector = paddle.modifiers.new("Fluid", "FLUID")
    effector.fluid_type = "EFFECTOR"
    keys(paddle, "location", [(0, 0, -0.5), (0.4, 0, -0.5)], [1, 8])
    water = add("cube", "Water", size=2)
    modifier = water.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    domain = modifier.domain_settings
    domain.domain_type, domain.resolution_max, domain.use_mesh = "LIQUID", 32, True
    domain.cache_type, domain.cache_frame_end = "ALL", 8
    save("fluid")
    domain.cache_directory = "//water"
    bpy.ops.fluid.bake_all()


def guided():
    new(8)
    guide = add("cube", "Guide", size=0.5)
    effector = guide.modifiers.new("Fluid", "FLUID")
    effector.fluid_type = "EFFECTOR"
    effector.effector_settings.effector_type = "GUIDE"
    smoke = add("cube", "Smoke", size=2)
    modifier = smoke.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    domain = modifier.domain_settings
    domain.cache_type, domain.use_guide, domain.guide_source = "MODULAR", True, "EFFECTOR"


def recorded():
    new()
    ball = add("cube", "Ball")
    keys(ball, "location", [(0, 0, 0.1 * frame) for frame in range(1, 13)], range(1, 13))


def blended():
    new()
    slab = add("cube", "Slab")
    slab.shape_key_add(name="Basis")
    squashed = slab.shape_key_add(name="Squashed")
    squashed.data[0].co.z -= 1
    keys(squashed, "value", [0.0, 1.0], [1, 12])


def broken(change, *names, **options):
    """A change of objects, as the proofs make it."""
    return lambda: changes.mutate(change, list(names), options)


def no_world():
    bpy.ops.rigidbody.world_remove()


def lose_files():
    """The flags of the bake stay; the files of half the frames are gone."""
    for folder in ("data", "mesh"):
        place = os.path.join(os.path.dirname(bpy.data.filepath), "water", folder)
        for name in sorted(os.listdir(place))[:5]:
            os.unlink(os.path.join(place, name))


def fewer_keys():
    thing = get("Ball")
    thing.animation_data_clear()
    keys(thing, "location", [(0, 0, 0), (0, 0, 1)], [1, 12])


def no_blend():
    get("Slab").data.shape_keys.animation_data_clear()


CLOTH, SOFT, DUST = {"types": ["CLOTH"]}, {"types": ["SOFT_BODY"]}, {"types": ["PARTICLE_SYSTEM"]}
COLLISION, FLUID = {"types": ["COLLISION"]}, {"types": ["FLUID"]}
# Predicate → the scene in which it holds, and what ends that.
CASES = {
    "renderable": (cloth, broken("hide_in_render", "Sheet")),
    "solver_enabled": (cloth, broken("switch_off", "Sheet", **CLOTH)),
    "cloth_modifier": (cloth, broken("remove_modifier", "Sheet", **CLOTH)),
    "cloth_cache_baked": (cloth, broken("free_bake", "Sheet", **CLOTH)),
    "cloth_self_collision": (
        cloth,
        broken("set_value", "Sheet", **CLOTH, path="collision_settings.use_self_collision", value=False),
    ),
    "cloth_pin_group": (cloth, broken("clear_group", "Sheet", **CLOTH, path="settings.vertex_group_mass")),
    "cloth_collision_partners": (cloth, broken("remove_modifier", "Table", **COLLISION)),
    "soft_modifier": (soft, broken("remove_modifier", "Jelly", **SOFT)),
    "soft_cache_baked": (soft, broken("free_bake", "Jelly", **SOFT)),
    "soft_collision_partners": (soft, broken("switch_off", "Block", **COLLISION, where="show_viewport")),
    "soft_goal_group": (soft, broken("set_value", "Jelly", **SOFT, path="settings.use_goal", value=False)),
    "soft_rigid_partners": (soft, no_world),
    "rigid_settings": (rigid, broken("remove_body", "Left")),
    "rigid_type": (rigid, broken("swap_body_type", "Left")),
    "rigid_shape": (rigid, broken("change_shape", "Left", shapes=[])),
    "rigid_world_populated": (rigid, broken("remove_from_world", "Floor", "Left", "Right")),
    "rigid_cache_baked": (rigid, broken("free_world_bake")),
    "rigid_constraint": (rigid, broken("detach_constraint", "Left")),
    "rigid_constraint_no_collision": (rigid, broken("enable_constraint_collisions", "Left")),
    "rigid_collision_modifier": (rigid, broken("remove_modifier", "Left", **COLLISION)),
    "rigid_positive_mass": (rigid, broken("set_body", "Left", attribute="mass", value=0.0)),
    "particle_system": (particles, broken("remove_modifier", "Flag", **DUST)),
    "particle_type": (
        particles,
        broken("set_value", "Flag", **DUST, path="particle_system.settings.type", value="HAIR"),
    ),
    "particle_source": (
        particles,
        broken("set_value", "Flag", **DUST, path="particle_system.settings.count", value=0),
    ),
    "particle_cache_baked": (particles, broken("free_bake", "Flag", **DUST)),
    "particle_collision_partners": (particles, broken("remove_modifier", "Wall", **COLLISION)),
    "particle_from_deformed": (particles, broken("move_first", "Flag", **DUST)),
    "particle_force_fields": (particles, broken("remove_field_strength", "Wind")),
    "fluid_modifier": (fluid, broken("remove_modifier", "Water", **FLUID)),
    "fluid_type": (fluid, broken("swap_fluid_type", "Tap", kind="FLOW")),
    "fluid_domain_exists": (fluid, broken("move_out_of_domain", "Tap")),
    "fluid_flow_count": (fluid, broken("close_flows", flows=["Tap"], least=1)),
    "fluid_dynamic_effector": (fluid, broken("remove_keys", "Paddle")),
    "fluid_guiding": (guided, broken("disable_guiding")),
    "fluid_resolution": (fluid, broken("lower_resolution", "Water", least=32)),
    "fluid_mesh": (
        fluid,
        broken("set_value", "Water", **FLUID, path="domain_settings.use_mesh", value=False),
    ),
    "fluid_cache_baked": (fluid, lose_files),
    "dense_transform_keys": (recorded, fewer_keys),
    "animated_shape_keys": (blended, no_blend),
    "static_has_cache": (cloth, broken("free_bake", "Sheet", **CLOTH)),
    "static_has_rigid_world": (rigid, no_world),
    "static_has_solver": (cloth, broken("remove_modifier", "Sheet", **CLOTH)),
}


def with_its_files(make, change):
    """What is read after a change; files of a fluid that the change takes away are put back afterwards."""
    files = os.path.join(PLACE, "water")
    kept = f"{files}_kept"
    if make is fluid:
        shutil.copytree(files, kept)
    try:
        return read(os.path.join(PLACE, f"{make.__name__}.blend"), change)
    finally:
        if make is fluid:
            bpy.ops.wm.read_factory_settings(use_empty=True)
            shutil.rmtree(files)
            os.rename(kept, files)


def main():
    found = {}
    for name, (make, change) in CASES.items():
        if make.__name__ not in found:
            make()
            found[make.__name__] = read(save(make.__name__))
        found[name] = found[make.__name__]
        found[f"{name}/broken"] = with_its_files(make, change)
    finish(found)


main()
