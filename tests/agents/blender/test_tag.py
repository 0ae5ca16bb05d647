"""``blender_tag_object``: what it sets, what it refuses, and what it finds missing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args

import pytest

from agents.blender.tools.tag import TOOL
from agents.protocol import vocabulary
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

# A table of two meshes in one collection with an Empty, on a floor; nothing is tagged.
ROOM = """
scene = bpy.context.scene

def group(name, parent):
    made = bpy.data.collections.new(name)
    parent.children.link(made)
    return made

def mesh(name, where, size, parent=None):
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, where))
    made = bpy.context.object
    made.name, made.scale = name, size
    return put(made, parent)

def put(made, collection, parent=None):
    for old in made.users_collection:
        old.objects.unlink(made)
    collection.objects.link(made)
    return made

def empty(name, collection):
    made = bpy.data.objects.new(name, None)
    collection.objects.link(made)
    return made

ground, room = group("ground", scene.collection), group("room", scene.collection)
floor, table = group("floor", ground), group("table", room)
for collection, meshes in ((floor, [("Slab", -0.1)]), (table, [("Leg", 0.5), ("Top", 1.05)])):
    root = empty(collection.name + "_root", collection)
    for name, height in meshes:
        mesh(name, height, (1, 1, 0.1), collection).parent = root
bpy.context.view_layer.update()
"""

TAGGED: dict[str, Any] = {
    "collections": [
        {"name": "ground", "role": "system"},
        {"name": "room", "role": "system"},
        {"name": "floor", "role": "object"},
        {"name": "table", "role": "object", "deformation_kind": "none", "motion_kind": "none"},
    ],
    "objects": [
        {"name": "floor_root", "is_object_root": True},
        {"name": "table_root", "is_object_root": True},
        {"name": "Leg", "contact_with": ["Slab", "Top"]},
    ],
}


def refusal(session: LiveSession, **tags: Any) -> str:
    with pytest.raises(Refusal) as refused:
        session.use(TOOL, **tags)
    return str(refused.value)


def properties(session: LiveSession) -> dict[str, dict[str, Any]]:
    """What the scene's things really carry."""
    return session.run(
        f"known = {[one.name for one in vocabulary.PROPERTIES]!r}\n"
        "things = [*bpy.data.collections, *bpy.data.objects, bpy.context.scene]\n"
        "{one.name: {k: one[k] for k in known if k in one} for one in things if any(k in one for k in known)}"
    )


def test_schema_offers_exactly_the_vocabulary() -> None:
    assert set(vocabulary.ROLES) == set(get_args(vocabulary.Role))
    assert set(vocabulary.DEFORMATION_KINDS) == set(get_args(vocabulary.DeformationKind))
    assert set(vocabulary.MOTION_KINDS) == set(get_args(vocabulary.MotionKind))


def test_a_tagged_scene_carries_the_properties_and_misses_nothing(session: LiveSession) -> None:
    session.run(ROOM)
    found = session.use(TOOL, **TAGGED, strict_grounding=True)
    assert properties(session) == {
        "ground": {"protocol_role": "system"},
        "room": {"protocol_role": "system"},
        "floor": {"protocol_role": "object"},
        "table": {"protocol_role": "object", "deformation_kind": "none", "motion_kind": "none"},
        "floor_root": {"is_object_root": True},
        "table_root": {"is_object_root": True},
        "Leg": {"contact_with": ["Slab", "Top"]},
        "Scene": {"strict_grounding": True},
    }
    assert found.data["warnings"] == []
    assert "object 'Leg': contact_with 'Slab', 'Top'" in found.text


def test_tags_survive_a_fresh_process(session: LiveSession) -> None:
    session.run(ROOM)
    session.use(TOOL, **TAGGED)
    before = properties(session)
    session.blender.kill()
    assert properties(session) == before
    assert len(before) == 7


