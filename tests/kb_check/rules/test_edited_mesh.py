"""What changes a mesh in Edit Mode in vain is found: each script is run in Blender, which refuses it or loses it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy, bmesh
bpy.ops.wm.read_factory_settings()
bpy.ops.mesh.primitive_cube_add()
ob = bpy.context.object
mesh = ob.data
group = ob.vertex_groups.new(name="group")
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.mesh.select_all(action="DESELECT")
"""
_LEAVE = "\nbpy.ops.object.mode_set(mode='OBJECT')"
_NEW = "bm = bmesh.new()\nbm.from_mesh(mesh)\n"
_REFUSED = {
    "to_mesh": f"{_NEW}bm.to_mesh(mesh)",
    "to_mesh of its own": "bm = bmesh.from_edit_mesh(mesh)\nbm.to_mesh(ob.data)",
    "from_pydata": "mesh.from_pydata([(0, 0, 0)], [], [])",
    "vertices": "ob.data.vertices.add(1)",
    "group": "group.add([0], 1.0, 'REPLACE')",
    "group by its name": "ob.vertex_groups['group'].remove([0])",
}
# What is done in Edit Mode, and what tells afterwards whether it was.
_LOST = {
    "selected": ("ob.data.vertices[0].select = True", "mesh.vertices[0].select"),
    "selected by a name": ("mesh.vertices[0].select = True", "mesh.vertices[0].select"),
    "of the context": ("bpy.context.object.data.vertices[0].select = True", "mesh.vertices[0].select"),
    "of the edited object": (
        "bpy.context.edit_object.data.vertices[0].select = True",
        "mesh.vertices[0].select",
    ),
    "in a loop": (
        "for face in mesh.polygons:\n    if face.normal.z > 0.5:\n        face.select = True",
        "any(face.select for face in mesh.polygons)",
    ),
    "in two loops": (
        "for face in mesh.polygons:\n    print(face.index)\nfor face in mesh.polygons:\n    face.select = True",
        "mesh.polygons[0].select",
    ),
    "moved": ("mesh.vertices[0].co.x = 9", "mesh.vertices[0].co.x == 9"),
    "moved by item": ("mesh.vertices[0].co[0] = 9", "mesh.vertices[0].co.x == 9"),
    "added to": ("mesh.vertices[0].co.x += 9", "mesh.vertices[0].co.x > 5"),
    "all at once": ("mesh.vertices.foreach_set('co', [9.0] * 24)", "mesh.vertices[0].co.x == 9"),
    "material": ("mesh.polygons[0].material_index = 1", "mesh.polygons[0].material_index"),
    "seam": ("mesh.edges[0].use_seam = True", "mesh.edges[0].use_seam"),
    "flipped": (
        "normal = mesh.polygons[0].normal.copy()\nmesh.flip_normals()",
        "mesh.polygons[0].normal != normal",
    ),
    "cleared": ("mesh.clear_geometry()", "not mesh.vertices"),
}
_SOUND = {
    "left before": (f"{_LEAVE}\nmesh.vertices[0].select = True", "mesh.vertices[0].select"),
    "left by toggle": (
        "bpy.ops.object.editmode_toggle()\nmesh.vertices[0].select = True",
        "mesh.vertices[0].select",
    ),
    "left by a function": (
        "def leave():\n    bpy.ops.object.mode_set(mode='OBJECT')\nleave()\nmesh.vertices[0].select = True",
        "mesh.vertices[0].select",
    ),
    "after other operators": (
        "bpy.ops.uv.cube_project()\nbpy.ops.mesh.subdivide()\nbpy.ops.object.mode_set(mode='OBJECT')\n"
        "mesh.vertices[0].select = True",
        "mesh.vertices[0].select",
    ),
    "another mesh": (
        "other = bpy.data.meshes.new('other')\nother.from_pydata([(0, 0, 0)], [], [])\n"
        "other.vertices[0].select = True\nbm = bmesh.new()\nbm.to_mesh(other)",
        "True",
    ),
    "another object": (
        "bpy.context.view_layer.objects.active = bpy.data.objects['Cube']\n"
        "bpy.data.objects['Cube'].data.vertices[0].co.x = 9",
        "bpy.data.objects['Cube'].data.vertices[0].co.x == 9",
    ),
    "the startup cube": (
        "cube = bpy.data.objects['Cube']\ncube.data.vertices[0].co.x = 9",
        "bpy.data.objects['Cube'].data.vertices[0].co.x == 9",
    ),
    "its BMesh": (
        "bm = bmesh.from_edit_mesh(mesh)\nbm.verts.ensure_lookup_table()\nbm.verts[0].co.x = 9\n"
        "bmesh.update_edit_mesh(mesh)",
        "mesh.vertices[0].co.x == 9",
    ),
    "in a loop over another mesh, too": (
        "other = bpy.data.objects['Cube'].data\nfor face in mesh.polygons:\n    print(face.index)\n"
        "for face in other.polygons:\n    face.use_smooth = True",
        "other.polygons[0].use_smooth",
    ),
    "in a loop that leaves": (
        "for n in range(2):\n    bpy.ops.object.mode_set(mode='OBJECT')\n    mesh.vertices[n].co.x = 9",
        "mesh.vertices[0].co.x == 9",
    ),
    "what no BMesh has": (
        "mesh.name = 'a'\nmesh.materials.append(None)\nob.location.x = 2",
        "mesh.materials",
    ),
    "caught": ("try:\n    mesh.vertices.add(1)\nexcept RuntimeError:\n    pass", "True"),
    "another data": (
        f"{_LEAVE}\nob.data = bpy.data.meshes['Cube']\nmesh.vertices[0].co.x = 9",
        "mesh.vertices[0].co.x == 9",
    ),
}


