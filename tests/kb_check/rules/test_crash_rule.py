"""What is said to crash Blender does, what is told instead does not, and scripts are told of the one alone."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from kb_build.symbols.lines import fatal_lines

if TYPE_CHECKING:
    from conftest import Check

    from kb_check.checker import Checker

pytestmark = pytest.mark.blender

_START = "import bpy\nscene = bpy.context.scene\n"
_STRIP = (
    "strips = scene.sequence_editor_create().strips\nstrip = strips.new_effect('s', 'COLOR', 1, 1, length=9)"
)
_SET = "bpy.context.workspace.sequencer_scene = scene"
_UNSET = "bpy.context.workspace.sequencer_scene = None"
_ZONE = (
    "nodes = bpy.data.node_groups.new('g', 'GeometryNodeTree').nodes\nnode = nodes.new('GeometryNode{}Input')"
)
_CAMERA = "camera = bpy.data.objects.new('c', bpy.data.cameras.new('c'))\ndepsgraph = None"
# Symbol → what is there, what crashes Blender, and what is written in its place.
_CRASHES = {
    "StripModifiers.new": (
        _STRIP,
        "strip.modifiers.new('m', 'CURVES')",
        f"{_SET}\nstrip.modifiers.new('m', 'CURVES')",
    ),
    "StripModifiers.clear": (_STRIP, "strip.modifiers.clear()", f"{_SET}\nstrip.modifiers.clear()"),
    "StripModifiers.remove": (
        f"{_STRIP}\n{_SET}\nm = strip.modifiers.new('m', 'CURVES')",
        f"{_UNSET}\nstrip.modifiers.remove(m)",
        "strip.modifiers.remove(m)",
    ),
    "VertexGroups.active": (
        "groups = bpy.data.objects['Cube'].vertex_groups\ngroups.new(name='g')",
        "groups.active = None",
        "groups.active_index = -1\nassert groups.active is None",
    ),
    "AttributeGroupMesh.active": (
        "found = bpy.data.meshes['Cube'].attributes\nfound.active = found.new('a', 'FLOAT', 'POINT')",
        "found.active = None",
        "found.active_index = -1\nassert found.active is None",
    ),
    "AttributeGroupCurves.active": (
        "found = bpy.data.hair_curves.new('h').attributes\nfound.active = found.new('a', 'FLOAT', 'POINT')",
        "found.active = None",
        "found.active_index = -1\nassert found.active is None",
    ),
    "CollectionObjects.unlink": (
        "ob = bpy.data.objects.get('nothing')",
        "scene.collection.objects.unlink(ob)",
        "if ob:\n    scene.collection.objects.unlink(ob)",
    ),
    "CollectionChildren.unlink": (
        "children = scene.collection.children",
        "children.unlink(bpy.data.collections.get('nothing'))",
        "child = bpy.data.collections.get('nothing')\nchild and children.unlink(child)",
    ),
    "BoneCollections.remove": (
        "found = bpy.data.armatures.new('a').collections\none = found.get('nothing')",
        "found.remove(one)",
        "if one is not None:\n    found.remove(one)",
    ),
    "AnimData.fix_paths_rename_all": (
        "ob = bpy.data.objects['Cube']\nob.keyframe_insert('location')",
        "ob.animation_data.fix_paths_rename_all(old_name='a', new_name='b')",
        "ob.animation_data.fix_paths_rename_all(prefix='pose.bones', old_name='a', new_name='b')",
    ),
    "GeometryNodeSimulationInput.pair_with_output": (
        _ZONE.format("Simulation"),
        "node.pair_with_output(None)",
        "node.pair_with_output(nodes.new('GeometryNodeSimulationOutput'))",
    ),
    "GeometryNodeRepeatInput.pair_with_output": (
        _ZONE.format("Repeat"),
        "node.pair_with_output(nodes.get('Repeat Output'))",
        "node.pair_with_output(nodes.new('GeometryNodeRepeatOutput'))",
    ),
    "Object.calc_matrix_camera": (
        _CAMERA,
        "camera.calc_matrix_camera(depsgraph)",
        "camera.calc_matrix_camera(bpy.context.evaluated_depsgraph_get())",
    ),
    "MovieTrackingTracks.active": (
        "import os, tempfile\nimage = bpy.data.images.new('i', 8, 8)\n"
        "path = os.path.join(tempfile.mkdtemp(), 'i.png')\nimage.save(filepath=path)\n"
        "tracks = bpy.data.movieclips.load(path).tracking.tracks",
        "tracks.active = None",
        "tracks.active = tracks.new(name='t', frame=1)",
    ),
    "Image.gl_load": ("image = bpy.data.images.new('i', 8, 8)", "image.gl_load()", "image.update()"),
    "Image.gl_touch": ("image = bpy.data.images.new('i', 8, 8)", "image.gl_touch()", "image.update()"),
    "RegionView3D.update": (
        "area = next(area for area in bpy.context.screen.areas if area.type == 'VIEW_3D')",
        "area.spaces.active.region_3d.update()",
        "bpy.context.view_layer.update()",
    ),
}
# What it needs is set, and taken away again.
_NOT_TOLD = {"StripModifiers.remove"}


def _ends(code: str) -> bool:
    """Whether a Blender of its own crashes at some code; other errors fail the test."""
    words = [sys.executable, "-P", "-c", code]
    ended = subprocess.run(words, check=False, capture_output=True, timeout=60, text=True)
    assert ended.returncode <= 0, ended.stderr
    return ended.returncode < 0


@pytest.mark.parametrize("path", _CRASHES)
def test_what_crashes_is_said_of_the_symbol_and_found_in_scripts(
    check: Check, rule_checker: Checker, path: str
) -> None:
    there, fatal, instead = _CRASHES[path]
    symbol = rule_checker.api.symbols.symbol(f"bpy.types.{path}")
    if symbol is None:
        pytest.skip(f"this Blender has no {path}")
    crashes = _ends(f"{_START}{there}\n{fatal}")
    assert bool(fatal_lines(symbol)) is crashes
    found = check("crash", f"{_START}{there}\n{fatal}")
    assert len(found) == (crashes and path not in _NOT_TOLD)
    assert not check("crash", f"{_START}{there}\n{instead}")


@pytest.mark.parametrize(
    ("path", "call"),
    [
        ("bpy.types.WindowManager.popup_menu", "bpy.context.window_manager.popup_menu(drawn, title='t')"),
        ("bpy.types.WindowManager.popover", "bpy.context.window_manager.popover(drawn)"),
        ("bpy.ops.wm.call_menu", "bpy.ops.wm.call_menu(name='VIEW3D_MT_add')"),
        ("bpy.ops.wm.call_menu_pie", "bpy.ops.wm.call_menu_pie(name='VIEW3D_MT_snap_pie')"),
        ("bpy.ops.wm.call_panel", "bpy.ops.wm.call_panel(name='OBJECT_PT_transform')"),
    ],
)
def test_what_pops_up_crashes_a_blender_without_a_window(
    check: Check, rule_checker: Checker, path: str, call: str
) -> None:
    code = f"{_START}def drawn(self, context):\n    self.layout.label(text='i')\n\n{call}"
    symbol = rule_checker.api.symbols.symbol(path)
    assert symbol is not None
    assert "where there is no window" in fatal_lines(symbol)
    assert _ends(code)
    assert [one.severity for one in check("crash", code)] == ["warning"]
    assert not check("crash", f"{code}\n\ndef register():\n    pass\n")


@pytest.mark.parametrize(
    ("before", "severity"),
    [
        ("", "warning"),
        ("bpy.ops.wm.read_factory_settings()\n", "error"),
        ("bpy.ops.wm.read_factory_settings(use_empty=True)\n", "error"),
        ("bpy.ops.wm.read_factory_settings(app_template='Video_Editing')\n", "warning"),
        ("bpy.ops.wm.read_factory_settings()\nbpy.ops.wm.open_mainfile(filepath='/x.blend')\n", "warning"),
    ],
)
def test_what_a_script_makes_the_file_of_a_new_blender_surely_crashes(
    check: Check, before: str, severity: str
) -> None:
    code = f"import bpy\n{before}scene = bpy.context.scene\n{_STRIP}\nstrip.modifiers.new('m', 'CURVES')"
    (found,) = check("crash", code)
    assert found.severity == severity
    if severity == "error":
        assert _ends(code)
    assert not check("crash", code.replace("strip.modifiers", f"{_SET}\nstrip.modifiers"))


_ASKED = "import bpy, bmesh\nbm = bmesh.new()\nvert = bm.verts.new()\nmesh = bpy.data.meshes.new('m')\n"


@pytest.mark.parametrize(
    ("path", "fatal", "instead", "severity"),
    [
        ("bmesh.ops.bmesh_to_mesh", "bmesh.ops.bmesh_to_mesh(bm)", "bm.to_mesh(mesh)", "error"),
        ("bmesh.ops.mesh_to_bmesh", "bmesh.ops.mesh_to_bmesh(bm)", "bm.from_mesh(mesh)", "error"),
        ("bmesh.ops.object_load_bmesh", "bmesh.ops.object_load_bmesh(bm)", "bm.to_mesh(mesh)", "error"),
        (
            "bmesh.ops.pointmerge_facedata",
            "bmesh.ops.pointmerge_facedata(bm, verts=[vert])",
            "bmesh.ops.pointmerge_facedata(bm, verts=[vert], vert_snap=vert)",
            "warning",
        ),
        ("bpy.app.help_text", "bpy.app.help_text()", "bpy.app.version_string", "warning"),
    ],
)
def test_what_crashes_outside_rna_is_said_and_found(
    check: Check, rule_checker: Checker, path: str, fatal: str, instead: str, severity: str
) -> None:
    symbol = rule_checker.api.symbols.symbol(path)
    if symbol is None:
        pytest.skip(f"this Blender has no {path}")
    crashes = _ends(_ASKED + fatal)
    assert bool(fatal_lines(symbol)) is crashes
    assert [found.severity for found in check("crash", _ASKED + fatal)] == [severity] * crashes
    assert not check("crash", _ASKED + instead)
    assert not _ends(_ASKED + instead)


def test_what_is_written_in_its_place_crashes_nothing(rule_checker: Checker) -> None:
    known = [path for path in _CRASHES if rule_checker.api.symbols.symbol(f"bpy.types.{path}")]
    assert not _ends(_START + "\n".join(f"{_CRASHES[path][0]}\n{_CRASHES[path][2]}" for path in known))


def test_an_index_is_written_for_none(check: Check) -> None:
    (found,) = check("crash", "import bpy\nbpy.context.object.vertex_groups.active = None\n")
    assert found.severity == "error"
    assert found.fix is not None
    assert [edit.text for edit in found.fix.edits] == ["bpy.context.object.vertex_groups.active_index = -1"]


@pytest.mark.parametrize(
    ("code", "found"),
    [
        ("c.objects.unlink(bpy.data.objects.get('a'))", ["warning"]),
        ("c.objects.unlink(bpy.data.objects.get('a', c.objects[0]))", []),
        ("c.objects.unlink(object=None)", ["error"]),
        ("try:\n    c.objects.unlink(None)\nexcept RuntimeError:\n    pass", ["error"]),
        ("for ob in (bpy.data.objects.get('a'),):\n    if ob:\n        c.objects.unlink(ob)", []),
        ("ob = bpy.data.objects.get('a')\nassert ob\nc.objects.unlink(ob)", []),
        ("ob = bpy.data.objects.get('a')\nwhile not ob:\n    break\nc.objects.unlink(ob)", []),
        ("[c.objects.unlink(ob) for ob in c.objects if ob]", []),
    ],
)
def test_what_may_be_none_is_told_unless_the_script_asks(check: Check, code: str, found: list[str]) -> None:
    start = "import bpy\nc = bpy.context.scene.collection\n"
    assert [finding.severity for finding in check("crash", start + code)] == found


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("", ""),
        ("bpy.context.workspace.sequencer_scene = scene", ""),
        ("", "bpy.context.workspace.sequencer_scene = scene"),
    ],
)
def test_a_call_that_ends_blender_is_found_unless_what_it_needs_is_set(
    check: Check, before: str, after: str
) -> None:
    found = check(
        "crash",
        f"""\
