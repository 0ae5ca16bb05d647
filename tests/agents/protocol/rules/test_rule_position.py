"""R10 to R13: where objects are to each other, and how they are turned."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import pytest
from scenes import a_plan, build, the_finding, verified

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.protocol.findings import Report

pytestmark = pytest.mark.blender

# Cubes of 0.2 m, whose ε is 2 mm; ``at`` is the middle of their underside.
CUBE = """
where = {{"at": {at}, "turn": {turn}}}
thing("{name}", box("{name} body", (-0.1, -0.1, 0), (0.1, 0.1, 0.2), **where), **where)
"""
TABLE = """
where = {{"at": {at}, "turn": {turn}}}
thing("Table", box("Top", (-0.5, -0.3, 0.7), (0.5, 0.3, 0.75), **where), **where)
"""


def cube(name: str, at: tuple[float, float, float], turn: tuple[float, float, float] = (0, 0, 0)) -> str:
    return CUBE.format(name=name, at=at, turn=turn)


def table(at: tuple[float, float, float] = (0, 0, 0), turn: float = 0) -> str:
    return TABLE.format(at=at, turn=(0, 0, turn))


def judged(session: LiveSession, rule: str, script: str, **relation: Any) -> Report:
    build(session, script)
    return verified(session, rule, a_plan(relation))


# R10: on top of


def on_top(session: LiveSession, script: str, a: str = "Cup", b: str = "Table") -> Report:
    return judged(session, "R10", script, kind="OnTopOf", a=a, b=b)


@pytest.mark.parametrize("height", [0.75, 0.7481, 0.9])
def test_what_begins_where_the_other_ends_is_on_top_of_it(session: LiveSession, height: float) -> None:
    assert on_top(session, table() + cube("Cup", (0.2, 0.1, height))).passed == ("R10",)


@pytest.mark.parametrize("sunk", [0.0021, 0.03])
def test_what_begins_below_the_top_is_not_on_it(session: LiveSession, sunk: float) -> None:
    found = the_finding(on_top(session, table() + cube("Cup", (0.2, 0.1, 0.75 - sunk))))
    assert (found.rule, found.severity, found.objects) == ("R10", "hard", ("Cup", "Table"))
    assert found.measured == pytest.approx(sunk, abs=1e-5)
    assert found.tolerance == pytest.approx(0.002)
    assert found.at is not None
    assert found.at[2] == pytest.approx(0.75 - sunk, abs=1e-5)


@pytest.mark.parametrize("share", [0.265, 0.6])
def test_a_quarter_of_the_outline_suffices(session: LiveSession, share: float) -> None:
    assert on_top(session, table() + cube("Cup", (0.6 - 0.2 * share, 0, 0.75))).passed == ("R10",)


@pytest.mark.parametrize("share", [0.235, 0.0])
def test_less_of_the_outline_does_not(session: LiveSession, share: float) -> None:
    found = the_finding(on_top(session, table() + cube("Cup", (0.6 - 0.2 * share, 0, 0.75))))
    assert found.measured == pytest.approx(share, abs=0.015)
    assert found.tolerance == 0.25
    assert "over 'Table'" in found.message


SOFA = """
thing("Sofa", box("Seat", (-1, -0.4, 0), (1, 0.2, 0.4)), box("Back", (-1, 0.2, 0), (1, 0.4, 0.9)))
"""


def test_a_cushion_on_the_seat_is_on_the_sofa_though_the_back_is_higher(session: LiveSession) -> None:
    assert on_top(session, SOFA + cube("Cushion", (0, 0.1, 0.4)), "Cushion", "Sofa").passed == ("R10",)


def test_a_cushion_in_the_back_is_not_on_the_sofa(session: LiveSession) -> None:
    found = the_finding(on_top(session, SOFA + cube("Cushion", (0, 0.15, 0.4)), "Cushion", "Sofa"))
    assert found.measured == pytest.approx(0.5, abs=1e-3)


def test_a_cloth_whose_hem_hangs_below_the_top_is_on_the_table(session: LiveSession) -> None:
    cloth = """
thing("Cloth", mesh("Linen", [(-0.7, -0.2, 0.4), (-0.501, -0.2, 0.752), (0.501, -0.2, 0.752), (0.7, -0.2, 0.4),
                              (-0.7, 0.2, 0.4), (-0.501, 0.2, 0.752), (0.501, 0.2, 0.752), (0.7, 0.2, 0.4)],
                    [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6)]))
