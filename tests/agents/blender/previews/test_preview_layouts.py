"""The previews of several things: rooms are opened, and the frame holds what matters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from preview_views import Views, build, is_coloured

from agents.blender.tools import bake, previews

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender


@pytest.fixture(autouse=True)
def _small(monkeypatch: pytest.MonkeyPatch) -> None:
    """What pictures show is tried with views of a size of their own."""
    monkeypatch.setattr(previews, "PANEL", 96)


def room(walls: str) -> str:
    return walls + (
        "\nfor at, (x, y) in enumerate(((-1, -1), (1, -1), (-1, 1), (1, 1))):\n"
        "    thing = box(f'Chest {at}', (x, y, .3), (.6, .6, .6), (.8, 0, 0)); thing.parent = house"
        "\nbpy.context.view_layer.update()"
    )


HOUSE = "house = bpy.data.objects.new('House', None); bpy.context.scene.collection.objects.link(house)\n"
THICK = (
    HOUSE
    + """
for name, place, size in (
    ('South', (0, -2.1, 1.25), (4.4, .2, 2.5)), ('North', (0, 2.1, 1.25), (4.4, .2, 2.5)),
    ('West', (-2.1, 0, 1.25), (.2, 4, 2.5)), ('East', (2.1, 0, 1.25), (.2, 4, 2.5)),
    ('Ceiling', (0, 0, 2.6), (4.4, 4.4, .2)), ('Floor', (0, 0, -.1), (4.4, 4.4, .2)),
):
    box(name, place, size, (.6, .6, .6)).parent = house
"""
)
THIN = HOUSE + "box('Shell', (0, 0, 1.25), (4.4, 4.4, 2.5), (.6, .6, .6)).parent = house\n"


@pytest.mark.parametrize(
    "walls",
    [
        pytest.param(THICK, marks=pytest.mark.whole),
        THICK + "house.rotation_euler.z = .6\n",
        pytest.param(THIN, marks=pytest.mark.whole),
    ],
    ids=["thick", "turned", "one box"],
)
def test_a_closed_room_is_opened_from_every_side(session: LiveSession, walls: str) -> None:
    build(session, room(walls))
    views = Views(session, "scene")
    for name, view in views.by_name.items():
        assert view["cut_away"], name
        assert views.share(name, "red") > 0.02, name
    # The far walls still stand: behind the things there is more than the background.
    assert views.middle("front")[3] == 255
    assert not any("Chest" in name for view in views.by_name.values() for name in view["cut_away"])


STREET = """
for name, place, size in (
    ('Street', (0, -1.125, -.05), (4, 1.75, .1)), ('Gutter', (0, 0, -.085), (4, .5, .03)),
    ('Curb', (0, .325, 0), (4, .15, .2)), ('Pavement', (0, 1.3, 0), (4, 1.8, .2)),
):
    box(name, place, size, (.6, .6, .6))
import bmesh
from mathutils import Matrix, Vector
slabs, work = bpy.data.objects['Pavement'], bmesh.new()
slabs.scale = (1, 1, 1)
for low, high in [((-2, -.9, -.1), (2, .9, .096))] + [
    ((x + .004, y + .004, .09), (x + .496, min(y + .496, .9), .1))
    for x in (-2, -1.5, -1, -.5, 0, .5, 1, 1.5) for y in (-.9, -.4, .1, .6)
]:
    middle, size = (Vector(low) + Vector(high)) / 2, Vector(high) - Vector(low)
    bmesh.ops.create_cube(work, size=1, matrix=Matrix.LocRotScale(middle, None, size))
