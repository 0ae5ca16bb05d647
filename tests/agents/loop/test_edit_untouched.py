"""The report of an edit: what changed, what follows from what the plan names, and what nobody asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from agents.loop.edit.untouched import Blocks, compared
from agents.loop.task import RunTask
from agents.plan.edit import EditPlan

if TYPE_CHECKING:
    from collections.abc import Sequence

File = dict[str, dict[str, Any]]
STILL = {"kind": "still", "engine": "BLENDER_WORKBENCH", "resolution": [64, 36], "samples": 1}


def kitchen() -> File:
    """{data-block: {part: (what is in it, what it points to)}}."""
    return {
        "Scene Scene": {
            "collection": ("", ["Collection Set"]),
            "camera": ("", ["Object Camera"]),
            "render": ("64", []),
            "frame range": ("1-20", []),
            "physics": ("", []),
        },
        "Collection Set": {"objects": ("", ["Object Mug", "Object Plate", "Object Spoon", "Object Camera"])},
        "Object Mug": thing("Mug", "Mug", "Glaze"),
        "Object Plate": thing("Plate", "Plate", "China"),
        "Object Spoon": thing("Spoon", "Spoon", "China") | {"parent": ("", ["Object Plate"])},
        "Object Camera": thing("Camera", "", ""),
        "Mesh Mug": {"geometry": ("round", []), "materials": ("", ["Material Glaze"])},
        "Mesh Plate": {"geometry": ("flat", []), "materials": ("", ["Material China"])},
        "Mesh Spoon": {"geometry": ("long", []), "materials": ("", ["Material China"])},
        "Material Glaze": {"nodes": ("blue", ["Image Crackle"])},
        "Material China": {"nodes": ("white", [])},
        "Image Crackle": {"picture": ("cracks", [])},
    }


def thing(name: str, mesh: str, material: str) -> dict[str, Any]:
    return {
        "transform": (f"where {name} is", []),
        "data": ("", [f"Mesh {mesh}"] if mesh else []),
        "materials": ("", [f"Material {material}"] if material else []),
        "modifiers": ("", []),
        "parent": ("", []),
        "caches": ("none", []),
    }


def blocks(file: File) -> Blocks:
    return Blocks(
        {name: repr(sorted(parts.items())) for name, parts in file.items()},
        {name: {part: repr(told) for part, told in parts.items()} for name, parts in file.items()},
        {name: {part: used for part, (_, used) in parts.items() if used} for name, parts in file.items()},
    )


def plan(*targets: str, kind: str = "modify", stage: str = "modeling", **more: Any) -> EditPlan:
    task = {"kind": kind, "stage": stage, "targets": list(targets), "instruction": "As told."}
    return EditPlan.model_validate({"title": "An edit", "tasks": [task], "render": STILL, **more})


def outside(after: File, plan: EditPlan) -> list[str]:
    return list(compared(blocks(kitchen()), blocks(after), plan).outside)


def edited(name: str, part: str, what: str = "anew", used: list[str] | None = None, **more: Any) -> File:
    file = kitchen() | more
    before = file[name].get(part, ("", []))
    file[name] = {**file[name], part: (what, before[1] if used is None else used)}
    return file


def test_a_file_that_was_not_changed_is_all_unchanged() -> None:
    report = compared(blocks(kitchen()), blocks(kitchen()), plan("Mug")).as_row()
    assert report["unchanged"] == sorted(kitchen())
    assert not any(report[key] for key in ("added", "removed", "changed", "outside", "why"))


def test_what_of_a_named_object_changed_is_told_part_by_part() -> None:
    report = compared(blocks(kitchen()), blocks(edited("Object Mug", "transform")), plan("Mug")).as_row()
    assert (report["changed"], report["outside"]) == (["Object Mug"], [])
    assert report["parts"] == {"Object Mug": ["transform"]}
    assert report["why"] == {"Object Mug": "named by the plan"}


@pytest.mark.parametrize(
    ("name", "part", "why"),
    [
        ("Mesh Mug", "geometry", "mesh of Mug"),
        ("Material Glaze", "nodes", "material of Mug"),
        ("Image Crackle", "picture", "image of Glaze"),
    ],
)
def test_what_only_a_named_object_uses_may_change_with_it(name: str, part: str, why: str) -> None:
    report = compared(blocks(kitchen()), blocks(edited(name, part)), plan("Mug")).as_row()
    assert (report["outside"], report["why"]) == ([], {name: why})


def test_a_material_that_others_use_too_is_outside_and_they_are_named() -> None:
    report = compared(blocks(kitchen()), blocks(edited("Material China", "nodes")), plan("Plate")).as_row()
    assert report["outside"] == ["Material China"]
    assert "Spoon" in report["why"]["Material China"]
    assert "Plate" not in report["why"]["Material China"]


def test_another_object_that_moves_is_outside() -> None:
    assert outside(edited("Object Spoon", "transform"), plan("Mug")) == ["Object Spoon"]


def test_what_a_named_collection_holds_may_change() -> None:
    assert outside(edited("Object Spoon", "transform"), plan("Set", "Scene")) == []


def with_added(name: str, **changes: Any) -> File:
    file = kitchen()
    file[f"Object {name}"] = thing(name, name, name) | changes
    file[f"Mesh {name}"] = {"geometry": (name, [])}
    file[f"Material {name}"] = {"nodes": (name, [])}
    held = file["Collection Set"]["objects"][1]
    file["Collection Set"] = {"objects": ("", [*held, f"Object {name}"])}
    return file


def test_a_planned_object_comes_with_its_data_into_a_collection() -> None:
    report = compared(blocks(kitchen()), blocks(with_added("Jug")), plan("Jug", kind="add")).as_row()
    assert report["added"] == ["Material Jug", "Mesh Jug", "Object Jug"]
    assert report["changed"] == ["Collection Set"]
    assert report["outside"] == []
    assert report["why"]["Collection Set"] == "holds Jug"
    assert report["why"]["Material Jug"] == "material of Jug"


def test_an_object_that_nobody_asked_for_is_outside_with_its_data() -> None:
    assert outside(with_added("Lamp"), plan("Jug", kind="add")) == [
        "Collection Set",
        "Material Lamp",
        "Mesh Lamp",
        "Object Lamp",
    ]


def test_parts_of_a_planned_object_belong_to_it() -> None:
    assert outside(with_added("Mug_handle"), plan("Mug")) == []
    assert outside(with_added("Mughal"), plan("Mug")) != []
    assert outside(with_added("Lid", parent=("", ["Object Mug"])), plan("Mug")) == []
    cutter = with_added("Cutter")
    cutter["Object Mug"] = cutter["Object Mug"] | {"modifiers": ("cut", ["Object Cutter"])}
    assert outside(cutter, plan("Mug")) == []


def test_new_collections_around_a_planned_object_belong_to_it() -> None:
    file = kitchen()
    file["Object Jug"] = thing("Jug", "", "")
    file["Collection Jug things"] = {"objects": ("", ["Object Jug"])}
    file["Collection Table"] = {"children": ("", ["Collection Jug things"])}
    file["Scene Scene"] = file["Scene Scene"] | {"collection": ("", ["Collection Set", "Collection Table"])}
    assert outside(file, plan("Jug", kind="add")) == []


def with_actor(**changes: Any) -> File:
    """The spoon, which lay on the plate, as an actor with its tags; ``changes`` are further ones of the spoon."""
    file = kitchen()
    file["Object Spoon"] |= {"parent": ("", ["Object Spoon root"]), "transform": ("below the root", [])}
    file["Object Spoon"] |= changes
    file["Object Spoon root"] = thing("Spoon root", "", "")
    file["Collection Spoon"] = {"objects": ("", ["Object Spoon", "Object Spoon root"])}
    file["Collection Actors"] = {"children": ("", ["Collection Spoon"])}
    file["Collection Set"] = {"objects": ("", ["Object Mug", "Object Plate", "Object Camera"])}
    file["Scene Scene"] |= {"collection": ("", ["Collection Actors", "Collection Set"])}
    return file


def test_the_collections_that_an_actor_needs_for_its_tags_belong_to_it() -> None:
    actor = {"name": "Spoon", "deformation_kind": "none", "motion_kind": "keyframe"}
    spoon_moves = plan("Mug", stage="motion", actors=[actor])
    assert outside(with_actor(), spoon_moves) == []
    assert outside(with_actor(materials=("", ["Material Glaze"])), spoon_moves) == ["Object Spoon"]
    assert "Collection Spoon" in outside(with_actor(), plan("Mug", stage="motion"))


def test_what_goes_with_a_removed_object_is_not_outside() -> None:
    file = kitchen()
    for name in ("Object Plate", "Mesh Plate"):
        del file[name]
    file["Collection Set"] = {"objects": ("", ["Object Mug", "Object Spoon", "Object Camera"])}
    file["Object Spoon"] = file["Object Spoon"] | {"parent": ("gone", []), "transform": ("kept", [])}
    report = compared(blocks(kitchen()), blocks(file), plan("Plate", kind="remove")).as_row()
    assert report["removed"] == ["Mesh Plate", "Object Plate"]
    assert report["outside"] == []
    assert report["why"]["Object Spoon"] == "used Plate"
    assert report["why"]["Collection Set"] == "held Plate"


def test_an_object_that_went_unasked_is_outside() -> None:
    file = kitchen()
    del file["Object Spoon"]
    file["Collection Set"] = {"objects": ("", ["Object Mug", "Object Plate", "Object Camera"])}
    assert outside(file, plan("Plate", kind="remove")) == ["Collection Set", "Object Spoon"]


def test_bakes_and_the_plans_own_settings_are_not_outside() -> None:
    assert outside(edited("Object Plate", "caches", "baked"), plan("Mug")) == []
    assert outside(edited("Scene Scene", "render", "128"), plan("Mug")) == []
    assert outside(edited("Scene Scene", "frame range", "1-48"), plan("Mug", frame_end=48)) == []
    assert outside(edited("Scene Scene", "frame range", "1-48"), plan("Mug")) == ["Scene Scene"]
    assert outside(edited("Scene Scene", "camera", used=["Object Mug"]), plan("Plate")) == ["Scene Scene"]


def test_a_rigid_body_world_is_not_outside_where_something_is_to_move() -> None:
    file = edited("Scene Scene", "physics", "a world", ["Collection RigidBodyWorld"])
    file["Collection RigidBodyWorld"] = {"objects": ("", ["Object Mug", "Object Plate"])}
    actor = {"name": "Mug", "deformation_kind": "sim_rigid", "motion_kind": "bake"}
    assert outside(file, plan("Mug", stage="motion", actors=[actor])) == []
    assert outside(file, plan("Mug")) == ["Collection RigidBodyWorld", "Scene Scene"]


def test_which_keys_of_an_action_have_changed_is_told_with_their_values() -> None:
    def file(*keys: Sequence[float], **more: Sequence[Sequence[float]]) -> Blocks:
        digest = {"Action Gusts": repr((keys, more))}
        told = {"Action Gusts": {"strength": [list(key) for key in keys]}}
        told["Action Gusts"] |= {path: [list(key) for key in rows] for path, rows in more.items()}
        return Blocks(digest, {"Action Gusts": {"keyframes": repr(keys)}}, {}, keys=told)

    asked = plan("Gusts", stage="motion")
    was = file([1, 2475], [64, 6600], [80, 5500], location=[[1, 0, 0], [9, 1, 2]])
    now = file([1, 2475], [60, 9909.5], [64, 13200], location=[[1, 0, 0], [9, 1, 2.5]])
    edit = compared(was, now, asked)
    assert edit.keys == {
        "Action Gusts": (
            "location at 9: 1 2 → 1 2.5",
            "strength at 60: new 9909.5, at 64: 6600 → 13200, at 80: none",
        )
    }
    assert edit.note("Action Gusts").startswith("keyframes; location at 9: 1 2 → 1 2.5; strength at 60: new")
    many = file(*([frame, 0] for frame in range(100)))
    other = file(*([frame, 1] for frame in range(100)))
    (told,) = compared(many, other, asked).keys["Action Gusts"]
    assert told.count("→") == 24
    assert told.endswith(", and 76 more")
    assert compared(was, Blocks(now.digests, now.parts), asked).keys == {}, "it has too many keys to be told"


def test_a_readout_of_an_edit_has_what_it_names_and_what_the_file_did_not_have() -> None:
    had = blocks(kitchen()).objects
    assert "Camera" in had
    assert not any(name.startswith("Object") for name in had)
    task = RunTask("", actors=("Ball",), edit=True, targets=("Table", "Ball"), mentioned=("Rug",), old=had)
    assert task.readout() == ({"focus": ["Table", "Ball", "Rug"], "max_tokens": 2000}, {"old": list(had)})
    assert RunTask("", actors=("Ball",)).readout() == ({}, {}), "a new scene is read whole"
