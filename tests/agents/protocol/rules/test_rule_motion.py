"""T2 to T4, T6 and T7: motions keyed and simulated, measured against their plan and against gravity."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from scenes import a_motion, build, measured, the_finding, verified

from agents.blender.tools.bake import TOOL as BAKE
from agents.protocol.measures.geometry import GapRequest
from agents.protocol.measures.motion import ContactFramesRequest

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.protocol.findings import Finding, Report

pytestmark = pytest.mark.blender

G = 9.81
# A box whose centre is its origin, which slides one metre along X between two frames.
SLED = """
scene.frame_start, scene.frame_end = 1, 120
sled = thing("Sled", box("Runner", (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)))

def slide(first, last, way=1.0, one=sled):
    key(one, first, location=(0, 0, 0))
    key(one, last, location=(way, 0, 0))
    linear(one)
"""
FLOOR = 'thing("Floor", box("Slab", (-9, -9, -1), (9, 9, 0)), system_name="ground")\n'
DROP = (
    "scene.frame_start, scene.frame_end = 1, 60\n"
    + FLOOR
    + """
crate = box("Case", (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5), at=(0, 0, HEIGHT))
thing("Crate", crate)
"""
)
RIGID = "rigid(bpy.data.objects['Slab'], 'PASSIVE')\nrigid(crate)\n"
# A sheet that hangs over a rod: pinned along its middle.
CURTAIN = """
scene.frame_start, scene.frame_end = 1, 20
shape = bmesh.new()
bmesh.ops.create_grid(shape, x_segments=8, y_segments=8, size=0.5)
data = bpy.data.meshes.new("Cloth")
shape.to_mesh(data)
sheet = bpy.data.objects.new("Cloth", data)
thing("Flag", sheet)
pins = sheet.vertex_groups.new(name="Pins")
pins.add([at for at, vertex in enumerate(data.vertices) if abs(vertex.co.x) < 0.1], 1, "ADD")
cloth = sheet.modifiers.new("Cloth", "CLOTH")
cloth.settings.vertex_group_mass = "Pins"
"""
ROLES = {"Floor": "ground", "Crate": "rigid"}


def phase(actor: str, kind: str, start: int, end: int, **more: Any) -> dict[str, Any]:
    return {"actor": actor, "kind": kind, "start": start, "end": end, **more}


def judged(session: LiveSession, rule: str, script: str, *phases: dict[str, Any], **plan: Any) -> Report:
    build(session, script)
    if "rigid(" in script or "CLOTH" in script:
        session.use(BAKE)
    return verified(session, rule, a_motion(*phases, **{"last": 120} | plan))


def broken(found: Report, rule: str, holds: bool) -> Finding | None:
    """The finding of a report that is to have one, None of one that is to have none."""
    if holds:
        assert not found.findings, [one.message for one in found.findings]
        assert found.passed == (rule,)
        return None
    return the_finding(found)


# T2: onset


@pytest.mark.parametrize(
    ("really", "end", "holds"),
    [(22, 40, True), (23, 40, False), (18, 40, True), (17, 40, False), (24, 100, True), (25, 100, False)],
)
def test_a_phase_begins_within_two_frames_or_a_twentieth(
    session: LiveSession, really: int, end: int, holds: bool
) -> None:
    found = judged(session, "T2", f"{SLED}\nslide({really}, {end})", phase("Sled", "translate", 20, end))
    if finding := broken(found, "T2", holds):
        assert finding.objects == ("Sled",)
        assert (finding.measured, finding.frame) == (really - 20, really)
        assert finding.tolerance == max(2, 0.05 * (end - 20))


def test_what_never_moves_is_told_with_its_speed(session: LiveSession) -> None:
    finding = the_finding(judged(session, "T2", SLED, phase("Sled", "translate", 20, 40, extent=1)))
    assert (finding.measured, finding.unit) == (0.0, "m/s")
    assert "does not move from frame 20 to 40" in finding.message


def test_a_knob_that_turns_on_the_spot_moves(session: LiveSession) -> None:
    script = f"{SLED}\nkey(sled, 20, rotation_euler=(0, 0, 0))\nkey(sled, 60, rotation_euler=(0, 0, 3))\nlinear(sled)"
    assert judged(session, "T2", script, phase("Sled", "rotate", 20, 60)).passed == ("T2",)


def test_a_slow_hand_of_a_clock_moves_where_the_plan_wants_it_so_slow(session: LiveSession) -> None:
    script = f"{SLED}\nslide(20, 100, way=0.02)"  # 6 mm/s
    assert judged(session, "T2", script, phase("Sled", "translate", 20, 100, extent=0.02)).passed == ("T2",)
    session.empty()
    assert judged(session, "T2", script, phase("Sled", "translate", 20, 100)).findings


def test_a_motion_that_goes_on_from_phase_to_phase_is_on_time(session: LiveSession) -> None:
    script = f"{SLED}\nslide(10, 60, way=5)"
    halves = phase("Sled", "translate", 10, 35), phase("Sled", "translate", 35, 60)
    assert judged(session, "T2", script, *halves).passed == ("T2",)
    pause = (
        phase("Sled", "translate", 10, 20),
        phase("Sled", "hold", 20, 40),
        phase("Sled", "translate", 40, 60),
    )
    session.empty()
    finding = the_finding(judged(session, "T2", script, *pause))
    assert (finding.measured, finding.frame) == (-20, 20)


def test_a_body_falls_from_the_first_frame_on(session: LiveSession) -> None:
    script = DROP.replace("HEIGHT", "3") + RIGID
    report = judged(session, "T2", script, phase("Crate", "fall", 1, 16), roles=ROLES, last=60)
    assert report.passed == ("T2",)
    finding = the_finding(verified(session, "T2", a_motion(phase("Crate", "fall", 10, 16), roles=ROLES)))
    assert (finding.measured, finding.frame) == (
        -8,
        2,
    )  # at frame 1 it is slower than a share of its greatest speed


@pytest.mark.parametrize(("really", "holds"), [(20, True), (30, False)])
def test_an_emitter_begins_with_its_first_particle(session: LiveSession, really: int, holds: bool) -> None:
    script = f"""