work.to_mesh(slabs.data)
work.free()
"""


def test_slabs_side_by_side_are_no_room(session: LiveSession) -> None:
    build(session, STREET)
    assert not any(view["cut_away"] for view in Views(session, "scene").data["views"])


def test_a_ground_that_is_framed_all_the_same_is_not_told_to_be_too_large(session: LiveSession) -> None:
    low = "\nfor obj in bpy.data.objects: obj.location.z -= .2"
    build(session, "box('Boat', (0, 0, 0), (.2, .1, .1), (.8, 0, 0))\n" + STREET)
    told = "Larger than the pictures"
    assert told in " ".join(Views(session, "scene").data["notes"]), "what the test is about"
    build(
        session,
        f"{STREET}{low}\nbox('Hill', (0, 0, 0), (4.2, 5, 1), (.6, .6, .6))\n"
        "box('Boat', (0, 0, 0), (.2, .1, .1), (.8, 0, 0))",
    )
    assert told not in " ".join(Views(session, "scene").data["notes"])


@pytest.mark.parametrize(
    "moved",
    ["door.keyframe_insert('rotation_euler', frame=1)", "bpy.context.view_layer.objects.active = door\n"
     "bpy.ops.rigidbody.object_add(type='ACTIVE')"],
)  # fmt: skip
def test_a_closed_door_is_no_wall(session: LiveSession, moved: str) -> None:
    build(session, room(THICK) + f"\ndoor = bpy.data.objects['South']\n{moved}")
    cut = {name for view in Views(session, "scene").data["views"] for name in view["cut_away"]}
    assert "Ceiling" in cut
    assert "South" not in cut


def test_a_roof_without_walls_is_lifted(session: LiveSession) -> None:
    build(session, room(HOUSE) + "\nbox('Roof', (0, 0, 2.6), (5, 5, .2), (.6, .6, .6))")
    views = Views(session, "scene")
    assert {name for name, view in views.by_name.items() if view["cut_away"]} == {"top", "three-quarter"}
    assert views.by_name["top"]["cut_away"] == ["Roof"]
    assert views.share("top", "red") > 0.02


def test_what_was_cut_away_is_said_on_the_sheet(session: LiveSession) -> None:
    build(session, room(THICK))
    found = session.use(previews.SCENE_LAYOUT)
    assert "top: Ceiling" in found.text
    assert "front: South" in found.text


def test_an_empty_room_is_opened_and_a_solid_is_not(session: LiveSession) -> None:
    build(session, THICK)
    assert Views(session, "scene").by_name["top"]["cut_away"] == ["Ceiling"]
    session.empty()
    build(session, "box('Solid', size=(4, 4, 3))")
    assert not any(view["cut_away"] for view in Views(session, "scene").data["views"])


def test_nothing_is_cut_away_outdoors(session: LiveSession) -> None:
    build(
        session,
        "random.seed(4); box('Ground', (0, 0, -.05), (40, 40, .1))\n"
        "for at in range(30):\n"
        "    box(f'House {at}', (random.uniform(-18, 18), random.uniform(-18, 18), 1.5), (3, 3, 3))",
    )
    assert not any(view["cut_away"] for view in Views(session, "scene").data["views"])


CROWD = """
for at in range(6): box(f'Thing {at}', (at, 0, .5), rgb=(.8, 0, 0))
bpy.ops.mesh.primitive_plane_add(size=500); bpy.context.object.name = 'Ground'
bpy.ops.mesh.primitive_uv_sphere_add(radius=800); bpy.context.object.name = 'Sky'
box('Lost', (0, 0, -700))
"""


def test_distant_objects_do_not_shrink_the_rest(session: LiveSession) -> None:
    build(session, CROWD)
    views = Views(session, "scene")
    assert views.extent == pytest.approx([6, 1, 1])
    assert views.share("front", "red") > 0.05
    assert "'Ground', 'Sky'" in " ".join(views.data["notes"])
    assert "'Lost' at (0, 0, -700) m" in " ".join(views.data["notes"])
    assert Views(session, "scene", everything=True).extent[0] == pytest.approx(1600, rel=0.01)


RAIN = """
box('Ground', (0, 0, -.1), (4, 4, .2))
bpy.ops.mesh.primitive_uv_sphere_add(radius=.1, location=(40, 0, 0)); drop = paint(bpy.context.object, .8, 0, 0)
drop.name = 'Drop'
bpy.ops.mesh.primitive_plane_add(size=2, location=(0, 0, 2)); bpy.context.object.name = 'Cloud'
rain = bpy.context.object.modifiers.new('Rain', 'PARTICLE_SYSTEM').particle_system.settings
rain.count, rain.frame_start, rain.frame_end, rain.render_type = 50, 1, 1, 'OBJECT'
rain.instance_object, rain.particle_size, rain.normal_factor = drop, 1, 0
for frame in range(1, 6): bpy.context.scene.frame_set(frame)
"""


def test_instance_sources_do_not_enlarge_the_view(session: LiveSession) -> None:
    build(session, RAIN)
    views = Views(session, "scene")
    assert views.extent[0] == pytest.approx(4)
    assert views.share("front", "red") > 0.005
    assert "'Drop' at (40, 0, 0) m" in " ".join(views.data["notes"])


CAVE = """
bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=7, radius=4)
for at in range(4): box(f'Chest {at}', (at - 1.5, 0, -2), (.6, .6, .6), (.8, 0, 0))
"""


def test_a_cave_of_many_faces_is_opened_in_seconds(session: LiveSession) -> None:
    build(session, CAVE + "import time; bpy.app.driver_namespace['began'] = time.process_time()")
    views = Views(session, "scene")
    spent = session.run("import time; time.process_time() - bpy.app.driver_namespace['began']")
    assert all(view["cut_away"] == ["Icosphere"] for view in views.by_name.values())
    assert all(views.share(name, "red") > 0.002 for name in views.by_name)
    assert spent < 10  # of the processor, not of the clock


POOL = """
fluid = box('Pool', (0, 0, .5), (2, 1, 1), (.1, .2, .8)).modifiers.new('Fluid', 'FLUID')
fluid.fluid_type = 'DOMAIN'
fluid = fluid.domain_settings
fluid.domain_type, fluid.resolution_max, fluid.use_mesh = 'LIQUID', 24, True
flow = box('Water', (0, 0, .3), (1.9, .9, .5), (.1, .2, .8)).modifiers.new('Fluid', 'FLUID')
flow.fluid_type = 'FLOW'
flow.flow_settings.flow_type, flow.flow_settings.flow_behavior = 'LIQUID', 'GEOMETRY'
bpy.data.objects['Water'].hide_render = True
box('Stone', (.3, 0, .3), (.3, .3, .3), (.8, 0, 0))
"""


def test_liquid_is_shown_and_not_cut_open(session: LiveSession) -> None:
    build(session, POOL)
    session.use(bake.TOOL, frame_start=1, frame_end=3)
    views = Views(session, "scene", frame=2)
    assert not any(view["cut_away"] for view in views.by_name.values())
    assert views.extent[2] < 0.8
    assert views.share("top", "blue") > 0.2


def test_the_scenes_camera_has_a_picture_of_its_own(session: LiveSession) -> None:
    build(
        session,
        "box('Aim', (0, 5, 0), rgb=(.8, 0, 0)); c = bpy.data.cameras.new('Eye'); o = bpy.data.objects.new('Eye', c)\n"
        "o.rotation_euler.x = math.pi / 2; bpy.context.scene.collection.objects.link(o); scene = bpy.context.scene\n"
        "scene.camera = o; scene.render.resolution_x, scene.render.resolution_y = 400, 100; box('Behind', (0, -50, 0))",
    )
    views = Views(session, "scene")
    assert list(views.by_name)[-1] == "camera 'Eye'"
    picture = views.pictures["camera 'Eye'"]
    assert picture.width == 4 * picture.height
    assert is_coloured(views.middle("camera 'Eye'"), "red")
    # 36 mm wide, 50 mm away: at 4.5 m, 3.24 m wide.
    assert views.share("camera 'Eye'", "red") == pytest.approx(1 / 3.24 * min(1, 4 / 3.24), rel=0.15)


def test_a_table_is_no_room_for_what_it_is_made_of(session: LiveSession) -> None:
    legs = "\n".join(
        f"box('Leg {x} {y}', ({x * 0.6}, {y * 0.3}, .35), (.06, .06, .7))" for x in (-1, 1) for y in (-1, 1)
    )
    build(
        session,
        f"box('Top', (0, 0, .72), (1.4, .8, .05))\n{legs}\nbox('Gift', (.5, .2, .845), (.2, .2, .2))\n"
        "box('Floor', (0, 0, -.05), (4, 4, .1))",
    )
    views = Views(session, "scene")
    assert [view["cut_away"] for view in views.data["views"]] == [[]] * len(views.data["views"])


HOUSE_OUTDOORS = """
walls = [box('South', (0, -2, 1), (4, .2, 2)), box('North', (0, 2, 1), (4, .2, 2)),
         box('West', (-2, 0, 1), (.2, 4, 2)), box('East', (2, 0, 1), (.2, 4, 2)), box('Roof', (0, 0, 2.1), (5, 5, .2))]
