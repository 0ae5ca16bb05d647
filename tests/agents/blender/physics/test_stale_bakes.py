"""A bake whose settings changed since is played as it was: the tools say whose, what changed, and what to do."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from test_bake import PARTS

from agents.blender.tools.bake import TOOL as BAKE
from agents.blender.tools.execute import TOOL as EXECUTE
from agents.blender.tools.files import LOAD, SAVE
from agents.blender.tools.scene_state import TOOL as STATE
from agents.blender.tools.trial import TOOL as TRIAL
from agents.blender.tools.verify import TOOL as VERIFY
from simworlds.sandbox.errors import Refusal

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
    with pytest.raises(
        Refusal, match=r"Free the old bake first .*soft body of 'Jelly' .changed since: 'Ball'"
    ):
        session.use(TRIAL, frames=3)
    session.use(BAKE, free=True)
    assert session.use(TRIAL, frames=3).data["last"] == 3
    session.use(BAKE)
    assert stale(session) == []


@pytest.mark.parametrize("scene", ["soft()", "cloth()", "emitter()"])
def test_a_file_that_is_opened_again_has_what_it_was_baked_from(session: LiveSession, scene: str) -> None:
    session.run(f"{PARTS}\n{scene}")
    assert not session.use(BAKE).failed
    session.use(SAVE, name="again", verify=False)
    session.use(LOAD, path="again")
    assert stale(session) == []


BLOWN = f"""{PARTS}
cloth()
bpy.ops.object.effector_add(type="WIND", location=(-3, 0, 2))
bpy.context.object.name = "Wind"
"""
BAKED_BY_CODE = """
cache = bpy.data.objects["Flag"].modifiers[0].point_cache
cache.frame_end = 12
with bpy.context.temp_override(point_cache=cache):
    bpy.ops.ptcache.bake(bake=True)
"""


@pytest.mark.parametrize("change", ["location.x = 3", "field.strength = 600"])
def test_a_bake_that_came_with_a_file_is_older_than_what_is_changed_in_it(
    session: LiveSession, change: str
) -> None:
    session.run(BLOWN + BAKED_BY_CODE)
    session.use(SAVE, name="theirs", verify=False)
    session.use(LOAD, path="theirs")
    assert stale(session) == []
    assert "outdated" not in session.use(STATE).text.lower()
    assert stale(session, f"bpy.data.objects['Wind'].{change}") == ["cloth of 'Flag' (changed since: 'Wind')"]
    assert "Outdated bakes" in session.use(STATE).text


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


BRICKS = f"""{PARTS}
body("Low", 0, 0.5)
body("High", 0, 3)
for name in ("Low", "High"):
    box = bpy.data.collections.new(f"The {{name}}")
    box["protocol_role"] = "object"
    scene.collection.children.link(box)
    box.objects.link(bpy.data.objects[name])
scene.rigidbody_world.point_cache.frame_end = 12
"""
ANOTHER = """
bpy.ops.mesh.primitive_cube_add(size=1, location=(1.2, 0, 0.5), rotation=(0, 0, 0))
bpy.context.object.name = "Third"
bpy.ops.rigidbody.object_add()
"""
PLAY = "for frame in (1, 2, 3, 12, 1): bpy.context.scene.frame_set(frame)"
BODIES = "the rigid-body world"


def test_bodies_are_still_to_be_baked_once_the_old_bake_was_played(session: LiveSession) -> None:
    session.run(BRICKS)
    session.use(BAKE)
    assert stale(session, ANOTHER) == [BODIES]
    assert stale(session, PLAY) == [BODIES]
    assert "Outdated bakes (free them, or bake again): Scene." in session.use(STATE).data["notes"]
    told = session.use(VERIFY, rules=["V2"])
    assert "Judged at frame 1 only" in told.text
    with pytest.raises(Refusal, match="Free the old bake first"):
        session.use(TRIAL, frames=3)
    session.use(BAKE, free=True)
    session.use(TRIAL, frames=3)
    freed = session.use(STATE)
    assert freed.data["notes"] == []
    assert "OUTDATED" not in freed.text
    session.use(BAKE)
    assert stale(session, PLAY) == []


@pytest.mark.parametrize("anew", ["bpy.ops.ptcache.bake_all(bake=True)", "bpy.ops.ptcache.bake_from_cache()"])
def test_bodies_that_code_bakes_anew_are_up_to_date(session: LiveSession, anew: str) -> None:
    session.run(BRICKS)
    session.use(BAKE)
    again = f"""
with bpy.context.temp_override(point_cache=bpy.context.scene.rigidbody_world.point_cache):
    bpy.ops.ptcache.free_bake()
    {{}}
    for frame in range(1, 13):
        bpy.context.scene.frame_set(frame)
    {anew}
"""
    assert stale(session, again.format("bpy.context.scene.rigidbody_world.time_scale = 2")) == []


def test_what_an_old_bake_shows_is_not_held_against_the_scene(session: LiveSession) -> None:
    """The body that the bake does not know stays where another one falls."""
    session.run(BRICKS)
    session.use(BAKE)
    session.run(
        "bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 1.7))\nbpy.ops.rigidbody.object_add()"
    )
    old = session.use(VERIFY, rules=["V2", "T2"])
    (finding,) = [one for one in old.data["findings"] if one["rule"] == "V2" and one["frame"] == 12]
    assert finding["severity"] == "soft"
    assert finding["fix"].startswith("Free it (blender_bake, free=true) or bake again (blender_bake)")
