"""R16 and R17: regular arrangements."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import pytest
from scenes import a_plan, build, the_finding, verified

if TYPE_CHECKING:
    from collections.abc import Sequence

    from live_session import LiveSession

    from agents.protocol.findings import Report

    Place = tuple[float, float, float]

pytestmark = pytest.mark.blender


def seat(name: str, at: Place, turn: float = 0, tilt: float = 0) -> str:
    where = f"at={tuple(at)}, turn=({tilt}, 0, {turn})"
    return f"thing({name!r}, box('{name} body', (-0.1, -0.1, 0), (0.1, 0.1, 0.3), {where}), {where})\n"


def on_circle(degrees: float, radius: float = 1.0, centre: Place = (3, 1, 0)) -> Place:
    turn = math.radians(degrees)
    return (centre[0] + radius * math.cos(turn), centre[1] + radius * math.sin(turn), centre[2])


def names(count: int) -> list[str]:
    return [f"Seat {place + 1}" for place in range(count)]


def judged(
    session: LiveSession, rule: str, places: Sequence[Place], extra: str = "", **relation: Any
) -> Report:
    """Seats at some places, and what the rule says of the relation of all of them."""
    members = names(len(places))
    script = "".join(seat(name, at) for name, at in zip(members, places, strict=True))
    build(session, script + extra)
    return verified(session, rule, a_plan({"kind": "Distributed", "members": members, **relation}))


EVEN = (0, 60, 120, 180, 240, 300)


# Circles


def ring(session: LiveSession, places: Sequence[Place], **relation: Any) -> Report:
    return judged(session, "R16", places, pattern="circle", **relation)


def test_a_ring_is_a_circle(session: LiveSession) -> None:
    assert ring(session, [on_circle(turn) for turn in EVEN], about=(3, 1, 5), radius=1.0).passed == ("R16",)


@pytest.mark.parametrize("radius", [1.029, 0.971])
def test_a_member_may_be_a_little_off_the_radius(session: LiveSession, radius: float) -> None:
    places = [on_circle(turn, radius if turn == 120 else 1) for turn in EVEN]
    assert ring(session, places, about=(3, 1, 0), radius=1.0).passed == ("R16",)


@pytest.mark.parametrize("radius", [1.031, 0.969, 1.5])
def test_a_member_that_is_off_the_radius_is_named(session: LiveSession, radius: float) -> None:
    places = [on_circle(turn, radius if turn == 120 else 1) for turn in EVEN]
    found = the_finding(ring(session, places, about=(3, 1, 0), radius=1.0))
    assert (found.rule, found.severity, found.objects, found.unit) == ("R16", "hard", ("Seat 3",), "m")
    assert found.measured == pytest.approx(abs(radius - 1), abs=1e-5)
    assert found.tolerance == pytest.approx(0.03)
    assert found.at == pytest.approx(places[2], abs=1e-5)


def test_a_ring_of_the_wrong_size_names_all_its_members(session: LiveSession) -> None:
    found = the_finding(ring(session, [on_circle(turn, 1.2) for turn in EVEN], radius=1.0))
    assert found.objects == tuple(names(6))
    assert found.measured == pytest.approx(0.2, abs=1e-5)


@pytest.mark.parametrize("off", [2.9, -2.9])
def test_gaps_may_differ_by_a_twentieth(session: LiveSession, off: float) -> None:
    assert ring(session, [on_circle(turn + off * (turn == 60)) for turn in EVEN], about=(3, 1, 0)).passed == (
        "R16",
    )


@pytest.mark.parametrize("off", [3.1, 30.0])
def test_an_uneven_gap_is_told_with_those_beside_it(session: LiveSession, off: float) -> None:
    found = the_finding(
        ring(session, [on_circle(turn + off * (turn == 60)) for turn in EVEN], about=(3, 1, 0))
    )
    assert (found.unit, found.tolerance) == ("°", pytest.approx(3))
    assert set(found.objects) in ({"Seat 1", "Seat 2"}, {"Seat 2", "Seat 3"})
    assert found.measured == pytest.approx(off, abs=1e-3)


@pytest.mark.parametrize(("off", "breaks"), [(1.9, False), (2.1, True)])
def test_in_a_ring_of_many_two_degrees_are_let_through(
    session: LiveSession, off: float, breaks: bool
) -> None:
    turns = range(0, 360, 15)
    report = ring(session, [on_circle(turn + off * (turn == 60), 2) for turn in turns], about=(3, 1, 0))
    assert bool(report.findings) == breaks


@pytest.mark.parametrize(("height", "breaks"), [(0.012, False), (0.02, True)])
def test_a_ring_is_flat(session: LiveSession, height: float, breaks: bool) -> None:
    turns = range(0, 360, 30)
    places = [on_circle(turn, 1, (3, 1, height * (turn == 90))) for turn in turns]
    report = ring(session, places, about=(3, 1, 0), radius=1.0)
    if not breaks:
        assert report.passed == ("R16",)
        return
    found = the_finding(report)
    assert (found.objects, found.tolerance) == (("Seat 4",), pytest.approx(0.01))
    assert found.measured == pytest.approx(0.75 * height, rel=0.05)  # the plane gives way a little


def test_a_leaning_ring_is_a_ring(session: LiveSession) -> None:
    places = [(3 + x, 0.8 * y, 0.6 * y) for x, y, _ in (on_circle(turn, 1, (0, 0, 0)) for turn in EVEN)]
    assert ring(session, places, radius=1.0).passed == ("R16",)


def test_the_centre_may_be_an_object(session: LiveSession) -> None:
    places = [on_circle(turn) for turn in EVEN]
    assert judged(session, "R16", places, seat("Table", (3, 1, 0)), pattern="circle", about="Table").passed
    session.empty()
    report = judged(session, "R16", places, seat("Table", (3.1, 1, 0)), pattern="circle", about="Table")
    assert report.findings[0].measured == pytest.approx(0.1, abs=5e-3)


def test_members_on_one_spot_are_no_ring(session: LiveSession) -> None:
    found = the_finding(ring(session, [(1, 1, 0)] * 4))
    assert "all at one point" in found.message


@pytest.mark.parametrize(("off", "breaks"), [(9.9, False), (10.1, True), (180, True)])
@pytest.mark.parametrize(("facing", "front"), [("inwards", -90), ("outwards", 90)])
def test_members_face_as_planned(
    session: LiveSession, facing: str, front: float, off: float, breaks: bool
) -> None:
    script = "".join(
        seat(name, on_circle(turn), turn + front + off * (turn == 60))
        for name, turn in zip(names(6), EVEN, strict=True)
    )
    build(session, script)
    relation = {"kind": "Distributed", "members": names(6), "pattern": "circle", "facing": facing}
    report = verified(session, "R16", a_plan(relation))
    if not breaks:
        assert report.passed == ("R16",)
        return
    found = the_finding(report)
    assert (found.objects, found.tolerance) == (("Seat 2",), 10)
    assert found.measured == pytest.approx(off, abs=0.01)


def test_the_seats_of_a_big_wheel_face_its_hub(session: LiveSession) -> None:
    # In the plane of X and Z; the front, −Y of each, is turned about Y's own axis towards the hub.
    script = "".join(
        f"one = thing({name!r}, box('{name} body', (-0.1, -0.1, -0.1), (0.1, 0.1, 0.1)))\n"
        f"one.matrix_world = Matrix.Rotation(math.radians({turn}), 4, 'Y') @ Matrix.Translation((0, 0, 2))"
        f" @ Matrix.Rotation(math.radians(90), 4, 'X')\n"
        for name, turn in zip(names(6), EVEN, strict=True)
    )
    build(session, script)
    inwards, outwards = (
        {"kind": "Distributed", "members": names(6), "pattern": "circle", "radius": 2.0, "facing": facing}
        for facing in ("inwards", "outwards")
    )
    found = [verified(session, "R16", a_plan(relation)) for relation in (inwards, outwards)]
    assert [len(report.findings) for report in found] in ([0, 6], [6, 0])
    wrong = next(report for report in found if report.findings)
    assert [one.measured for one in wrong.findings] == pytest.approx([180] * 6, abs=0.01)


def test_what_moves_may_make_a_ring_at_last(session: LiveSession) -> None:
    script = "".join(
        f"{seat(name, (2.0 * place, 5, 0))}"
        f"key(bpy.data.objects['{name} root'], 1, location={(2.0 * place, 5, 0)})\n"
        f"key(bpy.data.objects['{name} root'], 20, location={on_circle(turn)})\n"
        for place, (name, turn) in enumerate(zip(names(6), EVEN, strict=True))
    )
    build(session, f"scene.frame_end = 20\n{script}")
    relation = {"kind": "Distributed", "members": names(6), "pattern": "circle", "radius": 1.0}
    assert verified(session, "R16", a_plan(relation)).passed == ("R16",)
    session.run("bpy.context.scene.frame_end = 15")
    assert verified(session, "R16", a_plan(relation)).findings


def test_a_member_that_is_not_there_cannot_be_judged(session: LiveSession) -> None:
    build(session, "".join(seat(name, on_circle(turn)) for name, turn in zip(names(3), EVEN, strict=False)))
    found = the_finding(
        verified(session, "R16", a_plan({"kind": "Distributed", "members": names(4), "pattern": "circle"}))
    )
    assert found.outcome == "undecided"
    assert "'Seat 4'" in found.message


# Arcs


def test_an_arc_is_even_between_its_ends(session: LiveSession) -> None:
    places = [on_circle(turn) for turn in (10, 40, 70, 100)]
    assert judged(session, "R16", places, pattern="arc", about=(3, 1, 0), arc=90).passed == ("R16",)


@pytest.mark.parametrize(("arc", "off"), [(100, 10 / 3), (60, 10)])
def test_an_arc_has_its_planned_length(session: LiveSession, arc: float, off: float) -> None:
    places = [on_circle(turn) for turn in (10, 40, 70, 100)]
    found = the_finding(judged(session, "R16", places, pattern="arc", about=(3, 1, 0), arc=arc))
    assert found.measured == pytest.approx(off, abs=1e-3)
    assert found.tolerance == pytest.approx(max(2, 0.05 * arc / 3))


# Lines


def line(session: LiveSession, places: Sequence[Place], **relation: Any) -> Report:
    return judged(session, "R17", places, pattern="line", **relation)


def test_even_steps_are_a_line(session: LiveSession) -> None:
    assert line(session, [(place, 0.5 * place, 0.2 * place) for place in range(5)]).passed == ("R17",)


@pytest.mark.parametrize(("aside", "breaks"), [(0.095, False), (0.105, True)])
def test_a_member_may_be_a_fiftieth_of_the_length_beside_the_line(
    session: LiveSession, aside: float, breaks: bool
) -> None:
    # Four of five give the line; the one in the middle draws it a fifth of the way to itself.
    places = [(float(place), aside * (place == 2), 0) for place in range(5)]
    report = line(session, places)
    assert bool(report.findings) == breaks
    if breaks:
        found = the_finding(report)
        assert (found.rule, found.severity, found.objects) == ("R17", "hard", ("Seat 3",))
        assert found.measured == pytest.approx(0.8 * aside, rel=1e-3)
        assert found.tolerance == pytest.approx(0.08, rel=1e-3)


@pytest.mark.parametrize("off", [0.019, -0.019])
def test_spacing_may_differ_by_a_fiftieth(session: LiveSession, off: float) -> None:
    places = [(0, 0, 0), (1, 0, 0), (2 + off, 0, 0)]
    assert line(session, places, spacing=1.0).passed == ("R17",)


@pytest.mark.parametrize("off", [0.021, -0.5])
def test_uneven_spacing_is_told_with_those_beside_it(session: LiveSession, off: float) -> None:
    found = the_finding(line(session, [(0, 0, 0), (1, 0, 0), (2 + off, 0, 0)], spacing=1.0))
    assert set(found.objects) == {"Seat 2", "Seat 3"}
    assert found.measured == pytest.approx(abs(off), abs=1e-5)
    assert found.tolerance == pytest.approx(0.02)


def test_without_a_planned_spacing_it_is_to_be_even(session: LiveSession) -> None:
    found = the_finding(line(session, [(0, 0, 0), (1, 0, 0), (2.2, 0, 0)]))
    assert found.measured == pytest.approx(0.1, abs=1e-5)
    assert found.tolerance == pytest.approx(0.02 * 1.1)


def test_members_on_one_spot_are_no_line(session: LiveSession) -> None:
    assert "all at one point" in the_finding(line(session, [(1, 1, 0)] * 3)).message


def test_parts_stand_where_their_middle_is(session: LiveSession) -> None:
    build(session, 'thing("Rack", *(box(f"Peg {k}", (k + 0.1, 0, 0), (k + 0.3, 1, 1)) for k in (0, 1, 2.5)))')
    members = [f"Rack/Peg {k}" for k in ("0", "1", "2.5")]
    relation = {"kind": "Distributed", "members": members, "pattern": "line", "spacing": 1.0}
    found = the_finding(verified(session, "R17", a_plan(relation)))
    assert set(found.objects) == {"Rack/Peg 1", "Rack/Peg 2.5"}
    assert found.measured == pytest.approx(0.5, abs=1e-5)


# Grids


def cells(rows: int, columns: int) -> list[Place]:
    return [(1.0 * row, 0.6 * column, 0.0) for row in range(rows) for column in range(columns)]


def grid(session: LiveSession, places: Sequence[Place], **relation: Any) -> Report:
    return judged(session, "R17", places, pattern="grid", **relation)


def test_rows_and_columns_are_a_grid(session: LiveSession) -> None:
    assert grid(session, cells(3, 4), rows=4, columns=3, spacing=(0.6, 1.0)).passed == ("R17",)


@pytest.mark.parametrize(("off", "breaks"), [(0.0175, False), (0.0185, True), (0.2, True)])
def test_a_member_beside_its_crossing_is_named(session: LiveSession, off: float, breaks: bool) -> None:
    places = cells(3, 4)
    places[6] = (places[6][0], places[6][1], off)
    report = grid(session, places)
    assert bool(report.findings) == breaks
    if breaks:
        found = the_finding(report)
        assert found.objects == ("Seat 7",)
        assert found.measured == pytest.approx(off, rel=1e-3)
        assert found.tolerance == pytest.approx(0.018, rel=1e-3)


def test_a_grid_with_a_hole_says_how_many_it_lacks(session: LiveSession) -> None:
    found = the_finding(grid(session, [place for place in cells(3, 4) if place != (1.0, 0.6, 0.0)]))
    assert (found.measured, found.tolerance) == (11, 12)
    assert "11 members lie on a grid of" in found.message


def test_another_number_of_rows_is_told(session: LiveSession) -> None:
    found = the_finding(grid(session, cells(2, 6), rows=3, columns=4))
    assert "the plan says 3 × 4" in found.message


@pytest.mark.parametrize(("spacing", "breaks"), [(0.615, False), (0.62, True)])
def test_a_grid_has_its_planned_spacing(session: LiveSession, spacing: float, breaks: bool) -> None:
    report = grid(session, cells(3, 3), spacing=(1.0, spacing))
    assert bool(report.findings) == breaks
    if breaks:
        assert the_finding(report).measured == pytest.approx(0.6, abs=1e-5)
        assert the_finding(report).tolerance == pytest.approx(0.03 * spacing)


def test_a_grid_of_one_row_is_a_line(session: LiveSession) -> None:
    assert grid(session, cells(1, 4), rows=1, columns=4).passed == ("R17",)


def test_members_on_a_line_are_no_grid(session: LiveSession) -> None:
    assert "on one line" in the_finding(grid(session, cells(1, 4))).message


# Mirrors


def mirrored(session: LiveSession, places: Sequence[Place], **relation: Any) -> Report:
    members = names(len(places))
    build(session, "".join(seat(name, at) for name, at in zip(members, places, strict=True)))
    return verified(session, "R17", a_plan({"kind": "SymmetricAbout", "members": members, **relation}))


def test_pairs_and_what_stands_on_the_plane_are_symmetric(session: LiveSession) -> None:
    places = [(4, 1, 0), (3, 3, 0), (2, 1, 0), (3.5, 0, 0), (2.5, 0, 0)]
    assert mirrored(session, places, point=(3, 0, 0)).passed == ("R17",)


# The box around the four has a diagonal of 2.06 m: 3 % are 62 mm.
@pytest.mark.parametrize(("off", "breaks"), [(0.06, False), (0.065, True), (0.4, True)])
def test_a_member_beside_its_mirrored_place_breaks_the_symmetry(
    session: LiveSession, off: float, breaks: bool
) -> None:
    report = mirrored(session, [(1, 0, 0), (-1, 0, 0), (1, 0.5, 0), (-1, 0.5, off)])
    assert bool(report.findings) == breaks
    if breaks:
        found = the_finding(report)
        assert found.objects in {("Seat 3",), ("Seat 4",)}
        assert found.measured == pytest.approx(off, abs=1e-5)
        assert found.tolerance == pytest.approx(0.03 * math.hypot(2, 0.5, off), abs=1e-5)


def test_a_plan_without_arrangements_leaves_the_rules_idle(session: LiveSession) -> None:
    build(session, seat("A", (0, 0, 0)))
    not_applicable = verified(
        session, "R16,R17", a_plan({"kind": "CoMoves", "a": "A", "b": "B"})
    ).not_applicable
    assert not_applicable == {
        "R16": "the plan has no circle or arc",
        "R17": "the plan has no line, grid or mirror",
    }
