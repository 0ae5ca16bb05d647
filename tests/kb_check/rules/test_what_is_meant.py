"""What findings say is meant: what the thing itself has, before what only sounds alike."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from conftest import Check


@pytest.mark.parametrize(
    ("rule", "line", "said", "unsaid"),
    [
        ("unknown-attribute", "for e in bm.edges: e.length", "Closest: `calc_length`", "layer"),
        ("unknown-attribute", "for e in bm.edges: e.crease = 1", 'layers.float.get("crease_edge")', "Closest"),
        ("unknown-attribute", "for v in bm.verts: v.bevel_weight = 1", "bevel_weight_vert", "Closest"),
        ("unknown-attribute", "ob.setdefault('count', 1)", 'if "name" not in obj', "`location`"),
        ("unknown-attribute", "Vector().distance(ob.location)", "(a - b).length", "Closest"),
        ("unknown-attribute", "bpy.data.actions[0].slots[0].fcurves", "channelbag(ad.action_slot).fcurves", "Closest"),
        ("unknown-value", "ob.modifiers.new('Lines', 'GREASE_PENCIL_LINEART')", "Closest: `LINEART`.", "TINT"),
        ("unknown-keyword", "ob.data.update(calc_tessface=True)", "`bpy.types.Mesh.update(calc_tessface=…)`", "Image"),
        ("wrong-type", "bpy.data.meshes.new_from_object(bpy.context.scene)", "not an instance of", "objects.new"),
        ("wrong-type", "bpy.context.scene.camera = bpy.data.cameras.new('Camera')", "objects.new", "layer"),
        ("wrong-type", "bpy.context.scene.frame_end = ob.location.x / 2", "`round(…)`", "objects.new"),
    ],
)  # fmt: skip
def test_what_is_meant_is_said(check: Check, rule: str, line: str, said: str, unsaid: str) -> None:
    made = (
        "import bmesh\nimport bpy\nfrom mathutils import Vector\nbm = bmesh.new()\nob = bpy.context.object\n"
    )
    (found,) = check(rule, f"{made}{line}\n")
    assert said in found.message
    assert unsaid not in found.message


def test_a_value_of_another_setting_is_told_with_that_of_its_name(check: Check) -> None:
    code = """\
    import bpy

    view = bpy.context.scene.view_settings
    view.view_transform = "AgX"
    view.look = "Medium High Contrast"
    """
    (found,) = check("refused-value", code)
    assert found.message.endswith("Write 'AgX - Medium High Contrast'.")
