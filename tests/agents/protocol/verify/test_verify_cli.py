"""``simworlds verify`` on files of every kind."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from PIL import Image
from places import REPO
from processes import becomes
from running import run_here
from scenes import SOON, build
from test_verify_tool import PLAN, SCENE

from agents.blender.files.run_folder import RunFolder
from agents.blender.launch import make_launch
from agents.blender.supervisor import Supervisor
from agents.blender.tools.base import Call
from agents.commands.verify import _draw  # pyright: ignore[reportPrivateUsage] - no scene ends Blender only there
from agents.protocol.findings import Report
from agents.protocol.report.summary import VerificationScope

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

COMMAND = [sys.executable, "-m", "simworlds", "verify"]
SOUND = """
thing("Room", box("Slab", (-2, -2, -0.1), (2, 2, 0)), system_name="ground")
thing("Table", box("Top", (-0.6, -0.4, 0), (0.6, 0.4, 0.75)))
bpy.data.objects["Top"]["contact_with"] = ["Slab"]
system("cameras").objects.link(bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera")))
system("lighting").objects.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
"""
# What a script leaves that thinks of nothing: overlapping, floating, named by Blender, without a tag.
UNORGANISED = """
import random

dice = random.Random(7)
bpy.ops.mesh.primitive_plane_add(size=20)
make = (bpy.ops.mesh.primitive_cube_add, bpy.ops.mesh.primitive_uv_sphere_add,
        bpy.ops.mesh.primitive_cylinder_add, bpy.ops.mesh.primitive_cone_add)
for number in range(199):
    make[number % 4](location=(dice.uniform(-6, 6), dice.uniform(-6, 6), dice.uniform(-0.2, 3)))
    bpy.context.object.scale = [dice.uniform(0.15, 0.5)] * 3
"""
Done = subprocess.CompletedProcess[str]


def saved(session: LiveSession, script: str, path: Path, **options: Any) -> Path:
    """A .blend of what a script builds."""
    build(session, script)
    more = "".join(f", {name}={value!r}" for name, value in options.items())
    session.run(f"bpy.ops.wm.save_as_mainfile(filepath=bpy.path.abspath('//made.blend'), copy=True{more})")
    (session.blender.folder.workspace.mount / "made.blend").replace(path)
    return path


def environment(tmp_path: Path) -> dict[str, str]:
    """Nothing of the user's own; temporary folders where they can be counted."""
    (tmp_path / "tmp").mkdir(exist_ok=True)
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("BLENDER_", "COLUMNS"))}
    return {**kept, "PYTHONPATH": str(REPO), "PYTHONWARNINGS": "error", "TMPDIR": str(tmp_path / "tmp")}


def verify(tmp_path: Path, *words: object) -> Done:
    """Runs the command in a folder of its own; it leaves nothing in the place for temporary files."""
    ran = run_here(["verify", *map(str, words)], environment(tmp_path), tmp_path)
    done = Done(ran.args, ran.returncode, ran.stdout.decode(), ran.stderr.decode())
    assert list((tmp_path / "tmp").iterdir()) == []
    return done


def verify_in_a_process(tmp_path: Path, *words: object) -> Done:
    """The same in a process of its own."""
    done = subprocess.run(
        [*COMMAND, *map(str, words)],
        cwd=tmp_path,
        env=environment(tmp_path),
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert "Traceback" not in done.stdout + done.stderr, done.stderr
    assert list((tmp_path / "tmp").iterdir()) == []
    return done


def test_a_sound_scene_is_0_and_says_what_was_checked(session: LiveSession, tmp_path: Path) -> None:
    saved(session, SOUND, tmp_path / "sound.blend")
    before = (tmp_path / "sound.blend").read_bytes()
    done = verify_in_a_process(tmp_path, "sound.blend", "--sarif")
    assert (done.returncode, json.loads(done.stdout)["runs"][0]["results"]) == (0, [])
    assert (tmp_path / "sound.blend").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir() if path.name != "tmp"] == ["sound.blend"]
    done = verify(tmp_path, "sound.blend")
    assert done.returncode == 0
    assert "Ok: no hard finding." in done.stdout
    assert "Checked: C1–C6, G1–G3, V1, V2, W1, W3–W5" in done.stdout
    assert "no plan was given" in done.stdout


