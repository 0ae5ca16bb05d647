"""R9: what is in a container, and what is sunk into something."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from scenes import a_plan, build, the_finding, verified

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.protocol.findings import Report

pytestmark = pytest.mark.blender

# A cup of 0.1 m with walls, or as one sheet; and the ball in it, of a radius of 0.02 m.
CUPS = {
    "thick": 'lathe("Clay", [(0, 0), (.04, 0), (.05, .1), (.045, .1), (.036, .005), (0, .005)])',
    "sheet": 'lathe("Clay", [(0, 0), (.04, .005), (.048, .1)])',
    "inside out": 'lathe("Clay", [(.048, .1), (.04, .005), (0, 0)])',
    "turned": 'lathe("Clay", [(0, 0), (.04, 0), (.05, .1), (.045, .1), (.036, .005), (0, .005)])',
}
BALL = 'thing("Ball", ball("Rubber", 0.02, at=({x}, 0, {z})))\n'


def cup(kind: str) -> str:
    tilt = 'bpy.data.objects["Clay"].rotation_euler.x = 0.3\n' if kind == "turned" else ""
    return f'thing("Cup", {CUPS[kind]})\n{tilt}'


def inside(content: str, container: str, **more: Any) -> dict[str, Any]:
    return {"kind": "Inside", "content": content, "container": container, **more}


def held(
    session: LiveSession, script: str, content: str = "Ball", container: str = "Cup", **more: Any
) -> Report:
    build(session, script)
    return verified(session, "R9", a_plan(inside(content, container, **more)))


@pytest.mark.parametrize("kind", CUPS)
def test_a_ball_in_a_cup_is_inside(session: LiveSession, kind: str) -> None:
    assert held(session, cup(kind) + BALL.format(x=0, z=0.04)).passed == ("R9",)


# Places a millimetre inside of the sphere are looked at; above a plane is as much of them as of their height.
def below_the_rim(z: float) -> float:
    return 0.5 + (0.1 - z) / (2 * 0.019)


@pytest.mark.parametrize("kind", ["thick", "sheet", "inside out"])
@pytest.mark.parametrize(("z", "within"), [(0.08, True), (0.0815, True), (0.0822, False), (0.09, False)])
def test_an_open_container_ends_at_its_rim(session: LiveSession, kind: str, z: float, within: bool) -> None:
    report = held(session, cup(kind) + BALL.format(x=0, z=z))
    if within:
        assert report.passed == ("R9",)
    else:
        found = the_finding(report)
        assert (found.rule, found.severity, found.objects) == ("R9", "hard", ("Ball", "Cup"))
        assert found.measured == pytest.approx(below_the_rim(z), abs=0.01)
        assert found.tolerance == 0.98
        assert found.at is not None
        assert found.at[2] > 0.1


@pytest.mark.parametrize("kind", ["thick", "sheet", "inside out"])
@pytest.mark.parametrize(("z", "within"), [(0.0995, True), (0.1005, False)])
def test_in_part_is_half(session: LiveSession, kind: str, z: float, within: bool) -> None:
    report = held(session, cup(kind) + BALL.format(x=0, z=z), partial=True)
    if within:
        assert report.passed == ("R9",)
    else:
        found = the_finding(report)
        assert found.measured == pytest.approx(below_the_rim(z), abs=0.01)
        assert found.tolerance == 0.5


@pytest.mark.parametrize("kind", ["thick", "sheet", "inside out"])
@pytest.mark.parametrize(("x", "z"), [(0, 0.2), (0.07, 0.05), (0.066, 0.05), (0, -0.03)])
def test_beside_above_and_below_is_outside(session: LiveSession, kind: str, x: float, z: float) -> None:
    found = the_finding(held(session, cup(kind) + BALL.format(x=x, z=z)))
    assert found.measured == pytest.approx(0, abs=0.04)


def test_the_wall_of_a_container_is_not_its_cavity(session: LiveSession) -> None:
    found = the_finding(held(session, cup("thick") + BALL.format(x=0.026, z=0.05)))
    assert found.measured == pytest.approx(0.86, abs=0.02)
    assert "in its wall" in found.message


def test_touching_the_wall_is_inside(session: LiveSession) -> None:
    # Both lie at the ground of the cup, the second one half a millimetre deep in it.
    assert held(session, cup("thick") + BALL.format(x=0, z=0.025)).passed == ("R9",)
    session.empty()
    assert held(session, cup("thick") + BALL.format(x=0, z=0.0245)).passed == ("R9",)


TRAY = """
thing("Tray", box("Base", (-.3, -.3, 0), (.3, .3, .01)),
      box("West", (-.3, -.3, .01), (-.29, .3, .1)), box("East", (.29, -.3, .01), (.3, .3, .1)),
      box("South", (-.29, -.3, .01), (.29, -.29, .1)), box("North", (-.29, .29, .01), (.29, .3, .1)))