def test_omitted_tags_stay_and_null_removes(session: LiveSession) -> None:
    session.run(ROOM)
    session.use(TOOL, **TAGGED)
    found = session.use(
        TOOL,
        collections=[{"name": "table", "motion_kind": "keyframe", "deformation_kind": None}],
        objects=[{"name": "Leg", "contact_with": None}],
        strict_grounding=None,
    )
    assert found.data["collections"] == {"table": {"protocol_role": "object", "motion_kind": "keyframe"}}
    assert found.data["objects"] == {"Leg": {}}
    now = properties(session)
    assert now["table"] == {"protocol_role": "object", "motion_kind": "keyframe"}
    assert "Leg" not in now
    assert "Scene" not in now


def test_an_objects_name_in_contact_with_stands_for_its_root(session: LiveSession) -> None:
    session.run(ROOM)
    session.use(TOOL, **TAGGED)
    session.use(TOOL, objects=[{"name": "table_root", "contact_with": ["floor", "floor_root"]}])
    assert properties(session)["table_root"]["contact_with"] == ["floor_root"]


def test_a_root_moves_to_another_empty_in_one_call(session: LiveSession) -> None:
    session.run(ROOM)
    session.use(TOOL, **TAGGED)
    session.run(
        "made = bpy.data.objects.new('anchor', None)\nbpy.data.collections['table'].objects.link(made)"
    )
    assert "'table_root' as its root" in refusal(
        session, objects=[{"name": "anchor", "is_object_root": True}]
    )
    moved = [{"name": "anchor", "is_object_root": True}, {"name": "table_root", "is_object_root": None}]
    found = session.use(TOOL, objects=moved)
    assert found.data["objects"] == {"anchor": {"is_object_root": True}, "table_root": {}}
    assert any(one.startswith("G1") for one in found.data["warnings"])


@pytest.mark.parametrize(
    ("tags", "because"),
    [
        ({"collections": [{"name": "tabel", "role": "object"}]}, "Nearest: 'table'"),
        ({"collections": [{"name": "Leg", "role": "object"}]}, "not a collection but an object"),
        ({"collections": [{"name": "Scene Collection", "role": "system"}]}, "the scene's root"),
        ({"collections": [{"name": "room", "motion_kind": "none"}]}, "only objects (L3) have it"),
        ({"collections": [{"name": "table", "role": None}]}, "set deformation_kind to null"),
        ({"collections": [{"name": "table", "role": "system"}]}, "set deformation_kind to null"),
        ({"collections": [{"name": "table"}, {"name": "table", "role": "object"}]}, "named twice"),
        ({"objects": [{"name": "leg", "is_object_root": True}]}, "Nearest: 'Leg'"),
        ({"objects": [{"name": "table", "is_object_root": True}]}, "not an object but a collection"),
        (
            {"objects": [{"name": "Leg", "is_object_root": True}]},
            "'Leg' is a mesh, but a root must be an Empty",
        ),
        (
            {"objects": [{"name": "Outside", "is_object_root": True}]},
            "is in no object (L3), only in 'room'",
        ),
        ({"objects": [{"name": "Leg", "contact_with": ["Flor"]}]}, "no such object. Nearest: 'floor"),
        (
            {"objects": [{"name": "Leg", "contact_with": ["Leg"]}]},
            "is one mesh: it cannot be in contact with itself",
        ),
        ({"objects": [{"name": "Leg", "contact_with": ["Lamp"]}]}, "which is a light, not a root"),
        ({"objects": [{"name": "Outside", "contact_with": ["Leg"]}]}, "'Outside' is an empty and not a root"),
        (
            {"objects": [{"name": "Leg", "contact_with": ["Top"]}], "collections": [{"name": ""}]},
            "collections.0.name",
        ),
        ({}, "There is nothing to tag"),
        ({"collections": [{"name": "table", "role": "L3"}]}, "'system' or 'object'"),
        ({"collections": [{"name": "table", "motion_kind": "sim_cloth"}]}, "'keyframe', 'bake' or 'none'"),
        ({"collections": [{"name": "table", "is_object_root": True}]}, "Extra inputs"),
        ({"objects": [{"name": "Leg", "role": "object"}]}, "Extra inputs"),
        ({"objects": [{"name": "Leg", "contact_with": "Top"}]}, "valid list"),
    ],
)
def test_contradictions_are_refused_and_change_nothing(
    session: LiveSession, tags: dict[str, Any], because: str
) -> None:
    session.run(ROOM)
    session.run(
        "light = bpy.data.objects.new('Lamp', bpy.data.lights.new('Lamp', 'POINT'))\n"
        "for made in (light, bpy.data.objects.new('Outside', None)):\n"
        "    bpy.data.collections['room'].objects.link(made)"
    )
    session.use(TOOL, **TAGGED)
    before = properties(session)
    assert because in refusal(session, **tags)
    assert properties(session) == before


