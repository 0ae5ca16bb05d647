"""R15: what is declared to move an object does. T1: the timeline is the planned one, all of it baked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from scenes import a_motion, a_plan, build, the_finding, verified

from agents.blender.tools.bake import TOOL as BAKE

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.protocol.findings import Finding, Report

pytestmark = pytest.mark.blender

LAST = 12

DECLARED = """
def curves(one):
    return one.animation_data.action.layers[0].strips[0].channelbags[0].fcurves

def declared(name, deformation, motion):
    one = bpy.data.collections[name]
    one["deformation_kind"], one["motion_kind"] = deformation, motion
"""
# Each makes a mesh "Body" of an object "Actor" that its solver moves.
SOLVED = {
    "sim_rigid": """
rigid(box("Slab", (-1, -1, -0.1), (1, 1, 0)), "PASSIVE")
body = box("Body", (-0.1, -0.1, -0.1), (0.1, 0.1, 0.1), at=(0, 0, 0.6))
thing("Actor", body)
rigid(body)
""",
    "sim_cloth": """
shape = bmesh.new()
bmesh.ops.create_grid(shape, x_segments=4, y_segments=4, size=0.5)
data = bpy.data.meshes.new("Body")
shape.to_mesh(data)
body = bpy.data.objects.new("Body", data)
thing("Actor", body)
body.modifiers.new("Cloth", "CLOTH")
""",
    "sim_soft": """
body = ball("Body", 0.2, at=(0, 0, 1), segments=8)
thing("Actor", body)
body.modifiers.new("Softbody", "SOFT_BODY").settings.use_goal = False
""",
    "sim_particle": """
body = plane("Body", (-0.5, -0.5), (0.5, 0.5), at=(0, 0, 1))
thing("Actor", body)
body.modifiers.new("Rain", "PARTICLE_SYSTEM")
rain = body.particle_systems[0].settings
rain.count, rain.frame_start, rain.frame_end, rain.lifetime = 20, 1, 8, 50
""",
    "sim_fluid": """
body = box("Body", (-0.5, -0.5, 0), (0.5, 0.5, 1))
drop = box("Drop", (-0.2, -0.2, 0.4), (0.2, 0.2, 0.8))
thing("Actor", body, drop)
domain = body.modifiers.new("Fluid", "FLUID")
domain.fluid_type = "DOMAIN"
settings = domain.domain_settings
settings.domain_type, settings.resolution_max, settings.use_mesh = "LIQUID", 12, False
flow = drop.modifiers.new("Fluid", "FLUID")
flow.fluid_type = "FLOW"
flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = "LIQUID", "GEOMETRY"
""",
}
NAMED = {
    "sim_rigid": "active rigid body",
    "sim_cloth": "cloth modifier",
    "sim_soft": "soft-body modifier",
    "sim_particle": "particle system",
    "sim_fluid": "fluid domain or flow",
}
UNSOLVED = """
if body.rigid_body:
    with bpy.context.temp_override(object=body, active_object=body, selected_objects=[body]):
        bpy.ops.rigidbody.object_remove()
body.modifiers.clear()
"""


def make(
    session: LiveSession, script: str, kind: str = "", motion: str = "bake", *, baked: bool = False
) -> None:
    """An object "Actor" by a script; of a solver's ``kind`` alone, by that of the solver."""
    declared = f"declared('Actor', {kind!r}, {motion!r})" if kind else ""
    build(session, f"{DECLARED}\nscene.frame_start, scene.frame_end = 1, {LAST}\n{script}\n{declared}")
    if baked:
        session.use(BAKE)


def mechanism(session: LiveSession) -> Report:
    return verified(session, "R15,R19")


def the_breach(session: LiveSession) -> Finding:
    found = the_finding(mechanism(session))
    assert (found.severity, found.outcome) == ("hard", "broken")
    return found


# Solvers


@pytest.mark.parametrize("kind", SOLVED)
def test_a_baked_simulation_is_what_it_is_declared_to_be_and_its_twin_is_not(
    session: LiveSession, kind: str
) -> None:
    make(session, SOLVED[kind], kind, baked=True)
    assert mechanism(session).passed == ("R15", "R19")
    session.run(f"""
body = bpy.data.objects["Body"]
{UNSOLVED}
for frame in range(1, {LAST + 1}):
    body.location.z = 1 - 0.004 * frame**2
    body.keyframe_insert("location", frame=frame)
for one in bpy.data.objects:
    one.modifiers.clear()
""")
    found = the_breach(session)
    assert found.objects == ("Actor",)
    assert f"declared {kind}, but has no {NAMED[kind]} that is on" in found.message


