# SPDX-License-Identifier: GPL-3.0-or-later
"""Taking the open scene to a frame, in a way that leaves simulations right."""

import bpy

from simworlds.sandbox.inside.refusal import Refused

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
