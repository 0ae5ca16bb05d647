"""Draws the pictures of the page on tools, which show one small scene: ``python -m docs.generate.tool_pictures``."""

from __future__ import annotations

import tempfile
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PIL import Image

from agents.blender.blender_sessions import SessionSetup
from agents.loop.running.tool_client import ToolClient
from simworlds.sandbox.confinement.confined_command import best_sandbox

if TYPE_CHECKING:
    from collections.abc import Mapping

FOLDER = Path(__file__).resolve().parents[1] / "tools"
_WIDTH = 1100
_SCENE = """\
import bpy
from math import radians

def box(name, size, place, colour):
    bpy.ops.mesh.primitive_cube_add(size=1, location=place)
    obj = bpy.context.object
    obj.name, obj.scale = name, size
    bpy.ops.object.transform_apply(location=False, rotation=False)
    material = bpy.data.materials.new(name)
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*colour, 1)
    obj.data.materials.append(material)
    return obj

for obj in list(bpy.data.objects):
    bpy.data.objects.remove(obj)
floor = box("Floor", (3, 3, 0.1), (0, 0, -0.05), (0.35, 0.3, 0.25))
top = box("TableTop", (1.2, 0.7, 0.04), (0, 0, 0.73), (0.5, 0.3, 0.15))
legs = [box(f"Leg_{n}", (0.05, 0.05, 0.71), (x, y, 0.355), (0.5, 0.3, 0.15))
        for n, (x, y) in enumerate([(-0.55, -0.3), (0.55, -0.3), (-0.55, 0.3), (0.55, 0.3)], 1)]
crates = [box(f"Crate_{n}", (0.16, 0.16, 0.16), (0.02 * n, 0, 0.86 + 0.3 * n), (0.2, 0.35, 0.6)) for n in range(3)]
scene = bpy.context.scene
scene.frame_end = 60
bpy.ops.rigidbody.world_add()
scene.rigidbody_world.collection = bpy.data.collections.new("Bodies")
for obj in (floor, top, *legs, *crates):
    scene.rigidbody_world.collection.objects.link(obj)
    obj.rigid_body.type = "ACTIVE" if obj in crates else "PASSIVE"
    obj.rigid_body.collision_shape = "BOX"
    obj.rigid_body.use_margin = True
    obj.rigid_body.collision_margin = 0.001
camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
camera.location, camera.rotation_euler = (1.9, -2.9, 1.7), (radians(75), 0, radians(33))
scene.collection.objects.link(camera)
scene.camera = camera
lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "AREA"))
lamp.location, lamp.data.energy = (-1, -1, 3), 120
scene.collection.objects.link(lamp)
"""
_OBJECTS: Mapping[str, Any] = {
    "groups": [
        {"object": "Ground", "system": "ground", "members": ["Floor"], "contact_with": ["Table"]},
        {"object": "Table", "system": "furniture", "members": ["TableTop", *(f"Leg_{n}" for n in range(1, 5))]},
        *(
            {"object": f"Box_{n}", "system": "furniture", "members": [f"Crate_{n}"], "deformation_kind": "sim_rigid",
             "motion_kind": "bake"}
            for n in range(3)
        ),
    ]
}  # fmt: skip
# The name of each picture, the tool and its arguments, after the scene was built and baked.
_PICTURES: tuple[tuple[str, str, Mapping[str, Any]], ...] = (
    ("scene_layout", "blender_scene_layout_preview", {}),
    ("object", "blender_object_preview", {"object": "Table"}),
    ("material", "blender_material_preview", {"show": "scene", "width": 768}),
    ("uv", "blender_uv_preview", {"objects": ["TableTop"]}),
    ("motion_sheet", "blender_motion_sheet_preview", {"actors": ["Box_0", "Box_1", "Box_2"]}),
    ("verify", "blender_verify", {"rules": ["V", "W1"], "image": True}),
    ("render", "blender_render", {"frame": 60, "samples": 32, "width": 960, "height": 540}),
)


def draw(folder: Path = FOLDER) -> None:
    """Writes all pictures into ``folder``. Raises RuntimeError for a call that fails."""
    folder.mkdir(exist_ok=True)
    with (
        tempfile.TemporaryDirectory() as run,
        ToolClient(SessionSetup(best_sandbox(), run=Path(run) / "run")) as tools,
    ):
        for name, arguments in (
            ("blender_execute", {"code": _SCENE}),
            ("blender_group", _OBJECTS),
            ("blender_bake", {}),
        ):
            _asked(tools, name, arguments)
        for picture, name, arguments in _PICTURES:
            png = _asked(tools, name, arguments)
            _write(folder / f"{picture}.png", png)


def _asked(tools: ToolClient, name: str, arguments: Mapping[str, Any]) -> bytes:
    """The first picture of a call; empty if there is none."""
    outcome = tools.call(name, arguments)
    if outcome.failed:
        raise RuntimeError(f"{name}: {outcome.text}")
    return outcome.pictures[0].data if outcome.pictures else b""


def _write(path: Path, png: bytes) -> None:
    with Image.open(BytesIO(png)) as picture:
        small = picture.convert("RGB")
        small.thumbnail((_WIDTH, _WIDTH * 2))
        small.quantize(128).save(path, optimize=True)


if __name__ == "__main__":
    draw()
