"""What is said of symbols that neither Blender's API nor its manual says: each sentence is tried in Blender."""

from __future__ import annotations

import importlib
import math
import re
import subprocess
import sys
import warnings
import wave
from itertools import pairwise
from statistics import fmean
from typing import TYPE_CHECKING, Any

import pytest
from told_by_blender import told_by_blender

from kb_serve.answer.known.practice import Practice

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

bpy: Any = pytest.importorskip("bpy")
bmesh: Any = pytest.importorskip("bmesh")
bmesh_utils: Any = pytest.importorskip("bpy_extras.bmesh_utils")
mathutils: Any = pytest.importorskip("mathutils")
pytestmark = pytest.mark.blender
TYPES = "bpy.types."
PENCIL = "a noise modifier of a grease pencil object"
POINT = "_bpy_internal.grease_pencil.stroke.GreasePencilStrokePoint"


@pytest.fixture(autouse=True)
def empty_file() -> Iterator[None]:
    """Each test has a file of its own."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    yield
    bpy.ops.wm.read_factory_settings(use_empty=True)


def said(reader: BaseReader, path: str, question: str = "") -> str:
    assert reader.entry(path), path
    return "\n".join(Practice(reader).of(path, question or path))


def end_of(code: str) -> int:
    """With which exit code a Blender of its own ends that runs some code."""
    words = [sys.executable, "-P", "-c", code]
    return subprocess.run(words, check=False, capture_output=True, timeout=60).returncode


# Drivers


def new_object(name: str) -> Any:
    obj = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def driven() -> tuple[Any, Any, Any]:
    """An object with a new custom property, one that a driver reads it for, and that driver."""
    owner, obj = new_object("owner"), new_object("obj")
    bpy.context.view_layer.update()
    owner["name"] = 3.0
    driver: Any = obj.driver_add("location", 0).driver
    variable = driver.variables.new()
    variable.name = "v"
    variable.targets[0].id = owner
    variable.targets[0].data_path = '["name"]'
    driver.expression = "v * 2"
    return owner, obj, driver


@pytest.mark.parametrize(
    "name",
    ["DriverTarget.data_path", "bpy_struct.driver_add", "ChannelDriverVariables.new", "Driver.is_valid"],
)
def test_a_driver_wants_the_owner_of_a_custom_property_tagged(reader: BaseReader, name: str) -> None:
    assert "`owner.id_data.update_tag()`" in said(reader, TYPES + name)


def test_a_driver_sees_a_custom_property_after_its_owner_was_tagged() -> None:
    owner, obj, driver = driven()
    owner.update_tag()
    bpy.context.view_layer.update()
    assert driver.is_valid
    assert obj.location.x == 6.0
    owner["name"] = 5.0
    bpy.context.scene.frame_set(9)
    assert obj.location.x == 6.0
    owner.update_tag()
    bpy.context.view_layer.update()
    assert obj.location.x == 10.0


def test_a_driver_that_is_invalid_already_wants_its_expression_again() -> None:
    owner, obj, driver = driven()
    bpy.context.scene.frame_set(9)
    assert not driver.is_valid
    owner.update_tag()
    bpy.context.view_layer.update()
    assert not driver.is_valid
    owner.update_tag()
    driver.expression = driver.expression
    bpy.context.view_layer.update()
    assert driver.is_valid
    assert obj.location.x == 6.0


def test_a_bone_has_its_data_block_tagged() -> None:
    armature = bpy.data.armatures.new("a")
    rig, obj = bpy.data.objects.new("rig", armature), new_object("obj")
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    armature.edit_bones.new("Bone").tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    owner = rig.pose.bones["Bone"]
    owner["name"] = 3.0
    driver: Any = obj.driver_add("location", 0).driver
    variable = driver.variables.new()
    variable.name = "v"
    variable.targets[0].id = rig
    variable.targets[0].data_path = 'pose.bones["Bone"]["name"]'
    driver.expression = "v"
    assert not hasattr(owner, "update_tag")
    owner.id_data.update_tag()
    bpy.context.view_layer.update()
    assert obj.location.x == 3.0
    owner["name"] = 5.0
    owner.id_data.update_tag()
    bpy.context.view_layer.update()
    assert obj.location.x == 5.0


@pytest.mark.parametrize(
    ("path", "question", "is_said"),
    [
        ("bpy.types.DriverTarget.data_path", "strip keyframe opacity data_path", False),
        ("bpy.types.DriverTarget.data_path", "driver that reads a property", True),
        ("bpy.app.handlers.render_cancel", "cancel a render from a script", False),
        ("bpy.app.handlers.render_cancel", "a handler that runs when a render is cancelled", True),
        ("bpy.app.timers.register", "run blender in background with a script", False),
        ("bpy.app.timers.register", "call a function after an interval", True),
        ("bpy.types.bpy_struct.id_properties_ui", "bl_info dictionary for an add-on", False),
        ("bpy.types.bpy_struct.id_properties_ui", "limits of a custom property", True),
    ],
)
def test_what_was_only_found_says_it_where_the_question_is_about_it(
    reader: BaseReader, path: str, question: str, is_said: bool
) -> None:
    told = [*Practice(reader).of(path, question, is_named=False)]
    assert bool(told) == is_said
    assert [*Practice(reader).of(path, question)]


# Baking


def baked(kind: str, **given: str) -> list[float]:
    """The colour of a pixel that a plane with a material is baked to, where Cycles' setting has the bake's type."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.cycles.bake_type = kind
    scene.world = bpy.data.worlds.new("world")
    bpy.ops.mesh.primitive_plane_add()
    material = bpy.data.materials.new("material")
    bpy.context.object.data.materials.append(material)
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("image", 4, 4)
    material.node_tree.nodes.active = node
    bpy.ops.object.bake(**given)
    return list(node.image.pixels[:3])


def test_the_operator_bakes_what_its_argument_says(reader: BaseReader) -> None:
    (note,) = Practice(reader).of("bpy.types.CyclesRenderSettings.bake_type", "")
    assert "type='NORMAL'" in note
    assert baked("AO") == baked("NORMAL") == baked("AO", type="COMBINED")
    assert baked("NORMAL", type="AO") != baked("NORMAL")


# Cloth


