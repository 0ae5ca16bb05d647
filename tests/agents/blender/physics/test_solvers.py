"""Every solver baked from code sent to Blender, and the results checked physically."""

from __future__ import annotations

import shutil
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import pytest
from live_session import LiveSession

from agents.blender.tools.bake import TOOL
from agents.blender.tools.files import LOAD, SAVE
from agents.blender.tools.scene_state import TOOL as SCENE_STATE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

pytestmark = pytest.mark.blender

LAST = 60
LAST_OF_FLUIDS = 24

# Each solver on a stage of its own, 20 m apart.
BUILD = """
import bmesh

def cube(name, size, location, scale=(1, 1, 1)):
    bpy.ops.mesh.primitive_cube_add(size=size, location=location)
    bpy.context.object.name = name
    bpy.context.object.scale = scale
    return bpy.context.object

def floor(name, x, solver):
    slab = cube(name, 1, (x, 0, -0.5), (16, 16, 1))
    if solver == "RIGID":
        bpy.ops.rigidbody.object_add(type="PASSIVE")
    else:
        slab.modifiers.new("Collision", "COLLISION")
    return slab

# Cloth
floor("Floor", 0, "CLOTH")
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5, location=(0, 0, 0.5), segments=24, ring_count=12)
bpy.context.object.modifiers.new("Collision", "COLLISION")
bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20, size=2, location=(0, 0, 1.1))
bpy.context.object.name = "Sheet"
bpy.context.object.modifiers.new("Cloth", "CLOTH")

# Rigid bodies: one tower that stands, one that leans too far
floor("Ground", 20, "RIGID")
for tower, lean in (("Straight", 0.0), ("Leaning", 0.15)):
    for number in range(5):
        y = 2.0 if lean else -2.0
        cube(f"{tower}{number}", 0.5, (20 + lean * number, y, 0.25 + 0.5 * number))
        bpy.ops.rigidbody.object_add()
        bpy.context.object.rigid_body.collision_shape = "BOX"

# Particles
floor("Tray", 40, "PARTICLES").collision.damping_factor = 0.5
bpy.ops.mesh.primitive_plane_add(size=1, location=(40, 0, 2))
bpy.context.object.name = "Tap"
bpy.context.object.modifiers.new("Rain", "PARTICLE_SYSTEM")
rain = bpy.context.object.particle_systems[0].settings
rain.count, rain.frame_start, rain.frame_end, rain.lifetime, rain.normal_factor = 200, 1, 10, 200, 0

# Soft body
floor("Mat", 60, "SOFT")
jelly = cube("Jelly", 1, (60, 0, 1))
edit = bmesh.new()
edit.from_mesh(jelly.data)
bmesh.ops.subdivide_edges(edit, edges=edit.edges, cuts=4, use_grid_fill=True)
edit.to_mesh(jelly.data)
settings = jelly.modifiers.new("Softbody", "SOFT_BODY").settings
settings.use_goal, settings.use_stiff_quads, settings.shear = False, True, 0.5
settings.pull = settings.push = 0.6
settings.bend, settings.damping, settings.friction, settings.mass = 0.1, 5, 0.5, 3

# Liquid: a block of it, let go at one end of a tank
def fluid(owner, kind, **settings):
    modifier = owner.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = kind
    part = modifier.domain_settings if kind == "DOMAIN" else modifier.flow_settings
    for name, value in settings.items():
        setattr(part, name, value)

tank = cube("Tank", 1, (80, 0, 0.5), (2, 1, 1))
fluid(tank, "DOMAIN", domain_type="LIQUID", resolution_max=32, use_mesh=True, mesh_particle_radius=1.5)
fluid(cube("Block", 1, (79.45, 0, 0.35), (0.9, 1.1, 0.7)), "FLOW", flow_type="LIQUID", flow_behavior="GEOMETRY")

# Gas
fluid(cube("Air", 1, (100, 0, 1), (1, 1, 2)), "DOMAIN", domain_type="GAS", resolution_max=32)
bpy.ops.mesh.primitive_ico_sphere_add(radius=0.2, location=(100, 0, 0.4))
fluid(bpy.context.object, "FLOW", flow_type="SMOKE", flow_behavior="INFLOW")
"""