scene.frame_start, scene.frame_end = 1, 60
nozzle = plane("Nozzle", (-0.1, -0.1), (0.1, 0.1))
thing("Fountain", nozzle)
nozzle.modifiers.new("Drops", "PARTICLE_SYSTEM")
drops = nozzle.particle_systems[0].settings
drops.count, drops.frame_start, drops.frame_end = 100, {really}, 50
"""
    found = judged(
        session, "T2", script, phase("Fountain", "emit", 20, 50), roles={"Fountain": "emitter"}, last=60
    )
    if finding := broken(found, "T2", holds):
        assert finding.measured == pytest.approx(really - 20, abs=1)


# T3: order


PUSH = """
scene.frame_start, scene.frame_end = 1, 60
rod = thing("Rod", box("Nose", (-1, -0.1, -0.1), (0, 0.1, 0.1)))
tile = thing("Tile", box("Face", (0, -0.1, -0.5), (0.1, 0.1, 0.5)))
rod.location, tile.location = (-1, 0, 0), (0, 0, 0)
key(rod, 10, location=(-1, 0, 0))
key(rod, 30, location=(0, 0, 0))
linear(rod)
key(tile, ONSET, location=(0, 0, 0))
key(tile, ONSET + 10, location=(0, 0, 0.2))
linear(tile)
"""
CAUSED = ({"name": "push", **phase("Rod", "translate", 10, 30)}, phase("Tile", "slide", 30, 40, cause="push"))


@pytest.mark.parametrize(("onset", "holds"), [(32, True), (29, True), (28, False)])
def test_a_target_waits_for_the_contact(session: LiveSession, onset: int, holds: bool) -> None:
    # The rod comes 5 cm nearer a frame, and touches at frame 30.
    found = judged(session, "T3", PUSH.replace("ONSET", str(onset)), *CAUSED)
    if finding := broken(found, "T3", holds):
        assert finding.objects == ("Tile", "Rod")
        assert (finding.measured, finding.tolerance, finding.frame) == (30 - onset, 1, onset)
        assert "touches it only at frame 30" in finding.message


@pytest.mark.parametrize(("onset", "holds"), [(9, True), (8, False)])
def test_without_a_contact_the_cause_moves_first(session: LiveSession, onset: int, holds: bool) -> None:
    script = PUSH.replace("ONSET", str(onset)).replace(
        "(0, -0.1, -0.5), (0.1, 0.1, 0.5)", "(0, 4, 0), (0.1, 5, 1)"
    )
    found = judged(session, "T3", script, CAUSED[0], phase("Tile", "slide", 10, 20, cause="push"))
    if finding := broken(found, "T3", holds):
        assert (finding.measured, finding.frame) == (10 - onset, onset)


def test_what_is_held_from_the_start_is_not_touched_only_later(session: LiveSession) -> None:
    script = PUSH.replace("ONSET", "7").replace("location=(-1, 0, 0)", "location=(0, 0, 0)")
    script = script.replace("key(rod, 30, location=(0, 0, 0))", "key(rod, 30, location=(-1, 0, 0))")
    (finding,) = judged(
        session, "T3", script, CAUSED[0], phase("Tile", "slide", 7, 17, cause="push")
    ).findings
    assert "its cause 'push' starts only at frame 10" in finding.message


def test_a_fast_ball_that_rebounds_between_frames_has_hit(session: LiveSession) -> None:
    script = """
