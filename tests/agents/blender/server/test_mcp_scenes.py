"""A small scene for each solver, made by an MCP client alone: built, baked, looked at, filmed and saved.

``SIMWORLDS_PICTURES`` names a folder for the pictures that come back.
"""

from __future__ import annotations

import os
from base64 import b64decode
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from mcp import Client
from mcp_types import ImageContent, TextContent
from PIL import Image
from serving import over_stdio

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mcp_types import CallToolResult

pytestmark = [pytest.mark.blender, pytest.mark.anyio]

STAGE = """
import bpy, math
from mathutils import Vector
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.frame_start, scene.frame_end = 1, {frames}
scene.render.fps = 24
def coloured(thing, *rgb):
    material = bpy.data.materials.new(thing.name)
    material.diffuse_color = (*rgb, 1)
    material.node_tree.nodes['Principled BSDF'].inputs['Base Color'].default_value = (*rgb, 1)
    thing.data.materials.append(material)
    return thing
def cube(name, size, at, *rgb):
    bpy.ops.mesh.primitive_cube_add(size=1, location=at)
    thing = bpy.context.object
    thing.name, thing.scale = name, size
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    return coloured(thing, *rgb)
def ball(name, radius, at, *rgb):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=at, segments=24, ring_count=16)
    bpy.context.object.name = name
    bpy.ops.object.shade_smooth()
    return coloured(bpy.context.object, *rgb)
camera = bpy.data.objects.new('Camera', bpy.data.cameras.new('Camera'))
scene.collection.objects.link(camera)
camera.location = (4.5, -5.5, 3.5)
camera.rotation_euler = (Vector((0, 0, 0.6)) - camera.location).to_track_quat('-Z', 'Y').to_euler()
scene.camera = camera
sun = bpy.data.objects.new('Sun', bpy.data.lights.new('Sun', 'SUN'))
scene.collection.objects.link(sun)
sun.data.energy, sun.rotation_euler = 3, (.6, .3, .4)
scene.world = bpy.data.worlds.new('World')
scene.world.node_tree.nodes['Background'].inputs['Color'].default_value = (.02, .025, .03, 1)
"""


@dataclass(frozen=True)
class Scene:
    """``build`` makes it, ``judge`` is an expression that must come out true after the bake, at the last frame."""

    frames: int
    build: str
    judge: str
    actor: str


HEIGHTS = """
graph = bpy.context.evaluated_depsgraph_get()
def heights(name):
    thing = bpy.data.objects[name].evaluated_get(graph)
    return [(thing.matrix_world @ vertex.co).z for vertex in thing.data.vertices]
"""

SCENES = {
    "cloth": Scene(
        30,
        """
bpy.ops.mesh.primitive_plane_add(size=8)
floor = coloured(bpy.context.object, .5, .45, .4); floor.name = 'Floor'
floor.modifiers.new('Collision', 'COLLISION')
ball('Ball', .6, (0, 0, .6), .8, .2, .1).modifiers.new('Collision', 'COLLISION')
bpy.ops.mesh.primitive_grid_add(x_subdivisions=28, y_subdivisions=28, size=2.2, location=(0, 0, 1.4))
sheet = coloured(bpy.context.object, .2, .35, .8); sheet.name = 'Sheet'
sheet.modifiers.new('Cloth', 'CLOTH').settings.quality = 6
""",
        "min(heights('Sheet')) > -0.01 and max(heights('Sheet')) > 1.15 and min(heights('Sheet')) < 1.0",
        "Sheet",
    ),
    "rigid body": Scene(
        60,
        """
floor = cube('Floor', (8, 8, .2), (0, 0, -.1), .5, .45, .4)
bpy.ops.rigidbody.object_add(); floor.rigid_body.type = 'PASSIVE'
for number in range(6):
    tile = cube(f'Domino {number}', (.12, .5, 1), (number * .55 - 1.4, 0, .5), .9, .7 - .1 * number, .2)
    bpy.ops.rigidbody.object_add()
    tile.rigid_body.friction = .4
weight = ball('Weight', .25, (-2.3, 0, 1.1), .2, .2, .25)
bpy.ops.rigidbody.object_add()
weight.rigid_body.mass = 6
weight.rigid_body.kinematic = True
weight.keyframe_insert('location', frame=1)
weight.location.x = -1.5
weight.keyframe_insert('location', frame=8)
weight.rigid_body.keyframe_insert('kinematic', frame=8)
weight.rigid_body.kinematic = False
weight.rigid_body.keyframe_insert('kinematic', frame=9)
""",
        "all(bpy.data.objects[f'Domino {n}'].evaluated_get(graph).matrix_world.translation.z < .4 for n in range(6))",
        "Domino 3",
    ),
    "soft body": Scene(
        40,
        """
bpy.ops.mesh.primitive_plane_add(size=8)
floor = coloured(bpy.context.object, .5, .45, .4); floor.name = 'Floor'
floor.modifiers.new('Collision', 'COLLISION')
jelly = ball('Jelly', .6, (0, 0, 1.6), .2, .8, .35)
settings = jelly.modifiers.new('Softbody', 'SOFT_BODY').settings
settings.use_goal, settings.pull, settings.push, settings.bend = False, .9, .9, 2
""",
        "-0.05 < min(heights('Jelly')) < 0.3 and max(heights('Jelly')) < 1.6",
        "Jelly",
    ),
    "particles": Scene(
        40,
        """
bpy.ops.mesh.primitive_plane_add(size=8)
floor = coloured(bpy.context.object, .5, .45, .4); floor.name = 'Floor'
floor.modifiers.new('Collision', 'COLLISION')
grain = ball('Grain', .06, (30, 0, 0), .9, .6, .1)
bpy.ops.mesh.primitive_plane_add(size=1, location=(0, 0, 2))
source = coloured(bpy.context.object, .3, .3, .3); source.name = 'Source'
settings = source.modifiers.new('Grains', 'PARTICLE_SYSTEM').particle_system.settings
settings.count, settings.frame_start, settings.frame_end, settings.lifetime = 150, 1, 20, 200
settings.normal_factor, settings.render_type, settings.instance_object = 0, 'OBJECT', grain
settings.particle_size = 1
""",
        "all(grain.location.z > -.05 for grain in"
        " bpy.data.objects['Source'].evaluated_get(graph).particle_systems[0].particles)",
        "Source",
    ),
    "liquid": Scene(
        20,
        """
box = cube('Tank', (2, 2, 2), (0, 0, 1), .6, .75, .9)
domain = box.modifiers.new('Fluid', 'FLUID')
domain.fluid_type = 'DOMAIN'
domain = domain.domain_settings
domain.domain_type, domain.resolution_max, domain.use_mesh = 'LIQUID', 32, True
drop = ball('Drop', .5, (0, 0, 1.2), .1, .3, .9)
flow = drop.modifiers.new('Fluid', 'FLUID')
flow.fluid_type = 'FLOW'
flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = 'LIQUID', 'GEOMETRY'
drop.hide_render = True
""",
        "sum(heights('Tank')) / len(heights('Tank')) < .8 and min(heights('Tank')) > -.05",
        "Tank",
    ),
    "smoke": Scene(
        20,
        """
box = cube('Air', (2, 2, 3), (0, 0, 1.5), .8, .8, .8)
domain = box.modifiers.new('Fluid', 'FLUID')
domain.fluid_type = 'DOMAIN'
domain = domain.domain_settings
domain.domain_type, domain.resolution_max = 'GAS', 32
tree = box.data.materials[0].node_tree
tree.nodes.remove(tree.nodes['Principled BSDF'])
smoke = tree.nodes.new('ShaderNodeVolumePrincipled')
smoke.inputs['Density'].default_value = 20
tree.links.new(smoke.outputs['Volume'], tree.nodes['Material Output'].inputs['Volume'])
source = ball('Fire', .3, (0, 0, .4), .9, .3, .1)
flow = source.modifiers.new('Fluid', 'FLUID')
flow.fluid_type = 'FLOW'
flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = 'SMOKE', 'INFLOW'
""",
        "max(bpy.data.objects['Air'].evaluated_get(graph).modifiers['Fluid'].domain_settings.density_grid) > .1",
        "",
    ),
}


