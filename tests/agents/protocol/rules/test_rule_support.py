"""R5 and R6: what rests on something, and what leans on it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import pytest
from scenes import a_plan, build, the_finding, verified

from agents.protocol.judging.geometry.balance import balance

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.protocol.findings import Report

pytestmark = pytest.mark.blender

FLOOR = 'thing("Floor", box("Slab", (-3, -3, -0.1), (3, 3, 0)), system_name="ground")\n'
GROUND = 'thing("Floor", plane("Sheet", (-3, -3), (3, 3)), system_name="ground")\n'
WALL = 'thing("Wall", box("Bricks", (-3, 0, 0), (3, 0.2, 2.5)))\n'
CRATE = 'thing("Crate", box("Planks", (-0.1, -0.1, 0), (0.1, 0.1, 0.2), at=(0, 0, {height})))\n'
# Of a crate with a diagonal of 0.35 m, ε is 2 mm.


def supported(child: str, *parents: str) -> dict[str, Any]:
    return {"kind": "SupportedBy", "child": child, "parents": parents}


def against(child: str, parent: str) -> dict[str, Any]:
    return {"kind": "StableAgainst", "child": child, "parent": parent}


def judged(session: LiveSession, script: str, *relations: dict[str, Any], rules: str = "R5") -> Report:
    build(session, script)
    return verified(session, rules, a_plan(*relations))


def resting(session: LiveSession, script: str, *parents: str, child: str = "Crate") -> Report:
    return judged(session, script, supported(child, *(parents or ("Floor",))))


# R5: the gap


@pytest.mark.parametrize("height", [0.0, 0.0015, 0.0019, -0.0015])
def test_what_is_nearly_on_the_floor_rests_on_it(session: LiveSession, height: float) -> None:
    assert resting(session, FLOOR + CRATE.format(height=height)).passed == ("R5",)


@pytest.mark.parametrize("height", [0.0021, 0.005, 0.5])
def test_what_is_further_above_floats(session: LiveSession, height: float) -> None:
    found = the_finding(resting(session, FLOOR + CRATE.format(height=height)))
    assert (found.rule, found.severity, found.objects) == ("R5", "hard", ("Crate", "Floor"))
    assert found.measured == pytest.approx(height, abs=1e-5)
    assert found.tolerance == pytest.approx(0.002)
    assert "floats" in found.message
    assert found.at is not None
    assert found.at[2] == pytest.approx(height, abs=1e-5)


def test_what_is_deeper_than_that_is_sunk(session: LiveSession) -> None:
    found = the_finding(resting(session, FLOOR + CRATE.format(height=-0.03)))
    assert found.measured == pytest.approx(0.03, abs=1e-5)
    assert "deep in" in found.message


def test_nothing_below_is_no_support(session: LiveSession) -> None:
    found = the_finding(resting(session, FLOOR + CRATE.format(height=0).replace("at=(0", "at=(9")))
    assert "nothing of 'Floor' below" in found.message


@pytest.mark.parametrize("floor", [FLOOR, GROUND], ids=["slab", "sheet"])
def test_what_hangs_below_does_not_rest(session: LiveSession, floor: str) -> None:
    height = -0.3 if floor == FLOOR else -0.2
    found = the_finding(resting(session, floor + CRATE.format(height=height)))
    assert "no part of it lies on top" in found.message


def test_what_touches_a_side_does_not_rest(session: LiveSession) -> None:
    beside = FLOOR + 'thing("Crate", box("Planks", (3, 0, -0.05), (3.2, 0.2, 0.1)))'
    assert the_finding(resting(session, beside)).objects == ("Crate", "Floor")


# R5: opposed normals


TILTED = """
b = box("Planks", (-0.1, -0.1, -0.1), (0.1, 0.1, 0.1), turn=(0, {turn}, 0))
thing("Crate", b)
bpy.context.view_layer.update()
b.location.z -= min((b.matrix_world @ one.co).z for one in b.data.vertices)
"""


def test_what_stands_on_an_edge_has_its_face_turned(session: LiveSession) -> None:
    found = the_finding(resting(session, FLOOR + TILTED.format(turn=8.5)))
    assert found.measured == pytest.approx(-math.cos(math.radians(8.5)), abs=1e-5)
    assert found.tolerance == -0.99
    assert "8.5°" in found.message


def test_a_little_less_is_as_good_as_flat_but_does_not_balance(session: LiveSession) -> None:
    found = the_finding(resting(session, FLOOR + TILTED.format(turn=7.5)))
    assert "centre of mass" in found.message


@pytest.mark.parametrize("segments", [8, 12, 16, 32, 64])
def test_a_ball_rests_on_the_normal_at_its_contact(session: LiveSession, segments: int) -> None:
    ball = f'thing("Ball", ball("Rubber", 0.1, at=(0, 0, 0.1), segments={segments}))'
    assert resting(session, FLOOR + ball, child="Ball").passed == ("R5",)


def test_a_finely_meshed_bowl_rests_as_a_coarse_one_does(session: LiveSession) -> None:
    bowl = """