scene.frame_start, scene.frame_end = 1, 60
shot, tile = ball("Shot", 0.1, at=(-4, 0, 1)), box("Face", (-0.05, -0.2, -0.5), (0.05, 0.2, 0.5), at=(0, 0, 1))
thing("Ball", shot, at=(-4, 0, 1))
thing("Tile", tile)
scene.gravity = (0, 0, 0)
for one in (shot, tile):
    rigid(one, restitution=1, mass=1, linear_damping=0, angular_damping=0)
key(shot, 1, location=(-4, 0, 1))
key(shot, 3, location=(-3.2, 0, 1))
linear(shot)
shot.rigid_body.kinematic = True
shot.rigid_body.keyframe_insert("kinematic", frame=3)
shot.rigid_body.kinematic = False
shot.rigid_body.keyframe_insert("kinematic", frame=4)
"""
    build(session, script)
    session.use(BAKE)
    # It comes 0.4 m nearer a frame, stops where it hits between two frames, and the tile flies on before the second.
    (first, *_) = measured(session, ContactFramesRequest(("Shot",), ("Face",), 1, 40, 0.002)).frames
    assert first == 11
    gaps = [measured(session, GapRequest(("Shot",), ("Face",), frame)).distance for frame in (10, 11)]
    assert min(gaps) > 0.05
    shot = {"name": "shot", **phase("Ball", "translate", 1, 12)}
    roles = {"Ball": "rigid", "Tile": "rigid"}
    hit = phase("Tile", "slide", 11, 40, cause="shot")
    assert verified(session, "T3", a_motion(shot, hit, roles=roles)).passed == ("T3",)


# T4: extent


@pytest.mark.parametrize(("way", "holds"), [(1.09, True), (1.11, False), (0.91, True), (0.89, False)])
def test_a_way_is_a_tenth_longer_or_shorter_at_most(session: LiveSession, way: float, holds: bool) -> None:
    found = judged(
        session, "T4", f"{SLED}\nslide(20, 40, way={way})", phase("Sled", "translate", 20, 40, extent=1)
    )
    if finding := broken(found, "T4", holds):
        assert (finding.objects, finding.unit) == (("Sled",), "m")
        assert (finding.measured, finding.tolerance) == pytest.approx((way, 0.1))


def test_a_phase_that_is_two_frames_late_is_measured_whole(session: LiveSession) -> None:
    found = judged(session, "T4", f"{SLED}\nslide(22, 32)", phase("Sled", "translate", 20, 30, extent=1))
    assert found.passed == ("T4",)


@pytest.mark.parametrize(("off", "holds"), [(9.5, True), (10.5, False)])
def test_a_way_goes_ten_degrees_beside_its_direction_at_most(
    session: LiveSession, off: float, holds: bool
) -> None:
    script = f"{SLED}\nslide(20, 40)\n"
    turned = f"(math.cos(math.radians({off})), math.sin(math.radians({off})), 0)"
    script += f"key(sled, 40, location={turned})"
    found = judged(session, "T4", script, phase("Sled", "translate", 20, 40, direction=(2, 0, 0)))
    if finding := broken(found, "T4", holds):
        assert (finding.measured, finding.tolerance) == (pytest.approx(off, abs=0.01), 10)


@pytest.mark.parametrize(
    ("planned", "turned", "holds"),
    [(720, 655, True), (720, 640, False), (90, 81, True), (90, 78, False), (10, 6, True), (10, 4, False)],
)
def test_turns_are_counted_over_whole_ones(
    session: LiveSession, planned: int, turned: int, holds: bool
) -> None:
    script = f"{SLED}\nkey(sled, 20, rotation_euler=(0, 0, 0))\n" + (
        f"key(sled, 60, rotation_euler=(0, 0, math.radians({turned})))\nlinear(sled)"
    )
    found = judged(session, "T4", script, phase("Sled", "rotate", 20, 60, turn=planned))
    if finding := broken(found, "T4", holds):
        assert (finding.measured, finding.unit) == (pytest.approx(turned, abs=0.01), "°")


def test_a_swing_is_measured_where_it_is_farthest(session: LiveSession) -> None:
    script = f"{SLED}\nbpy.data.objects['Runner'].data.transform(Matrix.Translation((0, 0, -2)))\n" + (
        "for frame, turn in ((1, 0), (20, 0.5), (40, 0), (60, -0.5), (80, 0)):\n"
        "    key(sled, frame, rotation_euler=(0, turn, 0))"
    )
    far = 2 * 2 * 0.2474  # the chord of half a radian about a point two metres above
    swing = phase("Sled", "swing", 1, 80, amplitude=far, turn=28.65, direction=(-0.97, 0, 0.25))
    assert judged(session, "T4", script, swing).passed == ("T4",)
    report = verified(session, "T4", a_motion({**swing, "amplitude": 1.2, "turn": 45}, last=120))
    amplitude, turn = report.findings
    assert amplitude.measured == pytest.approx(far, rel=0.01)
    assert turn.measured == pytest.approx(28.65, abs=0.1)


def test_a_cloth_goes_as_far_as_its_points_on_average(session: LiveSession) -> None:
    drape = phase("Flag", "deform", 1, 20, extent=5)
    finding = the_finding(judged(session, "T4", CURTAIN, drape, roles={"Flag": "cloth"}, last=20))
    way = session.run(
        """
