"""Resources: records of symbols, pages, and which bases there are."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING
from urllib.parse import quote

import pytest
from mcp import Client
from mcp.shared.exceptions import MCPError
from mcp_types import TextResourceContents

from kb_build.symbols.records import symbol_from_json
from kb_serve.server import make_server

if TYPE_CHECKING:
    from kb_serve.service import Service

pytestmark = pytest.mark.anyio

SOCKET = 'bpy.types.ShaderNodeBsdfPrincipled.inputs["Specular IOR Level"]'


async def read(service: Service, uri: str) -> TextResourceContents:
    async with Client(make_server(service)) as client:
        contents = (await client.read_resource(uri)).contents
    assert len(contents) == 1
    assert isinstance(contents[0], TextResourceContents)
    return contents[0]


@pytest.mark.parametrize(
    ("uri", "path"),
    [
        ("blender://5.1/symbol/bpy.types.ClothSettings.quality", "bpy.types.ClothSettings.quality"),
        ("blender://5.1/symbol/bpy.ops.object.modifier_add", "bpy.ops.object.modifier_add"),
        (f"blender://5.1/symbol/{quote(SOCKET, safe='')}", SOCKET),
        (f"blender://5.1/symbol/{SOCKET}", SOCKET),
    ],
)
async def test_a_symbol_is_its_whole_record(service: Service, uri: str, path: str) -> None:
    found = await read(service, uri)
    assert found.mime_type == "application/json"
    assert symbol_from_json(json.loads(found.text)) == service.bases.pick("5.1").symbol(path)
    assert json.loads(found.text)["path"] == path


async def test_a_page_is_markdown_and_its_slug_may_have_slashes(service: Service) -> None:
    found = await read(service, "blender://5.1/page/physics/cloth/introduction")
    assert found.mime_type == "text/markdown"
    page = service.bases.pick("5.1").page("physics/cloth/introduction")
    assert page is not None
    assert found.text == page.text
    assert found.text.startswith("# ")


async def test_the_exact_version_names_its_base_too(service: Service) -> None:
    version = service.bases.pick().meta["blender"]
    found = await read(service, f"blender://{version}/symbol/bpy.types.Object")
    assert json.loads(found.text)["kind"] == "class"


async def test_every_hit_of_an_answer_can_be_read(service: Service) -> None:
    base = service.bases.pick()
    hits = base.query("cloth").hits
    assert {"manual", "class"} <= {hit.kind for hit in hits}
    for hit in hits:
        part = "page" if hit.kind in {"manual", "guide", "template"} else "symbol"
        assert (await read(service, f"blender://5.1/{part}/{quote(hit.id)}")).text


async def test_the_bases_are_listed(service: Service) -> None:
    async with Client(make_server(service)) as client:
        listed = (await client.list_resources()).resources
        templates = (await client.list_resource_templates()).resource_templates
    assert [str(one.uri) for one in listed] == ["blender://bases", "blender://tools"]
    assert {one.uri_template for one in templates} == {
        "blender://{version}/symbol/{+path}",
        "blender://{version}/page/{+slug}",
    }
    bases = json.loads((await read(service, "blender://bases")).text)
    assert [one["version"] for one in bases] == ["5.1"]
    assert bases[0]["blender"].startswith("5.1.")


@pytest.mark.parametrize(
    "uri",
    [
        "file:///etc/passwd",
        "blender://5.1/page/../../etc/passwd",
        "blender://5.1/page/%2e%2e/%2e%2e/etc/passwd",
        "blender://5.1/page//etc/passwd",
        "blender://5.1/symbol/file:///etc/passwd",
        "blender://5.1/symbol/bpy.types.NoSuchThing",
        "blender://5.1/symbol/%00",
        "blender://5.1/symbol/%ff%fe",
        "blender://5.1/symbol/%ed%a0%80",
        "blender://5.1/symbol/",
        "blender://5.1/page/' OR '1'='1",
        "blender://5.1",
        "blender://",
        "",
        "x" * 10_000,
        "blender://5.1/page/" + "a/" * 5_000,
    ],
)
async def test_unknown_resources_are_a_clear_error(service: Service, uri: str) -> None:
    async with Client(make_server(service)) as client:
        with pytest.raises(MCPError) as caught:
            await client.read_resource(uri)
    assert "no such resource" in caught.value.message
    assert len(caught.value.message) < 500


@pytest.mark.parametrize("version", ["9.9", "latest", "..", "%2e%2e%2f"])
async def test_a_version_that_was_not_built_is_a_clear_error(service: Service, version: str) -> None:
    async with Client(make_server(service)) as client:
        with pytest.raises(MCPError, match=r"Built are: 5\.1"):
            await client.read_resource(f"blender://{version}/symbol/bpy.types.Object")
