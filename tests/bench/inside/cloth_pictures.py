"""Scenes for the pictures of what is checked of cloth, and of actors of every kind."""

import math

from making import add, bake, cloth_on, get
from picture_parts import DARK, A, B, Shot, ball, box, coloured, group, solid


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


def flap(held=1.3, turn=0.12, free=1.0, width=0.7):
    """A strip of cloth in two colours: a level part of the length ``held``, and a flap that turns back over it."""
    thing = add("grid", "A", (0, 0, 0.7), size=1, x_subdivisions=67, y_subdivisions=16)
    coloured(coloured(thing, B), A)
    whole = held + math.pi * turn + free
    for face in thing.data.polygons:
        face.material_index = int((face.center.x + 0.5) * whole > held)
    for vertex in thing.data.vertices:
        way = (vertex.co.x + 0.5) * whole
        angle = min(max(way - held, 0) / turn, math.pi)
        along = min(way, held) - max(way - held - math.pi * turn, 0)
        vertex.co = (
            along - held / 2 + turn * math.sin(angle),
            vertex.co.y * width,
            turn * (1 - math.cos(angle)),
        )
    thing.data.shade_smooth()
    return thing


def cloth_self_collision(holds):
    solid(get("Floor"))
    for name, x in (("B", -0.65), ("Bar", 0.65)):
        box(name, (x, 0, 0.67), (0.05, 0.9, 0.05), DARK)
    thing = flap()
    pins = group(thing, "Pins", lambda place: abs(place.z) < 0.001 and abs(place.x) > 0.62)
    cloth = cloth_on(thing, 30)
    cloth.settings.vertex_group_mass = pins
    cloth.settings.quality = 8
    cloth.collision_settings.collision_quality = 4
    cloth.collision_settings.use_self_collision = holds
    cloth.collision_settings.self_distance_min = 0.012
    bake()


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
    "cloth_self_collision": Shot(cloth_self_collision, (1, 30), look=(0, 0, 0.5)),
    "cloth_pin_group": Shot(cloth_pin_group, (30,), look=(0, 0, 0.6)),
    "cloth_collision_partners": Shot(cloth_collision_partners, (30,)),
}
