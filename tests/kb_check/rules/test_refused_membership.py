"""Things that collections are asked for with ``in`` are found: each script is run, and fails or does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy, bmesh
bpy.ops.wm.read_factory_settings()
obj = bpy.context.object
mesh = bpy.data.meshes["Cube"]
mat = bpy.data.materials["Material"]
"""
_WRONG = {
    "of the file": "found = mat in bpy.data.materials",
    "not in it": "found = not (mat not in bpy.data.materials)",
    "of a scene": "found = obj in bpy.context.scene.objects",
    "of a mesh": "found = mat in mesh.materials",
    "a pointer": "found = obj.active_material in mesh.materials",
    "what has no name": "found = mesh.vertices[0] in mesh.vertices",
    "modifiers": "found = obj.modifiers.new('a', 'SUBSURF') in obj.modifiers",
    "nodes": "node = mat.node_tree.nodes[0]\nfound = node in mat.node_tree.nodes",
    "children": "part = bpy.context.collection\nfound = part in bpy.context.scene.collection.children",
}
_MORE = {"a number": "0 in mesh.vertices", "None": "None in bpy.data.objects"}
_SOUND = {
    "by its name": "assert mat.name in bpy.data.materials",
    "values": "assert mat in bpy.data.materials.values()",
    "keys": "assert 'Cube' in bpy.data.objects.keys()",
    "a name and a library": "('Cube', None) in bpy.data.objects",
    "a list of the context": "assert obj in bpy.context.selected_objects",
    "a list of all below": "obj in bpy.context.scene.collection.all_objects.values()",
    "children of an object": "obj in obj.children",
    "an array": "0 in mesh.polygons[0].vertices\n1.0 in obj.location",
    "a copy": "assert obj in list(bpy.data.objects)\nassert obj in bpy.data.objects[:]",
    "of bmesh": "bm = bmesh.new()\nassert bm.verts.new() in bm.verts",
    "what may be a text": "def has(one):\n    if isinstance(one, str):\n        return one in bpy.data.objects\n"
    "has(obj)\nhas('x')",
    "caught": "try:\n    mat in bpy.data.materials\nexcept TypeError:\n    pass",
    "custom properties": "'x' in obj",
}


def test_things_that_are_asked_for_are_found(check: Check, tmp_path: Path) -> None:
    codes = _WRONG | _MORE
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in codes.values()])
    errors = {name: error.partition(":")[0] for name, (error, *_) in zip(codes, answers, strict=True)}
    assert errors == dict.fromkeys(codes, "TypeError")
    found = {name: check("refused-membership", f"{_START}{code}") for name, code in codes.items()}
    assert [name for name, findings in found.items() if len(findings) != 1] == []


def test_what_is_mended_finds_the_thing(check: Check, tmp_path: Path) -> None:
    mended: list[str] = []
    for code in _WRONG.values():
        text = f"{_START}{code}"
        mended.append(apply_fixes(Source(text), check("refused-membership", text)).text)
    truths = dict.fromkeys(range(len(mended)), "found")
    answers = run_statements(tmp_path, mended, truths)
    assert [(error, after) for error, _, after in answers] == [("", "True")] * len(mended)


def test_what_runs_has_no_finding(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _SOUND.values()])
    assert [(name, error) for name, (error, *_) in zip(_SOUND, answers, strict=True) if error] == []
    assert [name for name, code in _SOUND.items() if check("refused-membership", f"{_START}{code}")] == []
