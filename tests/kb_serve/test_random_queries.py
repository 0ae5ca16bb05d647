"""Random hostile queries, versions and addresses: each is answered or refused in words, with little work."""

from __future__ import annotations

import contextlib
import logging
import time
from typing import TYPE_CHECKING

import anyio
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from mcp import Client
from mcp.shared.exceptions import MCPError

from kb_serve.errors import BadQuery
from kb_serve.knowledge_base import KnowledgeBase
from kb_serve.server import make_server

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kb_serve.service import Service

LONGEST = 20_000
MOST_SECONDS = (
    2.0  # of CPU; the worst takes a fifth on a slow machine, and took minutes when nothing was bounded
)

# Names that many symbols share, what code is made of, and how messages begin.
NAMES = "a AB x1 name data parent node inputs Color type location Object Mesh cloth ClothSettings wrong_name WrongName"
CODE = (
    *".:_/'\"()[]{},=0é🎨\n\0 ", "->", "::", "[0]", '["Cloth"]', '.inputs["Color"]', ".node", "()", "print(", "9.",
    "bpy.data.", "OBJECT_OT_x", "EMITTER ",
)  # fmt: skip
MESSAGES = (
    "Error: ", 'File "', "expected c, not d", "not found in (", 'enum "A" not found in (', 'keyword "abc" is invalid ',
    "'NoneType' object has no attribute 'name' ", "'Mesh' object has no attribute 'nam' ",
    'bpy_prop_collection[key]: key "Foo" not found ', "StructRNA of type Object has been removed ",
    'attribute "name" from "Object" is read-only ', "Operator bpy.ops.object.join.poll() ",
    "https://docs.blender.org/api/current/bpy.types.Object.html#", "https://docs.blender.org/manual/en/5.1/",
)  # fmt: skip
LONG_QUERIES = ["a." * 9_999, "1." * 9_999, "A_OT_" * 4_000, "x" + ".node_tree.nodes[0]" * 1_000]

pieces = st.sampled_from([*NAMES.split(), *CODE, *MESSAGES])
random_text = st.text(max_size=40) | st.lists(pieces, min_size=1, max_size=12).map("".join)


@st.composite
def hostile_text(draw: st.DrawFn) -> str:
    """Text of which a part is repeated, up to the longest query."""
    head, part, tail = (draw(random_text) for _ in range(3))
    return (head + part * draw(st.sampled_from([1, 2, 17, 300, LONGEST])) + tail)[:LONGEST]


random_settings = settings(
    max_examples=150, deadline=None, derandomize=True, database=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)  # fmt: skip


@pytest.fixture(scope="module")
def warm(base: Path) -> Iterator[KnowledgeBase]:
    """A base that has loaded what searches and corrections need."""
    with KnowledgeBase(base) as kb:
        kb.query("Cloht.qualty settings of somthing_wrong")
        yield kb


def ask(kb: KnowledgeBase, query: str) -> float:
    """The CPU seconds that a query takes, however it ends."""
    began = time.thread_time()
    with contextlib.suppress(BadQuery):
        assert kb.query(query).text
    return time.thread_time() - began


@pytest.mark.parametrize("query", LONG_QUERIES, ids=lambda query: ascii(query[:20]))
def test_long_queries_take_little_work(warm: KnowledgeBase, query: str) -> None:
    assert ask(warm, query) < MOST_SECONDS


@random_settings
@given(query=hostile_text())
def test_random_queries_take_little_work(warm: KnowledgeBase, query: str) -> None:
    assert ask(warm, query) < MOST_SECONDS


def test_a_query_that_takes_too_much_work_is_refused(base: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kb_serve.knowledge_base._MOST_WORK", 100)
    with KnowledgeBase(base) as kb:
        with pytest.raises(BadQuery, match="too much work"):
            kb.query("obj.modifiers.parent.name")
        assert kb.query("bpy.types.ClothSettings.quality").hits
        assert kb.symbol("bpy.types.ClothSettings") is not None


# The server


def refusals(service: Service, calls: list[tuple[str, str]], uris: list[str]) -> list[str]:
    """What a server says to tool calls (query, version) and addresses that it refuses."""
    said: list[str] = []

    async def send() -> None:
        async with Client(make_server(service)) as client:
            for query, version in calls:
                result = await client.call_tool("blender_docs", {"query": query, "blender": version})
                if result.is_error:
                    assert result.content[0].type == "text"
                    said.append(result.content[0].text)
            for uri in uris:
                try:
                    await client.read_resource(uri)
                except MCPError as error:
                    said.append(error.message)

    anyio.run(send)
    return said


versions = hostile_text() | st.sampled_from(
    ["999.999", "5." + "9" * 5_000, "9" * 5_000, "٥.٣", "²", "5.1\0", "-1.0"]
)


@st.composite
def addresses(draw: st.DrawFn) -> str:
    """Addresses of resources, as far as their beginning goes."""
    kind = draw(st.sampled_from(["/symbol/", "/page/", "/", "", "/symbol/%"]))
    return f"blender://{draw(versions)}{kind}{draw(hostile_text())}"


@random_settings
@given(
    calls=st.lists(st.tuples(random_text, versions), max_size=4),
    uris=st.lists(addresses() | hostile_text(), max_size=6),
)
@example(calls=[("cloth", "999.999"), ("cloth", "5." + "9" * 5_000)], uris=["blender://999.999/page/x"])
def test_hostile_calls_are_refused_in_words(
    service: Service, caplog: pytest.LogCaptureFixture, calls: list[tuple[str, str]], uris: list[str]
) -> None:
    for text in refusals(service, calls, uris):
        assert any(
            words in text for words in ("Built are: ", "no such resource", "is empty", "too much work")
        ), text
        assert len(text) < 500
    assert not [record for record in caplog.records if record.levelno >= logging.ERROR]
