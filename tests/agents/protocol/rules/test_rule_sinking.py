"""T6: a cloth that nothing holds falls as gravity wants it to begin with."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from scenes import a_motion, build, the_finding, verified

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

SHEET = """
scene.frame_start, scene.frame_end = 1, 14
shape = bmesh.new()
bmesh.ops.create_grid(shape, x_segments=8, y_segments=8, size=0.5)
data = bpy.data.meshes.new("Sheet")
shape.to_mesh(data)
sheet = bpy.data.objects.new("Sheet", data)
sheet.location.z = 3
data.vertices[0].co.z += 0.05  # it deforms
bpy.context.view_layer.update()
thing("Cloth", sheet, at=(0, 0, 3))
thing("Ground", box("Earth", (-3, -3, -1), (3, 3, 0)), system_name="ground")
cloth = sheet.modifiers.new("Cloth", "CLOTH")
cloth.settings.mass, cloth.settings.air_damping = {mass}, {air}
{more}
"""
PIN = """
group = sheet.vertex_groups.new(name="Pins")
group.add([0, 8], 1, "REPLACE")
cloth.settings.vertex_group_mass = "Pins"
"""
PLAN = a_motion(
    {"actor": "Cloth", "kind": "deform", "start": 1, "end": 14}, last=14, roles={"Cloth": "cloth"}
)


def made(session: LiveSession, mass: float, air: float, more: str = "") -> None:
    build(session, SHEET.format(mass=mass, air=air, more=more))


def test_a_cloth_of_ordinary_mass_falls(session: LiveSession) -> None:
    made(session, 0.3, 1)
    assert verified(session, "T6", PLAN).findings == ()


def test_a_cloth_that_sinks_as_if_in_syrup_is_told(session: LiveSession) -> None:
    made(session, 3e-5, 10)
    finding = the_finding(verified(session, "T6", PLAN))
    assert "of a free fall, with nothing that holds it" in finding.message
    assert "a gram a vertex" in finding.fix


def test_a_cloth_that_is_pinned_or_lies_is_no_fall(session: LiveSession) -> None:
    made(session, 0.3, 1, PIN)
    assert verified(session, "T6", PLAN).findings == ()
    session.empty()
    slab = """
slab = box("Slab", (-1, -1, 2.8), (1, 1, 2.999))
slab.modifiers.new("Collision", "COLLISION")
thing("Shelf", slab)
"""
    made(session, 0.3, 1, slab)
    assert verified(session, "T6", PLAN).findings == ()