def fallen(*, use_gravity: bool = True, own: float = -9.81, factor: float = 1.0) -> float:
    """How far a cloth is above its beginning after some frames."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.use_gravity = use_gravity
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=3, y_subdivisions=3)
    obj = bpy.context.object
    settings = obj.modifiers.new("Cloth", "CLOTH").settings
    settings.gravity = (0.0, 0.0, own)
    settings.effector_weights.gravity = factor
    for frame in range(1, 6):
        scene.frame_set(frame)
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices[0].co.z


def test_cloth_does_not_use_its_own_gravity(reader: BaseReader) -> None:
    assert "does not use its own" in said(reader, "bpy.types.ClothSettings.gravity")
    usual = fallen()
    assert usual < 0.0
    assert fallen(own=0.0) == usual
    assert fallen(factor=0.0) == 0.0
    assert fallen(use_gravity=False, own=9.81) == 0.0


# Actions


@pytest.mark.parametrize("path", ["AnimData.action", "NlaStrip.action", "ActionConstraint.action"])
def test_an_action_moves_nothing_without_its_slot(reader: BaseReader, path: str) -> None:
    assert "`x.action_slot = x.action_suitable_slots[0]`" in said(reader, TYPES + path)
    keyed, obj = new_object("keyed"), new_object("obj")
    for frame, x in ((1, 0.0), (10, 5.0)):
        keyed.location.x = x
        keyed.keyframe_insert("location", frame=frame)
    data = obj.animation_data_create()
    data.action = keyed.animation_data.action
    bpy.context.scene.frame_set(10)
    assert (data.action_slot, obj.location.x) == (None, 0.0)
    data.action_slot = data.action_suitable_slots[0]
    bpy.context.scene.frame_set(9)
    bpy.context.scene.frame_set(10)
    assert obj.location.x == 5.0


def test_a_new_actions_slot_is_made_by_keys_or_by_hand(reader: BaseReader) -> None:
    assert "`obj.keyframe_insert(…)` makes and gives one" in said(reader, "bpy.types.BlendDataActions.new")
    obj = new_object("obj")
    data = obj.animation_data_create()
    data.action = action = bpy.data.actions.new("a")
    assert len(action.slots) == 0
    data.action_slot = action.slots.new(obj.id_type, obj.name)
    assert data.action_slot == action.slots[0]
    data.action = bpy.data.actions.new("b")
    obj.keyframe_insert("location", frame=1)
    assert data.action_slot is not None


def test_a_slot_is_found_by_its_identifier(reader: BaseReader) -> None:
    assert 'slots["OBCube"]' in said(reader, "bpy.types.Action.slots")
    action = bpy.data.actions.new("a")
    slot = action.slots.new("OBJECT", "Cube")
    assert (slot.identifier, slot.name_display) == ("OBCube", "Cube")
    assert action.slots["OBCube"] == slot
    assert action.slots.get("Cube") is None


# What docstrings have otherwise


def test_arrays_of_properties_have_32_bits(reader: BaseReader) -> None:
    numpy = pytest.importorskip("numpy")
    pixels = bpy.data.images.new("i", 2, 2).pixels
    for name in ("foreach_get", "foreach_set"):
        assert "arrays of 32-bit floats alone" in said(reader, f"{TYPES}bpy_prop_array.{name}")
        getattr(pixels, name)(numpy.zeros(16, dtype=numpy.float32))
        with pytest.raises(TypeError, match="incorrect sequence item type: d"):
            getattr(pixels, name)(numpy.zeros(16))


def test_what_docstrings_have_otherwise_is_told_as_it_is(reader: BaseReader) -> None:
    mirrored = mathutils.Matrix.Diagonal((-1, 2, 3, 1))
    assert "negative on all axes" in said(reader, "mathutils.Matrix.to_scale")
    assert tuple(mirrored.to_scale()) == (-1, -2, -3)
    assert "plain function" in said(reader, "bpy.msgbus.subscribe_rna")
    key = (bpy.types.LayerObjects, "active")
    with pytest.raises(TypeError, match="notify expects a function"):
        bpy.msgbus.subscribe_rna(key=key, owner=object(), args=(), notify=[].clear)
    assert "RuntimeError" in said(reader, "bpy.utils.register_class")
    with pytest.raises(RuntimeError, match="missing bl_rna attribute"):
        bpy.utils.register_class(type("Plain", (), {}))
    assert "the faces themselves" in said(reader, "bpy_extras.bmesh_utils.bmesh_linked_uv_islands")
    mesh = bmesh.new()
    bmesh.ops.create_cube(mesh, size=1)
    islands = bmesh_utils.bmesh_linked_uv_islands(mesh, mesh.loops.layers.uv.new())
    assert isinstance(islands[0][0], bmesh.types.BMFace)


# Retiming


def test_keys_of_retiming_are_made_where_they_shall_be(reader: BaseReader, tmp_path: Path) -> None:
    for path in ("RetimingKey.timeline_frame", "RetimingKeys.add"):
        assert "may crash Blender" in said(reader, TYPES + path)
    with wave.open(str(tmp_path / "s.wav"), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(8000)
        file.writeframes(bytes(2 * 8000 * 3))
    strips = bpy.context.scene.sequence_editor_create().strips
    keys = strips.new_sound("s", str(tmp_path / "s.wav"), 1, 1).retiming_keys
    assert keys.add() is None
    assert keys.add(timeline_frame=500) is None
    assert keys.add(timeline_frame=20) is not None
    assert 20 in [key.timeline_frame for key in keys]
    keys.reset()
    assert len(keys) == 0


# Baking


def test_a_bake_takes_what_is_left_out_from_the_scene(reader: BaseReader) -> None:
    assert "`scene.render.bake`" in said(reader, "bpy.ops.object.bake")
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    bpy.ops.mesh.primitive_plane_add()
    mesh = bpy.context.object.data
    material = bpy.data.materials.new("m")
    mesh.materials.append(material)
    colour = mesh.color_attributes.new("c", "FLOAT_COLOR", "POINT")
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.0, 1.0, 0.0, 1.0)
    scene.render.bake.target = "VERTEX_COLORS"
    bpy.ops.object.bake(type="DIFFUSE", pass_filter={"COLOR"})
    assert tuple(round(part) for part in colour.data[0].color[:3]) == (0, 1, 0)


# Drawings and curves


def new_drawing() -> Any:
    return bpy.data.grease_pencils.new("g").layers.new("L").frames.new(1).drawing


def values(drawing: Any, name: str) -> list[float]:
    return [round(getattr(point, name), 3) for stroke in drawing.strokes for point in stroke.points]


@pytest.mark.parametrize("path", [POINT, f"{POINT}.opacity", f"{POINT}.radius"])
def test_what_a_point_has_is_set_for_every_point(reader: BaseReader, path: str) -> None:
    assert "Set `radius` and `opacity` of every point" in said(reader, path)


def test_the_first_opacity_makes_it_0_elsewhere_and_new_strokes_begin_with_0() -> None:
    drawing = new_drawing()
    drawing.add_strokes([2])
    assert "opacity" not in drawing.attributes
    drawing.strokes[0].points[0].opacity = 1.0
    drawing.strokes[0].points[0].radius = 0.5
    assert [item.value for item in drawing.attributes["opacity"].data] == [1.0, 0.0]
    assert values(drawing, "radius") == [0.5, 0.01]
    drawing.add_strokes([1])
    assert values(drawing, "opacity") == [1.0, 0.0, 0.0]
    assert values(drawing, "radius") == [0.5, 0.01, 0.0]


@pytest.mark.parametrize(
    ("path", "data"),
    [
        (
            "GreasePencilDrawing.add_strokes",
            "bpy.data.grease_pencils.new('g').layers.new('L').frames.new(1).drawing",
        ),
        ("Curves.add_curves", "bpy.data.hair_curves.new('h')"),
    ],
)
def test_no_sizes_crash_blender(reader: BaseReader, path: str, data: str) -> None:
    assert "An empty list crashes Blender" in said(reader, TYPES + path)
    call = f"{data}.{path.partition('.')[2]}"
    ends = [end_of(f"import bpy; {call}({sizes})") for sizes in ("[2]", "[]")]
    assert ends[0] == 0
    assert ends[1] < 0 or ends[1] > 1  # 1 would be an error that Python raised


_OFFSET = (
    "g = bpy.data.grease_pencils.new('g'); ob = bpy.data.objects.new('g', g); scene.collection.objects.link(ob); "
    "g.layers.new('l').frames.new(1).drawing.add_strokes([3]); m = ob.modifiers.new('m', 'GREASE_PENCIL_OFFSET')"
)


def test_an_offset_by_material_crashes_blender_without_one(reader: BaseReader) -> None:
    assert "has no material" in said(reader, f"{TYPES}GreasePencilOffsetModifier.offset_mode")
    before = f"import bpy; scene = bpy.context.scene; {_OFFSET}"
    fatal = "m.offset_mode = 'MATERIAL'; bpy.context.view_layer.update()"
    given = "g.materials.append(bpy.data.materials.new('m'))"
    assert end_of(f"{before}; {given}; {fatal}") == 0
    assert end_of(f"{before}; {fatal}") < 0


@pytest.mark.parametrize(
    "path",
    [
        "GreasePencilDrawing.remove_strokes",
        "GreasePencilDrawing.set_types",
        "Curves.remove_curves",
        "Curves.set_types",
    ],
)
def test_no_indices_mean_all(reader: BaseReader, path: str) -> None:
    assert f"`{path.partition('.')[2]}(indices=[])` " in said(reader, TYPES + path)
    drawing = new_drawing()
    curves: Any = bpy.data.hair_curves.new("h")
    drawing.add_strokes([2, 2])
    curves.add_curves([2, 2])
    if path.endswith("set_types"):
        drawing.set_types(type="BEZIER", indices=[])
        curves.set_types(type="BEZIER", indices=[])
        assert len({item.value for item in drawing.attributes["curve_type"].data}) == 1
        assert len({item.value for item in curves.attributes["curve_type"].data}) == 1
        assert {stroke.curve_type for stroke in drawing.strokes} == {2}
    else:
        drawing.remove_strokes(indices=[])
        curves.remove_curves(indices=[])
        assert (len(drawing.strokes), len(curves.curves)) == (0, 0)


def test_what_is_left_out_is_compressed_as_the_open_file_is(reader: BaseReader, tmp_path: Path) -> None:
    assert "Left out, `compress` is not False" in said(reader, "bpy.ops.wm.save_as_mainfile")
    path = tmp_path / "a.blend"
    kept = bpy.context.preferences.filepaths.use_file_compression
    for new in (False, True):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.context.preferences.filepaths.use_file_compression = new
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        assert (path.read_bytes()[:7] != b"BLENDER") is new
        for asked in (False, True):
            bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=asked)
            bpy.ops.wm.open_mainfile(filepath=str(path))
            bpy.ops.wm.save_mainfile()
            assert (path.read_bytes()[:7] != b"BLENDER") is asked
    bpy.context.preferences.filepaths.use_file_compression = kept


def test_a_render_has_no_pixels_until_it_is_saved(reader: BaseReader, tmp_path: Path) -> None:
    question = "bpy.data.images['Render Result'].pixels"
    assert "has no pixels to read" in said(reader, f"{TYPES}Image.pixels", question)
    assert "has no pixels" not in said(reader, f"{TYPES}Image.pixels", "image.pixels")
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.resolution_x = scene.render.resolution_y = 4
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.ops.render.render()
    result = bpy.data.images["Render Result"]
    assert (tuple(result.size), len(result.pixels)) == ((0, 0), 0)
    result.save_render(str(tmp_path / "a.png"))
    assert len(bpy.data.images.load(str(tmp_path / "a.png")).pixels) == 4 * 4 * 4


STROKE = "_bpy_internal.grease_pencil.stroke.GreasePencilStroke"


@pytest.mark.parametrize("path", [STROKE, f"{STROKE}.points", f"{STROKE}.cyclic"])
def test_a_stroke_is_reached_from_a_drawing(reader: BaseReader, path: str) -> None:
    assert "`drawing.strokes[0]` is one" in said(reader, path)
    layer = bpy.data.grease_pencils.new("g").layers.new("L")
    layer.frames.new(1)
    drawing = layer.frames[0].drawing
    drawing.add_strokes([4])
    assert len(drawing.strokes[0].points) == 4
    assert type(drawing.strokes[0]).__name__ == STROKE.rpartition(".")[2]


@pytest.mark.parametrize(
    "path", [f"{STROKE}.fill_id", f"{STROKE}.fill_color", f"{TYPES}MaterialGPencilStyle.show_fill"]
)
def test_it_is_told_what_fills_a_stroke(reader: BaseReader, path: str) -> None:
    assert "A fill is drawn where the stroke has a `fill_id` other than 0" in said(reader, path)


def middle_of_a_square(
    folder: Path, *, fill_id: int, show_fill: bool, color: tuple[float, ...] = ()
) -> list[float]:
    """The pixel in the middle of a rendered square of one stroke."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    data = bpy.data.grease_pencils.new("g")
    material = bpy.data.materials.new("m")
    bpy.data.materials.create_gpencil_data(material)
    material.grease_pencil.fill_color = (1.0, 0.0, 0.0, 1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        material.grease_pencil.show_fill = show_fill
    data.materials.append(material)
    layer = data.layers.new("L")
    layer.use_lights = False
    drawing = layer.frames.new(scene.frame_current).drawing
    drawing.add_strokes([4])
    stroke = drawing.strokes[0]
    for point, place in zip(stroke.points, ((-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)), strict=True):
        point.position, point.radius, point.opacity = place, 0.02, 1.0
    stroke.fill_id = fill_id
    if color:
        stroke.fill_color = color
    camera = bpy.data.objects.new("c", bpy.data.cameras.new("c"))
    camera.location, camera.rotation_euler = (0.0, -6.0, 0.0), (math.pi / 2, 0.0, 0.0)
    scene.camera = camera
    for obj in (bpy.data.objects.new("g", data), camera):
        scene.collection.objects.link(obj)
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.render.resolution_x = scene.render.resolution_y = 32
    scene.render.film_transparent, scene.view_settings.view_transform = True, "Standard"
    scene.render.filepath = str(folder / "square.png")
    bpy.ops.render.render(write_still=True)
    start = 4 * (16 * 32 + 16)
    return [
        round(value, 1) for value in bpy.data.images.load(scene.render.filepath).pixels[start : start + 4]
    ]


def test_a_fill_is_rendered_by_its_id_alone(tmp_path: Path) -> None:
    assert middle_of_a_square(tmp_path, fill_id=0, show_fill=True)[3] == 0.0
    assert middle_of_a_square(tmp_path, fill_id=1, show_fill=False) == [1.0, 0.0, 0.0, 1.0]
    assert middle_of_a_square(tmp_path, fill_id=1, show_fill=True, color=(0.0, 1.0, 0.0, 1.0)) == [
        0.0,
        1.0,
        0.0,
        1.0,
    ]


# Physics


@pytest.mark.parametrize("path", [f"{TYPES}RigidBodyObject", f"{TYPES}Object.location"])
def test_physics_moves_the_matrix_alone(reader: BaseReader, path: str) -> None:
    if path.endswith("location"):
        moved = "moves `ob.matrix_world`, not `ob.location`"
        assert moved in said(reader, path, "where is the rigid body after the simulation")
        assert moved not in said(reader, path, "obj.location = (1, 2)")
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_cube_add(location=(0, 0, 5))
    obj = bpy.context.object
    bpy.ops.rigidbody.object_add(type="ACTIVE")
    for frame in range(1, 15):
        scene.frame_set(frame)
    assert obj.location.z == 5.0
    assert obj.matrix_world.translation.z < 4.5


# Custom properties


def test_a_custom_property_gets_limits_and_choices_as_told(reader: BaseReader) -> None:
    assert ".update(min=0.0, max=2.0" in said(reader, f"{TYPES}bpy_struct.id_properties_ui")
    obj = new_object("o")
    obj["x"], obj["mode"] = 1.0, 0
    obj.id_properties_ui("x").update(min=0.0, max=2.0, description="…")
    assert obj.id_properties_ui("x").as_dict()["max"] == 2.0
    obj["x"] = 5.0
    assert obj["x"] == 5.0
    obj.id_properties_ui("mode").update(items=[("A", "First", ""), ("B", "Second", "")])
    assert [item[0] for item in obj.id_properties_ui("mode").as_dict()["items"]] == ["A", "B"]


# Geometry nodes


def test_a_modifiers_input_takes_an_attribute(kb: KnowledgeBase) -> None:
    answers = map(
        kb.query, ("bpy.types.NodesModifier", "bpy.ops.object.geometry_nodes_input_attribute_toggle")
    )
    notes = ["\n".join(answer.notes) for answer in answers]
    tree = bpy.data.node_groups.new("G", "GeometryNodeTree")
    interface: Any = tree.interface
    for in_out in ("INPUT", "OUTPUT"):
        interface.new_socket("Geometry", in_out=in_out, socket_type="NodeSocketGeometry")
    identifier = interface.new_socket("Size", in_out="INPUT", socket_type="NodeSocketFloat").identifier
    nodes: Any = tree.nodes
    store, given, out = map(
        nodes.new, ("GeometryNodeStoreNamedAttribute", "NodeGroupInput", "NodeGroupOutput")
    )
    store.inputs["Name"].default_value = "out"
    tree.links.new(given.outputs["Geometry"], store.inputs["Geometry"])
    tree.links.new(given.outputs["Size"], store.inputs["Value"])
    tree.links.new(store.outputs["Geometry"], out.inputs["Geometry"])
    mesh = bpy.data.meshes.new("m")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0)], [], [])
    attribute: Any = mesh.attributes.new("name", "FLOAT", "POINT")
    attribute.data[1].value = 7.0
    obj = bpy.data.objects.new("obj", mesh)
    bpy.context.scene.collection.objects.link(obj)
    modifier: Any = obj.modifiers.new("m", "NODES")
    modifier.node_group = tree
    for statement in (
        'modifier[identifier + "_use_attribute"] = True',
        'modifier[identifier + "_attribute_name"] = "name"',
    ):
        assert all(f"`{statement}`" in note for note in notes)
        exec(statement, {"modifier": modifier, "identifier": identifier})
    obj.update_tag()
    made: Any = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    assert [item.value for item in made.attributes["out"].data] == [0.0, 7.0]


