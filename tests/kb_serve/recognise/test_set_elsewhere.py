"""What an operator has no argument for is set where the sentence says, in this environment's Blender."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_serve.recognise.by_words.set_elsewhere import set_elsewhere

if TYPE_CHECKING:
    from pathlib import Path

    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

# (a call that runs, a keyword that it refuses, a value for it)
SET = [
    ("mesh.primitive_cube_add()", "name", "Box"),
    ("mesh.primitive_cube_add()", "dimensions", [1.0, 2.0, 3.0]),
    ("curve.primitive_bezier_circle_add()", "bevel_depth", 0.25),
    ("surface.primitive_nurbs_surface_sphere_add()", "resolution_u", 5),
    ("object.armature_add()", "display_type", "STICK"),
    ("object.camera_add()", "lens", 85.0),
    ("object.constraint_add(type='TRACK_TO')", "track_axis", "TRACK_Y"),
    ("object.effector_add(type='WIND')", "strength", 5.0),
    ("object.empty_add()", "empty_display_size", 2.0),
    ("object.grease_pencil_add(type='EMPTY')", "onion_mode", "RELATIVE"),
    ("object.light_add(type='SPOT')", "energy", 100.0),
    ("object.light_add(type='AREA')", "size", 2.0),
    ("object.light_add(type='AREA')", "power", 7.0),
    ("object.lightprobe_add(type='SPHERE')", "clip_start", 0.5),
    ("object.metaball_add()", "threshold", 0.5),
    ("object.modifier_add(type='SUBSURF')", "levels", 3),
    ("object.particle_system_add()", "count", 100),
    ("object.speaker_add()", "volume", 0.5),
    ("object.text_add()", "text", "Hello"),
    ("object.text_add()", "extrude", 0.25),
    ("object.volume_add()", "frame_start", 5),
    ("render.render()", "filepath", "/tmp/picture"),
    ("rigidbody.object_add()", "mass", 2.0),
    ("rigidbody.world_add()", "time_scale", 0.5),
]
_RUN = """
import json, sys
import bpy
told = []
for call, path, value in json.load(open(sys.argv[-1])):
    bpy.ops.wm.read_factory_settings()
    if not call.startswith("render."):
        exec(f"bpy.ops.{call}")
    exec(f"{path} = value")
    bpy.context.view_layer.update()
    set_to = eval(path)
    told.append(set_to if isinstance(set_to, (str, int, float)) else [*set_to])
open(sys.argv[-1], "w").write(json.dumps(told))
"""


def _told(call: str, name: str, reader: BaseReader) -> str:
    operator = reader.symbol(f"bpy.ops.{call.partition('(')[0]}")
    assert operator is not None
    assert all(parameter.name != name for parameter in operator.parameters)
    return set_elsewhere(operator, name, reader)


def test_it_is_set_where_the_sentence_says_in_blender(reader: BaseReader, tmp_path: Path) -> None:
    paths = [re.findall("`(.+)`", _told(call, name, reader))[0] for call, name, _ in SET]
    given = [(call, path, value) for (call, _, value), path in zip(SET, paths, strict=True)]
    told = told_by_blender(_RUN, tmp_path, given)
    assert [*zip(paths, told, strict=True)] == [*zip(paths, (value for *_, value in SET), strict=True)]


@pytest.mark.parametrize(
    ("call", "name", "sentence"),
    [
        ("object.shade_smooth", "angle", "`bpy.ops.object.shade_smooth_by_angle` takes it."),
        (
            "mesh.extrude_region_move",
            "orient_type",
            'Its part takes it: `TRANSFORM_OT_translate={"orient_type": …}`.',
        ),
        ("mesh.primitive_cube_add", "colour_of_dreams", ""),
        ("object.delete", "name", ""),  # it makes nothing
        ("object.light_add", "users", ""),  # read only
        ("wm.save_as_mainfile", "name", ""),
    ],
)
def test_other_operators_take_it_or_nothing_is_said(
    call: str, name: str, sentence: str, reader: BaseReader
) -> None:
    assert _told(call, name, reader) == sentence


@pytest.mark.parametrize(
    ("line", "closest"),
    [
        ("bpy.ops.object.select_all(type='DESELECT')", "`action`"),  # which takes that value
        ("bpy.ops.mesh.primitive_cylinder_add(height=3)", "`radius`, `depth`"),
        ("bpy.ops.object.empty_add(type='CUBE', size=1)", "`radius`"),
    ],
)
def test_a_keyword_may_mean_one_by_its_value_or_as_an_extent(
    line: str, closest: str, kb: KnowledgeBase
) -> None:
    assert f"closest: {closest}." in kb.query(line).notes[0]