import numpy
def places(frame):
    bpy.context.scene.frame_set(frame)
    mesh = bpy.data.objects["Cloth"].evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return numpy.array([tuple(vertex.co) for vertex in mesh.vertices])
first, last = places(1), places(20)
# Of an even grid, a corner has a quarter of an inner vertex's surface, a vertex of the border half of it.
mesh = bpy.data.objects["Cloth"].data
faces = numpy.bincount([corner.vertex_index for corner in mesh.loops])
ways = last - first
float(numpy.average(numpy.linalg.norm(ways, axis=1), weights=faces)), float(
    numpy.linalg.norm(numpy.average(ways, axis=0, weights=faces)))
"""
    )
    assert finding.measured == pytest.approx(way[0], rel=1e-3)
    assert way[0] > 1.02 * way[1]  # its two ends come nearer to each other


# T6: falls


@pytest.mark.parametrize("height", [1.2, 3, 12])
def test_a_body_falls_as_gravity_has_it(session: LiveSession, height: float) -> None:
    script = DROP.replace("HEIGHT", str(height)) + RIGID
    found = judged(session, "T6", script, phase("Crate", "fall", 1, 50), roles=ROLES, last=60)
    assert found.passed == ("T6",), [one.message for one in found.findings]


def keyed_fall(share: float) -> str:
    """A fall with a share of gravity, keyed frame by frame."""
    return DROP.replace("HEIGHT", "5") + (
        "for frame in range(1, 22):\n"
        f"    key(crate, frame, location=(0, 0, 5 - {share} * 9.81 / 2 * ((frame - 1) / 24) ** 2))\n"
    )


@pytest.mark.parametrize(("share", "holds"), [(0.91, True), (0.89, False), (1.09, True), (1.11, False)])
def test_a_fall_is_a_tenth_faster_or_slower_at_most(session: LiveSession, share: float, holds: bool) -> None:
    found = judged(session, "T6", keyed_fall(share), phase("Crate", "fall", 1, 21), roles=ROLES, last=60)
    if finding := broken(found, "T6", holds):
        assert (finding.measured, finding.unit) == (pytest.approx(share * G, rel=0.01), "m/s²")
        assert finding.tolerance == pytest.approx(G / 10, rel=1e-4)


@pytest.mark.parametrize("interpolation", ["LINEAR", "BEZIER"])
def test_two_keys_make_no_fall(session: LiveSession, interpolation: str) -> None:
    script = DROP.replace("HEIGHT", "5") + (
        "key(crate, 1, location=(0, 0, 5))\nkey(crate, 24, location=(0, 0, 0.5))\n"
        + ("linear(crate)" if interpolation == "LINEAR" else "")
    )
    finding = the_finding(judged(session, "T6", script, phase("Crate", "fall", 1, 24), roles=ROLES, last=60))
    assert finding.objects == ("Crate",)
    if interpolation == "LINEAR":
        assert finding.measured == pytest.approx(0, abs=0.01)
    else:
        assert finding.measured is not None
        assert abs(finding.measured - G) > 0.2 * G


def test_on_the_moon_things_fall_as_on_the_moon(session: LiveSession) -> None:
    script = DROP.replace("HEIGHT", "2") + RIGID + "scene.gravity = (0, 0, -1.62)"
    found = judged(session, "T6", script, phase("Crate", "fall", 1, 30), roles=ROLES, last=60)
    assert found.passed == ("T6",)


def test_a_fall_that_is_too_short_to_be_told_is_undecided(session: LiveSession) -> None:
    script = DROP.replace("HEIGHT", "0.51") + RIGID
    fall = phase("Crate", "fall", 1, 10)
    found = judged(session, "T6", script, fall, roles=ROLES, last=60)
    finding = the_finding(found)
    assert (finding.outcome, finding.objects) == ("undecided", ("Crate",))
    assert finding.fix.startswith("Let it fall freely")


# T6: tunnels


@pytest.mark.parametrize(("depth", "holds"), [(0.045, True), (0.055, False)])
def test_what_lands_may_be_a_twentieth_deep(session: LiveSession, depth: float, holds: bool) -> None:
    script = DROP.replace("HEIGHT", "2") + (
        f"key(crate, 1, location=(0, 0, 2))\nkey(crate, 21, location=(0, 0, {0.5 - depth}))\n"
        "key(crate, 25, location=(0, 0, 0.5))"
    )
    land = phase("Crate", "translate", 1, 25)
    found = judged(session, "T6", script, land, roles=ROLES, last=60)
    if finding := broken(found, "T6", holds):
        assert finding.objects == ("Crate", "Floor")
        assert (finding.measured, finding.frame) == (pytest.approx(depth, abs=1e-3), 21)
        assert finding.tolerance == pytest.approx(0.05)


@pytest.mark.parametrize(("deeper", "holds"), [(0.045, True), (0.055, False)])
def test_how_deep_a_thing_is_declared_to_be_from_the_first_frame_on_is_no_passage(
    session: LiveSession, deeper: float, holds: bool
) -> None:
    """As a hinge's sleeve is around the leaf that turns in it."""
    script = DROP.replace("HEIGHT", "0.4") + (
        "crate['contact_with'] = ['Slab']\n"
        f"key(crate, 1, location=(0, 0, 0.4))\nkey(crate, 21, location=(0.3, 0, {0.4 - deeper}))"
    )
    found = judged(session, "T6", script, phase("Crate", "translate", 1, 25), roles=ROLES, last=60)
    if finding := broken(found, "T6", holds):
        assert finding.measured == pytest.approx(0.1 + deeper, abs=1e-3)