inner = [box(f'Beam {at}', (at * .5 - 1, 0, .5), (.2, .2, .6)) for at in range(5)]
collection('House', 'object', *walls, *inner)
for at, (x, y) in enumerate(((-5, -4), (5, -4), (-5, 4), (5, 4), (0, 6))):
    trunk, crown = box(f'Trunk {at}', (x, y, 1), (.4, .4, 2)), box(f'Crown {at}', (x, y, 2.5), (1.5, 1.5, 1.5))
    collection(f'Tree {at}', 'object', trunk, crown)
"""


def test_a_house_among_trees_keeps_its_roof(session: LiveSession) -> None:
    build(session, HOUSE_OUTDOORS)
    views = Views(session, "scene")
    assert [view["cut_away"] for view in views.data["views"]] == [[]] * len(views.data["views"])


def test_what_hangs_on_a_wall_is_not_cut_away_with_it(session: LiveSession) -> None:
    build(session, room(THICK) + "\nbox('Television', (0, -1.95, 1.3), (1.1, .1, .7)).parent = house")
    views = Views(session, "scene")
    assert "South" in views.by_name["front"]["cut_away"]
    assert all("Television" not in view["cut_away"] for view in views.data["views"])


def test_a_domain_is_no_room(session: LiveSession) -> None:
    build(
        session,
        "for at in range(4): box(f'Chest {at}', (at - 1.5, 0, .3), (.6, .6, .6), (.8, 0, 0))\n"
        "domain = box('Domain', (0, 0, 1.25), (5, 5, 2.5))\n"
        "made = domain.modifiers.new('Fluid', 'FLUID'); made.fluid_type = 'DOMAIN'\n"
        "made.domain_settings.domain_type = 'LIQUID'\n",
    )
    assert all("Domain" not in view["cut_away"] for view in Views(session, "scene").data["views"])


def test_small_subjects_get_a_view_of_their_own_and_their_names_come_first(session: LiveSession) -> None:
    tree = "box(f'T{at}', (at % 5 * 9, at // 5 * 9, 2), (3, 3, 4))"
    crowd = f"for at in range(20): collection(f'Tree {{at}}', 'object', {tree})"
    build(
        session,
        f"{crowd}\ncollection('Mug', 'object', box('Mug mesh', (13, 13, .1), (.1, .1, .2), (.8, 0, 0)))",
    )
    views = Views(session, "scene", subjects=["Mug"])
    assert "subjects" in views.by_name
    assert views.share("subjects", "red") > 0.1 > views.share("three-quarter", "red")
    assert "Mug" in {name for name, *_ in views.by_name["top"]["labels"]}
    assert "subjects" not in Views(session, "scene", subjects=[f"Tree {at}" for at in range(20)]).by_name


def test_names_of_subjects_that_are_not_there_are_told(session: LiveSession) -> None:
    build(session, "box('Mug', (0, 0, 0))")
    result = session.use(previews.SCENE_LAYOUT, subjects=["Jug"])
    assert "Nothing to see of 'Jug'" in result.text


def test_a_subject_that_has_no_size_yet_is_told_and_hides_nothing(session: LiveSession) -> None:
    build(session, "box('Mug', (0, 0, 0)); box('Seed', (3, 0, 0), (0, 0, 0))")
    views = Views(session, "scene", subjects=["Mug", "Seed"])
    assert "three-quarter" in views.by_name
    views = Views(session, "scene", subjects=["Seed"])
    assert "subjects" not in views.by_name
    assert "Without any size at this frame: 'Seed'." in views.data["notes"]


def test_the_camera_sees_no_axes(session: LiveSession) -> None:
    build(
        session,
        "box('Mug', (0, 0, 0)); bpy.ops.object.camera_add(location=(0, -6, 0), rotation=(math.pi / 2, 0, 0))\n"
        "bpy.context.scene.camera = bpy.context.object",
    )
    views = Views(session, "scene")
    (through,) = (view for view in views.data["views"] if view["name"].startswith("camera"))
    assert through["axes"] == []
    assert views.by_name["front"]["axes"]
