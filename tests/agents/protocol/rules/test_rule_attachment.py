"""R7 and R8: what is fastened to something, and what fills an opening of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from scenes import a_plan, build, the_finding, verified

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.protocol.findings import Report

pytestmark = pytest.mark.blender

# R7

DOOR = """
scene.frame_start, scene.frame_end = 1, 20
thing("Door", box("Leaf", (0, 0, 0), (0.9, 0.05, 2)))
thing("Handle", box("Brass", (0.8, -0.05 - {gap}, 1), (0.85, -{gap}, 1.1)))
door, handle = bpy.data.objects["Door root"], bpy.data.objects["Handle root"]
bpy.context.view_layer.update()
"""
CHILD_OF = """
link = handle.constraints.new("CHILD_OF")
link.target = door
bpy.context.view_layer.update()
"""
SWING = """
key(door, 20, rotation_euler=(0, 0, 1.5))
key(door, 1, rotation_euler=(0, 0, 0))
"""
SLIDE = """
key(handle, 20, location=(0, 0, {way}))
key(handle, 1, location=(0, 0, 0))
"""
# Of a handle with a diagonal of 0.12 m, ε is 2 mm.


def fixed(part: str, host: str) -> dict[str, Any]:
    return {"kind": "FixedAttachment", "part": part, "host": host}


def fastened(session: LiveSession, script: str, part: str = "Handle", host: str = "Door") -> Report:
    build(session, script)
    return verified(session, "R7", a_plan(fixed(part, host)))


@pytest.mark.parametrize(
    "link",
    [
        CHILD_OF,
        "handle.parent = door",
        'c = handle.constraints.new("COPY_TRANSFORMS"); c.target = door',
        'c = bpy.data.objects["Brass"].constraints.new("CHILD_OF"); c.target = bpy.data.objects["Leaf"]',
        """
third = bpy.data.objects.new("Frame", None)
scene.collection.objects.link(third)
for one in (door, handle):
    one.constraints.new("CHILD_OF").target = third
""",
    ],
    ids=["child of", "parent", "copy transforms", "mesh to mesh", "both to a third"],
)
def test_what_touches_and_is_linked_is_fastened(session: LiveSession, link: str) -> None:
    assert fastened(session, DOOR.format(gap=0) + link).passed == ("R7",)


@pytest.mark.parametrize(
    "link",
    [
        "",
        CHILD_OF + "link.mute = True",
        CHILD_OF + "link.influence = 0",
        'c = handle.constraints.new("LIMIT_DISTANCE"); c.target = door',
        'c = door.constraints.new("TRACK_TO"); c.target = handle',
    ],
    ids=["nothing", "muted", "without influence", "another constraint", "the wrong way"],
)
def test_what_only_touches_is_not(session: LiveSession, link: str) -> None:
    found = the_finding(fastened(session, DOOR.format(gap=0) + link))
    assert (found.rule, found.severity, found.objects) == ("R7", "hard", ("Handle", "Door"))
    assert "no parent or constraint links them" in found.message


def test_what_follows_its_host_is_what_is_asked_for(session: LiveSession) -> None:
    # Fastened is the part, not the host: a door that follows its handle would do as well.
    assert fastened(session, DOOR.format(gap=0) + "door.parent = handle").passed == ("R7",)


@pytest.mark.parametrize(("gap", "touches"), [(0.0019, True), (0.0021, False), (0.1, False)])
def test_the_part_must_touch_its_host(session: LiveSession, gap: float, touches: bool) -> None:
    report = fastened(session, DOOR.format(gap=gap) + CHILD_OF)
    if touches:
        assert report.passed == ("R7",)
    else:
        found = the_finding(report)
        assert found.measured == pytest.approx(gap, abs=1e-5)
        assert found.tolerance == pytest.approx(0.002)
        assert found.at is not None


def test_a_handle_swings_with_its_door(session: LiveSession) -> None:
    assert fastened(session, DOOR.format(gap=0) + CHILD_OF + SWING).passed == ("R7",)


@pytest.mark.parametrize(("way", "holds"), [(0.0018, True), (0.0022, False), (0.1, False)])
def test_a_link_that_does_not_hold_is_no_fastening(session: LiveSession, way: float, holds: bool) -> None:
    report = fastened(session, DOOR.format(gap=0) + CHILD_OF + SWING + SLIDE.format(way=way))
    if holds:
        assert report.passed == ("R7",)
    else:
        found = the_finding(report)
        assert found.measured == pytest.approx(way, abs=1e-4)
        assert found.tolerance == pytest.approx(0.002)


def test_copying_the_location_does_not_turn_with_the_door(session: LiveSession) -> None:
    link = 'c = handle.constraints.new("COPY_LOCATION"); c.target = door; c.use_offset = True\n'
    found = the_finding(fastened(session, DOOR.format(gap=0) + link + SWING))
    assert found.measured is not None
    assert found.measured > 1.0


PARTS = """
scene.frame_start, scene.frame_end = 1, 20
thing("Door", box("Leaf", (0, 0, 0), (0.9, 0.05, 2)), box("Brass", (0.8, -0.05, 1), (0.85, 0, 1.1)))
handle = bpy.data.objects["Brass"]
"""


@pytest.mark.parametrize("host", ["Door/Leaf", "Door"])
def test_parts_of_one_object_are_fastened_by_its_root(session: LiveSession, host: str) -> None:
    assert fastened(session, PARTS, "Door/Brass", host).passed == ("R7",)


def test_a_part_that_is_keyed_by_itself_is_not(session: LiveSession) -> None:
    found = the_finding(fastened(session, PARTS + SLIDE.format(way=0.1), "Door/Brass", "Door/Leaf"))
    assert found.measured == pytest.approx(0.1, abs=1e-4)


MAN = """
bones = bpy.data.armatures.new("Bones")
rig = bpy.data.objects.new("Rig", bones)
scene.collection.objects.link(rig)
bpy.context.view_layer.objects.active = rig
bpy.ops.object.mode_set(mode="EDIT")
for name, low, high in (("Hip", 0, 1), ("Hand", 1, 2)):
    bone = bones.edit_bones.new(name)
    bone.head, bone.tail = (0, 0, low), (0, 0, high)
