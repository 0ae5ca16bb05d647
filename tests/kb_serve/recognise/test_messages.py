"""Error messages, in the forms in which Blender 5.1 raises them: what they lead to, and what is said of them."""

from __future__ import annotations

import ast
import importlib
import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_serve.recognise import message_patterns
from kb_serve.recognise.elsewhere.layers import in_layers
from kb_serve.recognise.message_patterns import may_be_message, prose_of
from kb_serve.recognise.messages.outside_areas import OUTSIDE

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

SPHERE = "bpy.ops.mesh.primitive_uv_sphere_add"
FIRST = {
    f'TypeError: Converting py args to operator properties:: keyword "segs" unrecognized, {SPHERE}(segs=12)': SPHERE,
    "TypeError: Converting py args to operator properties: MESH_OT_primitive_uv_sphere_add.segments expected an int "
    "type, not str": SPHERE,
    "RuntimeError: Operator bpy.ops.uv.unwrap.poll() failed, context is incorrect": "bpy.ops.uv.unwrap",
    "RuntimeError: Operator bpy.ops.object.mode_set.poll() Context missing active object": "bpy.ops.object.mode_set",
    'TypeError: ObjectModifiers.new(): error with argument 2, "type" -  enum "SMOKE" not found in (\'DATA_TRANSFER\', '
    "'MESH_CACHE', 'UV_PROJECT')": "bpy.types.ObjectModifiers.new",
    'TypeError: NodeLinks.new(): error with argument 1, "input" -  Function.input expected a NodeSocket type, not '
    "ShaderNodeBsdfPrincipled": "bpy.types.NodeLinks.new",
    "TypeError: bpy_struct: item.attr = val: Object.data expected a Mesh type, not Object": "bpy.types.Object.data",
    'AttributeError: bpy_struct: attribute "type" from "Object" is read-only': "bpy.types.Object.type",
    'AttributeError: bpy_prop "MeshLoop.normal" is read-only': "bpy.types.MeshLoop.normal",
    "AttributeError: 'Context' object has no attribute 'active_objct'": "bpy.types.Context.active_object",
    "AttributeError: 'NoneType' object has no attribute 'mass'": "bpy.types.Object.rigid_body",
    "AttributeError: 'NoneType' object has no attribute 'key_blocks'": "bpy.types.Mesh.shape_keys",
    "AttributeError: 'NoneType' object has no attribute 'bone_groups'": "bpy.types.Armature.collections",
    'AttributeError: bpy_prop_collection: attribute "link" not found': "bpy.types.CollectionObjects.link",
    'AttributeError: bpy_prop_collection: attribute "active" not found': "bpy.types.LayerObjects.active",
    'AttributeError: bpy_prop_collection: attribute "append" not found': "bpy.types.IDMaterials.append",
    "AttributeError: 'Scene' object has no attribute 'resolution_x'": "bpy.types.RenderSettings.resolution_x",
    "AttributeError: 'Object' object has no attribute 'mass'": "bpy.types.RigidBodyObject.mass",
    "TypeError: cannot create 'GPUShader' instances": "gpu.shader.create_from_info",
    "AttributeError: 'module' object has no attribute 'Sequence'": "bpy.types.Strip",
    "AttributeError: 'ColorSequence' object has no attribute 'use_translation'": "bpy.types.EffectStrip.transform",
    "KeyError: 'bpy_prop_collection[key]: key \"Color2\" not found'": 'bpy.types.ShaderNodeMix.inputs["B_Color"]',
    "KeyError: 'bpy_prop_collection[key]: key \"DiffCol\" not found'": "bpy.types.ViewLayer.use_pass_diffuse_color",
    "KeyError: 'bpy_struct[key]: key \"my_prop\" not found'": "bpy.types.bpy_struct.get",
    "TypeError: cannot create 'BMVert' instances": "bmesh.types.BMVertSeq.new",
    "AttributeError: 'LevelsetGrid' object has no attribute 'setConst'": "bpy.ops.fluid.bake_all",
    "terminate called after throwing an instance of 'Manta::Error'": "bpy.ops.fluid.bake_all",
    "SystemError: GPU functions for drawing are not available in background mode": "bpy.app.background",
    "TypeError: bpy_struct: item.attr = val: enum \"CYCLE\" not found in ('BLENDER_EEVEE', 'BLENDER_WORKBENCH', "
    "'CYCLES')": "bpy.types.RenderSettings.engine",
    "ValueError: edges.new(): this edge exists": "bmesh.types.BMEdgeSeq.new",
    'AttributeError: BMeshOpsModule: operator "extrude" doesn\'t exist': "bmesh.ops.extrude_edge_only",
    "RuntimeError: Error: Node type ShaderNodeTexImageX undefined": None,
    "RuntimeError: Error: Armature 'rig' not in edit mode, cannot add an editbone": "bpy.types.ArmatureEditBones.new",
    "RuntimeError: Error: Bézier spline cannot have points added": "bpy.types.SplinePoints.add",
    "RuntimeError: Error: Strips.new_effect: invalid length": "bpy.types.StripsTopLevel.new_effect",
    "RuntimeError: Error: An Action may not have more than one layer": "bpy.types.ActionLayers.new",
    "RuntimeError: Error: VertexGroups.new() is not supported for 'Light' objects": "bpy.types.VertexGroups.new",
    "ValueError: 1-2 args execution context is supported": "bpy.types.Context.temp_override",
    "ReferenceError: BMesh data of type BMesh has been removed": "bmesh.types.BMesh.free",
    "ReferenceError: StructRNA of type Object has been removed": "bpy.types.BlendDataObjects.remove",
    'AttributeError: bpy_prop_collection: attribute "extend" not found': "bpy.types.bpy_prop_collection_idprop.add",
    'AttributeError: bpy_prop_collection: attribute "index" not found': "bpy.types.bpy_prop_collection.find",
    'AttributeError: Calling operator "bpy.ops.foo.nine" error, could not be found': "bpy.utils.register_class",
    "rna_uiItemO: unknown operator 'foo.bar'": "bpy.utils.register_class",
    "rna_uiItemO: unknown operator 'object.delet'": "bpy.ops.object.delete",
    'AttributeError: Calling operator "bpy.ops.import_scene.obj" error, could not be found': "bpy.ops.wm.obj_import",
    "AttributeError: 'Scene' object has no attribute 'my_props'": "bpy.props.PointerProperty",
    "rna_uiItemR: property not found: Scene.my_prop": "bpy.props.PointerProperty",
    "TypeError: GPUOffScreen.__new__() got an unexpected keyword argument 'samples'": "gpu.types.GPUOffScreen",
    "TypeError: GPUTexture.__new__() takes exactly 1 positional argument (2 given)": "gpu.types.GPUTexture",
    "TypeError: IndexBuf.__new__: expected a sequence, got int": "gpu.types.GPUIndexBuf",
    'TypeError: delete: keyword "context" expected a string, not int': "bmesh.ops.delete",
    "TypeError: load() got an unexpected keyword argument 'overrides'": "bpy.types.BlendDataLibraries.load",
    "TypeError: 'relative_remap' is an invalid keyword argument for write()": "bpy.types.BlendDataLibraries.write",
    "AttributeError: 'BMLoop' object has no attribute 'uv'": "bmesh.types.BMLoopUV.uv",
    "AttributeError: module 'msgbus' has no attribute 'unsubscribe_rna'": "bpy.msgbus.publish_rna",
    "TypeError: bpy_struct: item.attr = val: enum \"STR\" not found in ('FLOAT', 'INT', 'VECTOR', 'RGBA', 'STRING')": (
        "bpy.types.FunctionNodeCompare.data_type"
    ),
    "TypeError: Converting py args to operator properties: FOO_OT_one.filepath expected a string type, not PosixPath": (
        "bpy.props.StringProperty"
    ),
    'TypeError: Converting py args to operator properties:: keyword "toggle_mode" unrecognized': (
        "bpy.ops.object.mode_set"
    ),
    # Classes that are spelled like a module, or like a value.
    "'BMesh' object has no attribute 'calc_tessface'": "bmesh.types.BMesh.calc_loop_triangles",
    "'BMesh' object has no attribute 'select_flush_mode'": "bmesh.types.BMesh.select_flush_mode",
    "'Matrix' object has no attribute 'rotation_part'": "mathutils.Matrix.to_3x3",
    "'Matrix' object is not callable": "mathutils.Matrix",
    "'Color' object has no attribute 'a'": "mathutils.Color",
    "AttributeError: 'Context' object has no attribute 'object'": "bpy.types.Context.object",
    "AttributeError: 'MyOperator' object has no attribute 'my_prop'": "bpy.props",
    "ModuleNotFoundError: No module named 'bpy_types'": "bpy.types",
    "NameError: name 'Vector' is not defined": "mathutils.Vector",
    "NameError: name 'bmesh' is not defined": "bmesh",
    "AttributeError: Writing to ID classes in this context is not allowed: Scene, Scene data-block, error setting "
    "Scene.frame_current": "bpy.types.Scene.frame_current",
}


@pytest.mark.parametrize("message", FIRST)
def test_a_message_leads_to_the_api_at_hand(kb: KnowledgeBase, message: str) -> None:
    hits = [hit.id for hit in kb.query(message).hits]
    named = [hit for hit in hits if not hit.startswith("info_")]
    assert FIRST[message] is None or named[0] == FIRST[message]