"""


@pytest.mark.parametrize(("top", "within"), [(0.1, True), (0.1009, True), (0.102, False)])
def test_a_box_of_boards_is_full_to_its_rim(session: LiveSession, top: float, within: bool) -> None:
    sand = f'thing("Sand", box("Grains", (-.29, -.29, .01), (.29, .29, {top})))'
    report = held(session, TRAY + sand, "Sand", "Tray")
    assert report.ok is within
    if not within:
        # The top is as large as the ground; a tenth of the whole are the sides.
        assert the_finding(report).measured == pytest.approx(0.57, abs=0.05)


def test_paper_on_a_tray_is_inside_and_at_its_outside_is_not(session: LiveSession) -> None:
    paper = 'thing("Paper", plane("Sheet", (-.1, -.1), (.1, .1), at=(0, 0, .01)))'
    assert held(session, TRAY + paper, "Paper", "Tray").passed == ("R9",)
    session.empty()
    stuck = 'thing("Paper", box("Sheet", (.3005, -.1, 0), (.301, .1, .1)))'
    assert the_finding(held(session, TRAY + stuck, "Paper", "Tray")).measured == pytest.approx(0, abs=0.05)


@pytest.mark.parametrize(
    ("container", "content"),
    [
        ('box("Glass", (0, 0, 0), (1, 1, 1))', 'ball("Rubber", .1, at=(.5, .5, .5))'),
        (
            'box("Glass", (0, 0, 0), (1, 1, 1)), box("Hollow", (.1, .1, .1), (.9, .9, .9))',
            'box("Gold", (.3, .3, .1), (.6, .6, .3))',
        ),
        (
            'box("Back", (0, .29, 0), (1, .3, 2)), box("Left", (0, 0, 0), (.02, .29, 2)), '
            'box("Right", (.98, 0, 0), (1, .29, 2)), '
            '*[box(f"Board {k}", (.02, 0, k * .49), (.98, .29, k * .49 + .02)) for k in range(5)]',
            'box("Book", (.1, .05, .51), (.13, .25, .75))',
        ),
        (
            'lathe("Floor", [(0, -.005), (.155, -.005), (.155, 0), (0, 0)]), '
            '*[box(f"Bar {k}", (.148, -.002, 0), (.152, .002, .4), turn=(0, 0, k * 15)) for k in range(24)], '
            '*[box(f"Roof {k}", (-.15, -.002, .4), (.15, .002, .404), turn=(0, 0, k * 15)) for k in range(12)]',
            'ball("Bird", .05, at=(.04, 0, .05))',
        ),
        (
            'box("Ground", (-3, -3, -.1), (3, 3, 0)), box("North", (-3, 3, 0), (3, 3.2, 2.5)), '
            'box("West", (-3.2, -3, 0), (-3, 3, 2.5)), box("East", (3, -3, 0), (3.2, 3, 2.5))',
            'box("Table", (-.5, -.5, 0), (.5, .5, .7))',
        ),
    ],
    ids=["tank", "safe", "shelf", "cage", "room without a front"],
)
def test_containers_of_many_kinds_hold_what_is_in_them(
    session: LiveSession, container: str, content: str
) -> None:
    script = f'thing("Cup", {container})\nroot = thing("Ball", {content})\n'
    assert held(session, script).passed == ("R9",)
    session.empty()
    found = the_finding(held(session, script + "root.location = (0, -4, 0)"))
    assert found.measured == pytest.approx(0, abs=0.01)


def test_legs_around_something_contain_nothing(session: LiveSession) -> None:
    table = """
legs = [box(f"Leg {x} {y}", (x - .02, y - .02, 0), (x + .02, y + .02, .7)) for x in (-.4, .4) for y in (-.4, .4)]
thing("Cup", box("Top", (-.5, -.5, .7), (.5, .5, .75)), *legs)
thing("Ball", ball("Cat", .15, at=(0, 0, .16)))
"""
    assert the_finding(held(session, table)).measured == pytest.approx(0, abs=0.05)


def test_what_drops_into_a_cup_is_inside_at_last(session: LiveSession) -> None:
    drop = """
