"""The solvers' sheets: short, given where they are needed, and recipes that do in Blender what they promise."""

from __future__ import annotations

import math
import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from live_session import LiveSession

from agents.blender.tool_catalogue import TOOLS
from agents.plan.edit import EditedActor
from agents.plan.part import STAGES
from agents.plan.scene import ScenePlan
from agents.protocol.tolerances import TOLERANCES
from agents.roles.names import ROLES
from agents.roles.prompts import system_prompt
from agents.roles.sheets import SOLVERS, sheet, solvers_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.roles.sheets import Solver

LONGEST = 3_000
_RECIPE = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)

# What the recipes are tried on, and what is measured: the value of the last expression.
HELPERS = """
import bpy
from mathutils import Vector

scene = bpy.context.scene
scene.render.fps, scene.frame_start, scene.frame_end = 24, 1, 60

def box(name, size, place):
    bpy.ops.mesh.primitive_cube_add(size=1, location=place)
    made = bpy.context.object
    made.name = name
    for vertex in made.data.vertices:
        vertex.co = [length * share for length, share in zip(size, vertex.co)]
    made.data.update()
    bpy.context.view_layer.update()
    return made

def ball(name, radius, place):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=radius, location=place)
    bpy.context.object.name = name
    return bpy.context.object

def points(obj):
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    found = [evaluated.matrix_world @ vertex.co for vertex in mesh.vertices]
    evaluated.to_mesh_clear()
    return found

def heights(obj):
    return [point.z for point in points(obj)]

def mean(values):
    return sum(values) / len(values)

def over(frames, measure):
    found = []
    for frame in range(1, frames + 1):
        scene.frame_set(frame)
        found.append(measure())
    return found
"""
CLOTH = """
bpy.ops.mesh.primitive_grid_add(x_subdivisions=12, y_subdivisions=12, size=1, location=(0, 0, 1.2))
sheet = bpy.context.object
table = box("Table", (0.4, 0.4, 0.6), (0, 0, 0.3))
floor = box("Floor", (4, 4, 0.2), (0, 0, -0.1))
cloth(sheet, [table, floor])
over(60, lambda: (mean(heights(sheet)), min(heights(sheet)), max(heights(sheet))))
"""
# The time of a sheet's frames with self collision, as a multiple of that without.
FOLDING = """
import time

def spent(distance):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=30, y_subdivisions=30, size=1, location=(0, 0, 0.75))
    contact = cloth(bpy.context.object, [table]).collision_settings
    contact.use_self_collision, contact.self_distance_min = distance is not None, distance or 0.001
    began = time.process_time()
    over(24, lambda: None)
    bpy.data.objects.remove(bpy.context.object)
    return time.process_time() - began

table = box("Table", (0.3, 0.3, 0.3), (0, 0, 0.45))
spent(DISTANCE) / min(spent(None), spent(None))
"""
PINNED = """
bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=1, location=(0, 0, 2))
sheet = bpy.context.object
edge = [vertex.index for vertex in sheet.data.vertices if vertex.co.y > 0.49]
settings = cloth(sheet, [], edge).settings
for frame, held in ((12, 1.0), (13, 0.0)):
    settings.pin_stiffness = held
    settings.keyframe_insert("pin_stiffness", frame=frame)
over(20, lambda: max(heights(sheet)))
"""
# A box that stands on end and is let fall, not quite straight.
SOFT = """
import math
from mathutils import Matrix

body = box("Body", (0.08, 0.08, 0.14), (0, 0, 0.21))
made = bmesh.new()
made.from_mesh(body.data)
bmesh.ops.subdivide_edges(made, edges=made.edges, cuts=8, use_grid_fill=True)
made.transform(Matrix.Rotation(math.radians(4), 4, "X"))
made.to_mesh(body.data)
made.free()
top = [vertex.index for vertex in body.data.vertices if vertex.co.z > 0.05]
floor = box("Floor", (2, 2, 0.1), (0, 0, -0.05))
soft(body, [floor])

def pose():
    places = points(body)
    spine = sum((places[index] for index in top), Vector()) / len(top) - sum(places, Vector()) / len(places)
    heights = [place.z for place in places]
    lean = math.degrees(spine.angle(Vector((0, 0, 1))))
    return [round(value, 5) for value in (mean(heights), min(heights), max(heights), lean)]

over(48, pose)
"""
LIMP = """
def strut(body):
    body.vertex_groups.new(name="Mass").add(range(len(body.data.vertices)), 1, "REPLACE")
"""
RIGID = """
body = ball("Body", 0.1, (0, 0, 0.4))
floor = box("Floor", (4, 4, 0.2), (0, 0, -0.1))
post = box("Post", (0.1, 0.1, 2), (1, 0, 1))
plank = box("Plank", (0.8, 0.1, 0.04), (1.47, 0, 1.5))
rigid(body, shape="SPHERE")
rigid(floor, shape="BOX", passive=True)
rigid(post, shape="BOX", passive=True)
rigid(plank, shape="BOX").angular_damping = 0.5
hinge("Hinge", plank, post, (1.05, 0, 1.5), (0, 1, 0), (0, 60))

def pose():
    fallen = (plank.matrix_world.to_3x3() @ Vector((1, 0, 0))).angle(Vector((1, 0, 0)))
    return body.matrix_world.translation.z, fallen

over(60, pose)
"""
# A crate that stands on the floor, with its origin a metre beside its mesh, and a rider that is parented to it.
STANDING = """
floor = box("Floor", (4, 4, 0.2), (0, 0, -0.1))
crate = box("Crate", (0.3, 0.3, 0.3), (0, 0, 0.15))
for vertex in crate.data.vertices:
    vertex.co.x += 1
rider = box("Rider", (0.1, 0.1, 0.1), (1, 0, 0.35))
rider.parent, rider.matrix_parent_inverse = crate, crate.matrix_world.inverted()
before = points(crate), points(rider)
centre(crate)
bpy.context.view_layer.update()
stayed = max((a - b).length for one, old in zip((crate, rider), before) for a, b in zip(points(one), old))
rigid(floor, shape="BOX", passive=True)
rigid(crate, shape=SHAPE)
stayed, over(24, lambda: max((a - b).length for a, b in zip(points(crate), before[0])))
"""
LIQUID = """
import bmesh

domain = box("Domain", (0.3, 0.2, 0.2), (0, 0, 0.1))
body = box("Body", (0.1, 0.15, 0.12), (-0.08, 0, 0.075))
liquid(domain, [body], cells=24)

def surface():
    found = points(domain)
    evaluated = domain.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = bmesh.new()
    mesh.from_mesh(evaluated.data)
    volume = mesh.calc_volume()
    mesh.free()
    low = [min(point[axis] for point in found) for axis in range(3)]
    high = [max(point[axis] for point in found) for axis in range(3)]
    return volume / (0.1 * 0.15 * 0.12), low, high

over(10, surface)
"""
GAS = """
domain = box("Domain", (0.5, 0.5, 1), (0, 0, 0.5))
source = ball("Source", 0.08, (0, 0, 0.15))
gas(domain, source, cells=24)

def column():
    settings = domain.evaluated_get(bpy.context.evaluated_depsgraph_get()).modifiers[0].domain_settings
    across, deep, high = settings.domain_resolution
    grid = list(settings.density_grid)
    layers = [max(grid[k * across * deep:(k + 1) * across * deep], default=0) for k in range(high)]
    return sum(grid), max((k + 1 for k in range(high) if layers[k] > 0.05), default=0) / high

over(12, column)
"""
# A flag in gusts, and a body that falls past it.
WIND = """
def flag():
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=12, size=1)
    made = bpy.context.object
    for vertex in made.data.vertices:
        vertex.co = (vertex.co.x + 0.5, 0, 2 + 0.6 * vertex.co.y)
    return made

sheet, body = flag(), ball("Body", 0.1, (3, 0, 5))
settings = cloth(sheet, [], [v.index for v in sheet.data.vertices if v.co.x < 0.01]).settings
settings.mass = 0.1
sheet.modifiers[-1].collision_settings.use_self_collision = False
bpy.ops.rigidbody.object_add()
scene.rigidbody_world.effector_weights.wind = 0
blower = bpy.data.objects.new("Blower", None)
scene.collection.objects.link(blower)
blower.location = (-1, 0, 2)
wind(blower, (0.97, 0.25, 0), 3000, [(1, 1), (24, 1), (36, 0.1), (60, 0.1), (72, 1)])
free = [v.index for v in sheet.data.vertices if v.co.x > 0.99]

def edge():
    places = points(sheet)
    middle = [mean([places[index][axis] for index in free]) for axis in range(2)]
    return [round(value, 3) for value in (*middle, body.matrix_world.translation.x)]

over(96, edge)
"""
PARTICLES = """
emitter = box("Emitter", (0.2, 0.2, 0.05), (0, 0, 0.5))
floor = box("Floor", (4, 4, 0.2), (0, 0, -0.1))
emit(emitter, [floor], count=40, end=12, radius=0.02)

def grains():
    graph = bpy.context.evaluated_depsgraph_get()
    alive = [one for one in emitter.evaluated_get(graph).particle_systems[0].particles if one.alive_state == "ALIVE"]
    return [(one.location.z, one.velocity.length) for one in alive]

over(60, grains)[-1]
"""


