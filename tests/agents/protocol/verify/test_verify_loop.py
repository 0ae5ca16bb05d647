"""An MCP client alone, from meshes that nobody tagged to a scene that holds, by what the findings say."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import pytest
from mcp import Client
from serving import over_stdio

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [pytest.mark.blender, pytest.mark.anyio]

# A table whose legs end 5 mm above the floor, and an orange that is 15 mm deep in it.
SCENE = """
bpy.ops.wm.read_factory_settings(use_empty=True)
add = bpy.ops.mesh
def called(name):
    bpy.context.object.name = name
add.primitive_cube_add(size=1, location=(0, 0, -0.1), scale=(4, 4, 0.2)); called("Slab")
add.primitive_cube_add(size=1, location=(0, 0, 0.75), scale=(1.2, 0.8, 0.05)); called("Top")
for k, (x, y) in enumerate(((-0.5, -0.3), (0.5, -0.3), (-0.5, 0.3), (0.5, 0.3))):
    add.primitive_cylinder_add(radius=0.03, depth=0.72, location=(x, y, 0.365)); called(f"Leg {k}")
add.primitive_uv_sphere_add(radius=0.1, location=(0, 0, 0.86)); called("Orange")
bpy.ops.object.light_add(type="SUN")
bpy.ops.object.camera_add(location=(3, -3, 2))
bpy.context.scene.camera = bpy.context.object
"""
FLOOR = {"object": "Floor", "system": "ground", "members": ["Slab"]}
TABLE = {"object": "Table", "system": "furniture", "members": ["Top", *(f"Leg {k}" for k in range(4))]}
FRUIT = {"object": "Fruit", "system": "food", "members": ["Orange"]}


async def called(client: Client, tool: str, **arguments: Any) -> dict[str, Any]:
    answer = await client.call_tool(tool, arguments)
    assert not answer.is_error, answer.content
    assert answer.structured_content is not None
    return answer.structured_content


async def found(client: Client) -> dict[str, list[str]]:
    """Rule → what is to be done, of hard findings."""
    told = await called(client, "blender_verify")
    fixes: dict[str, list[str]] = {}
    for one in told["findings"]:
        if one["severity"] == "hard":
            fixes.setdefault(one["rule"], []).append(one["fix"])
    assert told["ok"] is not bool(fixes)
    return fixes


async def moved(client: Client, fix: str) -> None:
    """Moves a root up or down as a finding says."""
    told = re.match(r"Move '(\w+)(?: root)?' ([\d.]+) mm (up|down)", fix)
    assert told is not None, fix
    way = float(told[2]) / 1000 * (1 if told[3] == "up" else -1)
    await called(client, "blender_execute", code=f"bpy.data.objects['{told[1]} root'].location.z += {way}")


async def test_untagged_meshes_become_a_scene_that_holds(tmp_path: Path) -> None:
    async with Client(over_stdio(tmp_path / "home", "--run", str(tmp_path / "run"))) as client:
        await called(client, "blender_execute", code=SCENE)
        assert set(await found(client)) == {"C3", "C6", "V2"}

        await called(client, "blender_group", groups=[FLOOR, {**TABLE, "contact_with": ["Floor"]}, FRUIT])
        fixes = await found(client)
        assert set(fixes) == {"V1", "V2"}
        assert fixes["V1"] == [
            "Move 'Table root' 5.0 mm down (−Z); or remove the declaration if they should not touch."
        ]
        await moved(client, fixes["V1"][0])

        fixes = await found(client)  # the orange is as high as before
        await moved(client, fixes["V2"][0])
        assert await found(client) == {}
