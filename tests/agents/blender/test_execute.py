"""``blender_execute``: what comes back of code that works, and of code that does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from agents.blender.tools.base import Call, ToolContext, parse
from agents.blender.tools.execute import TOOL, Outcome
from agents.blender.tools.tag import TOOL as TAG
from simworlds.sandbox.errors import Died, Refusal

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

FLAG = """
bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4)
flag = bpy.context.object
flag.name = flag.data.name = "Flag"
flag.modifiers.new("Cloth", "CLOTH")
flag.modifiers.new("Solid", "SOLIDIFY")
bpy.ops.mesh.primitive_cube_add(location=(5, 0, 0))
"""


def test_the_value_of_a_final_expression_comes_back(session: LiveSession) -> None:
    found = session.use(TOOL, code="x = 20\nx + 1")
    assert found.data["value"] == "21"
    assert not found.failed


def test_names_do_not_outlive_a_call_but_the_scene_does(session: LiveSession) -> None:
    session.use(TOOL, code="kept = 1\nbpy.data.objects.new('Kept', None)")
    assert session.use(TOOL, code="'Kept' in bpy.data.objects").data["value"] == "True"
    assert session.use(TOOL, code="kept").data["error"]["type"] == "NameError"


def test_reports_changes_by_kind(session: LiveSession) -> None:
    made = session.use(
        TOOL,
        code="bpy.ops.mesh.primitive_cube_add()\nbpy.context.object.modifiers.new('Smooth', 'SUBSURF')",
    )
    assert made.data["changed"]["objects"] == {"added": ["Cube"]}
    assert made.data["changed"]["modifiers"] == {"added": ["Cube[Smooth]"]}
    moved = session.use(TOOL, code="bpy.data.objects['Cube'].location.x = 2")
    assert moved.data["changed"]["objects"] == {"changed": ["Cube (transform)"]}
    gone = session.use(TOOL, code="bpy.data.objects.remove(bpy.data.objects['Cube'])")
    assert gone.data["changed"]["objects"] == {"removed": ["Cube"]}
    assert gone.data["changed"]["modifiers"] == {"removed": ["Cube[Smooth]"]}


MANY = """
ball = bpy.data.meshes.new("Ball")
for number in range(200):
    obj = bpy.data.objects.new("Ball", ball)
    bpy.context.collection.objects.link(obj)
    obj.modifiers.new("Smooth", "SUBSURF")
for row, column in [(1, 1), (1, 2), (10, 1)]:
    bpy.context.collection.objects.link(bpy.data.objects.new(f"Tile_{row}_{column}", ball))