# Results in a dictionary


@pytest.mark.parametrize(
    ("name", "given"),
    [
        ("extrude_face_region", "faces"),
        ("bevel", "edges"),
        ("duplicate", "faces"),
        ("convex_hull", "verts"),
        ("triangulate", "faces"),
        ("create_circle", ""),
    ],
)
def test_functions_of_bmesh_ops_return_a_dictionary_of_results(
    kb: KnowledgeBase, name: str, given: str
) -> None:
    bmesh: Any = importlib.import_module("bmesh")  # which is there only after bpy was imported
    mesh = bmesh.new()
    bmesh.ops.create_cube(mesh, size=1.0)
    symbol = kb.symbol(f"bmesh.ops.{name}")
    assert symbol
    taken = {"convex_hull": "input", "triangulate": "faces"}.get(name, "geom")
    arguments = {taken: list(getattr(mesh, given))} if given else {"segments": 3, "radius": 1.0}
    result = getattr(bmesh.ops, name)(mesh, **arguments)
    mesh.free()
    assert isinstance(result, dict)
    assert set(result) == {returned.name for returned in symbol.returns}
    assert "**Returns** a dict with these keys\n" in kb.query(symbol.path).text


def test_what_other_functions_return_is_no_dictionary(kb: KnowledgeBase) -> None:
    assert "**Returns**\n" in kb.query("bpy.types.Object.ray_cast").text


