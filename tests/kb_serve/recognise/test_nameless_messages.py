"""Messages that name nothing of the API, as this environment's Blender says them, and what they lead to."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from places import REPO
from told_by_blender import told_by_blender

from kb_build.summaries.shipped import ShippedSummary
from kb_serve.recognise.messages.nameless_messages import NAMELESS_MESSAGES

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

_STATEMENTS = """\
one, two = (1,)
bpy.data.objects("Cube")
ob.material_slots[0] = bpy.data.materials.new("m")
import mathutils; mathutils.Matrix(1, 2, 3)
lost_image(); bpy.ops.object.bake()
bpy.types.Scene.own = bpy.props.FloatProperty(update=lambda self: None)
bpy.types.Scene.own = bpy.props.EnumProperty(items=lambda self: [])
registered("Operator", execute=lambda self: {"FINISHED"})
bpy.data.objects.new("o", None).select_set(True)
bpy.ops.mesh.primitive_cube_add().location
bpy.ops.mesh.primitive_cube_add()[0]
bpy.data.libraries.write("x.blend", [ob])
bm = bmesh.new(); three = [bm.verts.new((x, x * x, 0)) for x in range(3)]; bm.faces.new(three); bm.faces.new(three)
bm = bmesh.new(); ends = [bm.verts.new((x, 0, 0)) for x in range(2)]; bm.edges.new(ends); bm.edges.new(ends)
group = ob.vertex_groups.new(name="g"); bpy.ops.object.mode_set(mode="EDIT"); group.add([0], 1.0, "ADD")
bpy.ops.object.empty_add(); bpy.ops.rigidbody.constraint_add(type="FIXED")
bpy.context.view_layer.objects.active = bpy.data.objects.new("o", None)
bpy.context.collection.objects.link(ob)
scene.collection.children.link(bpy.data.collections["Collection"])
scene.collection.objects.unlink(ob)
bpy.data.objects.new("o", mesh).ray_cast((0, 0, 5), (0, 0, -1))
bpy.data.objects.new("o", mesh).closest_point_on_mesh((0, 0, 0))
ngon().calc_tangents()
bpy.ops.object.mode_set(mode="EDIT"); bmesh.new().to_mesh(mesh)
bpy.data.meshes.new("m").vertices.foreach_set("co", [0.0] * 9)
mesh.vertices.foreach_set("co", [0.0] * 9)
mesh.vertices.foreach_set("co", [(0.0, 0.0, 0.0)] * len(mesh.vertices))
bpy.context.scene.sequence_editor_create().strips.new_effect("t", "TEXT", 1, 1)
ob.vertex_groups.new(name="g").weight(0)
bpy.data.hair_curves.new("h").add_curves([0])
ob.shape_key_add(name="a"); ob.modifiers.new("s", "SUBSURF"); bpy.ops.object.modifier_apply(modifier="s")
double(); ob.modifiers.new("s", "SUBSURF"); bpy.ops.object.modifier_apply(modifier="s")
double(); bpy.ops.object.transform_apply()
nodes()["Socket_0"] = "A"
nodes()["Socket_9"]
grouped()["grouped"] = {}
grouped()["grouped"]["number"] = "A"
ob.modifiers.new("w", "WAVE")["a"] = 1
ob.modifiers.new("w", "WAVE").keys()
scene.cycles.device = "CUDA"
bpy.props.IntProperty()["default"]
bpy.props.IntProperty() + 1
register_operator_with_own_init(); bpy.ops.wm.made()
import gpu; gpu.types.GPUShader("", "")
tree().nodes.new("NodeGroupInput").outputs.new("NodeSocketFloat", "x")
n = node(); n.id_data.links.new(n.inputs[0], n.inputs[1])
track.strips.new("s", 1, action); track.strips.new("t", 1, action)
ob.keyframe_insert("nothing")
ob.driver_add("nothing")
v = ob.driver_add("location", 0).driver.variables.new(); v.type = "TRANSFORMS"; v.targets[0].id_type = "OBJECT"
ob.keyframe_delete("location[0]")
ob.driver_add("location[0]")
ob.driver_remove("location[0]")
scene.camera = None; bpy.ops.render.render()
bpy.ops.object.bake(type="DIFFUSE")
scene.render.engine = "CYCLES"; bpy.ops.object.select_all(action="DESELECT"); bpy.ops.object.bake(type="DIFFUSE")
bpy.ops.fluid.bake_all()
ob.modifiers.new("f", "FLUID").fluid_type = "FLOW"; bpy.ops.fluid.bake_all()
bpy.data.images.load("/none.png")
open("//none.csv")
import mathutils; hash(mathutils.Vector((1, 2, 3)))
import mathutils; mathutils.Matrix().invert() @ mathutils.Vector()
import mathutils; mathutils.Vector() + mathutils.Vector().normalize()
import mathutils; mathutils.Matrix.Identity(3) @ mathutils.Matrix.Identity(4)
import mathutils; mathutils.Vector((1, 2, 3)).to_track_quat("Z", "Z")
bpy.data.libraries.load("/none.blend").__enter__()
bpy.ops.wm.save_as_mainfile(filepath="none/x.blend")
bpy.ops.wm.obj_import(filepath="/none.obj")
bpy.ops.preferences.addon_enable(module="nothing")
bpy.ops.object.mode_set(mode="POSE")
bpy.ops.object.empty_add(); bpy.ops.object.mode_set(mode="EDIT")
menu().default_value = "A"
scene.tool_settings.snap_elements = "VERTEX"
registered("Operator"); bpy.utils.register_class(made[-1])
bpy.utils.register_class(type("Plain", (), {}))
bpy.utils.unregister_class(type("Never", (bpy.types.Operator,), {}))
registered("Panel", bl_idname="my_panel", bl_space_type="VIEW_3D", bl_region_type="UI")
registered("Panel", bl_space_type="VIEW_3D", bl_region_type="TOOLS", bl_category="Tools")
registered("Menu", bl_idname="my_menu")
registered("Operator", bl_idname="tool")
registered("Operator", execute=lambda self, context: None); bpy.ops.wm.made()
restricted(); _bpy_restrict_state._bpy.context.scene
restricted(); _bpy_restrict_state._bpy.data.objects
scene.render.engine = "CYCLES"; bpy.ops.object.bake(type="DIFFUSE"); bpy.ops.object.bake(type="DIFFUSE")
scene.render.engine = "CYCLES"; mesh.materials.clear(); bpy.ops.object.bake(type="DIFFUSE")
cycle()
ob.location = (1, 2, 3, 4)
bpy.data.objects.new("o", ob)
bpy.data.objects.new("o", bpy.data.annotations.new("a"))
bmesh.new().verts[0]
bmesh.new().from_mesh(ob)
ob.modifiers.new("b", "BOOLEAN"); bpy.ops.object.modifier_apply(modifier="b")
bpy.data.objects[1.0]
bpy.data.objects.get("none")[0]
for _ in bpy.data.objects.get("none"): pass
len(bpy.data.objects.get("none"))
"x" in bpy.data.objects.get("none")
scene.camera.parent + 1
mathutils.Vector((1, 2, 3)) + mathutils.Vector((1, 2))
mathutils.Vector((1, 2, 3)) - (1, 2, 3)
mathutils.Matrix() @ (1, 2, 3)
[1, 2, 3] * mathutils.Vector((1, 2, 3))
ob.keyframe_insert("location.x")
ob.keyframe_insert("location", 10)
film(); bpy.ops.render.render(write_still=True)
bpy.ops.wm.open_mainfile(filepath="/none.blend")
bpy.ops.wm.save_mainfile()
bpy.ops.import_scene.gltf(filepath="/none.glb")
bpy.data.actions.new("other").fcurve_ensure_for_datablock(ob, "location")
ob.driver_add("location").driver
bpy.data.objects.new("o", mesh).animation_data_create().action_slot = action.slots.new("MESH", "m")
ob.animation_data.action = action; ob.animation_data.action_slot = action.slots.new("MESH", "m")
drawing().strokes[3]
bpy.data.curves.new("c", "CURVE").splines.new("BEZIER").points.add(1)
bpy.data.armatures.new("a").edit_bones.new("b")
bpy.data.images.new("i", 8, 8).save()
nodes()["Input_2"]
tree().interface.items["x"]
ob.dimensions = 1
bpy.ops.constraint.followpath_path_animate(constraint="Follow Path")
scene.render.engine = "CYCLES"; bpy.ops.object.bake(type="COMBINED", pass_filter={"DIRECT", "COLOR"})
ob.asset_mark(); marked()
loops_layer_of_a_vertex()
scene["set"] = {1, 2}
scene["list"] = [1, "a"]
scene["keys"] = {1: 2}
bm = bmesh.new(); bm.verts.new()[bm.verts.layers.float.active]
ob.evaluated_geometry()
ob.matrix_world @ ob.bound_box[0]
mesh.vertices[::2]
armature(); bpy.ops.pose.constraint_add(type="IK")
armature(); bpy.ops.constraint.childof_set_inverse(constraint="Child Of", owner="BONE")
action.layers.new("l").strips.new(type="KEYFRAME"); action.layers[0].strips.new(type="KEYFRAME")
action.layers.new("l"); action.layers.new("m")
b"\\x98".decode()
bpy.msgbus.subscribe_rna(key=ob, owner=ob, args=(), notify=ob.select_get)
bpy.utils.units.to_string("LENGTH", "METRIC", 3)
bpy.utils.units.to_value("METRIC", "LENGHT", "3mm")
registered("Panel", name="my_PT_panel", bl_space_type="VIEW_3D", bl_region_type="UI")
bpy.types.Scene.made = bpy.props.CollectionProperty(type=bpy.types.Object)
bpy.data.libraries.load(saved()).__enter__()
file = saved(); bpy.ops.wm.append(directory=f"{file}/Object/", filename="Cube")
bpy.ops.wm.append(filepath="/none.blend/Object/Cube")
ob.animation_data.action = action; ob.animation_data.action_slot = bpy.data.actions.new("o").slots.new("OBJECT", "o")
bmesh.from_edit_mesh(mesh)
bpy.ops.object.mode_set(mode="EDIT"); mesh.from_pydata([(0, 0, 0)], [], [])
bpy.data.meshes.remove(ob.to_mesh())
bpy.data.meshes.new_from_object(bpy.data.objects["Camera"])
bpy.ops.object.mode_set(mode="EDIT"); bpy.ops.object.join()
ob.convert_space(to_space="POSE")
ob.matrix_world = [1.0] * 16
bpy.data.images["Render Result"].save()
scene.sequence_editor_create().strips.new_effect("c", "CROSS", 1, frame_start=1, length=5)
del ob["x"]
ob.id_properties_ui("x")
[o for o in bpy.data.objects if o.type == "FONT"][0]
bpy.app.timers.register(ob.select_get())
bpy.ops.wm.stl_import(filepath="/none.stl")
bpy.ops.wm.usd_import(filepath="/none.usd")
bpy.ops.import_scene.fbx(filepath="/none.fbx")
bpy.data.images["Render Result"].pixels[0]
ob.location.x = "1"
bpy.types.Scene.made = bpy.props.PointerProperty(type=bpy.types.MeshVertex)
bpy.types.Scene.made = bpy.props.PointerProperty(type=type("Unknown", (bpy.types.PropertyGroup,), {}))
bpy.app.timers.unregister(print)
del bpy.data.objects["Cube"]
bpy.types.SpaceView3D.draw_handler_add(print, (), "WINDOW", "POST_DRAW")
bpy.types.SpaceView3D.draw_handler_add(print, (), "VIEW", "POST_PIXEL")
bpy.types.SpaceView3D.draw_handler_add(print, None, "WINDOW", "POST_PIXEL")
bpy.types.SpaceView3D.draw_handler_remove(None, "WINDOW")
bpy.data.images.new("i", 8, 8).pixels.foreach_get(numpy.empty(256))
bpy.data.images.new("i", 8, 8).pixels.foreach_set([0.0] * 3)
stored()
range(1.5)
round("a")
ob in bpy.data.objects
(lambda scene, depsgraph: None)(scene)
x, y = ob.location
bpy.ops.object.select_all("SELECT")
ob.name = None
ob["a" * 70] = 1
bpy.data.images.new("i", 8, 8).pixels[:] = [0.0] * 255
bpy.data.images.new("i", 8, 8).pixels = [0.0]
mesh.polygons[0].vertices = [0, 1]
ob.material_slots["x", 1]
mesh.materials[0] = "m"
ob.location[:] = (1, 2)
ob.matrix_world[0] = (1, 2, 3)
ob.location[3] = 1
mesh.normals_split_custom_set([(0, 0, 1)])
locked()
chosen(items=lambda self, context: [("A", "A", "")], default="A")
chosen(items=[("A", "A", "")], default="B")
registered("UIList", name="plain", bl_label=None)
registered("Header", name="header", bl_space_type="VIEW_3D")
registered("Operator", bl_idname=3)
enabled("older", blender_version_max="4.2.1")
enabled("empty", is_whole=False)
bpy.context.preferences.addons["cycles"].preferences.compute_device_type = "GPU"
json.dumps(ob.location)
[1, 2][ob.location.x]
"x" * ob.location.x
mesh.vertices["Cube"]
bpy.data.libraries.load(copied()).__enter__()[0].material
mesh.vertices[0].values = 2
"Objects: " + len(bpy.data.objects)
unbound()
sum(v.co for v in mesh.vertices)
ob.location = ob.matrix_world
ob.matrix_world = mathutils.Matrix.Identity(3)
ob.rotation_euler + ob.rotation_euler
registered("Panel", bl_space_type="PROPERTIES", bl_region_type="TOOLS")
bpy.ops.extensions.package_install(repo_index=0, pkg_id="x")
(1, 2, 3) * 0.5
ob.hide_render()
ob.location.x()
scene.frame_current()
[ob]()
ob.name()
ob.users_collection()
ob.location()
ob.matrix_world()
ob.rotation_euler()
bpy.data.materials[0].diffuse_color()
ob.bound_box[0] * 0.5
"%.2f" % ob.location
f"{ob.location:.2f}"
round(ob.location, 2)
abs(ob.location)
mathutils.Vector((0, 0, 0)).angle(ob.scale)
mathutils.Matrix.Scale(0, 4).inverted()
mathutils.Matrix.Identity(3) @ mathutils.Vector((1, 2, 3, 4))
mathutils.Vector((1, 2, 3, 4)) @ mathutils.Matrix.Identity(3)
""".splitlines()
_RUN = """
import json, os, sys, tempfile
import numpy
import bpy, bmesh, mathutils
import addon_utils
import _bpy_restrict_state