@pytest.mark.parametrize("name", [*_REFUSED, *_LOST])
def test_what_changes_an_edited_mesh_is_found(check: Check, name: str) -> None:
    code = _REFUSED[name] if name in _REFUSED else _LOST[name][0]
    found = check("edited-mesh", f"{_START}{code}\n")
    assert [finding.severity for finding in found] == ["error" if name in _REFUSED else "warning"]


@pytest.mark.parametrize("name", _SOUND)
def test_what_has_an_effect_has_no_finding(check: Check, name: str) -> None:
    assert check("edited-mesh", f"{_START}{_SOUND[name][0]}\n") == []


def test_blender_refuses_and_loses_them(tmp_path: Path) -> None:
    codes = [f"{_START}{code}" for code in _REFUSED.values()]
    changed = [f"{_START}{code}{_LEAVE}\nassert not ({asked})" for code, asked in _LOST.values()]
    kept = [
        f"{_START}{code}\nif ob.mode == 'EDIT' and bpy.context.object == ob:{_LEAVE.replace(chr(10), ' ')}\n"
        f"assert {asked}"
        for code, asked in _SOUND.values()
    ]
    answers = [error for error, *_ in run_statements(tmp_path, [*codes, *changed, *kept])]
    refused, others = answers[: len(codes)], answers[len(codes) :]
    assert [name for name, error in zip(_REFUSED, refused, strict=True) if not error] == []
    assert [(name, error) for name, error in zip([*_LOST, *_SOUND], others, strict=True) if error] == []


_BY_FUNCTIONS = """\
import bpy, bmesh
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_cube_add()
mesh = bpy.context.object.data
{code}
"""
_ENTER = "bpy.ops.object.mode_set(mode='EDIT')\n"


@pytest.mark.parametrize(
    ("code", "is_refused"),
    [
        ("bmesh.from_edit_mesh(mesh)", True),
        ("bmesh.update_edit_mesh(mesh)", True),
        (f"{_ENTER}bpy.ops.object.mode_set(mode='OBJECT')\nbmesh.from_edit_mesh(mesh)", True),
        ("def change():\n    return bmesh.from_edit_mesh(mesh)\nbpy.ops.object.select_all()\nchange()", True),
        (f"{_ENTER}bmesh.from_edit_mesh(mesh)\nbmesh.update_edit_mesh(mesh)", False),
        (f"def change():\n    return bmesh.from_edit_mesh(mesh)\n{_ENTER}change()", False),
        (
            f"{_ENTER}bpy.context.view_layer.objects.active = None\nbpy.ops.mesh.primitive_cube_add()\n"
            "bmesh.from_edit_mesh(mesh)",
            False,
        ),
        ("if mesh.is_editmode:\n    bmesh.from_edit_mesh(mesh)", False),
        ("try:\n    bmesh.from_edit_mesh(mesh)\nexcept ValueError:\n    pass", False),
    ],
)
def test_functions_of_edited_meshes_are_held_against_the_mode(
    check: Check, tmp_path: Path, code: str, *, is_refused: bool
) -> None:
    script = _BY_FUNCTIONS.format(code=code)
    ((error, *_),) = run_statements(tmp_path, [script])
    assert bool(error) is is_refused
    assert bool(check("wrong-mode", script)) is is_refused


@pytest.mark.parametrize(
    ("code", "is_found"),
    [
        ("mesh = bpy.data.meshes.new('a')\nbmesh.from_edit_mesh(mesh)", True),
        (
            "mesh = bpy.data.meshes.new('a')\nob = bpy.data.objects.new('a', mesh)\nbmesh.from_edit_mesh(ob.data)",
            True,
        ),
        ("bpy.ops.mesh.primitive_cube_add()\nbmesh.from_edit_mesh(bpy.context.object.data)", True),
        ("bmesh.from_edit_mesh(bpy.context.object.data)", False),
        ("bmesh.from_edit_mesh(bpy.data.meshes['Cube'])", False),
        ("def change(mesh):\n    bmesh.from_edit_mesh(mesh)\nchange(bpy.context.object.data)", False),
    ],
)
def test_only_new_meshes_are_surely_in_object_mode_when_a_script_starts(
    check: Check, code: str, *, is_found: bool
) -> None:
    found = check("wrong-mode", f"import bpy, bmesh\n{code}\n")
    assert [finding.severity for finding in found] == ["error"] * is_found
