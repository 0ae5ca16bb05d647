# SPDX-License-Identifier: GPL-3.0-or-later
"""Render settings and camera that all scenes of BlenderBench have in common."""

import bpy

_CAMERA = "Camera1"  # of the set's own renders, whatever the scene's camera is


def prepare(width, height, samples):
    """Sets Cycles and the goal's size. Runs before a task's start.py, which may set something else."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.cycles.samples = samples


def choose_camera():
    """Makes the camera of the set's renders the scene's, if it exists. Runs after start.py."""
    scene = bpy.context.scene
    camera = scene.objects.get(_CAMERA)
    if camera is not None and camera.type == "CAMERA":
        scene.camera = camera