@pytest.mark.parametrize("floor", ["plane", "slab"])
def test_what_is_above_at_one_frame_and_below_at_the_next_went_through(
    session: LiveSession, floor: str
) -> None:
    made = 'plane("Slab", (-9, -9), (9, 9))' if floor == "plane" else 'box("Slab", (-9, -9, -0.1), (9, 9, 0))'
    script = f"""
scene.frame_start, scene.frame_end = 1, 60
thing("Floor", {made}, system_name="ground")
thing("Shot", ball("Lead", 0.2, at=(0, 0, 8)), at=(0, 0, 8))
key(bpy.data.objects["Shot root"], 1, location=(0, 0, 8))
key(bpy.data.objects["Shot root"], 11, location=(0, 0, -7.3))
linear(bpy.data.objects["Shot root"])
"""
    found = judged(
        session, "T6", script, phase("Shot", "translate", 1, 11), roles={"Floor": "ground", "Shot": "rigid"}
    )
    finding = the_finding(found)
    assert finding.objects == ("Shot", "Floor")
    assert finding.frame == 7  # from 0.35 m above to 1.18 m below
    assert "passes through 'Floor' within a frame" in finding.message
    assert 0.98 <= (finding.measured or 0) <= 1.4


def test_of_what_has_several_meshes_those_are_named_that_meet(session: LiveSession) -> None:
    script = """
scene.frame_start, scene.frame_end = 1, 30
thing("Floor", box("Slab", (-9, -9, -1), (9, 9, 0)), box("Post", (-9, -9, 0), (-8, -8, 1)), system_name="ground")
root = thing("Dumbbell", box("Low", (0, 0, 0.2), (1, 1, 1.2)), box("High", (0, 0, 3), (1, 1, 4)))
key(root, 1, location=(0, 0, 0))
key(root, 25, location=(0, 0, -0.5))
"""
    roles = {"Floor": "ground", "Dumbbell": "rigid"}
    finding = the_finding(
        judged(session, "T6", script, phase("Dumbbell", "translate", 1, 25), roles=roles, last=30)
    )
    assert finding.objects == ("Dumbbell", "Floor")
    assert "'Dumbbell' ('Low') gets 0.300 m deep into 'Floor' ('Slab')." in finding.message


