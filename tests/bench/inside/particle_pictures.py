"""Scenes for the pictures of what is checked of particles."""

import math

import bpy
from making import add, bake
from picture_parts import A, B, Shot, ball, box, coloured, solid


def grains(source, count=120):
    """Grains that leave a surface in the first frames, without a push; the settings."""
    seed = ball("Seed", (5, 0, -1), 0.04, A)
    source.modifiers.new("Grains", "PARTICLE_SYSTEM")
    system = source.particle_systems[0]
    system.point_cache.frame_end = 30
    settings = system.settings
    settings.count, settings.lifetime, settings.frame_start, settings.frame_end = count, 60, 1, 10
    settings.particle_size, settings.normal_factor = 1.0, 0.0
    settings.render_type, settings.instance_object = "OBJECT", seed
    return settings


def plate(place, size=0.5):
    return coloured(add("plane", "A", place, size=size), A)


def fountain(count):
    settings = grains(plate((0, 0, 0.01)), count)
    settings.normal_factor, settings.factor_random = 4.0, 0.7
    settings.frame_end = 24


def particle_system(holds):
    if holds:
        fountain(200)
        bake()
    else:
        plate((0, 0, 0.01))


def particle_type(holds):
    settings = grains(ball("A", (0, 0, 0.55), 0.3, A), 500)
    if holds:
        settings.type, settings.render_type, settings.hair_length = "HAIR", "PATH", 0.25
    else:
        settings.count, settings.normal_factor = 150, 0.5
    bake()


def particle_source(holds):
    fountain(200 if holds else 8)
    bake()


def particle_cache_baked(holds):
    fountain(200)
    if holds:
        bake()
        return
    for frame in range(1, 9):
        bpy.context.scene.frame_set(frame)
    source = bpy.data.objects["A"]
    cache = source.particle_systems[0].point_cache
    with bpy.context.temp_override(object=source, point_cache=cache):  # a shorter range would be set back
        bpy.ops.ptcache.bake_from_cache()


def particle_collision_partners(holds):
    shelf = box("B", (0, 0, 0.45), (0.9, 0.9, 0.08), B)
    if holds:
        solid(shelf).collision.damping_factor = 0.9
    grains(plate((0, 0, 1.0)))
    bake()


def particle_from_deformed(holds):
    strip = coloured(add("grid", "A", (0, 0, 0.05), size=1.4, x_subdivisions=40, y_subdivisions=10), B)
    strip.scale.y = 0.4
    strip.data.shade_smooth()
    arch = strip.vertex_groups.new(name="Arch")
    for vertex in strip.data.vertices:
        arch.add([vertex.index], 1 - (vertex.co.x / 0.7) ** 2, "REPLACE")
    settings = grains(strip, 150)
    settings.frame_end, settings.physics_type = 1, "NO"
    raised = strip.modifiers.new("Raised", "DISPLACE")
    raised.direction, raised.mid_level, raised.strength, raised.vertex_group = "Z", 0, 0.7, arch.name
    if holds:
        bpy.context.view_layer.objects.active = strip
        bpy.ops.object.modifier_move_to_index(modifier="Raised", index=0)
    bake()


def particle_force_fields(holds):
    fan = coloured(add("cylinder", "B", (-0.8, 0, 0.6), radius=0.45, depth=0.1), B)
    fan.rotation_euler.y = math.radians(90)
    bpy.ops.object.forcefield_toggle()
    fan.field.type, fan.field.strength = "WIND", 12 if holds else 0
    grains(plate((0, 0, 1.2), 0.3)).frame_end = 26
    bake()


SHOTS = {
    "particle_system": Shot(particle_system, (26,)),
    "particle_type": Shot(particle_type, (14,)),
    "particle_source": Shot(particle_source, (26,)),
    "particle_cache_baked": Shot(particle_cache_baked, (8, 26)),
    "particle_collision_partners": Shot(particle_collision_partners, (30,)),
    "particle_from_deformed": Shot(particle_from_deformed, (4,)),
    "particle_force_fields": Shot(particle_force_fields, (26,), look=(0.1, 0, 0.6)),
}
