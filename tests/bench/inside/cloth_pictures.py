"""Scenes for the pictures of what is checked of cloth, and of actors of every kind."""

import math

from making import add, bake, cloth_on, get
from picture_parts import A, B, Shot, ball, box, coloured, group, solid


def sheet(name, place, colour, size=1.3):
    thing = coloured(add("grid", name, place, size=size, x_subdivisions=32, y_subdivisions=32), colour)
    thing.data.shade_smooth()
    return thing


def renderable(holds):
    box("B", (0, 0, 0), (0.8, 0.8, 0.5), B)
    ball("A", (0, 0, 0.75), 0.25, A).hide_render = not holds


def drape(height=0.8, last=30, *, is_cloth=True):
    """A sheet above a solid table; if it is cloth, it is baked up to the frame ``last``."""
    solid(box("B", (0, 0, 0), (0.8, 0.8, 0.6), B))
    thing = sheet("A", (0, 0, height), A)
    if is_cloth:
        cloth_on(thing, last)
        bake()


def solver_enabled(holds):
    drape()
    get("A").modifiers["Cloth"].show_render = holds


def cloth_modifier(holds):
    drape(is_cloth=holds)


def cloth_cache_baked(holds):
    drape(last=30 if holds else 8)


def cloth_pin_group(holds):
    solid(get("Floor"))
    box("B", (0, 0, 1.1), (1.3, 0.06, 0.06), B)
    thing = sheet("A", (0, -0.25, 0.75), A, 0.9)
    thing.rotation_euler.x = math.radians(55)
    pins = group(thing, "Pins", lambda place: place.y > 0.44)
    cloth_on(thing, 30).settings.vertex_group_mass = pins if holds else ""
    bake()


def cloth_collision_partners(holds):
    table = box("B", (0, 0, 0), (0.8, 0.8, 0.6), B)
    if holds:
        solid(table)
    cloth_on(sheet("A", (0, 0, 0.8), A), 30)
    bake()


SHOTS = {
    "renderable": Shot(renderable),
    "solver_enabled": Shot(solver_enabled, (30,)),
    "cloth_modifier": Shot(cloth_modifier, (30,)),
    "cloth_cache_baked": Shot(cloth_cache_baked, (8, 30)),
    "cloth_pin_group": Shot(cloth_pin_group, (30,), look=(0, 0, 0.6)),
    "cloth_collision_partners": Shot(cloth_collision_partners, (30,)),
}