def test_one_wrong_target_leaves_the_right_ones_untouched(session: LiveSession) -> None:
    session.run(ROOM)
    assert "nobody" in refusal(
        session,
        collections=[{"name": "table", "role": "object"}],
        objects=[{"name": "nobody", "contact_with": ["Leg"]}],
    )
    assert properties(session) == {}


@pytest.mark.parametrize(
    ("change", "tags", "missing"),
    [
        ("", {"collections": [{"name": "table", "role": "object"}]}, ["C1", "C4", "C6"]),
        ("scene.collection.children.unlink(ground)", {"collections": [{"name": "ground", "role": "system"}]},
         ["'ground' is not in the scene", "C6"]),
        ("room.children.link(ground); scene.collection.children.unlink(ground)", TAGGED, ["C2"]),
        ("room.name = 'room.001'", {"collections": [{"name": "room.001", "role": "system"}]}, ["C5", "C6"]),
        ("bpy.data.objects['Top'].parent = bpy.data.objects['Leg']", TAGGED, []),
        ("bpy.data.objects['Top'].parent = None", TAGGED, ["G1: parent to the root 'table_root' of 'table': 'Top'."]),
        ("root.parent = bpy.data.objects['floor_root']", TAGGED, ["G1", "G2: root 'table_root'"]),
        ("floor.objects.link(bpy.data.objects['Top'])", TAGGED, ["G1", "C3: 'Top' of 'floor'", "C3: 'Top' of 'table'"]),
        ("table.objects.link(bpy.data.objects.new('Eye', bpy.data.cameras.new('Eye')))", TAGGED, ["W3: 'Eye' in "]),
        ("put(bpy.data.objects['Leg'], room)", TAGGED, ["C3: 'Leg' is in no object"]),
    ],
)  # fmt: skip
def test_reports_what_the_protocol_still_requires(
    session: LiveSession, change: str, tags: dict[str, Any], missing: list[str]
) -> None:
    session.run(ROOM + change)
    found = session.use(TOOL, **tags).data["warnings"]
    assert len(found) == len(missing), found
    for start in missing:
        assert any(one.startswith(start) for one in found), (start, found)


def test_warnings_of_a_large_scene_are_bounded(session: LiveSession) -> None:
    session.run(
        "for n in range(60): bpy.context.scene.collection.children.link(bpy.data.collections.new(f'thing {n}'))"
    )
    tags = [{"name": f"thing {n}", "role": "object"} for n in range(60)]
    found = session.use(TOOL, collections=tags).data["warnings"]
    assert len(found) == 21
    assert found[-1].startswith("… and 101 more")


def test_reports_wrong_tags_set_by_code(session: LiveSession) -> None:
    session.run(
        ROOM
        + "for name, value in (('Leg', 'Slap'), ('Top', 7)): bpy.data.objects[name]['contact_with'] = value"
    )
    found = session.use(TOOL, objects=[{"name": "Leg"}, {"name": "Top"}])
    assert found.data["objects"] == {"Leg": {"contact_with": ["Slap"]}, "Top": {"contact_with": []}}
    assert any(
        "'Leg' should touch 'Slap', but the scene has no such object" in one for one in found.data["warnings"]
    )
    session.use(
        TOOL, objects=[{"name": "Leg", "contact_with": ["Slab"]}, {"name": "Top", "contact_with": []}]
    )
    assert properties(session) == {"Leg": {"contact_with": ["Slab"]}}
