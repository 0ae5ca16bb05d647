"""Calls of what modules besides ``bpy.types`` and ``bpy.ops`` have, what they are given, and what is read from results.

Each statement is run in Blender, which refuses the wrong ones only.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements
from told_by_blender import told_by_blender

from kb_check.calls.missing_arguments import IN_PYTHON

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_RULES = [
    "given-callback", "list-attribute", "missing-argument", "not-subscriptable", "unknown-name", "unknown-value",
    "wrong-size", "wrong-type",
]  # fmt: skip
_LINES = """\
import addon_utils, bl_math, bmesh, bpy, math
from bpy_extras import anim_utils, io_utils
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Matrix, Quaternion, Vector, geometry
scene, cube = bpy.context.scene, bpy.data.objects["Cube"]
action = bpy.data.actions.new("Action")
slot = action.slots.new("OBJECT", "Slot")
anim_utils.action_get_channelbag_for_slot(action)
anim_utils.action_get_channelbag_for_slot(action, slot)
anim_utils.action_get_channelbag_for_slot(slot=slot, action=action)
anim_utils.action_get_first_suitable_slot(action)
anim_utils.action_get_first_suitable_slot(action, "OBJECT")
anim_utils.action_ensure_channelbag_for_slot(action)
anim_utils.AutoKeying.get_4d_rotlock()
io_utils.unpack_list()
io_utils.unpack_list([(1, 2)])
bpy.path.basename()
bpy.path.basename("/a/b")
addon_utils.check()
addon_utils.check("cycles")
bl_math.clamp(5)
bl_math.clamp(5, 2)
bl_math.clamp(5, 2, 3)
x, y = world_to_camera_view(scene, scene.camera, cube.location)
x, y, z = world_to_camera_view(scene, scene.camera, cube.location)
world_to_camera_view(scene, scene.camera)
world_to_camera_view(scene, scene.camera, cube.location).xy
near = geometry.intersect_line_line((0, 0, 0), (1, 0, 0), (0, 1, 1), (0, -1, 1))
near.x
near[0].x
near.count(near[0])
geometry.intersect_point_line((0, 1, 0), (0, 0, 0), (1, 0, 0)).x
geometry.intersect_point_line((0, 1, 0), (0, 0, 0), (1, 0, 0))[0].x
Quaternion().to_axis_angle().x
bpy.context.selected_objects.location
bpy.context.selected_objects.index(cube)
bm = bmesh.new()
made = bmesh.ops.create_cube(bm, size=1)
uv = bm.loops.layers.uv.new("UV")
number = bm.faces.layers.int.new("number")
weights = bm.verts.layers.deform.verify()
vert, edge, face = bm.verts[:][0], bm.edges[:][0], bm.faces[:][0]
loop = face.loops[0]
vert[uv].uv = (0, 0)
edge[uv]
face[uv].uv = (0, 0)
face[bm.loops.layers.uv.active]
face[bm.loops.layers.uv["UV"]]
loop[uv].uv = (0, 0)
loop[number] = 1
face[number] = 1
vert[number]
vert[weights]
face[weights]
bmesh.ops.bevel(bm, geom=bm.edges[:], offset=(1, 2), segments=1, affect="EDGES")
bmesh.ops.subdivide_edges(bm, edges=bm.edges[:], cuts=1, edge_percents="none")
bmesh.ops.weld_verts(bm, targetmap=[])
bmesh.ops.create_cube(bm, calc_uvs=(1, 2))
Matrix.Scale((1, 2, 3), 4)
Matrix.Scale(Vector((1, 2, 3)), 4)
Matrix.Scale(2, (4,))
Matrix.Scale(2, 4)
Matrix.Rotation((1, 2, 3), 4, "X")
Matrix.Rotation(cube.rotation_euler, 4, "X")
Matrix.Rotation(cube.rotation_euler.x, 4, "X")
Vector((1, 2, 3)).lerp((4, 5, 6), (0.5,))
bl_math.lerp((0, 0), 1, 0.5)
bl_math.lerp(0, 1, 0.5)
geometry.interpolate_bezier((0, 0), (1, 0), (1, 1), (0, 1), [4])
face.material_index = (1, 2)
bpy.utils.units.to_value("LENGTH", "METRIC", "3mm")
bpy.utils.units.to_value("METRIC", "LENGHT", "3mm")
bpy.utils.units.to_value("METRIC", "LENGTH", ("3mm",))
bpy.utils.units.to_value("METRIC", "LENGTH", "3mm")
bpy.utils.units.to_string("LENGTH", "METRIC", 3.0)
bpy.utils.units.to_string("METRIC", "LENGTH", (3.0,))
bpy.utils.units.to_string(scene.unit_settings.system, "LENGTH", 3.0)
bpy.app.handlers.persistent()
bpy.app.handlers.persistent(lambda path: path)
bpy.app.handlers.count(None), bpy.app.handlers.index, bpy.app.handlers.n_fields, bpy.app.ffmpeg.count
bpy.app.handlers.counts
bpy.types.SpaceView3D.draw_handler_add(print, (), "WINDOW", "POST_PIXEL")
bpy.types.SpaceView3D.draw_handler_add(print, (), "WINDOW", "POST_2D")
bpy.types.SpaceNodeEditor.draw_handler_add(print, (), "CANVAS", "BACKDROP")
bpy.data.user_map(key_types={"MESH"}, value_types={"OBJECT"})
bpy.data.user_map(key_types={"MESH"}, value_types={"OBJECTS"})
bpy.data.libraries.write("unwritten.blend", set(), path_remap="REMAP")
"""


def test_what_is_found_is_what_blender_refuses(rule_checker: Checker, tmp_path: Path) -> None:
    lines: list[str] = [*_LINES.splitlines()]
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = rule_checker.check(_LINES, rules=_RULES)
    assert sorted({one.span.line for one in found}) == refused
    assert len(refused) == 46


def test_what_is_told_of_changes_is_a_function_in_python(rule_checker: Checker, tmp_path: Path) -> None:
    lines = [*_CALLBACKS, *(_SUBSCRIBED.format(given) for given in _GIVEN)]
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = rule_checker.check("\n".join(lines), rules=["given-callback"])
    first = len("\n".join(_CALLBACKS).splitlines()) - len(_CALLBACKS)
    assert [one.span.line - first for one in found] == refused
    assert len(refused) == 13


def test_what_is_called_by_mistake_is_given_by_the_fix(rule_checker: Checker) -> None:
    code = "import bpy\ndef called(): pass\n@bpy.app.handlers.persistent()\ndef loaded(path): pass\n"
    found = rule_checker.check(code + _SUBSCRIBED.format("called()"), rules=["given-callback"])
    assert [[edit.text for edit in one.fix.edits] for one in found if one.fix and one.fix.sure] == [
        [""],
        [""],
    ]


_CALLBACKS = [
    "import bpy, functools",
    "from functools import partial",
    "class Seen:\n    def notify(self): pass\n    @classmethod\n    def own(cls): pass",
    "seen = Seen()",
    "def called(*more): pass",
    "@functools.wraps(called)\ndef wrapped(): pass",
]
_SUBSCRIBED = "bpy.msgbus.subscribe_rna(key=bpy.context.object, owner=seen, args=(), notify={})"
_GIVEN = (
    "called", "lambda *more: None", "called()", "None", "'called'", "seen.notify", "Seen.notify", "Seen.own", "Seen",
    "seen", "print", "functools.partial(called, 1)", "partial(called)", "bpy.ops.mesh.delete", "bpy.types.Object",
    "bpy.context.object.select_set", "bpy.utils.keyconfig_set", "wrapped",
)  # fmt: skip


_NEEDED = """
import importlib, inspect, json, sys
import bpy
functions = json.load(open(sys.argv[-1]))
needed = {}
for path in functions:
    module, _, name = path.rpartition(".")
    try:
        function = getattr(importlib.import_module(module), name)
        parameters = inspect.signature(function).parameters.values()
    except (ImportError, ValueError):  # a method; another name of a function in C
        continue
    needed[path] = [
        one.name for one in parameters
        if one.default is one.empty and one.kind not in (one.VAR_POSITIONAL, one.VAR_KEYWORD)
    ]
