"""Checks of scripts that are four times as long do about four times the work.

The work is counted, not timed: the lines of Python that are come to.
"""

from __future__ import annotations

import sys
from textwrap import dedent, indent
from typing import TYPE_CHECKING

import pytest
from whole import by_turns

from kb_check.running.reach import RunReach

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

    from _typeshed import TraceFunction

    from kb_check.checker import Checker

_FEW, _TIMES = 30, 4
_MOST_GROWTH = 5.0
_NODES = """
tree = bpy.data.materials.new("A").node_tree
zones = bpy.data.node_groups.new("A", "GeometryNodeTree")
"""
# Kind of script → what it begins with, and what it repeats, with a number for `#`, the next for `#_`, and for `@` a
# letter that no script before had: what is said of a name is kept.
_KINDS = {
    "settings of nodes": (
        _NODES,
        """
        mix# = tree.nodes.new("ShaderNodeMix")
        mix#.data_type = "RGBA"
        tree.links.new(mix#.outputs[0], mix#.inputs[6])
        """,
    ),
    "settings of nodes that one name stands for": (
        _NODES,
        """
        mix = tree.nodes.new("ShaderNodeMix")
        mix.data_type = "RGBA"
        tree.links.new(mix.outputs[0], mix.inputs[6])
        """,
    ),
    "zones": (
        _NODES,
        """
        first# = zones.nodes.new("GeometryNodeSimulationInput")
        last# = zones.nodes.new("GeometryNodeSimulationOutput")
        first#.pair_with_output(last#)
        first#.inputs["Geometry"]
        """,
    ),
    "values that go with a setting": (
        """
        images = bpy.context.scene.render.image_settings
        images.media_type = "VIDEO"
        """,
        """
        images.file_format = "FFMPEG"
        bpy.context.scene.frame_end = #
        """,
    ),
    "pointers that operators fill": (
        "",
        """
        bpy.ops.mesh.primitive_cube_add()
        field# = bpy.context.object.field
        field#.strength = 1.0
        """,
    ),
    "calls that are made again": (
        "",
        """
        mesh# = bpy.data.meshes.new("A")
        ob# = bpy.data.objects.new("A", mesh#)
        bpy.context.collection.objects.link(ob#)
        bpy.context.collection.objects.link(ob#)
        curve# = bpy.data.curves.new("A", "CURVE")
        curve#.splines.new("BEZIER").points.add(3)
        bpy.data.meshes.remove(mesh#)
        """,
    ),
    "parts that are tried": (
        "",
        """
        try:
            bpy.context.scene.nothing@#
        except AttributeError:
            pass
        bpy.context.object.rigid_body.mass = 1
        """,
    ),
    "operators that are gone": (
        "",
        """
        bpy.ops.nothing.at_all@#()
        bpy.ops.object.nothing@#()
        """,
    ),
    "paths of what is made": (
        "",
        """
        ob# = bpy.data.objects.new("A", None)
        ob#.keyframe_insert('modifiers["A#"].strength')
        """,
    ),
    "functions that call functions": (
        """
        def f0():
            bpy.ops.wm.read_factory_settings(use_empty=True)
            bpy.ops.object.mode_set(mode="OBJECT")
        def g0():
            bpy.data.objects["Cube"].location.x = 1
        """,
        """
        def f#_():
            f#()
        f#_()
        bpy.ops.object.mode_set(mode="EDIT")
        def g#_():
            g#()
        g#_()
        """,
    ),
    "keyframes, drivers and constraints": (
        "ob = bpy.context.object",
        """
        ob.location = (#, 0, 0)
        ob.keyframe_insert("location", frame=#)
        driver# = ob.driver_add("location", 0).driver
        driver#.type = "SCRIPTED"
        ob.constraints.new("TRACK_TO").target = ob
        """,
    ),
    "modes and bones": (
        "ob = bpy.context.object",
        """
        bpy.ops.object.mode_set(mode="EDIT")
        bone# = ob.data.edit_bones.new("A#")
        bone#.head = (0, 0, #)
        bpy.ops.object.mode_set(mode="OBJECT")
        ob.pose.bones["A#"].location = (0, 0, 0)
        """,
    ),
    "trees that are cleared, and objects that are made": (
        "",
        """
        mat# = bpy.data.materials.new("A#")
        mat#.node_tree.nodes.clear()
        out# = mat#.node_tree.nodes.new("ShaderNodeOutputMaterial")
        new# = bpy.data.objects.new("A#", None)
        new#.location = (1, 2, 3)
        bpy.data.materials.remove(mat#)
        """,
    ),
    "meshes that are worked on": (
        "",
        """
        bm# = bmesh.new()
        bm#.verts.new((0, 0, #))
        bm#.verts.ensure_lookup_table()
        bm#.verts[0].co.x = 1
        bm#.free()
        """,
    ),
    "what a function makes and sets wrongly": (
        "def make(ob):",
        """
        bone# = ob.data.edit_bones.new("A#")
        bone#.lost@ = #
        """,
    ),
}


@pytest.mark.parametrize("kind", by_turns(_KINDS))
def test_a_script_that_is_four_times_as_long_takes_about_four_times_the_work(
    checker: Checker, kind: str
) -> None:
    begin, part = map(dedent, _KINDS[kind])

    def work(letter: str, times: int) -> int:
        parts = (_numbered(part.replace("@", letter), n) for n in range(times))
        body = "\n".join(parts)
        code = "\n".join(["import bpy, bmesh", begin, indent(body, "    ") if begin.endswith(":") else body])
        return _counted(lambda: _check(checker, code))

    work("a", _FEW)  # what is kept of the base
    few, many = work("b", _FEW), work("c", _FEW * _TIMES)
    assert many < few * _MOST_GROWTH, f"{few:,} steps, and {many:,} for four times the script"


def _numbered(part: str, number: int) -> str:
    """A part of a script with a number for ``#``, and the next one for ``#_``."""
    return part.replace("#_", str(number + 1)).replace("#", str(number))


def _check(checker: Checker, code: str) -> None:
    """Has a script checked, and each finding asked whether a run comes to it."""
    read = checker.read(code)
    reach = RunReach(read.tree, read.analysis)
    for finding in checker.check(read):
        reach.comes_to(finding.span.line, finding.span.column)


def _counted(run: Callable[[], object]) -> int:
    """The lines that Python comes to meanwhile, each turn of a loop anew."""
    steps, before = 0, sys.gettrace()

    def count(_frame: FrameType, _event: str, _value: object) -> TraceFunction:
        nonlocal steps
        steps += 1
        return count

    sys.settrace(count)
    try:
        run()
    finally:
        sys.settrace(before)
    return steps
