"""W1 and W2: what hangs together."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from scenes import a_motion, a_plan, build, the_finding, verified

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

STACK = """
thing("Floor", box("Slab", (-2, -2, -0.1), (2, 2, 0)), system_name="ground")
thing("Table", box("Top", (-0.5, -0.5, 0), (0.5, 0.5, 0.7)))
thing("Cup", box("Mug", (-0.1, -0.1, 0.7), (0.1, 0.1, 0.8)))
def touches(one, *names):
    bpy.data.objects[one]["contact_with"] = list(names)
"""


@pytest.mark.parametrize(
    "said",
    [
        'touches("Mug", "Top")\ntouches("Top", "Slab")',
        'touches("Top", "Cup root", "Floor")',
        'touches("Mug", "Slab")\ntouches("Table root", "Cup root")',
    ],
)
def test_what_is_connected_to_the_ground_over_any_steps_is_grounded(session: LiveSession, said: str) -> None:
    build(session, STACK + said)
    assert verified(session, "W1").passed == ("W1",)


def test_relations_of_contact_connect(session: LiveSession) -> None:
    build(session, STACK + 'touches("Top", "Slab")')
    plan = a_plan({"kind": "SupportedBy", "child": "Cup", "parents": ("Table/Top",)})
    assert verified(session, "W1", plan).passed == ("W1",)


def test_what_nothing_connects_to_the_ground_is_told(session: LiveSession) -> None:
    build(session, STACK + 'touches("Mug", "Top")')
    report = verified(session, "W1")
    assert [(one.rule, one.severity, one.objects) for one in report.findings] == [
        ("W1", "soft", ("Table",)),
        ("W1", "soft", ("Cup", "Table")),
    ]
    table, cup = report.findings
    assert table.message == "'Table' is not connected to the ground by declared contacts."
    assert cup.message.startswith(
        "'Cup' is connected to 'Table' by declared contacts, but 'Table' to nothing "
    )
    assert cup.fix.startswith("Declare what 'Table' touches ")
    assert report.ok


def test_the_last_of_a_chain_is_what_lacks_a_contact(session: LiveSession) -> None:
    build(
        session,
        STACK + 'thing("Lid", box("Cover", (-0.1, -0.1, 0.8), (0.1, 0.1, 0.82)))\n'
        'touches("Cover", "Mug")\ntouches("Mug", "Top")\ntouches("Top", "Mug")',
    )
    lid = next(one for one in verified(session, "W1").findings if one.objects[0] == "Lid")
    assert lid.objects == ("Lid", "Table")


@pytest.mark.parametrize(("lift", "findings"), [(0.0, 0), (0.002, 0), (0.2, 1), (-0.05, 0)])
@pytest.mark.parametrize("ground", ["ground", "floor"])
def test_what_has_no_tags_connects_where_it_stands_on_the_ground(
    session: LiveSession, lift: float, findings: int, ground: str
) -> None:
    build(
        session,
        f"""
