"""Objects that are linked to a collection which has them are found where Blender refuses it, and nowhere else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_CODE = """\
import bpy
scene = bpy.context.scene
own = bpy.data.collections.new("own")
scene.collection.children.link(own)
bpy.ops.mesh.primitive_cube_add()
cube = bpy.context.object
cube.name = "Cube"
bpy.context.collection.objects.link(cube)
own.objects.link(cube)
own.objects.link(cube)
scene.collection.objects.link(cube)
held = bpy.context.collection
held.objects.link(cube)
bpy.ops.object.light_add(type='SUN')
light = bpy.context.active_object
held.objects.unlink(light)
bpy.context.collection.objects.link(light)
bpy.context.view_layer.active_layer_collection.collection.objects.link(light)
ball = bpy.data.objects.new("ball", None)
bpy.context.collection.objects.link(ball)
bpy.context.scene.collection.objects.link(ball)
bpy.context.collection.objects.link(ball)
ball = bpy.data.objects.new("ball", None)
bpy.context.collection.objects.link(ball)
"""


def test_what_a_collection_has_is_told(check: Check, tmp_path: Path) -> None:
    lines: list[str] = [*_CODE.splitlines()]
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    assert [one.span.line for one in check("linked-twice", _CODE)] == refused == [8, 10, 13, 18, 22]


@pytest.mark.parametrize(
    "between",
    [
        "bpy.data.collections['A'].objects.unlink(cube)",
        "for other in cube.users_collection: other.objects.unlink(cube)",
        "bpy.context.view_layer.active_layer_collection = layer",
        "bpy.context.window.scene = other",
        "bpy.ops.object.move_to_collection(collection_index=1)",
        "cube = bpy.data.objects.new('other', None)",
        "tidy(cube)",
        "bpy.data.objects.remove(cube)",
    ],
)
def test_what_may_unlink_it_leaves_the_rest_alone(check: Check, between: str) -> None:
    made = "import bpy\nbpy.ops.mesh.primitive_cube_add()\ncube = bpy.context.object\n"
    link = "bpy.context.collection.objects.link(cube)\n"
    assert len(check("linked-twice", made + link)) == 1
    assert not check("linked-twice", f"{made}{between}\n{link}")
    assert not check("linked-twice", f"{made}try:\n    {link}except RuntimeError:\n    pass\n")
