"""``blender_group``: objects of the scene protocol, made in one call, without moving anything."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from scenes import build, verified

from agents.blender.tools.group import TOOL as GROUP
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.blender.tools.base import Result

pytestmark = pytest.mark.blender

LOOSE = """
for name, low, high, at in (
    ("Slab", (-2, -2, -0.1), (2, 2, 0), (0, 0, 0)),
    ("Seat", (-0.2, -0.2, 0), (0.2, 0.2, 0.04), (1, 0.5, 0.4)),
    ("Leg.001", (-0.02, -0.02, 0), (0.02, 0.02, 0.4), (0.85, 0.5, 0)),
    ("Leg.002", (-0.02, -0.02, 0), (0.02, 0.02, 0.4), (1.15, 0.5, 0)),
):
    scene.collection.objects.link(box(name, low, high, at=at, turn=(0, 0, 0)))
"""
CHAIR = {"object": "Chair", "system": "furniture", "members": ["Seat", "Leg.001", "Leg.002"]}
ROOM = {"object": "Room", "system": "ground", "members": ["Slab"]}


def group(session: LiveSession, *groups: dict[str, Any]) -> Result:
    return session.use(GROUP, groups=list(groups))


def matrices(session: LiveSession) -> dict[str, list[float]]:
    return session.run(
        "bpy.context.view_layer.update()\n"
        "{one.name: [round(value, 5) for row in one.matrix_world for value in row]"
        " for one in bpy.data.objects if one.type != 'EMPTY'}"
    )


def state(session: LiveSession) -> Any:
    """All that grouping could change."""
    return session.run(
        "(sorted((one.name, sorted(one.objects.keys()), sorted(one.children.keys()), dict(one.items()))"
        " for one in [bpy.context.scene.collection, *bpy.data.collections]),"
        " sorted((one.name, one.parent and one.parent.name, str(one.matrix_world), len(one.keys()))"
        " for one in bpy.data.objects)).__repr__()"
    )


def refused(session: LiveSession, *groups: dict[str, Any]) -> str:
    """Why; and that nothing has changed."""
    before = state(session)
    with pytest.raises(Refusal) as error:
        group(session, *groups)
    assert state(session) == before
    return str(error.value)


def test_loose_meshes_become_objects_of_the_protocol_in_one_call(session: LiveSession) -> None:
    build(session, LOOSE)
    before = matrices(session)
    found = group(session, ROOM, {**CHAIR, "contact_with": ["Room"], "motion_kind": "none"})
    assert matrices(session) == before
    report = verified(session, "C,G,V,W1,W2,W3")
    assert [finding.message for finding in report.findings] == []
    assert {"C1", "C2", "C3", "C4", "C6", "G1", "G2", "G3", "V1", "W1", "W2"} <= set(report.passed)
    chair = found.data["groups"][1]
    assert chair["systems"] == ["furniture"]
    assert chair["members"] == ["Leg.001", "Leg.002", "Seat"]
    assert chair["location"] == pytest.approx([1.0, 0.5, 0.0], abs=1e-5)  # the bottom, in the middle
    assert found.data["warnings"] == []
    assert session.run("bpy.data.collections['Chair']['motion_kind']") == "none"
    assert "'Chair' in 'furniture': root 'Chair root' at (1, 0.5, 0), 3 members" in found.text


def test_many_alike_are_told_in_two_lines(session: LiveSession) -> None:
    build(session, LOOSE)
    session.run("""
for number in range(9):
    copy = bpy.data.objects.new(f"Block {number}", bpy.data.objects["Seat"].data)
    copy.location.x = number - 4
    bpy.context.scene.collection.objects.link(copy)
