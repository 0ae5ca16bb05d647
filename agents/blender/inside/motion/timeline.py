# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes the open scene to frames without spoiling its simulations: what is not baked is stepped, never jumped."""

import contextlib

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.simulation_zones import objects_with_zones
from ..blend.visibility import as_rendered
from ..physics import stepped_frames
from ..physics.finite_check import DivergenceWatch

_MOST_FRAMES = 5000


def go_to_frame(arguments, report):
    """Takes the scene to ``frame`` (None: it stays): in one jump, or step by step if a simulation is not baked.

    Returns the ``scene``'s name and its current ``frame``. Raises Refused if that needs too many frames, and Diverged.
    """
    scene, frame = bpy.context.scene, arguments["frame"]
    if frame is not None and frame != scene.frame_current:
        stepper = FrameStepper(scene, frame)
        count = stepper.count([frame])
        if count > _MOST_FRAMES:
            raise Refused(
                f"Going to frame {frame} would simulate {count} frames, more than {_MOST_FRAMES}: bake first."
            )
        for _ in stepper.through([frame], lambda at: report(at - frame + count, count, f"frame {at}")):
            pass
    return {"scene": scene.name, "frame": scene.frame_current}


class FrameStepper:
    """Visits frames of a scene in order, and goes back to the frame before at the end of ``with``.

    No simulated frame is skipped: if a cache of the scene is not baked, every frame from its start, ``stepped_from``,
    is visited, unless the caches still hold these frames; ``stepped_for`` names such caches. Where nothing is
    simulated, which hiding may change, objects that keys hide in the viewport are where renders show them.
    """

    def __init__(self, scene, first):
        self._scene = scene
        waiting = [(cache.label, cache.range[0]) for cache in stepped_frames.waiting_caches(scene)]
        waiting += [
            (f"simulation nodes of {obj.name!r}", scene.frame_start) for obj in objects_with_zones(scene)
        ]
        self.stepped_for = [label for label, _ in waiting]
        self.stepped_from = min([first, *(start for _, start in waiting)]) if waiting else None

    def __enter__(self):
        self._frame, self._subframe = self._scene.frame_current, self._scene.frame_subframe
        self._shown = contextlib.ExitStack()
        if self.stepped_from is None:
            self._shown.enter_context(as_rendered(self._scene))
        return self

    def __exit__(self, *error):
        self._shown.close()
        self._scene.frame_set(self._frame, subframe=self._subframe)

    def count(self, frames):
        """How many frames must be visited to measure ``frames``."""
        return len(self._steps(frames))

    def _steps(self, frames):
        if self.stepped_from is None or not frames:
            return frames
        held = stepped_frames.last_held(self._scene)
        if held is not None and frames[-1] <= held:
            return frames
        return range(self.stepped_from, frames[-1] + 1)

    def through(self, frames, visiting):
        """Yields (frame, evaluated dependency graph) for each of the sorted ``frames``.

        Calls ``visiting(frame)`` before each frame that it visits. Raises Diverged at the first frame at which a
        simulation is not finite.
        """
        wanted, steps = set(frames), self._steps(frames)
        simulates = isinstance(steps, range)
        if simulates and stepped_frames.last_held(self._scene) is None:
            stepped_frames.restart(self._scene)  # else Blender would use the state after a jump as a result
        watch, done = DivergenceWatch(self._scene), None
        try:
            for frame in steps:
                visiting(frame)
                self._scene.frame_set(frame)
                graph = bpy.context.evaluated_depsgraph_get()
                watch.check(frame, graph)
                done = frame
                if frame in wanted:
                    yield frame, graph
        finally:
            if simulates and done is not None:
                stepped_frames.note(self._scene, steps[0], done)
