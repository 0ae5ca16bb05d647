"""R15: what a simulation works with is set up with it: partners, collision shapes, force fields."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from scenes import a_motion, build, the_finding, verified

from agents.blender.tools.scene_state import TOOL as STATE
from agents.plan.scene import Joint

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.protocol.findings import Finding

pytestmark = pytest.mark.blender

TABLE = """
top = box("Top", (-1, -1, 0), (1, 1, 0.1))
thing("Table", top)
def declared(name, kind):
    bpy.data.collections[name]["deformation_kind"] = kind
"""
ACTORS = {
    "cloth": """
sheet = plane("Sheet", (-0.5, -0.5), (0.5, 0.5), at=(0, 0, 0.2))
thing("Actor", sheet)
sheet.modifiers.new("Cloth", "CLOTH")
declared("Actor", "sim_cloth")
""",
    "soft": """
jelly = ball("Jelly", 0.2, at=(0, 0, 0.4), segments=8)
thing("Actor", jelly)
jelly.modifiers.new("Softbody", "SOFT_BODY")
declared("Actor", "sim_soft")
""",
    "rigid": """
ball_ = ball("Ball", 0.2, at=(0, 0, 0.4), segments=8)
thing("Actor", ball_)
rigid(ball_)
declared("Actor", "sim_rigid")
""",
}
PARTNERS = {
    "cloth": 'top.modifiers.new("Collision", "COLLISION")',
    "soft": 'top.modifiers.new("Collision", "COLLISION")',
    "rigid": 'rigid(top, "PASSIVE")',
}
OTHERS = {"cloth": PARTNERS["rigid"], "soft": PARTNERS["rigid"], "rigid": PARTNERS["cloth"]}
FIELD = """
bpy.ops.object.effector_add(type="WIND")
wind = bpy.context.object
wind.name = "Wind"
"""


def plan(role: str, table: str = "static", *relations: dict[str, Any], **roles: str) -> Any:
    rests = {"kind": "SupportedBy", "child": "Actor", "parents": ["Table"]}
    return a_motion(roles={"Actor": role, "Table": table, **roles}, relations=(rests, *relations))


def breach(session: LiveSession, made: Any) -> Finding:
    finding = the_finding(verified(session, "R15", made))
    assert (finding.rule, finding.severity, finding.outcome) == ("R15", "hard", "broken")
    return finding


@pytest.mark.parametrize("role", ACTORS)
def test_what_a_body_rests_on_takes_part_in_its_simulation(session: LiveSession, role: str) -> None:
    build(session, TABLE + ACTORS[role])
    finding = breach(session, plan(role))
    assert finding.objects == ("Actor", "Table")
    assert "takes no part" in finding.message
    session.empty()
    build(session, TABLE + ACTORS[role] + OTHERS[role])
    assert breach(session, plan(role)).objects == ("Actor", "Table"), "another solver's collider is none"
    session.empty()
    build(session, TABLE + ACTORS[role] + PARTNERS[role])
    assert verified(session, "R15", plan(role)).passed == ("R15",)


def test_a_collider_that_nothing_can_hit_is_told(session: LiveSession) -> None:
    build(
        session,
        TABLE + ACTORS["rigid"] + PARTNERS["rigid"] + '\nthing("Post", box("Pole", (2, 2, 0), (3, 3, 1)))',
    )
    finding = breach(session, plan("rigid", Post="collider"))
    assert finding.objects == ("Post",)
    assert "takes part in no simulation" in finding.message
    session.run('bpy.data.objects["Pole"].modifiers.new("Collision", "COLLISION")')
    assert verified(session, "R15", plan("rigid", Post="collider")).passed == ("R15",)


@pytest.mark.parametrize("shape", ["BOX", "SPHERE", "CYLINDER"])
def test_a_primitive_shape_is_where_its_mesh_is(session: LiveSession, shape: str) -> None:
    script = TABLE + ACTORS["rigid"] + PARTNERS["rigid"]
    build(session, script + f'\nball_.rigid_body.collision_shape = "{shape}"')
    assert verified(session, "R15", plan("rigid")).passed == ("R15",)
    session.run("""
ball_ = bpy.data.objects["Ball"]
for vertex in ball_.data.vertices:
    vertex.co.z += 0.028
""")
    finding = breach(session, plan("rigid"))
    assert finding.objects == ("Ball", "Actor")
    assert finding.measured == pytest.approx(0.028, abs=1e-4)
    session.run('bpy.data.objects["Ball"].rigid_body.collision_shape = "CONVEX_HULL"')
    assert verified(session, "R15", plan("rigid")).passed == ("R15",)


# How the mesh lies to its origin, what the body is, and whether its origin is where no centre of mass can be.
ORIGINS = {
    "far beside the mesh": ("z + 1", "", True),
    "at the foot of the mesh": ("z + 0.2", "", False),
    "a little below the mesh": ("z + 0.22", "", False),
    "of a passive body": ("z + 1", 'body.type = "PASSIVE"', False),
    "of a keyed body": ("z + 1", "body.kinematic = True", False),
    "of a compound": ("z + 1", 'body.collision_shape = "COMPOUND"', False),
    "of a part of a compound": (
        "z + 1",
        """