import bpy
scene = bpy.context.scene
{before}
strips = scene.sequence_editor_create().strips
strip = strips.new_effect("strip", "COLOR", channel=1, frame_start=1, length=9)
strip.modifiers.new("modifier", "CURVES")
{after}
""",
    )
    assert [(finding.span.line, finding.severity) for finding in found] == [(6, "warning")] * (not before)


_SCULPT = "import bpy\n{}\nbpy.ops.object.mode_set(mode='SCULPT')\n{}\n"
_CREATE = "bpy.ops.sculpt.face_sets_create(mode='ALL')"
_STEP = "bpy.ops.ed.undo_push(message='before')"


@pytest.mark.parametrize(
    ("before", "code"),
    [
        ("", _CREATE),
        (_STEP, _CREATE),
        ("bpy.ops.mesh.primitive_cube_add()", "bpy.ops.paint.mask_flood_fill(mode='VALUE', value=0.5)"),
        ("", "bpy.ops.sculpt.symmetrize()"),
        ("", "bpy.ops.sculpt.dynamic_topology_toggle()"),
        ("", "bpy.ops.object.mode_set(mode='VERTEX_PAINT')\nbpy.ops.paint.vertex_color_set()"),
    ],
)
def test_an_operator_that_ends_blender_without_an_undo_step_is_found(
    check: Check, before: str, code: str
) -> None:
    script = _SCULPT.format(before, code)
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, check=False)
    found = [finding.severity for finding in check("crash", script)]
    assert found == ["warning"] * (ended.returncode < 0)


@pytest.mark.parametrize(
    "code",
    [
        _CREATE,
        f"import bpy\ndef register():\n    bpy.ops.object.mode_set(mode='SCULPT')\n    {_CREATE}\n",
        f"import bpy, helpers\nbpy.ops.object.mode_set(mode='SCULPT')\n{_CREATE}\n",
    ],
)
def test_what_may_have_an_undo_step_is_left_alone(check: Check, code: str) -> None:
    assert not check("crash", code)


@pytest.mark.parametrize(
    ("made", "call"),
    [
        ("bpy.data.hair_curves.new('h')", "add_curves"),
        (
            "bpy.data.grease_pencils.new('g').layers.new('l').frames.new(1).drawing",
            "add_strokes",
        ),
    ],
)
def test_nothing_to_add_crashes(check: Check, made: str, call: str) -> None:
    code = f"import bpy\ndata = {made}\ndata.{call}({{}})\n"
    assert [one.severity for one in check("crash", code.format("[]"))] == ["error"]
    assert check("crash", code.format("[3]")) == []
    assert _ends(code.format("[]"))
    assert not _ends(code.format("[3]"))
