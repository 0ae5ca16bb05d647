"""Scenes for the pictures of what is checked of particles."""

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


def particle_collision_partners(holds):
    shelf = box("B", (0, 0, 0.45), (0.9, 0.9, 0.08), B)
    if holds:
        solid(shelf).collision.damping_factor = 0.9
    grains(plate((0, 0, 1.0)))
    bake()


SHOTS = {
    "particle_collision_partners": Shot(particle_collision_partners, (30,)),
}
