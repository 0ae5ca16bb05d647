"""Instances of classes that are none of RNA's: the calls that are said to make them do so."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_serve.answer.ways.makers_of_instances import told_makers

if TYPE_CHECKING:
    from pathlib import Path

    from kb_serve.reader import BaseReader


def _told(reader: BaseReader, path: str) -> str:
    symbol = reader.symbol(path)
    assert symbol is not None
    return "; ".join(told_makers(symbol, reader))


_MAKE = """
import json, sys
import bpy
import bmesh, imbuf, mathutils.bvhtree
object = bpy.context.object
depsgraph = bpy.context.evaluated_depsgraph_get()
mesh = object.data
vertices, polygons = [vertex.co for vertex in mesh.vertices], [tuple(face.vertices) for face in mesh.polygons]
size = (4, 4)
calls = json.load(open(sys.argv[-1]))
made = {}
for call in sorted(calls, key=len):
    if "edit_mesh" in call:
        bpy.ops.object.mode_set(mode="EDIT")
    made[call] = eval(call, {**globals(), "bmesh": bmesh if call.startswith("bmesh.") else bmesh.new()})
    if "edit_mesh" in call:
        bpy.ops.object.mode_set(mode="OBJECT")
open(sys.argv[-1], "w").write(json.dumps({call: type(one).__name__ for call, one in made.items()}))
"""


@pytest.mark.parametrize(
    ("cls", "count"), [("mathutils.bvhtree.BVHTree", 3), ("bmesh.types.BMesh", 2), ("imbuf.types.ImBuf", 3)]
)
def test_each_call_makes_one(reader: BaseReader, tmp_path: Path, cls: str, count: int) -> None:
    calls = re.findall(r"`([^`]+)`", _told(reader, cls))
    assert len(calls) == count
    calls = [call for call in calls if not call.startswith("imbuf.load")]  # of a picture
    assert set(told_by_blender(_MAKE, tmp_path, calls).values()) == {cls.rpartition(".")[2]}


def test_a_method_is_told_with_what_makes_its_instance(reader: BaseReader) -> None:
    told = _told(reader, "bmesh.types.BMesh.to_mesh")
    assert told.startswith("a `BMesh` is made by ")
    assert "`bmesh.new()`" in told
    assert _told(reader, "imbuf.types.ImBuf.copy").startswith("an `ImBuf` is made by ")


@pytest.mark.parametrize(
    "path",
    [
        "mathutils.kdtree.KDTree",  # it is called itself, as its signature says
        "mathutils.kdtree.KDTree.find",
        "mathutils.bvhtree.BVHTree.FromObject",  # what makes one needs none
        "bpy.types.Mesh",  # what RNA has is told how it is made otherwise
        "bpy.types.Mesh.vertices",
        "bmesh.types.BMVert.co",
        "bmesh.new",
    ],
)
def test_nothing_is_told_of_others(reader: BaseReader, path: str) -> None:
    assert _told(reader, path) == ""