frame = box("Frame", (-1, -1, 0), (1, 1, 1))
scene.collection.objects.link(frame)
rigid(frame)
frame.rigid_body.collision_shape = "COMPOUND"
ball_.parent = frame
""",
        False,
    ),
}


@pytest.mark.parametrize(("height", "change", "is_wrong"), ORIGINS.values(), ids=ORIGINS)
def test_the_origin_of_a_simulated_body_is_in_its_mesh(
    session: LiveSession, height: str, change: str, is_wrong: bool
) -> None:
    build(
        session,
        f"""{TABLE}{ACTORS["rigid"]}{PARTNERS["rigid"]}
body = ball_.rigid_body
body.collision_shape = "CONVEX_HULL"
for vertex in ball_.data.vertices:
    z = vertex.co.z
    vertex.co.z = {height}
{change}
""",
    )
    notes = [note for note in session.use(STATE).data.get("notes", ()) if "centre of mass" in note]
    report = verified(session, "R15", None)
    told = [finding for finding in report.findings if "centre of mass" in finding.message]
    if not is_wrong:
        assert not told
        assert not notes
        return
    (finding,) = told
    assert finding.objects == ("Ball", "Actor")
    assert finding.measured == pytest.approx(0.8, abs=0.01)
    assert notes[0].endswith("'Ball' by 0.8 m. Set the origin to the middle of its bounds.")


def test_a_field_has_strength_and_reaches_what_it_is_to_move(session: LiveSession) -> None:
    build(session, TABLE + ACTORS["cloth"] + PARTNERS["cloth"] + FIELD)
    made = plan("cloth", Wind="force")
    session.run('bpy.data.objects["Wind"].field.strength = 3')
    assert verified(session, "R15", made).passed == ("R15",)
    session.run('bpy.data.objects["Wind"].field.strength = 0')
    assert "no strength" in breach(session, made).message
    session.run("""
wind = bpy.data.objects["Wind"]
wind.field.strength, wind.field.use_max_distance, wind.field.distance_max = 3, True, 1
wind.location.x = 2
""")
    assert "ends 1 m from its centre; the nearest simulated object is 1.5" in breach(session, made).message


POST = """
post = box("Post body", (0.3, -0.1, 0.1), (0.5, 0.1, 0.6))
thing("Post", post)
rigid(post, "PASSIVE")
"""
JOINT = """
bpy.ops.object.empty_add()
hinge = bpy.context.object
hinge.name = "Hinge"
bpy.ops.rigidbody.constraint_add(type="HINGE")
hinge.rigid_body_constraint.object1 = bpy.data.objects["Post body"]
hinge.rigid_body_constraint.object2 = bpy.data.objects["Ball"]
"""


def test_a_planned_joint_is_made_and_limited(session: LiveSession) -> None:
    joint = {"kind": "hinge", "part": "Actor", "host": "Post", "limits": (-90, 0)}
    made = plan("rigid", Post="static").model_copy(update={"joints": (Joint.model_validate(joint),)})
    build(session, TABLE + ACTORS["rigid"] + PARTNERS["rigid"] + POST)
    session.run(JOINT)
    assert "has no limits" in breach(session, made).message
    session.run('bpy.data.objects["Hinge"].rigid_body_constraint.use_limit_ang_z = True')
    assert verified(session, "R15", made).passed == ("R15",)
    session.run('bpy.data.objects["Hinge"].rigid_body_constraint.object1 = None')
    assert "The planned hinge of 'Actor' and 'Post' is missing." in breach(session, made).message


def test_smoke_needs_nothing_of_the_flue_that_it_comes_out_of(session: LiveSession) -> None:
    """As an effector it would choke the smoke; what a liquid lies on must stop it."""
    build(
        session,
        """
thing("Flue", box("Bricks", (-0.1, -0.1, -1), (0.1, 0.1, 0)))
domain = box("Domain", (-0.5, -0.5, 0), (0.5, 0.5, 1))
thing("Actor", domain)
domain.modifiers.new("Fluid", "FLUID").fluid_type = "DOMAIN"
bpy.data.collections["Actor"]["deformation_kind"] = "sim_fluid"
""",
    )
    rests = {"kind": "SupportedBy", "child": "Actor", "parents": ["Flue"]}
    made = a_motion(roles={"Actor": "fluid", "Flue": "static"}, relations=(rests,))
    assert verified(session, "R15", made).passed == ("R15",)
    session.run('bpy.data.objects["Domain"].modifiers["Fluid"].domain_settings.domain_type = "LIQUID"')
    assert "'Flue' takes no part in the simulation of 'Actor'" in breach(session, made).message


def test_smoke_is_not_simulated_as_a_liquid(session: LiveSession) -> None:
    build(
        session,
        """
domain = box("Domain", (-0.5, -0.5, 0), (0.5, 0.5, 1))
thing("Actor", domain)
domain.modifiers.new("Fluid", "FLUID").fluid_type = "DOMAIN"
domain.modifiers["Fluid"].domain_settings.domain_type = "LIQUID"
bpy.data.collections["Actor"]["deformation_kind"] = "sim_fluid"
""",
    )
    made = a_motion(roles={"Actor": "fluid"})
    smoke = made.objects[0].model_copy(update={"fluid_kind": "smoke"})
    made = made.model_copy(update={"objects": (smoke,)})
    assert "planned as smoke, but its domain is of the kind LIQUID" in breach(session, made).message
    session.run('bpy.data.objects["Domain"].modifiers["Fluid"].domain_settings.domain_type = "GAS"')
    assert verified(session, "R15", made).passed == ("R15",)
