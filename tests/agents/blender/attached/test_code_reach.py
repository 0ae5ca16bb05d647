"""What of a scene code reaches, as far as its text tells."""

from __future__ import annotations

import pytest

from agents.blender.inside.attached.code.code_reach import Reach


@pytest.mark.parametrize(
    "code",
    [
        "bpy.data.objects['Cube'].location.x = 2",
        "made = bpy.data.objects.new('a', None)\nbpy.context.scene.collection.objects.link(made)",
        "bpy.data.objects.remove(bpy.data.objects['a'])",
        "if 'Cube' not in bpy.data.objects: pass",
        "found = bpy.data.materials.get('Wood') or bpy.data.materials.new('Wood')",
        "bpy.context.view_layer.objects.active = bpy.data.objects['Cube']",
    ],
)
def test_what_is_named_is_a_part(code: str) -> None:
    assert not Reach(code).everything


@pytest.mark.parametrize(
    "code",
    [
        "for one in bpy.data.objects: pass",
        "[one.name for one in bpy.context.scene.objects if one.type == 'MESH']",
        "bpy.data.objects[name]",
        "bpy.data.objects.get(f'Many {1}')",
        "len(bpy.data.meshes)",
        "bpy.data.objects[0]",
        "list(bpy.data.collections['A'].all_objects)",
        "bpy.ops.object.select_by_type(type='MESH')",
        "objects = bpy.data.objects",
    ],
)
def test_what_may_be_any_object_is_everything(code: str) -> None:
    assert "line 1 " in Reach(code).everything


def test_names_and_selection() -> None:
    reach = Reach("bpy.context.object.parent = bpy.data.objects['Table']")
    assert reach.names == {"Table"}
    assert reach.selection
    assert not Reach("bpy.data.objects['Table']").selection