"""


def test_a_series_of_changes_is_told_as_one(session: LiveSession) -> None:
    told = session.use(TOOL, code=MANY).data["changed"]
    assert told["objects"] == {
        "added": ["Ball … Ball.199 (200)", "Tile_10_1", "Tile_1_1", "Tile_1_2"],
    }, "three are no series"
    assert told["modifiers"] == {"added": ["Ball[Smooth] … Ball.199[Smooth] (200)"]}
    moved = session.use(TOOL, code="for obj in bpy.data.objects:\n    if '.' in obj.name: obj.location.x = 2")
    assert moved.data["changed"]["objects"] == {
        "changed": ["Ball.001 (transform) … Ball.199 (transform) (199)"]
    }


def test_more_kinds_than_fit_are_counted_whole(session: LiveSession) -> None:
    names = "[f'{kind}{one}.{n:03}' for kind in 'ABCDEFG' for one in 'abcdefg' for n in range(1, 6)]"
    told = session.use(TOOL, code=f"for name in {names}:\n    bpy.data.meshes.new(name)")
    added = told.data["changed"]["meshes"]["added"]
    assert len(added) == 41
    assert added[0] == "Aa.001 … Aa.005 (5)"
    assert added[-1] == "… and 45 more", "nine series of five"


def test_changes_are_counted_whatever_the_names_look_like(session: LiveSession) -> None:
    names = "[*(f'Ball.{n:03}' for n in range(1, 6)), 'a … b (7)', '… and 9 more']"
    code = f"for name in {names}:\n    bpy.data.meshes.new(name)"
    told = session.blender.call("execute", {"code": code}, Outcome.model_validate, timeout=60).value
    assert told.changed["meshes"]["added"] == ["Ball.001 … Ball.005 (5)", "a … b (7)", "… and 9 more"]
    assert told.counts == {"meshes": {"added": 7}}
    assert "counts" not in told.model_dump()


def test_reading_changes_nothing(session: LiveSession) -> None:
    assert session.use(TOOL, code="len(bpy.data.objects)").data["changed"] == {}


def test_an_error_marks_the_line_that_failed(session: LiveSession) -> None:
    found = session.use(TOOL, code="a = 1\nb = 2\nc = bpy.data.objects['Nobody']\nd = 4")
    error = found.data["error"]
    assert (error["type"], error["line"]) == ("KeyError", 3)
    assert ">    3  c = bpy.data.objects['Nobody']" in error["source"]
    assert "     4  d = 4" in error["source"]
    assert "supervisor" not in error["traceback"]
    assert not any(name in error["traceback"] for name in ("worker.py", "service.py", "execute.py"))


@pytest.mark.parametrize(
    ("code", "ask"),
    [
        ("bpy.context.scene.nonsense", "bpy.types.Scene.nonsense"),
        ("bpy.data.meshes.new('m').use_auto_smooth = True", "bpy.types.Mesh.use_auto_smooth"),
        (
            "m = bpy.data.materials.new('m')\nm.use_nodes = True\n"
            "m.node_tree.nodes['Principled BSDF'].inputs['Specular'].default_value = 1",
            "bpy.types.ShaderNodeBsdfPrincipled.inputs['Specular']",
        ),
        ("bpy.ops.mesh.primitive_cube_add(sizee=2)", "bpy.ops.mesh.primitive_cube_add(sizee)"),
        ("bpy.ops.mesh.primitive_dragon_add()", "bpy.ops.mesh.primitive_dragon_add"),
        ("import mathutils\nmathutils.Vector((1, 2, 3)).lenght", "mathutils.Vector.lenght"),
        ("bpy.ops.object.select_all({'scene': bpy.context.scene})", "bpy.types.Context.temp_override"),
    ],
)
def test_an_error_names_what_to_look_up(session: LiveSession, code: str, ask: str) -> None:
    assert session.use(TOOL, code=code).data["error"]["ask"].startswith(ask)


def test_unknown_attribute_lists_existing_names(session: LiveSession) -> None:
    session.run("for name in ('Chair', 'Table'): bpy.data.objects.new(name, None)")
    found = session.use(TOOL, code="bpy.data.objects['Tabel']")
    assert found.data["error"]["there"] == ["Table", "Chair"]
    assert found.data["error"]["ask"] == ""
    assert "`Table`, `Chair`" in found.text
    socket = session.use(
        TOOL,
        code="m = bpy.data.materials.new('m')\nm.use_nodes = True\nm.node_tree.nodes[0].inputs['Rouhgness']",
    )
    assert socket.data["error"]["there"][0] == "Roughness"


def test_reports_an_error_whose_text_fails(session: LiveSession) -> None:
    found = session.use(
        TOOL, code="class E(Exception):\n    def __str__(self): raise ValueError('no')\nraise E()"
    )
    error = found.data["error"]
    assert (error["type"], error["line"]) == ("E", 3)
    assert "str() failed" in error["message"]


def test_python_errors_are_not_looked_up(session: LiveSession) -> None:
    assert session.use(TOOL, code="1 / 0").data["error"]["ask"] == ""


def test_the_documentation_answers_into_the_error(session: LiveSession) -> None:
    asked: list[str] = []

    def docs(query: str, *, max_tokens: int = 400) -> str:
        asked.append(query)
        return "It is called Specular IOR Level now."

    context = ToolContext(session.blender, docs)
    found = TOOL.run(context, parse(TOOL, {"code": "bpy.context.scene.nonsense"}), Call())
    assert asked == ["bpy.types.Scene.nonsense"]
    assert "It is called Specular IOR Level now." in found.text


def test_failed_code_is_undone_when_asked(session: LiveSession) -> None:
    session.use(TOOL, code="bpy.data.objects.new('Before', None)")
    found = session.use(TOOL, code="bpy.data.objects.new('Half', None)\n1 / 0", on_error="restore")
    assert found.failed
    assert "The scene was restored from checkpoint" in found.text
    assert session.run("sorted(o.name for o in bpy.data.objects)") == []  # no user, so not written out


def test_failed_code_is_kept_by_default_and_says_how_to_undo_it(session: LiveSession) -> None:
    found = session.use(
        TOOL, code="o = bpy.data.objects.new('Half', None)\nbpy.context.collection.objects.link(o)\n1 / 0"
    )
    assert session.run("[o.name for o in bpy.data.objects]") == ["Half"]
    assert "blender_load(checkpoint=" in found.text
    assert "on_error='restore'" in found.text, "not everybody has blender_load"


def test_exit_is_an_error_like_any_other(session: LiveSession) -> None:
    found = session.use(TOOL, code="import sys\nsys.exit(3)")
    assert "sys.exit(3)" in found.data["error"]["message"]
    assert session.run("1 + 1") == 2


@pytest.mark.parametrize("code", ["this is no code", "def f(:", "\x00", "return 1"])
def test_reports_the_line_of_a_syntax_error(session: LiveSession, code: str) -> None:
    found = session.use(TOOL, code=code)
    assert found.data["error"]["type"] in {"SyntaxError", "ValueError"}
    assert session.run("1 + 1") == 2


def test_refuses_code_that_is_not_text(session: LiveSession) -> None:
    with pytest.raises(Refusal, match="code"):
        session.use(TOOL, code="\ud800")


def test_code_without_end_is_refused(session: LiveSession) -> None:
    with pytest.raises(Refusal, match="at most"):
        session.use(TOOL, code="x = 1\n" * 2_000_000)


def test_recursion_without_end_is_an_error(session: LiveSession) -> None:
    assert session.use(TOOL, code="def f(): f()\nf()").data["error"]["type"] == "RecursionError"


def test_output_without_end_is_cut_and_counted(session: LiveSession) -> None:
    found = session.use(TOOL, code="for _ in range(3000): print('x' * 100_000)")
    assert "bytes left out" in found.data["stdout"]
    assert len(found.text) < 20_000


def test_output_of_c_and_of_closed_streams_is_kept_apart(session: LiveSession) -> None:
    session.use(TOOL, code="import sys, os\nos.write(1, b'from C')\nsys.stdout.close()")
    found = session.use(TOOL, code="print('heard')")
    assert found.data["stdout"] == "heard\n"


@pytest.mark.parametrize(
    "poison",
    [
        "import builtins\nbuiltins.print = None\nbuiltins.len = None",
        "import sys\nsys.stdout = None\nsys.stderr = None",
        "import os, tempfile\nos.chdir(tempfile.gettempdir())\nos.environ.clear()",
        "import sys\nsys.setrecursionlimit(60)",
        "import sys\nsys.path.clear()",
        "import bpy\nbpy.app.handlers.depsgraph_update_post.clear()",
        "import sys\nsys.settrace(lambda *a: 1 / 0)",
        "import gc\ngc.disable()",
        "import signal\nsignal.alarm(1)",
        "import os\nos.close(1)\nos.close(2)",
        "bpy.ops.wm.read_homefile(use_empty=True)",
    ],
)
def test_one_call_does_not_affect_the_next(session: LiveSession, poison: str) -> None:
    session.use(TOOL, code=poison)
    found = session.use(
        TOOL, code="import json\nbpy.ops.mesh.primitive_cube_add()\nprint(len('abc'))\njson.dumps(1)"
    )
    assert found.data["error"] is None
    assert found.data["stdout"] == "3\n"
    assert "Cube" in found.data["changed"]["objects"]["added"]


def test_reports_a_value_whose_repr_fails(session: LiveSession) -> None:
    found = session.use(TOOL, code="class A:\n    def __repr__(self): raise ValueError('no')\nA()")
    assert "repr() failed" in found.data["value"]


def test_nan_and_infinity_reach_the_scene(session: LiveSession) -> None:
    found = session.use(
        TOOL, code="bpy.ops.mesh.primitive_cube_add()\nbpy.context.object.location.x = float('nan')"
    )
    assert not found.failed
    assert session.run("1 + 1") == 2


def test_a_crash_says_which_line_it_was_in(own_session: LiveSession) -> None:
    with pytest.raises(Died) as crash:
        own_session.use(TOOL, code="import ctypes\nctypes.string_at(0)")
    assert 'File "<blender_execute>", line 2' in crash.value.printed


# What is printed while it runs


def test_printed_lines_are_told_while_the_code_runs(session: LiveSession) -> None:
    told: list[tuple[float, float | None, str]] = []
    waiting = """