def recipe(solver: Solver) -> str:
    (code,) = _RECIPE.findall(sheet(solver))
    return code


@pytest.fixture(scope="module")
def _installed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveSession]:
    """The Blender that is installed, of another version."""
    if (program := shutil.which("blender")) is None:
        pytest.skip("no blender on PATH")
    session = LiveSession(tmp_path_factory.mktemp("installed"), blender_exe=Path(program))
    yield session
    session.blender.close()


@pytest.fixture(params=["the bpy package", pytest.param("installed", marks=pytest.mark.whole)])
def blender(request: pytest.FixtureRequest) -> LiveSession:
    """An empty scene in each Blender that this machine has."""
    session: LiveSession = request.getfixturevalue(
        "session" if request.param == "the bpy package" else "_installed"
    )
    session.empty()
    return session


def tried(blender: LiveSession, solver: Solver, scene: str) -> Any:
    return blender.run(f"{HELPERS}\n{recipe(solver)}\n{scene}")


def fall(heights: list[float], frames: int) -> float:
    """The mean acceleration over the first frames, at 24 a second, in m/s²."""
    return 2 * (heights[0] - heights[frames]) / (frames / 24) ** 2


def test_a_cloth_falls_as_things_fall_and_comes_to_rest_on_what_is_below(blender: LiveSession) -> None:
    seen = tried(blender, "cloth", CLOTH)
    middles = [mean for mean, _, _ in seen]
    assert 7 < fall(middles, 4) < 13
    assert min(low for _, low, _ in seen) > -0.005, "nothing goes through the floor"
    assert 0.6 < seen[-1][2] < 0.65, "its middle lies on the table"
    assert seen[-1][1] < 0.5, "its sides hang"
    assert abs(middles[-1] - middles[-7]) < 0.02


