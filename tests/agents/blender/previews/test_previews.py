"""The previews: what they show, of what, how large, and what they refuse."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from PIL import Image
from preview_views import SIZE, Views, build, is_coloured
from whole import by_turns

from agents.blender.sheets import contact_sheet
from agents.blender.tools import previews
from agents.blender.tools.base import Call
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender


@pytest.fixture(autouse=True)
def _small(monkeypatch: pytest.MonkeyPatch) -> None:
    """What pictures show is tried with views of a size of their own."""
    monkeypatch.setattr(previews, "PANEL", 96)


def test_a_preview_is_a_picture_and_the_same_as_a_file(session: LiveSession) -> None:
    build(session, "box('Crate', size=(1, 2, 3))")
    found = session.use(previews.SINGLE_MESH, object="Crate")
    (picture,) = found.pictures
    assert picture.path.read_bytes() == picture.png
    assert picture.path.is_relative_to(session.blender.folder.root / "previews")
    assert found.data["file"] == str(picture.path.relative_to(session.blender.folder.root))
    with Image.open(picture.path) as image:
        assert image.width == 2 * (previews.PANEL + 2) + contact_sheet.GAP + 2 * contact_sheet.MARGIN
        assert image.height > image.width
    assert "1 m × 2 m × 3 m" in found.text
    assert not list(session.blender.folder.workspace.mount.glob(".preview*"))


def test_files_of_several_previews_stay_beside_each_other(session: LiveSession) -> None:
    build(session, "box('A/../../b'); box('A/../../c')")
    paths = {session.use(previews.SINGLE_MESH, object=f"A/../../{name}").pictures[0].path for name in "bbc"}
    assert len(paths) == 3
    assert {path.parent for path in paths} == {session.blender.folder.root / "previews"}


def test_the_views_come_one_after_the_other_with_progress(session: LiveSession) -> None:
    build(session, "box('Crate')")
    told: list[tuple[float, float | None, str]] = []
    session.use(previews.SCENE_LAYOUT, Call(progress=lambda *step: told.append(step)))
    assert told == [(0, 4, "front"), (1, 4, "right"), (2, 4, "top"), (3, 4, "three-quarter")]


# What is shown


@pytest.mark.parametrize("here", [1, 5])
def test_what_keys_hide_in_the_viewport_is_shown_where_renders_show_it(
    session: LiveSession, here: int
) -> None:
    build(
        session,
        "crate, scene = box('Crate'), bpy.context.scene; box('Post', (0, 0, 9))\n"
        "for frame, x, hide in ((1, 0, False), (5, 40, True)):\n"
        "    crate.location.x, crate.hide_viewport = x, hide\n"
        "    crate.keyframe_insert('location', frame=frame)\n"
        "    crate.keyframe_insert('hide_viewport', frame=frame)\n"
        f"scene.frame_set({here})",
    )
    found = session.use(previews.SCENE_LAYOUT, frame=5)
    assert "40.5" in found.text, "as far as the crate reaches by then"
    assert "hidden" not in found.text
    assert session.run("bpy.data.objects['Crate'].hide_viewport") == (here == 5)


def test_each_view_shows_objects_at_their_size(session: LiveSession) -> None:
    build(session, "box('Crate', place=(40, -7, 3), size=(1, 2, 3))")
    views = Views(session, "mesh", "Crate")
    assert views.seen("front") == pytest.approx((1, 3), abs=0.04)
    assert views.seen("right") == pytest.approx((2, 3), abs=0.04)
    assert views.seen("top") == pytest.approx((1, 2), abs=0.04)
    assert views.data["low"] == pytest.approx([39.5, -8, 1.5])


def test_each_side_is_seen_from_where_its_name_says(session: LiveSession) -> None:
    build(
        session,
        "box('Body', size=(2, 2, 2), rgb=(.5, .5, .5))\n"
        "for name, place, rgb in (('F', (0, -1.1, 0), (.8, 0, 0)), ('R', (1.1, 0, 0), (0, .8, 0)),\n"
        "                         ('T', (0, 0, 1.1), (0, 0, .8)), ('Behind', (0, 1.1, 0), (0, .8, 0))):\n"
        "    box(name, place, rgb=rgb)",
    )
    views = Views(session, "scene")
    assert is_coloured(views.middle("front"), "red")
    assert is_coloured(views.middle("right"), "green")
    assert is_coloured(views.middle("top"), "blue")
    assert all(views.share("three-quarter", colour) > 0.02 for colour in ("red", "green", "blue"))


@pytest.mark.parametrize(
    ("code", "extent"),
    [
        ("o = box('It'); m = o.modifiers.new('Array', 'ARRAY'); m.count = 3", (3, 1, 1)),
        ("box('It', turn=(0, 0, math.pi / 4))", (2**0.5, 2**0.5, 1)),
        (
            "bpy.ops.mesh.primitive_uv_sphere_add(rotation=(1, 2, 3)); bpy.context.object.name = 'It'",
            (1.99, 1.99, 1.99),
        ),
        ("bpy.ops.curve.primitive_bezier_circle_add(radius=2); bpy.context.object.name = 'It'", (4, 4, 0)),
        ("bpy.ops.object.metaball_add(radius=2); bpy.context.object.name = 'It'", (2.23, 2.23, 2.23)),
        (
            "o = box('It'); o.shape_key_add(name='Basis'); k = o.shape_key_add(name='Long'); k.value = 1\n"
            "for point in k.data: point.co.x *= 5",
            (5, 1, 1),
        ),
        (
            "part = bpy.data.collections.new('Part'); c = box('Source'); part.objects.link(c)\n"
            "bpy.context.scene.collection.objects.unlink(c)\n"
            "e = bpy.data.objects.new('It', None); e.instance_type = 'COLLECTION'; e.instance_collection = part\n"
            "e.scale = (2, 1, 1); bpy.context.scene.collection.objects.link(e)",
            (2, 1, 1),
        ),
        (
            "m = bpy.data.meshes.new('Wire'); m.from_pydata([(0, 0, 0), (3, 0, 1)], [(0, 1)], [])\n"
            "bpy.context.scene.collection.objects.link(bpy.data.objects.new('It', m))",
            (3, 0, 1),
        ),
    ],
    ids=["modifier", "turned", "sphere", "curve", "metaball", "shape key", "instance", "wire"],
)
def test_the_evaluated_geometry_is_framed(session: LiveSession, code: str, extent: tuple[float, ...]) -> None:
    build(session, code)
    views = Views(session, "mesh", "It")
    assert views.extent == pytest.approx(extent, abs=0.02 * max(extent))
    wide = 1 if views.data["turned"] == pytest.approx(45) else max(extent[:2])  # a box, along its own axes
    assert max(views.seen("top")) == pytest.approx(wide, rel=0.04)


def test_particles_and_hair_are_seen_as_far_as_they_reach(session: LiveSession) -> None:
    build(
        session,
        "bpy.ops.mesh.primitive_plane_add(size=1, location=(0, 0, 5)); o = bpy.context.object; o.name = 'Rain'\n"
        "s = o.modifiers.new('p', 'PARTICLE_SYSTEM').particle_system.settings; s.count = 50; s.frame_end = 2\n"
        "bpy.ops.mesh.primitive_plane_add(size=1); o = bpy.context.object; o.name = 'Fur'\n"
        "s = o.modifiers.new('p', 'PARTICLE_SYSTEM').particle_system.settings; s.type = 'HAIR'; s.hair_length = 2\n"
        "for frame in range(1, 16): bpy.context.scene.frame_set(frame)",
    )
    rain = Views(session, "mesh", "Rain")
    # Thrown up with 1 m/s, for 14/24 s.
    assert rain.data["low"][2] == pytest.approx(5 + 14 / 24 - 9.81 / 2 * (14 / 24) ** 2, abs=0.15)
    assert rain.seen("front")[0] == pytest.approx(1, abs=0.15)
    assert Views(session, "mesh", "Fur").extent[2] == pytest.approx(2, rel=0.05)


def test_one_mesh_one_object_and_one_system_are_shown_alone(session: LiveSession) -> None:
    build(
        session,
        "seat, back = box('Seat'), box('Back', (0, 0, 1)); other = box('Table', (5, 0, 0))\n"
        "chair, table = collection('Chair', 'object', seat, back), collection('Desk', 'object', other)\n"
        "root = bpy.context.scene.collection; furniture = collection('Furniture', 'system')\n"
        "for one in (chair, table): root.children.unlink(one); furniture.children.link(one)\n"
        "box('Ball', (0, 9, 0))",
    )
    assert Views(session, "mesh", "Seat").extent == pytest.approx([1, 1, 1])
    assert Views(session, "object", "Chair").extent == pytest.approx([1, 1, 2])
    system = Views(session, "system", "Furniture")
    assert system.extent == pytest.approx([6, 1, 2])
    assert [label[0] for label in system.by_name["top"]["labels"]] == ["Chair", "Desk"]
    assert Views(session, "scene").extent == pytest.approx([6, 10, 2])


def test_labels_stand_on_what_they_name(session: LiveSession) -> None:
    build(
        session,
        "box('Red', (-3, 2, 0), rgb=(.8, 0, 0)); box('Blue', (3, -2, 0), rgb=(0, 0, .8)); box('Far', (9, 9, 0))",
    )
    views = Views(session, "scene")
    top = views.pictures["top"]
    places = {
        name: (x * top.width / SIZE, y * top.width / SIZE) for name, x, y in views.by_name["top"]["labels"]
    }
    for name in ("Red", "Blue"):
        pixel = top.getpixel((round(places[name][0]), round(places[name][1])))
        assert isinstance(pixel, tuple)
        assert is_coloured(pixel, name.lower())


# Frames


def test_another_frame_is_shown_and_left_again(session: LiveSession) -> None:
    build(
        session,
        "o = box('Lift')\nfor frame, z in ((1, 0), (11, 5)):\n"
        "    o.location.z = z; o.keyframe_insert('location', frame=frame)\n"
        "bpy.context.scene.frame_set(3, subframe=0.25)",
    )
    views = Views(session, "mesh", "Lift", frame=11)
    assert views.data["low"][2] == pytest.approx(4.5)
    assert views.data["frame"] == 11
    assert session.run("bpy.context.scene.frame_current, bpy.context.scene.frame_subframe") == (3, 0.25)


def test_unkeyed_changes_stay(session: LiveSession) -> None:
    build(session, "o = box('Lift'); o.keyframe_insert('location', frame=1); o.location = (7, 0, 0)")
    Views(session, "mesh", "Lift", frame=5)
    assert session.run("tuple(bpy.data.objects['Lift'].location)") == (7, 0, 0)


DRAPE = """
bpy.ops.mesh.primitive_grid_add(x_subdivisions=12, y_subdivisions=12, size=2, location=(0, 0, 1))
cloth = bpy.context.object; cloth.name = 'Cloth'; cloth.modifiers.new('c', 'CLOTH')
cloth.modifiers['c'].point_cache.frame_end = 12
ball = box('Post', (0, 0, 0)); ball.modifiers.new('c', 'COLLISION')
for frame in range(1, 6): bpy.context.scene.frame_set(frame)
"""
CLOTH = """
for frame in range(6, 10): bpy.context.scene.frame_set(frame)
graph = bpy.context.evaluated_depsgraph_get()
[tuple(v.co) for v in bpy.data.objects['Cloth'].evaluated_get(graph).data.vertices]
"""


def test_preview_does_not_disturb_a_simulation(
    session: LiveSession,
) -> None:
    build(session, DRAPE)
    alone = session.run(CLOTH)
    session.empty()
    build(session, DRAPE)
    views = Views(session, "scene", frame=9)
    assert views.data["frame"] == 5
    assert any("cloth of 'Cloth' is not baked" in note for note in views.data["notes"])
    assert session.run("bpy.context.scene.frame_current") == 5
    assert session.run(CLOTH) == alone


def test_a_baked_simulation_is_shown_at_any_frame(session: LiveSession) -> None:
    build(session, DRAPE + "bpy.ops.ptcache.bake_all(bake=True); bpy.context.scene.frame_set(1)")
    views = Views(session, "mesh", "Cloth", frame=12)
    assert views.data["notes"] == []
    assert views.extent[2] > 0.05  # it was flat


# Refusals and odd cases


def test_an_unknown_name_is_refused_with_the_nearest_ones(session: LiveSession) -> None:
    build(session, "collection('Chair', 'object', box('Seat')); collection('Furniture', 'system')")
    for tool, argument, name, near in (
        (previews.SINGLE_MESH, "object", "seet", "Seat"),
        (previews.OBJECT, "object", "chairs", "Chair"),
        (previews.SYSTEM_LAYOUT, "system", "furnitur", "Furniture"),
    ):
        with pytest.raises(Refusal, match=near):
            session.use(tool, **{argument: name})


def test_a_collection_without_its_role_is_shown_with_a_note(session: LiveSession) -> None:
    build(session, "collection('Chair', 'object', box('Seat'))")
    assert "is tagged protocol_role='object'" in session.use(previews.SYSTEM_LAYOUT, system="Chair").text


@pytest.mark.parametrize(
    ("code", "why"),
    [
        ("bpy.context.scene.collection.objects.link(bpy.data.objects.new('It', None))", "no geometry.*EMPTY"),
        ("box('It').location.x = float('nan')", "transform is not finite"),
        ("box('It').data.vertices[0].co.x = float('inf')", "coordinates that are not finite"),
        ("box('It', size=(0, 0, 0))", "at frame 1: all of it lies in one point"),
        ("box('It').data.clear_geometry()", "Without faces"),
        ("box('It', size=(1e11, 1, 1))", "too large"),
    ],
)
def test_what_cannot_be_drawn_is_refused_with_the_reason(session: LiveSession, code: str, why: str) -> None:
    build(session, code)
    for kind in ("mesh", "scene"):
        with pytest.raises(Refusal, match=why):
            Views(session, kind, "It")


def test_an_empty_scene_is_refused(session: LiveSession) -> None:
    with pytest.raises(Refusal, match="it is empty"):
        session.use(previews.SCENE_LAYOUT)


def test_one_broken_object_does_not_hide_others(session: LiveSession) -> None:
    build(
        session,
        "box('Good'); box('Bad').location.x = float('nan'); box('Shut', (3, 0, 0)).hide_set(True)\n"
        "box('Proxy', (9, 0, 0)).hide_render = True",
    )
    views = Views(session, "scene")
    assert views.extent == pytest.approx([1, 1, 1])
    notes = " ".join(views.data["notes"])
    assert "'Bad': its transform" in notes
    assert "hidden in the viewport: 'Shut'" in notes
    assert "hidden from renders: 'Proxy'" in notes
    assert "without its modifiers" in " ".join(Views(session, "mesh", "Shut").data["notes"])


def test_particles_are_drawn_as_renders_show_them(session: LiveSession) -> None:
    shower = """