import os, time
print("one")
while not os.path.exists("heard"):
    time.sleep(0.01)
print("two")
"""

    def hear(done: float, total: float | None, text: str) -> None:
        told.append((done, total, text))
        (session.blender.folder.workspace.mount / "heard").touch()

    found = session.use(TOOL, Call(progress=hear), code=waiting)
    assert told[0] == (1, None, "one")
    assert found.data["stdout"].split() == ["one", "two"]


# What changed


def changed(session: LiveSession, code: str) -> dict[str, dict[str, list[str]]]:
    """What a call says that it changed."""
    found = session.use(TOOL, code=code)
    assert not found.failed, found.text
    assert ("Changed:" in found.text) == bool(found.data["changed"])
    return found.data["changed"]


@pytest.mark.parametrize(
    ("code", "kind", "told"),
    [
        ("bpy.data.objects['Flag']['mood'] = 2", "objects", "Flag (custom properties)"),
        ("bpy.data.objects['Flag'].modifiers['Cloth'].settings.mass = 2", "objects", "Flag (modifiers)"),
        ("bpy.data.objects['Flag'].modifiers['Solid'].thickness = 2", "objects", "Flag (modifiers)"),
        ("bpy.data.objects['Flag'].location.x = 2", "objects", "Flag (transform)"),
        ("bpy.data.objects['Flag'].data.vertices[0].co.z = 2", "meshes", "Flag"),
        ("bpy.context.scene.gravity.z = -1", "scenes", "Scene (gravity)"),
        ("bpy.data.objects['Flag'].name = 'Banner'", "objects", "Flag → Banner"),
    ],
)
def test_exactly_what_was_changed_is_told(session: LiveSession, code: str, kind: str, told: str) -> None:
    session.run(FLAG)
    assert changed(session, code) == {kind: {"changed": [told]}}


def test_what_a_new_link_has_evaluated_anew_is_not_told_as_changed(session: LiveSession) -> None:
    session.run(FLAG)
    told = changed(session, "bpy.context.collection.objects.link(bpy.data.objects.new('New', None))")
    assert told["objects"] == {"added": ["New"]}
    assert changed(session, "bpy.context.scene.frame_set(5)\nbpy.context.scene.frame_set(1)") == {}


def test_what_came_between_two_calls_is_not_told_of_the_second(session: LiveSession) -> None:
    session.run(FLAG)
    assert changed(session, "bpy.data.objects['Flag'].location.x = 2") == {
        "objects": {"changed": ["Flag (transform)"]}
    }
    session.use(TAG, strict_grounding=True)
    assert changed(session, "len(bpy.data.objects)") == {}
    session.blender.restore()
    assert changed(session, "bpy.data.objects['Flag'].location.y = 2") == {
        "objects": {"changed": ["Flag (transform)"]}
    }


def test_a_picture_that_others_write_between_two_calls_is_not_told_of_the_second(
    session: LiveSession,
) -> None:
    make = """