"""
    assert on_top(session, table() + cloth, "Cloth", "Table").passed == ("R10",)


# R11: next to


@pytest.mark.parametrize("gap", [0.091, 0.3, 0.524])
def test_a_gap_in_the_planned_range_is_next_to(session: LiveSession, gap: float) -> None:
    script = cube("One", (0, 0, 0)) + cube("Other", (0.2 + gap, 0, 0))
    assert judged(session, "R11", script, kind="NextTo", a="One", b="Other", gap=(0.1, 0.5)).passed == (
        "R11",
    )


@pytest.mark.parametrize(
    ("gap", "limit", "fix"),
    [
        (0.089, 0.09, "Move 'One' 0.011 m away from 'Other'."),
        (0.526, 0.525, "Move 'One' 0.026 m towards 'Other'."),
    ],
)
def test_a_gap_outside_of_it_is_not(session: LiveSession, gap: float, limit: float, fix: str) -> None:
    script = cube("One", (0, 0, 0)) + cube("Other", (0.2 + gap, 0, 0))
    found = the_finding(judged(session, "R11", script, kind="NextTo", a="One", b="Other", gap=(0.1, 0.5)))
    assert (found.rule, found.objects, found.unit) == ("R11", ("One", "Other"), "m")
    assert found.measured == pytest.approx(gap, abs=1e-5)
    assert found.tolerance == pytest.approx(limit)
    assert found.fix == fix


def test_the_gap_is_between_surfaces_and_not_between_boxes(session: LiveSession) -> None:
    script = (
        'thing("One", ball("A", 0.5, segments=64))\nthing("Other", ball("B", 0.5, at=(1, 1, 0), segments=64))'
    )
    report = judged(session, "R11", script, kind="NextTo", a="One", b="Other", gap=(0.0, 0.1))
    assert the_finding(report).measured == pytest.approx(math.sqrt(2) - 1, abs=2e-3)


def test_a_thing_and_its_part_are_told_apart(session: LiveSession) -> None:
    script = 'thing("Lamp", box("Foot", (0, 0, 0), (1, 1, 0.1)), box("Shade", (0, 0, 0.5), (1, 1, 1)))'
    report = judged(session, "R11", script, kind="NextTo", a="Lamp/Shade", b="Lamp", gap=(0.0, 0.1))
    assert the_finding(report).measured == pytest.approx(0.4, abs=1e-5)


def test_a_part_that_is_not_there_cannot_be_judged(session: LiveSession) -> None:
    script = cube("One", (0, 0, 0)) + cube("Other", (1, 0, 0))
    found = the_finding(judged(session, "R11", script, kind="NextTo", a="One/Lid", b="Other"))
    assert found.outcome == "undecided"
    assert "'One/Lid'" in found.message


# R12: directions

SIDES = {
    "LeftOf": (-1, 0, 0),
    "RightOf": (1, 0, 0),
    "InFrontOf": (0, -1, 0),
    "Behind": (0, 1, 0),
    "Above": (0, 0, 1),
    "Below": (0, 0, -1),
}


@pytest.mark.parametrize(("kind", "side"), SIDES.items())
def test_each_direction_is_where_blender_has_it(
    session: LiveSession, kind: str, side: tuple[int, int, int]
) -> None:
    x, y, z = side
    build(session, cube("A", (x, y, z)) + cube("B", (0, 0, 0)) + cube("C", (-x, -y, -z)))
    there, opposite = ({"kind": kind, "a": name, "b": "B"} for name in "AC")
    assert verified(session, "R12", a_plan(there)).passed == ("R12",)
    found = the_finding(verified(session, "R12", a_plan(opposite)))
    assert (found.objects, found.unit, found.tolerance) == (("C", "B"), "°", 45)
    assert found.measured == pytest.approx(180, abs=1e-3)


@pytest.mark.parametrize("aside", [30.0, 44.5])
def test_the_direction_is_a_cone(session: LiveSession, aside: float) -> None:
    script = cube("A", (0.5, 0.1 + 0.5 * math.tan(math.radians(aside)), 0)) + cube("B", (0, 0, 0))
    assert judged(session, "R12", script, kind="RightOf", a="A", b="B").passed == ("R12",)


@pytest.mark.parametrize("aside", [45.5, 80.0])
def test_what_is_beside_the_cone_is_not_there(session: LiveSession, aside: float) -> None:
    script = cube("A", (0.5, 0.1 + 0.5 * math.tan(math.radians(aside)), 0)) + cube("B", (0, 0, 0))
    found = the_finding(judged(session, "R12", script, kind="RightOf", a="A", b="B"))
    assert found.measured == pytest.approx(aside, abs=1e-3)
    assert found.tolerance == 45


@pytest.mark.parametrize("gap", [0.0, -0.0019])
def test_what_touches_is_clear(session: LiveSession, gap: float) -> None:
    script = cube("A", (0.2 + gap, 0, 0)) + cube("B", (0, 0, 0))
    assert judged(session, "R12", script, kind="RightOf", a="A", b="B").passed == ("R12",)


@pytest.mark.parametrize("gap", [-0.0021, -0.05])
def test_what_overlaps_is_not_clear(session: LiveSession, gap: float) -> None:
    script = cube("A", (0.2 + gap, 0, 0)) + cube("B", (0, 0, 0))
    found = the_finding(judged(session, "R12", script, kind="RightOf", a="A", b="B"))
    assert (found.unit, found.tolerance) == ("m", pytest.approx(0.002))
    assert found.measured == pytest.approx(-gap, abs=1e-5)


def test_anywhere_over_a_floor_is_above_it(session: LiveSession) -> None:
    script = 'thing("Floor", box("Slab", (-5, -5, -0.1), (5, 5, 0)))\n' + cube("Lamp", (4.5, -4.5, 1))
    assert judged(session, "R12", script, kind="Above", a="Lamp", b="Floor").passed == ("R12",)


def test_a_chair_at_the_end_of_a_long_side_is_in_front_of_the_table(session: LiveSession) -> None:
    assert judged(
        session, "R12", table() + cube("Chair", (-0.45, -0.5, 0)), kind="InFrontOf", a="Chair", b="Table"
    ).passed


@pytest.mark.parametrize("turn", [90, 45, 200])
def test_left_of_a_turned_thing_is_at_its_own_left(session: LiveSession, turn: float) -> None:
    where = math.radians(turn + 180)
    at = (0.7 * math.cos(where), 0.7 * math.sin(where), 0)
    build(session, table(turn=turn) + cube("Chair", at, (0, 0, 17)))
    own, other = (
        {"kind": kind, "a": "Chair", "b": "Table", "frame": "reference"} for kind in ("LeftOf", "RightOf")
    )
    assert verified(session, "R12", a_plan(own)).passed == ("R12",)
    assert the_finding(verified(session, "R12", a_plan(other))).measured == pytest.approx(180, abs=0.01)


def test_seen_from_behind_left_is_right(session: LiveSession) -> None:
    build(session, cube("A", (1, 0, 0)) + cube("B", (0, 0, 0)) + "camera((0, 6, 3), (0, 0, 0))")
    left, right = ({"kind": kind, "a": "A", "b": "B", "frame": "camera"} for kind in ("LeftOf", "RightOf"))
    assert verified(session, "R12", a_plan(left)).passed == ("R12",)
    assert "seen from the camera" in the_finding(verified(session, "R12", a_plan(right))).message


def test_nearer_to_the_camera_is_in_front_even_from_aside(session: LiveSession) -> None:
    # Along the camera's own axis the two overlap, but not along the table's.
    script = table() + cube("Chair", (0.4, -0.45, 0)) + "camera((3, -5, 3), (0, 0, 0))"
    build(session, script)
    front, back = (
        {"kind": kind, "a": "Chair", "b": "Table", "frame": "camera"} for kind in ("InFrontOf", "Behind")
    )
    assert verified(session, "R12", a_plan(front)).passed == ("R12",)
    assert (the_finding(verified(session, "R12", a_plan(back))).measured or 0) > 90


def test_seen_from_straight_above_behind_is_up_in_the_picture(session: LiveSession) -> None:
    script = cube("A", (0, 1, 0)) + cube("B", (0, 0, 0)) + "camera((0, 0, 8), (0, 0, 0))"
    assert judged(session, "R12", script, kind="Behind", a="A", b="B", frame="camera").passed == ("R12",)


def test_without_a_camera_its_left_cannot_be_told(session: LiveSession) -> None:
    script = cube("A", (1, 0, 0)) + cube("B", (0, 0, 0))
    found = the_finding(judged(session, "R12", script, kind="RightOf", a="A", b="B", frame="camera"))
    assert found.outcome == "undecided"
    assert "no camera" in found.message


def test_a_camera_that_lies_on_its_side_has_no_left(session: LiveSession) -> None:
    tipped = "camera((0, -6, 0), (0, 0, 0)).rotation_euler = (math.pi / 2, math.pi / 2, 0)"
    script = cube("A", (1, 0, 0)) + cube("B", (0, 0, 0)) + tipped
    found = the_finding(judged(session, "R12", script, kind="RightOf", a="A", b="B", frame="camera"))
    assert found.outcome == "undecided"
    assert "vertical" in found.message


def test_a_moving_camera_is_taken_where_it_is_first(session: LiveSession) -> None:
    script = """
