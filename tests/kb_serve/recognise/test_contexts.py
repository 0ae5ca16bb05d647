"""What lets an operator run whose context does not fit: lines that work in Blender."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_serve.recognise.chains.chains import find_chains
from kb_serve.recognise.code.contexts import with_context

if TYPE_CHECKING:
    from pathlib import Path

    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("rigidbody.object_add", "'MESH'. `bpy.context.view_layer.objects.active = ob` comes before."),
        ("object.mode_set", "an active object. `bpy.context.view_layer.objects.active = ob` comes before."),
        ("object.duplicate", "in mode 'OBJECT'. `bpy.ops.object.mode_set(mode='OBJECT')` comes before."),
        ("nla.bake", "it refused nothing that was tried"),
        ("sequencer.delete", "bpy.context.workspace.sequencer_scene = scene"),
        (
            "sequencer.effect_strip_add",
            "`bpy.context.workspace.sequencer_scene = scene`; `areas = bpy.context.window.screen.areas`; `area =",
        ),
        ("mesh.subdivide", "mode_set(mode='EDIT')"),
        ("view3d.snap_cursor_to_center", "a.type == 'VIEW_3D'"),
        ("mesh.loop_select", "a.type == 'VIEW_3D'"),
        (
            "mesh.knife_tool",
            "objects.active = ob`; `bpy.ops.object.mode_set(mode='EDIT')`; `areas = bpy.context.window.screen.areas`;",
        ),
        (
            "text.insert",
            "area.type = 'TEXT_EDITOR'`; `area.spaces.active.text = bpy.data.texts.new(\"name\")`; `region = next(",
        ),
        (
            "graph.smooth",
            "`bpy.context.view_layer.objects.active = ob`; `ob.select_set(True)`; `obj.keyframe_insert(",
        ),
        (
            "paintcurve.new",
            "it took nothing of what was tried (objects of every type in every mode, areas of",
        ),
        ("anim.keyframe_insert", "`area = bpy.context.window.screen.areas[0]`"),
        ("asset.mark", "`with bpy.context.temp_override(id=ob): bpy.ops.asset.mark()`."),
        (
            "ptcache.bake",
            "with bpy.context.temp_override(point_cache=modifier.point_cache): bpy.ops.ptcache.bake(bake=True)",
        ),
        ("rigidbody.connect", "what `bpy.ops.rigidbody.object_add()` adds. `bpy.context.view_layer"),
        ("object.shape_key_add", "= ob`, then `bpy.ops.object.mode_set(mode='OBJECT')`."),
        ("anim.keying_set_path_add", "it takes what `scene.keying_sets.new()` adds."),
        (
            "pose.transforms_clear",
            "of type 'ARMATURE' in mode 'POSE'. `bpy.context.view_layer.objects.active = ob`",
        ),
        ("anim.clear_useless_actions", "another mode, active object, selection or editor"),
    ],
)
def test_a_failed_poll_says_what_helps(kb: KnowledgeBase, path: str, said: str) -> None:
    message = f"RuntimeError: Operator bpy.ops.{path}.poll() failed, context is incorrect"
    (note,) = [note for note in kb.query(message).notes if "poll()" in note]
    assert said in note


_RUN = """
import json, re, sys
import bpy
told = []
bpy.ops.wm.read_factory_settings()
ob = bpy.context.object
for note in json.load(open(sys.argv[-1])):
    for line in re.findall("`(.+?)`", note[note.index("`areas = "):]):
        exec(line)
    told.append([area.type for area in bpy.context.window.screen.areas])
open(sys.argv[-1], "w").write(json.dumps(told))
"""


def test_an_area_that_the_screen_lacks_is_made_in_blender(kb: KnowledgeBase, tmp_path: Path) -> None:
    wanted = {
        "clip.view_zoom_in": "CLIP_EDITOR",
        "graph.view_all": "GRAPH_EDITOR",
        "nla.view_all": "NLA_EDITOR",
        "text.insert": "TEXT_EDITOR",
        "view3d.snap_cursor_to_center": "VIEW_3D",
    }
    notes = [
        kb.query(f"RuntimeError: Operator bpy.ops.{path}.poll() failed, context is incorrect").notes[0]
        for path in wanted
    ]
    told = told_by_blender(_RUN, tmp_path, notes)
    assert all(area in areas for area, areas in zip(wanted.values(), told, strict=True))


def test_a_call_keeps_the_arguments_that_it_was_made_with(kb: KnowledgeBase) -> None:
    call = "bpy.ops.anim.keyframe_insert(type='Location')"
    message = "RuntimeError: Operator bpy.ops.anim.keyframe_insert.poll() failed, context is incorrect"
    assert f": {call}`" in kb.query(f"{call}\n{message}").notes[0]
    by_place = kb.query(f"bpy.ops.anim.keyframe_insert('INVOKE_DEFAULT')\n{message}")
    assert ": bpy.ops.anim.keyframe_insert()`" in "\n".join(by_place.notes)


def test_a_poll_that_names_what_its_like_want_says_so(kb: KnowledgeBase) -> None:
    message = (
        "RuntimeError: Operator bpy.ops.asset.clear.poll() No data-block selected that is marked as asset"
    )
    assert "`with bpy.context.temp_override(id=ob): bpy.ops.asset.clear()`" in kb.query(message).notes[0]
    other = "RuntimeError: Operator bpy.ops.asset.clear.poll() failed, context is incorrect"
    assert "temp_override(id=" not in kb.query(other).text


@pytest.mark.parametrize(
    ("old", "now"),
    [
        (
            'bpy.ops.object.delete({"selected_objects": objs})',
            "with bpy.context.temp_override(selected_objects=objs): bpy.ops.object.delete()",
        ),
        (
            'bpy.ops.object.modifier_apply(override, modifier="Bevel")',
            "with bpy.context.temp_override(**override): bpy.ops.object.modifier_apply(modifier='Bevel')",
        ),
        (
            'bpy.ops.object.modifier_apply(c, modifier="Bevel")',
            "with bpy.context.temp_override(**c): bpy.ops.object.modifier_apply(modifier='Bevel')",
        ),
        ("bpy.ops.object.join({", ""),
        ("bpy.ops.object.join()", ""),
    ],
)
def test_a_context_as_an_argument_becomes_a_with_line(kb: KnowledgeBase, old: str, now: str) -> None:
    (chain,) = find_chains(old)
    assert with_context(chain) == now
    assert not now or f"Write `{now}`." in kb.query(old).text


def test_a_parameters_name_is_no_context(kb: KnowledgeBase) -> None:
    assert "Write `" not in kb.query("bpy.ops.mesh.primitive_cube_add(size, location)").text


@pytest.mark.blender
@pytest.mark.parametrize("given", ["obj", "bpy.data.objects['Camera']"])
def test_an_object_that_an_operator_is_called_with_is_what_it_works_on(kb: KnowledgeBase, given: str) -> None:
    bpy = pytest.importorskip("bpy")
    bpy.ops.wm.read_factory_settings()
    note = "\n".join(kb.query(f"bpy.ops.object.delete({given})").notes)
    written = re.search(r"Write `(with .+?)`", note)
    assert written is not None
    exec(written[1], {"bpy": bpy, "obj": bpy.data.objects["Camera"]})
    assert sorted(obj.name for obj in bpy.data.objects) == ["Cube", "Light"]
    bpy.ops.wm.read_factory_settings(use_empty=True)
