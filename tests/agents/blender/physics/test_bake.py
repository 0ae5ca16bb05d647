"""``blender_bake``: which caches, which frames, what is told, and what becomes of a bake that does not end."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import pytest

from agents.blender.tools.bake import TOOL
from agents.blender.tools.base import Call
from simworlds.sandbox.errors import Interrupted, Refusal, TookTooLong

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

PARTS = """
scene = bpy.context.scene
scene.frame_end = 12

def plane(name, x, z=2.0, turned=False):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=6, y_subdivisions=6, size=1, location=(x, 0, z))
    bpy.context.object.name = name
    bpy.context.object.rotation_euler.x = 1.5 if turned else 0.0
    return bpy.context.object

def cloth(name="Flag", x=0):
    plane(name, x).modifiers.new("Cloth", "CLOTH")

def soft(name="Jelly", x=3, use_goal=False):
    plane(name, x).modifiers.new("Softbody", "SOFT_BODY").settings.use_goal = use_goal

def emitter(name="Tap", x=6, **settings):
    thing = plane(name, x)
    thing.modifiers.new("Drops", "PARTICLE_SYSTEM")
    given = thing.particle_systems[0].settings
    given.count, given.frame_end, given.lifetime = 50, 6, 100
    for key, value in settings.items():
        setattr(given, key, value)

def hair(name="Fur", x=9):
    thing = plane(name, x, turned=True)
    thing.modifiers.new("Strands", "PARTICLE_SYSTEM")
    system = thing.particle_systems[0]
    system.settings.type = "HAIR"
    system.settings.count, system.settings.hair_length = 10, 1
    system.use_hair_dynamics = True

def body(name="Brick", x=12, z=2.0, kind="ACTIVE"):
    bpy.ops.mesh.primitive_cube_add(size=1, location=(x, 0, z))
    bpy.context.object.name = name
    bpy.ops.rigidbody.object_add(type=kind)

def canvas(name="Wall", x=15, touched=True):
    thing = plane(name, x, 0)
    modifier = thing.modifiers.new("Paint", "DYNAMIC_PAINT")
    bpy.ops.dpaint.type_toggle(type="CANVAS")
    bpy.ops.dpaint.output_toggle(output="A")
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.2, location=(x - 0.5, 0, 0 if touched else 5))
    brush = bpy.context.object
    brush.name = f"{name}Brush"
    brush.modifiers.new("Paint", "DYNAMIC_PAINT").ui_type = "BRUSH"
    bpy.ops.dpaint.type_toggle(type="BRUSH")
    brush.keyframe_insert("location", frame=1)
    brush.location.x = x + 0.5
    brush.keyframe_insert("location", frame=12)

def tank(name="Tank", x=20, drop=True, kind="LIQUID", flow="LIQUID", resolution=16, **settings):
    bpy.ops.mesh.primitive_cube_add(size=2, location=(x, 0, 1))
    bpy.context.object.name = name
    modifier = bpy.context.object.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    modifier.domain_settings.domain_type = kind
    modifier.domain_settings.resolution_max = resolution
    for key, value in settings.items():
        setattr(modifier.domain_settings, key, value)
    if drop:
        bpy.ops.mesh.primitive_ico_sphere_add(radius=0.4, location=(x, 0, 1))
        bpy.context.object.name = f"{name}Drop"
        modifier = bpy.context.object.modifiers.new("Fluid", "FLUID")
        modifier.fluid_type = "FLOW"
        modifier.flow_settings.flow_type = flow

def lowest(name, frame):
    scene.frame_set(frame)
    thing = bpy.data.objects[name].evaluated_get(bpy.context.evaluated_depsgraph_get())
    return round(min((thing.matrix_world @ vertex.co).z for vertex in thing.data.vertices), 4)

def painted(name, frame):
    scene.frame_set(frame)
    thing = bpy.data.objects[name].evaluated_get(bpy.context.evaluated_depsgraph_get())
    return sum(point.color[3] > 0.5 for point in thing.data.attributes["dp_paintmap"].data)
