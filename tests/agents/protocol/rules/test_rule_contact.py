"""V1: what is declared to touch does."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from scenes import a_plan, build, the_finding, verified

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

FLOOR = 'thing("Floor", box("Slab", (-5, -5, -0.1), (5, 5, 0)), system_name="ground")\n'
CRATE = """
size, height = {size}, {height}
planks = box("Planks", (-size / 2, -size / 2, 0), (size / 2, size / 2, size), at=(0, 0, height))
root = thing("Crate", planks, at=(0, 0, height))
"""
SAID = 'planks["contact_with"] = ["Slab"]\n'


def crate(height: float, size: float = 0.2) -> str:
    return FLOOR + CRATE.format(size=size, height=height)


# ε is 2 mm, or 0.5 % of the smaller one's diagonal (a cube's: √3 of its side), at most 1 cm.
@pytest.mark.parametrize(
    ("size", "epsilon"), [(0.05, 0.002), (0.2, 0.002), (1.0, 0.005 * 3**0.5), (3.0, 0.01)]
)
def test_a_gap_counts_as_contact_up_to_the_tolerance(
    session: LiveSession, size: float, epsilon: float
) -> None:
    build(session, crate(0.99 * epsilon, size) + SAID)
    assert verified(session, "V1").passed == ("V1",)
    session.empty()
    build(session, crate(1.01 * epsilon, size) + SAID)
    found = the_finding(verified(session, "V1"))
    assert (found.rule, found.severity, found.outcome) == ("V1", "hard", "broken")
    assert found.objects == ("Planks", "Slab")
    assert found.measured == pytest.approx(1.01 * epsilon, abs=1e-6)
    assert found.tolerance == pytest.approx(epsilon, abs=1e-6)
    assert found.unit == "m"
    assert found.at is not None
    assert -1e-6 <= found.at[2] <= 1.01 * epsilon + 1e-6


def test_the_gap_of_a_leg_is_told_in_millimetres(session: LiveSession) -> None:
    build(session, crate(0.005) + SAID)
    assert "but are 5.0 mm apart" in the_finding(verified(session, "V1")).message


def test_a_plan_may_ask_for_less(session: LiveSession) -> None:
    build(session, crate(0.0015) + SAID)
    assert verified(session, "V1").passed == ("V1",)
    strict = a_plan({"kind": "Upright", "a": "Crate"}, tolerances={"contact": 0.001, "contact_share": 0.001})
    assert the_finding(verified(session, "V1", strict)).tolerance == pytest.approx(0.001)


@pytest.mark.parametrize(
    "said",
    [
        'planks["contact_with"] = "Slab"',
        'planks["contact_with"] = "Slab, "',
        'planks["contact_with"] = ["Floor root"]',
        'planks["contact_with"] = ["Floor"]',
        'planks["contact_with"] = bpy.data.objects["Slab"]',
        'root["contact_with"] = ["Slab"]',
        'bpy.data.objects["Slab"]["contact_with"] = ["Crate"]',
        'bpy.data.objects["Floor root"]["contact_with"] = ["Planks"]',
    ],
)
def test_either_side_may_say_it_in_any_of_the_names(session: LiveSession, said: str) -> None:
    build(session, crate(0.001) + said)
    assert verified(session, "V1").passed == ("V1",)
    session.run("bpy.data.objects['Crate root'].location.z += 0.05\nbpy.context.view_layer.update()")
    assert the_finding(verified(session, "V1")).measured == pytest.approx(0.051, abs=1e-6)


@pytest.mark.parametrize(
    "relation",
    [
        {"kind": "SupportedBy", "child": "Crate", "parents": ("Floor",)},
        {"kind": "StableAgainst", "child": "Crate", "parent": "Floor"},
        {"kind": "FixedAttachment", "part": "Crate/Planks", "host": "Floor/Slab"},
        {"kind": "Aperture", "filler": "Crate", "host": "Floor"},
    ],
)
def test_relations_of_contact_are_declarations(session: LiveSession, relation: dict[str, object]) -> None:
    build(session, crate(0.003))
    report = verified(session, "V1", a_plan(relation))
    found = the_finding(report)
    assert found.measured == pytest.approx(0.003, abs=1e-6)
    assert str(relation["kind"]) in found.message


def test_a_contact_that_is_told_twice_is_found_once(session: LiveSession) -> None:
    more = 'bpy.data.objects["Floor root"]["contact_with"] = ["Crate"]'
    build(session, crate(0.003) + SAID + more)
    plan = a_plan({"kind": "SupportedBy", "child": "Crate", "parents": ("Floor",)})
    the_finding(verified(session, "V1", plan))


@pytest.mark.parametrize(
    ("said", "objects"),
    [
        ('planks["contact_with"] = ["Carpet"]', ("Planks", "Carpet")),
        ('planks["contact_with"] = ["Bulb"]', ("Planks", "Bulb")),
        ('planks["contact_with"] = ["Planks"]', ("Planks", "Planks")),
        ('root["contact_with"] = ["Crate"]', ("Crate root", "Crate")),
        ('bpy.data.objects["Bulb"]["contact_with"] = ["Slab"]', ("Bulb", "Slab")),
    ],
)
def test_contacts_with_nobody_are_told(session: LiveSession, said: str, objects: tuple[str, ...]) -> None:
    bulb = (
        'scene.collection.objects.link(bpy.data.objects.new("Bulb", bpy.data.lights.new("Bulb", "POINT")))\n'
    )
    build(session, crate(0) + bulb + said)
    found = the_finding(verified(session, "V1"))
    assert (found.objects, found.outcome, found.measured) == (objects, "broken", None)


def test_parts_of_one_object_that_say_so_must_touch_as_well(session: LiveSession) -> None:
    lid = 'lid = box("Lid", (-0.1, -0.1, 0.2), (0.1, 0.1, 0.22), at=(0, 0, {}))\n'
    lid += 'lid.parent = root\nbpy.data.collections["Crate"].objects.link(lid)\n'
    build(session, crate(0) + lid.format(0.001) + 'lid["contact_with"] = ["Planks"]')
    assert verified(session, "V1").passed == ("V1",)
    session.empty()
    # The root stands for the whole crate: the lid does not touch what is left of it.
    build(session, crate(0) + lid.format(0.004) + 'lid["contact_with"] = ["Crate root"]')
    found = the_finding(verified(session, "V1"))
    assert found.measured == pytest.approx(0.004, abs=1e-6)


EVALUATED = {
    "a modifier": 'planks.modifiers.new("Shift", "SHRINKWRAP").target = bpy.data.objects["Slab"]',
    "a mirrored parent": "root.scale.z = -1\nroot.location.z = 0.2",
    "a scaled parent": "root.scale = (0.5, 0.5, 0.5)\nroot.location.z = 0",
    "shape keys": "planks.shape_key_add(name='Basis')\nlower = planks.shape_key_add(name='Lower')\n"
    "for point in lower.data:\n    point.co.z -= 0.5\nlower.value = 1",
}


@pytest.mark.parametrize("change", EVALUATED.values(), ids=EVALUATED)
def test_surfaces_are_those_that_are_seen(session: LiveSession, change: str) -> None:
    build(session, crate(0.5) + SAID)
    assert the_finding(verified(session, "V1")).measured == pytest.approx(0.5, abs=1e-6)
    session.run(
        "planks, root = bpy.data.objects['Planks'], bpy.data.objects['Crate root']\n"
        f"{change}\nbpy.context.view_layer.update()"
    )
    assert verified(session, "V1").passed == ("V1",)


LIFTED = """
key(root, 1, location=(0, 0, {}))
key(root, 20, location=(0, 0, {}))
scene.frame_start, scene.frame_end = 1, 20
"""


@pytest.mark.parametrize(("first", "last"), [(0.0, 0.4), (0.4, 0.0)])
def test_what_moves_touches_at_one_end_of_the_timeline(
    session: LiveSession, first: float, last: float
) -> None:
    build(session, crate(0) + LIFTED.format(first, last) + SAID)
    assert verified(session, "V1").passed == ("V1",)


def test_what_moves_and_never_touches_is_found_where_it_is_nearest(session: LiveSession) -> None:
    build(session, crate(0) + LIFTED.format(0.4, 0.1) + SAID)
    found = the_finding(verified(session, "V1"))
    assert found.frame == 20
    assert found.measured == pytest.approx(0.1, abs=1e-6)
    assert session.run("bpy.context.scene.frame_current") == 1


def test_what_is_not_evaluated_cannot_be_measured_and_hides_no_other_finding(session: LiveSession) -> None:
    build(session, crate(0.05) + SAID + 'thing("Rug", box("Wool", (1, 1, 0), (2, 2, 0.01)))\n'
          'wool = bpy.data.objects["Wool"]\nwool.hide_viewport, wool["contact_with"] = True, "Slab"')  # fmt: skip
    report = verified(session, "V1")
    assert {(one.objects, one.outcome) for one in report.findings} == {
        (("Planks", "Slab"), "broken"),
        (("Wool", "Slab"), "undecided"),
    }
    assert not report.ok
    assert "hidden from the viewport" in next(
        one.message for one in report.findings if one.outcome == "undecided"
    )


def test_without_declarations_there_is_nothing_to_judge(session: LiveSession) -> None:
    build(session, crate(0.5))
    assert set(verified(session, "V1").not_applicable) == {"V1"}


@pytest.mark.parametrize("mesh", ["Lid", "Lid.001", "Crate_Lid", "crate lid"])
def test_a_part_is_found_by_the_names_that_people_give_it(session: LiveSession, mesh: str) -> None:
    lid = f'thing("Crate", box("Planks", (0, 0, 0), (1, 1, 1)), box("{mesh}", (0, 0, 1.01), (1, 1, 1.03)))'
    build(session, f"{FLOOR}{lid}\nbpy.data.objects['Planks']['contact_with'] = ['Crate/Lid']")
    assert "10.0 mm apart" in the_finding(verified(session, "V1")).message


def test_a_part_that_is_nowhere_is_told_with_the_meshes_there_are(session: LiveSession) -> None:
    build(session, crate(0) + 'planks["contact_with"] = ["Crate/Lid"]')
    fix = the_finding(verified(session, "V1")).fix
    assert fix == "Call a mesh of 'Crate' 'Lid' or 'Crate_Lid'; its meshes are 'Planks'."
