"""Every tool of the suite, in the order in which clients list them (paper, Table "Tool suite")."""

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
