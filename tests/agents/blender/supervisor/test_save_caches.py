"""Saving with caches in any state, of all solvers: no state loses the scene, and what is baked stays baked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from live_session import LiveSession

from agents.blender.tools.files import LOAD, SAVE
from agents.blender.tools.render import TOOL as RENDER
from agents.blender.tools.verify import TOOL as VERIFY

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.blender

LAST = 4
# A scene with all solvers; ON_DISK, FOLDER say where their caches are.
SOLVERS = """
scene = bpy.context.scene
scene.frame_end = LAST

def grid(name, place):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=1, location=(place, 0, 1))
    bpy.context.object.name = name
    return bpy.context.object

def fluid(name, kind, flow, place):
    bpy.ops.mesh.primitive_ico_sphere_add(radius=0.5, location=(place, 4, 0))
    modifier = bpy.context.object.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "FLOW"
    modifier.flow_settings.flow_type = flow
    bpy.ops.mesh.primitive_cube_add(size=2, location=(place, 4, 0))
    bpy.context.object.name = name
    modifier = bpy.context.object.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    domain = modifier.domain_settings
    domain.domain_type, domain.resolution_max, domain.cache_frame_end = kind, 8, LAST
    domain.cache_type = "REPLAY"
    if FOLDER:
        domain.cache_directory = FOLDER + name

grid("Cloth", 0).modifiers.new("Cloth", "CLOTH")
grid("Soft", 2).modifiers.new("Softbody", "SOFT_BODY")
grid("Rigid", 4)
bpy.ops.rigidbody.object_add()
grid("Emitter", 6)
bpy.ops.object.particle_system_add()
settings = bpy.context.object.particle_systems[0].settings
settings.count, settings.frame_start, settings.frame_end, settings.lifetime = 20, 1, LAST, 9
grid("Paint", 8).modifiers.new("Paint", "DYNAMIC_PAINT")
bpy.ops.dpaint.type_toggle(type="CANVAS")
surface = bpy.context.object.modifiers["Paint"].canvas_settings.canvas_surfaces[0]
surface.surface_format, surface.frame_end = "VERTEX", LAST
brush = grid("Brush", 8).modifiers.new("Paint", "DYNAMIC_PAINT")
brush.ui_type = "BRUSH"
bpy.ops.dpaint.type_toggle(type="BRUSH")
fluid("Liquid", "LIQUID", "LIQUID", 0)
fluid("Gas", "GAS", "SMOKE", 4)
bpy.ops.object.camera_add(location=(5, -9, 6), rotation=(1.1, 0, 0))
scene.camera = bpy.context.object

def points():
    things = bpy.data.objects
    return [
        things["Cloth"].modifiers["Cloth"].point_cache,
        things["Soft"].modifiers["Softbody"].point_cache,
        scene.rigidbody_world.point_cache,
        things["Emitter"].particle_systems[0].point_cache,
        things["Paint"].modifiers["Paint"].canvas_settings.canvas_surfaces[0].point_cache,
    ]

def domains():
    return [bpy.data.objects[name].modifiers["Fluid"].domain_settings for name in ("Liquid", "Gas")]

for cache in points():
    cache.frame_end = LAST
    if ON_DISK and cache != scene.rigidbody_world.point_cache:  # Blender crashes over that one
        cache.use_disk_cache = True

def step(*frames):
    for frame in frames:
        scene.frame_set(frame)

def bake():
    for place in range(len(points())):
        with bpy.context.temp_override(point_cache=points()[place]):
            bpy.ops.ptcache.bake(bake=True)
    for name in ("Liquid", "Gas"):
        bpy.context.view_layer.objects.active = bpy.data.objects[name]
        bpy.data.objects[name].modifiers["Fluid"].domain_settings.cache_type = "ALL"
        bpy.ops.fluid.bake_all()

def reach_further():
    for cache in points():
        cache.frame_end = LAST + 3
    for domain in domains():
        domain.cache_frame_end = LAST + 3

def change():
    scene.gravity[2] = -1
    for domain in domains():
        domain.alpha = 2
