"""What an edit is compared with and shown: the faults of the file before, and pictures of what is wanted."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import pytest
from PIL import Image

from agents.loop.edit.baseline import format_known, new_findings
from agents.loop.edit.inputs import picture
from agents.loop.errors import Unusable
from agents.plan.edit import EditPlan, mentioned_in, unknown_targets
from agents.protocol.findings import Finding

if TYPE_CHECKING:
    from pathlib import Path

STILL = {"kind": "still", "engine": "BLENDER_WORKBENCH", "resolution": [64, 36], "samples": 1}


def depth(measured: float | None, *objects: str, **more: Any) -> Finding:
    about = {"rule": "V2", "severity": "hard", "measured": measured, "tolerance": 0.001, "unit": "m", **more}
    return Finding(objects=objects or ("Mug", "Table"), message="Too deep.", **about)


# Faults that were there


def test_a_fault_that_was_there_is_not_new_however_its_objects_are_ordered() -> None:
    assert new_findings([depth(0.05)], [depth(0.05, "Table", "Mug")]) == []
    assert new_findings([depth(0.05)], [depth(0.02)]) == []


def floating(*names: str) -> Finding:
    return Finding("W1", "soft", names, "")


def test_what_stands_on_something_that_floated_before_is_not_held_against_the_edit() -> None:
    before, on_it, alone = floating("Table"), floating("Lantern", "Table"), floating("Lantern")
    assert new_findings([before], [before, on_it]) == []
    assert new_findings([before], [before, alone]) == [alone]
    assert new_findings([floating("Shelf")], [on_it]) == [on_it]


def test_a_fault_that_got_worse_is_new_and_says_what_it_was() -> None:
    (found,) = new_findings([depth(0.05)], [depth(0.06)])
    assert found.message == "Too deep. The edit made this worse: it was 0.05 m."


def test_what_is_too_little_is_worse_the_less_it_is() -> None:
    assert new_findings([depth(0.4, tolerance=1.0)], [depth(0.5, tolerance=1.0)]) == []
    assert len(new_findings([depth(0.4, tolerance=1.0)], [depth(0.3, tolerance=1.0)])) == 1


def test_each_fault_that_was_there_excuses_one_and_the_worst_it_can() -> None:
    known, now = [depth(0.05), depth(0.02)], [depth(0.02), depth(0.05), depth(0.04)]
    assert [finding.measured for finding in new_findings(known, now)] == [0.04]


def test_other_objects_other_rules_and_what_is_now_certain_are_new() -> None:
    assert len(new_findings([depth(0.05)], [depth(0.05, "Jug", "Table")])) == 1
    assert len(new_findings([depth(0.05)], [depth(0.05, rule="V1")])) == 1
    assert len(new_findings([depth(None, outcome="undecided")], [depth(0.05)])) == 1
    assert len(new_findings([depth(0.05, severity="soft")], [depth(0.05)])) == 1


def test_faults_of_the_file_that_say_the_same_are_one_line() -> None:
    alone = [
        Finding("W1", "soft", (name,), f"{name!r} is not connected to the ground by declared contacts.")
        for name in [f"Leaf_{number:02}" for number in range(1, 18)]
    ]
    other = Finding("V1", "hard", ("Mug", "Table"), "The gap between 'Mug' and 'Table' is 4 mm.")
    assert format_known([*alone, other]) == [
        "V1 Mug, Table: The gap between 'Mug' and 'Table' is 4 mm.",
        "W1, 17 times: … is not connected to the ground by declared contacts. "
        "Objects: Leaf_01 … Leaf_17 (17).",
    ]
    assert format_known([]) == []


# Pictures


@pytest.mark.parametrize(("kind", "mode"), [("PNG", "RGBA"), ("PNG", "P"), ("JPEG", "CMYK"), ("WEBP", "RGB")])
def test_pictures_of_the_usual_kinds_become_one_that_models_read(
    tmp_path: Path, kind: str, mode: str
) -> None:
    path = tmp_path / "named.as-it-likes"
    Image.new(mode, (40, 30)).save(path, kind)
    found = picture(path)
    assert found.media_type == "image/png"
    with Image.open(io.BytesIO(found.data), formats=["PNG"]) as shown:
        assert shown.size == (40, 30)


def test_large_pictures_are_shrunk_in_pixels_and_bytes(tmp_path: Path) -> None:
    Image.effect_noise((1800, 1800), 200).convert("RGB").save(tmp_path / "noise.jpg", quality=60)
    found = picture(tmp_path / "noise.jpg")
    assert len(found.data) <= 3_500_000
    with Image.open(io.BytesIO(found.data)) as shown:
        assert shown.size[0] == shown.size[1] <= 1568


def test_a_photograph_is_shown_upright(tmp_path: Path) -> None:
    exif = Image.Exif()
    exif[0x0112] = 6  # taken with the camera on its side
    Image.new("RGB", (40, 20)).save(tmp_path / "photo.jpg", exif=exif)
    with Image.open(io.BytesIO(picture(tmp_path / "photo.jpg").data)) as shown:
        assert shown.size == (20, 40)


@pytest.mark.parametrize("kind", ["missing", "text", "torn", "GIF"])
def test_what_is_no_picture_is_said_to_be_none(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "wanted.png"
    if kind == "text":
        path.write_text("red")
    elif kind == "torn":
        written = io.BytesIO()
        Image.effect_noise((64, 64), 99).save(written, "PNG")
        path.write_bytes(written.getvalue()[:500])
    elif kind == "GIF":
        Image.new("P", (4, 4)).save(path, "GIF")
    with pytest.raises(Unusable, match=r"wanted\.png"):
        picture(path)


# Plans


def edit_plan(*tasks: tuple[str, ...], **more: Any) -> EditPlan:
    told = [
        {"kind": kind, "stage": stage, "targets": names, "instruction": "As told."}
        for kind, stage, *names in tasks
    ]
    return EditPlan.model_validate({"title": "An edit", "tasks": told, "render": STILL, **more})


def test_what_instructions_speak_of_beside_their_targets_is_found_in_the_file() -> None:
    task = {
        "kind": "add",
        "stage": "modeling",
        "targets": ["Jug"],
        "instruction": "A Jug like Mug.001, on the Table.",
    }
    plan = EditPlan.model_validate({"title": "Jug", "tasks": [task], "render": {"kind": "still"}})
    assert mentioned_in(plan, ("Mug.001", "Tab", "Table", "Jug", "Spoon")) == ["Mug.001", "Table"]


def test_only_what_is_there_or_is_added_can_be_changed() -> None:
    plan = edit_plan(
        ("add", "modeling", "Jug"), ("modify", "texture", "Jug"), ("remove", "modeling", "Spoom")
    )
    assert unknown_targets(plan, frozenset({"Spoon"})) == [
        "tasks.2.targets: there is nothing called 'Spoom' in the file. Nearest: 'Spoon'."
    ]


def test_a_modification_may_bring_what_is_new_beside_what_it_changes() -> None:
    file = frozenset({"Body", "Red paint", "Wheels"})
    assert unknown_targets(edit_plan(("modify", "texture", "Body", "Gold paint", "Beacon blue")), file) == []
    (slip,) = unknown_targets(edit_plan(("modify", "texture", "Body", "Wheel")), file)
    assert slip.endswith("Nearest: 'Wheels'. If it is new, name it in a task of the kind add.")
    assert len(unknown_targets(edit_plan(("modify", "texture", "Gold paint", "Beacon blue")), file)) == 2
    assert len(unknown_targets(edit_plan(("remove", "texture", "Body", "Gold paint")), file)) == 1


def test_actors_need_a_task_that_sets_them_in_motion() -> None:
    actor = {"name": "Jug", "deformation_kind": "sim_rigid", "motion_kind": "bake"}
    with pytest.raises(ValueError, match="no task is in the stage motion"):
        edit_plan(("modify", "texture", "Jug"), actors=[actor])
    assert edit_plan(("modify", "motion", "Jug"), actors=[actor]).actors[0].name == "Jug"