# What Blender lets pass


def test_angles_in_degrees_are_told_to_be_radians(reader: BaseReader) -> None:
    path = f"{TYPES}Object.rotation_euler"
    assert "`ob.rotation_euler.z = math.radians(90)`" in said(reader, path, "use degrees for rotation_euler")
    assert "math.radians" not in said(reader, path, "rotate an object")


def test_a_new_spline_has_a_point(reader: BaseReader) -> None:
    question = "how many points to add to a new spline"
    assert "`spline.points.add(len(path) - 1)`" in said(reader, f"{TYPES}SplinePoints.add", question)
    of_bezier = said(reader, f"{TYPES}SplineBezierPoints.add", question)
    assert "`spline.bezier_points.add(len(path) - 1)`" in of_bezier
    curve = bpy.data.curves.new("curve", "CURVE")
    for kind, points in (("POLY", "points"), ("NURBS", "points"), ("BEZIER", "bezier_points")):
        assert len(getattr(curve.splines.new(kind), points)) == 1
    point = curve.splines[-1].bezier_points[0]
    point.co = 1, 2, 3
    assert tuple(point.handle_left) == (0, 0, 0)


def test_the_value_of_the_first_shape_key_changes_nothing(reader: BaseReader) -> None:
    told = said(reader, f"{TYPES}Object.shape_key_add", "my first shape key has no effect")
    assert '`ob.shape_key_add(name="Basis")` comes before' in told
    bpy.ops.mesh.primitive_cube_add()
    ob = bpy.context.object
    depsgraph = bpy.context.evaluated_depsgraph_get()
    moved: list[float] = []
    for name in ("Smile", "Frown"):
        key = ob.shape_key_add(name=name)
        for point in key.data:
            point.co.z += 9
        heights: list[float] = []
        for value in (0, 1):
            key.value = value
            depsgraph.update()
            heights.append(ob.evaluated_get(depsgraph).data.vertices[0].co.z)
        moved.append(heights[1] - heights[0])
    assert moved == [0, pytest.approx(9)]


