# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes the open scene to frames without spoiling its simulations: what is not baked is stepped, never jumped."""

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.simulation_zones import objects_with_zones
from ..physics.caches import renew, unbaked

_MOST_FRAMES = 5000


def stand_at(arguments, report):
    """Takes the scene to ``frame`` (None: it stays): by one jump, or step by step where a simulation is not baked.

    Returns the ``scene``'s name and the ``frame`` that it stands at. Raises Refused where the way is too long.
    """
    scene, frame = bpy.context.scene, arguments["frame"]
    if frame is not None and frame != scene.frame_current:
        starts = [cache["start"] for cache in unbaked(scene) if cache["start"] < frame]
        first = min(starts, default=frame)
        if frame - first > _MOST_FRAMES:
            raise Refused(f"To frame {frame} {frame - first} frames would have to be simulated: bake first.")
        if starts:
            renew(scene)
        for at in range(first, frame + 1):
            report(at - first, frame - first, f"frame {at}")
            scene.frame_set(at)
    return {"scene": scene.name, "frame": scene.frame_current}


class FrameStepper:
    """Goes through frames of a scene in order, and at the end of ``with`` back to where it stood.

    Nothing that is simulated is jumped: where a cache of the scene is not baked, every frame is visited from its
    start on, which is then ``stepped_from``; ``stepped_for`` names such caches.
    """

    def __init__(self, scene, first):
        self._scene = scene
        waiting = [(cache["label"], cache["start"]) for cache in unbaked(scene)]
        waiting += [
            (f"simulation nodes of {obj.name!r}", scene.frame_start) for obj in objects_with_zones(scene)
        ]
        self.stepped_for = [label for label, _ in waiting]
        self.stepped_from = min([first, *(start for _, start in waiting)]) if waiting else None

    def __enter__(self):
        self._frame, self._subframe = self._scene.frame_current, self._scene.frame_subframe
        return self

    def __exit__(self, *error):
        self._scene.frame_set(self._frame, subframe=self._subframe)

    def count(self, frames):
        """How many frames are visited for the sake of these."""
        return len(self._steps(frames))

    def _steps(self, frames):
        if self.stepped_from is None or not frames:
            return frames
        return range(self.stepped_from, frames[-1] + 1)

    def through(self, frames, visiting):
        """(frame, evaluated dependency graph) of each of the ``frames``, which are sorted.

        Calls ``visiting(frame)`` before each that is visited.
        """
        wanted = set(frames)
        for frame in self._steps(frames):
            visiting(frame)
            self._scene.frame_set(frame)
            if frame in wanted:
                yield frame, bpy.context.evaluated_depsgraph_get()