@pytest.mark.whole  # it measures time, which a busy machine may not have
@pytest.mark.parametrize(
    ("share", "words", "times"),
    [
        (0.2, "a fifth of an edge of the mesh, 2 times", 2),
        (0.5, "half an edge, 9", 9),
        (0.8, "four fifths, 24", 24),
    ],
)
def test_self_collision_costs_what_the_sheet_says(
    blender: LiveSession, share: float, words: str, times: int
) -> None:
    assert words in sheet("cloth")
    spent = tried(blender, "cloth", FOLDING.replace("DISTANCE", str(share / 30)))
    assert times / 2 < spent < times * 2


def test_pins_hold_until_they_are_let_go(blender: LiveSession) -> None:
    highest = tried(blender, "cloth", PINNED)
    assert highest[11] > 1.95
    assert highest[-1] < 1.8


def test_a_soft_body_gives_way_and_stays_upright(blender: LiveSession) -> None:
    seen = tried(blender, "soft", SOFT)
    assert 7 < fall([mean for mean, *_ in seen], 4) < 13
    heights = [(high - low) / 0.145 for _, low, high, _ in seen]
    assert min(heights) < 0.99, "it yields"
    assert heights[-1] > 0.93, "it springs back"
    assert max(lean for *_, lean in seen) < 25
    assert seen[-1][3] < 10, "it stands"
    gap = TOLERANCES.contact_gap(math.hypot(0.08, 0.08, 0.14))
    assert abs(seen[-1][1]) <= gap, "R5: it neither floats nor sinks in"
    assert min(low for _, low, *_ in seen) > -gap