def test_what_an_expression_of_a_driver_knows_is_told(reader: BaseReader) -> None:
    told = said(reader, f"{TYPES}Driver.expression", "what functions can I use in a driver expression")
    ob = bpy.data.objects.new("a", None)
    bpy.context.scene.collection.objects.link(ob)
    driver = ob.driver_add("location", 0).driver
    for expression in ("sin(frame / 10)", "clamp(frame)", "lerp(0, 1, 0.5)", "smoothstep(0, 1, 0.5)"):
        assert f"`{expression.partition('(')[0]}" in told
        driver.expression = expression
        bpy.context.scene.frame_set(5)
        assert driver.is_valid


# Simulations


def test_a_simulation_is_stepped_through(reader: BaseReader) -> None:
    question = "position of a rigid body at frame 50 after the simulation"
    assert "scene.frame_set(frame)" in said(reader, f"{TYPES}RigidBodyObject.kinematic", question)
    assert "one frame to the next" not in said(reader, f"{TYPES}Scene.frame_set")
    ended: list[float] = []
    for frames in ([1, 30], range(1, 31)):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.mesh.primitive_cube_add(location=(0, 0, 10))
        obj = bpy.context.object
        bpy.ops.rigidbody.object_add()
        for frame in frames:
            bpy.context.scene.frame_set(frame)
        ended.append(obj.matrix_world.translation.z)
    assert ended[0] == 10.0
    assert ended[1] < 4


def test_a_body_is_let_go_and_its_cache_ends(reader: BaseReader) -> None:
    started = said(reader, f"{TYPES}RigidBodyObject.kinematic", "make a rigid body start moving at frame 30")
    assert '`body.keyframe_insert("kinematic", frame=30)`' in started
    assert "one frame to the next" not in started
    stopped = said(
        reader, f"{TYPES}RigidBodyWorld.point_cache", "why does my rigid body simulation stop at frame 250"
    )
    assert "`scene.rigidbody_world.point_cache.frame_end = 500`" in stopped
    assert "one frame to the next" not in stopped
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_cube_add(location=(0, 0, 10))
    obj, scene = bpy.context.object, bpy.context.scene
    bpy.ops.rigidbody.object_add()
    body = obj.rigid_body
    body.kinematic = True
    body.keyframe_insert("kinematic", frame=29)
    body.kinematic = False
    body.keyframe_insert("kinematic", frame=30)
    scene.frame_end = 400
    for end in (250, 400):
        scene.rigidbody_world.point_cache.frame_end = end
        heights: list[float] = []
        for frame in range(1, 261):
            scene.frame_set(frame)
            heights.append(obj.matrix_world.translation.z)
        assert heights[28] == 10.0 > heights[31]
        assert (heights[250] == heights[259]) == (end == 250)


def test_what_a_simulation_does_is_read_from_the_evaluated_object(reader: BaseReader) -> None:
    question = "world space vertex positions after modifiers"
    assert "`mesh = evaluated.to_mesh()`" in said(reader, f"{TYPES}Object.matrix_world", question)
    assert "to_mesh" not in said(reader, f"{TYPES}Object.matrix_world", "add a modifier to a mesh")
    bpy.ops.mesh.primitive_grid_add(location=(0, 0, 1))
    ob = bpy.context.object
    ob.modifiers.new("w", "WAVE")
    bpy.context.scene.frame_set(20)
    evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    lifted = [vertex.index for vertex in mesh.vertices if (evaluated.matrix_world @ vertex.co).z > 1.001]
    assert lifted
    assert all(ob.data.vertices[index].co.z == 0 for index in lifted)
    evaluated.to_mesh_clear()