scene.frame_end = 20
one = camera((0, -6, 3), (0, 0, 0))
key(one, 1, location=(0, -6, 3), rotation_euler=(1.1, 0, 0))
key(one, 20, location=(0, 6, 3), rotation_euler=(1.1, 0, 3.14159))
scene.frame_set(20)
"""
    script = cube("A", (1, 0, 0)) + cube("B", (0, 0, 0)) + script
    assert judged(session, "R12", script, kind="RightOf", a="A", b="B", frame="camera").passed == ("R12",)


# R13: orientation


@pytest.mark.parametrize("lean", [0.0, 2.9])
def test_what_hardly_leans_is_upright(session: LiveSession, lean: float) -> None:
    script = cube("Lamp", (0, 0, 0), (lean, 0, 70))
    assert judged(session, "R13", script, kind="Upright", a="Lamp").passed == ("R13",)


@pytest.mark.parametrize("lean", [3.1, 90.0, 180.0])
def test_what_leans_is_not_upright(session: LiveSession, lean: float) -> None:
    found = the_finding(
        judged(session, "R13", cube("Lamp", (0, 0, 0), (0, lean, 30)), kind="Upright", a="Lamp")
    )
    assert (found.rule, found.objects, found.unit, found.tolerance) == ("R13", ("Lamp",), "°", 3)
    assert found.measured == pytest.approx(lean, abs=0.01)


@pytest.mark.parametrize("turn", [4.9, 90.0, 184.0])
def test_axes_that_run_along_each_other_are_parallel(session: LiveSession, turn: float) -> None:
    script = cube("A", (0, 0, 0), (0, 0, 20)) + cube("B", (1, 0, 0), (0, 0, 20 + turn))
    assert judged(session, "R13", script, kind="ParallelTo", a="A", b="B").passed == ("R13",)


@pytest.mark.parametrize(("turn", "off"), [(5.1, 5.1), (45.0, 45.0), (96.0, 6.0)])
def test_axes_that_do_not_are_not(session: LiveSession, turn: float, off: float) -> None:
    script = cube("A", (0, 0, 0), (0, 0, 20)) + cube("B", (1, 0, 0), (0, 0, 20 + turn))
    found = the_finding(judged(session, "R13", script, kind="ParallelTo", a="A", b="B"))
    assert found.measured == pytest.approx(off, abs=0.01)
    assert found.tolerance == 5


@pytest.mark.parametrize("off", [0.0, 14.9, -14.9])
def test_a_front_that_is_turned_to_it_faces_it(session: LiveSession, off: float) -> None:
    script = cube("Chair", (0, 2, 0), (0, 0, off)) + cube("Screen", (0, 0, 1))
    assert judged(session, "R13", script, kind="Facing", a="Chair", b="Screen").passed == ("R13",)


@pytest.mark.parametrize("off", [15.1, 180.0])
def test_a_front_that_is_turned_away_does_not(session: LiveSession, off: float) -> None:
    script = cube("Chair", (0, 2, 0), (0, 0, off)) + cube("Screen", (0, 0, 1))
    found = the_finding(judged(session, "R13", script, kind="Facing", a="Chair", b="Screen"))
    assert (found.objects, found.tolerance) == (("Chair", "Screen"), 15)
    assert found.measured == pytest.approx(off, abs=0.01)


@pytest.mark.parametrize("turn", [0, 30, 90])
def test_chairs_along_a_table_face_it_each_for_itself(session: LiveSession, turn: float) -> None:
    way = math.radians(turn)
    at = (0.4 * math.cos(way) - 0.6 * math.sin(way), 0.4 * math.sin(way) + 0.6 * math.cos(way), 0)
    script = table(turn=turn).replace("-0.5", "-2").replace("0.5", "2") + cube("Chair", at, (0, 0, turn + 4))
    assert judged(session, "R13", script, kind="Facing", a="Chair", b="Table").passed == ("R13",)
    session.empty()
    script = script.replace(f"(0, 0, {turn + 4})", f"(0, 0, {turn + 16})")
    assert the_finding(
        judged(session, "R13", script, kind="Facing", a="Chair", b="Table")
    ).measured == pytest.approx(16, abs=0.1)


def test_what_is_right_above_cannot_be_faced(session: LiveSession) -> None:
    script = cube("Chair", (0, 0, 0)) + cube("Lamp", (0, 0, 2))
    found = the_finding(judged(session, "R13", script, kind="Facing", a="Chair", b="Lamp"))
    assert found.outcome == "undecided"
    assert "right above" in found.message


KEYED = """
scene.frame_end = 20
root = bpy.data.objects["Pole root"]
key(root, 1, rotation_euler=({first}, 0, 0))
key(root, 20, rotation_euler=({last}, 0, 0))
scene.frame_set(10)
"""


@pytest.mark.parametrize(("first", "last"), [(0.0, 1.5), (1.5, 0.0)])
def test_what_moves_is_upright_at_its_first_or_its_last_frame(
    session: LiveSession, first: float, last: float
) -> None:
    script = cube("Pole", (0, 0, 0)) + KEYED.format(first=first, last=last)
    assert judged(session, "R13", script, kind="Upright", a="Pole").passed == ("R13",)


def test_what_is_upright_only_in_between_is_not(session: LiveSession) -> None:
    script = cube("Pole", (0, 0, 0)) + KEYED.format(first=-0.5, last=0.5)
    found = the_finding(judged(session, "R13", script, kind="Upright", a="Pole"))
    assert found.measured == pytest.approx(math.degrees(0.5), abs=0.01)
    assert found.frame == 1


# What a solver does: the mesh turns, and its root stands as it did.
TOPPLED = """
scene.frame_end = 20
mesh = bpy.data.objects["Pole body"]
key(mesh, 1, rotation_euler=(0, 0, 0))
key(mesh, 20, rotation_euler=({lean}, 0, 0))
scene.frame_set(1)
"""
SAGGED = """
scene.frame_end = 20
mesh = bpy.data.objects["Pole body"]
mesh.shape_key_add(name="Basis")
bent = mesh.shape_key_add(name="Bent")
for point in bent.data:
    y, z = point.co.y, point.co.z
    point.co.x *= 1.2
    point.co.y, point.co.z = y * {cosine} - 0.8 * z * {sine}, y * {sine} + 0.8 * z * {cosine}
