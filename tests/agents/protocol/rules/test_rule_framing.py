"""R14 and W6: what the camera shows, measured against what its lens takes in."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import pytest
from scenes import a_plan, build, the_finding, verified

from agents.plan.arithmetic import doubts_of

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.plan.part import Vector
    from agents.plan.scene import ScenePlan
    from agents.protocol.findings import Report

pytestmark = pytest.mark.blender

# Ten metres away a lens of 50 mm before 36 mm of film takes in 7.2 m, and in 16:9 a height of 4.05 m.
WIDE, HIGH = 7.2, 4.05
STAGE = """
scene.render.resolution_x, scene.render.resolution_y = 1920, 1080
camera((0, -10, 0), (0, 0, 0))

def sheet(name, left, right, low, high, y=0, **more):
    points = [(left, y, low), (right, y, low), (right, y, high), (left, y, high)]
    return thing(name, mesh(name + " mesh", points, [(0, 1, 2, 3)]), **more)
"""


def plan(*subjects: str, **more: Any) -> ScenePlan:
    objects = [
        {"name": name, "systems": ["set"], "dimensions": (1, 1, 1), "position": (0, 0, 0)}
        for name in subjects
    ]
    camera = {"position": (0, -10, 0), "target": (0, 0, 0), "subjects": subjects}
    return a_plan(objects=objects, camera=camera, **more)


def seen(session: LiveSession, script: str, *subjects: str, **more: Any) -> Report:
    build(session, STAGE + script)
    return verified(session, "R14", plan(*subjects, **more))


def test_what_stands_in_the_middle_of_the_picture_is_framed(session: LiveSession) -> None:
    found = seen(session, "thing('Crate', box('Case', (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)))", "Crate")
    assert found.passed == ("R14",)


CRATE = "box('Case', (-0.15, -0.25, 0), (0.15, 0.25, 0.4), at={at}, turn={turn})"


@pytest.mark.parametrize(("at", "turn"), [((2, 1, -0.5), (0, 0, 30)), ((-1, 3, 1), (20, 40, 70))])
def test_the_plan_is_doubted_by_just_as_much_as_is_measured_when_it_is_built(
    session: LiveSession, at: Vector, turn: Vector
) -> None:
    build(session, f"{STAGE}\nthing('Crate', {CRATE.format(at=at, turn=turn)}, at={at}, turn={turn})")
    planned = a_plan(
        objects=[
            {
                "name": "Crate",
                "systems": ["set"],
                "dimensions": (0.3, 0.5, 0.4),
                "position": at,
                "rotation": turn,
            }
        ],
        camera={"position": (0, -10, 0), "target": (0, 0, 0), "lens": 50, "subjects": ["Crate"]},
        render={"kind": "still", "resolution": (1920, 1080)},
    )
    measured = the_finding(verified(session, "R14", planned)).measured
    (doubt,) = doubts_of(planned)
    told = re.search(r"fills at most ([\d.]+)%", doubt.message)
    assert measured is not None
    assert told is not None
    assert measured * 0.995 <= float(told[1]) / 100 <= measured * 1.03


@pytest.mark.parametrize(("outside", "framed"), [(0.19, True), (0.21, False)])
def test_a_fifth_of_a_subject_may_be_outside_of_the_picture(
    session: LiveSession, outside: float, framed: bool
) -> None:
    right = WIDE / 2 + outside
    found = seen(session, f"sheet('Poster', {right - 1}, {right}, -0.5, 0.5)", "Poster")
    assert (found.passed == ("R14",)) == framed
    if not framed:
        finding = the_finding(found)
        assert finding.objects == ("Poster", "Camera")
        assert finding.measured == pytest.approx(outside, abs=0.005)
        assert finding.tolerance == pytest.approx(0.2)


@pytest.mark.parametrize(("cover", "framed"), [(0.0101, True), (0.0099, False)])
def test_a_subject_covers_a_hundredth_of_the_picture(
    session: LiveSession, cover: float, framed: bool
) -> None:
    half = (cover * WIDE * HIGH) ** 0.5 / 2
    found = seen(session, f"sheet('Stamp', {-half}, {half}, {-half}, {half})", "Stamp")
    assert (found.passed == ("R14",)) == framed
    if not framed:
        assert the_finding(found).measured == pytest.approx(cover, rel=1e-3)
        assert the_finding(found).objects == ("Stamp", "Camera")


@pytest.mark.parametrize(("hidden", "framed"), [(0.48, True), (0.52, False)])
def test_half_of_a_subject_may_be_hidden(session: LiveSession, hidden: float, framed: bool) -> None:
    # Half as far away, half as wide: the wall's edge hides what is behind it up to twice as far out.
    edge = (hidden - 0.5) / 2
    found = seen(
        session,
        f"sheet('Poster', -0.5, 0.5, -0.5, 0.5)\nsheet('Wall', -3, {edge}, -2, 2, y=-5)\n",
        "Poster",
    )
    assert (found.passed == ("R14",)) == framed
    if not framed:
        finding = the_finding(found)
        assert finding.objects == ("Poster", "Wall mesh", "Camera")
        assert finding.measured == pytest.approx(hidden, abs=0.005)
        assert finding.at == pytest.approx((0, 0, 0), abs=0.02)


GLASS = """
glass = bpy.data.materials.new("Glass")
glass.node_tree.nodes["Principled BSDF"].inputs["Transmission Weight"].default_value = 1
bpy.data.objects["Wall mesh"].data.materials.append(glass)
"""


@pytest.mark.parametrize(
    ("why", "hides"),
    [
        ("", True),
        ("bpy.data.objects['Wall mesh'].hide_render = True", False),
        ("bpy.data.collections['Wall'].hide_render = True", False),
        (GLASS, False),
        (GLASS + "glass.node_tree.nodes['Principled BSDF'].inputs[0].default_value = (1, 0, 0, 1)", False),
        (GLASS.replace("value = 1", "value = 0"), True),
    ],
    ids=["a wall", "not rendered", "collection not rendered", "glass", "red glass", "no glass"],
)
def test_only_what_is_rendered_and_opaque_hides(session: LiveSession, why: str, hides: bool) -> None:
    build(session, STAGE + "sheet('Poster', -0.5, 0.5, -0.5, 0.5)\nsheet('Wall', -3, 3, -2, 2, y=-5)\n" + why)
    found = verified(session, "R14", plan("Poster"))
    assert bool(found.findings) == hides
    if hides:
        assert the_finding(found).measured == 1.0


def test_a_thing_does_not_hide_itself_nor_do_its_instances(session: LiveSession) -> None:
    script = """