"""
STATES = {
    "none": "",
    "half stepped": "step(1, 2)",
    "stepped": "step(*range(1, LAST + 1))",
    "back at the start": "step(*range(1, LAST + 1), 1)",
    "half baked": "bake()\nreach_further()",
    "outdated": "bake()\nchange()",
    "baked": "bake()",
}
CELLS = [
    *((state, "where Blender puts them") for state in STATES),
    ("back at the start", "on disk"),
    ("baked", "on disk"),
]
# One that is baked in part, and one that is and on disk. What was stepped and is not baked, others save.
_IN_PART = {CELLS[4], CELLS[-1]}


def build(state: str, place: str) -> str:
    """Code that makes the scene, with its caches in that state and place."""
    folder = f"//told/{state.replace(' ', '_')}/"  # a bake over frames of another simulation keeps those
    where = ("True", repr(folder)) if place == "on disk" else ("False", "''")
    code = SOLVERS.replace("LAST", str(LAST))
    return code.replace("ON_DISK", where[0]).replace("FOLDER", where[1]) + STATES[state].replace(
        "LAST", str(LAST)
    )


@pytest.fixture(scope="module")
def _run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveSession]:
    made = LiveSession(tmp_path_factory.mktemp("caches") / "run")
    made.use(SAVE, name="empty", verify=False)
    yield made
    made.blender.close()


@pytest.fixture
def session(_run: LiveSession) -> LiveSession:
    """The run's own file, empty: relative folders are those of the run."""
    _run.use(LOAD, path="empty")
    return _run


@pytest.mark.parametrize(
    ("state", "place"),
    [pytest.param(*cell, marks=() if cell in _IN_PART else pytest.mark.whole) for cell in CELLS],
)
def test_a_scene_is_saved_whatever_state_its_caches_are_in(
    session: LiveSession, state: str, place: str
) -> None:
    session.run(build(state, place))
    session.use(VERIFY)
    saved = session.use(SAVE, name="state")
    here = {cache["label"]: cache for cache in saved.data["caches"]}
    there = {cache["label"]: cache for cache in saved.data["opened"]["caches"]}
    assert len(here) == 7
    assert saved.data["opened"]["objects"] == saved.data["objects"] == 11
    assert not [file for file in saved.data["external"] if "cache" in file["path"]]
    baked = {label: cache["frames"] for label, cache in here.items() if cache["baked"]}
    assert len(baked) == {"baked": 7, "half baked": len(baked), "outdated": len(baked)}.get(state, 0)
    assert {label: there[label]["frames"] for label in baked} == baked
    # Of paint, Blender bakes no frame that changes nothing.
    assert [label for label in baked if baked[label] < LAST] in ([], ["dynamic paint of 'Paint'"])
    assert saved.failed is any(here[label]["missing"] for label in baked)
    loaded = session.use(LOAD, path="state")
    again = {cache["label"]: cache["frames"] for cache in loaded.data["caches"] if cache["baked"]}
    assert (loaded.data["objects"], again) == (11, baked)
    if state in ("back at the start", "baked"):
        shown = session.use(
            RENDER, kind="animation", engine="cycles", samples=1, width=32, height=32, frame_end=2
        )
        assert not shown.failed, shown.text
        assert (shown.data["unbaked"] == []) is (state == "baked")


def test_a_fluid_baked_by_code_outlives_the_blender_that_baked_it(session: LiveSession) -> None:
    session.run(build("baked", "where Blender puts them"))
    number = session.blender.keep("baked").number
    caches = session.use(LOAD, checkpoint=number).data["caches"]
    fluids = [cache for cache in caches if cache["label"].endswith(("'Liquid'", "'Gas'"))]
    assert [(cache["baked"], cache["missing"]) for cache in fluids] == [(True, 0)] * 2


def test_tells_what_is_lost_because_nothing_uses_it(session: LiveSession) -> None:
    session.run(
        "bpy.data.materials.new('Velvet')\nbpy.data.materials.new('Kept').use_fake_user = True\n"
        "bpy.ops.mesh.primitive_cube_add()\nbpy.context.object.data.materials.append(bpy.data.materials.new('Worn'))"
    )
    saved = session.use(SAVE, name="materials", verify=False)
    assert saved.data["unused"] == ["material 'Velvet'"]
    assert "not in the file, since nothing uses it: material 'Velvet'" in saved.text
