"""Rules about values and arguments report what Blender refuses, and nothing that it takes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from other_versions import base_of
from statements_in_blender import run_statements

from kb_check.checker import Checker
from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.findings import Finding

SETTING = """\
import bpy, bmesh, mathutils, math, pathlib
from pathlib import Path
from mathutils import Vector, Color, Euler, Quaternion, Matrix
scene = bpy.context.scene
mesh = bpy.data.meshes.new("mesh")
mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
ob = bpy.data.objects.new("object", mesh)
scene.collection.objects.link(ob)
material = bpy.data.materials.new("material")
light = bpy.data.lights.new("light", 'AREA')
camera = bpy.data.cameras.new("camera")
tree = bpy.data.node_groups.new("tree", 'ShaderNodeTree')
principled = tree.nodes.new('ShaderNodeBsdfPrincipled')
mapping = tree.nodes.new('ShaderNodeMapping')
mix = tree.nodes.new('ShaderNodeMix')
bm = bmesh.new()
bm.from_mesh(mesh)
bm.verts.ensure_lookup_table()
image = bpy.data.images.new("image", 2, 2)
cloth = ob.modifiers.new("Cloth", 'CLOTH')
group = ob.vertex_groups.new(name="group")
""".splitlines()

REFUSED = {
    "unknown-attribute": """\
light.energy.value
light.energy.value = 100
light.energy.default_value = 5
scene.frame_end.value
ob.hide_render.value
ob.name.name
ob.display_type.identifier
ob.location.x.real_part
principled.inputs["Roughness"].default_value.x
mesh.vertices.add(1).co
added = mesh.edges.add(1); added.vertices
scene.frame_set(1).name
""",
    "wrong-type": """\
