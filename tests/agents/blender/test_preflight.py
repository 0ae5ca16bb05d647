"""The pre-flight of ``blender_execute``: what is refused before it runs, and what must not be."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING, Any

import pytest
from places import REPO

from agents.blender.checks.preflight import _answers  # pyright: ignore[reportPrivateUsage] - what hostile code can answer
from agents.blender.tools.base import Call, NotChecked, ToolContext, parse, perform
from agents.blender.tools.execute import TOOL
from kb_check import tool as check_tool
from kb_serve.bases import Bases
from kb_serve.rebuild import Upkeep
from kb_serve.service import Service
from simworlds.llm.messages import ToolUse
from simworlds.llm.records.transcript import read_folder
from simworlds.sandbox.replies import Malformed, parse_value, unread

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from live_session import LiveSession

    from agents.blender.tools.base import Check, Result

pytestmark = pytest.mark.blender

Execute = "Callable[..., Result]"


@pytest.fixture(scope="module")
def check(base: Path) -> Iterator[Check]:
    with closing(Bases(base.parent.parent)) as bases:
        service = Service(bases, Upkeep(bases, enabled=False))

        def checked(code: str) -> dict[str, Any]:
            result = check_tool.answer(service, {"code": code})
            assert result.structured_content is not None
            return result.structured_content

        yield checked


@pytest.fixture
def execute(session: LiveSession, check: Check) -> Callable[..., Result]:
    """Runs code as the server does, with a knowledge base beside it."""
    context = ToolContext(session.blender, session.context.docs, check)

    def run(code: str, **more: Any) -> Result:
        return perform(TOOL, context, parse(TOOL, {"code": code, **more}), Call())

    return run


def was_refused(result: Result) -> bool:
    return result.data.get("executed") is False


def test_an_error_is_told_with_its_fix_before_anything_ran(
    execute: Callable[..., Result], session: LiveSession
) -> None:
    result = execute(
        "ob = bpy.data.objects.new('Half', None)\n"
        "bpy.context.scene.collection.objects.link(ob)\n"
        "bpy.data.objects['Half'].draw_type = 'WIRE'\n"
    )
    assert was_refused(result)
    assert result.failed
    assert result.text.startswith("**Nothing was executed; the scene is unchanged.** 1 error")
    assert "line 3" in result.text
    assert "Fix: `bpy.data.objects['Half'].display_type = 'WIRE'`" in result.text
    assert session.run("len(bpy.data.objects)") == 0
    assert [finding["rule"] for finding in result.data["preflight"]] == ["unknown-attribute"]


def test_a_deprecation_that_a_warning_tells_of_is_not_told_again(execute: Callable[..., Result]) -> None:
    result = execute("import sys\nmaterial = bpy.data.materials.new('Dye')\nmaterial.use_nodes = True\n")
    if "use_nodes" not in result.text:
        pytest.skip("this Blender still needs it")
    assert "DeprecationWarning" in result.data["stderr"]
    assert result.text.count("line 3") == 1
    assert "DeprecationWarning" not in result.text
    assert "On stderr" not in result.text


def test_code_is_run_unchecked_when_asked(execute: Callable[..., Result]) -> None:
    result = execute("bpy.context.scene.nonsense", preflight="off")
    assert result.data["error"]["type"] == "AttributeError"


def test_right_code_runs_without_a_word_of_the_check(execute: Callable[..., Result]) -> None:
    result = execute("bpy.ops.mesh.primitive_cube_add(size=2)\nbpy.context.object.name")
    assert result.data["value"] == "'Cube'"
    assert "preflight" not in result.data
    assert "arning" not in result.text


REGISTERS = [
    # what registers, what then uses it
    ("bpy.types.Scene.my_count = bpy.props.IntProperty()", "bpy.context.scene.my_count = 4"),
    (
        "class Group(bpy.types.PropertyGroup):\n    size: bpy.props.IntProperty()\nbpy.utils.register_class(Group)\n"
        "bpy.types.ID.my_group = bpy.props.PointerProperty(type=Group)",
        "bpy.data.objects.new('x', None).my_group.size = 3",
    ),
    (
        "class Op(bpy.types.Operator):\n    bl_idname = 'my.op'\n    bl_label = 'Op'\n"
        "    size: bpy.props.IntProperty()\n    def execute(self, context):\n        return {'FINISHED'}\n"
        "bpy.utils.register_class(Op)",
        "bpy.ops.my.op(size=3)",
    ),
    (
        "class MY_PT_panel(bpy.types.Panel):\n    bl_label = 'x'\n    bl_space_type = 'VIEW_3D'\n"
        "    bl_region_type = 'UI'\n    def draw(self, context):\n        pass\nbpy.utils.register_class(MY_PT_panel)",
        "bpy.types.MY_PT_panel",
    ),
    (
        "class Engine(bpy.types.RenderEngine):\n    bl_idname = 'MY_ENGINE'\n    bl_label = 'x'\n"
        "bpy.utils.register_class(Engine)",
        "bpy.context.scene.render.engine = 'MY_ENGINE'",
    ),
    (
        "bpy.types.Object.my_shout = property(lambda self: self.name.upper())",
        "bpy.data.objects.new('x', None).my_shout",
    ),
    ("pass", "import bpy\ntry:\n    bpy.context.scene.nonsense\nexcept AttributeError:\n    pass"),
]


@pytest.mark.parametrize("in_one_call", [False, True])
@pytest.mark.parametrize(("before", "uses"), REGISTERS)
def test_what_was_registered_may_be_used(
    execute: Callable[..., Result], before: str, uses: str, in_one_call: bool
) -> None:
    for code in [f"{before}\n{uses}"] if in_one_call else [before, uses]:
        # Under names of its own: what other cases have registered stays in this Blender.
        result = execute(code.replace("my", "our").replace("MY", "OUR") if in_one_call else code)
        assert not was_refused(result), result.text
        assert result.data["error"] is None


def test_a_misspelt_name_beside_a_registered_one_is_still_found(execute: Callable[..., Result]) -> None:
    execute("bpy.types.Scene.my_count = bpy.props.IntProperty()")
    assert was_refused(execute("bpy.context.scene.my_count = 1\nbpy.context.scene.frame_currant = 1"))


@pytest.mark.parametrize(
    "code",
    [
        "def never():\n    bpy.context.scene.nonsense",
        "def often():\n    bpy.context.scene.nonsense\ntry:\n    often()\nexcept Exception:\n    pass",
        "from contextlib import suppress\nwith suppress(AttributeError):\n    bpy.context.scene.nonsense",
        "class Op(bpy.types.Operator):\n    bl_idname = 'my.late'\n    bl_label = 'x'\n"
        "    def execute(self, context):\n        bpy.context.scene.nonsense\n        return {'FINISHED'}\n"
        "bpy.utils.register_class(Op)",
        "exec('bpy.types.Scene.brought = bpy.props.IntProperty()')\nbpy.context.scene.brought",
        "setattr(bpy.types.Scene, 'set_' + 'it', bpy.props.IntProperty())\nbpy.context.scene.set_it",
        "if bpy.app.version < (3, 0, 0):\n    bpy.context.scene.nonsense",
        "if hasattr(bpy.context.scene, 'nonsense'):\n    bpy.context.scene.nonsense",
    ],
)
def test_code_that_runs_is_not_refused(execute: Callable[..., Result], code: str) -> None:
    result = execute(code)
    assert not was_refused(result), result.text
    assert result.data["error"] is None


def test_warnings_stand_in_a_line_each_at_most_three(execute: Callable[..., Result]) -> None:
    code = "".join(f"def never_{n}():\n    bpy.context.scene.nonsense_{n}\n" for n in range(5))
    result = execute(code)
    warnings = [line for line in result.text.splitlines() if line.startswith("Warning, line ")]
    assert len(warnings) == 3
    assert "nothing was printed or changed" in result.text
    assert len(result.data["preflight"]) == 5


def test_unreadable_code_is_left_to_blenders_own_python(execute: Callable[..., Result]) -> None:
    for code in ("import bpy\nprint 'x'", "import bpy\0", "bpy" + ".a" * 49_000):
        assert execute(code).data["error"]["type"] in {
            "SyntaxError",
            "RecursionError",
            "MemoryError",
            "ValueError",
        }


def test_without_an_answer_code_runs_and_the_reason_is_said_once(session: LiveSession) -> None:
    def check(code: str) -> dict[str, Any]:
        del code
        raise NotChecked("There is no knowledge base here.")

    context = ToolContext(session.blender, session.context.docs, check)
    first, second = (
        perform(TOOL, context, parse(TOOL, {"code": "bpy.context.scene.name"}), Call()) for _ in range(2)
    )
    assert "There is no knowledge base here." in first.text
    assert "There is no knowledge base here." not in second.text
    assert first.data["value"] == second.data["value"] == "'Scene'"


def shipped_code() -> Iterator[tuple[str, str]]:
    """What runs in a live Blender as it is shipped: the transcripts' calls, and what builds scenes."""
    transcripts = REPO / "agents" / "transcripts"
    for folder in sorted(path for path in transcripts.iterdir() if path.is_dir()):
        for turn in read_folder(folder):
            for use in turn.turn.content:
                if isinstance(use, ToolUse) and use.name == "blender_execute":
                    yield f"{folder.name}/{turn.name}", use.input["code"]
    for scripts in (transcripts, REPO / "bench" / "references" / "inside"):
        for path in sorted(scripts.rglob("*.py")):
            yield path.name, path.read_text("utf-8")


