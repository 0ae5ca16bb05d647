"""Makes two scenes for each picture of the audit's pages, one in which it holds and one in which not, and renders both.

Names of pictures may be given: only these are made. The result: {NAME or NAME_not: [.blend, [.png of each frame]]}. In
each scene, the actors are the objects ``A`` and ``B``.
"""

import sys

import body_pictures
import bpy
import cheat_pictures
import cloth_pictures
import fluid_pictures
import particle_pictures
import relation_pictures
from making import finish, new, save
from picture_parts import camera, floor, render

SHOTS = (
    relation_pictures.SHOTS
    | cloth_pictures.SHOTS
    | body_pictures.SHOTS
    | particle_pictures.SHOTS
    | fluid_pictures.SHOTS
    | cheat_pictures.SHOTS
)


def main():
    made = {}
    for name in sys.argv[3:] or SHOTS:
        shot = SHOTS[name]
        for holds in (True, False):
            key = name if holds else f"{name}_not"
            new(30)
            floor()
            shot.build(holds)
            camera(shot)
            bpy.context.view_layer.update()
            made[key] = [save(key), render(shot, key)]
    finish(made)


main()
