"""G1 to G3: Empties and chains of parents."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from scenes import build, the_finding, verified

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

SCENE = """
thing("Chair", box("Seat", (-0.2, -0.2, 0.4), (0.2, 0.2, 0.45)), box("Leg", (-0.2, -0.2, 0), (-0.16, -0.16, 0.4)))
thing("Cup", box("Mug", (0.5, 0.5, 0), (0.6, 0.6, 0.1)))
chair = bpy.data.collections["Chair"]
root, seat, leg = (bpy.data.objects[name] for name in ("Chair root", "Seat", "Leg"))
"""


@pytest.mark.parametrize(
    "more",
    [
        "",
        "leg.parent = seat",
        # Through something that is no mesh, and through a bone.
        'pivot = bpy.data.objects.new("Pivot", None)\nchair.objects.link(pivot)\n'
        "pivot.parent, leg.parent = root, pivot",
        'rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))\nchair.objects.link(rig)\nrig.parent = root\n'
        'bpy.context.view_layer.objects.active = rig\nbpy.ops.object.mode_set(mode="EDIT")\n'
        'bone = rig.data.edit_bones.new("Bone")\nbone.tail = (0, 0, 1)\nbpy.ops.object.mode_set(mode="OBJECT")\n'
        'leg.parent, leg.parent_type, leg.parent_bone = rig, "BONE", "Bone"',
    ],
)
def test_meshes_whose_parents_lead_to_their_root_are_in_order(session: LiveSession, more: str) -> None:
    build(session, SCENE + more)
    report = verified(session, "G")
    assert report.findings == ()
    assert report.passed == ("G1", "G2", "G3")


@pytest.mark.parametrize(
    ("change", "rule", "objects"),
    [
        ("leg.parent = None", "G1", ("Leg", "Chair")),
        ('leg.parent = bpy.data.objects["Cup root"]', "G1", ("Leg", "Chair")),
        (
            'stray = bpy.data.objects.new("Stray", None)\nscene.collection.objects.link(stray)\nleg.parent = stray',
            "G1", ("Leg", "Chair"),
        ),
        (
            'other = bpy.data.scenes.new("Other")\nfar = bpy.data.objects.new("Far", None)\n'
            "other.collection.objects.link(far)\nleg.parent = far",
            "G1", ("Leg", "Chair"),
        ),
        ('root.parent = bpy.data.objects["Cup root"]', "G2", ("Chair root", "Cup root")),
        (
            "chair.objects.unlink(root)\nscene.collection.objects.link(root)",
            "G3", ("Chair root", "Chair"),
        ),
        (
            'chair.objects.unlink(root)\nbpy.data.collections["Cup"].objects.link(root)',
            "G3", ("Chair root", "Chair"),
        ),
        (
            'lost = bpy.data.objects.new("Lost root", None)\nlost["is_object_root"] = True\n'
            "scene.collection.objects.link(lost)",
            "G3", ("Lost root",),
        ),
        ('bpy.data.collections["Cup"].objects.link(root)', "G3", ("Chair root", "Chair", "Cup")),
    ],
)  # fmt: skip
def test_what_is_not_anchored_is_found_by_its_rule(
    session: LiveSession, change: str, rule: str, objects: tuple[str, ...]
) -> None:
    build(session, SCENE + change)
    found = the_finding(verified(session, rule))
    assert (found.rule, found.severity, found.outcome) == (rule, "hard", "broken")
    assert found.objects == objects


def test_every_mesh_of_an_object_without_a_root_is_told(session: LiveSession) -> None:
    build(session, SCENE + "bpy.data.objects.remove(root)")
    report = verified(session, "G")
    assert {one.objects for one in report.findings} == {("Seat", "Chair"), ("Leg", "Chair")}
    assert report.passed == ("G2", "G3")


def test_without_objects_there_is_nothing_to_judge(session: LiveSession) -> None:
    assert set(verified(session, "G").not_applicable) == {"G1", "G2", "G3"}
