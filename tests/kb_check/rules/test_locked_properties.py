"""What Blender does not let be assigned, though RNA calls it writable, is reported; what a switch frees is not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_MESH = "import bpy\nmesh = bpy.data.meshes.new('a')\n"
_LAYER = "import bpy\nlayer = bpy.data.grease_pencils.new('a').layers.new('a')\n"
_SCRIPTS = {
    f"{_MESH}mesh.texspace_size = (1, 1, 1)": "warning",
    f"{_LAYER}layer.channel_color = (1, 0, 0)": "error",
    f"{_MESH}mesh.use_auto_texspace = False\nmesh.texspace_size = (1, 1, 1)": "",
    f"{_MESH}mesh.auto_texspace = False\nmesh.texspace_size = (1, 1, 1)": "",  # another name of it
    f"{_MESH}mesh.use_auto_texspace = True": "",
    f"{_MESH}mesh.use_auto_texspace = True\nmesh.texspace_location = (0, 0, 0)": "error",
    f"{_MESH}mesh.use_auto_texspace = True\nmesh.use_auto_texspace = False\nmesh.texspace_size = (1, 1, 1)": "",
    f"{_LAYER}layer.tint_color = (1, 0, 0)": "",
}


@pytest.mark.blender
@pytest.mark.parametrize("script", _SCRIPTS)
def test_what_is_locked_is_found_as_blender_refuses_it(script: str, check: Check, tmp_path: Path) -> None:
    *_, (failed, *_) = run_statements(tmp_path, script.splitlines())
    assert bool(failed) is bool(_SCRIPTS[script])
    found = check("read-only", script)
    assert [finding.severity for finding in found] == [_SCRIPTS[script]] * bool(_SCRIPTS[script])
    assert all(finding.span.line == len(script.splitlines()) for finding in found)


_PARTS: str = """\
import bpy
mesh = bpy.data.meshes.new("a")
mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
mesh.calc_loop_triangles()
ob = bpy.data.objects.new("a", mesh)
mesh.loops[0].normal[:] = (0, 0, 1)
mesh.loops[0].normal[0] = 1
mesh.loops[0].normal.x = 1
mesh.loops[0].normal.xy = (1, 2)
mesh.loops[0].normal.z += 1
mesh.polygons[0].center[0] = 2
mesh.loop_triangles[0].normal.x = 1
mesh.vertex_normals[0].vector.x = 1
normal = mesh.vertices[0].normal; normal[0] = 1
normal_copy = mesh.vertices[0].normal.copy(); normal_copy[0] = 1
mesh.vertices[0].co.x = 1
mesh.vertices[0].co[:] = (1, 1, 1)
mesh.polygons[0].vertices[0] = 1
ob.location.x = 1
ob.matrix_world[0][3] = 1
ob.matrix_world.translation.x = 3
ob.color[0] = 1
"""


@pytest.mark.blender
def test_parts_of_what_is_read_only_are(check: Check, tmp_path: Path) -> None:
    lines = _PARTS.splitlines()
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    assert [finding.span.line for finding in check("read-only", _PARTS)] == refused
    assert len(refused) == 9
    tried = (
        _PARTS.partition("mesh.loops")[0]
        + "try:\n    mesh.loops[0].normal.x = 1\nexcept AttributeError: pass"
    )
    assert not run_statements(tmp_path, [tried])[0][0]
    assert check("read-only", tried) == []


_OPERATOR = """\
import bpy
class Own(bpy.types.Operator):
    bl_idname, bl_label = "own.own", "Own"
    def execute(self, context):
        self.cancel = True
        self.get = 1
        return {"FINISHED"} if self.cancel else {"CANCELLED"}
"""


@pytest.mark.blender
def test_own_classes_may_have_values_in_the_place_of_functions(check: Check, tmp_path: Path) -> None:
    runs = [_OPERATOR, "bpy.utils.register_class(Own)\nassert bpy.ops.own.own() == {'FINISHED'}"]
    refused = "bpy.context.object.select_set = True"
    assert [bool(error) for error, *_ in run_statements(tmp_path, [*runs, refused])] == [False, False, True]
    assert check("read-only", _OPERATOR) == []
    assert check("read-only", f"import bpy\n{refused}")


@pytest.mark.blender
def test_what_one_kind_of_data_lost_is_told_where_another_has_it_locked(check: Check, tmp_path: Path) -> None:
    lines = [
        "import bpy",
        "ob = bpy.data.objects.new('a', bpy.data.armatures.new('a'))",
        "ob.data.layers = [True] * 32",
    ]
    assert [bool(error) for error, *_ in run_statements(tmp_path, lines)] == [False, False, True]
    (found,) = check("read-only", "import bpy\nbpy.context.object.data.layers = [True] * 32")
    assert found.symbol == "bpy.types.Armature.layers"
    assert found.instead == ("bpy.types.Armature.collections",)
    (found,) = check("read-only", "import bpy\narm = bpy.context.object.data\narm.layers = [True] * 32")
    assert found.symbol == "bpy.types.Armature.layers"
    (found,) = check("read-only", "import bpy\nbpy.context.object.data.edges = []")
    assert found.symbol == "bpy.types.Mesh.edges"