def test_what_refused_a_call_says_when_it_does(kb: KnowledgeBase) -> None:
    text = kb.query("RuntimeError: Error: Strips.new_effect: effect takes 2 input strips").text
    assert "without `input1` and `input2`: “Strips.new_effect: effect takes 2 input strips”" in text
    assert "'GREASEPENCIL object'" not in text
    values = kb.query("ObjectModifiers.new").text
    assert "(taken only by a MESH object)" in values
    assert "(taken only by a MESH, CURVE, SURFACE or FONT object)" in values
    assert (
        "- `type='CLOTH'|'COLLISION'|'DYNAMIC_PAINT'|'FLUID'|'SOFT_BODY'` a second time: returns `None`"
        in values
    )


def test_too_many_arguments_are_answered_with_what_is_taken(kb: KnowledgeBase) -> None:
    text = kb.query("TypeError: mathutils.Vector(): takes at most 1 argument (3 given)").text
    assert "takes at most 1 by position, the first a sequence: `Vector((…, …))`" in text
    assert "`a @ b`" not in text


def test_what_only_evaluated_objects_have_is_reached_from_one(kb: KnowledgeBase) -> None:
    evaluated = ".evaluated_get(bpy.context.evaluated_depsgraph_get())"
    text = kb.query("Particle.location").text
    assert f"`bpy.context.object{evaluated}.particle_systems" in text
    assert "filled on evaluated objects only" in kb.query("ParticleSystem.particles").text
    message = "IndexError: bpy_prop_collection[index]: index 0 out of range, size 0"
    text = kb.query(f"{message}\nParticleSystem.particles[0].location").text
    assert f"Blender fills `.particles` on evaluated objects only: `obj{evaluated}`" in text


def test_a_pasted_traceback_is_read_as_its_last_line(kb: KnowledgeBase) -> None:
    line = "AttributeError: 'Mesh' object has no attribute 'calc_loop_triangle'"
    pasted = (
        f'Traceback (most recent call last):\n  File "/tmp/bpy.types.Scene.py", line 3, in <module>\n{line}'
    )
    assert kb.query(pasted).hits[0].id == kb.query(line).hits[0].id == "bpy.types.Mesh.calc_loop_triangles"
    (note,) = kb.query(pasted).notes
    assert note.startswith("`bpy.types.Mesh` has no `calc_loop_triangle`")
    assert "Closest: `bpy.types.Mesh.calc_loop_triangles`" in note


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (
            f'keyword "segs" unrecognized {SPHERE}(segs=12)',
            f"`{SPHERE}` takes no `segs`; closest: `segments`.",
        ),
        (
            "RuntimeError: Operator bpy.ops.uv.unwrap.poll() failed, context is incorrect",
            "mode_set(mode='EDIT')",
        ),
        (
            "AttributeError: 'NoneType' object has no attribute 'mass'",
            "`bpy.types.Object.rigid_body` is None before `bpy.ops.rigidbody.object_add()`.",
        ),
        (
            "bpy.context.scene.world.node_tree.nodes: 'NoneType' object has no attribute 'node_tree'",
            '`bpy.types.Scene.world` is None on what is new: set it, `scene.world = bpy.data.worlds.new("World")`.',
        ),
        (
            'AttributeError: bpy_struct: attribute "id_type" from "DriverTarget" is read-only',
            "`bpy.types.DriverTarget.id_type` can be assigned at other times",
        ),
        (
            "AttributeError: 'NoneType' object has no attribute 'nodes'",
            "`.nodes`, a `bpy.types.NodeTree`, is None: it does not exist (yet), or was not found. One is reached by "
            "`bpy.types.NodesModifier.node_group`, `bpy.types.Scene.compositing_node_group`, ",
        ),
        (
            "AttributeError: 'NoneType' object has no attribute 'nodes'",
            "`bpy.types.Scene.compositing_node_group` is None on what is new: set it, "
            "`scene.compositing_node_group = bpy.data.node_groups.new(",
        ),
        (
            "AttributeError: 'NoneType' object has no attribute 'strength'",
            "`bpy.types.Object.field` is None before `bpy.ops.object.forcefield_toggle()`.",
        ),
        (
            "AttributeError: 'NoneType' object has no attribute 'color'",
            '`bpy.types.Scene.world` is None on what is new: set it, `scene.world = bpy.data.worlds.new("World")`.',
        ),
        (
            "AttributeError: 'NoneType' object has no attribute 'show_only_render'",
            "One is reached by `bpy.types.Context.space_data`, `bpy.types.AreaSpaces.active`.",
        ),
        (
            'AttributeError: bpy_prop_collection: attribute "unlink" not found',
            "has no `unlink`; others have: `bpy.types.Collection.objects.unlink`, "
            "`bpy.types.Collection.children.unlink`.",
        ),
        (
            "AttributeError: 'GreasePencilFrame' object has no attribute 'strokes'",
            "never had it from 4.3 to 5.3 (add-ons and custom properties aside).\nIts `.drawing` has it: "
            "`.drawing.strokes` (`bpy.types.GreasePencilDrawing.strokes`).",
        ),
        (
            "TypeError: cannot create 'GPUShader' instances",
            "is not made by calling it, but by `gpu.shader.from_builtin()`, `gpu.shader.create_from_info()`.",
        ),
        (
            'Converting py args to operator properties:: keyword "export_textures" unrecognized',
            "`bpy.ops.wm.usd_export(export_textures_mode=…)`. NEW stands for True",
        ),
        (
            'Converting py args to operator properties:: keyword "export_texture" unrecognized',
            "`export_textures_mode` is the argument of `bpy.ops.wm.usd_export`.",
        ),
        ("ReferenceError: StructRNA of type Object has been removed", "data was removed, freed"),
        ("ReferenceError: BMesh data of type BMVert has been removed", "`v.is_valid` tells"),
        (
            "ReferenceError: StructRNA of type DepsgraphObjectInstance has been removed",
            "only until the loop goes on",
        ),
        (
            "AttributeError: Writing to ID classes in this context is not allowed: Scene, Scene data-block, error "
            "setting Scene.frame_end",
            "`draw()` and `poll()`",
        ),
        ('AttributeError: bpy_struct: attribute "type" from "Object" is read-only', "cannot be assigned"),
        ("KeyError: 'bpy_prop_collection[key]: key \"Cub\" not found'", "no element `Cub`"),
        (
            "obj.material_slots[0].link\nIndexError: bpy_prop_collection[index]: index 0 out of range, size 0",
            "has no elements: there is no `[0]` yet. `bpy.ops.object.material_slot_add()` adds one.",
        ),
        (
            "mesh.materials[1] = mat\nIndexError: bpy_prop_collection[index] = value: index 1 out of range, size 1",
            "has only 1, counted from 0: there is no `[1]` yet. `.materials.append(material)` adds one.",
        ),
        (
            "spline.points[0].co = v\nIndexError: bpy_prop_collection[index]: index 0 out of range, size 0",
            "`.points.add(count)` adds one to a poly spline or nurbs spline; a bezier spline refuses it.",
        ),
        ("IndexError: bpy_prop_collection[index]: index 0 out of range, size 0", "there is no `[0]` yet."),
        (
            "TypeError: bpy_struct: item.attr = val: Object.parent expected a Object type, not Armature",
            "Give the object, not its data: `obj`, whose `.data` is the `Armature`.",
        ),
        (
            "TypeError: bpy_struct: item.attr = val: DriverTarget.id expected a Object type, not Scene",
            "Set `id_type = 'SCENE'` before `id`",
        ),
        (
            "TypeError: NodeLinks.new(): error with argument 1, \"input\" -  Function.input does not support a 'None' "
            "assignment NodeSocket type",
            "None was given for a `bpy.types.NodeSocket`: `outputs.get(name)` is None where nothing has the name.",
        ),
        (
            'TypeError: IDMaterials.append(): error with argument 1, "material" -  Function.material expected a '
            "Material type, not str",
            'Give the thing itself, not its name: `bpy.data.materials["…"]`.',
        ),
        (
            'TypeError: Scene.frame_set(): error with argument 1, "frame" -  Function.frame expected an int type, not '
            "float",
            "Give a whole number: `int(value)`, or `round(value)`.",
        ),
        (
            "TypeError: bpy_struct: item.attr = val: NodeSocketFloatFactor.default_value expected a float type, not "
            "tuple",
            "Give one number, not a tuple of them.",
        ),
        (
            'TypeError: Scene.ray_cast(): error with argument 1, "depsgraph" -  Function.depsgraph expected a '
            "Depsgraph type, not ViewLayer",
            "A `bpy.types.Depsgraph` is reached as `bpy.context.evaluated_depsgraph_get()`.",
        ),
        (
            'TypeError: ObjectModifiers.new(): error with argument 2, "type" -  enum "SUBSURFACE" not found in '
            "('BEVEL', 'BOOLEAN', 'MULTIRES', 'SUBSURF')",
            "`SUBSURFACE` is not an item of this enum; closest: `SUBSURF`.",
        ),
        (
            "TypeError: bpy_struct: item.attr = val: enum \"POW\" not found in ('ADD', 'POWER', 'LOGARITHM')",
            "`POW` is not an item of this enum; closest: `POWER`.",
        ),
        (
            "TypeError: bpy_struct: item.attr = val: enum \"CUDA\" not found in ('CPU', 'GPU')",
            "`CUDA` is a value of `bpy.types.CyclesDeviceSettings.type`.",
        ),
        (
            "AttributeError: 'CameraDOFSettings' object has no attribute 'focus_dist'",
            "CameraDOFSettings.focus_distance",
        ),
        (
            "AttributeError: 'TextStrip' object has no attribute 'frame_start_final'",
            "Strip.frame_final_start`",
        ),
        (
            "AttributeError: 'NoneType' object has no attribute 'enabled'",
            "`, then `bpy.ops.rigidbody.constraint_add()`",
        ),
        ("AttributeError: 'tuple' object has no attribute 'x'", "`mathutils.Vector(value).x`"),
        (
            "AttributeError: 'Context' object has no attribute 'selected_objects'",
            "`bpy.context.view_layer.objects.selected` needs none. Or give it one: `with bpy.context.temp_override(",
        ),
        (
            "AttributeError: 'MyOperator' object has no attribute 'my_prop'",
            "with a colon (`my_prop: bpy.props.FloatProperty()`, or another of `bpy.props`)",
        ),
        ("ModuleNotFoundError: No module named 'bpy_types'", "`import _bpy_types`"),
        ("NameError: name 'Vector' is not defined", "`from mathutils import Vector`"),
        ("NameError: name 'BVHTree' is not defined", "`from mathutils.bvhtree import BVHTree`"),
        ("NameError: name 'IntProperty' is not defined", "`from bpy.props import IntProperty`"),
        ("NameError: name 'bmesh' is not defined", "`import bmesh`"),
        ("NameError: name 'C' is not defined", "write `bpy.context`"),
        ("AttributeError: 'str' object has no attribute 'location'", '`bpy.data.objects["…"]`'),
        ("AttributeError: type object 'Object' has no attribute 'mine'", "`bpy.types.Object` has no `mine`"),
        (
            'AttributeError: bpy_prop_collection: attribute "material" not found',
            "`material_slots[0].material`, or `for one in material_slots:` and `one.material`.",
        ),
        (
            'AttributeError: bpy_prop_collection: attribute "select_set" not found',
            "such as `bpy.types.Object.select_set`: `objects[0].select_set(…)`",
        ),
        (
            'AttributeError: bpy_prop_collection: attribute "default_value" not found',
            "what they hold has it, such as `bpy.types.NodeSocket",
        ),
        (
            "AttributeError: 'list' object has no attribute 'location'",
            "`for thing in things:` and `thing.location`.",
        ),
        ("AttributeError: 'float' object has no attribute 'y'", "one value already, of type `float`"),
        ("AttributeError: 'bool' object has no attribute 'location'", "one value already, of type `bool`"),
        (
            'AttributeError: bpy_prop_collection: attribute "insert" not found',
            "If it is a `CollectionProperty` of your own: `items.add()`, then `items.move(len(items) - 1, index)`.",
        ),
        (
            'AttributeError: Calling operator "bpy.ops.foo.nine" error, could not be found',
            'of the class with `bl_idname = "foo.nine"` did not run here.',
        ),
        (
            "AttributeError: type object 'Scene' has no attribute 'my_prop'",
            "`bpy.types.Scene.my_prop = bpy.props.PointerProperty(type=…)`",
        ),
        (
            "TypeError: bpy_struct: item.attr = val: Image.filepath expected a string type, not PosixPath",
            "Give a text: `str(path)`.",
        ),
        (
            "TypeError: bpy_struct: item.attr = val: Object.name expected a string type, not int",
            "Give a text: `str(value)`.",
        ),
        (
            "TypeError: write() got an unexpected keyword argument 'relative_remap'",
            "`bpy.types.BlendDataLibraries.write` takes no `relative_remap`; closest: `path_remap`.",
        ),
        (
            "KeyError: 'bpy_prop_collection[key]: key \"my_addon\" not found', "
            "context.preferences.addons[__name__].preferences",
            "that of an extension is `bl_ext.repository.name`.",
        ),
        (
            'KeyError: \'bpy_prop_collection[key]: key "Cube" not found\', action.slots["Cube"]',
            '`action.slots["OBCube"]`',
        ),
        (
            "KeyError: 'bpy_prop_collection[key]: key \"Geometry Nodes\" not found'",
            "A modifier of type 'NODES' is called \"GeometryNodes\" where it gets no name",
        ),
        (
            "ob.constraints['TrackTo']\nKeyError: 'bpy_prop_collection[key]: key \"TrackTo\" not found'",
            "A constraint of type 'TRACK_TO' is called \"Track To\"",
        ),
        ("AttributeError: 'set' object has no attribute 'location'", "Operators return a set, {'FINISHED'}"),
        (
            "TypeError: write() argument 2 must be set, not list",
            "`bpy.data.libraries.write(path, {obj, material})`",
        ),
        (
            "ValueError: faces.new(...): face already exists",
            "`face = bm.faces.get(verts) or bm.faces.new(verts)`",
        ),
        ("ValueError: edges.new(): this edge exists", "`edge = bm.edges.get(verts) or bm.edges.new(verts)`"),
        (
            "RuntimeError: Error: VertexGroup.add(): cannot be called while object is in edit mode",
            "`layer = bm.verts.layers.deform.verify()`",
        ),
        (
            "RuntimeError: Error: No Rigid Body World to add Rigid Body Constraint to",
            "`bpy.ops.rigidbody.world_add()` makes the world of the scene",
        ),
        (
            "key \"permissions\" invalid: permissions must be a table of strings, not a <class 'list'>",
            '`[permissions]`, below it `network = "Loads maps from the net"`.',
        ),
        ('permissions = ["network"]', "`permissions` is a table"),
        ('missing "maintainer"', "`blender --command extension validate`"),
        ("ModuleNotFoundError: No module named 'requests'", "an extension brings a package as a wheel"),
        (
            "TypeError: GPUFrameBuffer.__new__() got an unexpected keyword argument 'color'",
            "`gpu.types.GPUFrameBuffer` takes no `color`; closest: `color_slots`.",
        ),
        (
            'TypeError: triangulate: keyword "quad_method" expected a string, not int',
            "`bmesh.ops.triangulate(quad_method=…)` takes one of `'BEAUTY'`, `'FIXED'`",
        ),
        (
            'TypeError: bevel: keyword "geom" expected a bmesh sequence, list, (htype, flag) pair, not int',
            "takes a list of the bmesh's own elements, as `bm.faces[:]`.",
        ),
        (
            'TypeError: ObjectModifiers.new(): error with argument 2, "type" -  enum "SUBDIVISION" not found in '
            "('BEVEL', 'BOOLEAN', 'MULTIRES', 'SUBSURF')",
            "`SUBDIVISION` is not an item of this enum; of that label: `SUBSURF`.",
        ),
    ],
)
def test_notes_explain_error_messages(kb: KnowledgeBase, message: str, said: str) -> None:
    assert said in "\n".join(kb.query(message).notes)