makers = [plane("Seats", (-1, -1), (1, 1), turn=(90, 0, 0))]
copy = box("Copy", (-0.8, -0.8, -0.8), (0.8, 0.8, 0.8))
thing("Crowd", *makers)
scene.collection.objects.link(copy)
copy.parent, makers[0].instance_type = makers[0], "VERTS"
"""
    assert seen(session, script, "Crowd").passed == ("R14",)


def test_a_fountain_is_seen_with_its_drops_as_soon_as_there_are_any(session: LiveSession) -> None:
    script = """
scene.frame_end = 41
basin = plane("Basin", (-0.5, -0.5), (0.5, 0.5), turn=(90, 0, 0))
thing("Fountain", basin)
basin.modifiers.new("Drops", "PARTICLE_SYSTEM")
drops = basin.particle_systems[0].settings
drops.count, drops.frame_start, drops.frame_end, drops.lifetime = 1000, 5, 10, 100
drops.normal_factor, drops.object_align_factor = 0, (40, 0, 0)
scene.gravity = (0, 0, 0)
"""
    # A thousand samples of the basin, which stays, and a thousand drops, which fly out of the picture.
    finding = the_finding(seen(session, script, "Fountain", render={"kind": "animation"}))
    assert (finding.frame, finding.measured) == (21, pytest.approx(0.5, abs=0.02))
    session.run("bpy.data.objects['Basin'].show_instancer_for_render = False")
    finding = the_finding(verified(session, "R14", plan("Fountain", render={"kind": "animation"})))
    assert finding.measured == 1.0


def test_behind_an_orthographic_camera_nothing_is_seen(session: LiveSession) -> None:
    script = """
scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 4
sheet("Before", -0.5, 0.5, -0.5, 0.5)
sheet("Beside", 1.7, 2.7, -0.5, 0.5)
sheet("Behind", -0.5, 0.5, -0.5, 0.5, y=-12)
"""
    found = seen(session, script, "Before", "Beside", "Behind")
    told = {finding.objects[0]: finding.measured for finding in found.findings}
    assert told == {"Beside": pytest.approx(0.7, abs=0.01), "Behind": 1.0}


def test_what_leaves_the_picture_is_told_with_the_frame(session: LiveSession) -> None:
    script = """
