"""Every tool of the suite, in the order in which clients list them (paper, Table "Tool suite")."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.blender.tools import (
    bake,
    execute,
    files,
    group,
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
    trial.TOOL,
    bake.TOOL,
    render.TOOL,
)
FOR_CLIENTS: tuple[BlenderTool, ...] = (job.TOOL,)
"""Further ones for clients that wait for a reply for some minutes only; the agent loop waits as long as it takes."""
BY_NAME = {tool.name: tool for tool in (*TOOLS, *FOR_CLIENTS)}
assert len(BY_NAME) == len(TOOLS) + len(FOR_CLIENTS), "a tool is listed twice"
