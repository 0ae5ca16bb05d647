"""Gives a scene the render settings of its plan, so that whoever opens the file and renders gets what was planned."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agents.plan.scene import RenderSettings

_ENGINES = {"BLENDER_EEVEE": ("BLENDER_EEVEE", "BLENDER_EEVEE_NEXT")}  # the second in 4.2 to 4.5
_SAMPLES = {"CYCLES": "scene.cycles.samples", "BLENDER_EEVEE": "scene.eevee.taa_render_samples"}
_CODE = """\
import bpy

scene = bpy.context.scene
render = scene.render
for engine in {engines}:
    try:
        render.engine = engine
        break
    except TypeError:  # not of this Blender
        pass
render.resolution_x, render.resolution_y = {width}, {height}
render.resolution_percentage = 100
render.filepath = "//renders/"  # beside the file, wherever that is
"""


def code_of(planned: RenderSettings, samples: int) -> str:
    """Code that gives the open scene the engine, size and ``samples`` of its plan, and a place for its pictures."""
    width, height = planned.resolution
    engines = _ENGINES.get(planned.engine, (planned.engine,))
    code = _CODE.format(engines=engines, width=width, height=height)
    setting = _SAMPLES.get(planned.engine)
    return f"{code}{setting} = {samples}\n" if setting else code