floor = box("Old floor", (-2, -2, -0.1), (2, 2, 0))
table = box("Old table", (-0.5, -0.5, {lift}), (0.5, 0.5, 0.7))
thing("Cup", box("Mug", (-0.1, -0.1, 0.7), (0.1, 0.1, 0.8)))
bpy.data.objects["Mug"]["contact_with"] = ["Old table"]
scene.collection.objects.link(table)
if {ground!r} == "ground": thing("Floor", floor, system_name="ground")
else: scene.collection.objects.link(floor)
""",
    )
    assert len(verified(session, "W1").findings) == findings


@pytest.mark.parametrize("by_plan", [False, True])
def test_strict_grounding_makes_it_hard(session: LiveSession, by_plan: bool) -> None:
    build(
        session, STACK + 'touches("Top", "Slab")\n' + ("" if by_plan else 'scene["strict_grounding"] = True')
    )
    plan = a_plan({"kind": "Upright", "a": "Cup"}, strict_grounding=by_plan)
    report = verified(session, "W1", plan)
    assert the_finding(report).severity == "hard"
    assert not report.ok


def test_a_ground_that_is_no_object_grounds_nothing(session: LiveSession) -> None:
    build(session, STACK + 'touches("Mug", "Top")\ntouches("Top", "Slab")\nsystem("ground").name = "floor"')
    assert len(verified(session, "W1").findings) == 3


# One piece. ε of the bolt and the plate is 2 mm, that of two plates of 1.4 m is 7 mm.

PLATES = """
plate, other = box("Plate", (-0.5, -0.5, 0), (0.5, 0.5, 0.02)), box("Other plate", (-0.5, -0.5, -0.02), (0.5, 0.5, 0))
other.location.z -= {plate}
thing("Rig", plate, box("Bolt", (-0.01, -0.01, 0.02), (0.01, 0.01, 0.05), at=(0, 0, {bolt})), other)
"""


@pytest.mark.parametrize(
    ("bolt", "plate", "loose"),
    [
        (0.0019, 0.0070, ()),
        (0.0021, 0.0070, ("Bolt",)),
        (0.0019, 0.0072, ("Other plate",)),
        (0.5, 0.5, ("Bolt", "Other plate")),
        (-0.01, -0.01, ()),
    ],
)
def test_meshes_of_an_object_hang_together_within_the_tolerance(
    session: LiveSession, bolt: float, plate: float, loose: tuple[str, ...]
) -> None:
    build(session, PLATES.format(bolt=bolt, plate=plate))
    report = verified(session, "W2")
    if not loose:
        assert report.passed == ("W2",)
        return
    found = the_finding(report)
    assert (found.rule, found.severity, found.outcome) == ("W2", "soft", "broken")
    assert found.objects[0] == "Rig"
    assert found.measured == len(loose) + 1
    assert found.tolerance == 1
    if len(loose) == 1:
        assert found.objects[1:] == loose


def test_an_object_may_be_loose_if_it_says_so(session: LiveSession) -> None:
    build(
        session, PLATES.format(bolt=1, plate=1) + 'bpy.data.collections["Rig"]["allows_disconnected"] = True'
    )
    assert set(verified(session, "W2").not_applicable) == {"W2"}


def test_a_part_within_another_one_hangs_together_with_it(session: LiveSession) -> None:
    build(
        session,
        'thing("Pendant", box("Amber", (-1, -1, -1), (1, 1, 1)), box("Fly", (-0.1, -0.1, -0.1), (0.1, 0.1, 0.1)))',
    )
    assert verified(session, "W2").passed == ("W2",)


def test_two_halves_of_a_broken_thing_are_two_pieces(session: LiveSession) -> None:
    links = ", ".join(
        f'box("Link {k}", ({k}, 0, 0), ({k} + {1 if k != 4 else 0.9}, 1, 1))' for k in range(10)
    )
    build(session, f'thing("Chain", {links})')
    found = the_finding(verified(session, "W2"))
    assert found.measured == 2
    assert len(found.objects) == 6


def test_the_smaller_of_two_pieces_is_the_loose_one(session: LiveSession) -> None:
    build(
        session,
        'thing("Cup", box("Mug", (0, 0, 0), (0.1, 0.1, 0.1)), box("Handle", (0.12, 0.04, 0.02), (0.15, 0.06, 0.08)))',
    )
    assert the_finding(verified(session, "W2")).objects == ("Cup", "Handle")


def test_what_cannot_be_measured_is_told(session: LiveSession) -> None:
    build(session, PLATES.format(bolt=0, plate=0) + 'bpy.data.objects["Bolt"].hide_viewport = True')
    found = the_finding(verified(session, "W2"))
    assert (found.objects, found.outcome) == (("Rig",), "undecided")


def test_what_the_plan_lets_move_may_begin_in_the_air(session: LiveSession) -> None:
    build(
        session,
        """
thing("Floor", box("Slab", (-2, -2, -0.1), (2, 2, 0)), system_name="ground")
thing("Ball", ball("Sphere", 0.1, at=(0, 0, 1)))
""",
    )
    assert [one.objects for one in verified(session, "W1").findings] == [("Ball",)]
    falls = {"actor": "Ball", "kind": "fall", "start": 1, "end": 10}
    assert verified(session, "W1", a_motion(falls, roles={"Ball": "rigid"})).findings == ()
    strict = a_motion(falls, roles={"Ball": "rigid"}, strict_grounding=True)
    assert [one.severity for one in verified(session, "W1", strict).findings] == ["hard"]