arc = [(math.sin(k * math.pi / 200), 1 - math.cos(k * math.pi / 200)) for k in range(101)]
shell = [(.5 * r, .5 * z) for r, z in arc] + [(.48 * r, .02 + .48 * z) for r, z in reversed(arc)]
thing("Bowl", lathe("Clay", shell, segments=300))
"""
    assert resting(session, FLOOR + bowl, child="Bowl").passed == ("R5",)


def test_a_log_rests_on_its_line_of_contact(session: LiveSession) -> None:
    log = (
        'thing("Log", lathe("Bark", [(0, -1), (0.1, -1), (0.1, 1), (0, 1)], at=(0, 0, 0.1), turn=(90, 0, 0)))'
    )
    assert resting(session, FLOOR + log, child="Log").passed == ("R5",)


def test_a_cone_on_its_tip_does_not(session: LiveSession) -> None:
    cone = 'thing("Cone", lathe("Wood", [(0, 0), (0.1, 0.3), (0, 0.3)]))'
    assert the_finding(resting(session, FLOOR + cone, child="Cone")).rule == "R5"


# R5: balance

TABLE = 'thing("Table", box("Top", (-0.5, -0.5, 0), (0.5, 0.5, 0.7)))\n'
# 0.6 m of the board's length; the part on the table is 0.2 wide, and (0.5 - start) long.
BOARD = 'thing("Board", box("Wood", ({start}, -0.1, 0.7), ({start} + 0.6, 0.1, 0.72)))\n'


@pytest.mark.parametrize(("start", "stands"), [(0.1, True), (0.182, True), (0.192, False), (0.25, False)])
def test_the_centre_of_mass_must_be_inside_the_inset_hull(
    session: LiveSession, start: float, stands: bool
) -> None:
    report = resting(session, TABLE + BOARD.format(start=start), "Table", child="Board")
    if stands:
        assert report.passed == ("R5",)
        return
    found = the_finding(report)
    assert found.measured == pytest.approx(0.5 - (start + 0.3), abs=1e-4)
    assert found.tolerance == pytest.approx(0.05 * math.sqrt(0.2 * (0.5 - start)), abs=1e-4)
    assert "tips over" in found.message
    assert f"should be at least {found.tolerance * 1000:.1f} mm inside" in found.message


CHAIR = """
thing("Chair",
      *[box(f"Leg {{x}} {{y}}", (x - .02, y - .02, {short} * (x > 0)), (x + .02, y + .02, .45))
        for x in (-.2, .2) for y in (-.2, .2)],
      box("Seat", (-.22, -.22, .45), (.22, .22, .48)), box("Back", (-.22, .2, .48), (.22, .22, .9)))