def test_no_shipped_code_would_be_refused(check: Check) -> None:
    codes = list(shipped_code())
    assert len(codes) > 40
    errors = {
        name: finding["message"]
        for name, code in codes
        for finding in check(code)["findings"]
        if finding["severity"] == "error"
    }
    assert errors == {}


def test_the_live_blender_tells_what_it_has(session: LiveSession) -> None:
    asked = {
        "bpy.types.Object.location": True,
        "bpy.types.Object.nonsense": False,
        "bpy.types.ID.vertices": True,  # a mesh has them
        "bpy.types.Object.display_type:WIRE": True,
        "bpy.types.Object.display_type:NONSENSE": False,
        "bpy.types.Object.to_mesh(depsgraph)": True,
        "bpy.types.Object.to_mesh(nonsense)": False,
        "bpy.types.Nonsense": False,
        "bpy.types.Context.scene": True,
        "bpy.ops.mesh": True,
        "bpy.ops.nonsense": False,
        "bpy.ops.mesh.primitive_cube_add": True,
        "bpy.ops.mesh.primitive_cube_add(size)": True,
        "bpy.ops.mesh.primitive_cube_add(radius)": False,
        "bpy.ops.object.modifier_add(type):CLOTH": True,
        "bpy.ops.object.modifier_add(type):NONSENSE": False,
        "mathutils.Vector": True,
        "mathutils.nonsense": False,
        "bpy.utils.register_class": True,
        "bpy_extras.io_utils": True,
        "": False,
        "bpy.types.": False,
        "bpy.ops.": False,
        "os.path": True,
        "(": False,
        ":": False,
    }
    reply = session.blender.call("present", {"paths": list(asked)}, unread, timeout=60)
    assert dict(zip(asked, reply.value, strict=True)) == asked


@pytest.mark.parametrize("value", [None, {}, [], [True], [True, 1], [True, None], "ab", [True, True, True]])
def test_the_worker_may_answer_only_what_was_asked(value: Any) -> None:
    with pytest.raises(Malformed):
        parse_value(lambda claim: _answers(2, claim), value)