@pytest.mark.parametrize("kind", SOLVED)
def test_what_is_not_baked_is_told(session: LiveSession, kind: str) -> None:
    make(session, SOLVED[kind], kind)
    found = the_breach(session)
    assert found.objects[0] == "Actor"
    assert "is not baked" in found.message
    assert "blender_bake" in found.fix


@pytest.mark.parametrize("kind", ["sim_rigid", "sim_cloth", "sim_soft", "sim_fluid"])
def test_shape_keys_on_what_is_simulated_imitate_it(session: LiveSession, kind: str) -> None:
    make(session, SOLVED[kind], kind, baked=True)
    session.run("""
body = bpy.data.objects["Body"]
body.shape_key_add(name="Basis")
shape = body.shape_key_add(name="Fallen")
for value, frame in ((0, 1), (1, 12)):
    shape.value = value
    shape.keyframe_insert("value", frame=frame)
""")
    found = next(one for one in mechanism(session).findings if "shape keys" in one.message)
    assert found.objects == ("Body", "Actor")
    assert "'Body' is moved by animated shape keys" in found.message


def test_a_simulation_that_may_stand_still_need_not_be_baked(session: LiveSession) -> None:
    make(session, SOLVED["sim_cloth"], "sim_cloth", "none")
    assert mechanism(session).passed == ("R15", "R19")


def keyed(frames: int, last: int, on: str = "Body") -> str:
    """So many keys, spread over the frames to the last one."""
    return f"""
scene.frame_end = {last}
one = bpy.data.objects[{on!r}]
for number in range({frames}):
    key(one, 1 + round(number * ({last} - 1) / {max(1, frames - 1)}), location=(0, 0, 0.6 - 0.01 * number))
"""


@pytest.mark.parametrize(("frames", "last"), [(4, 12), (4, 50), (9, 100)])
def test_a_few_keys_imitate_nothing(session: LiveSession, frames: int, last: int) -> None:
    make(session, SOLVED["sim_rigid"] + keyed(frames, last), "sim_rigid", "none")
    assert mechanism(session).passed == ("R15", "R19")


@pytest.mark.parametrize(("frames", "last"), [(5, 12), (5, 50), (10, 100)])
@pytest.mark.parametrize("on", ["Body", "Actor root"])
def test_keys_every_few_frames_imitate_the_solver(
    session: LiveSession, frames: int, last: int, on: str
) -> None:
    make(session, SOLVED["sim_rigid"] + keyed(frames, last, on), "sim_rigid", "none")
    found = the_breach(session)
    assert found.objects == (on, "Actor")
    assert f"{frames} keyframes on location" in found.message


IMITATIONS = {
    "sampled": ("curves(body)[2].convert_to_samples(1, 12)", "11 keyframes on location"),
    "an NLA track": (
        "body.animation_data.nla_tracks.new().strips.new('Fall', 1, body.animation_data.action)\n"
        "body.animation_data.action = None",
        "12 keyframes on location",
    ),
    "a driver": (
        "body.animation_data_clear()\nbody.driver_add('location', 2).driver.expression = '1 - 0.01 * frame'",
        "a driver on location",
    ),
    "a recording": (
        "body.animation_data_clear()\nbody.modifiers.new('Played', 'MESH_CACHE')",
        "a Mesh Cache modifier",
    ),
}


@pytest.mark.parametrize(("script", "told"), IMITATIONS.values(), ids=IMITATIONS)
def test_what_else_plays_a_motion_frame_by_frame_imitates_it_too(
    session: LiveSession, script: str, told: str
) -> None:
    make(session, SOLVED["sim_rigid"] + keyed(12, 12) + script, "sim_rigid", "none")
    assert told in the_breach(session).message


def test_an_emitter_may_be_carried_about(session: LiveSession) -> None:
    make(session, SOLVED["sim_particle"] + keyed(12, 12), "sim_particle", "none")
    assert mechanism(session).passed == ("R15", "R19")