def test_what_cloth_bumps_into_needs_a_modifier(reader: BaseReader) -> None:
    told = said(reader, f"{TYPES}ClothCollisionSettings", "cloth collision with an object")
    assert "`other.modifiers.new(\"Collision\", 'COLLISION')`" in told
    assert "COLLISION" not in said(reader, f"{TYPES}ClothCollisionSettings", "make cloth collide with itself")
    heights: list[float] = []
    for is_obstacle in (False, True):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.mesh.primitive_cube_add(size=4)
        if is_obstacle:
            bpy.context.object.modifiers.new("Collision", "COLLISION")
        bpy.ops.mesh.primitive_grid_add(location=(0, 0, 2.2))
        cloth = bpy.context.object
        cloth.modifiers.new("Cloth", "CLOTH")
        for frame in range(1, 21):
            bpy.context.scene.frame_set(frame)
        evaluated = cloth.evaluated_get(bpy.context.evaluated_depsgraph_get())
        heights.append(min((evaluated.matrix_world @ vertex.co).z for vertex in evaluated.data.vertices))
    assert heights[0] < 1.5
    assert heights[1] > 1.9


def test_a_film_has_a_medium_of_its_own(reader: BaseReader) -> None:
    told = said(reader, "bpy.ops.render.render", "render the animation to mp4")
    assert "media_type = 'VIDEO'` comes first" in told
    render = bpy.context.scene.render
    with pytest.raises(TypeError, match="FFMPEG"):
        render.image_settings.file_format = "FFMPEG"
    render.image_settings.media_type = "VIDEO"
    assert render.image_settings.file_format == "FFMPEG"
    render.ffmpeg.format, render.ffmpeg.codec = "MPEG4", "H264"


def test_an_input_of_a_node_is_animated_by_itself(reader: BaseReader) -> None:
    insert = f"{TYPES}bpy_struct.keyframe_insert"
    assert "An input of a node" in said(reader, insert, "how to add keyframes to a shader node value")
    assert "An input of a node" not in said(reader, insert, "node.inputs[0].keyframe_insert('default_value')")
    told = said(reader, f"{TYPES}Material", "keyframe the emission strength of a material")
    assert '.keyframe_insert("default_value", frame=1)`' in told
    tree = bpy.data.materials.new("m").node_tree
    (node,) = (node for node in tree.nodes if node.bl_idname == "ShaderNodeBsdfPrincipled")
    assert node.inputs["Emission Strength"].keyframe_insert("default_value", frame=1)
    assert tree.animation_data.action is not None


def test_a_child_stays_where_it_is(reader: BaseReader) -> None:
    assert "child.matrix_world = world" in said(reader, f"{TYPES}Object.parent", "parent and keep transform")
    bpy.ops.object.armature_add(location=(1, 2, 3), rotation=(0.5, 0.5, 0.5))
    parent = bpy.context.object
    for settings in ({}, {"parent_type": "BONE", "parent_bone": "Bone"}):
        child = bpy.data.objects.new("child", None)
        bpy.context.collection.objects.link(child)
        child.location = (5, 5, 5)
        bpy.context.view_layer.update()
        world = child.matrix_world.copy()
        child.parent = parent
        for name, value in settings.items():
            setattr(child, name, value)
        child.matrix_world = world
        bpy.context.view_layer.update()
        assert child.matrix_world.translation[:] == pytest.approx((5, 5, 5), abs=1e-5)


def test_a_pose_bone_lies_in_the_space_of_its_armature(reader: BaseReader) -> None:
    told = said(reader, f"{TYPES}PoseBone.tail", "world position of a bone's tail")
    assert "`ob.matrix_world @ bone.head`, or `@ bone.tail`" in told
    bpy.ops.object.armature_add(location=(3, 0, 0))
    ob = bpy.context.object
    bone = ob.pose.bones[0]
    assert bone.tail[:] == (0, 0, 1)
    assert (ob.matrix_world @ bone.tail)[:] == (3, 0, 1)


def test_an_object_moves_to_another_collection_by_leaving_its_own(reader: BaseReader) -> None:
    told = said(reader, f"{TYPES}CollectionObjects.link", "move an object to another collection")
    assert "`for other in ob.users_collection: other.objects.unlink(ob)`" in told
    new = bpy.data.collections.new("x")
    bpy.ops.object.empty_add()
    ob = bpy.context.object
    for other in ob.users_collection:
        other.objects.unlink(ob)
    new.objects.link(ob)
    assert ob.users_collection == (new,)


def test_the_body_of_a_text_takes_no_keyframes(reader: BaseReader) -> None:
    assert "takes no keyframes" in said(reader, f"{TYPES}TextCurve.body", "animate the body of a text")
    with pytest.raises(TypeError, match="not animatable"):
        bpy.data.curves.new("t", "FONT").keyframe_insert("body")


def test_simulations_of_geometry_nodes_are_no_point_caches(reader: BaseReader) -> None:
    told = said(reader, "bpy.ops.ptcache.bake_all", "bake the geometry nodes simulation")
    assert "`bpy.ops.object.simulation_nodes_cache_bake(selected=True)`" in told
    assert "simulation_nodes_cache_bake" not in said(reader, "bpy.ops.ptcache.bake_all", "bake cloth")


def test_a_new_rigid_body_world_is_given_a_collection(reader: BaseReader) -> None:
    assert "`scene.rigidbody_world.collection.objects.link(obj)`" in said(
        reader, f"{TYPES}RigidBodyWorld.collection"
    )
    bpy.ops.rigidbody.world_add()
    world = bpy.context.scene.rigidbody_world
    assert (world.collection, world.constraints) == (None, None)
    world.collection = bpy.data.collections.new("Bodies")
    bpy.ops.mesh.primitive_cube_add()
    obj = bpy.context.object
    world.collection.objects.link(obj)
    assert obj.rigid_body


def test_a_canvas_writes_weights_of_vertices_in_the_group(reader: BaseReader) -> None:
    path = f"{TYPES}DynamicPaintSurface.output_name_a"
    assert "`group.add(" in said(reader, path, "weights of a vertex group by dynamic paint")
    assert "`group.add(" not in said(reader, path)


def test_an_aov_is_shown_by_its_name(reader: BaseReader) -> None:
    assert "`space.shading.render_pass = aov.name`" in said(
        reader, f"{TYPES}View3DShading.render_pass", "show an aov"
    )
    bpy.context.view_layer.aovs.add().name = "own"
    shading = bpy.context.scene.display.shading
    shading.render_pass = "own"
    with pytest.raises(TypeError):
        shading.render_pass = "nobody's"


# Modules


