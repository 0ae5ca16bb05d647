"""What the extract says of ``bmesh.ops`` holds in Blender: each claimed type and value is tried."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.blender.extract_reader import Extract
    from kb_build.symbols.records import Symbol

pytestmark = pytest.mark.blender

# Keywords are read in order, so a keyword that does not exist stops the call after the claimed ones were taken.
TRY_KEYWORDS = """
import json, os, sys, bpy, bmesh
from mathutils import Matrix
claims, refused = json.load(open(sys.argv[1])), []
mesh = bmesh.new()
bmesh.ops.create_cube(mesh, size=1.0)
made = {"BMVert": mesh.verts[:][0], "BMEdge": mesh.edges[:][0], "BMFace": mesh.faces[:][0]}
plain = {"float": 0.5, "int": 1, "bool": True, "Matrix": Matrix(), "float[3]": (1, 2, 3)}
def held(kind):
    return [made[name] for name in kind[kind.index("[") + 1 : -1].split(" | ")]
def examples(kind, values):
    if kind in plain:
        return [plain[kind]]
    if kind == "enum":
        return values
    if kind == "set[enum]":
        return [{value} for value in values] + [set(values)]
    if kind in made:
        return [made[kind]]
    if kind.startswith("dict["):
        keys, _, value = kind[5:-1].partition(", ")
        values = [made[name] for name in value.split(" | ")] if value[:2] == "BM" else [plain[value]]
        return [{made[key]: value} for key in keys.split(" | ") for value in values]
    return [set(held(kind))] if kind.startswith("set[") else [held(kind)]
tried = 0
for name, keyword, kind, values in claims:
    for example in examples(kind, values):
        tried += 1
        try:
            getattr(bmesh.ops, name)(mesh, **{keyword: example, "no_such_keyword": 1})
        except Exception as error:
            if "no_such_keyword" not in str(error):
                refused.append([name, keyword, kind, str(error)])
json.dump({"tried": [tried], "refused": refused}, open(sys.argv[2], "w"))
os._exit(0)
"""
CALL = """
import json, os, sys, bpy, bmesh
found = {}
for name, keywords in json.load(open(sys.argv[1])):
    mesh = bmesh.new()
    bmesh.ops.create_cube(mesh, size=1.0)
    parts = {"verts": mesh.verts[:], "edges": mesh.edges[:], "faces": mesh.faces[:]}
    parts["geom"] = sum(parts.values(), [])
    result = getattr(bmesh.ops, name)(mesh, **{key: parts.get(key, 2) for key in keywords})
    for slot, value in result.items():
        kinds = sorted({type(item).__name__ for item in value}) if isinstance(value, list) else []
        found[f"{name}.{slot}"] = [type(value).__name__, kinds]
json.dump(found, open(sys.argv[2], "w"))
os._exit(0)
"""


def ask_blender(script: str, folder: Path, claims: object) -> dict[str, list[Any]]:
    """What a script writes into a file when Blender's interpreter runs it."""
    program, asked, told = folder / "ask.py", folder / "asked.json", folder / "told.json"
    program.write_text(script)
    asked.write_text(json.dumps(claims))
    words = [sys.executable, str(program), str(asked), str(told)]
    subprocess.run(words, env=os.environ | {"TMPDIR": str(folder)}, check=True, capture_output=True)
    return json.loads(told.read_text())


@pytest.fixture(scope="module")
def operators(extract: Extract) -> dict[str, Symbol]:
    return {symbol.name: symbol for symbol in extract.symbols if symbol.owner == "bmesh.ops"}


def test_every_type_and_value_of_a_keyword_is_accepted(operators: dict[str, Symbol], tmp_path: Path) -> None:
    claims = [
        (name, parameter.name, parameter.type, [item.identifier for item in parameter.enum_items])
        for name, symbol in operators.items()
        for parameter in symbol.parameters[1:]
        if parameter.type
    ]
    answer = ask_blender(TRY_KEYWORDS, tmp_path, claims)
    assert answer["refused"] == []
    assert answer["tried"][0] >= len(claims) >= 300


def test_only_what_python_cannot_pass_has_no_type(operators: dict[str, Symbol]) -> None:
    untyped = [p for symbol in operators.values() for p in symbol.parameters if not p.type]
    assert len(untyped) < 12
    assert all("Python cannot pass" in parameter.description for parameter in untyped)


def test_a_bevel_tells_its_values(operators: dict[str, Symbol]) -> None:
    bevel = {parameter.name: parameter for parameter in operators["bevel"].parameters}
    assert (bevel["bmesh"].type, bevel["bmesh"].required) == ("BMesh", True)
    assert bevel["geom"].type == "Sequence[BMVert | BMEdge | BMFace]"
    assert [item.identifier for item in bevel["affect"].enum_items] == ["VERTICES", "EDGES"]
    assert "(bmesh, /, *, geom=[]" in operators["bevel"].signature
    assert "delimit=set()" in operators["dissolve_limit"].signature


def test_results_hold_the_elements_that_their_type_names(
    operators: dict[str, Symbol], tmp_path: Path
) -> None:
    calls = [
        ("create_grid", ["x_segments", "y_segments"]), ("extrude_face_region", ["geom"]), ("duplicate", ["geom"]),
        ("extrude_discrete_faces", ["faces"]), ("subdivide_edges", ["edges", "cuts"]), ("split", ["geom"]),
        ("triangulate", ["faces"]), ("poke", ["faces"]), ("inset_individual", ["faces"]),
        ("dissolve_limit", ["verts", "edges", "angle_limit"]), ("region_extend", ["geom"]),
    ]  # fmt: skip
    types = {f"{name}.{result.name}": result.type for name in operators for result in operators[name].returns}
    found = ask_blender(CALL, tmp_path, calls)
    assert len(found) > 20
    for slot, (container, kinds) in found.items():
        assert types[slot].startswith(container), slot
        assert all(kind in types[slot] for kind in kinds), slot