def ngon():
    mesh = bpy.data.meshes.new("m")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0)], [], [(0, 1, 2, 3, 4)])
    mesh.uv_layers.new()
    return mesh

def double():
    scene.collection.objects.link(bpy.data.objects.new("o", mesh))

def tree():
    return bpy.data.node_groups.new("g", "GeometryNodeTree")

def node():
    return tree().nodes.new("ShaderNodeMath")

def menu():
    return tree().interface.new_socket("Mode", in_out="INPUT", socket_type="NodeSocketMenu")

def nodes():
    group = tree()
    group.interface.new_socket("Count", in_out="INPUT", socket_type="NodeSocketInt")
    modifier = ob.modifiers.new("m", "NODES")
    modifier.node_group = group
    return modifier

made = []

def registered(base, name="Made", **members):
    members = {"bl_label": "x", "draw": lambda self, context: None, **members}
    if base == "Operator":
        members.setdefault("bl_idname", "wm.made")
    made.append(type(name, (getattr(bpy.types, base),), members))
    bpy.utils.register_class(made[-1])

def grouped():
    annotations = {"number": bpy.props.IntProperty()}
    group = type("Group", (bpy.types.PropertyGroup,), {"__annotations__": annotations})
    bpy.utils.register_class(group)
    bpy.types.Scene.grouped = bpy.props.PointerProperty(type=group)
    scene.grouped.number = 1
    return scene.bl_system_properties_get()