def test_a_body_that_is_let_go_is_the_solvers(session: LiveSession) -> None:
    let_go = """
key(body.rigid_body, 1, kinematic=True)
key(body.rigid_body, 5, kinematic=False)
scene.frame_set(1)
"""
    make(session, SOLVED["sim_rigid"] + let_go, "sim_rigid", baked=True)
    assert session.run("bpy.data.objects['Body'].rigid_body.kinematic") is True
    assert mechanism(session).passed == ("R15", "R19")


@pytest.mark.parametrize("how", ["kinematic = True", "enabled = False", "type = 'PASSIVE'"])
def test_a_body_that_never_is_does_not_count(session: LiveSession, how: str) -> None:
    make(session, SOLVED["sim_rigid"], "sim_rigid", baked=True)
    session.run(f"bpy.data.objects['Body'].rigid_body.{how}")
    assert "has no active rigid body that is on" in mechanism(session).findings[0].message


@pytest.mark.parametrize(
    ("kind", "off"),
    [
        ("sim_rigid", "bpy.context.scene.rigidbody_world.enabled = False"),
        ("sim_cloth", "bpy.data.objects['Body'].modifiers[0].show_viewport = False"),
    ],
)
def test_a_solver_that_is_switched_off_is_told(session: LiveSession, kind: str, off: str) -> None:
    make(session, SOLVED[kind], kind, baked=True)
    session.run(off)
    assert "switched off" in mechanism(session).findings[0].message


def test_a_bake_that_ends_early_is_told_with_its_frames(session: LiveSession) -> None:
    make(session, SOLVED["sim_cloth"], "sim_cloth", baked=True)
    session.run("bpy.context.scene.frame_end = 15")
    assert "baked for frames 1–12, not for 1–15" in the_breach(session).message


def test_frames_that_are_gone_from_the_disk_are_counted(session: LiveSession) -> None:
    make(session, SOLVED["sim_fluid"], "sim_fluid", baked=True)
    session.run("""
import os
folder = bpy.path.abspath(bpy.data.objects["Body"].modifiers[0].domain_settings.cache_directory)
for name in sorted(os.listdir(os.path.join(folder, "data")))[-3:]:
    os.remove(os.path.join(folder, "data", name))
""")
    assert "3 of its frames are missing" in the_breach(session).message


REOPEN = """
import os
path = os.path.join(os.path.dirname(bpy.data.filepath), "again.blend")
bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
bpy.ops.wm.open_mainfile(filepath=path)
"""


def test_a_bake_is_as_good_when_its_file_is_opened_again(session: LiveSession) -> None:
    make(session, SOLVED["sim_rigid"], "sim_rigid", baked=True)
    session.run(REOPEN)
    assert session.run("bpy.context.scene.rigidbody_world.point_cache.is_outdated") is True  # Blender's view
    assert mechanism(session).passed == ("R15", "R19")


CHANGES = (
    "body.location.x += 0.1",
    "body.parent.location.x += 0.1",
    "body.rigid_body.mass = 3",
    "bpy.context.scene.rigidbody_world.time_scale = 2",
)
RESHAPED = "bpy.data.objects['Slab'].data.vertices[0].co.z += 0.1"  # which Blender itself does not notice


@pytest.mark.parametrize(
    ("change", "reopened"), [*((one, again) for one in CHANGES for again in (False, True)), (RESHAPED, True)]
)
def test_a_bake_is_outdated_by_what_it_depends_on_alone(
    session: LiveSession, change: str, reopened: bool
) -> None:
    make(session, SOLVED["sim_rigid"], "sim_rigid", baked=True)
    session.run(REOPEN if reopened else "")
    session.run("bpy.data.objects['Body'].hide_render = True\nbpy.context.view_layer.update()")
    assert mechanism(session).passed == ("R15", "R19")
    session.run(f"body = bpy.data.objects['Body']\n{change}\nbpy.context.view_layer.update()")
    assert "baked, but outdated" in the_breach(session).message


# What is not simulated

