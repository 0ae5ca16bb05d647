"""``blender_export`` and ``blender_import``: what each format keeps of meshes, hierarchies, motion and units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from agents.blender.exchange.replies import ImportedFile
from agents.blender.tools import export_file
from agents.blender.tools.export_file import TOOL as EXPORT
from agents.blender.tools.import_file import TOOL as IMPORT
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.blender.tools.base import Result

pytestmark = pytest.mark.blender

# Two meshes with two materials, of which one has a packed texture.
LOOKS = """
image = bpy.data.images.new("wood", 8, 8)
image.pixels = [0.5, 0.25, 0.1, 1.0] * 64
image.pack()
def material(name, textured):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    if textured:
        node = made.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        made.node_tree.links.new(node.outputs[0], made.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    return made
materials = [material("plain", False), material("textured", True)]
for number in range(2):
    bpy.ops.mesh.primitive_cube_add(size=1 + number, location=(3 * number, 1, 2))
    bpy.context.object.name = f"Box {number}"
    for made in materials:
        bpy.context.object.data.materials.append(made)
    for face in bpy.context.object.data.polygons:
        face.material_index = face.index % 2
bpy.context.object.modifiers.new("Bevel", "BEVEL").width = 0.1
"""
# An Empty with an arm that has a hand.
HIERARCHY = """
bpy.ops.object.empty_add(location=(1, 2, 3))
parent = bpy.context.object
for name, size in (("Arm", 1.0), ("Hand", 0.5)):
    bpy.ops.mesh.primitive_cube_add(size=size, location=(0, 1, 0))
    bpy.context.object.name, bpy.context.object.parent = name, parent
    parent = bpy.context.object
"""
# A box that moves 4 m and turns.
MOTION = """
bpy.context.scene.frame_end = 24
bpy.ops.mesh.primitive_cube_add(size=1)
box = bpy.context.object
for frame, x, turn in ((1, 0, 0), (24, 4, 1.5)):
    box.location.x, box.rotation_euler.z = x, turn
    box.keyframe_insert("location", frame=frame)
    box.keyframe_insert("rotation_euler", frame=frame)
"""
# A box of 2 × 1 × 0.5 m, that stands on the ground.
UNITS = """
bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 0.25))
bpy.context.object.scale = (2, 1, 0.5)
"""
_ALL = ("glb", "gltf", "usdz", "usdc", "usda", "fbx", "obj", "abc", "stl")
_FORMATS = {"glb", "usdc", "fbx", "obj", "abc", "stl"}
_NOT_KEPT = {
    "obj": {"hierarchy": ["parents"], "motion": ["animation"]},
    "abc": {"looks": ["textures"]},
    "stl": {
        "looks": ["materials", "textures", "UV maps", "objects (all are one mesh)"],
        "hierarchy": ["UV maps", "parents", "objects (all are one mesh)"],
        "motion": ["UV maps", "animation"],
        "units": ["UV maps"],
    },
}
_SCENES = {"looks": LOOKS, "hierarchy": HIERARCHY, "motion": MOTION, "units": UNITS}


def export(session: LiveSession, name: str, **more: Any) -> Result:
    return session.use(EXPORT, name=name, **more)


def bring_in(session: LiveSession, name: str, **more: Any) -> Result:
    return session.use(IMPORT, path=name, **more)


@pytest.mark.parametrize(
    ("ending", "scene"),
    [
        pytest.param(ending, scene, marks=() if (row + column) % 3 == 0 else pytest.mark.whole)
        for row, ending in enumerate(sorted(_FORMATS))
        for column, scene in enumerate(_SCENES)
    ],
)
def test_a_file_keeps_what_its_format_can(session: LiveSession, ending: str, scene: str) -> None:
    session.run(_SCENES[scene])
    answer = export(session, f"{scene}.{ending}")
    assert answer.data["differences"] == [], answer.text
    assert isinstance(answer.data["verified"], dict), answer.text
    assert not answer.failed
    assert answer.data["not_kept"] == _NOT_KEPT.get(ending, {}).get(scene, [])


@pytest.mark.parametrize("ending", _ALL)
def test_the_same_comes_back_into_the_scene_by_the_runs_own_file(session: LiveSession, ending: str) -> None:
    session.run(LOOKS)
    sent = export(session, f"back/{ending}.{ending}", verify=False)
    session.empty()
    path = sent.data["path"]
    came = bring_in(session, path, collection="Came")
    assert came.data["triangles"] == sent.data["triangles"]
    assert came.data["high"] == pytest.approx(sent.data["high"], abs=1e-4)
    assert came.data["missing"] == came.data["outside"] == []
    textures = [image["into"] for material in came.data["materials"] for image in material["images"]]
    assert textures == ([] if ending in {"abc", "stl"} else ["Base Color"])
    assert session.run("all(image.packed_file for image in bpy.data.images if image.source == 'FILE')")
    assert session.run("sorted(c.name for c in bpy.context.scene.collection.children)") == ["Came"]


@pytest.mark.parametrize(
    "ending",
    [
        "glb",
        pytest.param("usdc", marks=pytest.mark.whole),
        pytest.param("fbx", marks=pytest.mark.whole),
        "abc",
    ],
)
def test_motion_comes_back_frame_by_frame(session: LiveSession, ending: str) -> None:
    session.run(MOTION)
    poses = export(session, f"moving.{ending}").data["poses"]
    assert [pose["frame"] for pose in poses] == [1, 24]
    assert poses[1]["high"][0] > 4
    still = export(session, f"still.{ending}", animation=False)
    assert not still.failed, still.text
    assert still.data["poses"] == []
    assert still.data["verified"]["animated"] == 0


def test_what_a_file_brings_does_not_change_the_scene_around_it(session: LiveSession) -> None:
    session.run(MOTION)
    export(session, "moving.glb", verify=False)
    session.empty()
    settings = "s = bpy.context.scene; (s.frame_start, s.frame_end, s.render.fps, s.frame_current, s.world)"
    session.run("bpy.context.scene.frame_end = 77; bpy.context.scene.render.fps = 30")
    session.run("bpy.ops.mesh.primitive_cube_add(); bpy.ops.object.mode_set(mode='EDIT')")
    before = session.run(settings)
    bring_in(session, "moving.glb")
    assert session.run(settings) == before
    assert session.run("[o.name for o in bpy.context.selected_objects]") == ["Cube"]


def test_exporting_changes_nothing(session: LiveSession) -> None:
    session.run(LOOKS)
    state = (
        "[(o.name, o.select_get()) for o in bpy.data.objects], bpy.context.object.name, "
        "[(i.name, i.filepath, bool(i.packed_file)) for i in bpy.data.images], len(bpy.data.meshes)"
    )
    before = session.run(state)
    for ending in _FORMATS:
        export(session, f"same.{ending}", objects=["Box 0"], verify=False)
    assert session.run(state) == before


def test_a_name_stands_for_what_is_parented_to_it_and_a_collection_for_what_is_in_it(
    session: LiveSession,
) -> None:
    session.run(HIERARCHY + "bpy.ops.mesh.primitive_cube_add(location=(9, 0, 0))")
    answer = export(session, "one.glb", objects=["Arm"], verify=False)
    assert answer.data["objects"] == {"MESH": 2}
    assert answer.data["parented"] == 1
    session.run("made = bpy.data.collections.new('Kit'); bpy.context.scene.collection.children.link(made)")
    session.run("made = bpy.data.collections['Kit']; made.objects.link(bpy.data.objects['Cube'])")
    assert export(session, "kit.glb", objects=["Kit"], verify=False).data["objects"] == {"MESH": 1}
    with pytest.raises(Refusal, match="Nearest: 'Arm'"):
        export(session, "no.glb", objects=["Arn"])


def test_hidden_and_unsuitable_objects_are_named(session: LiveSession) -> None:
    session.run(UNITS + "bpy.ops.object.camera_add(); bpy.ops.mesh.primitive_cube_add()")
    session.run("bpy.context.object.name = 'Ghost'; bpy.context.object.hide_set(True)")
    answer = export(session, "some.stl")
    assert "keeps no camera: 'Camera'" in answer.text
    assert "hidden, so not exported: 'Ghost'" in answer.text
    session.run("bpy.data.objects['Cube'].hide_set(True)")
    with pytest.raises(Refusal, match="There is nothing to export"):
        export(session, "none.stl")


def test_a_difference_is_told_and_fails_the_call(
    session: LiveSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = export_file._import_again  # pyright: ignore[reportPrivateUsage]

    def without_texture(*arguments: Any, **more: Any) -> Any:
        back = whole(*arguments, **more)
        assert isinstance(back, ImportedFile)
        bare = [entry.model_copy(update={"images": []}) for entry in back.materials]
        return back.model_copy(update={"materials": bare, "triangles": 7, "high": [9.0, 9.0, 9.0]})

    monkeypatch.setattr(export_file, "_import_again", without_texture)
    session.run(LOOKS)
    answer = export(session, "broken.glb")
    assert answer.failed
    assert "7 triangles instead of" in answer.text
    assert "bounds" in answer.text
    assert "without the textures of 'textured' (Base Color)" in answer.text


def test_what_is_not_baked_is_told(session: LiveSession) -> None:
    session.run(MOTION + "box.modifiers.new('Cloth', 'CLOTH')")
    answer = export(session, "loose.abc", verify=False)
    assert "not baked, so its motion may be wrong in the file" in answer.text
    assert answer.data["poses"] == []


def test_scale_and_upward_axis_are_given_for_files_that_do_not_say(session: LiveSession) -> None:
    session.run(UNITS)
    export(session, "box.stl", verify=False)
    export(session, "box.glb", verify=False)
    for name in ("box.stl", "box.glb"):
        session.empty()
        small = bring_in(session, name, scale=0.01)
        assert small.data["high"] == pytest.approx([0.01, 0.005, 0.005], abs=1e-6)
    session.empty()
    lying = bring_in(session, "box.stl", up="Y")
    assert lying.data["high"][1] - lying.data["low"][1] == pytest.approx(0.5)
    session.empty()
    large = bring_in(session, "box.stl", scale=1000.0)
    assert "2,000 m long" in large.text
    assert "scale=0.01" in large.text


def test_an_export_replaces_its_own_and_nothing_else(session: LiveSession) -> None:
    session.run(UNITS)
    first = export(session, "twice.obj", verify=False)
    again = export(session, "twice.obj", verify=False)
    assert first.data["path"] == again.data["path"]
    assert "instead of the one before" in again.text
    root = session.blender.folder.root
    (root / "mine_obj").mkdir()
    (root / "mine_obj" / "letter.txt").write_text("dear")
    with pytest.raises(Refusal, match="is not an export of that name"):
        export(session, "mine.obj")
    assert (root / "mine_obj" / "letter.txt").read_text() == "dear"


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("tower", "no ending of a known format"),
        ("tower.blend", "no ending of a known format"),
        ("../tower.glb", "cannot be used as a file name"),
        ("/tmp/tower.glb", "cannot be used as a file name"),
        ("workspace/tower.glb", "reserved"),
    ],
)
def test_an_export_stays_in_the_runs_folder(session: LiveSession, name: str, why: str) -> None:
    session.run(UNITS)
    with pytest.raises(Refusal, match=why):
        export(session, name)


def test_formats_are_listed_with_what_the_build_lacks(session: LiveSession) -> None:
    answer = session.use(IMPORT)
    for label in ("glTF", "USD", "FBX", "OBJ", "Alembic", "STL"):
        assert f"- {label} (" in answer.text
    assert "lacks" not in answer.text
    session.run("bpy.ops.preferences.addon_disable(module='io_scene_fbx')")
    session.run("import sys; sys.modules['io_scene_fbx'] = None")
    try:
        assert (
            "FBX (.fbx), its unit is written in it: **this build lacks writing**" in session.use(IMPORT).text
        )
        session.run(UNITS)
        with pytest.raises(Refusal, match="cannot write fbx; its build lacks it"):
            export(session, "box.fbx")
    finally:
        session.blender.kill()