def register_operator_with_own_init():
    def __init__(self):
        bpy.types.Operator.__init__(self)

    registered("Operator", __init__=__init__, execute=lambda self, context: {"FINISHED"})

def restricted():
    restriction.append(_bpy_restrict_state.RestrictBlend())
    restriction[-1].__enter__()

def lost_image():
    scene.render.engine = "CYCLES"
    nodes = ob.data.materials[0].node_tree.nodes
    node = nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("Lost", 8, 8)
    node.image.source = "FILE"
    node.image.filepath = "/lost.png"
    nodes.active = node

def cycle():
    other = bpy.data.objects["Camera"]
    ob.parent = other
    other.constraints.new("COPY_LOCATION").target = ob
    bpy.context.view_layer.update()

def drawing():
    return bpy.data.grease_pencils.new("g").layers.new("l").frames.new(1).drawing

def loops_layer_of_a_vertex():
    bm = bmesh.new()
    layer = bm.loops.layers.uv.new()
    bm.verts.new()[layer]

def armature():
    bpy.ops.object.armature_add()
    bpy.ops.object.mode_set(mode="POSE")
    bpy.context.object.data.bones.active = None

def saved():
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(tempfile.mkdtemp(), "a.blend"))
    return bpy.data.filepath

def copied():
    file = os.path.join(tempfile.mkdtemp(), "b.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file, copy=True)
    return file

def unbound():
    if not scene:
        found = ob
    return found

def marked():
    with bpy.context.temp_override(id=ob):
        bpy.ops.asset.mark()

def film():
    scene.render.engine = "CYCLES"
    settings = scene.render.image_settings
    settings.media_type = "VIDEO"
    settings.file_format = "FFMPEG"

def locked():
    ob.keyframe_insert("location", frame=1)
    ob.animation_data.action.layers[0].strips[0].channelbags[0].fcurves[0].lock = True
    ob.keyframe_insert("location", index=0, frame=5)

def chosen(**settings):
    group = type("Group", (bpy.types.PropertyGroup,), {"__annotations__": {"p": bpy.props.EnumProperty(**settings)}})
    bpy.utils.register_class(group)

def enabled(name, is_whole=True, **manifest):
    repos = bpy.context.preferences.extensions.repos
    repository = repos.new(name="own", module="own", custom_directory=tempfile.mkdtemp())
    folder = os.path.join(repository.directory, name)
    os.makedirs(folder, exist_ok=True)
    told = {"schema_version": "1.0.0", "id": name, "version": "1.0.0", "name": "x", "tagline": "x", "maintainer": "x",
            "type": "add-on", "blender_version_min": "4.2.0", "license": ["SPDX:GPL-3.0-or-later"], **manifest}
    with open(os.path.join(folder, "blender_manifest.toml"), "w") as file:
        file.write("".join(f"{key} = {json.dumps(value)}\\n" for key, value in told.items()))
    if is_whole:
        open(os.path.join(folder, "__init__.py"), "w").close()
    addon_utils.extensions_refresh()
    bpy.ops.preferences.addon_enable(module=f"bl_ext.{repository.module}.{name}")

def stored():
    for name, number in (("A", 1), ("B", 2)):
        bpy.types.Scene.chosen = bpy.props.EnumProperty(items=[(name, name, "", number)])
        if name == "A":
            scene.chosen = name
    assert scene.chosen == ""

restriction = []
printed = tempfile.TemporaryFile()
for stream in (1, 2):
    os.dup2(printed.fileno(), stream)

def said_by_printing():
    printed.seek(0)
    text = printed.read().decode()
    printed.seek(0)
    printed.truncate()
    return text

messages = []
for line in json.load(open(sys.argv[-1])):
    bpy.ops.wm.read_factory_settings()
    scene = bpy.context.scene
    ob = bpy.data.objects["Cube"]
    bpy.context.view_layer.objects.active = ob
    mesh = ob.data
    action = bpy.data.actions.new("a")
    track = ob.animation_data_create().nla_tracks.new()
    said_by_printing()
    try:
        exec(line)
        said = ""
    except Exception as error:
        said = f"{type(error).__name__}: {str(error).strip()}"
        if "(see previous error)" in said:
            said = f"{said_by_printing().strip()} {said}"
    while restriction:
        restriction.pop().__exit__(None, None, None)
    sys.stdout.flush()
    messages.append(said or said_by_printing().strip())
open(sys.argv[-1], "w").write(json.dumps(messages))
"""


@pytest.fixture(scope="module")
def messages(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """What Blender says to each of the statements."""
    return told_by_blender(_RUN, tmp_path_factory.mktemp("messages"), _STATEMENTS)


def test_blender_says_each_of_the_messages(messages: list[str]) -> None:
    assert [line for line, said in zip(_STATEMENTS, messages, strict=True) if not said] == []
    unsaid = [one for one in NAMELESS_MESSAGES if not any(one.is_in(said) for said in messages)]
    assert unsaid == []


def test_a_message_that_begins_with_a_name_is_known_without_its_quotes(messages: list[str]) -> None:
    told = [
        (one, said)
        for one in NAMELESS_MESSAGES
        for said in messages
        if re.match(r"'\w+' object", one.parts[0]) and one.is_in(said)
    ]
    bare = {said: said.replace("'", "").replace('"', "") for _, said in told}
    assert all(one.is_in(bare[said]) for one, said in told)
    assert all(sum(one.is_in(text) for one in NAMELESS_MESSAGES) == 1 for text in bare.values())
    assert len(bare) > 4


def test_a_part_that_begins_with_a_quote_begins_with_a_word() -> None:
    known = [one for one in NAMELESS_MESSAGES if one.parts[0].startswith("'set' object")]
    assert any(one.is_in("AttributeError: set object has no attribute location") for one in known)
    assert not any(one.is_in("AttributeError: Dataset object has no attribute location") for one in known)


def test_each_message_leads_to_what_it_is_about(kb: KnowledgeBase, messages: list[str]) -> None:
    told = [
        one
        for one in NAMELESS_MESSAGES
        if kb.symbol(one.paths[0]) and not (one.lacking and kb.symbol(one.lacking))
    ]
    for said in messages:
        about = [one for one in told if one.is_in(said)]
        assert len(about) <= 1, said
        answer = kb.query(said)
        for one in about:
            named = [hit.id for hit in answer.hits if f"{hit.id}.poll()" not in said]
            assert named[0] in one.paths, said
            assert one.help in answer.notes
        assert answer.notes, said


@pytest.mark.blender
def test_what_they_advise_about_vectors_and_formats_works() -> None:
    bpy = pytest.importorskip("bpy")
    from mathutils import Matrix, Vector

    assert len(Vector((1, 2)).to_3d() + Vector((1, 2, 3))) == 3
    assert Matrix() @ Vector((1, 2, 3)) == Vector((1, 2, 3))
    assert Vector((1, 2, 3)) * Vector((1, 2, 3)) == Vector((1, 4, 9))
    settings = bpy.data.scenes.new("new").render.image_settings
    settings.media_type = "VIDEO"
    settings.media_type = "IMAGE"
    settings.file_format = "PNG"


def test_what_they_lead_to_exists_here_or_in_a_newer_blender(kb: KnowledgeBase, reader: BaseReader) -> None:
    paths = {path for one in NAMELESS_MESSAGES for path in (*one.paths, *filter(None, [one.lacking]))}
    lacking = {path for path in paths if "/" not in path and kb.symbol(path) is None}
    first = {one.paths[0] for one in NAMELESS_MESSAGES} | {one.lacking for one in NAMELESS_MESSAGES}
    assert lacking <= first
    assert {path for path in lacking if reader.history.removed(path) is None} == set()
    shipped = (
        file.read_text(encoding="utf-8") for file in (REPO / "corpora" / "summaries").glob("5.1.*.jsonl")
    )
    slugs = {ShippedSummary.from_line(line).slug for text in shipped for line in text.splitlines()}
    assert {path for path in paths if "/" in path} <= slugs