"""


def test_four_legs_make_one_hull(session: LiveSession) -> None:
    assert resting(session, FLOOR + CHAIR.format(short=0), child="Chair").passed == ("R5",)


def test_two_short_legs_let_the_chair_tip(session: LiveSession) -> None:
    found = the_finding(resting(session, FLOOR + CHAIR.format(short=0.02), child="Chair"))
    assert "tips over" in found.message
    assert found.measured is not None
    assert found.measured < -0.17


TRESTLES = """
thing("Left", box("Oak", (-1, -.2, 0), (-.9, .2, .7)))
thing("Right", box("Ash", (.9, -.2, 0), (1, .2, .7)))
thing("Board", box("Wood", (-1.2, -.1, .7), (1.2, .1, .73)))
"""


def test_several_bear_together_what_one_does_not(session: LiveSession) -> None:
    assert resting(session, TRESTLES, "Left", "Right", child="Board").passed == ("R5",)
    apart = verified(session, "R5", a_plan(supported("Board", "Left"), supported("Board", "Right")))
    assert apart.passed == ("R5",)
    alone = the_finding(verified(session, "R5", a_plan(supported("Board", "Left"))))
    assert alone.measured == pytest.approx(-0.9, abs=1e-3)


def test_mass_is_weighed_by_volume_not_by_surface(session: LiveSession) -> None:
    # The flag is large but thin: the block keeps the centre of mass on the post.
    script = FLOOR + (
        'thing("Sign", box("Block", (-.1, -.1, 0), (.1, .1, .3)), box("Flag", (.1, -.001, .2), (1.5, .001, .3)))'
    )
    assert resting(session, script, child="Sign").passed == ("R5",)


def test_an_open_surface_is_weighed_by_its_area(session: LiveSession) -> None:
    script = TABLE + 'thing("Paper", plane("Sheet", ({0}, -.1), ({0} + .6, .1), at=(0, 0, .7)))'
    assert resting(session, script.replace("{0}", ".1"), "Table", child="Paper").passed == ("R5",)
    session.empty()
    found = the_finding(resting(session, script.replace("{0}", ".3"), "Table", child="Paper"))
    assert found.measured == pytest.approx(-0.1, abs=1e-3)


def test_what_is_fastened_need_not_balance(session: LiveSession) -> None:
    far_out = TABLE + BOARD.format(start=0.4)
    fastened = {"kind": "FixedAttachment", "part": "Board", "host": "Table"}
    assert judged(session, far_out, supported("Board", "Table"), fastened).passed == ("R5",)


def test_what_leans_balances_on_both(session: LiveSession) -> None:
    build(session, FLOOR + WALL + LEANING.format(turn=6))
    assert verified(
        session, "R5,R6", a_plan(supported("Plank", "Floor"), against("Plank", "Wall"))
    ).passed == (
        "R5",
        "R6",
    )
    alone = the_finding(verified(session, "R5", a_plan(supported("Plank", "Floor"))))
    assert "tips over" in alone.message


# R5: what is hard to measure


@pytest.mark.parametrize(
    "more",
    [
        'bpy.data.objects["Planks"].data.flip_normals()',
        'bpy.data.objects["Planks"].scale = (-1, 1, 1)',
        'bpy.data.objects["Crate root"].scale = (2, 1, 0.5)',
        'bpy.data.objects["Slab"].data.flip_normals()',
        'm = bpy.data.objects["Planks"].modifiers.new("a", "ARRAY"); m.relative_offset_displace = (1.5, 0, 0)',
    ],
    ids=["inside out", "mirrored", "scaled parent", "floor inside out", "modifier"],
)
def test_turned_and_scaled_meshes_rest_as_others_do(session: LiveSession, more: str) -> None:
    assert resting(session, FLOOR + CRATE.format(height=0) + more).passed == ("R5",)


@pytest.mark.parametrize(
    ("more", "reason"),
    [
        ('bpy.data.objects["Planks"].data.vertices[0].co.x = math.nan', "not finite"),
        ('bpy.data.objects["Planks"].data.clear_geometry()', "no object named 'Crate' has a surface"),
        ('bpy.data.collections["Crate"].name = "Box"', "no object named 'Crate' has a surface"),
    ],
)
def test_what_cannot_be_measured_is_undecided(session: LiveSession, more: str, reason: str) -> None:
    build(
        session, FLOOR + CRATE.format(height=0) + 'thing("Ball", ball("Rubber", .1, at=(1, 0, .5)))\n' + more
    )
    report = verified(session, "R5", a_plan(supported("Crate", "Floor"), supported("Ball", "Floor")))
    undecided, broken = report.findings
    assert (undecided.outcome, undecided.objects) == ("undecided", ("Crate", "Floor"))
    assert reason in undecided.message
    assert (broken.outcome, broken.measured) == ("broken", pytest.approx(0.4, abs=1e-4))
    assert not report.ok


def test_what_falls_onto_the_floor_rests_on_it_at_last(session: LiveSession) -> None:
    fall = """
