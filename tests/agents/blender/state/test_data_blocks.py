"""``blender_scene_state(sections=["data_blocks"])``: digests that change with every edit, and with nothing else."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from agents.blender.tools.files import LOAD, SAVE
from agents.blender.tools.scene_state import TOOL

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

SCENE = """
import bpy
scene = bpy.context.scene
scene.frame_end = 20
bpy.ops.mesh.primitive_cube_add()
cube = bpy.context.object
glaze = bpy.data.materials.new("Glaze")
glaze.use_nodes = True
cube.data.materials.append(glaze)
cube.modifiers.new("Bevel", "BEVEL")
cube["weight"] = 2.0
group = cube.vertex_groups.new(name="Top")
group.add([0, 1], 0.5, "REPLACE")
bpy.ops.object.camera_add()
scene.camera = bpy.context.object
camera = bpy.context.object
bpy.ops.object.light_add(type="POINT")
lamp = bpy.context.object
lamp.name = lamp.data.name = "Lamp"
for frame, x in ((1, 0.0), (20, 4.0)):
    camera.location.x = x
    camera.keyframe_insert("location", frame=frame)
    glaze.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = x / 4
    glaze.node_tree.nodes["Principled BSDF"].inputs["Roughness"].keyframe_insert("default_value", frame=frame)
    lamp["swing"] = x
    lamp.keyframe_insert('["swing"]', frame=frame)
