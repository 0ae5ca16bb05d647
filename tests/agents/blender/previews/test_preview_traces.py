"""The previews leave nothing behind in the scene."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest
from preview_views import Views, build

from agents.blender.tools import material_preview, previews
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender


CENSUS = """
import json
def plain(block, depth):
    found = {}
    for prop in block.bl_rna.properties:
        if prop.identifier in {"rna_type", "original", "is_evaluated", "depsgraph"}:
            continue
        value = getattr(block, prop.identifier)
        if prop.type == "POINTER":
            value = value.name_full if isinstance(value, bpy.types.ID) else value and depth and plain(value, depth - 1)
        elif prop.type == "COLLECTION":
            value = [getattr(one, "name", "") for one in value]
        elif hasattr(value, "__len__") and not isinstance(value, str):
            value = [list(row) if hasattr(row, "__len__") and not isinstance(row, str) else row for row in value]
        found[prop.identifier] = value
    return found
lists = [prop.identifier for prop in bpy.data.bl_rna.properties if prop.type == "COLLECTION"]
state = {name: [(one.name_full, one.session_uid, one.users) for one in getattr(bpy.data, name)] for name in lists}
for name in ("scenes", "objects", "materials", "images", "meshes", "cameras", "worlds", "collections"):
    state[name + " in full"] = {one.name_full: plain(one, 2) for one in getattr(bpy.data, name)}
state["context"] = [bpy.context.scene.name, bpy.context.view_layer.name, bpy.context.mode]
state["context"] += [bpy.context.object.name, [one.name for one in bpy.context.selected_objects]]
handlers = [(name, getattr(bpy.app.handlers, name)) for name in dir(bpy.app.handlers)]
state["handlers"] = [(name, [repr(one) for one in held]) for name, held in handlers if isinstance(held, list)]
open("census.json", "w").write(json.dumps(state, default=repr, sort_keys=True))
"""
LIVED_IN = """
box('Table', (0, 0, 0), rgb=(.5, .2, .1)); box('Lamp', (0, 0, 2), rgb=(1, 1, 1)).select_set(False)
bpy.data.objects['Table'].shape_key_add(name='Basis')
i = bpy.data.images.new('Cloth', 8, 8); t = bpy.data.materials['Table'].node_tree
n = t.nodes.new('ShaderNodeTexImage'); n.image = i; t.links.new(n.outputs[0], t.nodes['Principled BSDF'].inputs[0])
bpy.ops.mesh.primitive_plane_add(size=1); o = bpy.context.object
s = o.modifiers.new('p', 'PARTICLE_SYSTEM').particle_system.settings; s.type = 'HAIR'; s.count = 5
bpy.ops.object.text_add(); bpy.ops.object.camera_add(location=(0, -9, 1), rotation=(1.5, 0, 0))
scene = bpy.context.scene; scene.camera = bpy.context.object; scene.camera.data.lens = 33; scene.frame_set(7)
scene.camera.data.keyframe_insert('lens', frame=7)
scene.world = bpy.data.worlds.new('World'); scene.render.filepath = '//out'; scene.render.resolution_x = 321
scene.render.engine = 'CYCLES'; scene.display.shading.light = 'FLAT'
def spoil(*_): bpy.data.objects.new('Spoilt', None)
bpy.app.handlers.render_pre.append(spoil); bpy.app.handlers.depsgraph_update_post.append(spoil)
bpy.context.view_layer.objects.active = bpy.data.objects['Table']
for spare in [one for one in bpy.data.objects if one.name.startswith('Spoilt')]: bpy.data.objects.remove(spare)
bpy.app.handlers.depsgraph_update_post.remove(spoil)
"""


@pytest.fixture(autouse=True)
def _small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(material_preview, "_PANEL", 64)
    monkeypatch.setattr(previews, "PANEL", 64)


def census(session: LiveSession) -> dict[str, Any]:
    session.run(CENSUS)
    return json.loads((session.blender.folder.workspace.mount / "census.json").read_text())


def test_no_preview_leaves_a_trace(session: LiveSession) -> None:
    build(session, LIVED_IN)
    before = census(session)
    session.use(previews.SCENE_LAYOUT)
    session.use(previews.SINGLE_MESH, object="Table", frame=9)
    assert census(session) == before
    session.use(material_preview.TOOL, frames=[9], width=64, objects=["Table"])
    assert census(session) == before
    session.run("bpy.data.objects['Table'].location.x += 1e-3")
    assert census(session) != before, "the census sees nothing"


def test_a_preview_that_fails_half_way_leaves_no_trace_either(session: LiveSession) -> None:
    build(session, LIVED_IN)
    obstacle = session.blender.folder.workspace.mount / ".preview-2.png"
    session.run("import os; os.makedirs('.preview-2.png/x')")
    before = census(session)
    try:
        with pytest.raises(Refusal, match="could not be rendered"):
            session.use(previews.SCENE_LAYOUT, frame=9)
        assert census(session) == before
        assert [path.name for path in obstacle.parent.glob(".preview*")] == [obstacle.name]
    finally:
        (obstacle / "x").rmdir()
        obstacle.rmdir()


def test_a_render_of_the_scenes_own_is_kept(session: LiveSession) -> None:
    build(
        session,
        "box('Crate', rgb=(.8, 0, 0)); bpy.ops.object.camera_add(location=(0, -4, 0), rotation=(math.pi / 2, 0, 0))\n"
        "s = bpy.context.scene; s.camera = bpy.context.object; s.render.engine = 'BLENDER_WORKBENCH'\n"
        "s.render.resolution_x = s.render.resolution_y = 64; bpy.ops.render.render()\n"
        "bpy.data.images['Render Result'].save_render(os.path.abspath('before.png'))",
    )
    session.use(previews.SCENE_LAYOUT)
    session.run("bpy.data.images['Render Result'].save_render(__import__('os').path.abspath('after.png'))")
    pictures = [
        (session.blender.folder.workspace.mount / f"{name}.png").read_bytes() for name in ("before", "after")
    ]
    assert pictures[0] == pictures[1]


def test_previews_work_while_a_mesh_is_being_edited(session: LiveSession) -> None:
    build(
        session,
        "box('Crate', rgb=(.8, 0, 0)); bpy.ops.object.mode_set(mode='EDIT')\n"
        "bpy.ops.mesh.select_all(action='SELECT'); bpy.ops.transform.resize(value=(3, 1, 1))",
    )
    assert Views(session, "mesh", "Crate").extent == pytest.approx([3, 1, 1])
    assert session.run("bpy.context.mode") == "EDIT_MESH"