def test_a_module_that_was_not_imported_is_to_be_imported(kb: KnowledgeBase) -> None:
    run = (
        "import bpy\ntry: bpy.utils.previews.new()\nexcept AttributeError as error: print(error)\n"
        "import bpy.utils.previews\nbpy.utils.previews.new()"
    )
    ended = subprocess.run(
        [sys.executable, "-P", "-c", run], check=True, capture_output=True, text=True, timeout=60
    )
    message = ended.stdout.strip().splitlines()[-1]
    assert message == "module 'bpy.utils' has no attribute 'previews'"
    answer = kb.query(f"AttributeError: {message}")
    assert answer.hits[0].id == "bpy.utils.previews"
    assert answer.notes[0].endswith("to be imported first: `import bpy.utils.previews`.")


# What is set up otherwise in other versions


def test_a_scene_composes_by_a_group_whose_output_is_the_picture(kb: KnowledgeBase) -> None:
    note = "\n".join(kb.query("how to set up the compositor in python").notes)
    scene = bpy.context.scene
    codes = re.findall(r"`([^`]+)`", note)
    names = {"bpy": bpy, "scene": scene}
    for code in codes[:2]:
        exec(code, names)
    output = names["tree"].nodes.new("NodeGroupOutput")
    exec(codes[2], names)
    assert output.inputs[0].name == "Image"
    assert scene.compositing_node_group == names["tree"]


def test_the_shading_of_a_viewport_is_its_spaces(kb: KnowledgeBase) -> None:
    bpy.ops.wm.read_factory_settings()
    assert "area.spaces.active.shading" in "\n".join(kb.query("set viewport shading to rendered").notes)
    areas = bpy.context.window_manager.windows[0].screen.areas
    shading = next(area for area in areas if area.type == "VIEW_3D").spaces.active.shading
    bpy.context.scene.display.shading.type = "WIREFRAME"
    assert shading.type != "WIREFRAME"
    shading.type = "RENDERED"
    assert shading.type == "RENDERED"


def test_a_transparent_film_is_no_movie(kb: KnowledgeBase) -> None:
    assert "A film:" in "\n".join(kb.query("render a film to mp4").notes)
    assert "A film:" not in "\n".join(kb.query("render with transparent film and save a png").notes)


@pytest.mark.parametrize(
    "query",
    ["links.new(a.outputs[0], h.inputs['Color'])", "NameError: name 'liquid_save_data_4' is not defined"],
)
def test_letters_and_digits_of_variables_ask_for_no_film(query: str, kb: KnowledgeBase) -> None:
    assert "A film:" not in "\n".join(kb.query(query).notes)


def test_it_is_told_when_a_modifier_is_none(kb: KnowledgeBase) -> None:
    (note,) = kb.query("why does modifiers.new return None").notes
    assert note.startswith("`obj.modifiers.new(…)` returns None, without an error")


def test_advice_of_other_versions_is_not_given(reader: BaseReader, monkeypatch: pytest.MonkeyPatch) -> None:
    def told(minor: str) -> str:
        monkeypatch.setitem(reader.meta, "minor", minor)
        return said(reader, "bpy.utils.register_class") + said(reader, f"{TYPES}ObjectModifiers.new", PENCIL)

    assert "crashes Blender" in told("5.1")
    assert "crashes Blender" not in told("5.0")
    assert "GP_NOISE" in told("4.2")
    assert "GP_NOISE" not in told("4.3")


def test_a_boid_gets_a_rule_by_the_settings_in_the_context(reader: BaseReader, tmp_path: Path) -> None:
    (line,) = re.findall("`(with .+?)`", said(reader, "bpy.ops.boid.rule_add"))
    script = f"""
import json, sys
import bpy
bpy.ops.wm.read_factory_settings()
bpy.ops.object.particle_system_add()
psys = bpy.context.object.particle_systems[0]
psys.settings.physics_type = 'BOIDS'
rules = psys.settings.boids.states[0].rules
counts = [len(rules)]
bpy.ops.boid.rule_add(type='FOLLOW_LEADER')
counts.append(len(rules))
{line}
counts.append(len(rules))
open(sys.argv[-1], "w").write(json.dumps(counts))
"""
    before, without, within = told_by_blender(script, tmp_path)
    assert without == before
    assert within == before + 1


def test_smooth_by_angle_is_added_by_an_operator(kb: KnowledgeBase) -> None:
    (note,) = kb.query("smooth by angle modifier").notes
    assert "`bpy.ops.object.shade_auto_smooth(angle=0.5)` adds it" in note
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.object.shade_auto_smooth(angle=0.5)
    assert [modifier.type for modifier in bpy.context.object.modifiers] == ["NODES"]