""")
    bricks = [
        {"object": f"Brick {n}", "system": "set", "members": [f"Block {n}"], "contact_with": ["Room"]}
        for n in range(9)
    ]
    found = group(session, ROOM, *bricks)
    assert len(found.data["groups"]) == 10
    lines = found.text.splitlines()
    assert lines[1].startswith(
        "- 'Brick 0' in 'set': root 'Brick 0 root' at (-4, 0, 0), 1 member: 'Block 0'."
    )
    assert lines[2].startswith("- In the same way 8 more: 'Brick 1', 'Brick 2'")
    assert not any("Brick 3 root" in line for line in lines)


def test_a_root_that_the_call_makes_may_be_touched(session: LiveSession) -> None:
    build(session, LOOSE)
    group(session, {**CHAIR, "contact_with": ["Chair root"]})
    assert session.run("list(bpy.data.objects['Chair root']['contact_with'])") == ["Chair root"]


def test_a_given_place_is_the_root_s(session: LiveSession) -> None:
    build(session, LOOSE)
    before = matrices(session)
    found = group(session, {**CHAIR, "location": [1.0, 0.5, 0.25]})
    assert found.data["groups"][0]["location"] == [1.0, 0.5, 0.25]
    assert matrices(session) == before


def test_the_bottom_is_that_of_the_evaluated_geometry(session: LiveSession) -> None:
    build(session, LOOSE)
    session.run(
        "array = bpy.data.objects['Seat'].modifiers.new('Array', 'ARRAY')\n"
        "array.use_relative_offset, array.use_constant_offset = False, True\n"
        "array.constant_offset_displace = (2, 0, -3)"
    )
    found = group(session, CHAIR)
    assert found.data["groups"][0]["location"] == pytest.approx([2.0, 0.5, -2.6], abs=1e-5)


def test_doing_it_twice_changes_nothing(session: LiveSession) -> None:
    build(session, LOOSE)
    group(session, ROOM, CHAIR)
    before = state(session)
    found = group(session, ROOM, CHAIR)
    assert state(session) == before
    assert found.data["groups"][1]["taken_out_of"] == []


def test_more_members_join_what_is_there(session: LiveSession) -> None:
    build(session, LOOSE)
    group(session, {**CHAIR, "members": ["Seat"]})
    before = matrices(session)
    found = group(session, {"object": "Chair", "members": ["Leg.001", "Leg.002"]})
    assert found.data["groups"][0]["members"] == ["Leg.001", "Leg.002", "Seat"]
    assert found.data["groups"][0]["location"] == pytest.approx([1.0, 0.5, 0.4], abs=1e-5)  # it stays
    assert matrices(session) == before
    assert verified(session, "G,C4").findings == ()


def test_a_root_that_is_moved_leaves_its_members_where_they_are(session: LiveSession) -> None:
    build(session, LOOSE)
    group(session, CHAIR)
    before = matrices(session)
    found = group(session, {"object": "Chair", "location": [0, 0, 5]})
    assert found.data["groups"][0]["location"] == [0, 0, 5]
    assert matrices(session) == before


def test_a_member_of_another_object_changes_over(session: LiveSession) -> None:
    build(session, LOOSE)
    group(session, ROOM, CHAIR)
    before = matrices(session)
    found = group(session, {"object": "Stick", "system": "props", "members": ["Leg.002"]})
    assert matrices(session) == before
    assert found.data["groups"][0]["taken_out_of"] == ["Chair"]
    assert found.data["groups"][0]["freed_from"] == {"Leg.002": "Chair root"}
    assert session.run("bpy.data.objects['Leg.002'].parent.name") == "Stick root"
    assert verified(session, "C3,G").findings == ()


def test_chains_of_parents_stay_and_only_their_upper_end_is_hung_up(session: LiveSession) -> None:
    build(session, LOOSE)
    session.run(
        "for name in ('Leg.001', 'Leg.002'):\n"
        "    leg, seat = bpy.data.objects[name], bpy.data.objects['Seat']\n"
        "    world = leg.matrix_world.copy()\n"
        "    leg.parent = seat\n"
        "    leg.matrix_world = world"
    )
    before = matrices(session)
    group(session, CHAIR)
    parents = session.run(
        "{name: bpy.data.objects[name].parent.name for name in ('Seat', 'Leg.001', 'Leg.002')}"
    )
    assert parents == {"Seat": "Chair root", "Leg.001": "Seat", "Leg.002": "Seat"}
    assert matrices(session) == before


def test_a_turned_stretched_and_animated_mesh_stays_as_it_is_at_every_frame(session: LiveSession) -> None:
    build(session, LOOSE)
    script = (
        "parent = bpy.data.objects.new('Old', None)\n"
        "scene.collection.objects.link(parent)\n"
        "parent.matrix_world = Matrix.LocRotScale(Vector((1, 2, 3)), Euler((0.3, 0.4, 0.5)), Vector((1, 2, 0.5)))\n"
        "seat = bpy.data.objects['Seat']\n"
        "seat.parent, seat.rotation_euler = parent, (0.5, 0.2, 0.1)\n"
        "key(seat, 1, location=(0, 0, 0))\n"
        "key(seat, 20, location=(1, 2, 3))\n"
    )
    session.run(
        "import bpy\nfrom mathutils import Matrix, Vector, Euler\nscene = bpy.context.scene\n"
        "def key(one, frame, location):\n    one.location = location\n"
        "    one.keyframe_insert('location', frame=frame)\n" + script
    )
    places = []
    for grouped in (False, True):
        if grouped:
            session.run("bpy.context.scene.frame_set(7)")
            found = group(session, CHAIR)
            assert found.data["groups"][0]["freed_from"] == {"Seat": "Old"}
        places.append([])
        for frame in (1, 10, 20):
            session.run(f"bpy.context.scene.frame_set({frame})")
            places[-1].append(matrices(session)["Seat"])
    for before, after in zip(*places, strict=True):
        assert after == pytest.approx(before, abs=2e-5)


def test_an_empty_that_holds_all_meshes_already_becomes_the_root(session: LiveSession) -> None:
    build(session, LOOSE)
    session.run(
        "handle = bpy.data.objects.new('Handle', None)\n"
        "bpy.context.scene.collection.objects.link(handle)\n"
        "for name in ('Seat', 'Leg.001', 'Leg.002'):\n"
        "    bpy.data.objects[name].parent = handle"
    )
    found = group(session, {**CHAIR, "members": [*CHAIR["members"], "Handle"]})
    assert found.data["groups"][0]["root"] == "Handle"
    assert verified(session, "C4,G").findings == ()


def test_a_root_loses_its_own_parent_and_stays(session: LiveSession) -> None:
    build(session, LOOSE)
    group(session, ROOM, CHAIR)
    session.run(
        "root, other = bpy.data.objects['Chair root'], bpy.data.objects['Slab']\n"
        "world = root.matrix_world.copy()\n"
        "root.parent = other\n"
        "root.matrix_world = world"
    )
    before = matrices(session)
    found = group(session, {"object": "Chair"})
    assert found.data["groups"][0]["freed_from"] == {"Chair root": "Slab"}
    assert matrices(session) == before
    assert verified(session, "G2").findings == ()


def test_collections_that_physics_goes_by_keep_their_members(session: LiveSession) -> None:
    build(session, LOOSE)
    session.run(
        "colliders = bpy.data.collections.new('Colliders')\n"
        "bpy.context.scene.collection.children.link(colliders)\n"
        "colliders.objects.link(bpy.data.objects['Seat'])\n"
        "bpy.data.objects['Slab'].modifiers.new('Cloth', 'CLOTH').collision_settings.collection = colliders\n"
        "bpy.ops.rigidbody.world_add()\n"
        "world = bpy.context.scene.rigidbody_world\n"
        "world.collection = bpy.data.collections.new('Bodies')\n"
        "bpy.context.view_layer.objects.active = bpy.data.objects['Leg.001']\n"
        "bpy.ops.rigidbody.object_add()"
    )
    found = group(session, CHAIR)
    assert found.data["groups"][0]["taken_out_of"] == ["Scene Collection"]
    assert session.run("bpy.data.collections['Colliders'].objects.keys()") == ["Seat"]
    assert session.run("bpy.data.collections['Bodies'].objects.keys()") == ["Leg.001"]
    assert session.run("bpy.data.objects['Leg.001'].rigid_body is not None") is True


def test_a_system_that_was_nested_comes_under_the_scene(session: LiveSession) -> None:
    build(session, LOOSE)
    session.run(
        "outer, inner = bpy.data.collections.new('House'), bpy.data.collections.new('furniture')\n"
        "bpy.context.scene.collection.children.link(outer)\n"
        "outer.children.link(inner)"
    )
    group(session, ROOM, CHAIR)
    assert verified(session, "C").findings == ()
    assert session.run("bpy.data.collections['House'].children.keys()") == []


def test_what_the_protocol_still_misses_is_told(session: LiveSession) -> None:
    build(session, LOOSE)
    found = group(session, CHAIR)
    assert any(one.startswith("C6:") for one in found.data["warnings"])
    assert "The protocol still requires:" in found.text


@pytest.mark.parametrize(
    ("groups", "why"),
    [
        ([{**CHAIR, "members": ["Seta"]}], "The scene has no object 'Seta'. Nearest: 'Seat'"),
        ([{"object": "Chair", "system": "furniture"}], "'Chair' is empty: name its members"),
        ([{"object": "Chair", "members": ["Seat"]}], "'Chair' is in no system yet: name one"),
        ([CHAIR, {**ROOM, "members": ["Seat"]}], "'Seat' cannot be in both 'Chair' and 'Room'"),
        ([CHAIR, CHAIR], "'Chair' is named twice"),
        ([{**CHAIR, "system": "Chair"}], "'Chair' cannot be both a system and an object"),
        (
            [{**CHAIR, "contact_with": ["Romo"]}, ROOM],
            "'Chair' cannot touch 'Romo': there is no such object. Nearest: 'Room'",
        ),
        ([{**CHAIR, "members": ["Lamp"]}], "'Lamp' is a light, which cannot be part of an object"),
        ([{**CHAIR, "members": ["Wind"]}], "'Wind' is a force field"),
        ([{**CHAIR, "members": ["Bone"]}], "'Chair' would have no mesh"),
        (
            [{**CHAIR, "members": ["Hand"]}],
            "'Hand' is moved by 'Bone' (parent type BONE), which is not in 'Chair'",
        ),
        ([{**CHAIR, "object": "ü" * 200}], "is not a valid name"),
        ([{**CHAIR, "object": "props"}], "'props' is already tagged as system, so it cannot become object"),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_changes(
    session: LiveSession, groups: list[dict[str, Any]], why: str
) -> None:
    build(
        session,
        LOOSE
        + """
lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
bpy.ops.object.effector_add(type="WIND")
bpy.context.object.name = "Wind"
rig = bpy.data.objects.new("Bone", bpy.data.armatures.new("Bone"))
hand = box("Hand", (0, 0, 0), (1, 1, 1))
for one in (lamp, rig, hand):
    scene.collection.objects.link(one)
bpy.context.view_layer.objects.active = rig
bpy.ops.object.mode_set(mode="EDIT")
bone = rig.data.edit_bones.new("B")
bone.tail = (0, 0, 1)
bpy.ops.object.mode_set(mode="OBJECT")
hand.parent, hand.parent_type, hand.parent_bone = rig, "BONE", "B"
system("props")
""",
    )
    assert why in refused(session, *groups)


def test_what_hangs_on_a_bone_keeps_it_when_the_armature_is_a_member(session: LiveSession) -> None:
    build(
        session,
        LOOSE
        + """
rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
scene.collection.objects.link(rig)
bpy.context.view_layer.objects.active = rig
bpy.ops.object.mode_set(mode="EDIT")
rig.data.edit_bones.new("B").tail = (0, 0, 1)
bpy.ops.object.mode_set(mode="OBJECT")
hand = box("Hand", (0, 0, 0), (1, 1, 1))
scene.collection.objects.link(hand)
hand.parent, hand.parent_type, hand.parent_bone = rig, "BONE", "B"
""",
    )
    before = matrices(session)
    group(session, {"object": "Arm", "system": "body", "members": ["Hand", "Rig"], "deformation_kind": "rig"})
    assert matrices(session) == before
    assert session.run("(lambda one: (one.parent.name, one.parent_bone))(bpy.data.objects['Hand'])") == (
        "Rig",
        "B",
    )
    assert session.run("bpy.data.objects['Rig'].parent.name") == "Arm root"
    assert verified(session, "G").findings == ()