POST = 'thing("Actor", box("Post", (-0.1, -0.1, 0), (0.1, 0.1, 1)))\npost = bpy.data.objects["Post"]\n'
ARMATURE = """
bones = bpy.data.objects.new("Bones", bpy.data.armatures.new("Bones"))
bpy.data.collections["Actor"].objects.link(bones)
post.modifiers.new("Armature", "ARMATURE").object = bones
"""
HINGE = """
bones = bpy.data.objects.new("Bones", bpy.data.armatures.new("Bones"))
bpy.data.collections["Actor"].objects.link(bones)
bones.parent = bpy.data.objects["Actor root"]
bpy.context.view_layer.objects.active = bones
bpy.ops.object.mode_set(mode="EDIT")
bones.data.edit_bones.new("hinge").tail = (0, 0, 1)
bpy.ops.object.mode_set(mode="OBJECT")
"""
ON_BONE = "post.parent, post.parent_type, post.parent_bone = bones, 'BONE', 'hinge'\n"
TO_BONE = """
link = post.constraints.new("COPY_ROTATION")
link.target, link.subtarget = bones, "hinge"
"""
TO_BONES = """
link = post.constraints.new("ARMATURE").targets.new()
link.target, link.subtarget = bones, "hinge"
"""
KEYS = """
for frame, x in ((1, 0), (9, 1)):
    key(bpy.data.objects["Actor root"], frame, location=(x, 0, 0))
"""
OTHER = """
other = thing("Cart", box("Planks", (0, 0, 0), (1, 1, 1)))
link = bpy.data.objects["Actor root"].constraints.new("CHILD_OF")
link.target = other
"""
PUSHED = "key(other, 1, location=(0, 0, 0))\nkey(other, 9, location=(1, 0, 0))\n"
GRASS = """
post.modifiers.new("Grass", "PARTICLE_SYSTEM")
post.particle_systems[0].settings.type = "HAIR"
"""


@pytest.mark.parametrize(
    ("kind", "motion", "script"),
    [
        ("rig", "keyframe", ARMATURE + KEYS),
        ("rig", "keyframe", HINGE + ON_BONE + KEYS),
        ("rig", "keyframe", HINGE + TO_BONE + KEYS),
        ("rig", "keyframe", HINGE + TO_BONES + KEYS),
        ("none", "keyframe", KEYS),
        ("none", "keyframe", OTHER + PUSHED),
        ("none", "none", ""),
        ("none", "none", OTHER),
        ("none", "none", GRASS),
        ("none", "none", "key(post, 1, hide_render=False)\nkey(post, 9, hide_render=True)"),
        ("none", "none", "key(post, 1, location=(0, 0, 0))\nkey(post, 9, location=(0, 0, 0))"),
    ],
)
def test_what_is_declared_and_done_is_right(
    session: LiveSession, kind: str, motion: str, script: str
) -> None:
    make(session, POST + script, kind, motion)
    assert mechanism(session).passed == ("R15", "R19")


@pytest.mark.parametrize(
    ("kind", "motion", "script", "told"),
    [
        ("rig", "none", "", "declared a rig, but no armature"),
        ("rig", "none", HINGE, "and no bone carries it"),
        ("rig", "none", HINGE + TO_BONE + "post.constraints[0].mute = True", "and no bone carries it"),
        ("none", "keyframe", "", "has none"),
        ("none", "keyframe", "key(post, 1, location=(0, 0, 0))", "has none"),
        ("none", "keyframe", OTHER, "has none"),
        ("none", "none", KEYS, "'Actor root' is animated"),
        ("none", "none", OTHER + PUSHED, "'Cart root' is animated"),
        ("none", "none", "post.modifiers.new('Cloth', 'CLOTH')", "is simulated (sim_cloth)"),
        ("none", "bake", "", "no solver moves it"),
    ],
)
def test_what_is_declared_and_not_done_is_told(
    session: LiveSession, kind: str, motion: str, script: str, told: str
) -> None:
    make(session, POST + script, kind, motion)
    found = the_breach(session)
    assert found.objects[0] == "Actor"
    assert told in found.message


def test_what_declares_nothing_is_not_judged(session: LiveSession) -> None:
    make(session, POST + KEYS)
    why = "no object declares how it is deformed or moved"
    assert mechanism(session).not_applicable == {"R15": why, "R19": why}


def test_the_plan_declares_for_what_has_no_tags(session: LiveSession) -> None:
    make(session, POST)
    plan = a_motion(
        {"actor": "Actor", "kind": "topple", "start": 1, "end": 9}, last=LAST, roles={"Actor": "rigid"}
    )
    found = the_finding(verified(session, "R15,R19", plan))
    assert "declared sim_rigid, but has no active rigid body" in found.message


