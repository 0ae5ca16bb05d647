"""What is no collection is found where it is looped over: each statement is run, and fails or does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy, bmesh
from mathutils import Vector
from mathutils.kdtree import KDTree
scene = bpy.context.scene
ob = bpy.data.objects.new("o", bpy.data.meshes.new("m"))
tree = bpy.data.node_groups.new("t", "ShaderNodeTree")
bm = bmesh.new()
corner = bm.verts.new()
"""
_REFUSED = (
    "for node in tree: pass",
    "[x for x in ob]",
    "len(ob.data)",
    "list(bpy.data)",
    "sorted(scene, key=str)",
    "x, y = ob",
    "print(*ob)",
    "max(ob)",
    "list(zip(range(3), ob))",
    "list(map(str, scene.render))",
    "tuple(bm)",
    "set(corner)",
    "len(KDTree(3))",
    "list(ob.values)",
    "enumerate(bpy.context)",
)
_RUN = (
    "for node in tree.nodes: pass",
    "[x for x in ob.location]",
    "len(ob.data.vertices)",
    "list(bpy.data.objects)",
    "x, y, z = ob.scale",
    "print(*ob.bound_box)",
    "max(ob.name, scene.name)",
    "list(ob.values())",
    "tuple(bm.verts)",
    "'count' in ob",
    "set(ob.keys())",
    "list(Vector())",
    "sum(ob.location, start=1.0)",
    "sorted([ob, scene], key=str)",
    "list(ob) if hasattr(ob, '__iter__') else [ob]",
)


def test_what_cannot_be_looped_over_is_found(check: Check, tmp_path: Path) -> None:
    raised = run_statements(tmp_path, [_START, *_REFUSED, *_RUN])
    assert [error.partition(":")[0] for error, *_ in raised] == [
        "",
        *["TypeError"] * len(_REFUSED),
        *[""] * len(_RUN),
    ]
    found = [len(check("not-iterable", f"{_START}{code}\n")) for code in (*_REFUSED, *_RUN)]
    assert found == [1] * len(_REFUSED) + [0] * len(_RUN)


def test_the_collection_that_items_are_called_after_is_named(check: Check) -> None:
    [found] = check("not-iterable", f"{_START}for node in tree: pass\n")
    assert found.message.endswith("Its `nodes` can.")


def test_a_method_is_called_by_the_fix(check: Check) -> None:
    [found] = check("not-iterable", f"{_START}list(ob.values)\n")
    assert found.fix is not None
    assert found.fix.edits[0].text == "()"


def test_an_annotation_may_be_wrong(check: Check) -> None:
    [found] = check("not-iterable", f"{_START}def f(objects: bpy.types.Object):\n    return list(objects)\n")
    assert found.severity == "warning"


def test_a_class_of_the_script_may_answer(check: Check, tmp_path: Path) -> None:
    own = """\
class Row(bpy.types.PropertyGroup):
    size: bpy.props.IntProperty(default=2)
    def __iter__(self): return iter(range(self.size))
    def __len__(self): return self.size
bpy.utils.register_class(Row)
bpy.types.Scene.row = bpy.props.PointerProperty(type=Row)
list(bpy.context.scene.row), len(bpy.context.scene.row)
"""
    ((error, *_),) = run_statements(tmp_path, [f"{_START}{own}"])
    assert not error
    assert check("not-iterable", f"{_START}{own}") == []