@pytest.mark.parametrize(
    ("message", "denied"),
    [
        ("AttributeError: 'Scene' object has no attribute 'my_props'", "Closest"),
        (
            "bpy.rna          | WARNING current value '5' matches no enum in 'Scene', 'Scene', 'e'",
            "has no `rna`",
        ),
        ("bpy.msgbus.unsubscribe_rna(owner=f)", "read as"),
        ("def __init__(self):\n    StrokeShader.__init__(self)\n    raise TypeError('x')", "is called as"),
        ("ModuleNotFoundError: No module named 'bgl'", "as a wheel"),
        ("WARN (bpy.rna): current value '0' matches no enum in 'Scene', '', 'my_enum'", "has no `rna`"),
        (
            'AttributeError: Calling operator "bpy.ops.import_scene.obj" error, could not be found',
            "is registered",
        ),
    ],
)
def test_what_messages_do_not_say_is_not_told(kb: KnowledgeBase, message: str, denied: str) -> None:
    assert denied not in "\n".join(kb.query(message).notes)


@pytest.mark.blender
def test_what_elements_of_a_bmesh_lack_lies_in_a_layer(reader: BaseReader) -> None:
    pytest.importorskip("bpy")
    bmesh = importlib.import_module("bmesh")
    bm = bmesh.new()
    bm.faces.new([bm.verts.new(co) for co in ((0, 0, 0), (1, 0, 0), (0, 1, 0))])
    found = 0
    assert not list(in_layers("bmesh.types.BMVert", "co", reader))
    for owner in ("BMVert", "BMEdge", "BMFace", "BMLoop"):
        for name in reader.members(owner.replace("BM", "bmesh.types.BMLayerAccess")):
            ((_, how),) = in_layers(f"bmesh.types.{owner}", name, reader)
            _, setting, _, reading, _ = how.split("`")
            names = {"bm": bm}
            exec(setting, names)
            for sequence in (bm.verts, bm.edges, bm.faces):
                sequence.ensure_lookup_table()
            element = {"BMVert": bm.verts[0], "BMEdge": bm.edges[0], "BMFace": bm.faces[0]}.get(owner)
            names[owner[2:].lower()] = element or bm.faces[0].loops[0]
            assert eval(reading, names) is not None
            found += 1
    assert found


