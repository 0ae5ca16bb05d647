"""What small parts of larger things begin with is what they have where a script makes them."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

_MADE = """
import bpy, json
mesh = bpy.data.meshes.new("x")
mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
cube = bpy.data.objects["Cube"]
cube.modifiers.new("x", "SKIN")
target = cube.constraints.new("ARMATURE").targets.new()
print(json.dumps({
    "MeshVertex.select": mesh.vertices[0].select,
    "MeshEdge.select": mesh.edges[0].select,
    "MeshPolygon.select": mesh.polygons[0].select,
    "MeshSkinVertex.radius": [*cube.data.skin_vertices[0].data[0].radius],
    "ConstraintTargetBone.weight": target.weight,
}))
"""


@pytest.mark.blender
def test_what_small_parts_begin_with_is_told(kb: KnowledgeBase) -> None:
    done = subprocess.run([sys.executable, "-c", _MADE], capture_output=True, text=True, check=True)
    made: dict[str, object] = json.loads(done.stdout.splitlines()[-1])
    for name, value in made.items():
        symbol = kb.reader.symbol(f"bpy.types.{name}")
        assert symbol is not None
        told = symbol.new_values[0].value if symbol.new_values else symbol.default
        assert told == value, name
        assert "(RNA's" not in kb.query(symbol.path).text