bpy.ops.object.mode_set(mode="OBJECT")
ring = (-.1, -.1), (.1, -.1), (.1, .1), (-.1, .1)
body = mesh("Body", [(x, y, z) for z in (0, .5, 1, 1.5, 2) for x, y in ring],
            [(k + i, k + (i + 1) % 4, k + 4 + (i + 1) % 4, k + 4 + i) for k in (0, 4, 8, 12) for i in range(4)])
root = thing("Man", body)
for name, low, high in (("Hip", -1, 1.1), ("Hand", 1.1, 3)):
    inside = [one.index for one in body.data.vertices if low <= one.co.z < high]
    body.vertex_groups.new(name=name).add(inside, 1, "ADD")
body.modifiers.new("Rig", "ARMATURE").object = rig
bpy.data.collections["Man"].objects.link(rig)
rig.parent = root
hand = rig.pose.bones["Hand"]
hand.rotation_mode = "XYZ"
scene.frame_start, scene.frame_end = 1, 20
for frame, turn in ((20, .8), (1, 0)):
    hand.rotation_euler = (turn, 0, 0)
    hand.keyframe_insert("rotation_euler", frame=frame)
handle = thing("Sword", box("Steel", (.1, -.02, 1.9), (.14, .02, 2.5)))
bpy.context.view_layer.update()
link = handle.constraints.new("{kind}")
held = link if "{kind}" == "CHILD_OF" else link.targets.new()
held.target = {target}
held.subtarget = "{bone}"
bpy.context.view_layer.update()
"""


@pytest.mark.parametrize("kind", ["CHILD_OF", "ARMATURE"])
def test_a_bone_carries_what_it_holds(session: LiveSession, kind: str) -> None:
    sword = MAN.format(kind=kind, target="rig", bone="Hand")
    assert fastened(session, sword, "Sword", "Man").passed == ("R7",)


def test_what_a_bending_host_leaves_behind_is_not_fastened(session: LiveSession) -> None:
    sword = MAN.format(kind="CHILD_OF", target="root", bone="")
    found = the_finding(fastened(session, sword, "Sword", "Man"))
    assert found.measured == pytest.approx(0.532, abs=0.01)


# R8

WALL = 'wall = box("Bricks", (-3, 0, 0), (3, 0.2, 2.5))\nthing("Wall", wall)\n'
CUT = """
cutter = box("Cutter", (-0.5, -0.1, 1), (0.5, 0.3, 2))
scene.collection.objects.link(cutter)
cutter.hide_render = True
wall.modifiers.new("Opening", "BOOLEAN").object = cutter
"""
SHEET = """
outer, inner = [(-3, 0), (3, 0), (3, 2.5), (-3, 2.5)], [(-0.5, 1), (0.5, 1), (0.5, 2), (-0.5, 2)]
thing("Wall", mesh("Paper", [(x, 0.1, z) for x, z in outer + inner],
                   [(k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4)]))