def test_the_place_of_a_call_in_a_message_is_none_of_its_words(kb: KnowledgeBase) -> None:
    message = "RuntimeError: Error: Python: TypeError: 'NoneType' object is not iterable\n"
    located = kb.query(f"{message}Location: /opt/blender/5.0/scripts/modules/bpy/ops.py:109")
    assert [hit.id for hit in located.hits] == [hit.id for hit in kb.query(message).hits]


@pytest.mark.parametrize(
    ("name", "first", "said"),
    [
        ("location", "bpy.context.active_object", "`bpy.context.object` are None where no object is active"),
        (
            "select_set",
            "bpy.context.active_object",
            "`bpy.data.objects.get(name)` is None where nothing has the name",
        ),
        (
            "name",
            "bpy.context.active_object",
            "Often: `bpy.context.active_object` and `bpy.context.object` are None",
        ),
        ("inputs", "bpy.types.NodeTree.nodes", "`nodes.get(name)` is None where nothing has the name"),
        ("vertices", "bpy.types.Object.data", "`bpy.types.Object.data` is None on a new empty object"),
        ("diffuse_color", "bpy.types.Object.active_material", "`bpy.data.materials.get(name)` is None where"),
        ("drivers", "bpy.types.Object.animation_data", "is None before `obj.animation_data_create()`"),
    ],
)
def test_what_many_things_have_was_mostly_asked_of_what_is_not_there(
    kb: KnowledgeBase, name: str, first: str, said: str
) -> None:
    answer = kb.query(f"AttributeError: 'NoneType' object has no attribute '{name}'")
    assert answer.hits[0].id == first
    assert said in "\n".join(answer.notes)


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("'GreasePencilLayer' object has no attribute 'info'", "bpy.types.GreasePencilTreeNode.name"),
        ("AttributeError: 'Action' object has no attribute 'fcurves'", "bpy.types.ActionChannelbag.fcurves"),
        (
            'AttributeError: Calling operator "bpy.ops.wm.fbx_export" error, could not be found',
            "bpy.ops.export_scene.fbx",
        ),
        ("bpy.ops.object.add_cube()", "bpy.ops.mesh.primitive_cube_add"),
        (
            "RuntimeError: Error: Node type GeometryNodeMeshPrimitiveCube undefined",
            "bpy.types.GeometryNodeMeshCube",
        ),
        ("which node replaces CompositorNodeMixRGB", "bpy.types.ShaderNodeMix"),
        ("what happened to CompositorNodeComposite", "bpy.types.NodeGroupOutput"),
        (
            "ImportError: cannot import name 'orientation_helper_factory' from 'bpy_extras.io_utils'",
            "bpy_extras.io_utils.orientation_helper",
        ),
        (
            "IndexError: bpy_prop_collection[index]: index 0 out of range, size 0",
            "bpy.types.bpy_prop_collection",
        ),
    ],
)
def test_what_is_gone_or_never_was_leads_to_what_there_is(kb: KnowledgeBase, query: str, first: str) -> None:
    assert kb.query(query).hits[0].id == first


def test_the_legacy_mix_node_leads_to_the_one_that_menus_make(kb: KnowledgeBase) -> None:
    answer = kb.query("ShaderNodeMixRGB")
    assert [hit.id for hit in answer.hits[:2]] == ["bpy.types.ShaderNodeMixRGB", "bpy.types.ShaderNodeMix"]
    assert "`data_type = 'RGBA'`" in answer.notes[0]


def test_an_operators_unknown_keyword_is_that_of_operators_alone(kb: KnowledgeBase) -> None:
    notes = kb.query(
        'TypeError: Converting py args to operator properties:: keyword "size" unrecognized'
    ).notes
    assert all("gpu." not in note and "39 operators" not in note for note in notes)


def test_what_was_set_by_registration_is_not_said_to_be_missing(kb: KnowledgeBase) -> None:
    said = "Writing to ID classes in this context is not allowed: Scene, Scene data-block, error setting Scene.my_prop"
    answer = kb.query(f"AttributeError: {said}")
    assert answer.hits[0].id == "bpy.types.Scene"
    assert "has no `my_prop`" not in "\n".join(answer.notes)


@pytest.mark.blender
def test_the_context_without_a_window_lacks_what_is_told_and_has_what_is_given() -> None:
    bpy = pytest.importorskip("bpy")
    with bpy.context.temp_override(window=None):
        with pytest.raises(AttributeError, match="'Context' object has no attribute 'object'"):
            assert bpy.context.object
        assert not hasattr(bpy.context, "selected_objects")
        assert hasattr(bpy.context.view_layer.objects, "active")
        assert hasattr(bpy.context.view_layer.objects, "selected")
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            assert hasattr(bpy.context, "selected_objects")


@pytest.mark.blender
def test_what_is_told_to_be_imported_can_be() -> None:
    pytest.importorskip("bpy")
    for name, module in (
        ("Vector", "mathutils"), ("BVHTree", "mathutils.bvhtree"), ("IntProperty", "bpy.props"),
        ("__name__", "_bpy_types"),
    ):  # fmt: skip
        assert hasattr(importlib.import_module(module), name)


@pytest.mark.blender
def test_what_is_said_to_be_none_where_nothing_is_there_is_none() -> None:
    bpy = pytest.importorskip("bpy")
    bpy.context.view_layer.objects.active = None
    assert bpy.context.active_object is None
    assert bpy.context.object is None
    assert bpy.data.objects.get("none has this name") is None
    assert bpy.data.materials.new("new").node_tree.nodes.get("none has this name") is None
    assert bpy.data.objects.new("empty", None).data is None
    assert bpy.data.objects.new("new", bpy.data.meshes.new("new")).active_material is None


@pytest.mark.parametrize(
    "message",
    ["AttributeError: Object object has no attribute select", "Mesh object has no attribute calc_normals",
     "NoneType object has no attribute mass", "module bpy.utils has no attribute register_module"],
)  # fmt: skip
def test_a_message_without_its_quotes_is_the_same_message(kb: KnowledgeBase, message: str) -> None:
    quoted = re.sub(r"(?<=module )([\w.]+)|(\w+)(?= object has)|(\w+)$", r"'\g<0>'", message)
    assert quoted.count("'") == 4
    assert kb.query(message).notes == kb.query(quoted).notes != []


@pytest.mark.blender
def test_statements_that_fill_pointers_fill_them() -> None:
    bpy = pytest.importorskip("bpy")
    scene = bpy.data.scenes.new("new")
    assert scene.compositing_node_group is None
    assert scene.world is None
    scene.compositing_node_group = bpy.data.node_groups.new("Compositor Node Tree", "CompositorNodeTree")
    scene.world = bpy.data.worlds.new("World")
    assert len(scene.compositing_node_group.nodes) == 0
    assert scene.world.color is not None
    assert bpy.data.materials.new("new").node_tree is not None


def test_a_key_is_no_socket_of_other_letters(kb: KnowledgeBase) -> None:
    for name in ("position", "g"):
        (note,) = kb.query(f"KeyError: 'bpy_prop_collection[key]: key \"{name}\" not found'").notes
        assert note.startswith(f"The collection has no element `{name}`")


@pytest.mark.parametrize("name", ["B", "Value", "Color"])
def test_a_key_that_many_nodes_have_is_not_one_that_a_node_lost(kb: KnowledgeBase, name: str) -> None:
    notes = kb.query(f"KeyError: 'bpy_prop_collection[key]: key \"{name}\" not found'").notes
    lost = [note for note in notes if "is there only with" not in note]
    assert [note.partition("`;")[0] for note in lost] == [f"The collection has no element `{name}"]


def test_a_former_name_is_said_to_fail_only_where_it_does(
    kb: KnowledgeBase, nodes_that_refuse_fac: set[str]
) -> None:
    notes = kb.query("KeyError: 'bpy_prop_collection[key]: key \"Fac\" not found'").notes
    (note,) = (note for note in notes if "former name of `Factor`" in note)
    assert set(re.findall(r"`(bpy\.types\.\w+)`", note)) == nodes_that_refuse_fac
    assert not any("does not exist" in note for note in notes)


