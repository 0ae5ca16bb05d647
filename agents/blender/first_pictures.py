"""Draws what the tools draw, so that the shaders for it are compiled, and can be kept for other Blenders."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from agents.blender.tools import execute, motion_sheet, previews, render, uv_preview, verify
from agents.blender.tools.base import Call, ToolContext, parse, perform
from simworlds.sandbox.shader_cache import keep_shaders

if TYPE_CHECKING:
    from agents.blender.supervisor import Supervisor
    from agents.blender.tools.base import BlenderTool

_SCENE = """\
import bpy
bpy.ops.mesh.primitive_cube_add()
bpy.ops.object.light_add(type="SUN")
bpy.ops.object.camera_add(location=(0, 0, 9))
bpy.context.scene.camera = bpy.context.object
bpy.context.scene.render.engine = "BLENDER_WORKBENCH"
"""


def _no_docs(query: str, *, max_tokens: int = 400) -> str:
    del query, max_tokens
    return ""


def keep_drawn(blender: Supervisor) -> int:
    """Keeps the shaders of a Blender that ran nothing but SimWorlds' own code; returns how many files there are.

    Its scene is a cube afterwards. Raises BlenderError, OSError.
    """
    context = ToolContext(blender, _no_docs)
    drawn: tuple[tuple[BlenderTool, dict[str, Any]], ...] = (
        (execute.TOOL, {"code": _SCENE}),
        (previews.SCENE_LAYOUT, {}),
        (uv_preview.TOOL, {}),
        (motion_sheet.TOOL, {"actors": ["Cube"]}),
        (render.TOOL, {"width": 64, "samples": 1}),
        (verify.TOOL, {"image": True}),
    )
    for tool, arguments in drawn:
        perform(tool, context, parse(tool, arguments), Call())
    return keep_shaders(blender.launch.private)