def test_a_soft_body_without_struts_and_weight_below_lies_down(blender: LiveSession) -> None:
    seen = tried(blender, "soft", LIMP + SOFT)
    assert (seen[-1][2] - seen[-1][1]) / 0.145 < 0.8 or seen[-1][3] > 30


def test_a_rigid_body_rests_and_a_hinge_stops_at_its_limit(blender: LiveSession) -> None:
    seen = tried(blender, "rigid", RIGID)
    assert seen[-1][0] == pytest.approx(0.1, abs=0.003)
    fallen = [angle for _, angle in seen]
    assert fallen[-1] == pytest.approx(1.047, abs=0.08)
    assert max(fallen) < 1.2


@pytest.mark.parametrize("shape", ["BOX", "CONVEX_HULL", "MESH"])
def test_a_rigid_body_that_stands_stays(blender: LiveSession, shape: str) -> None:
    moved, seen = tried(blender, "rigid", STANDING.replace("SHAPE", repr(shape)))
    assert moved == pytest.approx(0, abs=1e-5), "only the origin moves"
    assert max(seen) < 0.0005


def test_a_liquid_spreads_in_its_domain_and_keeps_its_volume(blender: LiveSession) -> None:
    seen = tried(blender, "liquid", LIQUID)
    assert all(0.7 < volume < 1.4 for volume, _, _ in seen)
    assert seen[-1][2][0] > seen[0][2][0] + 0.03, "it flows"
    for _, low, high in seen:
        assert low[0] >= -0.15
        assert low[2] >= 0
        assert high[0] <= 0.15
        assert high[2] <= 0.2


def test_smoke_rises_from_its_source_below_the_lid(blender: LiveSession) -> None:
    seen = tried(blender, "gas", GAS)
    amounts, tops = zip(*seen, strict=True)
    assert 0 < amounts[0] < amounts[-1]
    assert tops[0] < 0.35
    assert tops[0] + 0.1 < tops[-1] <= 1


def test_a_gas_has_no_walls_as_its_sheet_says(blender: LiveSession) -> None:
    assert "The lid and the sides are open" in sheet("gas")
    borders = """
settings = gas(box("Domain", (1, 1, 1), (0, 0, 0)), ball("Source", 0.1, (0, 0, 0)))
[name for name in dir(settings) if name.startswith("use_collision_border_") and getattr(settings, name)]
"""
    assert tried(blender, "gas", borders) == []


def test_a_flag_flies_in_gusts_and_hangs_between_them(blender: LiveSession) -> None:
    seen = blender.run(f"{HELPERS}\n{recipe('cloth')}\n{recipe('wind')}\n{WIND}")
    reach, across, past = zip(*seen, strict=True)
    assert min(reach[18:24]) > 0.6, "it flies"
    assert max(across[12:36]) - min(across[12:36]) > 0.2, "it flutters"
    assert max(reach[54:60]) < 0.5, "it hangs in the lull"
    assert max(reach[80:]) > 0.6, "the next gust raises it"
    assert max(past) == pytest.approx(3, abs=0.01), "what has no weight for wind falls straight down"


@pytest.mark.parametrize(("damping", "speed"), [(0.0, 1.0), (0.9, 0.434)])
@pytest.mark.parametrize("substeps", [5, 20])
def test_a_body_gains_in_a_wind_what_its_sheet_says(
    blender: LiveSession, damping: float, speed: float, substeps: int
) -> None:
    drift = f"""
boat = box("Boat", (0.2, 0.1, 0.1), (0, 0, 0))
bpy.ops.rigidbody.object_add()
body, world = boat.rigid_body, scene.rigidbody_world
body.mass, body.linear_damping, body.use_deactivation = 0.005, {damping}, False
scene.gravity, world.substeps_per_frame = (0, 0, 0), {substeps}
blower = bpy.data.objects.new("Blower", None)
scene.collection.objects.link(blower)
wind(blower, (1, 0, 0), 0.12)
blower.field.flow = 0
places = []
for frame in range(1, {26 if not damping else 98}):
    scene.frame_set(frame)
    places.append(boat.matrix_world.translation.x)
(places[-1] - places[-2]) * 24
"""
    assert "5 g at 24 fps take 0.12 for 1 m/s²" in sheet("wind")
    assert tried(blender, "wind", drift) == pytest.approx(speed, rel=0.05)