def test_several_files_have_one_log_and_the_worst_exit_code(session: LiveSession, tmp_path: Path) -> None:
    saved(session, SOUND, tmp_path / "sound.blend")
    done = verify(tmp_path, "sound.blend", "missing.blend", "--sarif")
    assert done.returncode == 2
    first, second = json.loads(done.stdout)["runs"]
    assert [run["automationDetails"]["id"] for run in (first, second)] == [
        "simworlds-verify/sound.blend/",
        "simworlds-verify/missing.blend/",
    ]
    assert first["results"] == []
    assert second["invocations"][0]["executionSuccessful"] is False
    done = verify(tmp_path, "sound.blend", "missing.blend", "--json")
    assert done.returncode == 2
    assert "of one file" in done.stderr
    done = verify(tmp_path, "sound.blend", "--json", "--sarif")
    assert (done.returncode, done.stdout) == (2, "")
    assert "--json and --sarif exclude each other" in done.stderr


def test_findings_are_1_and_come_as_table_json_and_picture(session: LiveSession, tmp_path: Path) -> None:
    saved(session, SCENE, tmp_path / "broken.blend")
    done = verify(tmp_path, "broken.blend", "--json", "--image", "seen.png")
    assert done.returncode == 1
    data = json.loads(done.stdout)
    assert (data["file"], data["scene"], data["frame"], data["ok"]) == ("broken.blend", "Scene", 1, False)
    measured = {one["rule"]: one["measured"] for one in data["findings"] if one["severity"] == "hard"}
    assert measured == {"V1": pytest.approx(0.012, abs=1e-5), "V2": pytest.approx(0.01, abs=1e-5)}
    with Image.open(tmp_path / "seen.png") as picture:
        assert picture.width > 900
    done = verify(tmp_path, "broken.blend", "--rules", "V1", "--image", "/proc/seen.png")
    assert done.returncode == 2
    assert "Error: no image could be made: /proc/seen.png cannot be written" in done.stderr
    done = verify(tmp_path, "broken.blend", "--rules", "v1,C")
    assert done.returncode == 1
    assert "Leg · Slab" in done.stdout
    assert "12 mm" in done.stdout
    assert "V2" not in done.stdout


def test_a_drawing_that_ends_blender_is_told_beside_the_report(tmp_path: Path) -> None:
    folder = RunFolder.make(tmp_path / "run")
    scope = VerificationScope((), file="scene.blend")
    with closing(Supervisor(make_launch(folder.workspace), folder)) as blender:
        blender.end()
        why = _draw(blender, Report((), ()), Call(), scope, tmp_path / "seen.png")
    assert "being ended" in why
    assert not (tmp_path / "seen.png").exists()


def test_a_plan_is_judged_by(session: LiveSession, tmp_path: Path) -> None:
    saved(session, SCENE, tmp_path / "room.blend")
    (tmp_path / "plan.json").write_text(json.dumps(PLAN))
    done = verify(tmp_path, "room.blend", "--plan", "plan.json", "--rules", "R1,R2,R10", "--json")
    data = json.loads(done.stdout)
    assert done.returncode == 1
    assert data["plan"] == "A table"
    assert {rule["id"]: rule["state"] for rule in data["rules"]} == {
        "R1": "holds",
        "R2": "holds",
        "R10": "broken",
    }