def test_tags_that_say_something_else_than_the_plan_are_told(session: LiveSession) -> None:
    make(session, POST + KEYS, "none", "keyframe")
    plan = a_motion(
        {"actor": "Actor", "kind": "topple", "start": 1, "end": 9}, last=LAST, roles={"Actor": "rigid"}
    )
    found = verified(session, "R15,R19", plan).findings
    assert [one.objects for one in found] == [("Actor",)] * 2
    assert (
        "tagged deformation_kind='none', but its planned role 'rigid' needs 'sim_rigid'" in found[0].message
    )
    assert "tagged motion_kind='keyframe'" in found[1].message


def test_only_the_planned_phases_must_be_baked(session: LiveSession) -> None:
    make(session, SOLVED["sim_cloth"], "sim_cloth", baked=True)
    session.run("bpy.context.scene.frame_end = 15")
    phase = {"actor": "Actor", "kind": "deform", "start": 1}
    for end, breaks in ((12, False), (13, True)):
        plan = a_motion({**phase, "end": end}, last=15, roles={"Actor": "cloth"})
        assert bool(verified(session, "R15,R19", plan).findings) == breaks


# T1


def timeline(session: LiveSession, last: int = LAST, **more: Any) -> Report:
    phase = {"actor": "Actor", "kind": "deform", "start": 1, "end": 9}
    return verified(session, "T1", a_motion(phase, last=last, roles={"Actor": "cloth"}, **more))


def test_a_baked_timeline_that_is_the_planned_one_passes(session: LiveSession) -> None:
    make(session, SOLVED["sim_cloth"], baked=True)
    assert timeline(session).passed == ("T1",)


@pytest.mark.parametrize(
    ("change", "told", "measured"),
    [
        ("scene.render.fps = 25", "frame rate is 25; the plan says 24", 25),
        (
            "scene.render.fps, scene.render.fps_base = 24, 1.001",
            "frame rate is 23.976; the plan says 24",
            24 / 1.001,
        ),
        ("scene.frame_start = 2", "first frame is 2; the plan says 1", 2),
        ("scene.frame_end = 11", "last frame is 11; the plan says 12", 11),
    ],
)
def test_another_timeline_is_told(session: LiveSession, change: str, told: str, measured: float) -> None:
    make(session, SOLVED["sim_cloth"], baked=True)
    session.run(f"scene = bpy.context.scene\n{change}")
    found = the_finding(timeline(session))
    assert (found.rule, found.severity, found.tolerance) == ("T1", "hard", 0)
    assert found.measured == pytest.approx(measured)
    assert told in found.message


def test_a_cache_must_reach_to_the_last_frame(session: LiveSession) -> None:
    make(session, SOLVED["sim_cloth"], baked=True)
    session.run("bpy.context.scene.frame_end = 13")
    found = the_finding(timeline(session, last=13))
    assert found.objects == ("Body",)
    assert "baked for frames 1–12, not for 1–13" in found.message


def test_a_cache_that_is_not_baked_is_told_but_not_of_a_solver_that_is_off(session: LiveSession) -> None:
    make(session, SOLVED["sim_cloth"])
    assert "The cloth cache of 'Body' is not baked" in the_finding(timeline(session)).message
    session.run("bpy.data.objects['Body'].modifiers[0].show_viewport = False")
    assert timeline(session).passed == ("T1",)


def test_an_animation_without_phases_has_a_timeline_and_a_still_has_none(session: LiveSession) -> None:
    make(session, POST)
    relation = {"kind": "Upright", "a": "Actor"}
    film = a_plan(relation, frame_end=20, render={"kind": "animation"})
    assert the_finding(verified(session, "T1", film)).measured == LAST
    assert verified(session, "T1", a_plan(relation)).not_applicable == {"T1": "the plan has no motion"}


def test_particles_are_baked_from_the_first_birth_to_the_last_death(session: LiveSession) -> None:
    begin = SOLVED["sim_particle"].replace("= 20, 1, 8, 50", "= 20, 4, 6, 3")
    make(session, begin, "sim_particle", baked=True)
    assert session.run("bpy.data.objects['Body'].particle_systems[0].point_cache.frame_start") == 4
    assert timeline(session).passed == ("T1",)
    assert mechanism(session).passed == ("R15", "R19")