"""


def one(found: Any) -> dict[str, Any]:
    """The entry of the only cache."""
    (entry,) = found.data["caches"]
    return entry


# Which caches, which frames


def test_every_kind_of_cache_is_baked_over_the_scenes_range(session: LiveSession) -> None:
    session.run(f"{PARTS}\ncloth()\nsoft()\nemitter()\nhair()\nbody()\ncanvas()")
    seen: list[tuple[float, float | None, str]] = []
    found = session.use(TOOL, Call(progress=lambda *told: seen.append(told)))
    assert not found.failed
    assert found.data["range"] == [1, 12]
    caches = {cache["kind"]: cache for cache in found.data["caches"]}
    assert set(caches) == {"cloth", "soft_body", "particles", "hair", "rigid_body", "dynamic_paint"}
    for cache in caches.values():
        assert cache["baked"], cache
        assert (cache["range"], cache["missing"], cache["warning"]) == ([1, 12], 0, None), cache
        assert cache["bytes"] > 0
    assert caches["rigid_body"]["moved"] == pytest.approx(9.81 / 2 * (11 / 24) ** 2, rel=0.05)  # free fall
    assert 0.3 < caches["cloth"]["moved"] < caches["rigid_body"]["moved"]  # in air
    assert caches["rigid_body"]["who"] == "Brick"
    assert caches["dynamic_paint"]["unit"] == "of 1"
    done = [done for done, _, _ in seen]
    assert done == sorted(set(done))
    assert {total for _, total, _ in seen} == {done[-1]}
    assert "6 caches: frame 7 of 1–12" in [text for _, _, text in seen]


def test_the_range_is_set_from_the_arguments_and_the_scene_keeps_its_own(session: LiveSession) -> None:
    session.run(f"{PARTS}\ncloth()\nemitter()\nscene.frame_set(5)")
    found = session.use(TOOL, frame_start=3, frame_end=20)
    ranges = {cache["kind"]: cache["range"] for cache in found.data["caches"]}
    assert ranges["cloth"] == [3, 20]
    assert ranges["particles"][1] == 20
    assert session.run("s = bpy.context.scene\n(s.frame_start, s.frame_end, s.frame_current)") == (1, 12, 5)


@pytest.mark.parametrize("preview", [False, True])
def test_particles_are_not_baked_beyond_the_range(session: LiveSession, preview: bool) -> None:
    code = "scene.frame_end = 250\nscene.use_preview_range = True\nscene.frame_preview_end = 100"
    session.run(f"{PARTS}\nemitter()\n{code}\nscene.use_preview_range = {preview}")
    read = "s = bpy.context.scene\n(s.frame_start, s.frame_end, s.frame_preview_start, s.frame_preview_end)"
    before = session.run(read)
    if preview:
        assert one(session.use(TOOL, frame_end=10))["range"] == [1, 10]
    assert one(session.use(TOOL, frame_end=120))["range"] == [1, 107]  # the last of them dies at 106
    assert session.run(read) == before


def test_an_object_of_the_plan_is_baked_by_its_name(session: LiveSession) -> None:
    session.run(
        f"{PARTS}\ncloth('SailSheet')\ncloth('Flag', 3)\n"
        "sail = bpy.data.collections.new('Sail'); sail['protocol_role'] = 'object'\n"
        "scene.collection.children.link(sail); sail.objects.link(bpy.data.objects['SailSheet'])"
    )
    assert one(session.use(TOOL, objects=["Sail"]))["object"] == "SailSheet"
    assert session.use(TOOL, objects=["Sail"], free=True).text == "Freed: cloth of 'SailSheet'."


def test_only_what_is_asked_for_is_baked(session: LiveSession) -> None:
    session.run(f"{PARTS}\ncloth('Flag', 0)\ncloth('Sail', 3)\ntank()")
    found = session.use(TOOL, objects=["Sail"])
    assert one(found)["object"] == "Sail"
    state = session.run(
        "[(m.point_cache.is_baked, m.point_cache.frame_end, o.name) for o in bpy.data.objects for m in o.modifiers "
        "if m.type == 'CLOTH']"
    )
    assert sorted(state) == [(False, 250, "Flag"), (True, 12, "Sail")]
    tank = "bpy.data.objects['Tank'].modifiers[0]"
    assert session.run(f"{tank}.show_viewport, {tank}.domain_settings.cache_type") == (True, "REPLAY")


def test_any_rigid_body_stands_for_their_world(session: LiveSession) -> None:
    session.run(f"{PARTS}\nbody('A', 0)\nbody('B', 3)\ncloth('Flag', 6)")
    entry = one(session.use(TOOL, objects=["B"]))
    assert (entry["kind"], entry["object"], entry["bodies"]) == ("rigid_body", None, 2)


def test_baking_again_shows_what_was_changed(session: LiveSession) -> None:
    session.run(f"{PARTS}\ncloth()\ntank()")
    session.use(TOOL, frame_end=8)
    first = session.run(f"{PARTS}\nlowest('Flag', 8), lowest('Tank', 8)")
    session.run("bpy.context.scene.gravity.z = -3")
    session.use(TOOL, frame_end=8)
    cloth, liquid = session.run(f"{PARTS}\nlowest('Flag', 8), lowest('Tank', 8)")
    assert cloth > first[0] + 0.1
    assert liquid > first[1] + 0.1


def test_a_longer_bake_of_a_fluid_does_not_go_on_where_the_last_one_ended(session: LiveSession) -> None:
    session.run(f"{PARTS}\ntank()")
    session.use(TOOL, frame_end=5)
    entry = one(session.use(TOOL, frame_end=9))
    assert (entry["frames"], entry["missing"]) == (9, 0)


# What is refused


@pytest.mark.parametrize(
    ("code", "arguments", "words"),
    [
        ("pass", {}, "nothing to bake"),
        (
            "cloth()",
            {"objects": ["Flagg"]},
            r"no object or collection 'Flagg' in the scene 'Scene'. Nearest: 'Flag'",
        ),
        ("cloth()\nplane('Shelf', 3)", {"objects": ["Shelf"]}, r"no simulation of its own.*Flag"),
        ("cloth()", {"frame_start": 9, "frame_end": 9}, "not a range"),
        ("cloth()", {"frame_start": 50}, "not a range"),
        (
            "cloth()\nbpy.data.objects['Flag'].modifiers[0].point_cache.use_external = True",
            {},
            "use_external",
        ),
    ],
)
def test_what_cannot_be_baked_is_refused(
    session: LiveSession, code: str, arguments: dict[str, Any], words: str
) -> None:
    session.run(f"{PARTS}\n{code}")
    with pytest.raises(Refusal, match=words):
        session.use(TOOL, **arguments)


@pytest.mark.parametrize(
    "arguments", [{"frame_end": 1e9}, {"frame_start": -1}, {"objects": "all"}, {"timeout": 0}]
)
def test_arguments_out_of_bounds_are_refused(session: LiveSession, arguments: dict[str, Any]) -> None:
    with pytest.raises(Refusal, match="blender_bake"):
        session.use(TOOL, **arguments)


# What did not move


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (
            "cloth()\nflag = bpy.data.objects['Flag']\n"
            "flag.vertex_groups.new(name='Pin').add(range(49), 1, 'REPLACE')\n"
            "flag.modifiers[0].settings.vertex_group_mass = 'Pin'",
            "pinned by the vertex group 'Pin'",
        ),
        ("cloth()\nbpy.data.objects['Flag'].modifiers[0].show_viewport = False", "switched off"),
        ("cloth()\nbpy.data.objects['Flag'].hide_viewport = True", "hidden"),
        ("cloth()\nscene.use_gravity = False", "no gravity"),
        ("soft(use_goal=True)\nbpy.data.objects['Jelly'].modifiers[0].settings.goal_default = 1", "use_goal"),
        ("emitter(count=0)", "count is 0"),
        ("emitter(frame_start=40, frame_end=50)", "outside the range"),
        ("body(kind='PASSIVE')", "PASSIVE"),
        ("body()\nscene.rigidbody_world.enabled = False", "enabled"),
        ("body('Slab', 0, 0, 'PASSIVE')\nbody('Box', 0, 1)", "stable stack"),
        ("canvas(touched=False)", "no brush touches"),
        ("tank(drop=False)", "no flow object"),
        pytest.param("tank(flow='SMOKE')", "flow_type", marks=pytest.mark.whole),
        ("tank(kind='GAS', flow='LIQUID')", "flow_type"),
    ],
)
def test_a_bake_in_which_nothing_moved_names_the_likely_cause(
    session: LiveSession, code: str, words: str
) -> None:
    session.run(f"{PARTS}\n{code}")
    found = session.use(TOOL, frame_end=6)
    entry = one(found)
    assert words in (entry["warning"] or entry["fault"])
    assert words in found.text
    assert found.failed == (entry["fault"] is not None)


@pytest.mark.parametrize(
    "code",
    [
        "tank(use_mesh=False)",
        pytest.param("tank(kind='GAS', flow='SMOKE', use_noise=True)", marks=pytest.mark.whole),
        pytest.param("tank(kind='GAS', flow='SMOKE', use_adaptive_domain=True)", marks=pytest.mark.whole),
        "tank(kind='GAS', flow='FIRE', flame_smoke=0)",
    ],
)
def test_fluids_are_seen_to_move_in_every_form(session: LiveSession, code: str) -> None:
    session.run(f"{PARTS}\n{code}")
    found = session.use(TOOL, frame_end=6)
    assert one(found)["warning"] is None, found.text
    assert 0.05 < one(found)["moved"] < 1.0


def test_a_fluid_that_carries_other_things_is_baked_before_them(session: LiveSession) -> None:
    session.run(f"{PARTS}\nemitter()\ntank(resolution=8)\ntank('Sea', 30, resolution=8)")
    session.run(
        "bpy.ops.object.effector_add(type='FLUID')\n"
        "bpy.context.object.field.source_object = bpy.data.objects['Tank']"
    )
    seen: list[str] = []
    session.use(TOOL, Call(progress=lambda done, total, text: seen.append(text.split(":")[0])), frame_end=3)
    assert list(dict.fromkeys(seen))[:3] == ["liquid of 'Tank'", "particles of 'Tap'", "liquid of 'Sea'"]


# Where fluids lie


def test_fluids_lie_in_the_workspace_wherever_they_were_to_lie(session: LiveSession) -> None:
    session.run(
        f"{PARTS}\ntank(resolution=8, cache_directory='/tmp/elsewhere')\n"
        "tank('A b/ü', 24, resolution=8, cache_directory='/tmp/elsewhere')"
    )
    found = session.use(TOOL, frame_end=3)
    assert not found.failed, found.text
    folders = {cache["folder"] for cache in found.data["caches"]}
    assert len(folders) == 2
    workspace = str(session.blender.folder.workspace.mount)
    assert all(folder.startswith(f"{workspace}/cache/fluid/") for folder in folders)
    assert session.run(
        "[o.modifiers[0].domain_settings.cache_directory[:2] for o in bpy.data.objects "
        "if o.modifiers[0].fluid_type == 'DOMAIN']"
    ) == ["//", "//"]


def test_old_bakes_are_removed(session: LiveSession) -> None:
    session.run(f"{PARTS}\ntank('Vat', resolution=8)")
    for _ in range(5):
        session.use(TOOL, frame_end=2)
    place = session.blender.folder.workspace.mount / "cache" / "fluid" / "Vat"
    assert sorted(folder.name for folder in place.iterdir()) == ["0003", "0004", "0005"]


# What survives


def test_a_bake_is_kept_as_a_checkpoint(session: LiveSession) -> None:
    session.run(f"{PARTS}\nemitter()\ncanvas()\ntank()")
    assert not session.use(TOOL).failed
    last = session.blender.checkpoints.last
    assert last is not None
    assert last.after == "after baking"
    read = f"{PARTS}\nlowest('Tank', 9), painted('Wall', 4), painted('Wall', 12)"
    before = session.run(read)
    assert 0 < before[1] < before[2]
    session.blender.kill()
    assert session.run(read) == before


def test_edit_mode_is_left_for_a_bake(session: LiveSession) -> None:
    session.run(f"{PARTS}\ncloth()\nbpy.ops.object.mode_set(mode='EDIT')")
    found = session.use(TOOL)
    assert "EDIT mode" in found.text
    assert one(found)["moved"] > 0.5


def test_cancelled_bake_keeps_the_last_one(session: LiveSession) -> None:
    session.run(f"{PARTS}\ntank()")
    session.use(TOOL, frame_end=6)
    read = f"{PARTS}\nlowest('Tank', 2), lowest('Tank', 6)"
    before = session.run(read)
    call = Call(cancelled=threading.Event())

    def give_up(done: float, total: float | None, text: str) -> None:
        if done >= 3:
            call.cancelled.set()

    with pytest.raises(Interrupted, match="checkpoint"):
        session.use(TOOL, Call(progress=give_up, cancelled=call.cancelled), frame_end=100_000)
    assert session.run(read) == before
    assert not session.use(TOOL, frame_end=8).failed


def test_a_bake_past_its_deadline_is_undone(session: LiveSession) -> None:
    session.run(f"{PARTS}\ncloth()")
    with pytest.raises(TookTooLong, match="deadline of 1 s"):
        session.use(TOOL, frame_end=1_000_000, timeout=1)
    cache = "bpy.data.objects['Flag'].modifiers[0].point_cache"
    assert session.run(f"{cache}.is_baked, {cache}.frame_end") == (False, 250)
    assert not session.use(TOOL).failed