def test_what_sinks_slowly_through_a_plane_is_in_it(session: LiveSession) -> None:
    script = """
scene.frame_start, scene.frame_end = 1, 60
thing("Floor", plane("Slab", (-9, -9), (9, 9)), system_name="ground")
root = thing("Shot", ball("Lead", 0.2, at=(0, 0, 1)), at=(0, 0, 1))
key(root, 1, location=(0, 0, 1))
key(root, 60, location=(0, 0, -1))
"""
    roles = {"Floor": "ground", "Shot": "rigid"}
    finding = the_finding(
        judged(session, "T6", script, phase("Shot", "translate", 1, 60), roles=roles, last=60)
    )
    assert finding.measured == pytest.approx(0.2, abs=0.03)  # half of it on either side


def test_a_marble_in_a_bowl_is_in_its_hollow_and_not_in_its_clay(session: LiveSession) -> None:
    script = """
scene.frame_start, scene.frame_end = 1, 60
bowl = lathe("Clay", [(0, -0.1), (0.6, 0), (1, 0.5), (0.9, 0.5), (0.55, 0.1), (0, 0)])
thing("Bowl", bowl, system_name="ground")
marble = ball("Glass", 0.1, at=(0.5, 0, 0.8))
thing("Marble", marble)
rigid(bowl, "PASSIVE", collision_shape="MESH", friction=0.2)
rigid(marble, collision_shape="SPHERE", friction=0.2)
scene.rigidbody_world.substeps_per_frame = 30
"""
    roles = {"Bowl": "ground", "Marble": "rigid"}
    roll = phase("Marble", "roll", 1, 60)
    found = judged(session, "T6", script, roll, roles=roles, last=60)
    assert found.passed == ("T6",), [one.message for one in found.findings]


def test_what_the_plan_sinks_into_a_ground_may_be_in_it(session: LiveSession) -> None:
    script = f"{SLED}\n{FLOOR}\nslide(20, 40)"
    roles = {"Floor": "ground", "Sled": "keyframed"}
    slide = phase("Sled", "translate", 20, 40)
    finding = the_finding(judged(session, "T6", script, slide, roles=roles))
    assert finding.measured == pytest.approx(0.5, abs=0.02)
    sunk = {"kind": "EmbeddedIn", "part": "Sled", "host": "Floor", "depth": 0.5}
    plan = a_motion(slide, last=120, roles=roles, relations=(sunk,))
    assert verified(session, "T6", plan).passed == ("T6",)


def test_a_wall_that_is_to_be_touched_stops_what_touches_it(session: LiveSession) -> None:
    script = f'{SLED}\nthing("Wall", box("Bricks", (2, -1, -1), (2.2, 1, 1)))\nslide(20, 40, way=2)'
    slide, roles = phase("Sled", "translate", 20, 40), {"Wall": "static", "Sled": "keyframed"}
    assert judged(session, "T6", script, slide, roles=roles).passed == ("T6",)
    leans = {"kind": "StableAgainst", "child": "Sled", "parent": "Wall"}
    plan = a_motion(slide, last=120, roles=roles, relations=(leans,))
    finding = the_finding(verified(session, "T6", plan))
    assert finding.objects == ("Sled", "Wall")
    assert finding.measured == pytest.approx(0.5, abs=0.05)  # the wall is halfway into it


# T6: jumps


@pytest.mark.parametrize(("jump", "holds"), [(0.24, True), (0.26, False)])
def test_a_step_is_half_as_long_again_as_planned_at_most(
    session: LiveSession, jump: float, holds: bool
) -> None:
    # At 4 m/s and 24 frames a second a step is a sixth of a metre.
    script = f"{SLED}\nslide(20, 29)\nkey(sled, 30, location=(1 + {jump}, 0, 0))\nlinear(sled)"
    found = judged(session, "T6", script, phase("Sled", "translate", 20, 40, top_speed=4))
    if finding := broken(found, "T6", holds):
        assert (finding.measured, finding.tolerance, finding.frame) == (
            pytest.approx(jump, abs=1e-4),
            pytest.approx(0.25),
            30,
        )