scene.frame_end = 250.0
scene.render.fps = 60 / 2
scene.render.filepath = None
scene.camera = camera
scene.camera = "Camera"
scene.world = material
scene.render.filepath = Path("/tmp")
scene.render.filepath = pathlib.Path.home() / "picture.png"
ob.name = Path("/tmp/name").with_suffix(".x").parent
bpy.data.objects.new(Path("name"), None)
bpy.ops.wm.save_as_mainfile(filepath=Path("/tmp").resolve() / "name.blend", copy=True)
bm.from_mesh("mesh")
bm.from_mesh(ob)
bm.to_mesh(ob)
bm.from_object(ob, bpy.context)
bm.faces.new([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
bm.faces.new(bm.verts[0])
bm.faces.new([0, 1, 2])
bm.edges.new((0, 1))
bm.faces.remove(bm.verts[0])
scene.gravity = 9.81
light.energy = "100"
light.energy = None
light.color = (1, 1, 1, 1)
light.color = "#ff0000"
material.diffuse_color = (1, 0, 0)
material.diffuse_color = Color((1, 0, 0))
ob.location = (1, 2)
ob.location = 5
mix.inputs["A"].default_value = "red"
ob.location = (1, 2, "3")
ob.location = (1, None, 3)
ob.rotation_quaternion = Euler((0, 0, 0))
ob.rotation_euler = Quaternion()
ob.matrix_world = (1, 2, 3)
ob.matrix_world = Euler()
ob.hide_render = "yes"
ob.hide_render = 2
ob.hide_render = 0.5
ob.pass_index = "1"
ob.name = 5
ob.display_type = 3
ob.rotation_mode = None
ob.active_material = "material"
ob.parent = scene
ob.data = material
ob.data = ob
ob.data = scene.collection
bpy.data.objects.new("name", material)
bpy.data.objects.new("name", image)
bpy.data.objects.new("name", tree)
bpy.data.objects.new(name="name", object_data=ob)
bpy.data.objects.new("name", bpy.data.worlds.new("world"))
bpy.data.objects.new("name", cloth)
ob.data.name = 5
ob.location.x = "1"
ob.lock_location = (1, 0, 1)
scene.tool_settings.snap_elements = 'VERTEX'
scene.tool_settings.snap_elements = ['VERTEX']
scene.tool_settings.mesh_select_mode = (0, 1, 0)
principled.inputs["Base Color"].default_value = (1, 0, 0)
principled.inputs["Base Color"].default_value = 1
principled.inputs["Roughness"].default_value = (1, 0, 0)
principled.inputs["Roughness"].default_value = "0.5"
mapping.inputs["Location"].default_value = (1, 2)
cloth.settings.quality = 5.5
scene.collection.objects.link(mesh)
scene.collection.objects.link("object")
bpy.data.objects.new("name", "mesh")
bpy.data.objects.new(5, None)
bpy.data.meshes.remove(ob)
bpy.data.images.new("name", 512.0, 512)
tree.links.new(principled, mapping)
tree.nodes.active = 1
ob.modifiers.new("Cloth", 1)
ob.keyframe_insert(5)
ob.keyframe_insert("location", frame="5")
ob.select_set('SELECT')
ob.ray_cast((0, 0), (0, 0, 1))
group.add([0], "1", 'ADD')
scene.frame_set(1.5)
bpy.ops.mesh.primitive_cube_add(size="1")
bpy.ops.mesh.primitive_cube_add(size=None)
bpy.ops.mesh.primitive_cube_add(location=(1, 2))
bpy.ops.mesh.primitive_cube_add(align=1)
bpy.ops.mesh.primitive_circle_add(vertices=8.0)
Vector("abc")
Vector(5)
Euler("XYZ")
Quaternion(1.0)
Color("red")
Color((1, 1, 1, 1))
Color([1, 1])
Color(Quaternion())
Euler((1, 2))
Euler((1, 2, 3, 4), 'XYZ')
Quaternion((1, 2))
Quaternion((1, 2, 3, 4, 5))
bm.verts.new((1, 2))
bm.verts.new([1, 2, 3, 4])
bm.verts.new(Quaternion())
bmesh.geometry.intersect_face_point(next(iter(bm.faces)), (0, 0))
Matrix.Translation("abc")
Matrix.Translation(3)
Matrix.Diagonal(2)
Matrix.LocRotScale("abc", None, None)
Matrix.LocRotScale((0, 0, 0), None, 2.0)
ob.location.dot("abc")
ob.location.cross(2)
ob.location.lerp(5, 0.5)
ob.location.rotate("XYZ")
ob.rotation_euler.rotate("Z")
ob.rotation_euler.make_compatible(0)
Quaternion().slerp(1, 0.5)
mathutils.geometry.intersect_point_line(0, (1, 0, 0), (0, 1, 0))
mathutils.kdtree.KDTree(1).insert(0, 0)
mathutils.noise.noise(0.5)
""",
    "read-only": """\
ob.type = 'MESH'
ob.users = 5
ob.bound_box = None
ob.vertex_groups = None
mesh.vertices = []
mesh.vertices[0].index = 5
bpy.data.objects = []
bpy.context.object = ob
bpy.context.active_object = ob
bpy.context.selected_objects = []
bpy.context.mode = 'EDIT'
ob.select_set = True
ob.location.length_squared = 1
ob.location.xx = (1, 1)
ob.matrix_world.is_negative = True
bm.verts = []
bm.verts[0].link_edges = []
del ob.name
scene.render.image_settings = None
""",
    "missing-argument": """\
bpy.data.meshes.new()
bpy.data.objects.new("object")
bpy.data.images.new("image", width=5)
ob.modifiers.new("Cloth")
ob.select_set()
ob.keyframe_insert()
tree.links.new(principled.outputs[0])
tree.nodes.new()
scene.frame_set()
mesh.from_pydata([], [])
mathutils.geometry.intersect_line_line((0, 0, 0), (1, 0, 0))
ob.location.lerp((0, 0, 0))
Matrix.Rotation(math.pi, 4)
Matrix.Rotation(math.pi, 3)
""",
    "positional-argument": """\
ob.shape_key_add("Smile")
ob.select_set(True, None)
ob.copy(1)
ob.modifiers.new("Cloth", 'CLOTH', 3)
ob.keyframe_insert("location", 0, 5)
mesh.from_pydata([], [], [], True, 3)
bpy.data.images.new("image", 2, 2, True)
bpy.context.temp_override(ob)
bpy.context.temp_override({"object": ob})
bpy.ops.object.select_all('SELECT')
bpy.ops.mesh.primitive_cube_add((1, 2, 3))
bpy.ops.mesh.primitive_cube_add(2.0)
bpy.ops.mesh.primitive_cube_add('EXEC_DEFAULT', True, 1)
bpy.ops.mesh.primitive_cube_add({"active_object": ob})
""",
    "refused-product": """\
ob.matrix_world * mesh.vertices[0].co
mesh.vertices[0].co * ob.matrix_world
ob.matrix_world.to_quaternion() * ob.location
Quaternion() * Matrix()
Quaternion() @ Matrix()
ob.rotation_euler * ob.location
ob.rotation_euler @ Vector()
light.color * light.color
Vector() * light.color
ob.location * Quaternion()
ob.location *= ob.matrix_world
ob.location @= ob.matrix_world
""",
    "not-subscriptable": """\
scene[0]
ob[None]
mesh.vertices["a"]
mesh.vertices[0] = (0, 0, 0)
mesh.vertices[0] = mesh.vertices[1]
bpy.data.objects[0] = ob
tree.interface.items_tree[1.5]
mesh.vertices[1.5]
bpy.data.objects[::2]
bpy.data.objects[None]
bpy.data.objects[ob]
bpy.types["Object"]
bpy.ops["mesh"]
bpy.context["object"]
scene.render["engine"]
scene.frame_current[0]
bpy.context.selected_objects["Cube"]
bpy.context.window_manager.windows["a"]
tree.links["a"]
principled.inputs[99]
ob.location["x"]
ob.location[3]
ob.location[::2]
ob.rotation_euler[3]
ob.color[4]
ob.color["r"]
ob.matrix_world[0, 1]
bm.verts["a"]
bm.verts[::2]
mesh.vertices.add(1)[0]
points = mesh.vertices.add(1); points[0].co = (0, 0, 0)
""",
}
TAKEN = """\
scene.frame_end = 250
scene.render.filepath = str(Path("/tmp"))
scene.render.filepath = Path("/tmp").as_posix()
scene.render.filepath = (Path("/tmp") / "name").name
bmesh.new().from_mesh(ob.data)
bmesh.new().from_object(ob, bpy.context.evaluated_depsgraph_get())
bm.edges.new(bm.verts[:2]) if not bm.edges else None
bm.edges.get((bm.verts[0], bm.verts[1]))
bm.faces.get(set(bm.verts))
bm.faces.get(vert for vert in bm.verts)
bm.verts.new((0, 0, 0), bm.verts[0]); bm.verts.ensure_lookup_table()
bm.verts.new((0, 0, 0), None); bm.verts.ensure_lookup_table()
scene.render.fps = int(60 / 2)
scene.render.fps = round(23.976)
scene.render.fps = sum([12, 12])
scene.render.fps = 60 // 2
scene.render.fps = 2 ** 4
scene.camera = None
scene.gravity = [0, 0, -9]
light.energy = 100
light.energy = True
light.color = Vector((1, 1, 1))
light.color = {0.1, 0.2, 0.3}
material.diffuse_color = [1, 0, 0, 1]
material.diffuse_color = Quaternion()
ob.location = range(3)
ob.location = Color((1, 0, 0))
ob.location.x = True
ob.location[0] = 1
ob.location[-1] = 1
ob.location[0:2] = (1, 2)
ob.matrix_world = Matrix()
ob.matrix_world = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
ob.matrix_world.translation.x = 1
ob.hide_render = 1
ob.pass_index = True
ob.parent = None
ob.data = bpy.data.meshes.new("other")
ob.data.materials.append(material); ob.data.materials[0] = material; ob.data.materials[0] = None
ob.data.vertices
ob.lock_location = (True, False, True)
ob.lock_location[0] = 1
ob.name = "5" * 3
ob.name = 3 * "5"
scene.tool_settings.snap_elements = {'VERTEX'}
image.pixels = [0] * 16
image.pixels = (0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)
principled.inputs["Base Color"].default_value = (1, 0, 0, 1)
principled.inputs["Roughness"].default_value = 1
principled.inputs[5]
tree.links.new(principled.outputs[0], mapping.inputs[0])
geometry = bpy.data.node_groups.new("geometry", 'GeometryNodeTree')
number = geometry.nodes.new("FunctionNodeRandomValue")
number.inputs["Min"].default_value = 0.5
number.data_type = 'FLOAT_VECTOR'
number.inputs["Min"].default_value = (0, 0, 0.5)
mix.data_type = 'RGBA'
mix.inputs["A"].default_value = (1, 0, 0, 1)
mix.inputs[6].default_value = (1, 0, 0, 1)
switch = geometry.nodes.new("GeometryNodeSwitch")
switch.input_type = 'STRING'
switch.inputs["False"].default_value = "no"
switch.inputs[2].default_value = "yes"
geometry.interface.new_socket("Size", socket_type='NodeSocketFloat')
geometry.interface.items_tree["Size"].default_value = 2
subdivision = ob.modifiers.new("", 'SUBSURF')
ob.modifiers["Subdivision"].levels = 2
bevel = ob.modifiers.new("Edges", 'BEVEL')
ob.modifiers["Edges"].segments = 2
either = ob.modifiers.new("Either", 'BEVEL')
either = ob.modifiers.new("Either", 'MIRROR')
ob.modifiers["Either.001"].use_axis[0] = True
follow = ob.constraints.new('FOLLOW_PATH')
follow.name = "Follow"
ob.constraints["Follow"].offset_factor = 0.5
solidify = ob.modifiers.new("Lattice", 'SOLIDIFY')
ob.modifiers["Lattice"].thickness = 2
tree.nodes["Mix"].data_type = 'RGBA'
tree.nodes["Mix"].inputs[7]
bpy.data.objects.new("name", None)
bpy.data.objects.new("name", light)
bpy.data.objects.new("name", bpy.data.curves.new("curve", 'FONT'))
bpy.data.objects.new("name", bpy.data.hair_curves.new("hair"))
bpy.data.objects.new("name", bpy.data.lightprobes.new("probe", 'PLANE'))
bpy.data.objects.new("name", bpy.data.grease_pencils.new("pencil"))
bpy.data.objects.new("name", None).data = image
bpy.data.objects[-1]
bpy.data.objects[:][::2]
bpy.data.objects[True]
ob.matrix_world @ mesh.vertices[0].co
mesh.vertices[0].co @ ob.matrix_world
ob.location * Vector((1, 2, 3))
Quaternion() @ ob.location
light.color * 2
2 * ob.matrix_world
ob.matrix_world *= 2
ob.matrix_world @= Matrix()
light.energy.is_integer()
light.energy.real
scene.frame_end.bit_length()
ob.hide_render.real
ob.name.upper().lower()
ob.display_type.lower()
mesh.vertices.add(1)
nothing = mesh.vertices.add(1)
nothing = mesh.vertices.add(1) or mesh.vertices; nothing[0].co
result = mesh.vertices.add(1); result.co if result else None
made = scene.collection.children.link(bpy.data.collections.new("made")) or bpy.data.collections["made"]; made.name
scene["property"] = 5
scene["property"]
mesh.vertices
bpy.data.meshes.new("quad").from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2, 3)])
bpy.data.meshes["quad"].polygons[0].vertices[3]
bm.verts[-1]
bm.verts[0].co = (0, 0, 1)
bm.verts[0].co.x = 1
ob.vertex_groups.new(name="other")
group.add(range(0), 1, 'ADD')
ob.select_set(1)
ob.select_set(True, view_layer=None)
ob.shape_key_add(name="Smile", from_mix=1)
ob.keyframe_insert("location", index=0, frame=5)
scene.frame_set(5, subframe=0.5)
bpy.context.temp_override(object=ob, active_object=ob)
bpy.ops.mesh.primitive_cube_add(size=2, location=(0, 0, 1))
bpy.ops.mesh.primitive_cube_add('EXEC_DEFAULT', True)
bpy.ops.mesh.primitive_circle_add('EXEC_DEFAULT', vertices=8)
Matrix.Rotation(1, 2)
Matrix.Rotation(math.pi, 4, 'X')
Matrix.Rotation(math.pi, 4, (0, 0, 1))
Matrix.Scale(2, 4)
Matrix.LocRotScale(None, None, (1, 2, 3))
Vector(range(3))
Vector(b"ab")
Euler(ob.location, 'ZYX')
Quaternion((1, 0, 0), math.pi)
Quaternion((1, 0, 0))
Quaternion(Color())
Euler(Color())
Color(Vector((1, 1, 1)))
bm.verts.new((1, 2, 3))
bm.verts.new(ob.location)
bm.verts.new(Color())
Color()
mathutils.noise.noise(ob.location)
mathutils.geometry.intersect_point_line([0, 0, 0], (1, 0, 0), ob.location)
Vector.Range(4)
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=bm.verts)
""".splitlines()


def found_at(checker: Checker, lines: list[str], first: int) -> dict[int, list[Finding]]:
    """Place of a statement → the errors that are found in it; the setting, which is right, comes before."""
    found: dict[int, list[Finding]] = {}
    for finding in checker.check("\n".join(lines), rules=list(REFUSED)):
        found.setdefault(finding.span.line - 1 - first, []).append(finding)
    return found


def test_what_blender_takes_is_no_finding(rule_checker: Checker, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [*SETTING, *TAKEN])
    assert [line for line, (error, *_) in zip([*SETTING, *TAKEN], answers, strict=True) if error] == []
    assert found_at(rule_checker, [*SETTING, *TAKEN], len(SETTING)) == {}


@pytest.mark.parametrize("rule", REFUSED)
def test_what_blender_refuses_is_found(rule_checker: Checker, tmp_path: Path, rule: str) -> None:
    lines = REFUSED[rule].splitlines()
    answers = run_statements(tmp_path, [*SETTING, *lines])[len(SETTING) :]
    assert [line for line, (error, *_) in zip(lines, answers, strict=True) if not error] == []
    found = found_at(rule_checker, [*SETTING, *lines], len(SETTING))
    assert [line for place, line in enumerate(lines) if place not in found] == []
    assert {finding.rule for findings in found.values() for finding in findings} == {rule}


@pytest.mark.parametrize("rule", REFUSED)
def test_sure_fixes_run(rule_checker: Checker, tmp_path: Path, rule: str) -> None:
    lines = REFUSED[rule].splitlines()
    fixed: list[str] = []
    for place, findings in found_at(rule_checker, [*SETTING, *lines], len(SETTING)).items():
        fixes = [finding.fix for finding in findings if finding.fix and finding.fix.sure]
        text = lines[place]
        edits = [edit for fix in fixes for edit in fix.edits]
        for edit in sorted(edits, key=lambda edit: edit.span.column, reverse=True):
            text = text[: edit.span.column] + edit.text + text[edit.span.end_column :]
        if edits:
            fixed.append(text)
    answers = run_statements(tmp_path, [*SETTING, *fixed])[len(SETTING) :]
    assert [(line, error) for line, (error, *_) in zip(fixed, answers, strict=True) if error] == []


_SPELT: str = """\
import bpy
r = bpy.context.scene.render
bpy.context.scene.render.image_settings.media_type = 'VIDEO'
r.image_settings.file_format = 'PNG'
scene = bpy.context.scene
settings = scene.render.image_settings
r.image_settings.media_type = 'IMAGE'
settings.file_format = 'PNG'
settings.file_format = 'FFMPEG'
"""


def test_a_part_of_the_scene_is_one_by_a_name_and_written_out(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _SPELT.splitlines()
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = rule_checker.check(_SPELT, rules=["refused-value"])
    assert [one.span.line for one in found] == refused == [4, 9]
    # Of another scene nothing is known.
    other = _SPELT.replace(
        "bpy.context.scene.render.image", "bpy.ops.scene.new()\nbpy.context.scene.render.image", 1
    )
    assert 5 not in [one.span.line for one in rule_checker.check(other, rules=["refused-value"])]


@pytest.mark.blender
def test_names_that_a_later_blender_lost_are_taken_before() -> None:
    with Checker(base_of("3.4")) as checker:
        names = ("2D_UNIFORM_COLOR", "3D_FLAT_COLOR", "UNIFORM_COLOR")
        code = "import gpu\n" + "".join(f"gpu.shader.from_builtin({name!r})\n" for name in names)
        assert checker.check(code) == []


@pytest.mark.blender
def test_a_copy_of_the_context_is_a_dictionary_in_each_version() -> None:
    with Checker(base_of("4.2")) as checker:
        code = (
            "import bpy\ncontext = bpy.context.copy()\nbpy.ops.object.select_all(context, action='SELECT')\n"
        )
        (found,) = checker.check(code)
    assert found.severity == "error"
    assert found.span.line == 3


_UNSET = """\
import bpy
scene = bpy.context.scene
settings = scene.render.image_settings
"""


def test_the_setting_that_a_value_needs_is_set_by_the_fix(rule_checker: Checker, tmp_path: Path) -> None:
    for line in (
        "scene.render.image_settings.file_format = 'FFMPEG'", "settings.file_format = 'OPEN_EXR_MULTILAYER'",
    ):  # fmt: skip
        code = _UNSET + line
        found = rule_checker.check(code, rules=["refused-value"])
        assert [one.span.line for one in found] == [4]
        mended = apply_fixes(Source(code), found).text.splitlines()
        assert len(mended) == 5
        answers = run_statements(tmp_path, mended)
        assert [error for error, *_ in answers] == [""] * 5
