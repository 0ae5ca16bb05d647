"""Scenes that are broken, empty, endless or of another plan: a clear finding or error, never a traceback or a pass."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import pytest
from scenes import SOON, a_plan, build, verified

from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.protocol.findings import Finding, Report

pytestmark = pytest.mark.blender

ALL = "C,G,V,W,R,T"
FLOOR = 'thing("Floor", box("Slab", (-3, -3, -0.1), (3, 3, 0)), system_name="ground")\n'
CRATE = """
crate = box("Planks", (-0.1, -0.1, 0), (0.1, 0.1, 0.2))
root = thing("Crate", crate)
crate["contact_with"] = "Slab"
"""
SCENE = FLOOR + CRATE


def plan(**more: Any) -> Any:
    relations = (
        {"kind": "SupportedBy", "child": "Crate", "parents": ("Floor",)},
        {"kind": "OnTopOf", "a": "Crate", "b": "Floor"},
        {"kind": "Upright", "a": "Crate"},
    )
    sizes = {"Crate": (0.2, 0.2, 0.2), "Floor": (6, 6, 0.1)}
    objects = [
        {"name": name, "systems": ["set"], "dimensions": size, "position": (0, 0, 0)}
        for name, size in sizes.items()
    ]
    return a_plan(*relations, **({"objects": objects} | more))


def judged(session: LiveSession, script: str, rules: str = ALL) -> Report:
    build(session, script)
    report = verified(session, rules, plan())
    assert [one.message for one in report.findings if one.outcome == "error"] == []
    return report


def of(report: Report, rule: str) -> list[Finding]:
    return [one for one in report.findings if one.rule == rule]


def test_the_scene_that_is_not_broken_is_in_order(session: LiveSession) -> None:
    report = judged(session, SCENE)
    assert {one.rule for one in report.findings} == {"W4", "W5"}
    assert {"C3", "G1", "V1", "V2", "W1", "R1", "R2", "R3", "R4", "R5", "R10", "R13"} <= set(report.passed)


BROKEN = {
    "vertices that are not numbers": "crate.data.vertices[0].co.x = float('nan')",
    "one vertex that is infinite": "crate.data.vertices[0].co.x = float('inf')",
    "a place that is not a number": "crate.location.x = float('nan')",
    "a scale that is not a number": "crate.scale.x = float('nan')",
    "a parent that is nowhere": "root.location.z = float('nan')",
    "coordinates beyond measure": "crate.data.transform(Matrix.Scale(1e30, 4))",
    "hidden from the viewport": "crate.hide_viewport = True",
    "a collection that is hidden": 'bpy.data.collections["Crate"].hide_viewport = True',
}


@pytest.mark.parametrize("change", BROKEN.values(), ids=BROKEN)
def test_what_cannot_be_measured_passes_no_rule_that_is_about_it(session: LiveSession, change: str) -> None:
    report = judged(session, SCENE + change)
    assert not report.ok
    for rule in ("V1", "V2", "R2", "R4", "R5", "R10"):
        assert rule not in report.passed
        assert of(report, rule), rule
        assert all(one.outcome in {"undecided", "broken"} and one.fix for one in of(report, rule))
    assert all("Planks" in one.message or "Crate" in one.message for one in of(report, "V1"))
    assert "Traceback" not in " ".join(one.message for one in report.findings)


def test_an_empty_scene_passes_nothing_that_needs_something(session: LiveSession) -> None:
    report = verified(session, ALL)
    assert {one.rule for one in report.findings} == {"C6", "W4", "W5"}
    assert not report.ok
    assert set(report.passed) <= {"W3"}
    planned = verified(session, ALL, plan())
    assert {("R1", ("Crate",)), ("R1", ("Floor",))} <= {(one.rule, one.objects) for one in planned.findings}
    assert not {"R1", "R2", "R3", "R5", "R10", "R13"} & set(planned.passed)


def test_a_plan_for_another_scene_is_met_by_nothing(session: LiveSession) -> None:
    build(
        session,
        'thing("Sea", plane("Water", (-9, -9), (9, 9)), system_name="ground")\n'
        'hull = box("Hull", (0, 0, 0), (1, 1, 1))\nthing("Ship", hull)\nhull["contact_with"] = "Water"',
    )
    report = verified(session, ALL, plan())
    inventory = {one.objects for one in of(report, "R1")}
    assert inventory == {("Crate",), ("Floor",), ("Sea",), ("Ship",)}
    for rule in ("R2", "R3", "R5", "R10", "R13"):
        assert rule not in report.passed
        assert of(report, rule) == [], "what is missing is told once, by the inventory"
    assert [one for one in report.findings if one.outcome == "error"] == []


WITHOUT = {
    "nothing": "",
    "Empties": 'bpy.data.collections["Crate"].objects.link(bpy.data.objects.new("Handle", None))',
    "a mesh without vertices": 'thing("Ghost", bpy.data.objects.new("Air", bpy.data.meshes.new("Air")))\n'
    'bpy.data.objects["Air"]["contact_with"] = "Slab"',
    "a mesh of edges": 'line = mesh("Line", [(0, 0, 1), (0, 0, 2)], [])\nthing("Wire", line)\n'
    'line["contact_with"] = "Slab"',
    "a light": 'scene.collection.objects.link(bpy.data.objects.new("Bulb", bpy.data.lights.new("Bulb", "POINT")))\n'
    'bpy.data.objects["Bulb"]["contact_with"] = "Slab"',
}


@pytest.mark.parametrize("more", WITHOUT.values(), ids=WITHOUT)
def test_contacts_of_what_has_no_geometry_are_found(session: LiveSession, more: str) -> None:
    report = judged(session, SCENE + more, "V,W1,R4")
    if "contact_with" in more:
        assert {one.outcome for one in of(report, "V1")} == {"broken"}
        assert "nothing of that name has a surface" in of(report, "V1")[0].message
    else:
        assert report.findings == ()


FLAT = {
    "all its corners in one place": "for point in crate.data.vertices:\n    point.co = (0, 0, 0)",
    "all on a line": "for point in crate.data.vertices:\n    point.co = (point.co.x, 0, 0)",
    "scaled to nothing": "crate.scale = (0, 0, 0)",
    "one triangle": "crate.data.clear_geometry()\n"
    "crate.data.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])",
    "the same face a hundred times": "crate.data.clear_geometry()\n"
    "crate.data.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)] * 100)",
}


@pytest.mark.parametrize("change", FLAT.values(), ids=FLAT)
def test_what_has_collapsed_is_measured_as_what_it_is(session: LiveSession, change: str) -> None:
    report = judged(session, SCENE + change)
    assert "V1" in report.passed  # it lies on the slab
    assert of(report, "R2")


def test_collections_that_make_instances_of_each_other_are_refused(session: LiveSession) -> None:
    session.run(
        'a, b = (bpy.data.collections.new(name) for name in "AB")\n'
        "for holds, makes in ((a, b), (b, a)):\n"
        '    maker = bpy.data.objects.new(f"of {makes.name}", None)\n'
        '    maker.instance_type, maker.instance_collection = "COLLECTION", makes\n'
        "    holds.objects.link(maker)\nmaker = None"
    )
    with pytest.raises(Refusal, match=r"in a circle, ('A' → 'B' → 'A'|'B' → 'A' → 'B')"):
        verified(session, ALL)


def test_endless_instances_are_told_in_seconds(session: LiveSession) -> None:
    build(
        session,
        SCENE + 'levels = [bpy.data.collections.new(f"Level {k}") for k in range(6)]\n'
        'levels[0].objects.link(box("Brick", (0, 0, 0), (1, 1, 1)))\n'
        "for below, above in zip(levels, levels[1:]):\n    for k in range(12):\n"
        '        maker = bpy.data.objects.new(f"{above.name} {k}", None)\n'
        '        maker.instance_type, maker.instance_collection, maker.location.x = "COLLECTION", below, k\n'
        "        above.objects.link(maker)\n"
        'tower = bpy.data.objects.new("Tower", None)\nthing("Babel", tower)\n'
        'tower.instance_type, tower.instance_collection = "COLLECTION", levels[-1]\ntower["contact_with"] = "Slab"',
    )
    began = time.perf_counter()
    report = verified(session, "V,R4", plan())
    assert time.perf_counter() - began < SOON
    assert {(one.rule, one.objects, one.outcome) for one in report.findings} == {
        ("V1", ("Tower", "Slab"), "undecided"),
        ("V2", ("Tower",), "undecided"),
        ("R4", ("Tower",), "broken"),
    }
    assert "more than 50000 instances" in " ".join(one.message for one in report.findings)


def test_a_mesh_that_is_being_edited_is_measured_as_it_is(session: LiveSession) -> None:
    build(
        session, SCENE + 'bpy.context.view_layer.objects.active = crate\nbpy.ops.object.mode_set(mode="EDIT")'
    )
    report = verified(session, ALL, plan())
    assert {one.rule for one in report.findings} == {"W4", "W5"}


def test_a_long_simulation_that_is_not_baked_is_undecided_at_once(session: LiveSession) -> None:
    began = time.perf_counter()
    report = judged(session, SCENE + "rigid(crate)\nscene.frame_end = 100_000", "V1,V2,R3,T2")
    assert time.perf_counter() - began < SOON
    told = [one for one in report.findings if one.outcome == "undecided"]
    assert {one.rule for one in told} == {"V1", "V2", "R3"}
    assert all("bake first" in one.message for one in told)
    # Where no rule follows motion, the first frame is enough, and nothing is simulated.
    assert verified(session, "V1,V2,R3", plan()).ok


ODD_TAGS = {
    "numbers": 'crate["contact_with"] = 7',
    "a dictionary": 'crate["contact_with"] = {"Slab": 1}',
    "an empty list": 'crate["contact_with"] = []',
    "an empty text": 'crate["contact_with"] = ""',
    "floats": 'crate["contact_with"] = [0.5, 1.5]',
    "very many": 'crate["contact_with"] = [f"Nobody {k}" for k in range(2000)]',
    "bytes": 'crate["contact_with"] = b"\\xff\\xfe"',
    "roles that are none": 'bpy.data.collections["Crate"]["protocol_role"] = 5\n'
    'system("set")["protocol_role"] = [1, 2]',
    "roots that are texts": 'crate["is_object_root"] = "no"\nroot["is_object_root"] = {"a": 1}',
    "kinds that are none": 'bpy.data.collections["Crate"]["deformation_kind"] = 3.5\n'
    'bpy.data.collections["Crate"]["motion_kind"] = "levitation"',
    "names of all kinds": 'crate.name, root.name = "Ä\\"\\\\ \\U0001F4A5 " + "x" * 40, "Slab/Planks"\n'
    'bpy.data.collections["Crate"].name = "Slab"',
}


@pytest.mark.parametrize("change", ODD_TAGS.values(), ids=ODD_TAGS)
def test_tags_that_say_nonsense_are_findings_at_most(session: LiveSession, change: str) -> None:
    report = judged(session, SCENE + change)
    assert report.findings
    if "Nobody" in change:
        assert len(of(report, "V1")) == 2000


def test_a_thousand_rules_breaches_do_not_stop_a_report(session: LiveSession) -> None:
    build(
        session,
        'cube = box("Cube", (0, 0, 0), (1, 1, 1))\nfor k in range(225):\n'
        '    one = bpy.data.objects.new(f"C{k}", cube.data)\n    one.location = (k % 15 * 0.6, k // 15 * 0.6, 0)\n'
        "    scene.collection.objects.link(one)",
    )
    began = time.perf_counter()
    report = verified(session, "C3,V2")
    assert time.perf_counter() - began < SOON
    assert len(of(report, "C3")) == 225
    crossing = of(report, "V2")
    assert len(crossing) == 2 * 14 * 15 + 2 * 14 * 14
    assert all(one.measured == pytest.approx(0.4, abs=1e-3) for one in crossing)