def test_without_a_window_it_is_added_by_hand_before_5_0(
    reader: BaseReader, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(reader.meta, "minor", "4.5")
    assert "`geometry_nodes/smooth_by_angle.blend`" in said(reader, "bpy.ops.object.shade_auto_smooth")
    monkeypatch.setitem(reader.meta, "minor", "5.0")
    assert "smooth_by_angle.blend" not in said(reader, "bpy.ops.object.shade_auto_smooth")


def light_on_sphere(folder: Path, of_cycles: float, of_object: float) -> list[float]:
    """The pixels of a coarse smooth sphere, with the offsets of its shadow terminator where either is kept."""
    bpy.ops.wm.read_factory_settings()
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 1, False
    scene.render.resolution_x = scene.render.resolution_y = 48
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    bpy.ops.mesh.primitive_uv_sphere_add(segments=8, ring_count=6)
    sphere = bpy.context.object
    sphere.data.shade_smooth()
    sphere.cycles.shadow_terminator_offset = of_cycles
    sphere.shadow_terminator_shading_offset = of_object
    scene.render.filepath = str(folder / "sphere.png")
    bpy.ops.render.render(write_still=True)
    return list(bpy.data.images.load(scene.render.filepath).pixels)


def test_the_shadow_terminator_is_the_objects_own(reader: BaseReader, tmp_path: Path) -> None:
    settings = f"{TYPES}CyclesObjectSettings.shadow_terminator_offset"
    assert "`ob.shadow_terminator_shading_offset`" in said(reader, settings)
    assert light_on_sphere(tmp_path, 1.0, 0.0) == light_on_sphere(tmp_path, 0.0, 0.0)
    assert light_on_sphere(tmp_path, 0.0, 1.0) != light_on_sphere(tmp_path, 0.0, 0.0)


@pytest.mark.parametrize(
    ("question", "is_told"),
    [
        ("read the vertices of the evaluated mesh", True),
        ("evaluate closure node in geometry nodes", False),
        ("evaluate on domain node geometry nodes", False),
    ],
)
def test_a_node_that_evaluates_something_is_no_evaluated_object(
    kb: KnowledgeBase, question: str, is_told: bool
) -> None:
    told = any("`ob.data` is the mesh without modifiers" in note for note in kb.query(question).notes)
    assert told == is_told


def bounce_of(body: float, floor: float) -> float:
    """How high a cube comes back that falls on a floor, each with its restitution."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for height, width, kind, restitution in ((-1, 20, "PASSIVE", floor), (4, 1, "ACTIVE", body)):
        bpy.ops.mesh.primitive_cube_add(location=(0, 0, height), scale=(width, width, 1))
        bpy.ops.rigidbody.object_add(type=kind)
        bpy.context.object.rigid_body.restitution = restitution
    obj, heights = bpy.context.object, []
    for frame in range(1, 50):
        bpy.context.scene.frame_set(frame)
        heights.append(obj.matrix_world.translation.z)
    turns = next(place for place, (now, then) in enumerate(pairwise(heights)) if now < then)
    return max(heights[turns:])


def test_two_bodies_bounce_by_the_product(reader: BaseReader) -> None:
    assert bounce_of(0.9, 0.9) == pytest.approx(bounce_of(0.81, 1), abs=1e-3)
    assert bounce_of(0.9, 0.9) > bounce_of(0.9, 0.5) + 0.5
    assert "the product counts" in said(reader, f"{TYPES}RigidBodyObject.restitution")


@pytest.mark.parametrize(
    ("mass", "air", "fps", "faces"), [(0.03, 1, 24, 2), (0.01, 2, 24, 4), (0.01, 1, 48, 2)]
)
def test_a_sheet_falls_as_fast_as_its_drag_allows(
    reader: BaseReader, mass: float, air: float, fps: int, faces: int
) -> None:
    bpy.context.scene.render.fps = fps
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=faces, y_subdivisions=faces, size=1)
    settings = bpy.context.object.modifiers.new("Cloth", "CLOTH").settings
    settings.mass, settings.air_damping = mass, air
    heights: list[float] = []
    for frame in range(1, 60):
        bpy.context.scene.frame_set(frame)
        shape = bpy.context.object.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        heights.append(fmean(vertex.co.z for vertex in shape.vertices))
    fastest = (heights[-2] - heights[-1]) * fps
    assert fastest == pytest.approx(9.81 * fps / 10 * mass / air, rel=0.02)
    assert "23.5 × `mass` / `air_damping`" in said(reader, f"{TYPES}ClothSettings.air_damping")


# What an override, a frame and an image do not reach


def two_meshes() -> tuple[Any, Any]:
    """Two objects with meshes; the second is selected and active."""
    first, second = (bpy.data.objects.new(name, bpy.data.meshes.new(name)) for name in ("first", "second"))
    for place, obj in enumerate((first, second)):
        obj.data.from_pydata([(place, 0, 0), (place, 1, 0), (place, 0, 1)], [], [(0, 1, 2)])
        bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = second
    second.select_set(True)
    return first, second


def overridden(obj: Any) -> Any:
    return bpy.context.temp_override(
        object=obj, active_object=obj, selected_objects=[obj], selected_editable_objects=[obj]
    )


@pytest.mark.parametrize("exporter", ["obj_export", "stl_export", "ply_export"])
def test_an_override_does_not_choose_what_is_exported(
    reader: BaseReader, exporter: str, tmp_path: Path
) -> None:
    first, _ = two_meshes()
    path = tmp_path / "exported"
    words = {} if exporter == "obj_export" else {"ascii_format": True}
    with overridden(first):
        getattr(bpy.ops.wm, exporter)(filepath=str(path), export_selected_objects=True, **words)
    points = re.findall(
        r"^\s*(?:vertex |v )?(-?[\d.]+) -?[\d.]+ -?[\d.]+$", path.read_text("utf-8"), re.MULTILINE
    )
    assert {float(point) for point in points} == {1.0}
    assert "selected in the view layer" in said(
        reader, f"bpy.ops.wm.{exporter}", "temp_override selected_objects and export"
    )


def test_an_override_does_not_choose_whose_mode_is_set(reader: BaseReader) -> None:
    first, second = two_meshes()
    with overridden(first):
        bpy.ops.object.mode_set(mode="EDIT")
    assert (first.mode, second.mode) == ("OBJECT", "EDIT")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert "the exporters of OBJ" in said(reader, f"{TYPES}Context.temp_override")


def test_a_frame_evaluates_what_is_shown(reader: BaseReader) -> None:
    obj, _ = two_meshes()
    material = bpy.data.materials.new("material")
    for frame, shade in ((1, 0.0), (11, 1.0)):
        material.diffuse_color = (shade, shade, shade, 1)
        material.keyframe_insert("diffuse_color", frame=frame)
    bpy.context.scene.frame_set(6)
    assert material.diffuse_color[0] == 1
    obj.data.materials.append(material)
    bpy.context.scene.frame_set(6)
    assert 0 < material.diffuse_color[0] < 1
    assert "stays as it was" in said(reader, f"{TYPES}Scene.frame_set", "the material stays the same")


def test_python_reads_no_pixels_of_a_multilayer_image(reader: BaseReader, tmp_path: Path) -> None:
    scene, path = bpy.context.scene, tmp_path / "layers.exr"
    scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(scene.camera)
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.resolution_x = scene.render.resolution_y = 8
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    assert (tuple(image.size), len(image.pixels)) == ((0, 0), 0)
    assert "Write each pass to a file" in said(
        reader, f"{TYPES}Image.size", "size of a loaded multilayer exr is 0"
    )


@pytest.mark.parametrize(
    "query",
    [
        "bpy.ops.object.material_slot_remove_unused in temp_override",
        "with bpy.context.temp_override(object=o):\n    bpy.ops.object.location_clear()",
        "bpy.ops.object.mode_set with a context override",
    ],
)
def test_of_operators_that_look_at_no_override_it_is_told(kb: KnowledgeBase, query: str) -> None:
    assert "view layer" in "\n".join(kb.query(query).notes)
    assert "temp_override" not in "\n".join(kb.query("bpy.ops.object.mode_set").notes)
