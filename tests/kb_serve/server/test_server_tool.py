"""The tool, through a real client of both protocol generations, connected in this process."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, fields
from pathlib import Path
from threading import Event, get_ident
from typing import TYPE_CHECKING, Any

import anyio
import anyio.to_thread
import pytest
from mcp import Client
from mcp.shared.exceptions import MCPError

from kb_serve.answer.budget import tokens
from kb_serve.answer.docs_answer import DocsAnswer
from kb_serve.answer.hits import Hit
from kb_serve.knowledge_base import KnowledgeBase
from kb_serve.server import make_server
from kb_serve.service import Service
from kb_serve.tool import DESCRIPTION, tool

if TYPE_CHECKING:
    from mcp_types import CallToolResult

ServeFrom = Callable[[Path], Service]

pytestmark = pytest.mark.anyio

QUALITY = "bpy.types.ClothSettings.quality"


async def ask(service: Service, mode: Any = "auto", **arguments: Any) -> CallToolResult:
    async with Client(make_server(service), mode=mode) as client:
        return await client.call_tool("blender_docs", arguments)


def said(result: CallToolResult) -> str:
    assert len(result.content) == 1
    assert result.content[0].type == "text"
    return result.content[0].text


async def test_the_whole_schema_has_the_hints_that_clients_are_sent(service: Service) -> None:
    async with Client(make_server(service)) as client:
        listed = (await client.list_tools()).tools
    assert [one.name for one in listed] == ["blender_docs", "blender_check"]
    hints = tool().annotations
    assert hints is not None
    assert listed[0].annotations is not None
    assert listed[0].annotations.read_only_hint
    assert hints.model_copy(update={"title": None}) == listed[0].annotations


async def test_all_that_a_client_is_sent_is_within_three_kilobytes(service: Service) -> None:
    async with Client(make_server(service)) as client:
        listed = await client.list_tools()
        sent = listed.model_dump_json(by_alias=True, exclude_none=True) + (client.instructions or "")
    assert len(sent.encode()) <= 3_000


async def test_the_description_fits_into_what_clients_show_and_teaches_every_way_to_ask() -> None:
    assert len(DESCRIPTION) < 2048
    for way in (
        "ClothSettings.quality",
        'modifiers["Cloth"]',
        "AttributeError",
        "part=2",
        "topic",
        'blender="',
    ):
        assert way in DESCRIPTION


async def test_the_arguments_and_their_defaults_are_those_of_the_interface() -> None:
    schema = tool().input_schema
    defaults = {name: field.get("default", "required") for name, field in schema["properties"].items()}
    assert defaults == {"query": "required", "blender": None, "limit": 8, "max_tokens": 1500, "part": 1}
    assert schema["required"] == ["query"]


async def test_the_output_schema_is_the_answer_and_the_version_it_holds_for() -> None:
    schema = tool().output_schema
    assert schema is not None
    assert set(schema["properties"]) == {field.name for field in fields(DocsAnswer)} | {"blender"}
    assert set(schema["properties"]["hits"]["items"]["properties"]) == {field.name for field in fields(Hit)}
    assert set(schema["required"]) == set(schema["properties"])


@pytest.mark.parametrize("mode", ["auto", "legacy"])
async def test_an_answer_is_markdown_with_the_same_as_structure_beside_it(
    service: Service, base: Path, mode: str
) -> None:
    result = await ask(service, mode, query="ClothSettings.quality")
    with KnowledgeBase(base) as direct:
        expected = json.loads(json.dumps(asdict(direct.query("ClothSettings.quality"))))
        version = direct.meta["blender"]
    assert not result.is_error
    assert result.structured_content == {**expected, "blender": version}
    assert said(result) == expected["text"]
    assert expected["hits"][0]["id"] == QUALITY


async def test_a_long_answer_comes_in_parts_within_the_budget(service: Service) -> None:
    first = await ask(service, query="bpy.types.Object", max_tokens=300)
    assert first.structured_content is not None
    parts = first.structured_content["parts"]
    assert parts > 1
    second = await ask(service, query="bpy.types.Object", max_tokens=300, part=2)
    assert said(first) != said(second)
    assert max(tokens(said(first)), tokens(said(second))) <= 300


async def test_limit_bounds_the_hits(service: Service) -> None:
    result = await ask(service, query="quality", limit=3)
    assert result.structured_content is not None
    assert len(result.structured_content["hits"]) == 3


async def test_a_version_may_be_given_as_a_number_since_models_do(service: Service) -> None:
    result = await ask(service, query=QUALITY, blender=5.1)
    assert not result.is_error


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        ({"query": ""}, "empty"),
        ({"query": " \n\t"}, "empty"),
        ({"query": "\0\0"}, "empty"),
        ({}, "query: Field required"),
        ({"query": None}, "query:"),
        ({"query": ["a"]}, "query:"),
        ({"query": {"a": 1}}, "query:"),
        ({"query": QUALITY, "limit": 0}, "limit:"),
        ({"query": QUALITY, "limit": -1}, "limit:"),
        ({"query": QUALITY, "limit": "many"}, "limit:"),
        ({"query": QUALITY, "limit": 1.5}, "limit:"),
        ({"query": QUALITY, "limit": None}, "limit:"),
        ({"query": QUALITY, "max_tokens": 1}, "max_tokens:"),
        ({"query": QUALITY, "part": 0}, "part:"),
        ({"query": QUALITY, "part": 10**30}, "part="),
        ({"query": QUALITY, "blender": "9.9"}, "simworlds kb build 9.9"),
        ({"query": QUALITY, "blender": "latest"}, "5.1"),
        ({"query": QUALITY, "blender": "../../etc/passwd"}, "not a Blender version"),
        ({"query": QUALITY, "blender": ["5.1"]}, "blender:"),
        ({"query": QUALITY, "version": "4.5"}, "version:"),
        ({"query": "x" * 20_001}, "20,000"),
    ],
)
async def test_errors_say_why_a_call_failed(service: Service, arguments: dict[str, Any], hint: str) -> None:
    result = await ask(service, **arguments)
    assert result.is_error
    assert hint in said(result)
    assert "Traceback" not in said(result)
    assert len(said(result)) < 1000


@pytest.mark.parametrize(
    "query",
    [
        "x" * 10_000,
        "cloth " * 1_500,
        " ".join(f"word{number}" for number in range(1_000)),
        "(" * 5_000,
        "a." * 5_000,
        'a["' * 3_000,
        "cloth\0collision",
        "🙂🔥 cloth 🎬",
        "\u202e\u200b\ufeff",
        '"',
        '"cloth',
        "cloth*",
        "NEAR(cloth collision, 2)",
        "name: cloth",
        "cloth AND NOT OR",
        "^cloth - + {a b}",
        "'; DROP TABLE symbols; --",
        "%_%",
        "../../etc/passwd",
        "file:///etc/passwd",
        "C:\\Windows\\System32",
        "bpy.types.",
        "bpy..types...Object",
        "[[[[",
        "\\",
        "{0.__class__}",
        "\ud800 cloth",
    ],
    ids=ascii,
)
async def test_any_text_is_answered(service: Service, query: str) -> None:
    result = await ask(service, query=query, max_tokens=400)
    assert not result.is_error
    assert result.structured_content is not None
    assert result.structured_content["kind"] in {"schema", "page", "candidates", "none"}
    assert tokens(said(result)) <= 400


async def test_huge_limits_are_no_trouble(service: Service) -> None:
    result = await ask(service, query="quality", limit=10**30, max_tokens=10**30)
    assert result.structured_content is not None
    assert result.structured_content["next_part"] == 0
    assert 8 < len(result.structured_content["hits"]) <= 50


@pytest.mark.parametrize("arguments", [{"query": f"{QUALITY} " * 10}, {"query": QUALITY, "blender": "5.1"}])
async def test_others_are_served_while_a_call_that_may_take_long_is_answered(
    service: Service, monkeypatch: pytest.MonkeyPatch, arguments: dict[str, Any]
) -> None:
    begun, others_served = Event(), Event()
    ask_base = Service.ask

    def ask_slowly(self: Service, *arguments: Any, **more: Any) -> tuple[DocsAnswer, str]:
        begun.set()
        assert others_served.wait(60)
        return ask_base(self, *arguments, **more)

    monkeypatch.setattr(Service, "ask", ask_slowly)
    async with Client(make_server(service)) as client, anyio.create_task_group() as calls:
        calls.start_soon(client.call_tool, "blender_docs", arguments)
        await anyio.to_thread.run_sync(begun.wait)
        assert (await client.list_tools()).tools
        others_served.set()


async def test_a_short_query_is_answered_without_a_thread(
    service: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    ask_base, threads = Service.ask, list[int]()

    def ask_and_note(self: Service, *arguments: Any, **more: Any) -> tuple[DocsAnswer, str]:
        threads.append(get_ident())
        return ask_base(self, *arguments, **more)

    monkeypatch.setattr(Service, "ask", ask_and_note)
    await ask(service, query=QUALITY)
    await ask(service, query=f"{QUALITY} " * 10)
    assert [thread == get_ident() for thread in threads] == [True, False]


async def test_another_tool_is_refused_by_name(service: Service) -> None:
    async with Client(make_server(service)) as client:
        with pytest.raises(MCPError, match="Available: blender_docs, blender_check"):
            await client.call_tool("blender_execute", {})


async def test_without_a_base_the_answer_says_how_to_build_one(tmp_path: Path, serve_from: ServeFrom) -> None:
    result = await ask(serve_from(tmp_path), query=QUALITY)
    assert result.is_error
    assert "simworlds kb build" in said(result)


@pytest.mark.parametrize("content", [b"", b"not a base", b"SQLite format 3\0" + b"\0" * 5000])
async def test_error_for_a_file_of_another_kind_says_what_to_do(
    tmp_path: Path, serve_from: ServeFrom, content: bytes
) -> None:
    (tmp_path / "kb").mkdir()
    (tmp_path / "kb" / "blender-5.1.sqlite").write_bytes(content)
    result = await ask(serve_from(tmp_path), query=QUALITY)
    assert result.is_error
    assert "simworlds kb build" in said(result)


async def test_error_for_a_truncated_base_says_what_to_do(
    home: Path, base: Path, serve_from: ServeFrom
) -> None:
    target = home / "kb" / base.name
    target.unlink()
    with base.open("rb") as whole:
        target.write_bytes(whole.read(200_000))
    result = await ask(serve_from(home), query="how to make cloth collide")
    assert result.is_error
    assert "simworlds kb build" in said(result)
