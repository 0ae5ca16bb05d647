"""C1 to C6: the layout of the collections."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from scenes import build, the_finding, verified

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

SCENE = """
thing("Floor", box("Slab", (-2, -2, -0.1), (2, 2, 0)), system_name="ground")
thing("Chair", box("Seat", (-0.2, -0.2, 0.4), (0.2, 0.2, 0.45)), box("Leg", (-0.2, -0.2, 0), (-0.16, -0.16, 0.4)))
thing("Cup", box("Mug", (0.5, 0.5, 0), (0.6, 0.6, 0.1)))
chair, root = bpy.data.collections["Chair"], bpy.data.objects["Chair root"]
"""
ALL = ("C1", "C2", "C3", "C4", "C5", "C6")


@pytest.mark.parametrize(
    "more",
    [
        "",
        # An L3 may be in several systems, and hold collections of its own that carry no tags.
        'system("kitchen").children.link(chair)',
        'parts = bpy.data.collections.new("Parts.001")\nchair.children.link(parts)\n'
        'parts.objects.link(bpy.data.objects["Leg"])\nchair.objects.unlink(bpy.data.objects["Leg"])',
        # A system holds an untagged collection of L3s; a system is linked at the root and elsewhere, too.
        'room = bpy.data.collections.new("Room")\nsystem("set").children.link(room)\nroom.children.link(chair)\n'
        'system("set").children.unlink(chair)',
        'aside = bpy.data.collections.new("Aside")\nscene.collection.children.link(aside)\n'
        'aside.children.link(system("set"))',
        # Names that only look like a number's.
        'chair.name = "Chair.12"',
        'chair.name = "V2.001 chair"',
    ],
)
def test_a_scene_in_order_has_nothing_to_find(session: LiveSession, more: str) -> None:
    build(session, SCENE + more)
    report = verified(session, "C")
    assert report.findings == ()
    assert report.passed == ALL


@pytest.mark.parametrize(
    ("change", "rule", "objects", "measured"),
    [
        (
            'system("set").children.unlink(chair)\nscene.collection.children.link(chair)',
            "C1", ("Chair",), None,
        ),
        (
            'scene.collection.children.unlink(system("set"))\nsystem("ground").children.link(system("set"))',
            "C2", ("set",), None,
        ),
        ('scene.collection.objects.link(box("Stray", (3, 3, 0), (4, 4, 1)))', "C3", ("Stray",), 0),
        ('bpy.data.collections["Cup"].objects.link(bpy.data.objects["Leg"])', "C3", ("Leg",), 2),
        (
            'text = bpy.data.objects.new("Words", bpy.data.curves.new("Words", "FONT"))\n'
            'system("set").objects.link(text)',
            "C3", ("Words",), 0,
        ),
        ('del root["is_object_root"]', "C4", ("Chair",), 0),
        (
            'other = bpy.data.objects.new("Handle", None)\nother["is_object_root"] = True\nchair.objects.link(other)',
            "C4", ("Chair", "Chair root", "Handle"), 2,
        ),
        ('bpy.data.objects["Leg"]["is_object_root"] = True', "C4", ("Chair", "Chair root", "Leg"), 1),
        ('chair.name = "Chair.001"', "C5", ("Chair.001",), None),
        ('system("set").name = "set.0012"', "C5", ("set.0012",), None),
        ('system("ground").name = "floor"', "C6", ("ground",), 0),
        ('del system("ground")["protocol_role"]', "C6", ("ground",), 0),
        (
            'system("ground").children.unlink(bpy.data.collections["Floor"])\n'
            'system("set").children.link(bpy.data.collections["Floor"])',
            "C6", ("ground",), 0,
        ),
    ],
)  # fmt: skip
def test_what_is_out_of_order_is_found_by_its_rule(
    session: LiveSession, change: str, rule: str, objects: tuple[str, ...], measured: float | None
) -> None:
    build(session, SCENE + change)
    found = the_finding(verified(session, rule))
    assert (found.rule, found.severity, found.outcome) == (rule, "hard", "broken")
    assert found.objects == objects
    assert found.measured == measured
    assert found.fix


def test_a_scene_without_any_tags_has_homeless_meshes_and_no_ground(session: LiveSession) -> None:
    build(session, 'for name in "ab":\n    scene.collection.objects.link(box(name, (0, 0, 0), (1, 1, 1)))')
    report = verified(session, "C")
    assert [(one.rule, one.objects) for one in report.findings] == [
        ("C3", ("a",)),
        ("C3", ("b",)),
        ("C6", ("ground",)),
    ]
    assert not report.ok
    assert set(report.not_applicable) == {"C1", "C2", "C4", "C5"}


def test_meshes_that_no_render_shows_are_in_an_object_as_well(session: LiveSession) -> None:
    build(
        session,
        SCENE
        + 'cutter = box("Cutter", (0, 0, 0), (1, 1, 1))\ncutter.hide_render = cutter.hide_viewport = True\n'
        "scene.collection.objects.link(cutter)",
    )
    assert the_finding(verified(session, "C3")).objects == ("Cutter",)


def test_other_scenes_have_their_own_order(session: LiveSession) -> None:
    build(
        session,
        SCENE
        + 'other = bpy.data.scenes.new("Other")\nother.collection.objects.link(box("Far", (0, 0, 0), (1, 1, 1)))\n'
        'strange = bpy.data.collections.new("Strange.001")\nstrange["protocol_role"] = "system"\n'
        "other.collection.children.link(strange)",
    )
    assert verified(session, "C").findings == ()