def test_particles_come_to_rest_on_a_floor_and_stay(blender: LiveSession) -> None:
    grains = tried(blender, "particles", PARTICLES)
    assert len(grains) == 40
    assert all(0 < height < 0.1 for height, _ in grains)
    assert max(speed for _, speed in grains) < 0.1


def test_particles_that_are_born_before_the_first_frame_fall_through(blender: LiveSession) -> None:
    grains = tried(blender, "particles", PARTICLES.replace("end=12", "start=-30, end=12"))
    assert min(height for height, _ in grains) < -1


def test_settings_that_sheets_name_are_there(blender: LiveSession) -> None:
    prose = "\n".join(_RECIPE.sub("", sheet(solver)) for solver in SOLVERS)
    named = set(re.findall(r"`(?:\w+\.)*([a-z]+(?:_[a-z]+)+)`", prose)) - {tool.name for tool in TOOLS}
    assert len(named) > 15
    missing = f"""
known = set()
for name in dir(bpy.types):
    kind = getattr(bpy.types, name)
    known.update(kind.bl_rna.properties.keys() if hasattr(kind, "bl_rna") else ())
sorted(set({sorted(named)!r}) - known)
"""
    assert blender.run(missing) == []


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_sheet_is_short_and_has_one_recipe(solver: Solver) -> None:
    text = sheet(solver)
    assert len(text.encode()) <= LONGEST
    assert recipe(solver).startswith("import bpy\n")
    assert max(map(len, recipe(solver).splitlines())) <= 110
    assert "\nOrder: " in text


@pytest.mark.parametrize("stage", STAGES)
def test_coders_get_the_sheets_where_solvers_are_set_up_and_run(stage: Any) -> None:
    for role in ROLES:
        text = "\n\n".join(system_prompt(role, stage, solvers=["cloth", "gas"]))
        wanted = role == "coder" and stage in {"deformation_setup", "motion"}
        assert (sheet("cloth") in text) == (sheet("gas") in text) == wanted
        assert sheet("rigid") not in text
    assert sheet("cloth") in system_prompt("coder", "light", staged=False, solvers=["cloth"])


def test_a_plans_roles_name_its_solvers() -> None:
    def planned(name: str, role: str, **more: Any) -> dict[str, Any]:
        place = {"dimensions": (1, 1, 1), "position": (0, 0, 0), "systems": ["ground"]}
        return {"name": name, "role": role, **place, **more}

    plan = ScenePlan.model_validate(
        {
            "title": "All",
            "systems": ["ground"],
            "objects": [
                planned("Floor", "ground"),
                planned("Smoke", "fluid", fluid_kind="smoke"),
                planned("Sparks", "emitter"),
                planned("Flag", "cloth"),
                planned("Brick", "rigid"),
                planned("Breeze", "force"),
            ],
            "lighting": [{"name": "Sun", "kind": "sun", "energy": 3}],
            "camera": {"position": (0, -5, 2), "target": (0, 0, 0)},
            "render": {"kind": "still"},
        }
    )
    assert solvers_of(plan) == ("cloth", "rigid", "gas", "particles", "wind")
    water = ScenePlan.model_validate({**plan.model_dump(), "objects": [planned("Water", "fluid")]})
    assert solvers_of(water) == ("liquid",)
    drape = EditedActor(name="Drape", deformation_kind="sim_cloth", motion_kind="bake")
    fluid = EditedActor(name="Fluid", deformation_kind="sim_fluid", motion_kind="bake")
    assert solvers_of(None, [drape, fluid]) == ("cloth", "liquid", "gas")
    assert solvers_of(None) == ()
