"""T8, and what the other rules say of fluids: they judge the liquid or gas, never the box of its domain."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from scenes import a_motion, build, the_finding, verified

from agents.blender.tools.bake import TOOL as BAKE

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.plan.scene import ScenePlan
    from agents.protocol.findings import Report

pytestmark = pytest.mark.blender

LAST = 18
SET = f"""
scene.frame_start, scene.frame_end = 1, {LAST}
thing("Floor", box("Slab", (-2, -2, -0.1), (2, 2, 0)), system_name="ground")
camera((2.2, -3.2, 2.6), (0, 0, 0.4), 35)

def fluid(obj, kind):
    made = obj.modifiers.new("Fluid", "FLUID")
    made.fluid_type = kind
    return made

def declared(name):
    made = bpy.data.collections[name]
    made["deformation_kind"], made["motion_kind"] = "sim_fluid", "bake"
"""
# A tank without a lid, of boards, and a column of water at its left wall.
DAM = (
    SET
    + """
WALL = 0.08
def boards(*boxes):
    shape = bmesh.new()
    for low, high in boxes:
        for vertex in bmesh.ops.create_cube(shape, size=1)["verts"]:
            vertex.co = Vector([low[i] + (vertex.co[i] + 0.5) * (high[i] - low[i]) for i in range(3)])
    data = bpy.data.meshes.new("Boards")
    shape.to_mesh(data)
    shape.free()
    return bpy.data.objects.new("Boards", data)

tank = boards(
    ((-0.5, -0.3, 0), (0.5, 0.3, WALL)),
    ((-0.5, -0.3, WALL), (-0.5 + WALL, 0.3, 0.7)), ((0.5 - WALL, -0.3, WALL), (0.5, 0.3, 0.7)),
    ((-0.42, -0.3, WALL), (0.42, -0.3 + WALL, 0.7)), ((-0.42, 0.3 - WALL, WALL), (0.42, 0.3, 0.7)),
)
thing("Tank", tank)
fluid(tank, "EFFECTOR")
domain = box("Domain", (-0.6, -0.4, 0), (0.6, 0.4, {lid}))
column = box("Column", (-0.4, -0.2, 0.1), (-0.1, 0.2, 0.5))
column.hide_render = True
thing("Water", domain, column, at=(-0.25, 0, 0.1))
settings = fluid(domain, "DOMAIN").domain_settings
settings.domain_type, settings.resolution_max, settings.use_mesh = "LIQUID", 20, True
flow = fluid(column, "FLOW").flow_settings
flow.flow_type, flow.flow_behavior = "LIQUID", "GEOMETRY"
declared("Water")
{more}
"""
)
CHIMNEY = (
    SET
    + """
thing("Chimney", box("Bricks", (-0.15, -0.15, 0), (0.15, 0.15, 0.5)))
domain = box("Domain", (-0.5, -0.5, 0.3), (0.5, 0.5, {top}))
source = box("Source", (-0.1, -0.1, 0.45), (0.1, 0.1, 0.55))
source.hide_render = True
thing("Smoke", domain, source, at=(0, 0, 0.5))
domain["contact_with"] = ["Source"]
settings = fluid(domain, "DOMAIN").domain_settings
settings.domain_type, settings.resolution_max = "GAS", 16
flow = fluid(source, "FLOW").flow_settings
flow.flow_type, flow.flow_behavior = "SMOKE", "INFLOW"
declared("Smoke")
{more}
"""
)


def dam_plan() -> ScenePlan:
    return a_motion(
        {"actor": "Water", "kind": "flow", "start": 1, "end": LAST, "direction": (1, 0, 0), "extent": 0.6},
        last=LAST,
        roles={"Tank": "container", "Water": "fluid"},
        relations=({"kind": "Inside", "content": "Water", "container": "Tank"},),
        camera={"position": (2.2, -3.2, 2.6), "target": (0, 0, 0.4), "subjects": ["Tank"]},
    )


def chimney_plan() -> ScenePlan:
    return a_motion(
        {"actor": "Smoke", "kind": "flow", "start": 2, "end": LAST, "direction": (0, 0, 1), "extent": 0.6},
        last=LAST,
        roles={"Chimney": "static", "Smoke": "fluid"},
        relations=({"kind": "FixedAttachment", "part": "Smoke", "host": "Chimney"},),
        camera={"position": (2.2, -3.2, 2.6), "target": (0, 0, 0.4), "subjects": ["Smoke", "Chimney"]},
    )


def dam(session: LiveSession, lid: float = 1.2, more: str = "", *, baked: bool = True) -> None:
    build(session, DAM.replace("{lid}", str(lid)).replace("{more}", more))
    if baked:
        session.use(BAKE)


def chimney(session: LiveSession, top: float = 1.6, more: str = "", *, baked: bool = True) -> None:
    build(session, CHIMNEY.replace("{top}", str(top)).replace("{more}", more))
    if baked:
        session.use(BAKE)


def hard(report: Report) -> list[str]:
    return [finding.message for finding in report.findings if finding.severity == "hard"]


def test_water_that_is_set_up_in_a_tank_is_where_its_flow_is(session: LiveSession) -> None:
    dam(session, baked=False)
    assert verified(session, "V,R9", dam_plan()).ok
    # The box around it hides nothing: renders do not show it.
    assert not [one for one in hard(verified(session, "R14", dam_plan())) if "hidden" in one]
    session.run('bpy.data.objects["Column"].location.z += 0.4')
    assert "'Water' is inside 'Tank'" in the_finding(verified(session, "R9", dam_plan())).message


def test_a_dam_that_breaks_in_its_tank_is_sound(session: LiveSession) -> None:
    dam(session)
    assert hard(verified(session, "V,R9,R14,R15,T", dam_plan())) == []


def test_a_low_domain_cuts_the_splash(session: LiveSession) -> None:
    dam(session, lid=0.52)
    findings = [one for one in verified(session, "T8").findings if one.severity == "hard"]
    assert [("top of its domain" in one.message, "higher" in one.fix) for one in findings] == [(True, True)]


def test_a_liquid_that_loses_its_volume_is_told(session: LiveSession) -> None:
    dam(session, more="settings.particle_radius = 3")
    (finding,) = (one for one in verified(session, "T8").findings if "volume" in one.message)
    assert (finding.severity, "shrinks" in finding.message) == ("hard", True)
    assert finding.measured is not None
    assert finding.measured > 0.15


def test_an_ordinary_chimney_is_sound(session: LiveSession) -> None:
    chimney(session, baked=False)
    assert verified(session, "V,R7", chimney_plan()).ok
    session.use(BAKE)
    assert hard(verified(session, "V,R7,R14,R15,T", chimney_plan())) == []


def test_smoke_that_stays_in_its_source_or_does_not_get_as_far_is_told(session: LiveSession) -> None:
    chimney(session, more="settings.alpha = settings.beta = 0")
    told = hard(verified(session, "T4,T8", chimney_plan()))
    assert any("outside its source" in message for message in told)
    assert any("from where it began; the plan says 0.6 m" in message for message in told)


def test_smoke_at_the_top_of_its_domain_is_advice(session: LiveSession) -> None:
    chimney(session, top=0.8)
    report = verified(session, "T8")
    assert report.ok
    assert "at the top of its domain" in the_finding(report).message


def test_fluids_that_are_not_baked_are_not_judged(session: LiveSession) -> None:
    chimney(session, baked=False)
    assert verified(session, "T8").not_applicable == {"T8": "no fluid is baked"}