@pytest.fixture(scope="module")
def nodes_that_refuse_fac(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    """The nodes of this environment's Blender with a socket `Factor` that one does not get as `Fac`."""
    return set(told_by_blender(_NODES, tmp_path_factory.mktemp("nodes")))


_NODES = """
import json, sys
import bpy

found = []
for kind in ("ShaderNodeTree", "CompositorNodeTree", "GeometryNodeTree", "TextureNodeTree"):
    tree = bpy.data.node_groups.new("tree", kind)
    for name in dir(bpy.types):
        if not name.startswith(("ShaderNode", "CompositorNode", "GeometryNode", "FunctionNode", "TextureNode")):
            continue
        try:
            node = tree.nodes.new(name)
        except RuntimeError:
            continue
        for sockets in (node.inputs, node.outputs):
            if "Factor" in [socket.name for socket in sockets] and sockets.get("Fac") is None:
                found.append("bpy.types." + name)
open(sys.argv[-1], "w").write(json.dumps(sorted(set(found))))
"""


@pytest.mark.parametrize(
    ("query", "lost"),
    [
        ('key "Subsurface" not found', 'ShaderNodeBsdfPrincipled.inputs["Subsurface"]'),
        ('combine rgba node: key "B" not found', 'CompositorNodeCombRGBA.inputs["B"]'),
    ],
)
def test_a_key_of_the_node_at_hand_is_one_that_it_lost(kb: KnowledgeBase, query: str, lost: str) -> None:
    (before, _, key) = query.rpartition("key ")
    notes = kb.query(f"{before}KeyError: 'bpy_prop_collection[key]: key {key}'").notes
    assert notes[0].startswith(f"`bpy.types.{lost}` does not exist")


@pytest.mark.parametrize(
    ("message", "first", "notes"),
    [
        (
            'TypeError: ActionStrips.new(): error with keyword argument "type" - enum "CLIP" not found in '
            "('KEYFRAME')",
            "bpy.types.ActionStrips.new",
            ["`CLIP` is not an item of this enum, which has `KEYFRAME`."],
        ),
        (
            'TypeError: BlendDataNodeTrees.new(): error with argument 2, "type" - enum "GeometryNodes" not found in '
            "('DUMMY', 'ShaderNodeTree', 'GeometryNodeTree', 'CompositorNodeTree')",
            "bpy.types.BlendDataNodeTrees.new",
            ["`GeometryNodes` is not an item of this enum; closest: `GeometryNodeTree`."],
        ),
        (
            'TypeError: bpy_struct: item.attr = val: enum "HAIR" not found in '
            "('NONE', 'HALO', 'LINE', 'PATH', 'OBJECT', 'COLLECTION')",
            "bpy.types.ParticleSettings.render_type",
            ["`HAIR` is a value of `bpy.types.ParticleSettings.type`."],
        ),
    ],
)
def test_the_items_in_a_message_tell_whose_they_are(
    kb: KnowledgeBase, message: str, first: str, notes: list[str]
) -> None:
    answer = kb.query(message)
    assert answer.hits[0].id == first
    assert list(answer.notes) == notes


@pytest.mark.blender
def test_a_mode_that_the_active_object_has_not_is_no_misspelt_one(kb: KnowledgeBase) -> None:
    bpy = pytest.importorskip("bpy")
    bpy.ops.object.empty_add()
    with pytest.raises(TypeError) as caught:
        bpy.ops.object.mode_set(mode="EDIT")
    answer = kb.query(f"TypeError: {caught.value}")
    assert answer.hits[0].id == "bpy.ops.object.mode_set"
    first, second = answer.notes
    assert first == "`EDIT` is a value of `bpy.ops.object.mode_set(mode)`, which present data do not allow."
    assert second.startswith("The active object has no such mode")


@pytest.mark.blender
def test_a_mode_that_no_object_has_leads_to_the_one_of_its_label(kb: KnowledgeBase) -> None:
    bpy = pytest.importorskip("bpy")
    bpy.ops.object.grease_pencil_add()
    with pytest.raises(TypeError) as caught:
        bpy.ops.object.mode_set(mode="EDIT_GPENCIL")
    assert (
        kb.query(f"TypeError: {caught.value}").notes[0].endswith("no Object comes to have it. Write `EDIT`.")
    )
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.object.mode_set(mode="OBJECT")


@pytest.mark.parametrize(
    ("message", "told"),
    [
        (
            "TypeError: Converting py args to operator properties: enum \"HAIR\" not found in ('MESH', 'CURVE', "
            "'SURFACE', 'META', 'FONT', 'CURVES')",
            "Use `bpy.ops.object.select_by_type(type='CURVES')`.",
        ),
        (
            "TypeError: Converting py args to operator properties: enum \"PAINT_GPENCIL\" not found in ('OBJECT', "
            "'EDIT', 'PAINT_GREASE_PENCIL')",
            "Use `bpy.ops.object.mode_set(mode='PAINT_GREASE_PENCIL')`.",
        ),
    ],
)
def test_a_value_of_operator_properties_is_an_operators(kb: KnowledgeBase, message: str, told: str) -> None:
    assert told in kb.query(message).notes[0]


@pytest.mark.blender
def test_what_python_says_was_meant_tells_which_function_was_called(kb: KnowledgeBase) -> None:
    bpy = pytest.importorskip("bpy")
    with pytest.raises(TypeError) as caught:
        bpy.data.libraries.load("x.blend", links=True)
    message = (
        f"TypeError: {caught.value}. Did you mean 'link'?"  # what Python adds where it prints a traceback
    )
    answer = kb.query(message)
    assert answer.hits[0].id == "bpy.types.BlendDataLibraries.load"
    assert "`bpy.types.BlendDataLibraries.load` takes no `links`; closest: `link`." in answer.notes
    (alone,) = kb.query("TypeError: load() got an unexpected keyword argument 'nothing'").notes
    assert "Several functions are called `load`" in alone
    called = kb.query(
        "bpy.data.libraries.load('x', nothing=1) load() got an unexpected keyword argument 'nothing'"
    )
    assert "`bpy.types.BlendDataLibraries.load` takes no `nothing`." in "\n".join(called.notes)


@pytest.mark.parametrize(
    ("message", "former"),
    [
        ("KeyError: 'bpy_prop_collection[key]: key \"Specular\" not found'", 'inputs["Specular"]'),
        ("RuntimeError: Error: Node type ShaderNodeTexMusgrave undefined", "ShaderNodeTexMusgrave"),
        (
            "item.attr = val: enum \"BLENDER_EEVEE_NEXT\" not found in ('BLENDER_EEVEE', 'CYCLES')",
            "EEVEE_NEXT",
        ),
        ('Calling operator "bpy.ops.export_mesh.stl" error, could not be found', "bpy.ops.export_mesh.stl"),
    ],
)
def test_messages_reveal_removed_symbols(kb: KnowledgeBase, message: str, former: str) -> None:
    note = next(note for note in kb.query(message).notes if "does not exist" in note)
    assert former in note
    assert "removed in" in note or "gone by" in note


@pytest.mark.parametrize(
    ("socket", "told"),
    [
        ("Cr", "on `CompositorNodeSepYCCA` (now `CompositorNodeSeparateColor`)."),
        (
            "R",
            "on `CompositorNodeCombRGBA` (now `CompositorNodeCombineColor`), `CompositorNodeSepRGBA` (now ",
        ),
        ("Value_Bool", "socket `Value_Bool` on `GeometryNodeFieldOnDomain`, "),
        ("Specular", "Nodes that have one: `ShaderNodeEeveeSpecular`."),
    ],
)
def test_a_key_that_no_node_is_named_with_may_be_of_several(
    kb: KnowledgeBase, socket: str, told: str
) -> None:
    notes = "\n".join(kb.query(f"KeyError: 'bpy_prop_collection[key]: key \"{socket}\" not found'").notes)
    assert told in notes


def test_names_of_the_callers_data_are_not_searched_for() -> None:
    assert prose_of("RuntimeError: Error: Object 'Cloth' already in collection 'Smoke'").split() == [
        "Object", "already", "in", "collection",
    ]  # fmt: skip
    assert prose_of("stop 'cloth' from tearing") == "stop 'cloth' from tearing"


@pytest.mark.parametrize(
    "call", ["{'object': o}", "override", "dict(area=a), action='SELECT'", "context.copy()"]
)
def test_a_context_argument_leads_to_temp_override(kb: KnowledgeBase, call: str) -> None:
    answer = kb.query(f"bpy.ops.object.select_all({call})")
    assert answer.hits[0].id == "bpy.ops.object.select_all"
    assert "bpy.types.Context.temp_override" in [hit.id for hit in answer.hits]
    assert any("temp_override" in note for note in answer.notes)


@pytest.mark.parametrize(
    "call", ["'INVOKE_DEFAULT'", "action='SELECT'", "", "'EXEC_DEFAULT', True, action='SELECT'"]
)
def test_a_right_call_is_left_alone(kb: KnowledgeBase, call: str) -> None:
    assert kb.query(f"bpy.ops.object.select_all({call})").notes == ()


def test_unknown_arguments_are_noted(kb: KnowledgeBase) -> None:
    (note,) = kb.query("bpy.ops.mesh.primitive_cube_add(edge=1, location=(0, f(a=1), 0))").notes
    assert note == "`bpy.ops.mesh.primitive_cube_add` takes no `edge`."


@pytest.mark.parametrize(
    ("written", "first"),
    [
        ("obj.select = True", "select_set"),
        ("obj.select == True", "select_get"),
        ("print(obj.select)", "select_get"),
    ],
)
def test_assigning_to_a_missing_name_leads_to_the_setter(kb: KnowledgeBase, written: str, first: str) -> None:
    assert kb.query(written).hits[0].id == f"bpy.types.Object.{first}"


@pytest.mark.parametrize(
    ("written", "first"),
    [
        ("modifiers.new('Cloth', 'CLOTH')", "bpy.types.ObjectModifiers.new"),
        ("faces.new(corners)", "bmesh.types.BMFaceSeq.new"),
        ("links.new(a, b)", "bpy.types.NodeLinks.new"),
    ],
)
def test_a_variable_called_like_a_collection_is_that_collection(
    kb: KnowledgeBase, written: str, first: str
) -> None:
    assert kb.query(written).hits[0].id == first


def test_removed_enum_values_are_noted(kb: KnowledgeBase) -> None:
    answer = kb.query("sky.sky_type = 'NISHITA'")
    assert answer.hits[0].id == "bpy.types.ShaderNodeTexSky.sky_type"
    assert any("NISHITA" in note and "SINGLE_SCATTERING" in note for note in answer.notes)


def test_code_that_asks_an_element_for_a_layer_is_told_so(kb: KnowledgeBase) -> None:
    answer = kb.query("bm.faces[0].loops[0].uv")
    assert answer.hits[0].id == "bmesh.types.BMLoopUV.uv"
    assert not any("Closest" in note for note in answer.notes)


def test_the_engines_that_a_panel_is_for_are_none_that_is_set(kb: KnowledgeBase) -> None:
    panel = "COMPAT_ENGINES = {'BLENDER_RENDER', 'BLENDER_EEVEE'}"
    assert not any("BLENDER_RENDER" in note for note in kb.query(panel).notes)
    assert any("BLENDER_RENDER" in note for note in kb.query(f"{panel}\nx.engine = 'BLENDER_RENDER'").notes)


def test_preferences_of_an_add_on_are_reached_through_it(kb: KnowledgeBase) -> None:
    reached = 'bpy.context.preferences.addons["cycles"].preferences'
    answer = kb.query(f"{reached}.compute_device_type = 'CUDA'")
    assert answer.hits[0].id == "bpy.types.CyclesPreferences.compute_device_type"
    assert f"`{reached}.compute_device_type`" in answer.text
    assert kb.query(f"{reached}.get_devices()").hits[0].id == "bpy.types.CyclesPreferences.get_devices"


def test_an_unknown_keyword_alone_names_the_operators_that_know_it(kb: KnowledgeBase) -> None:
    answer = kb.query(
        'TypeError: Converting py args to operator properties: : keyword "use_selection" unrecognized'
    )
    notes = "\n".join(answer.notes)
    assert (
        "`use_selection` is an argument of `bpy.ops.export_scene.fbx`, `bpy.ops.export_scene.gltf`" in notes
    )
    assert (
        "`export_selected_objects` is the argument of `bpy.ops.wm.obj_export`, `bpy.ops.wm.ply_export`, "
        "`bpy.ops.wm.stl_export`." in notes
    )
    assert answer.kind == "candidates"


@pytest.mark.parametrize(
    ("message", "path", "said"),
    [
        (
            "TypeError: register_class(...):, validating class: enum \"VIEW3D\" not found in ('EMPTY', 'VIEW_3D', "
            "'IMAGE_EDITOR', 'NODE_EDITOR', 'SEQUENCE_EDITOR', 'CLIP_EDITOR', 'DOPESHEET_EDITOR', 'GRAPH_EDITOR')",
            "bpy.types.Panel.bl_space_type",
            "closest: `VIEW_3D`",
        ),
        (
            "ValueError: validating class:: 'REGISTR' not found in ('REGISTER', 'UNDO', 'UNDO_GROUPED', 'BLOCKING', "
            "'MACRO', 'GRAB_CURSOR', 'GRAB_CURSOR_X', 'GRAB_CURSOR_Y', 'DEPENDS_ON_CURSOR', 'PRESET', 'INTERNAL')",
            "bpy.types.Operator.bl_options",
            "closest: `REGISTER`",
        ),
        (
            "RuntimeError: class OBJECT_OT_drop, function execute: incompatible return value , TypeError(, "
            "Function.result expected a set, not a NoneType)",
            "bpy.types.Operator.execute",
            "must return what `bpy.types.Operator.execute` returns",
        ),
        (
            "ValueError: bpy_struct \"Scene\" registration error: 'mode' EnumProperty could not register (see previous "
            "error)",
            "bpy.props.EnumProperty",
            "printed before this one",
        ),
        (
            "RuntimeError: Error: Registering panel class: parent 'PT_main' for 'PT_sub' not found",
            "bpy.types.Panel.bl_parent_id",
            "`PT_main` first",
        ),
    ],
)
def test_what_is_refused_when_classes_are_registered(
    kb: KnowledgeBase, message: str, path: str, said: str
) -> None:
    answer = kb.query(message)
    assert answer.hits[0].id == path
    assert said in "\n".join(answer.notes)


IMAGES = (
    "'AVIF', 'JPEG', 'OPEN_EXR', 'PNG', 'WEBP', 'BMP', 'CINEON', 'DPX', 'IRIS', 'JPEG2000', 'HDR', 'TARGA'"
)


def test_a_list_of_items_tells_the_mode_of_the_property(kb: KnowledgeBase) -> None:
    message = f"TypeError: item.attr = val: enum \"FFMPEG\" not found in ({IMAGES}, 'TARGA_RAW', 'TIFF')"
    answer = kb.query(message)
    assert answer.hits[0].id == "bpy.types.ImageFormatSettings.file_format"
    assert any("= 'FFMPEG' is taken only with media_type='VIDEO'." in note for note in answer.notes)


def test_where_a_value_is_taken_is_said_in_words(kb: KnowledgeBase) -> None:
    (note,) = (one for one in kb.query("socket.structure_type = 'DYNAMIC'").notes if "is taken only" in one)
    assert note.endswith("taken only in a GeometryNodeTree, and there only by a menu, color, float, matrix, vector, "
                         "boolean, integer or rotation node socket interface.")  # fmt: skip


def test_what_became_an_operator_is_no_argument(kb: KnowledgeBase) -> None:
    notes = kb.query('keyword "use_auto_smooth" unrecognized').notes
    assert notes
    assert not any(" of ." in note for note in notes)


def test_of_many_operators_that_lost_an_argument_the_most_used_are_named(kb: KnowledgeBase) -> None:
    answer = kb.query('Converting py args to operator properties:: keyword "view_align" unrecognized')
    assert "bpy.ops.mesh.primitive_cube_add" in [hit.id for hit in answer.hits[:3]]


EEVEE_NEXT = (
    'TypeError: bpy_struct: item.attr = val: enum "BLENDER_EEVEE" not found in '
    "('BLENDER_EEVEE_NEXT', 'BLENDER_WORKBENCH', 'CYCLES')"
)
FORMATS = (
    'TypeError: bpy_struct: item.attr = val: enum "AVI_JPEG" not found in '
    "('BMP', 'IRIS', 'PNG', 'JPEG', 'JPEG2000', 'TARGA', 'TARGA_RAW', 'CINEON', 'DPX', 'OPEN_EXR_MULTILAYER', "
    "'OPEN_EXR', 'HDR', 'TIFF', 'WEBP', 'FFMPEG')"
)
TARGETS = (
    "error with argument 1, \"target\" -  enum \"BLENDER_EEVEE\" not found in ('ALL', 'EEVEE', 'CYCLES')"
)
ICONS = "Function.icon: enum \"{}\" not found in ('NONE', 'QUESTION', 'ERROR', 'CANCEL', 'PLUS')"
SHADERS = "expected a string in ('FLAT_COLOR', 'IMAGE', 'SMOOTH_COLOR', 'UNIFORM_COLOR', 'POLYLINE_FLAT_COLOR'), got "


@pytest.mark.parametrize(
    ("message", "first", "said"),
    [
        (
            EEVEE_NEXT,
            "bpy.types.RenderSettings.engine",
            "is another version's: only Blender 4.2 to 4.5 have",
        ),
        (FORMATS, "bpy.types.ImageFormatSettings.file_format", "is taken only with media_type='VIDEO'"),
        (
            f"TypeError: get_output_node(): {TARGETS}",
            "bpy.types.ShaderNodeTree.get_output_node",
            "closest: `EEVEE`",
        ),
        (
            f'UILayout.label(): error with keyword argument "icon" - {ICONS.format("SEQUENCE_COLOR_03")}',
            "bpy.types.UILayout.label",
            "(icon='STRIP_COLOR_03')`",
        ),
        (
            f'UILayout.label(): error with keyword argument "icon" - {ICONS.format("HAIR")}',
            "bpy.types.UILayout.label",
            "(icon='CURVES')`, `bpy.types.UILayout.label(icon='STRANDS')`",
        ),
        (
            f"TypeError: {SHADERS}'2D_UNIFORM_COLOR'",
            "gpu.shader.from_builtin",
            "Use `gpu.shader.from_builtin(shader_name='UNIFORM_COLOR')`",
        ),
        (f"TypeError: {SHADERS}'MY_UNIFORM_COLOR'", "gpu.shader.from_builtin", "closest: `UNIFORM_COLOR`"),
    ],
)
def test_values_that_are_not_taken_are_told_by_the_list_beside_them(
    kb: KnowledgeBase, message: str, first: str, said: str
) -> None:
    answer = kb.query(message)
    assert answer.hits[0].id == first
    assert said in "\n".join(answer.notes)
    assert "has no `icon`" not in answer.text


def test_operators_take_no_arguments_by_place(kb: KnowledgeBase) -> None:
    notes = kb.query("TypeError: primitive_cube_add() takes at most 3 arguments (4 given)").notes
    assert any("`bpy.ops.mesh.primitive_cube_add` takes its arguments by name only" in note for note in notes)
    assert not any("takes 3 arguments" in note for note in notes)


def test_a_key_that_an_input_of_geometry_nodes_lacks_is_no_registered_property(kb: KnowledgeBase) -> None:
    notes = kb.query("KeyError: 'bpy_struct[key]: key \"Socket_9\" not found'").notes
    assert not any("bpy.props" in note for note in notes)


@pytest.mark.parametrize(
    ("query", "note"),
    [
        ("bpy.ops.material.new(name='x')\nTypeError: Converting py args to operator properties:: keyword \"name\" "
         "unrecognized", "`bpy.ops.material.new` takes no arguments."),
        ("AttributeGroupMesh.new(): error with argument 3, \"domain\" -  Function.domain enum \"FACE_CORNER\" not "
         "found in ('POINT', 'EDGE', 'FACE', 'CORNER', 'CURVE', 'INSTANCE', 'LAYER')",
         "`FACE_CORNER` is not an item of this enum; closest: `CORNER`."),
        ("ob.data.vertices[0].groups[0].weight\nIndexError: bpy_prop_collection[index]: index 0 out of range, size 0",
         "The collection has no elements: there is no `[0]` yet."),
    ],
)  # fmt: skip
def test_a_message_beside_its_line_says_one_thing(kb: KnowledgeBase, query: str, note: str) -> None:
    assert kb.query(query).notes == (note,)


def test_a_poll_that_says_why_is_not_explained_otherwise(kb: KnowledgeBase) -> None:
    said = "RuntimeError: Operator bpy.ops.ed.undo.poll() Undo disabled at startup in background-mode"
    assert not [note for note in kb.query(said).notes if "active object" in note]


def test_what_a_collection_has_to_add_elements_is_closest(kb: KnowledgeBase) -> None:
    for query in ("AttributeError: 'NlaStrips' object has no attribute 'add'", "track.strips.add()"):
        (note,) = [note for note in kb.query(query).notes if "has no `add`" in note]
        assert "Closest: `bpy.types.NlaStrips.new`" in note or "Closest: `bpy.types.ActionStrips.new`" in note


def test_what_all_data_blocks_have_is_had_by_that_of_a_bone(kb: KnowledgeBase) -> None:
    answer = kb.query("AttributeError: 'PoseBone' object has no attribute 'update_tag'")
    assert any("`.id_data.update_tag`" in note for note in answer.notes)
    assert "custom_shape" not in answer.text.partition("##")[0]
    assert "id_data" not in kb.query("AttributeError: 'Context' object has no attribute 'update_tag'").text


def test_the_message_of_bmesh_names_its_function(kb: KnowledgeBase) -> None:
    answer = kb.query('TypeError: bevel: keyword "vertex_only" is invalid for this operator')
    assert answer.hits[0].id == "bmesh.ops.bevel"
    assert "Use `bmesh.ops.bevel(affect=…)`" in answer.notes[0]


def test_a_keyword_that_many_take_is_offered_by_those_that_scripts_use_most(kb: KnowledgeBase) -> None:
    notes = kb.query(
        'TypeError: Converting py args to operator properties:: keyword "values" unrecognized'
    ).notes
    assert any("`value` is the argument of" in note and "translate`" in note for note in notes)
    notes = kb.query(
        'TypeError: Converting py args to operator properties:: keyword "name" unrecognized'
    ).notes
    assert not any("new in" in note for note in notes)


def test_items_that_begin_like_modes_are_no_modes(kb: KnowledgeBase) -> None:
    message = (
        "TypeError: Converting py args to operator properties:  enum \"{}\" not found in ('OBJECT', '{}')"
    )
    assert "no such mode" in "\n".join(kb.query(message.format("POSE", "EDIT")).notes)
    assert "no such mode" not in "\n".join(kb.query(message.format("BONES", "ARMATURE")).notes)


def test_the_old_mix_is_no_newer_one_where_the_code_makes_it(kb: KnowledgeBase) -> None:
    line = "mix.inputs['Color1'].default_value = (1, 0, 0, 1)"
    assert "ShaderNodeMix`" in "\n".join(kb.query(line).notes)
    assert kb.query(f"mix = nodes.new('ShaderNodeMixRGB')\n{line}").notes == ()


@pytest.mark.parametrize(
    ("line", "path", "wanted"),
    [
        ("p.co = (i, 3, 0)", "SplinePoint.co", 4),
        ("ns.points[0].co = (0, 3, 0)", "SplinePoint.co", 4),
        ("light.color = (1, 0, 0, 1)", "Light.color", 3),
    ],
)
def test_a_number_of_items_tells_which_property_of_a_name_is_set(
    kb: KnowledgeBase, line: str, path: str, wanted: int
) -> None:
    given = line.count(",") + 1
    counted = f"should contain {wanted} items, not {given}"
    message = f"ValueError: bpy_struct: item.attr = val: sequences of dimension 0 {counted}"
    answer = kb.query(f"{line}\n{message}")
    assert answer.hits[0].id == f"bpy.types.{path}"
    assert answer.notes[0] == f"`bpy.types.{path}` takes {wanted} numbers, not {given}."


@pytest.mark.parametrize(
    "code",
    [
        "lm.object = lat",
        "lm = ob.modifiers.new('Lat', 'LATTICE')\n    lm.object = lat",
        "x.vertex_group = 'g'",
    ],
)
def test_a_modifier_that_an_object_does_not_take_is_none(kb: KnowledgeBase, code: str) -> None:
    message = "AttributeError: 'NoneType' object has no attribute 'object'"
    answer = kb.query(
        f'Traceback (most recent call last):\n  File "a.py", line 9, in <module>\n    {code}\n{message}'
    )
    assert answer.hits[0].id == "bpy.types.ObjectModifiers.new"
    assert "returns None, without an error" in answer.notes[1]


def test_objects_take_no_modifiers_of_others_in_blender() -> None:
    bpy = pytest.importorskip("bpy")
    scene = bpy.context.scene
    takes = {
        "light": (bpy.data.lights.new("l", "POINT"), "LATTICE"),
        "empty": (None, "LATTICE"),
        "pencil": (bpy.data.grease_pencils.new("g"), "LATTICE"),
        "mesh": (bpy.data.meshes.new("m"), "GREASE_PENCIL_LATTICE"),
    }
    for name, (data, kind) in takes.items():
        ob = bpy.data.objects.new(name, data)
        scene.collection.objects.link(ob)
        assert ob.modifiers.new("m", kind) is None, name


def test_a_type_of_nodes_that_no_tree_takes_leads_to_the_one_of_its_name(kb: KnowledgeBase) -> None:
    message = kb.query("RuntimeError: Error: Node type CompositorNodeGamma undefined")
    line = kb.query("nodes.new('CompositorNodeGamma')")
    for answer in (message, line):
        assert "a class of nodes that no tree takes" in answer.notes[0]
        assert "Use `bpy.types.ShaderNodeGamma`." in answer.notes[0]


def test_what_python_alone_lacks_a_setter_for_says_what_changes_it(kb: KnowledgeBase) -> None:
    answer = kb.query("AttributeError: property 'curve_type' of 'GreasePencilStroke' object has no setter")
    assert [hit.id.rpartition(".")[2] for hit in answer.hits[:2]] == ["curve_type", "set_types"]
    assert "is read-only" in answer.notes[0]


def test_the_function_that_a_message_names_comes_before_the_codes(kb: KnowledgeBase) -> None:
    message = (
        'NlaStrips.new(): error with argument 2, "start" -  Function.start expected an int type, not float'
    )
    answer = kb.query(f"    tr2.strips.new('spin', 10.5, a2)\nTypeError: {message}")
    assert answer.hits[0].id == "bpy.types.NlaStrips.new"


@pytest.mark.parametrize("code", ["", "    cp.target_space = 'LOCAL_OWNER_ORIENT'\n"])
def test_a_value_that_is_taken_elsewhere_is_told_of_what_takes_it(kb: KnowledgeBase, code: str) -> None:
    # `owner_space` has the same three values where nothing is a bone, and never this one.
    answer = kb.query(
        f"{code}TypeError: bpy_struct: item.attr = val: enum \"LOCAL_OWNER_ORIENT\" not found in ('WORLD', 'CUSTOM', "
        "'LOCAL')"
    )
    assert answer.hits[0].id == "bpy.types.Constraint.target_space"
    assert "is taken only by a constraint with a bone as target" in answer.notes[0]


@pytest.mark.parametrize(
    ("name", "how"),
    [
        ("math", "import math"),
        ("radians", "from math import radians"),
        ("np", "import numpy as np"),
        ("Path", "from pathlib import Path"),
    ],
)
def test_a_name_of_pythons_library_is_told_with_its_import(kb: KnowledgeBase, name: str, how: str) -> None:
    answer = kb.query(f"NameError: name '{name}' is not defined")
    assert answer.notes == (f"`{name}` must be imported first: `{how}`.",)
    assert not answer.hits


def test_a_name_that_the_script_lacks_is_not_looked_for_in_blender(kb: KnowledgeBase) -> None:
    answer = kb.query("NameError: name 'bake_mesh_6' is not defined")
    assert not answer.hits
    assert answer.notes[0].startswith("The script uses `bake_mesh_6` before")
    line = "bpy.ops.mesh.primitive_cube_add(size=s)\nNameError: name 's' is not defined"
    assert [hit.id for hit in kb.query(line).hits] == ["bpy.ops.mesh.primitive_cube_add"]


@pytest.mark.parametrize("caller", ["driver_add", "keyframe_insert"])
def test_an_index_beyond_an_array_is_told_with_the_right_ones(kb: KnowledgeBase, caller: str) -> None:
    answer = kb.query(
        f'TypeError: bpy_struct.{caller}(): index out of range "location", given 5, array length is 3'
    )
    assert answer.hits[0].id == f"bpy.types.bpy_struct.{caller}"
    assert "the index is 0 to 2" in answer.notes[0]


def test_the_class_that_a_message_names_decides_what_a_variable_is(kb: KnowledgeBase) -> None:
    answer = kb.query("    h.falloff = 1.0\nAttributeError: 'HookModifier' object has no attribute 'falloff'")
    assert answer.hits[0].id == "bpy.types.HookModifier.falloff_radius"
    assert not [note for note in answer.notes if "LightProbe" in note]


def test_what_python_says_was_meant_comes_first_where_it_says_the_same(kb: KnowledgeBase) -> None:
    answer = kb.query(
        "AttributeError: 'RigidBodyConstraint' object has no attribute 'use_spring_rot_x'. Did you mean: "
        "'use_spring_ang_x'?"
    )
    assert answer.hits[0].id == "bpy.types.RigidBodyConstraint.use_spring_ang_x"


@pytest.mark.parametrize(
    ("message", "first", "told"),
    [
        (
            "TypeError: bpy_struct: item.attr = val: enum \"BONE\" not found in ('OBJECT')",
            "bpy.types.Object.parent_type",
            "= 'BONE' is taken only by a child of armature object",
        ),
        (
            "TypeError: bpy_struct: item.attr = val: enum \"VERTEX\" not found in ('OBJECT', 'ARMATURE', 'BONE')",
            "bpy.types.Object.parent_type",
            "= 'VERTEX' is taken only by a child of mesh",
        ),
    ],
)
def test_the_only_items_of_a_property_tell_it_among_many_that_have_them(
    message: str, first: str, told: str, kb: KnowledgeBase
) -> None:
    answer = kb.query(message)
    assert answer.hits[0].id == first
    assert any(told in note for note in answer.notes)


@pytest.mark.parametrize(
    ("message", "first", "told"),
    [
        (
            'TypeError: Converting py args to operator properties: enum "PAINT_GPENCIL" not found',
            "bpy.ops.object.mode_set",
            "Use `bpy.ops.object.mode_set(mode='PAINT_GREASE_PENCIL')`",
        ),
        (
            'TypeError: bpy_struct: item.attr = val: enum "BLENDER_EEVEE_NEXT" not found',
            "bpy.types.RenderSettings.engine",
            "Use `bpy.types.RenderSettings.engine = 'BLENDER_EEVEE'`",
        ),
        (
            'item.attr = val: enum "FFMPEG" not found',
            "bpy.types.ImageFormatSettings.file_format",
            "is taken only with media_type='VIDEO'",
        ),
    ],
)
def test_a_message_without_its_list_leads_to_what_had_or_takes_the_value(
    message: str, first: str, told: str, kb: KnowledgeBase
) -> None:
    answer = kb.query(message)
    assert answer.hits[0].id == first
    assert any(told in note for note in answer.notes)


def test_a_value_of_nothing_is_told_nothing(kb: KnowledgeBase) -> None:
    assert kb.query('enum "NONSENSE" not found').notes == ()


@pytest.mark.parametrize(
    "name", ["spaces", "region_3d", "shading", "tag_redraw", "edit_tree", "overlay", "show_gizmo"]
)
def test_what_only_an_area_has_is_taken_from_a_window(name: str, kb: KnowledgeBase) -> None:
    assert OUTSIDE in kb.query(f"AttributeError: 'NoneType' object has no attribute '{name}'").notes


def test_what_other_things_have_is_none_of_an_area(kb: KnowledgeBase) -> None:
    other = kb.query("AttributeError: 'NoneType' object has no attribute 'vertices'")
    assert OUTSIDE not in other.notes


@pytest.mark.blender
def test_an_area_of_a_window_is_there_outside_of_any() -> None:
    bpy = pytest.importorskip("bpy")
    bpy.ops.wm.read_factory_settings()
    context = bpy.context
    assert [context.area, context.region, context.region_data, context.space_data] == [None] * 4
    area = next(a for a in context.window_manager.windows[0].screen.areas if a.type == "VIEW_3D")
    assert area.spaces.active.type == "VIEW_3D"
    with context.temp_override(area=area):
        assert bpy.context.space_data.type == "VIEW_3D"


def test_what_a_pattern_fits_is_told_from_a_question_by_one_of_its_words() -> None:
    """All messages that stand in this module, also in parts of texts."""
    nodes = ast.walk(ast.parse(Path(__file__).read_text(encoding="utf-8")))
    texts = [node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    known = vars(message_patterns).items()
    # These are looked for in messages that others fit.
    named = {name: one for name, one in known if name.isupper() and not name.startswith("_")}
    patterns = [
        one
        for name, one in named.items()
        if name not in {"MEANT", "SUBSCRIPTED"} and isinstance(one, re.Pattern)
    ]
    fitting = [text for text in texts if any(pattern.search(text) for pattern in patterns)]
    assert len(fitting) > 100
    assert [text for text in fitting if not may_be_message(text)] == []
    assert not may_be_message("make a cloth collide with itself")


@pytest.mark.parametrize(
    ("message", "path", "said"),
    [
        (
            'RuntimeError: Calling operator "bpy.ops.object.select_all" error, cannot modify blend data in this state '
            "(drawing/rendering)",
            "bpy.ops.object.select_all",
            "No operator is called while Blender only reads",
        ),
        (
            'RuntimeError: Calling operator "bpy.ops.object.mode_set" error, can\'t modify blend data in this state '
            "(drawing/rendering)",
            "bpy.ops.object.mode_set",
            "No operator is called while Blender only reads",
        ),
        (
            "TypeError: on_frame() missing 1 required positional argument: 'scene'",
            "bpy.app.handlers",
            "`handlers.append(on_frame)`: `on_frame()` calls it at once",
        ),
        (
            "TypeError: update_size() missing 1 required positional argument: 'context'",
            "",
            "`update_size` is a function of the script's own",
        ),
        (
            "AttributeError: 'list' object has no attribute 'inverted'",
            "mathutils.Matrix.inverted",
            "a matrix has: ",
        ),
        (
            "AttributeError: 'tuple' object has no attribute 'normalized'",
            "mathutils.Vector.normalized",
            "`mathutils.Vector(value).normalized()`",
        ),
        (
            "AttributeError: 'NoneType' object has no attribute 'type' and no __dict__ for setting new attributes",
            "bpy.types.Object.rigid_body",
            "`bpy.types.Object.rigid_body` is None before",
        ),
    ],
)
def test_a_message_says_what_was_done_wrong(kb: KnowledgeBase, message: str, path: str, said: str) -> None:
    answer = kb.query(message)
    assert not path or answer.hits[0].id == path
    assert said in "\n".join(answer.notes)


@pytest.mark.parametrize(
    "message",
    [
        "TypeError: Mesh.from_pydata() missing 1 required positional argument: 'faces'",
        "TypeError: Drop.__init__() takes 1 positional argument but 2 were given",
        "TypeError: handler() missing 1 required positional argument: 'depsgraph'",
    ],
)
def test_what_blender_has_is_no_function_of_the_scripts_own(kb: KnowledgeBase, message: str) -> None:
    assert "of the script's own" not in "\n".join(kb.query(message).notes)


def test_what_is_set_on_none_is_not_read_only(kb: KnowledgeBase) -> None:
    message = "AttributeError: 'NoneType' object has no attribute 'type'"
    assert "bpy.types.Object`" in "\n".join(kb.query(message).notes)
    setting = kb.query(f"{message} and no __dict__ for setting new attributes")
    assert "bpy.types.Object`" not in "\n".join(setting.notes)


@pytest.mark.parametrize(("kind", "said"), [("Pointer", "class in `type`"), ("Float", "number of arguments")])
def test_what_keeps_a_property_from_registering_is_told_of_its_kind(
    kb: KnowledgeBase, kind: str, said: str
) -> None:
    error = f"ValueError: bpy_struct \"Scene\" registration error: 'own' {kind}Property could not register"
    assert said in "\n".join(kb.query(error).notes)


@pytest.mark.blender
def test_blender_calls_no_operator_while_it_only_reads() -> None:
    bpy = pytest.importorskip("bpy")

    class Asking(bpy.types.Operator):
        bl_idname = "wm.asking"
        bl_label = "Asking"
        said = ""

        @classmethod
        def poll(cls, context: object) -> bool:
            try:
                bpy.ops.object.select_all(action="SELECT")
            except RuntimeError as error:
                Asking.said = str(error)
            return True

    bpy.utils.register_class(Asking)
    try:
        assert bpy.ops.wm.asking.poll()
    finally:
        bpy.utils.unregister_class(Asking)
    assert "modify blend data in this state (drawing/rendering)" in Asking.said


def test_of_a_collection_that_code_names_its_elements_are_told_once(kb: KnowledgeBase) -> None:
    message = 'ob.data.polygons.normal\nAttributeError: bpy_prop_collection: attribute "normal" not found'
    notes = kb.query(message).notes
    assert [note for note in notes if "polygons[0].normal" in note] == [
        "The elements of `.polygons` have it: `.polygons[0].normal` (`bpy.types.MeshPolygon.normal`)."
    ]


@pytest.mark.parametrize(
    "message",
    [
        "AttributeError: 'list' object has no attribute 'items'",
        'AttributeError: bpy_prop_collection: attribute "foo" not found',
    ],
)
def test_what_no_element_has_is_not_said_to_be_of_one(kb: KnowledgeBase, message: str) -> None:
    assert not [note for note in kb.query(message).notes if "[0]." in note]