"""
WINDOW = """
thing("Window", box("Pane", ({x} - 0.5 + {rim}, {y}, 1 + {rim}), ({x} + 0.5 - {rim}, {y} + 0.04, 2 - {rim})))
"""


def filled(session: LiveSession, script: str, filler: str = "Window") -> Report:
    build(session, script)
    return verified(session, "R8", a_plan({"kind": "Aperture", "filler": filler, "host": "Wall"}))


@pytest.mark.parametrize("wall", [WALL + CUT, SHEET], ids=["cut", "sheet"])
@pytest.mark.parametrize(("rim", "fits"), [(0.0, True), (0.009, True), (0.011, False), (0.05, False)])
def test_the_rim_must_be_near_all_around(session: LiveSession, wall: str, rim: float, fits: bool) -> None:
    report = filled(session, wall + WINDOW.format(x=0, y=0.08, rim=rim))
    if fits:
        assert report.passed == ("R8",)
    else:
        found = the_finding(report)
        assert (found.rule, found.severity, found.objects) == ("R8", "hard", ("Window", "Wall"))
        assert found.measured == pytest.approx(rim, abs=1e-4)
        assert (found.tolerance, found.unit) == (0.01, "m")


@pytest.mark.parametrize("wall", [WALL + CUT, SHEET], ids=["cut", "sheet"])
def test_one_side_that_gapes_is_enough(session: LiveSession, wall: str) -> None:
    found = the_finding(filled(session, wall + WINDOW.format(x=0.006, y=0.08, rim=0.0065)))
    assert found.measured == pytest.approx(0.0125, abs=1e-4)
    assert found.at is not None
    assert found.at[0] == pytest.approx(-0.5, abs=1e-3)


@pytest.mark.parametrize(("between", "fits"), [(0.005, True), (0.05, False)])
@pytest.mark.parametrize("wall", [WALL + CUT, SHEET], ids=["cut", "sheet"])
def test_two_leaves_fill_one_opening_together(
    session: LiveSession, wall: str, between: float, *, fits: bool
) -> None:
    leaf = 'thing("{0}", box("{0} board", ({1}, 0.08, 1.005), ({2}, 0.12, 1.995)))\n'
    leaves = leaf.format("Left", -0.495, -between / 2) + leaf.format("Right", between / 2, 0.495)
    build(session, wall + leaves)
    plan = a_plan(*({"kind": "Aperture", "filler": name, "host": "Wall"} for name in ("Left", "Right")))
    report = verified(session, "R8", plan)
    if fits:
        assert report.passed == ("R8",)
    else:
        assert [found.measured for found in report.findings] == [pytest.approx(between, abs=1e-3)] * 2
    alone = a_plan({"kind": "Aperture", "filler": "Left", "host": "Wall"})
    assert the_finding(verified(session, "R8", alone)).measured > 0.4  # pyright: ignore[reportOptionalOperand]


@pytest.mark.parametrize(("rim", "fits"), [(-0.0005, True), (-0.0015, False), (-0.02, False)])
def test_a_filler_that_is_too_large_is_in_the_wall(session: LiveSession, rim: float, fits: bool) -> None:
    report = filled(session, WALL + CUT + WINDOW.format(x=0, y=0.08, rim=rim))
    if fits:
        assert report.passed == ("R8",)
    else:
        found = the_finding(report)
        assert found.tolerance == pytest.approx(0.001)
        assert found.measured is not None
        assert -rim - 1e-5 <= found.measured <= -1.5 * rim
        assert "deep in" in found.message


@pytest.mark.parametrize(
    "script",
    [
        WALL + WINDOW.format(x=0, y=0.08, rim=0.005),
        WALL + CUT + WINDOW.format(x=1.5, y=0.08, rim=0.005),
        WALL + CUT + WINDOW.format(x=0, y=-0.5, rim=0.005),
    ],
    ids=["no opening", "beside it", "before it"],
)
def test_without_an_opening_around_it_nothing_is_filled(session: LiveSession, script: str) -> None:
    found = the_finding(filled(session, script))
    assert (found.tolerance, found.unit) == (180.0, "°")
    assert found.measured is not None
    assert found.measured > 200
    assert "not in an opening" in found.message


def test_a_window_stuck_onto_the_wall_is_not_in_it(session: LiveSession) -> None:
    found = the_finding(filled(session, WALL + WINDOW.format(x=0, y=-0.04, rim=0.005)))
    assert found.measured == pytest.approx(180, abs=10)


def test_a_door_needs_no_rim_at_the_floor(session: LiveSession) -> None:
    gate = WALL + CUT.replace("(-0.5, -0.1, 1), (0.5, 0.3, 2)", "(-2.5, -0.1, -1), (2.5, 0.3, 2.2)")
    assert filled(
        session, gate + 'thing("Gate", box("Wood", (-2.496, 0.1, 0), (2.496, 0.14, 2.196)))', "Gate"
    ).passed


def test_round_openings_in_turned_walls_are_filled_too(session: LiveSession) -> None:
    script = """