root = bpy.data.objects["Crate root"]
key(root, 1, location=(0, 0, {0}))
key(root, 20, location=(0, 0, {1}))
"""
    scene = FLOOR + CRATE.format(height=0) + "scene.frame_start, scene.frame_end = 1, 20\n"
    assert resting(session, scene + fall.format(1, 0)).passed == ("R5",)
    session.empty()
    # The scene stands at frame 1, but as it was keyed last: it is looked at as it will play.
    assert resting(session, scene + fall.format(0, 1)).passed == ("R5",)
    session.empty()
    found = the_finding(resting(session, scene + fall.format(0.2, 0.1)))
    assert (found.frame, found.measured) == (20, pytest.approx(0.1, abs=1e-5))


def test_thousands_of_parts_are_judged_as_one(session: LiveSession) -> None:
    tiles = """
thing("Floor", *[box(f"Tile {x} {y}", (x*.1, y*.1, -.02), (x*.1+.1, y*.1+.1, 0)) for x in range(32) for y in range(32)])
thing("Crate", box("Planks", (.5, .5, 0), (1.5, 1.5, 1)))
"""
    report = resting(session, tiles)
    assert report.passed == ("R5",)
    assert report.seconds < 20


# R6

SHELF = 'thing("Shelf", box("Wood", ({x} - 0.5, -0.3 - {gap}, 0), ({x}, -{gap}, 1.8)))\n'
LEANING = """
b = box("Wood", (-0.1, -0.02, 0), (0.1, 0.02, 2), turn=(-{turn}, 0, 0))
thing("Plank", b)
bpy.context.view_layer.update()
b.location.y -= max((b.matrix_world @ one.co).y for one in b.data.vertices)
b.location.z -= min((b.matrix_world @ one.co).z for one in b.data.vertices)
"""


def leaning(session: LiveSession, script: str, child: str = "Shelf", parent: str = "Wall") -> Report:
    return judged(session, script, against(child, parent), rules="R6")


@pytest.mark.parametrize("gap", [0.0, 0.0093, -0.0093])
def test_a_shelf_at_the_wall_is_stable(session: LiveSession, gap: float) -> None:
    assert leaning(session, WALL + SHELF.format(x=0, gap=gap)).passed == ("R6",)


@pytest.mark.parametrize("gap", [0.0097, 0.3])
def test_a_shelf_before_the_wall_is_not(session: LiveSession, gap: float) -> None:
    found = the_finding(leaning(session, WALL + SHELF.format(x=0, gap=gap)))
    assert (found.rule, found.objects) == ("R6", ("Shelf", "Wall"))
    assert found.measured == pytest.approx(gap, abs=1e-5)
    # Half a per cent of its diagonal is 9.46 mm.
    assert found.tolerance == pytest.approx(0.005 * math.hypot(0.5, 0.3, 1.8), abs=1e-5)


def test_a_shelf_in_the_wall_is_not(session: LiveSession) -> None:
    found = the_finding(leaning(session, WALL + SHELF.format(x=0, gap=-0.05)))
    assert found.measured == pytest.approx(0.05, abs=1e-5)
    assert "deep in" in found.message


@pytest.mark.parametrize(("turn", "parallel"), [(0, True), (7.9, True), (8.1, False), (20, False)])
def test_the_faces_must_be_parallel(session: LiveSession, turn: float, parallel: bool) -> None:
    report = leaning(session, WALL + LEANING.format(turn=turn), "Plank")
    if parallel:
        assert report.passed == ("R6",)
    else:
        found = the_finding(report)
        assert (found.measured, found.tolerance, found.unit) == (pytest.approx(turn, abs=0.01), 8.0, "°")


@pytest.mark.parametrize(("over", "within"), [(0.0, True), (0.009, True), (0.011, False), (0.3, False)])
def test_the_face_must_not_reach_beyond_the_wall(session: LiveSession, over: float, within: bool) -> None:
    report = leaning(session, WALL + SHELF.format(x=3 + over, gap=0))
    if within:
        assert report.passed == ("R6",)
    else:
        found = the_finding(report)
        assert found.measured == pytest.approx(over, abs=1e-4)
        assert found.tolerance == 0.01
        assert "beyond" in found.message


ROOM = 'thing("Room", box("Ground", (-3, -3, -0.1), (3, 3, 0)), box("Bricks", (-3, 0, 0), (3, 0.2, 2.5)))\n'


def test_standing_on_the_floor_of_a_room_is_not_being_at_its_wall(session: LiveSession) -> None:
    plan = supported("Shelf", "Room"), against("Shelf", "Room")
    assert judged(session, ROOM + SHELF.format(x=0, gap=0), *plan, rules="R5,R6").passed == ("R5", "R6")
    session.empty()
    found = the_finding(judged(session, ROOM + SHELF.format(x=0, gap=0.1), *plan, rules="R5,R6"))
    assert found.rule == "R6"
    assert "not with a face of its side" in found.message


@pytest.mark.parametrize(
    "child",
    [
        'lathe("Tin", [(0, 0), (.2, 0), (.2, .5), (0, .5)], at=(0, -.2, 0))',
        'box("Frame", (-.3, -.03, 1), (.3, 0, 1.5))',
        'plane("Print", (-.3, 1), (.3, 1.5), at=(0, -.001, 0), turn=(90, 0, 0))',
    ],
    ids=["round", "flat", "sheet"],
)
@pytest.mark.parametrize(
    "wall", [WALL, 'thing("Wall", plane("Paper", (-3, 0), (3, 2.5), turn=(90, 0, 0)))\n']
)
def test_round_flat_and_open_things_are_at_walls(session: LiveSession, wall: str, child: str) -> None:
    assert leaning(session, wall + f'thing("Thing", {child})', "Thing").passed == ("R6",)


# Balance, by itself


def test_balance_is_the_distance_from_the_hull() -> None:
    square = [
        (0.0, 0.0, 5.0),
        (2.0, 0.0, 0.0),
        (2.0, 2.0, 0.0),
        (0.0, 2.0, 0.0),
        (1.0, 1.0, 0.0),
        (1.0, 0.0, 0.0),
    ]
    assert balance(square, (1.5, 1.0, 9.0)) == pytest.approx((0.5, 4.0))
    assert balance(square, (3.0, 3.0, 0.0)) == pytest.approx((-math.sqrt(2), 4.0))
    assert balance(square, (2.0, 1.0, 0.0)) == pytest.approx((0.0, 4.0))


@pytest.mark.parametrize("line", [[(0.0, 0.0, 0.0)], [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.5, 0.0, 0.0)]])
def test_a_line_has_no_inside(line: list[tuple[float, float, float]]) -> None:
    assert balance(line, (0.0, 0.0, 1.0)) == pytest.approx((0.0, 0.0))
    assert balance(line, (0.0, 0.25, 1.0)) == pytest.approx((-0.25, 0.0))