leaf = box("Leaf", (50, 0, 0), (0.5, 0.5, 0.5))
leaf.hide_render = True
tap = box("Tap", (0, 0, 0), (4, 4, 4))
tap.show_instancer_for_render = False
made = tap.modifiers.new("Shower", "PARTICLE_SYSTEM").particle_system.settings
made.count, made.frame_start, made.frame_end, made.physics_type = 200, 1, 1, "NO"
made.render_type, made.instance_object, made.particle_size = "OBJECT", leaf, 1
bpy.context.scene.frame_set(2)
"""
    build(session, shower)
    views = Views(session, "scene")
    assert views.extent == pytest.approx([4.5, 4.5, 4.5], abs=0.5)


@pytest.mark.parametrize(
    "size",
    [1e-6, pytest.param(1e-3, marks=pytest.mark.whole), pytest.param(1e5, marks=pytest.mark.whole), 1e7],
)
def test_size_makes_no_difference(session: LiveSession, size: float) -> None:
    build(session, f"box('It', ({size}, 0, 0), ({size}, {size}, {2 * size}), (.8, 0, 0))")
    views = Views(session, "mesh", "It")
    assert views.seen("front")[1] == pytest.approx(2 * size, rel=0.03)
    assert views.share("front", "red") > 0.3


# Where Workbench cannot draw


def test_cycles_draws_where_there_is_no_graphics_driver(own_session: LiveSession) -> None:
    own_session.blender.launch.environment["__EGL_VENDOR_LIBRARY_FILENAMES"] = "/nonexistent"
    own_session.blender.kill()
    build(own_session, "box('Crate', size=(1, 1, 2), rgb=(.8, 0, 0))")
    views = Views(own_session, "mesh", "Crate")
    assert views.data["engine"] == "CYCLES"
    assert "Workbench cannot draw" in " ".join(views.data["notes"])
    assert views.seen("front") == pytest.approx((1, 2), abs=0.06)
    assert is_coloured(views.middle("front"), "red")


@pytest.mark.parametrize("turn", by_turns([150, 0, 90], 3))
def test_an_object_is_seen_along_its_own_axes(session: LiveSession, turn: float) -> None:
    build(
        session,
        "root = bpy.data.objects.new('TV', None); root['is_object_root'] = True\n"
        "case, screen = box('Case', (0, .06, 0), (1, .1, .6)), box('Screen', (0, 0, 0), (.9, .02, .5), (.8, 0, 0))\n"
        "case.parent = screen.parent = root\n"
        f"collection('Television', 'object', root, case, screen); root.rotation_euler.z = math.radians({turn})\n"
        "bpy.context.view_layer.update()",
    )
    views = Views(session, "object", "Television")
    assert views.share("front", "red") > 0.3
    assert views.share("right", "red") < 0.05
    assert views.data["turned"] == pytest.approx(turn)
    assert ("turned by" in session.use(previews.OBJECT, object="Television").text) == bool(turn)