open(sys.argv[-1], "w").write(json.dumps(needed))
"""


def test_signatures_of_modules_in_python_are_pythons_own(rule_checker: Checker, tmp_path: Path) -> None:
    rows = rule_checker.names.reader.rows("SELECT path FROM symbols WHERE kind = 'function'")
    paths = [path for (path,) in rows if path.startswith(IN_PYTHON)]
    needed = told_by_blender(_NEEDED, tmp_path, paths)
    for path, names in needed.items():
        symbol = rule_checker.api.symbols.symbol(path)
        assert symbol is not None
        assert {one.name for one in symbol.parameters if one.required} <= set(names), path
    assert len(needed) > 100


@pytest.mark.parametrize(
    "code",
    [
        "try:\n    bpy.context.selected_objects.location\nexcept AttributeError:\n    pass",
        "if hasattr(bpy.context.selected_objects, 'location'):\n    bpy.context.selected_objects.location",
        "found = bpy.context.selected_objects\nfound = found[0]\nfound.location",
        "def f(found):\n    return found.location\nf(bpy.context.selected_objects)",
    ],
)
def test_what_may_have_an_attribute_is_left_alone(rule_checker: Checker, code: str) -> None:
    assert rule_checker.check(f"import bpy\n{code}\n", rules=["list-attribute"]) == []