@pytest.fixture(scope="module")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
async def client(base: Path, tmp_path_factory: pytest.TempPathFactory) -> AsyncIterator[Client]:
    """A client of a server that works in the folder ``run``."""
    async with Client(over_stdio(base.parent.parent), read_timeout_seconds=200) as connected:
        yield connected


async def use(client: Client, tool: str, **arguments: Any) -> CallToolResult:
    answer = await client.call_tool(tool, arguments)
    said = "\n".join(part.text for part in answer.content if isinstance(part, TextContent))
    assert not answer.is_error, said
    return answer


def picture(answer: CallToolResult, name: str) -> Image.Image:
    images = [part for part in answer.content if isinstance(part, ImageContent)]
    assert images
    data = b64decode(images[-1].data)
    if folder := os.environ.get("SIMWORLDS_PICTURES"):
        Path(folder, f"{name}.png").write_bytes(data)
    return Image.open(BytesIO(data)).convert("RGB")


def shows_something(image: Image.Image) -> bool:
    """Whether it is no plain colour: its brightness spreads."""
    low, high = image.convert("L").getextrema()
    return high - low > 40


# The solvers themselves, and both kinds of cache, are tried in tests/agents/blender/physics.
_ONE = "cloth"


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name == _ONE else pytest.mark.whole) for name in SCENES]
)
async def test_a_client_makes_a_scene_of_each_solver(client: Client, name: str) -> None:
    scene, slug = SCENES[name], name.replace(" ", "-")
    await use(client, "blender_execute", code=STAGE.format(frames=scene.frames) + scene.build)

    baked = await use(client, "blender_bake", timeout=200)
    assert baked.structured_content is not None
    assert baked.structured_content["caches"]
    assert all(cache["baked"] for cache in baked.structured_content["caches"])

    judged = await use(
        client, "blender_execute", code=f"bpy.context.scene.frame_set({scene.frames}){HEIGHTS}{scene.judge}"
    )
    assert judged.structured_content is not None
    assert judged.structured_content["value"] == "True"

    state = await use(client, "blender_scene_state")
    assert state.structured_content is not None
    assert shows_something(picture(await use(client, "blender_scene_layout_preview"), f"{slug}-layout"))
    if scene.actor:
        sheet = await use(client, "blender_motion_sheet_preview", actors=[scene.actor], timeout=200)
        assert shows_something(picture(sheet, f"{slug}-motion"))
    still = await use(
        client, "blender_render", kind="still", name=slug, engine="cycles", samples=8, width=320, height=240
    )
    shot = picture(still, f"{slug}-still")
    assert shot.size == (320, 240)
    assert shows_something(shot)
    saved = await use(client, "blender_save", name=slug)
    assert saved.structured_content is not None
    assert Path(saved.structured_content["path"]).stat().st_size > 10_000