scene.frame_start, scene.frame_end = 1, 20
root = bpy.data.objects["Ball root"]
key(root, 20, location=(0, 0, 0))
key(root, 1, location=(0, 0, 1))
"""
    assert held(session, cup("thick") + BALL.format(x=0, z=0.03) + drop).passed == ("R9",)


# EmbeddedIn

SLAB = 'thing("Floor", box("Stone", (-1, -1, -0.5), (1, 1, 0)))\n'
SHEET = 'thing("Floor", plane("Lawn", (-1, -1), (1, 1)))\n'
POST = 'thing("Post", box("Wood", (0, 0, -{depth}), (0.1, 0.1, 1 - {depth})))\n'


def embedded(
    session: LiveSession, script: str, depth: float, part: str = "Post", host: str = "Floor"
) -> Report:
    build(session, script)
    return verified(session, "R9", a_plan({"kind": "EmbeddedIn", "part": part, "host": host, "depth": depth}))


@pytest.mark.parametrize(
    "floor",
    [SLAB, SLAB + 'bpy.data.objects["Stone"].data.flip_normals()\n', SHEET,
     SHEET + 'bpy.data.objects["Lawn"].data.flip_normals()\n'],
    ids=["slab", "slab inside out", "sheet", "sheet inside out"],
)  # fmt: skip
@pytest.mark.parametrize(
    ("depth", "right"), [(0.2, True), (0.181, True), (0.219, True), (0.179, False), (0.221, False)]
)
def test_a_post_is_as_deep_as_planned(session: LiveSession, floor: str, depth: float, right: bool) -> None:
    report = embedded(session, floor + POST.format(depth=depth), 0.2)
    if right:
        assert report.passed == ("R9",)
    else:
        found = the_finding(report)
        assert (found.rule, found.objects) == ("R9", ("Post", "Floor"))
        assert found.measured == pytest.approx(depth, abs=1e-5)
        assert (found.tolerance, found.unit) == (pytest.approx(0.02), "m")


@pytest.mark.parametrize("floor", [SLAB, SHEET], ids=["slab", "sheet"])
def test_a_post_on_the_floor_is_not_in_it(session: LiveSession, floor: str) -> None:
    found = the_finding(embedded(session, floor + POST.format(depth=0), 0.2))
    assert found.measured == pytest.approx(0, abs=1e-6)


def test_depth_is_the_way_out_not_the_nearest_surface(session: LiveSession) -> None:
    board = 'thing("Floor", box("Board", (-.2, -.2, 0), (.2, .2, .06)))\n'
    nail = 'thing("Post", lathe("Nail", [(0, .01), (.002, .015), (.002, .11), (.005, .11), (.005, .112), (0, .112)]))'
    assert embedded(session, board + nail, 0.05).passed == ("R9",)
    session.empty()
    assert embedded(session, SLAB + POST.format(depth=0.4), 0.4).passed == ("R9",)


def test_a_peg_in_a_sheet_is_as_deep_as_its_shorter_end(session: LiveSession) -> None:
    wall = 'thing("Floor", plane("Paper", (-1, 0), (1, 2), turn=(90, 0, 0)))\n'
    peg = 'thing("Post", box("Peg", (-.02, -.08, 1), (.02, .02, 1.04)))'
    assert embedded(session, wall + peg, 0.02).passed == ("R9",)


def test_a_round_stone_is_half_in_the_ground(session: LiveSession) -> None:
    stone = 'thing("Post", ball("Granite", 0.2, at=(0.3, 0.2, 0.1)))'
    assert embedded(session, SLAB + stone, 0.1).passed == ("R9",)


@pytest.mark.parametrize(
    ("more", "reason"),
    [
        ('bpy.data.objects["Rubber"].data.vertices[0].co.x = math.nan', "not finite"),
        ('bpy.data.objects["Rubber"].data.vertices.foreach_set("co", [0.0] * 1446)', "without an area"),
        ('bpy.data.objects["Rubber"].data.clear_geometry()', "no object named 'Ball' has a surface"),
    ],
)
def test_what_cannot_be_measured_is_undecided(session: LiveSession, more: str, reason: str) -> None:
    found = the_finding(held(session, cup("thick") + BALL.format(x=0, z=0.04) + more))
    assert (found.outcome, found.objects) == ("undecided", ("Ball", "Cup"))
    assert reason in found.message


@pytest.mark.parametrize(("when", "told"), [("start_or_end", False), ("end", False), ("always", True)])
def test_a_ball_that_drops_into_a_bowl_is_in_it_at_the_end(
    session: LiveSession, when: str, told: bool
) -> None:
    script = """
scene.frame_start, scene.frame_end = 1, 10
thing("Bowl", lathe("Clay", [(0, 0), (0.3, 0), (0.3, 0.3), (0.27, 0.3), (0.27, 0.03), (0, 0.03)]))
root = thing("Ball", ball("Sphere", 0.05, at=(0, 0, 0)))
"""
    keys = "key(root, 1, location=(0, 0, 1))\nkey(root, 10, location=(0, 0, 0.1))\n"
    relation = {"kind": "Inside", "content": "Ball", "container": "Bowl", "when": when}
    plan = a_plan(relation, frame_end=10)
    plan = plan.model_copy(
        update={
            "objects": tuple(
                one.model_copy(update={"role": "keyframed"}) if one.name == "Ball" else one
                for one in plan.objects
            )
        }
    )
    build(session, script + keys)
    assert bool(verified(session, "R9", plan).findings) == told
    # Before it moves, only what is to hold at the end waits.
    session.empty()
    build(session, script + "root.location.z = 1")
    assert bool(verified(session, "R9", plan).findings) == (when != "end")
