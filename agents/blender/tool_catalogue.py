"""The tools of a Blender of the server's own, and how models are told to work with them.

``TOOLS`` is in the order in which clients list them (paper, Table "Tool suite"), ``HABITS`` in that in which a scene is
made: not every tool is a habit, and not every habit is one of these tools.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.blender.tools import (
    assets,
    bake,
    execute,
    export_file,
    fetch_assets,
    files,
    group,
    import_file,
    job,
    material_preview,
    motion_sheet,
    previews,
    render,
    scene_state,
    tag,
    trial,
    uv_preview,
    verify,
)

if TYPE_CHECKING:
    from agents.blender.tools.base import BlenderTool

TOOLS: tuple[BlenderTool, ...] = (
    scene_state.TOOL,
    *previews.TOOLS,
    material_preview.TOOL,
    uv_preview.TOOL,
    motion_sheet.TOOL,
    execute.TOOL,
    tag.TOOL,
    group.TOOL,
    verify.TOOL,
    files.SAVE,
    files.LOAD,
    import_file.TOOL,
    export_file.TOOL,
    trial.TOOL,
    bake.TOOL,
    render.TOOL,
)
FOR_CLIENTS: tuple[BlenderTool, ...] = (job.TOOL,)
"""Further ones for clients that wait for a reply for some minutes only; the agent loop waits as long as it takes."""
# Listed only where the server has what they need.
WITH_ASSETS = assets.TOOL
ONLINE = fetch_assets.TOOL
BY_NAME = {tool.name: tool for tool in (*TOOLS, *FOR_CLIENTS, WITH_ASSETS, ONLINE)}
assert len(BY_NAME) == len(TOOLS) + len(FOR_CLIENTS) + 2, "a tool is listed twice"
OPENING = (
    "You have your own live Blender, without a window. The scene stays from call to call. If Blender crashes or hangs, "
    "it is restarted from the last checkpoint, which the error names: read the scene's state before you go on. Lengths "
    "are in metres, angles in Python in radians."
)
HABITS = (
    ("blender_plan_check", "for a whole scene: write its plan first and check it; the prompt make_scene says how"),
    ("blender_docs", "before you use an API name that you have not looked up for this version, when you begin "
     "a topic (cloth, materials), and on any error that is still unclear"),
    execute.TOOL.told,
    ("blender_check", "for scripts and add-ons that you write to files; blender_execute checks its code by itself"),
    scene_state.TOOL.told,
    previews.SINGLE_MESH.told,
    previews.SCENE_LAYOUT.told,
    material_preview.TOOL.told,
    uv_preview.TOOL.told,
    trial.TOOL.told,
    bake.TOOL.told,
    motion_sheet.TOOL.told,
    assets.TOOL.told,
    files.SAVE.told,
    render.TOOL.told,
    job.TOOL.told,
)  # fmt: skip
