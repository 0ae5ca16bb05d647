"""``blender_check``, through a real client of the server, in this process and over stdio."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import pytest
from mcp import Client, StdioServerParameters
from running import COMMAND, REPO, environment

from kb_check.tool import CheckFinding, CheckReply, tool
from kb_serve.answer.budget import tokens
from kb_serve.server import make_server

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from mcp_types import CallToolResult

    from kb_serve.service import Service

pytestmark = pytest.mark.anyio

WRONG = """\
import bpy
ob = bpy.data.objects["Cube"]
ob.draw_type = "WIRE"
bpy.ops.mesh.primitive_cube_add(sizee=2)
bpy.context.scene.render.engine = "CYCLE"
"""


async def check(service: Service, code: str, **more: Any) -> CallToolResult:
    async with Client(make_server(service)) as client:
        return await client.call_tool("blender_check", {"code": code, **more})


def said(result: CallToolResult) -> str:
    assert len(result.content) == 1
    assert result.content[0].type == "text"
    return result.content[0].text


def found(result: CallToolResult) -> CheckReply:
    assert not result.is_error, said(result)
    reply = CheckReply.model_validate(result.structured_content)
    assert reply.text == said(result)
    return reply


def by_line(reply: CheckReply) -> dict[int, CheckFinding]:
    return {finding.line: finding for finding in reply.findings}


async def test_it_is_listed_as_a_tool_that_only_reads_with_a_short_description(service: Service) -> None:
    async with Client(make_server(service)) as client:
        listed = {entry.name: entry for entry in (await client.list_tools()).tools}
    entry = listed["blender_check"]
    assert entry.annotations is not None
    assert entry.annotations.read_only_hint
    assert tokens((entry.description or "") + str(entry.input_schema)) < 350
    assert set(tool().input_schema["properties"]) == {"code", "blender", "max_tokens"}


async def test_findings_have_a_line_the_right_name_and_the_mended_line(service: Service, base: Path) -> None:
    reply = found(await check(service, WRONG))
    lines = by_line(reply)
    assert set(lines) == {3, 4, 5}
    assert lines[3].instead == ["bpy.types.Object.display_type"]
    assert (lines[3].fix, lines[3].sure) == ('ob.display_type = "WIRE"', True)
    assert lines[3].absent == ["bpy.types.Object.draw_type"]
    assert (lines[4].fix, lines[4].sure) == ("bpy.ops.mesh.primitive_cube_add(size=2)", False)
    assert reply.blender.startswith(base.stem.rpartition("-")[2])
    assert "line 3: error" in reply.text
    assert 'fix: `ob.display_type = "WIRE"`' in reply.text


@pytest.mark.parametrize(
    ("line", "right", "findings"),
    [
        (
            "bpy.ops.export_mesh.stl(filepath='a', use_selection=True)",
            "bpy.ops.wm.stl_export(filepath='a', export_selected_objects=True)",
            1,
        ),
        (
            "bpy.ops.export_scene.obj(\n    filepath='a',\n    use_selection=True,\n)",
            "bpy.ops.wm.obj_export(\n    filepath='a',\n    export_selected_objects=True,\n)",
            2,
        ),
        (
            "ob.draw_type = 'WIRE'; ob.show_x_ray = True",
            "ob.display_type = 'WIRE'; ob.show_in_front = True",
            2,
        ),
    ],
)
async def test_a_fix_mends_the_whole_statement(
    service: Service, line: str, right: str, findings: int
) -> None:
    code = f"import bpy\nob = bpy.context.object\n{line}\n"
    reply = found(await check(service, code))
    assert [finding.fix for finding in reply.findings] == [right] * findings
    assert reply.text.count("as above") == findings - 1
    assert found(await check(service, code.replace(line, right))).findings == []


async def test_a_likely_correction_goes_with_the_sure_fixes_of_its_statement(service: Service) -> None:
    line = "bpy.context.object.draw_type = bpy.context.object.locatoin"
    reply = found(await check(service, f"import bpy\n{line}"))
    shown = {finding.sure: finding.fix for finding in reply.findings}
    assert shown[True] == "bpy.context.object.display_type = bpy.context.object.locatoin"
    assert shown[False] == "bpy.context.object.display_type = bpy.context.object.location"


async def test_right_code_is_answered_by_one_line_with_what_was_checked(service: Service) -> None:
    reply = found(await check(service, "import bpy\nbpy.context.scene.frame_set(1)\n"))
    assert reply.findings == []
    assert "\n" not in reply.text
    assert "2 lines checked for Blender" in reply.text


async def test_code_that_does_not_import_bpy_is_checked_too(service: Service) -> None:
    assert set(by_line(found(await check(service, "bpy.context.scene.nonsense")))) == {1}


async def test_the_answer_keeps_to_its_budget_and_counts_the_rest(service: Service) -> None:
    code = "\n".join(f"bpy.context.scene.nonsense_{number}" for number in range(300))
    result = await check(service, code, max_tokens=200)
    reply = found(result)
    assert tokens(said(result)) <= 200
    assert (reply.count, len(reply.findings)) == (300, 100)
    assert " more: " in reply.text.splitlines()[-1]


async def test_equal_findings_are_told_once_with_all_lines(service: Service) -> None:
    reply = found(await check(service, "ob = bpy.data.objects[0]\n" + "ob.draw_type = 'WIRE'\n" * 3))
    assert reply.text.count("display_type`.") == 1
    assert "lines 2, 3, 4: error" in reply.text


async def test_what_is_not_reached_by_a_run_is_marked(service: Service) -> None:
    code = "def never():\n    bpy.context.scene.nonsense\ndef often():\n    bpy.context.scene.nonsense\noften()\n"
    lines = by_line(found(await check(service, code)))
    assert {line: finding.reached for line, finding in lines.items()} == {2: False, 4: True}


async def test_code_that_enables_an_addon_may_use_names_that_nobody_knows(service: Service) -> None:
    wrong = "bpy.ops.nobody.knows()\n"
    assert found(await check(service, wrong)).complete
    assert not found(await check(service, f"import addon_utils\n{wrong}")).complete


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        ({}, "code: Field required"),
        ({"code": None}, "code:"),
        ({"code": ["a"]}, "code:"),
        ({"code": "1", "max_tokens": 1}, "max_tokens:"),
        ({"code": "1", "blender": "9.9"}, "simworlds kb build 9.9"),
        ({"code": "1", "blender": "../../etc/passwd"}, "not a Blender version"),
        ({"code": "1", "query": "x"}, "query:"),
        ({"code": "x" * 100_001}, "100,000"),
        ({"code": "#" * 10_000_000}, "100,000"),
    ],
    ids=str,
)
async def test_errors_say_why_a_call_failed(service: Service, arguments: dict[str, Any], hint: str) -> None:
    async with Client(make_server(service)) as client:
        result = await client.call_tool("blender_check", arguments)
    assert result.is_error
    assert hint in said(result)
    assert len(said(result)) < 1000


@pytest.mark.parametrize(
    ("code", "hint"),
    [
        ("", "Nothing found"),
        ("print 'x'", "Python 2"),
        ("def f(:", "Python cannot read this"),
        ("import bpy\0", "null bytes"),
        ("x = '\ud800'", "Nothing found"),
        ("\ufeffimport bpy\nbpy.context.scene.nonsense", "nonsense"),
        ("bpy.context.scene.nonsense\rbpy.context.scene.nonsense", "lines 1, 2"),
        ("(" * 100_000, "too many nested"),
        ("-" * 99_999 + "1", "cannot be parsed"),
        ("bpy" + ".a" * 49_000, "cannot be parsed"),
        ("\n" * 99_990 + "(", "never closed"),
        (" " * 99_990 + "print", "unexpected indent"),
        ("bpy.ops.a.b()\n" * 2_000, "error"),
        ("🙂 = bpy", "Python cannot read this"),
        ("é = bpy.context.scene; é.frame_currant", "é.frame_current"),
    ],
    ids=lambda text: ascii(text)[:30],
)
async def test_any_text_is_answered(service: Service, code: str, hint: str) -> None:
    result = await check(service, code)
    assert hint in found(result).text
    assert tokens(said(result)) <= 1500


async def test_a_damaged_base_says_what_to_do(
    home: Path, base: Path, serve_from: Callable[[Path], Service]
) -> None:
    target = home / "kb" / base.name
    target.unlink()
    with base.open("rb") as whole:
        target.write_bytes(whole.read(200_000))
    result = await check(serve_from(home), WRONG)
    assert result.is_error
    assert "simworlds kb build" in said(result)


async def test_a_client_gets_findings_from_the_process_it_starts(home: Path) -> None:
    words = [*COMMAND, "serve"]
    started = StdioServerParameters(command=words[0], args=words[1:], env=environment(home), cwd=REPO)
    async with Client(started) as client:
        assert {entry.name for entry in (await client.list_tools()).tools} == {
            "blender_docs",
            "blender_check",
        }
        assert set(by_line(found(await client.call_tool("blender_check", {"code": WRONG})))) == {3, 4, 5}
        result = await client.call_tool("blender_check", {"code": "#" * 10_000_000})
    assert result.is_error


# Code that would take long, or the parser's stack, if its checks grew faster than it does.
NASTY = {
    "parentheses": "x=" + "(" * 5000 + "1" + ")" * 5000,
    "operators": "x=" + "-" * 40_000 + "1",
    "attributes": "import bpy\nx=bpy" + ".data" * 18_000,
    "calls": "import bpy\nx=bpy.data.objects" + ".get('a')" * 10_000,
    "functions that call two others": "import bpy\n"
    + "\n".join(f"def f{n}(a):\n  return f{n + 1}(a) or f{n + 2}(a)" for n in range(1500))
    + "\nf0(bpy.context)",
    "loops in loops": "import bpy\nx=1\n"
    + "\n".join(" " * n + "while x:" for n in range(18))
    + "\n"
    + " " * 18
    + "x=bpy.data",
    "a pair of itself": "x=1\n" + "x=(x,x)\n" * 1000,
    "a list of itself": "x=[]\n" + "x=[x,x]\n" * 1000,
    "a text that doubles": "x='ab'\n" + "x=x+x\n" * 1000,
    "names that it lacks": "import bpy\no=bpy.context.object\n" + "\n".join(f"o.zz{n}=1" for n in range(700)),
}
SECONDS_OF_CPU = 20.0


@pytest.mark.parametrize("code", NASTY.values(), ids=NASTY)
async def test_no_code_takes_long_or_fails(service: Service, code: str) -> None:
    began = time.process_time()
    found(await check(service, code))
    assert time.process_time() - began < SECONDS_OF_CPU