scene.frame_end = 41
root = sheet("Kite", -0.5, 0.5, -0.5, 0.5)
key(root, 1, location=(0, 0, 0))
key(root, 41, location=(4, 0, 0))
linear(root)
scene.frame_set(7)
"""
    found = seen(session, script, "Kite")
    finding = the_finding(found)
    assert (finding.frame, finding.measured) == (41, pytest.approx(0.9, abs=0.005))
    assert session.run("bpy.context.scene.frame_current") == 7


def test_a_wall_that_moves_in_is_seen_in_the_middle(session: LiveSession) -> None:
    script = """
scene.frame_end = 41
sheet("Poster", -0.5, 0.5, -0.5, 0.5)
root = sheet("Wall", -3, 3, -2, 2, y=-5)
for frame, x in ((1, 9), (21, 0), (41, 9)):
    key(root, frame, location=(x, 0, 0))
"""
    finding = the_finding(seen(session, script, "Poster"))
    assert (finding.frame, finding.measured, finding.objects[1]) == (21, 1.0, "Wall mesh")


def test_without_an_active_camera_nothing_is_framed(session: LiveSession) -> None:
    finding = the_finding(seen(session, "sheet('Poster', -1, 1, -1, 1)\nscene.camera = None", "Poster"))
    assert (finding.outcome, finding.message) == ("broken", "The scene has no active camera.")


@pytest.mark.parametrize(
    ("script", "reason"),
    [
        ("", "no object is named 'Poster'"),
        ("sheet('Poster', -1, 1, -1, 1)\nscene.camera.data.type = 'PANO'", "panoramic"),
        ("sheet('Poster', 1, 1, -1, 1)", "no area"),
    ],
)
def test_what_cannot_be_told_is_undecided(session: LiveSession, script: str, reason: str) -> None:
    finding = the_finding(seen(session, script, "Poster"))
    assert finding.outcome == "undecided"
    assert reason in finding.message


def test_a_plan_without_subjects_leaves_the_camera_alone(session: LiveSession) -> None:
    build(session, STAGE)
    relation = {"kind": "Upright", "a": "Poster"}
    assert verified(session, "R14", a_plan(relation)).not_applicable == {
        "R14": "the plan names no subjects of the camera"
    }


# What sets another in motion

TWO = """
scene.frame_end = 40
sheet('Cue', -1.5, -0.5, -0.5, 0.5)
sheet('Eight', 0.5, 1.5, -0.5, 0.5)
"""


def hit(*, subjects: tuple[str, ...] = ("Cue", "Eight"), start: int = 20, **more: Any) -> ScenePlan:
    phases = (
        {"name": "roll", "actor": "Cue", "kind": "translate", "start": 1, "end": 20},
        {"name": "away", "actor": "Eight", "kind": "translate", "start": start, "end": 60, **more},
    )
    made = plan("Cue", "Eight", frame_end=60, motion={"phases": phases})
    return made.model_copy(update={"camera": made.camera.model_copy(update={"subjects": subjects})})


@pytest.mark.parametrize(
    ("script", "shown", "why"),
    [
        ("", None, ""),
        ("sheet('Wall', 0.2, 0.45, -2, 2, y=-5)", None, ""),
        ("sheet('Wall', 0.2, 0.55, -2, 2, y=-5)", "40% of 'Eight'", "60% is hidden, mostly by 'Wall mesh'."),
        ("bpy.data.objects['Camera'].location.x = -4", "10% of 'Eight'", "90% is outside the picture."),
    ],
    ids=["nothing", "two fifths", "three fifths", "outside"],
)
def test_who_is_hit_is_to_be_seen_as_it_is_hit(
    session: LiveSession, script: str, shown: str | None, why: str
) -> None:
    build(session, STAGE + TWO + script)
    found = verified(session, "W6", hit(cause="roll"))
    if shown is None:
        assert found.passed == ("W6",)
    else:
        (finding,) = (one for one in found.findings if "'Eight':" in one.message)
        assert finding.severity == "soft"
        assert finding.frame == 20
        assert finding.message.startswith("motion.phases[1] ('away'): 'Eight' begins at frame 20")
        assert shown in finding.message
        assert finding.message.endswith(why)


@pytest.mark.parametrize("more", [{}, {"cause": "roll", "subjects": ()}, {"cause": "roll", "start": 50}])
def test_only_subjects_that_set_each_other_in_motion_are_looked_at(
    session: LiveSession, more: dict[str, Any]
) -> None:
    build(session, STAGE + TWO)
    assert "W6" in verified(session, "W6", hit(**more)).not_applicable