def test_a_leap_is_more_than_any_planned_way_explains(session: LiveSession) -> None:
    script = f"{SLED}\nslide(20, 39, way=0.5)\nkey(sled, 40, location=(3, 0, 0))\nlinear(sled)"
    slide = phase("Sled", "translate", 20, 60, extent=3)
    finding = the_finding(judged(session, "T6", script, slide))
    assert (finding.measured, finding.frame) == (pytest.approx(2.5, abs=1e-3), 40)
    assert finding.tolerance == pytest.approx(1.5 * 2 * 3 / 40)  # twice the mean speed, half as much again


# T7: rest


@pytest.mark.parametrize(("speed", "holds"), [(0.009, True), (0.011, False)])
def test_what_settles_is_slower_than_a_centimetre_a_second(
    session: LiveSession, speed: float, holds: bool
) -> None:
    script = f"{SLED}\nslide(1, 120, way={speed} * 119 / 24)"
    found = judged(session, "T7", script, phase("Sled", "settle", 20, 120))
    if finding := broken(found, "T7", holds):
        assert finding.objects == ("Sled",)
        assert (finding.measured, finding.tolerance) == (pytest.approx(speed, rel=1e-3), pytest.approx(0.01))


def test_a_large_thing_may_be_faster_in_proportion(session: LiveSession) -> None:
    script = f"{SLED}\nbpy.data.objects['Runner'].data.transform(Matrix.Scale(3, 4))\nslide(1, 120, way=0.1)"
    assert judged(session, "T7", script, phase("Sled", "settle", 20, 120)).passed == ("T7",)


@pytest.mark.parametrize(("stops", "holds"), [(96, True), (99, False)])
def test_rest_is_asked_for_in_the_last_second_only(session: LiveSession, stops: int, holds: bool) -> None:
    found = judged(session, "T7", f"{SLED}\nslide(20, {stops})", phase("Sled", "settle", 20, 120))
    if finding := broken(found, "T7", holds):
        assert finding.frame in range(97, 100)


@pytest.mark.parametrize(("stops", "holds"), [(55, True), (58, False)])
def test_rest_is_asked_for_in_the_last_quarter_of_a_short_phase(
    session: LiveSession, stops: int, holds: bool
) -> None:
    found = judged(session, "T7", f"{SLED}\nslide(20, {stops})", phase("Sled", "settle", 40, 60))
    broken(found, "T7", holds)


@pytest.mark.parametrize(("rate", "holds"), [(0.095, True), (0.105, False)])
def test_what_settles_turns_by_a_tenth_of_a_radian_a_second_at_most(
    session: LiveSession, rate: float, holds: bool
) -> None:
    script = f"{SLED}\nkey(sled, 1, rotation_euler=(0, 0, 0))\n" + (
        f"key(sled, 120, rotation_euler=(0, 0, {rate} * 119 / 24))\nlinear(sled)"
    )
    found = judged(session, "T7", script, phase("Sled", "settle", 20, 120))
    if finding := broken(found, "T7", holds):
        assert (finding.measured, finding.unit) == (pytest.approx(rate, rel=1e-3), "rad/s")


def test_a_body_that_lands_comes_to_rest_but_not_while_it_falls(session: LiveSession) -> None:
    script = DROP.replace("HEIGHT", "2") + RIGID
    found = judged(session, "T7", script, phase("Crate", "settle", 13, 60), roles=ROLES, last=60)
    assert found.passed == ("T7",)
    early = verified(session, "T7", a_motion(phase("Crate", "settle", 5, 13), roles=ROLES))
    assert the_finding(early).measured == pytest.approx(
        G * 11.5 / 24, rel=0.03
    )  # it has fallen for half a second


def test_a_cloth_that_still_swings_is_not_at_rest(session: LiveSession) -> None:
    settle = phase("Flag", "settle", 1, 20)
    finding = the_finding(judged(session, "T7", CURTAIN, settle, roles={"Flag": "cloth"}, last=20))
    assert "its points move at" in finding.message
    assert (finding.measured or 0) > 0.5


@pytest.mark.parametrize(("way", "holds"), [(0.008, True), (0.03, False)])
def test_what_is_held_does_not_drift(session: LiveSession, way: float, holds: bool) -> None:
    found = judged(session, "T7", f"{SLED}\nslide(20, 119, way={way})", phase("Sled", "hold", 20, 119))
    if finding := broken(found, "T7", holds):
        assert finding.measured == pytest.approx(way, abs=1e-4)
        assert "drifts" in finding.message


# What cannot be told


def test_a_missing_actor_is_named_and_no_other_one_is_hidden_by_it(session: LiveSession) -> None:
    script = f"{SLED}\nslide(30, 40)"
    phases = phase("Ghost", "translate", 20, 40), phase("Sled", "translate", 20, 40)
    ghost, sled = judged(session, "T2", script, *phases).findings
    assert (ghost.outcome, ghost.objects) == ("undecided", ("Ghost",))
    assert (sled.outcome, sled.measured) == ("broken", 10)