for frame in range(1, 21):
    bent.value = (frame - 1) / 19
    bent.keyframe_insert("value", frame=frame)
scene.frame_set(1)
"""


@pytest.mark.parametrize(("when", "holds"), [("start_or_end", True), ("end", False), ("always", False)])
def test_what_topples_without_its_root_is_not_upright_at_the_end(
    session: LiveSession, when: str, holds: bool
) -> None:
    script = cube("Pole", (0, 0, 0)) + TOPPLED.format(lean=1.5)
    report = judged(session, "R13", script, kind="Upright", a="Pole", when=when)
    assert report.passed == (("R13",) if holds else ())
    if not holds:
        found = the_finding(report)
        assert (found.frame, found.tolerance) == (20, 3.0)
        assert found.measured == pytest.approx(math.degrees(1.5), abs=0.5)
        assert "toppled" in found.fix


def test_what_hardly_leans_at_the_end_stays_upright(session: LiveSession) -> None:
    script = cube("Pole", (0, 0, 0)) + TOPPLED.format(lean=0.04)
    assert judged(session, "R13", script, kind="Upright", a="Pole", when="always").passed == ("R13",)


@pytest.mark.parametrize(("lean", "holds"), [(0.35, True), (0.9, False)])
def test_what_deforms_may_lean_but_not_lie(session: LiveSession, lean: float, holds: bool) -> None:
    script = cube("Pole", (0, 0, 0)) + SAGGED.format(sine=math.sin(lean), cosine=math.cos(lean))
    report = judged(session, "R13", script, kind="Upright", a="Pole", when="end")
    assert report.passed == (("R13",) if holds else ())
    if not holds:
        assert the_finding(report).measured == pytest.approx(math.degrees(lean), abs=6)


def test_a_rule_without_such_relations_is_idle(session: LiveSession) -> None:
    build(session, cube("A", (0, 0, 0)))
    not_applicable = verified(
        session, "R10,R11,R12,R13", a_plan({"kind": "CoMoves", "a": "A", "b": "B"})
    ).not_applicable
    assert not_applicable == {
        "R10": "the plan has no OnTopOf",
        "R11": "the plan has no NextTo",
        "R12": "the plan has no Direction",
        "R13": "the plan has no Upright or Facing or ParallelTo",
    }