READ = """
import bmesh
from mathutils import Vector

def seen(name):
    return bpy.data.objects[name].evaluated_get(bpy.context.evaluated_depsgraph_get())

def corners(name):
    thing = seen(name)
    return [thing.matrix_world @ vertex.co for vertex in thing.data.vertices]

def rounded(found):
    if isinstance(found, dict):
        return {key: rounded(value) for key, value in found.items()}
    if isinstance(found, (list, tuple)):
        return [rounded(value) for value in found]
    return round(found, 3) if isinstance(found, float) else found

def sheet():
    points = corners("Sheet")
    distance = min((point - Vector((0, 0, 0.5))).length for point in points)
    return {"low": min(p.z for p in points), "high": max(p.z for p in points), "distance": distance}

def tower(name):
    return [tuple(seen(f"{name}{number}").matrix_world.translation) for number in range(5)]

def rain():
    heights = [p.location.z for p in seen("Tap").particle_systems[0].particles if p.alive_state == "ALIVE"]
    return {"count": len(heights), "low": min(heights, default=None), "high": max(heights, default=None)}

def jelly():
    heights = [point.z for point in corners("Jelly")]
    return {"low": min(heights), "height": max(heights) - min(heights)}

def liquid():
    thing = seen("Tank")
    mesh = bmesh.new()
    mesh.from_mesh(thing.data)
    mesh.transform(thing.matrix_world)
    points = [vertex.co.copy() for vertex in mesh.verts]
    volume = mesh.calc_volume()
    mesh.free()
    level = max(point.z for point in points if point.x < 79.5)
    return {"volume": volume, "front": max(point.x for point in points), "level": level}

def gas():
    domain = seen("Air").modifiers["Fluid"].domain_settings
    layer = domain.domain_resolution[0] * domain.domain_resolution[1]
    density = domain.density_grid[:]
    layers = [sum(density[n : n + layer]) for n in range(0, len(density), layer)]
    middle = sum(number * amount for number, amount in enumerate(layers)) / max(sum(layers), 1e-9)
    return {"amount": sum(layers), "middle": (middle + 0.5) / len(layers) * 2}

def at(frames, *what):
    found = {}
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        found[frame] = {read.__name__: rounded(read()) for read in what}
    return found
"""
FINGERPRINT = (
    f"{READ}\ndef towers(): return tower('Leaning')\nat((1, 12, 24), sheet, towers, rain, jelly, liquid, gas)"
)


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveSession]:
    """All solvers, baked."""
    session = LiveSession(tmp_path_factory.mktemp("solvers"))
    session.run(BUILD)
    points = ["Sheet", "Straight0", "Tap", "Jelly"]
    for objects, last in ((points, LAST), (["Tank", "Air"], LAST_OF_FLUIDS)):
        found = session.use(TOOL, objects=objects, frame_start=1, frame_end=last)
        assert not found.failed, found.text
        assert not [cache["warning"] for cache in found.data["caches"] if cache["warning"]], found.text
    yield session
    session.blender.close()


def read(session: LiveSession, what: str, frames: range) -> list[Any]:
    """What a function of READ tells at every frame."""
    found = session.run(f"{READ}\nat({list(frames)}, {what})")
    return [found[frame][what] for frame in frames]


def test_cloth_lies_on_the_sphere_and_not_in_the_floor(stage: LiveSession) -> None:
    before, after = read(stage, "sheet", range(1, LAST + 1, LAST - 1))
    assert before["high"] == pytest.approx(1.1, abs=0.001)
    assert after["distance"] > 0.5
    assert 1.0 < after["high"] < 1.06
    assert 0.0 < after["low"] < 0.2


