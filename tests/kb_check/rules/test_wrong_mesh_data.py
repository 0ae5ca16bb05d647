"""Lists that are no mesh are found: each is given to Blender, which refuses it or makes an invalid mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = "import bpy\nmesh = bpy.data.meshes.new('m')\n"
_THREE = "[(0, 0, 0), (1, 0, 0), (1, 1, 0)]"
_REFUSED = {
    "two numbers": "mesh.from_pydata([(0, 0)], [], [])",
    "two numbers, by keyword": "mesh.from_pydata(vertices=[(0, 0), (1, 0)], edges=[], faces=[])",
    "two numbers in one": "mesh.from_pydata([(0, 0, 0), [1, 0]], [], [])",
    "a list by its name": "verts = [(0, 0), (1, 0), (1, 1)]\nmesh.from_pydata(verts, [], [(0, 1, 2)])",
    "each of a loop": "mesh.from_pydata([(x, 1) for x in range(3)], [], [])",
    "edges of three": f"mesh.from_pydata({_THREE}, [(0, 1, 2)], [])",
    "edges of one": f"mesh.from_pydata({_THREE}, [(0,)], [])",
}
_INVALID = {
    "beyond the last": f"mesh.from_pydata({_THREE}, [], [(1, 2, 3)])",
    "below the first": f"mesh.from_pydata({_THREE}, [], [(0, 1, -1)])",
    "an edge": f"mesh.from_pydata({_THREE}, [(0, 3)], [])",
    "a face of two": f"mesh.from_pydata({_THREE}, [], [(0, 1)])",
}
_SHIFTED = {"four numbers": "mesh.from_pydata([(0, 0, 0, 1), (2, 2, 2, 1)], [], [])"}
_SOUND = {
    "a face": f"mesh.from_pydata({_THREE}, [], [(0, 1, 2)])",
    "an edge": f"mesh.from_pydata({_THREE}, [(0, 2)], [])",
    "nothing": "mesh.from_pydata([], [], [])",
    "a list that grows": "verts = [(0, 0, 0), (1, 0, 0)]\nverts.append((1, 1, 0))\n"
    "mesh.from_pydata(verts, [], [(0, 1, 2)])",
    "what is unpacked": "two = (0, 0)\nmesh.from_pydata([(*two, 0), (*two, 1), (1, *two)], [], [(0, 1, 2)])",
    "several of them": f"more = {_THREE}\nmesh.from_pydata([*more, (2, 2, 0)], [], [(0, 1, 3)])",
    "numbers of a loop": "mesh.from_pydata([(x, x * x, 0) for x in range(4)], [], [(0, 1, 3)])",
    "caught": "try:\n    mesh.from_pydata([(0, 0)], [], [])\nexcept RuntimeError:\n    pass",
}


def test_lists_that_are_no_mesh_are_found(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _REFUSED.values()])
    errors = {name: error.partition(":")[0] for name, (error, *_) in zip(_REFUSED, answers, strict=True)}
    assert errors == dict.fromkeys(_REFUSED, "RuntimeError")
    found = {name: check("wrong-mesh-data", f"{_START}{code}") for name, code in _REFUSED.items()}
    severities = {name: [finding.severity for finding in findings] for name, findings in found.items()}
    assert severities == {name: ["error"] for name in _REFUSED}


def test_lists_that_make_another_mesh_are_warned_of(check: Check, tmp_path: Path) -> None:
    codes = {**_INVALID, **_SHIFTED}
    watched = dict.fromkeys(range(len(_INVALID)), "mesh.validate()")
    watched[len(_INVALID)] = "mesh.vertices[1].co.x != 2"
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in codes.values()], watched)
    assert [(name, error, after) for name, (error, _, after) in zip(codes, answers, strict=True)] == [
        (name, "", "True") for name in codes
    ]
    found = {name: check("wrong-mesh-data", f"{_START}{code}") for name, code in codes.items()}
    severities = {name: [finding.severity for finding in findings] for name, findings in found.items()}
    assert severities == {name: ["warning"] for name in codes}


def test_a_mesh_has_no_finding(check: Check, tmp_path: Path) -> None:
    codes = [f"{_START}{code}" for code in _SOUND.values()]
    answers = run_statements(tmp_path, codes, dict.fromkeys(range(len(codes) - 1), "mesh.validate()"))
    assert [
        (name, error, after) for name, (error, _, after) in zip(_SOUND, answers, strict=True) if error
    ] == []
    assert {after for _, _, after in answers[:-1]} == {"False"}
    assert [name for name, code in _SOUND.items() if check("wrong-mesh-data", f"{_START}{code}")] == []