lamp.driver_add("location", 2).driver.expression = "frame / 10"
scene.timeline_markers.new("cut", frame=10).camera = camera
image = bpy.data.images.new("Paint", 4, 4)
image.use_fake_user = True
bpy.data.texts.new("Notes").write("first\\nsecond")
bpy.data.objects.new("Lost", bpy.data.meshes.new("Lost"))
scene.frame_set(1)
"""
CUBE = "cube = bpy.data.objects['Cube']\n"
NODES = "bsdf = bpy.data.materials['Glaze'].node_tree.nodes['Principled BSDF']\n"
CURVE = (
    "curve = bpy.data.objects['Camera'].animation_data.action.layers[0].strips[0].channelbags[0].fcurves[0]\n"
)


def blocks(session: LiveSession) -> dict[str, Any]:
    return session.use(TOOL, sections=["data_blocks"]).data


def changed(before: dict[str, Any], after: dict[str, Any]) -> dict[str, set[str]]:
    """{data-block: its parts that differ}; what was added or removed has all of its parts."""
    told: dict[str, set[str]] = {}
    for name in before["data_blocks"].keys() | after["data_blocks"].keys():
        if before["data_blocks"].get(name) != after["data_blocks"].get(name):
            one, other = (state["data_block_parts"].get(name, {}) for state in (before, after))
            told[name] = {part for part in one.keys() | other.keys() if one.get(part) != other.get(part)}
    return told


@pytest.fixture
def scene(session: LiveSession) -> LiveSession:
    session.run(SCENE)
    return session


def test_digests_cover_exactly_what_a_file_keeps(scene: LiveSession) -> None:
    found = scene.use(TOOL, sections=["data_blocks"])
    assert {
        "Object Cube", "Mesh Cube", "Material Glaze", "Object Lamp", "Light Lamp", "Camera Camera", "Scene Scene",
        "Image Paint", "Text Notes", "Action CameraAction",
    } <= found.data["data_blocks"].keys()  # fmt: skip
    kinds = {name.partition(" ")[0] for name in found.data["data_blocks"]}
    assert not kinds & {"Screen", "WindowManager", "WorkSpace", "Brush"}
    assert not [name for name in found.data["data_blocks"] if "Lost" in name]
    assert "3 Object" in found.text
    assert found.data["data_block_uses"]["Object Cube"]["data"] == ["Mesh Cube"]
    keys = found.data["data_block_keys"]
    assert {"Action CameraAction", "Action GlazeAction"} <= keys.keys() <= found.data["data_blocks"].keys()
    assert [frame for frame, *_ in keys["Action CameraAction"]["location"]] == [1, 20]
    assert found.data["tagged"] is False
    assert "data_blocks" not in scene.use(TOOL).data


def test_digests_are_not_cut_however_short_the_readout(session: LiveSession) -> None:
    session.run(
        "for n in range(300):\n    bpy.context.scene.collection.objects.link(bpy.data.objects.new(f'E{n}', None))"
    )
    found = session.use(TOOL, sections=["data_blocks"], max_tokens=500)
    assert sum(name.startswith("Object E") for name in found.data["data_blocks"]) == 300


@pytest.mark.parametrize(
    "code",
    [
        "[bpy.context.scene.frame_set(frame) for frame in (7, 13, 20)]",
        "bpy.ops.object.select_all(action='DESELECT')\n"
        "bpy.context.view_layer.objects.active = bpy.data.objects['Cube']",
        CUBE + "bpy.context.view_layer.objects.active = cube\nbpy.ops.object.mode_set(mode='EDIT')\n"
        "bpy.ops.mesh.select_all(action='SELECT')\nbpy.ops.mesh.select_all(action='INVERT')\n"
        "bpy.ops.object.mode_set(mode='OBJECT')",
        "bpy.data.texts['Notes'].current_line_index = 1",
        "bpy.context.view_layer.update()",
        "bpy.context.scene.cursor.location.x = 3",
    ],
    ids=["frames", "selecting", "selecting vertices", "a text's cursor", "updating", "the 3D cursor"],
)  # fmt: skip
def test_reading_changes_no_digest(scene: LiveSession, code: str) -> None:
    before = blocks(scene)
    scene.run(code)
    assert not changed(before, blocks(scene))


def test_saving_and_opening_elsewhere_changes_no_digest(scene: LiveSession) -> None:
    scene.run(
        "import os\nimage = bpy.data.images.new('Leaf', 4, 4)\nimage.filepath_raw = os.path.abspath('leaf.png')\n"
        "image.file_format = 'PNG'\nimage.save()\nbpy.data.images.remove(image)\n"
        "image = bpy.data.images.load(os.path.abspath('leaf.png'))\nimage.use_fake_user = True\n"
        "bpy.ops.rigidbody.world_add()\nscene = bpy.context.scene\n"
        "scene.rigidbody_world.collection = bpy.data.collections.new('Bodies')\n"
        "bpy.context.view_layer.update()"
    )
    before = blocks(scene)
    scene.use(SAVE, name="elsewhere/copy", verify=False)
    assert not changed(before, blocks(scene))
    scene.empty()
    scene.use(LOAD, path="elsewhere/copy.blend")
    assert not changed(before, blocks(scene))


EDITS: list[tuple[str, dict[str, set[str]]]] = [
    (CUBE + "cube.location.x += 1e-3", {"Object Cube": {"transform"}}),
    (CUBE + "cube.modifiers['Bevel'].width = 0.3", {"Object Cube": {"modifiers"}}),
    (CUBE + "cube.data.vertices[3].co.z += 0.01", {"Mesh Cube": {"geometry"}}),
    (CUBE + "cube['weight'] = 3.0", {"Object Cube": {"custom properties"}}),
    (CUBE + "cube.vertex_groups['Top'].add([0], 0.7, 'REPLACE')", {"Object Cube": {"weights"}}),
    (CUBE + "cube.hide_render = True", {"Object Cube": {"visibility"}}),
    (CUBE + "cube.hide_set(True)", {"Object Cube": {"visibility in view layers"}}),
    (CUBE + "cube.parent = bpy.data.objects['Lamp']", {"Object Cube": {"parent"}}),
    (CUBE + "cube.rotation_mode = 'QUATERNION'", {"Object Cube": {"transform"}}),
    (NODES + "bsdf.inputs['Metallic'].default_value = 1.0", {"Material Glaze": {"nodes"}}),
    (CURVE + "curve.keyframe_points[1].co.y = 9", {"Action CameraAction": {"keyframes"}}),
    ("bpy.data.lights['Lamp'].energy = 7", {"Light Lamp": {"settings"}}),
    ("bpy.data.lights['Lamp'].type = 'SUN'", {"Light Lamp": {"settings"}}),
    ("bpy.data.images['Paint'].pixels[0] = 0.5", {"Image Paint": {"picture"}}),
    ("bpy.data.texts['Notes'].lines[1].body = 'third'", {"Text Notes": {"text"}}),
    ("bpy.context.scene.frame_end = 30", {"Scene Scene": {"frame range"}}),
    ("bpy.context.scene.render.resolution_x = 64", {"Scene Scene": {"render"}}),
    (
        CUBE + "made = bpy.data.collections.new('Made')\nbpy.context.scene.collection.children.link(made)\n"
        "bpy.context.scene.collection.objects.unlink(cube)\nmade.objects.link(cube)",
        {
            "Scene Scene": {"collection", "view layers"},
            "Collection Made": {"children", "objects", "settings", "visibility"},
        },
    ),
]


@pytest.mark.parametrize(("code", "expected"), EDITS, ids=[" ".join(one[0].split())[-40:] for one in EDITS])
def test_an_edit_changes_the_digests_of_what_it_edits_alone(
    scene: LiveSession, code: str, expected: dict[str, set[str]]
) -> None:
    before = blocks(scene)
    scene.run(code)
    assert changed(before, blocks(scene)) == expected


def test_a_bake_is_told_apart_from_its_settings(session: LiveSession) -> None:
    session.run(
        "bpy.context.scene.frame_end = 4\nbpy.ops.mesh.primitive_grid_add(x_subdivisions=3, y_subdivisions=3)\n"
        "bpy.context.object.modifiers.new('Cloth', 'CLOTH').point_cache.frame_end = 4"
    )
    before = blocks(session)
    session.run("bpy.ops.ptcache.bake_all(bake=True)")
    baked = blocks(session)
    assert changed(before, baked) == {"Object Grid": {"caches"}}
    session.run("bpy.data.objects['Grid'].modifiers['Cloth'].settings.mass = 2")
    assert "modifiers" in changed(baked, blocks(session))["Object Grid"]