def test_the_plan_of_the_run_that_made_a_file_is_found(session: LiveSession, tmp_path: Path) -> None:
    scene = saved(session, SCENE, tmp_path / "scene.blend")
    (tmp_path / "plan.json").write_text(json.dumps(PLAN))
    words = (scene, "--json")
    assert json.loads(verify(tmp_path, *words).stdout)["plan"] == ""
    (tmp_path / "journal.jsonl").touch()
    done = verify(tmp_path, *words)
    assert json.loads(done.stdout)["plan"] == PLAN["title"]
    assert "plan.json, of the run that made the file" in done.stderr
    (finding,) = [one for one in json.loads(done.stdout)["findings"] if one["rule"] == "R10"]
    assert finding["severity"] == "hard"
    withdraw = [{"rule": "R10", "objects": finding["objects"]}]
    decision = {"transition": "withdraw", "reason": "It hangs.", "withdraw": withdraw}
    row = {"type": "withdrew", "stage": "modeling", "attempt": 2, "n": 0, "decision": decision}
    (tmp_path / "journal.jsonl").write_text(json.dumps(row) + "\n")
    told = json.loads(verify(tmp_path, *words).stdout)
    assert {one["severity"] for one in told["findings"] if one["rule"] == "R10"} == {"soft"}
    assert "The planner took back what the plan says" in verify(tmp_path, scene).stdout
    (tmp_path / "journal.jsonl").write_text("no journal")
    (again,) = [
        one for one in json.loads(verify(tmp_path, *words).stdout)["findings"] if one["rule"] == "R10"
    ]
    assert again["severity"] == "hard"
    task = {"kind": "modify", "stage": "light", "targets": ["Sun"], "instruction": "Dim it."}
    edit = {"title": "An edit", "tasks": [task], "render": {"kind": "still"}}
    (tmp_path / "plan.json").write_text(json.dumps(edit))
    done = verify(tmp_path, *words)
    assert (json.loads(done.stdout)["plan"], "Warning" in done.stderr) == ("", False)
    (tmp_path / "plan.json").write_text(json.dumps(PLAN))
    checkpoint = tmp_path / "checkpoints" / "modeling.blend"
    checkpoint.parent.mkdir()
    checkpoint.write_bytes((tmp_path / scene).read_bytes())
    done = verify(tmp_path, "checkpoints/modeling.blend", *words[1:])
    assert json.loads(done.stdout)["plan"] == ""
    assert f"--plan {tmp_path / 'plan.json'}" in done.stderr
    (tmp_path / "plan.json").write_text(json.dumps(PLAN)[:-9])
    done = verify(tmp_path, *words)
    assert json.loads(done.stdout)["plan"] == ""
    assert "Warning: the scene is checked without a plan.\nThe plan " in done.stderr
    assert "plan: The plan is not valid JSON" in done.stderr