def test_a_straight_tower_stands_and_a_leaning_one_topples(stage: LiveSession) -> None:
    straight, leaning = stage.run(
        f"{READ}\nbpy.context.scene.frame_set({LAST})\ntower('Straight'), tower('Leaning')"
    )
    for number, (x, y, z) in enumerate(straight):
        assert (x, y, z) == pytest.approx((20, -2, 0.25 + 0.5 * number), abs=0.02)
    assert leaning[0][2] == pytest.approx(0.25, abs=0.02)
    assert leaning[4][2] < 1.0
    assert all(z > 0.2 for _, _, z in leaning)


def test_particles_collide_with_the_tray(stage: LiveSession) -> None:
    rain = read(stage, "rain", range(5, LAST + 1, 2))
    assert rain[-1]["count"] == 200
    assert min(frame["low"] for frame in rain) > -0.001
    assert rain[0]["high"] > 1.5
    assert rain[-1]["high"] < 0.2
    lows = [frame["low"] for frame in rain]
    assert any(later > earlier + 0.05 for earlier, later in pairwise(lows)), "none bounced"


def test_a_soft_body_squashes_and_recovers(stage: LiveSession) -> None:
    jelly = read(stage, "jelly", range(2, LAST + 1, 2))
    assert jelly[0]["height"] == pytest.approx(1.0, abs=0.001)
    assert min(frame["height"] for frame in jelly) < 0.88
    assert jelly[-1]["height"] == pytest.approx(1.0, abs=0.08)
    assert min(frame["low"] for frame in jelly) > -0.02


def test_liquid_keeps_its_volume_and_reaches_the_far_wall(stage: LiveSession) -> None:
    liquid = read(stage, "liquid", range(1, LAST_OF_FLUIDS + 1))
    block = liquid[0]["volume"]
    assert block == pytest.approx(0.9 * 1.0 * 0.7, rel=0.3)  # less a cell along the walls
    for frame in liquid:
        assert frame["volume"] == pytest.approx(block, rel=0.2)
    assert liquid[0]["front"] < 80.0
    assert liquid[-1]["front"] == pytest.approx(81.0, abs=0.1)
    assert liquid[0]["level"] == pytest.approx(0.7, abs=0.05)
    assert liquid[-1]["level"] < 0.5


def test_smoke_rises(stage: LiveSession) -> None:
    gas = read(stage, "gas", range(1, LAST_OF_FLUIDS + 1, 4))
    heights = [frame["middle"] for frame in gas]
    assert heights[0] == pytest.approx(0.4, abs=0.1)
    assert heights == sorted(heights)
    assert heights[-1] > heights[0] + 0.2
    amounts = [frame["amount"] for frame in gas]
    assert amounts == sorted(amounts)


def test_a_baked_domain_tells_of_the_parts_that_it_has(stage: LiveSession) -> None:
    state = stage.use(SCENE_STATE, objects=["Tank", "Air"], sections=["physics"])
    domains = {one["name"]: one for one in state.data["physics"] if one["kind"] == "fluid_domain"}
    assert domains["Tank"]["cache"]["baked"] == ["data", "mesh"]
    assert domains["Air"]["cache"]["baked"] == ["data"]
    assert "settings" not in domains["Air"]


def test_baked_physics_is_there_again_after_a_crash(stage: LiveSession) -> None:
    before = stage.run(FINGERPRINT)
    stage.blender.kill()
    assert stage.run(FINGERPRINT) == before


def test_saved_physics_opens_elsewhere_in_a_fresh_process(
    stage: LiveSession, make_session: Callable[[str], LiveSession]
) -> None:
    before = stage.run(FINGERPRINT)
    saved = stage.use(SAVE, name="solvers")
    assert not saved.failed, saved.text
    other = make_session("elsewhere")
    ours, theirs = other.blender.folder.root, stage.blender.folder.root
    shutil.copyfile(theirs / "solvers.blend", ours / "solvers.blend")
    shutil.copytree(theirs / "blendcache_solvers", ours / "blendcache_solvers")
    other.use(LOAD, path="solvers.blend")
    assert other.run(FINGERPRINT) == before