def test_half_a_turn_a_frame_cannot_be_told_from_the_other_way_round(session: LiveSession) -> None:
    script = f"{SLED}\nkey(sled, 1, rotation_euler=(0, 0, 0))\nkey(sled, 21, rotation_euler=(0, 0, 60))\nlinear(sled)"
    finding = the_finding(judged(session, "T4", script, phase("Sled", "rotate", 1, 21, turn=3438)))
    assert finding.outcome == "undecided"
    assert "turns so far in a frame" in finding.message


def test_a_timeline_that_is_too_long_is_refused_and_not_passed(session: LiveSession) -> None:
    found = judged(session, "T2", f"{SLED}\nslide(20, 40)", phase("Sled", "translate", 20, 40), last=9000)
    finding = the_finding(found)
    assert finding.outcome == "undecided"
    assert "9000 frames would have to be visited" in finding.message


def test_what_is_not_baked_is_stepped_and_the_scene_left_at_its_frame(session: LiveSession) -> None:
    build(session, DROP.replace("HEIGHT", "3") + RIGID + "scene.frame_set(5)")
    plan = a_motion(phase("Crate", "fall", 1, 30), phase("Crate", "settle", 31, 60), roles=ROLES)
    found = verified(session, "T2,T6,T7", plan)
    assert found.passed == ("T2", "T6", "T7"), [one.message for one in found.findings]
    assert session.run("bpy.context.scene.frame_current") == 5


def test_what_a_jump_left_behind_is_not_taken_for_a_simulation(session: LiveSession) -> None:
    plan = a_motion(phase("Flag", "deform", 1, 20, extent=5), roles={"Flag": "cloth"}, last=20)
    ways: list[float | None] = []
    for jump in ("", "scene.frame_set(1)\nscene.frame_set(20)"):
        session.empty()
        build(session, f"{CURTAIN}\nbpy.context.view_layer.update()\n{jump}")
        ways.append(the_finding(verified(session, "T4", plan)).measured)
    assert ways[0] == pytest.approx(ways[1], rel=1e-3)


# What a finding says a motion comes from


HIT = """
scene.frame_start, scene.frame_end = 1, 40
scene.gravity = (0, 0, 0)
rod = thing("Rod", box("Nose", (-1, -0.1, -0.1), (0, 0.1, 0.1)))
face = box("Face", (-0.05, -0.1, -0.5), (0.05, 0.1, 0.5), at=(0.05, 0, 0))
thing("Tile", face)
key(rod, 1, location=(-1, 0, 0))
key(rod, 21, location=(0.5, 0, 0))
linear(rod)
nose = bpy.data.objects["Nose"]
rigid(nose, "PASSIVE", kinematic=True)
rigid(face)
"""
HIT_ROLES = {"Rod": "keyframed", "Tile": "rigid"}
PUSHED = {"name": "push", **phase("Rod", "translate", 1, 21)}


def test_a_cause_that_arrives_too_early_is_told(session: LiveSession) -> None:
    """The rod comes 7.5 cm nearer a frame, and touches between frames 14 and 15."""
    build(session, HIT)
    session.use(BAKE)
    rest = phase("Tile", "hold", 1, 24)
    slide = {"name": "slide", **phase("Tile", "slide", 24, 40, cause="push", extent=9.0)}
    made = a_motion(PUSHED, rest, slide, roles=HIT_ROLES, last=40)
    for rule in ("T2", "T7"):
        finding = next(one for one in verified(session, rule, made).findings if one.rule == rule)
        assert "touches it at frame 15" in finding.message
        assert finding.fix.startswith("Let 'Rod' arrive at frame 24")
    assert "It moves from frame 15 on." in finding.message
    (far,) = verified(session, "T4", made).findings
    assert "keyframe" not in far.fix


def test_a_body_that_its_margins_lift_is_told_as_the_simulation_begins(session: LiveSession) -> None:
    script = DROP.replace("HEIGHT", "0.5") + RIGID
    script += "for one in (crate, bpy.data.objects['Slab']):\n    one.rigid_body.collision_margin = 0.001\n"
    finding = the_finding(judged(session, "T7", script, phase("Crate", "hold", 1, 20), roles=ROLES, last=60))
    assert "It moves at frame 2, as the simulation begins." in finding.message
    assert "`collision_margin` 0" in finding.fix
