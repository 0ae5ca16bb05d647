"""An edit from file and instruction to its result, with every part real but the model."""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING, Any

import crates
import pytest
from PIL import Image
from run_sessions import answered, asked_of, scenes, sit
from running import run_here
from team import DONE, Team, call, reply, run, whose, words_of

from agents.blender.blender_sessions import SessionSetup
from agents.loop.errors import Unusable
from agents.loop.record.events import read_event
from agents.loop.record.reducer import read_run_state
from agents.loop.running.tool_client import ToolClient
from agents.views.event_lines import format_event
from simworlds.sandbox.confinement.confined_command import best_sandbox

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from run_sessions import Played

pytestmark = pytest.mark.blender

STILL = {"kind": "still", "engine": "BLENDER_WORKBENCH", "resolution": [64, 36], "samples": 1}

# A file that knows nothing of the scene protocol: a mug and a spoon on a table, a lamp that swings.
KITCHEN = """\
import bpy
from mathutils import Matrix, Vector

scene = bpy.context.scene
scene.frame_end = 8
scene.render.engine = "BLENDER_WORKBENCH"


def block(name, size, at):
    bpy.ops.mesh.primitive_cube_add(size=1, location=at)
    made = bpy.context.object
    made.name = made.data.name = name
    made.data.transform(Matrix.Diagonal((*size, 1)))
    return made


block("Table", (2, 2, 0.1), (0, 0, -0.05))
mug = block("Mug", (0.2, 0.2, 0.2), (0, 0, 0.1))
block("Spoon", (0.4, 0.05, 0.02), (0.5, 0, 0.01))
glaze = bpy.data.materials.new("Glaze")
glaze.use_nodes = True
image = glaze.node_tree.nodes.new("ShaderNodeTexImage")
image.image = bpy.data.images.load("//leaf.png")
mug.data.materials.append(glaze)
lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
lamp.data.energy = 50
scene.collection.objects.link(lamp)
for frame, z in ((1, 1.0), (8, 1.2)):
    lamp.location.z = z
    lamp.keyframe_insert("location", frame=frame)
camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
camera.location = (2, -2, 1.5)
camera.rotation_euler = (Vector((0, 0, 0)) - camera.location).to_track_quat("-Z", "Y").to_euler()
scene.collection.objects.link(camera)
scene.camera = camera
"""
SUNK = crates.MODELING.replace("HEIGHT", "-0.1")
RED = """\
import bpy
mug = bpy.data.objects["Mug"]
mug.scale.z = 1.5
mug.location.z = 0.15
bpy.data.objects["Spoon"].location.x = 0.6
jug = bpy.data.objects.new("Jug", mug.data.copy())
jug.data.name = "Jug"
jug.location = (-0.5, 0, 0.1)
bpy.context.scene.collection.objects.link(jug)
"""

KEYED = """\
import bpy
ball = bpy.data.objects["Mug"]
for frame in range(1, 9):
    ball.location.z = max(0.1, 0.4 - 4.9 * ((frame - 1) / 24) ** 2)
    ball.keyframe_insert("location", frame=frame)
"""
TAGGED = """\
import bpy
tagged = bpy.data.collections.new("Mug")
system = bpy.data.collections.new("crockery")
bpy.context.scene.collection.children.link(system)
system.children.link(tagged)
system["protocol_role"] = "system"
mug = bpy.data.objects["Mug"]
root = bpy.data.objects.new("Mug root", None)
root["is_object_root"] = True
tagged.objects.link(root)
mug.parent = root
bpy.context.scene.collection.objects.unlink(mug)
tagged.objects.link(mug)
tagged["protocol_role"], tagged["deformation_kind"], tagged["motion_kind"] = "object", "sim_rigid", "bake"
"""
SIMULATED = """\
import bpy
mug = bpy.data.objects["Mug"]
mug.animation_data_clear()
mug.location.z = 0.4
bpy.ops.rigidbody.world_add()
for one, kind in ((mug, "ACTIVE"), (bpy.data.objects["Table"], "PASSIVE")):
    with bpy.context.temp_override(object=one, active_object=one, selected_objects=[one]):
        bpy.ops.rigidbody.object_add(type=kind)
    one.rigid_body.collision_shape = "BOX"
bpy.context.scene.rigidbody_world.point_cache.frame_end = 8
bpy.ops.ptcache.bake_all(bake=True)
"""


