"""Scenes for the pictures of what is checked of cloth, and of actors of every kind."""

from making import add, bake, cloth_on
from picture_parts import A, B, Shot, ball, box, coloured, solid


def sheet(name, place, colour, size=1.3):
    thing = coloured(add("grid", name, place, size=size, x_subdivisions=32, y_subdivisions=32), colour)
    thing.data.shade_smooth()
    return thing


def renderable(holds):
    box("B", (0, 0, 0), (0.8, 0.8, 0.5), B)
    ball("A", (0, 0, 0.75), 0.25, A).hide_render = not holds


def cloth_collision_partners(holds):
    table = box("B", (0, 0, 0), (0.8, 0.8, 0.6), B)
    if holds:
        solid(table)
    cloth_on(sheet("A", (0, 0, 0.8), A), 30)
    bake()


SHOTS = {
    "renderable": Shot(renderable),
    "cloth_collision_partners": Shot(cloth_collision_partners, (30,)),
}
