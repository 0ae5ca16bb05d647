"""A bake whose settings changed since is played as it was: the tools say whose, what changed, and what to do."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from test_bake import PARTS

from agents.blender.tools.bake import TOOL as BAKE
from agents.blender.tools.execute import TOOL as EXECUTE
from agents.blender.tools.files import LOAD, SAVE
from agents.blender.tools.trial import TOOL as TRIAL
from agents.blender.tools.verify import TOOL as VERIFY

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

JELLY_ON_BALL = f"""{PARTS}
soft()
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.4, location=(3, 0, 1))
bpy.context.object.name = "Ball"
bpy.context.object.modifiers.new("Collision", "COLLISION")
"""
STALE = "older than their settings"


def stale(session: LiveSession, code: str = "") -> list[str]:
    """What ``blender_execute`` says of stale bakes after some code."""
    changed: dict[str, Any] = session.use(EXECUTE, code=code, preflight="off").data["changed"]
    return changed.get("caches", {}).get(STALE, [])


@pytest.mark.parametrize(
    ("scene", "change", "told"),
    [
        ("soft()", "bpy.data.objects['Jelly'].modifiers[0].settings.pull = 0.1", "its settings"),
        ("soft()", "bpy.data.objects['Jelly'].data.vertices[0].co.z += 0.1", "its mesh"),
        ("soft()", "bpy.data.objects['Jelly'].location.z += 1", "its place"),
        ("cloth()", "bpy.data.objects['Flag'].modifiers[0].collision_settings.distance_min = 0.1", "its settings"),
        ("cloth()", "bpy.context.scene.gravity.z = -3", "the scene"),
        ("emitter()", "bpy.data.objects['Tap'].particle_systems[0].settings.normal_factor = 3", "its settings"),
        ("tank()", "bpy.data.objects['Drop'].location.x += 0.1", "'Drop'"),
    ],
)  # fmt: skip
def test_a_changed_setting_makes_a_bake_stale_and_a_new_bake_does_not(
    session: LiveSession, scene: str, change: str, told: str
) -> None:
    session.run(
        f"{PARTS}\n{scene}\nif 'TankDrop' in bpy.data.objects: bpy.data.objects['TankDrop'].name = 'Drop'"
    )
    assert not session.use(BAKE).failed
    assert stale(session, "for frame in (3, 9, 1): bpy.context.scene.frame_set(frame)") == []
    (entry,) = stale(session, change)
    assert entry.endswith(f"(changed since: {told})")
    assert session.use(BAKE).data["notes"] == []
    assert stale(session) == []


def test_a_liquid_whose_bake_blender_drops_is_told_of(session: LiveSession) -> None:
    session.run(f"{PARTS}\ntank()")
    session.use(BAKE)
    changed = session.use(
        EXECUTE, code="bpy.data.objects['Tank'].modifiers[0].domain_settings.time_scale = 0.5"
    ).data
    assert changed["changed"]["caches"] == {"no longer baked": ["liquid of 'Tank'"]}


def test_all_tools_tell_of_it_and_a_saved_file_remembers_it(session: LiveSession) -> None:
    session.run(JELLY_ON_BALL)
    session.use(BAKE)
    done = session.use(EXECUTE, code="bpy.data.objects['Ball'].collision.thickness_outer = 0.1")
    assert "soft body of 'Jelly' (changed since: 'Ball')" in done.text
    assert "blender_bake" in done.text
    assert "simulates again" not in done.text, "it does not: it is played"
    session.run(
        "jelly = bpy.data.objects['Jelly']\nbox = bpy.data.collections.new('Jelly')\n"
        "scene = bpy.context.scene\nscene.collection.children.link(box)\nbox.objects.link(jelly)\n"
        "box['protocol_role'], box['deformation_kind'], box['motion_kind'] = 'object', 'sim_soft', 'bake'"
    )
    session.use(SAVE, name="stale", verify=False)
    session.use(LOAD, path="stale")
    assert stale(session) == ["soft body of 'Jelly' (changed since: 'Ball')"]
    told = session.use(VERIFY).text
    assert "is baked, but outdated: since then 'Ball' changed; the old bake is played" in told
    assert "Free the old bake first" in session.use(TRIAL, frames=3).text
    session.use(BAKE)
    assert stale(session) == []


def test_looks_and_what_takes_no_part_leave_a_bake_as_it_is(session: LiveSession) -> None:
    session.run(f"{JELLY_ON_BALL}\nplane('Other', 9)\nemitter()")
    session.use(BAKE)
    quiet = """
jelly, tap = bpy.data.objects["Jelly"], bpy.data.objects["Tap"]
jelly.modifiers.new("Smooth", "SUBSURF")
jelly.data.materials.append(bpy.data.materials.new("Red"))
jelly.data.polygons[0].material_index = 0
bpy.data.objects["Other"].location.x = 4
tap.particle_systems[0].settings.display_size = 0.3
tap.particle_systems[0].settings.render_type = "OBJECT"
tap.particle_systems[0].settings.instance_object = bpy.data.objects["Other"]
"""
    assert stale(session, quiet) == []


def test_one_bake_names_the_others_that_are_stale(session: LiveSession) -> None:
    session.run(f"{JELLY_ON_BALL}\ncloth()")
    session.use(BAKE)
    session.run("bpy.data.objects['Jelly'].modifiers[0].settings.pull = 0.1")
    assert (
        "Still played as it was baked before: soft body of 'Jelly'"
        in session.use(BAKE, objects=["Flag"]).text
    )


def test_a_bake_that_code_made_itself_is_not_measured_by_an_older_one(session: LiveSession) -> None:
    session.run(JELLY_ON_BALL)
    session.use(BAKE)
    again = """
modifier = bpy.data.objects["Jelly"].modifiers[0]
with bpy.context.temp_override(point_cache=modifier.point_cache):
    bpy.ops.ptcache.free_bake()
modifier.settings.pull = 0.1
for frame in range(1, 13):
    bpy.context.scene.frame_set(frame)
with bpy.context.temp_override(point_cache=modifier.point_cache):
    bpy.ops.ptcache.bake_from_cache()
"""
    assert stale(session, again) == []