@pytest.fixture(scope="module")
def unorganised(_one_session: LiveSession, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with ``baseline.blend``, and ``tagged.blend``, where a collection has the tag of a system."""
    folder = tmp_path_factory.mktemp("unorganised")
    _one_session.empty()
    saved(_one_session, UNORGANISED, folder / "baseline.blend")
    saved(_one_session, "system('ground')", folder / "tagged.blend")
    return folder


def test_two_hundred_unorganised_primitives_get_a_useful_report_in_seconds(
    unorganised: Path, tmp_path: Path
) -> None:
    shutil.copy(unorganised / "baseline.blend", tmp_path)
    began = time.perf_counter()
    done = verify(tmp_path, "baseline.blend", "--json")
    assert time.perf_counter() - began < SOON
    data = json.loads(done.stdout)
    assert done.returncode == 1
    crossing = [one for one in data["findings"] if one["rule"] == "V2"]
    assert len(crossing) > 50
    assert all(one["measured"] > one["tolerance"] and one["at"] for one in crossing)
    assert {rule["id"] for rule in data["rules"] if rule["state"] == "idle"} >= {"C1", "G1", "V1", "R1"}
    done = verify(tmp_path, "baseline.blend")
    lines = done.stdout.splitlines()
    assert len(lines) < 45  # folded
    assert any(f"hard ×{len(crossing)}" in line for line in lines)
    assert any("no collection has the tag protocol_role" in line for line in lines)
    assert "of whose tags this scene has none" in " ".join(lines)


def test_numbered_meshes_that_are_in_no_object_are_one_row(unorganised: Path, tmp_path: Path) -> None:
    shutil.copy(unorganised / "tagged.blend", tmp_path)
    done = verify(tmp_path, "tagged.blend", "--rules", "C3")
    assert done.returncode == 1
    assert "Cube … Cube.049 (50)" in done.stdout
    assert "The mesh … is not in any object." in done.stdout
    assert "hard ×200" in done.stdout


def test_a_frame_that_blender_does_not_have_is_refused(tmp_path: Path) -> None:
    done = verify(tmp_path, "any.blend", "--frame", "99999999999")
    assert done.returncode == 2
    assert "99999999999 is not in the range" in done.stderr


def test_of_a_file_that_is_not_there_nothing_else_is_told(tmp_path: Path) -> None:
    for name in ("plan.json", "journal.jsonl"):
        (tmp_path / name).write_text("{}")
    (tmp_path / "checkpoints").mkdir()
    done = verify(tmp_path, "checkpoints/absent.blend")
    assert (done.returncode, done.stderr) == (2, "Error: There is no file checkpoints/absent.blend.\n")


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["absent.blend"], "There is no file absent.blend."),
        (["text.blend"], "text.blend is not a .blend file."),
        (["door.py"], "door.py is not a .blend file."),
        (["empty.blend"], "empty.blend is empty."),
        (["folder.blend"], "it is a link or not a regular file"),
        (["text.blend", "--rules", "X"], "--rules: There is no rule 'X'. The rules are: C1"),
        (["text.blend", "--rules", ","], "--rules: No rule is named."),
        (["text.blend", "--plan", "absent.json"], "The plan absent.json cannot be read: No such file"),
        (["text.blend", "--plan", "text.blend"], "plan: The plan is not valid JSON"),
        (
            ["text.blend", "--plan", "plan.json"],
            "relations[0].a: There is no object 'Lmap'; did you mean 'Lamp'",
        ),
        (["text.blend", "--plan", "loose.json"], "tolerances: contact cannot be loosened"),
        (["text.blend", "--image", "nowhere/seen.png"], "nowhere for seen.png does not exist"),
        (["text.blend", "--image", "text.blend"], "--image text.blend is to be a PNG: give it a name that"),
        (["text.blend", "--blender-exe", "/bin/true"], "No Blender was found"),
    ],
)
def test_what_cannot_be_checked_is_2_with_a_sentence(tmp_path: Path, words: list[str], why: str) -> None:
    (tmp_path / "text.blend").write_text("not a scene")
    (tmp_path / "door.py").write_text("import bpy")
    (tmp_path / "empty.blend").write_bytes(b"")
    (tmp_path / "folder.blend").mkdir()
    wrong = {**PLAN, "relations": [{"kind": "OnTopOf", "a": "Lmap", "b": "Table"}]}
    (tmp_path / "plan.json").write_text(json.dumps(wrong))
    (tmp_path / "loose.json").write_text(json.dumps({**PLAN, "tolerances": {"contact": 5}}))
    if "--blender-exe" in words:
        (tmp_path / "text.blend").write_bytes(b"BLENDER-v0501")
    done = verify(tmp_path, *words, "--json")
    assert done.returncode == 2, done.stdout
    assert why in " ".join(done.stderr.split())
    assert json.loads(done.stdout)["error"]


def test_torn_newer_and_hostile_files_are_2_with_a_sentence(session: LiveSession, tmp_path: Path) -> None:
    whole = saved(session, SOUND, tmp_path / "whole.blend", compress=False).read_bytes()
    assert whole[12:17] == b"v0501"
    files = {
        "torn": (whole[: len(whole) // 2], "torn.blend could not be checked: torn.blend cannot be opened"),
        "newer": (whole.replace(b"v0501", b"v0777", 1), "newer.blend was saved by Blender 7.77"),
    }
    for name, (content, why) in files.items():
        (tmp_path / f"{name}.blend").write_bytes(content)
        done = verify(tmp_path, f"{name}.blend", "--sarif")
        assert done.returncode == 2, name
        assert why in done.stderr
        (run,) = json.loads(done.stdout)["runs"]
        assert run["invocations"][0]["executionSuccessful"] is False
    garbled = bytearray(whole)
    for place in range(2000, len(garbled), 97):
        garbled[place] ^= 0xFF
    (tmp_path / "garbled.blend").write_bytes(garbled)
    done = verify_in_a_process(tmp_path, "garbled.blend")
    assert done.returncode == 2
    assert "garbled.blend could not be checked" in done.stderr


def test_scripts_in_a_file_do_not_run(session: LiveSession, tmp_path: Path) -> None:
    script = (
        f"{SOUND}\n"
        "text = bpy.data.texts.new('start.py')\n"
        "text.write(\"import bpy\\nbpy.data.objects.remove(bpy.data.objects['Sun'])\")\n"
        "text.use_module = True\n"
    )
    saved(session, script, tmp_path / "script.blend")
    data = json.loads(verify(tmp_path, "script.blend", "--rules", "W5", "--json").stdout)
    assert data["rules"][0]["state"] == "holds"


def test_what_links_files_that_cannot_be_read_is_not_judged_by_halves(
    session: LiveSession, tmp_path: Path
) -> None:
    (tmp_path / "lib").mkdir()
    saved(session, SOUND, tmp_path / "lib" / "parts.blend")
    session.empty()
    (session.blender.folder.workspace.mount / "parts.blend").write_bytes(
        (tmp_path / "lib/parts.blend").read_bytes()
    )
    session.run(
        "with bpy.data.libraries.load(bpy.path.abspath('//parts.blend'), link=True) as (has, takes):\n"
        "    takes.collections = ['ground', 'set']\n"
        "for one in takes.collections:\n"
        "    bpy.context.scene.collection.children.link(one)\n"
        f"bpy.data.libraries[0].filepath = {str(tmp_path / 'lib' / 'parts.blend')!r}\n"
        "bpy.ops.wm.save_as_mainfile(filepath=bpy.path.abspath('//made.blend'), copy=True, "
        "relative_remap=False)"
    )
    (session.blender.folder.workspace.mount / "made.blend").replace(tmp_path / "linking.blend")
    done = verify(tmp_path, "linking.blend", "--rules", "C")
    assert done.returncode == 2
    assert "parts.blend, which cannot be read: give its folder with --read" in done.stderr
    done = verify(tmp_path, "linking.blend", "--rules", "C", "--read", tmp_path / "lib")
    assert done.returncode == 0, done.stdout + done.stderr


def test_another_frame_is_reached_by_steps_where_nothing_is_baked(
    session: LiveSession, tmp_path: Path
) -> None:
    script = f"""{SOUND}
bpy.ops.rigidbody.world_add()
bpy.ops.mesh.primitive_cube_add(size=0.2, location=(0, 0, 5))
bpy.ops.rigidbody.object_add()
bpy.context.object.name = "Falls"
"""
    saved(session, script, tmp_path / "falls.blend")
    done = verify(tmp_path, "falls.blend", "--frame", "40", "--rules", "V2", "--json")
    # After 39 frames at 24 a second it is 12.9 m down, and on its way through floor and table.
    data = json.loads(done.stdout)
    assert data["frame"] == 40
    assert all("Falls" in finding["objects"] for finding in data["findings"])
    assert done.returncode in {0, 1}


def test_geometry_that_is_no_numbers_is_no_pass(session: LiveSession, tmp_path: Path) -> None:
    script = f"""{SOUND}
bad = box("Bad", (0, 0, 1), (1, 1, 2))
bad.data.vertices[0].co.x = float("nan")
thing("Broken", bad)
"""
    saved(session, script, tmp_path / "nan.blend")
    done = verify(tmp_path, "nan.blend", "--json")
    found = {one["rule"] for one in json.loads(done.stdout)["findings"]}
    assert "R4" in found
    assert done.returncode == 1


@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.whole)])
def test_an_interrupt_leaves_nothing_behind(
    session: LiveSession, tmp_path: Path, number: signal.Signals
) -> None:
    script = f"""{SOUND}
bpy.ops.mesh.primitive_grid_add(x_subdivisions=150, y_subdivisions=150, location=(0, 0, 3))
bpy.ops.object.modifier_add(type="CLOTH")
bpy.context.object.modifiers[0].point_cache.frame_end = 4000
"""
    saved(session, script, tmp_path / "slow.blend")
    process = subprocess.Popen(
        [*COMMAND, "slow.blend", "--frame", "4000"],
        cwd=tmp_path,
        env=environment(tmp_path),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stderr is not None
        # Nothing is said for two seconds; then, what takes so long.
        assert process.stderr.readline().rstrip() in {"Opening slow.blend …", "Going to the frame …"}
        assert becomes(lambda: bool(running(tmp_path)))
        process.send_signal(number)
        _, told = process.communicate(timeout=120)
    finally:
        process.kill()
        process.communicate()
    assert process.returncode == 130
    assert told.splitlines()[-1] == "Interrupted."
    assert list((tmp_path / "tmp").iterdir()) == []
    assert becomes(lambda: not running(tmp_path))


def running(tmp_path: Path) -> list[int]:
    """Blender's processes, and what confines them, of a run below a folder for temporary files."""
    marker = os.fsencode(tmp_path / "tmp") + b"/simworlds-verify-"
    return [
        int(folder.name)
        for folder in Path("/proc").glob("[0-9]*")
        if marker in (given_to(folder)) and int(folder.name) != os.getpid()
    ]


def given_to(folder: Path) -> bytes:
    """A process's environment; nothing of one that is gone, or is only waited for."""
    try:
        return (folder / "environ").read_bytes()
    except OSError:
        return b""
