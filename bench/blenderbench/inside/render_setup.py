# SPDX-License-Identifier: GPL-3.0-or-later
"""What all renders of BlenderBench have in common; sent to the confined Blender as code, a call at its end."""

import bpy

_CAMERA = "Camera1"  # what the set's own renders are taken with, whatever the scene's camera is


def settle(width, height, samples):
    """Before a task's start.py, which may set something else: Cycles, the goal's size, RGB."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.cycles.samples = samples


def look_through():
    """After start.py: the scene's camera is the one of the set's renders, if there is one of that name."""
    scene = bpy.context.scene
    camera = scene.objects.get(_CAMERA)
    if camera is not None and camera.type == "CAMERA":
        scene.camera = camera