import os
made = bpy.data.images.new("Picture", 4, 4)
made.filepath_raw, made.file_format = os.path.abspath("picture.png"), "PNG"
made.save()
"""
    assert changed(session, make) == {"images": {"added": ["Picture"]}}
    with (session.blender.folder.workspace.mount / "picture.png").open("ab") as picture:
        picture.write(b"more")
    assert changed(session, "len(bpy.data.images)") == {}


def test_what_failed_code_changed_is_told_once(session: LiveSession) -> None:
    session.run(FLAG)
    failed = session.use(TOOL, code="bpy.data.objects['Flag'].location.x = 2\nnobody")
    assert failed.data["changed"] == {"objects": {"changed": ["Flag (transform)"]}}
    assert changed(session, "len(bpy.data.objects)") == {}


def test_a_simulation_that_starts_again_is_told(session: LiveSession) -> None:
    session.run(FLAG)
    step = "for frame in range({}, {}):\n    bpy.context.scene.frame_set(frame)\n"
    pin = "bpy.data.objects['Flag'].modifiers['Cloth'].settings.pin_stiffness = {}\n"
    session.run(step.format(1, 6))
    between = session.use(TOOL, code=pin.format(2) + step.format(6, 9))
    assert between.data["changed"]["caches"]["reset"][0].startswith("cloth of 'Flag'")
    assert "simulates again from its first frame" in between.text
    session.run(step.format(1, 6))
    assert "caches" not in changed(session, step.format(6, 9))