def task(stage: str, *targets: str, kind: str = "modify") -> dict[str, Any]:
    return {"kind": kind, "stage": stage, "targets": list(targets), "instruction": "As asked."}


def plan(*tasks: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"title": "An edit", "tasks": list(tasks), "render": STILL, **more}


_SAVE = """
bpy.ops.wm.save_as_mainfile(filepath=bpy.path.abspath("//kitchen.blend"), copy=True, compress=False)
"""


def build(folder: Path, code: str) -> Path:
    """A file made by code, with a texture beside it."""
    with ToolClient(SessionSetup(best_sandbox(), run=folder / "work")) as tools:
        Image.new("RGB", (4, 4), (20, 90, 30)).save(folder / "work" / "workspace" / "leaf.png")
        made = tools.call("blender_execute", {"code": code + _SAVE})
        assert not made.failed, made.text
    mine = folder / "mine"
    mine.mkdir()
    for name in ("leaf.png", "kitchen.blend"):
        (folder / "work" / "workspace" / name).rename(mine / name)
    return mine / "kitchen.blend"


@pytest.fixture(scope="session")
def kitchen(home: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(tmp_path_factory.mktemp("kitchen"), KITCHEN)


@pytest.fixture(scope="session")
def pristine(kitchen: Path) -> bytes:
    return kitchen.read_bytes()


# A file that knows no protocol


@pytest.fixture(scope="session")
def taller(
    play: Callable[..., Played], kitchen: Path, pristine: bytes, tmp_path_factory: pytest.TempPathFactory
) -> Played:
    """A mug made taller and a jug added, where the planner first errs and the coder at first moves the spoon, too."""
    reference = tmp_path_factory.mktemp("reference") / "wanted.webp"
    Image.new("RGB", (3000, 1000), (200, 30, 30)).save(reference)
    wrong = plan(task("modeling", "Mugg"))
    right = plan(task("modeling", "Mug"), task("modeling", "Jug", kind="add"))
    back = 'import bpy\nbpy.data.objects["Spoon"].location.x = 0.5'
    team = Team(coder={"modeling": (run(RED), DONE, run(back), DONE)})
    team.plan = lambda params: reply(right if "there is nothing called" in words_of(params) else wrong)
    return play(
        team, mode="edit", prompt="Make the mug taller, and add a jug", file=kitchen, reference=reference
    )


def test_an_edit_changes_what_is_asked_for_and_reports_every_data_block(
    taller: Played, kitchen: Path, tmp_path: Path
) -> None:
    assert taller.ended.how == "done", taller.ended.why
    report = taller.the("edited")
    assert report["added"] == ["Mesh Jug", "Object Jug"]
    assert report["removed"] == []
    assert report["changed"] == ["Object Mug", "Scene Scene"]
    assert report["outside"] == []
    assert report["why"]["Scene Scene"] == "holds Jug"
    assert {"Mesh Table", "Object Table", "Light Lamp", "Action LampAction", "Image leaf.png"} <= set(
        report["unchanged"]
    )
    assert report["parts"]["Object Mug"] == ["transform"]
    before, after = scenes(tmp_path, kitchen, taller.root / "scene.blend")
    assert {name for name in before if before[name] != after.get(name)} == set(report["changed"])


def test_once_there_is_a_plan_what_it_changes_is_read_in_full_and_the_rest_is_counted(taller: Played) -> None:
    planner, coder, reviewer = (
        [words_of(one) for one in taller.requests if whose(one)[0] == role]
        for role in ("planner", "coder", "reviewer")
    )
    assert "## Objects (5)" in planner[0]
    assert "- Spoon MESH in " in planner[0]
    for told, count, named in ((coder[0], "1 of 5", ["Mug"]), (reviewer[0], "2 of 6", ["Mug", "Jug"])):
        assert f"## Objects ({count})" in told
        assert re.findall(r"^- (\w+) MESH in ", told, re.MULTILINE) == named
        assert re.search(r"^- Scene Collection: 4 objects: .*Spoon", told, re.MULTILINE)
    states = taller.of("tool.called", role="runner", name="blender_scene_state", stage="modeling")
    assert [row["input"].get("focus") for row in states] == [None, *[["Mug", "Jug"]] * (len(states) - 1)]


def test_what_an_edit_moves_beside_what_was_asked_for_keeps_the_stage_open(taller: Played) -> None:
    first, second = taller.of("verified", stage="modeling")
    assert [(one["rule"], one["severity"], one["objects"]) for one in first["findings"]] == [
        ("unplanned", "hard", ["Spoon"])
    ]
    assert "(transform), which no task of the edit plan asks for" in first["findings"][0]["message"]
    assert second["ok"]
    assert taller.taken == [("modeling", "retry"), ("modeling", "advance")]


def test_what_changed_beside_what_was_asked_for_is_named_in_a_warning(taller: Played) -> None:
    moved = {"outside": ["Object Spoon"], "parts": {"Object Spoon": ["transform"]}}
    history = read_run_state(taller.root)
    told = "\n".join(format_event(read_event({**taller.the("edited"), **moved}), history))
    assert "Warning" in told
    assert "Object Spoon (transform)" in told
    assert "Object Mug" not in told.partition("Warning")[2]


def test_the_file_that_is_edited_stays_as_it_is(taller: Played, kitchen: Path, pristine: bytes) -> None:
    assert sorted(path.name for path in kitchen.parent.iterdir()) == ["kitchen.blend", "leaf.png"]
    assert kitchen.read_bytes() == pristine
    opened = taller.of("tool.answered", name="blender_load")[0]
    assert "leaf.png" in opened["content"][0]["text"]
    assert "missing" not in opened["content"][0]["text"]


def test_a_plan_for_what_is_not_in_the_file_goes_back_with_what_is(taller: Played) -> None:
    told = words_of(taller.requests[1])
    assert "there is nothing called 'Mugg' in the file. Nearest: 'Mug'" in told


def test_the_planner_sees_the_scene_and_the_reference_at_a_size_that_models_see(taller: Played) -> None:
    (message,) = taller.requests[0]["messages"]
    pictures = [block for block in message["content"] if block["type"] == "image"]
    assert len(pictures) >= 2
    kept = taller.the("reference")["path"]
    with Image.open(taller.root / kept) as picture:
        assert max(picture.size) == 1568


def test_all_but_the_planner_see_the_file_as_it_was_beside_what_it_is_now(taller: Played) -> None:
    coder, reviewer = (
        next(one for one in taller.requests if whose(one) == (role, "modeling"))
        for role in ("coder", "reviewer")
    )
    final = next(one for one in taller.requests if whose(one)[0] == "final_reviewer")
    assert "before the edit:" in words_of(coder)
    assert "What the result should look like:" in words_of(coder)
    for request in (reviewer, final):
        assert "PL between now and before the edit: " in words_of(request)
        assert "PL between now and wanted: " in words_of(request)


def test_what_is_compared_is_rendered_at_one_size_and_frame(taller: Played) -> None:
    before, *present = [row["input"] for row in taller.of("tool.called", name="blender_render")][:2]
    (frame,) = {row["data"]["frame"] for row in taller.of("tool.answered", name="blender_render")[:2]}
    assert before["name"] == "before"
    assert {**before, "name": "present", "frame": frame, "keep": True} == present[0]


# Faked physics


@pytest.fixture(scope="session")
def dropped(play: Callable[..., Played], kitchen: Path) -> Played:
    """A mug that is to fall: keyed and not tagged, keyed though tagged, then simulated."""
    actor = {"name": "Mug", "deformation_kind": "sim_rigid", "motion_kind": "bake"}
    turns = (run(KEYED), call("blender_verify"), DONE, run(TAGGED), DONE, run(SIMULATED), DONE)
    team = Team(plan=plan(task("motion", "Mug", "Table"), actors=[actor]), coder={"motion": turns})
    return play(team, mode="edit", prompt="Let the mug fall onto the table", file=kitchen)


def found_by(played: Played, attempt: int) -> list[dict[str, Any]]:
    findings = played.the("verified", stage="motion", attempt=attempt)["findings"]
    return [one for one in findings if one["rule"] == "R15"]


def test_an_actor_that_says_not_by_what_it_moves_cannot_advance(dropped: Played) -> None:
    (finding,) = found_by(dropped, 1)
    assert finding["severity"] == "hard"
    assert "there is no collection of that name" in finding["message"]
    first = dropped.of("decided", stage="motion")[0]
    assert first["taken"] == "retry"
    assert first["why"].startswith("The verifier has ")


def test_the_coder_is_told_of_it_when_it_verifies_and_not_only_at_the_end(dropped: Played) -> None:
    last = [one for one in dropped.requests if whose(one) == ("coder", "motion")][2]
    (answered,) = last["messages"][-1]["content"]
    assert "there is no collection of that name" in str(answered["content"])


def test_what_is_asked_beside_the_review_is_numbered_apart_from_what_the_review_is_shown(
    dropped: Played,
) -> None:
    states = dropped.of("tool.called", name="blender_scene_state")
    beside = [row for row in states if row["input"].get("sections") in (["data_blocks"], ["collections"])]
    assert len(beside) > 4
    assert {row["role"] for row in beside} == {"verifier"}, "else a resumed run takes one answer for another"


def test_keyframes_that_play_a_simulation_are_sent_back(dropped: Played) -> None:
    assert any("Mug" in one["objects"] for one in found_by(dropped, 2))
    assert dropped.of("decided", stage="motion")[1]["taken"] == "retry"
    assert any("R15" in words_of(request) for request in dropped.requests)


def test_a_real_simulation_closes_the_stage_and_its_consequences_are_no_surprise(dropped: Played) -> None:
    assert dropped.ended.how == "done", dropped.ended.why
    assert found_by(dropped, 3) == []
    report = dropped.the("edited")
    assert report["outside"] == [], report["why"]
    assert report["why"]["Collection crockery"] == "holds Mug"
    assert "Object Spoon" in report["unchanged"]


# Stages that leave a picture, or a material, behind

PAINTED = """\
import bpy
bpy.data.objects["Mug"].data.materials[0] = bpy.data.materials.new("Enamel")
"""


@pytest.fixture(scope="session")
def painted(play: Callable[..., Played], kitchen: Path) -> Played:
    """A mug with another material, in a stage that is followed by one in which nothing happens."""
    team = Team(
        plan=plan(task("texture", "Mug", "Enamel"), task("camera", "Camera")),
        coder={"texture": (run(PAINTED), DONE), "camera": (DONE,)},
    )
    return play(team, mode="edit", prompt="Paint the mug, and keep the camera", file=kitchen)


def test_what_fell_out_of_use_is_told_once_with_the_next_stage(painted: Played) -> None:
    assert painted.ended.how == "done", painted.ended.why
    told = [
        (whose(one), words_of(one).count("Not saved, since nothing uses it any more"))
        for one in painted.requests
    ]
    assert not any(count for (_, stage), count in told if stage == "texture")
    coder = next(words_of(one) for one in painted.requests if whose(one) == ("coder", "camera"))
    assert "material 'Glaze'" in coder.partition("Not saved, since")[2].partition("\n")[0]
    assert [count for who, count in told if who == ("coder", "camera")] == [1]
    assert any(count for (role, _), count in told if role == "planner")


def test_a_still_that_shows_the_same_is_shown_again(painted: Played) -> None:
    texture, camera = (
        next(words_of(one) for one in painted.requests if whose(one) == ("reviewer", stage))
        for stage in ("texture", "camera")
    )
    assert "Not rendered again" not in texture
    assert "Not rendered again, since nothing that this still shows has changed since." in camera
    first, second = (
        painted.the("tool.answered", name="blender_render", role="runner", stage=stage)
        for stage in ("texture", "camera")
    )
    assert [part["path"] for part in first["content"][1:]] == [part["path"] for part in second["content"][1:]]
    (lit,) = painted.of("tool.answered", name="blender_material_preview", role="runner", stage="texture")
    assert [one["name"] for one in lit["data"]["objects"]] == ["Mug"], "nothing else was to change"


# A file of the protocol that has faults of its own


@pytest.fixture(scope="session")
def brighter(play: Callable[..., Played], tmp_path_factory: pytest.TempPathFactory) -> Played:
    """A crate sunk into the floor, under a sun that is to be brighter; the first attempt sinks it deeper."""
    file = build(tmp_path_factory.mktemp("sunk"), "\n".join([SUNK, crates.CAMERA, crates.LIGHT]))
    deeper = 'import bpy\nbpy.data.objects["Crate root"].location.z = -0.2\nbpy.data.lights["Sun"].energy = 5'
    back = 'import bpy\nbpy.data.objects["Crate root"].location.z = -0.1'
    seen = call("blender_verify")
    team = Team(
        plan=plan(task("light", "Sun")), coder={"light": (run(deeper), seen, DONE, run(back), seen, DONE)}
    )
    return play(team, mode="edit", prompt="Make the sun brighter", file=file)


def test_faults_that_the_file_had_do_not_count_unless_they_get_worse(brighter: Played) -> None:
    assert brighter.ended.how == "done", brighter.ended.why
    assert any(
        one["rule"] == "V2"
        for one in brighter.of("tool.answered", name="blender_verify")[0]["data"]["findings"]
    )
    first, second = brighter.of("verified", stage="light")
    assert not first["ok"]
    assert any("made this worse" in one["message"] for one in first["findings"])
    assert second["ok"]
    assert brighter.taken == [("light", "retry"), ("light", "advance")]
    assert brighter.the("edited")["changed"] == ["Light Sun"]


def test_a_coder_that_verifies_is_told_of_the_edits_own_faults_alone(brighter: Played) -> None:
    coders = [
        words_of(one)
        for one in brighter.requests
        if one["system"][0]["text"].startswith("# You are the coder")
    ]
    assert any("made this worse" in one for one in coders)
    assert "No findings that were not there before the edit." in coders[-1]
    assert not any("Fix: Move them apart" in one for one in coders)


def test_the_team_is_told_which_faults_are_not_its_own(brighter: Played) -> None:
    coder = next(
        one for one in brighter.requests if one["system"][0]["text"].startswith("# You are the coder")
    )
    assert "What the verifier had to say of the file before the edit" in words_of(coder)


# Files that cannot be edited


def spoilt(kind: str, kitchen: Path, folder: Path) -> Path:
    """A file that is none, holds text, is cut off, or was written by a Blender that is not there yet."""
    path = folder / "bad.blend"
    whole = kitchen.read_bytes()
    if kind == "text":
        path.write_text("This is no .blend.")
    elif kind == "torn":
        path.write_bytes(whole[: len(whole) // 3])
    elif kind == "newer":
        head, version = whole[:13], whole[13:17]
        assert head.startswith(b"BLENDER")
        assert version.isdigit()
        path.write_bytes(head + b"9901" + whole[17:])
    return path


@pytest.mark.parametrize("kind", ["missing", "text", pytest.param("torn", marks=pytest.mark.whole), "newer"])
def test_a_file_that_cannot_be_opened_ends_clearly_before_a_model_is_asked(
    kind: str, kitchen: Path, home: Path, tmp_path: Path
) -> None:
    path = spoilt(kind, kitchen, tmp_path)
    with answered(home, Team()) as api:
        if kind in {"missing", "text"}:
            with pytest.raises(Unusable, match=r"bad\.blend"):
                sit(tmp_path / "run", mode="edit", file=path)
            assert not (tmp_path / "run").exists()
        else:
            ended = sit(tmp_path / "run", mode="edit", file=path).ended
            assert (ended.how, ended.again) == ("failed", False)
            assert "bad.blend" in ended.why
            assert "Traceback" not in ended.why
        assert asked_of(api) == []


def test_the_command_says_what_is_wrong_with_a_file_and_nothing_of_resuming(tmp_path: Path) -> None:
    path = tmp_path / "bad.blend"
    path.write_text("This is no .blend.")
    given = ["edit", str(path), "Make it blue", "--run", str(tmp_path / "run")]
    done = run_here(given, os.environ, tmp_path)
    assert (done.returncode, done.stdout) == (2, b"")
    told = f"Error: {path} is not a .blend file: its first bytes are not those of one.\n"
    assert done.stderr.decode() == told