wall = box("Bricks", (-3, -0.1, 0), (3, 0.1, 2.5), turn=(10, 20, 30))
thing("Wall", wall)
way = wall.matrix_world @ Matrix.Translation((1, 0, 1.2)) @ Matrix.Rotation(math.pi / 2, 4, "X")
cutter = lathe("Cutter", [(0, -1), (0.4, -1), (0.4, 1), (0, 1)])
glass = lathe("Glass", [(0, -0.02), ({radius}, -0.02), ({radius}, 0.02), (0, 0.02)])
cutter.matrix_world = glass.matrix_world = way
scene.collection.objects.link(cutter)
wall.modifiers.new("Opening", "BOOLEAN").object = cutter
thing("Porthole", glass)
"""
    assert filled(session, script.format(radius=0.392), "Porthole").passed == ("R8",)
    session.empty()
    found = the_finding(filled(session, script.format(radius=0.385), "Porthole"))
    assert found.measured == pytest.approx(0.015, abs=2e-4)


def test_walls_and_windows_of_several_parts_are_taken_whole(session: LiveSession) -> None:
    script = """
def beams(low, high, start, end, front, back):
    return [((low, front, start), (high, back, start + .05)), ((low, front, end - .05), (high, back, end)),
            ((low, front, start + .05), (low + .05, back, end - .05)),
            ((high - .05, front, start + .05), (high, back, end - .05))]
thing("Wall", box("Below", (-3, 0, 0), (3, .2, 1)), box("Above", (-3, 0, 2), (3, .2, 3)),
      box("Left", (-3, 0, 1), (-.5, .2, 2)), box("Right", (.5, 0, 1), (3, .2, 2)))
frame = [box(f"Beam {k}", *ends) for k, ends in enumerate(beams(-.497, .497, 1.003, 1.997, .05, .1))]
thing("Window", *frame, box("Glass", (-.447, .07, 1.053), (.447, .08, 1.947)))
"""
    assert filled(session, script).passed == ("R8",)


@pytest.mark.parametrize("rule", ["R7", "R8"])
def test_what_is_not_there_is_undecided(session: LiveSession, rule: str) -> None:
    build(session, DOOR.format(gap=0))
    plan = a_plan(fixed("Knob", "Door"), {"kind": "Aperture", "filler": "Knob", "host": "Door"})
    found = the_finding(verified(session, rule, plan))
    assert (found.outcome, found.objects) == ("undecided", ("Knob", "Door"))
    assert "'Knob'" in found.message
