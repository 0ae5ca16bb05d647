"""Tools that an open Blender shares with a run's own: the same calls are answered in the same way."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from attached_client import server, text, use
from mcp import Client
from mcp_types import ImageContent
from open_window import OpenWindow, blender_with_a_window, opened
from serving import over_stdio

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Iterator

pytestmark = [pytest.mark.window, pytest.mark.anyio]

SCENE = """\
# a ball on a floor
for obj in list(bpy.data.objects):
    bpy.data.objects.remove(obj)
for collection in list(bpy.data.collections):
    bpy.data.collections.remove(collection)
def put(name, make, **options):
    make(**options)
    bpy.context.object.name = name
    bpy.context.object.data.materials.append(bpy.data.materials.new(name))
put("Floor", bpy.ops.mesh.primitive_cube_add, size=4, location=(0, 0, -2))
put("Ball", bpy.ops.mesh.primitive_uv_sphere_add, radius=0.5, location=(0, 0, 2))
ball = bpy.context.object
ball.keyframe_insert("location", frame=1)
ball.location.z = 0.5
ball.keyframe_insert("location", frame=12)
bpy.context.scene.frame_end = 12
bpy.context.scene.name = "Scene"
"""
CALLS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("blender_scene_state", {"sections": ["objects", "animation"]}),
    ("blender_group", {"groups": [{"object": "ball", "system": "things", "members": ["Ball"]}]}),
    ("blender_tag_object", {"collections": [{"name": "things", "role": "system"}]}),
    ("blender_single_mesh_preview", {"object": "Ball"}),
    ("blender_object_preview", {"object": "ball"}),
    ("blender_system_layout_preview", {"system": "things"}),
    ("blender_scene_layout_preview", {"frame": 6}),
    ("blender_uv_preview", {"objects": ["Ball"]}),
    (
        "blender_motion_sheet_preview",
        {"actors": ["Ball"], "phases": [{"name": "fall", "start": 1, "end": 12}]},
    ),
    ("blender_verify", {"rules": ["V"]}),
    ("blender_save", {"name": "copy"}),
)


@pytest.fixture(scope="module")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="module")
def window(tmp_path_factory: pytest.TempPathFactory) -> Iterator[OpenWindow]:
    yield from opened(tmp_path_factory.mktemp("window"))


@pytest.fixture(scope="module")
async def both(
    window: OpenWindow, tmp_path_factory: pytest.TempPathFactory
) -> AsyncIterator[tuple[Client, Client]]:
    """A client of a run's own Blender, and one of the open Blender of the same version, with the same scene."""
    own = over_stdio(
        tmp_path_factory.mktemp("own"), "--tools", "all", "--blender-exe", str(blender_with_a_window())
    )
    attached = server(window)
    attached = attached.model_copy(update={"args": [*attached.args, "--tools", "all"]})
    async with (
        Client(own, read_timeout_seconds=300) as first,
        Client(attached, read_timeout_seconds=300) as second,
    ):
        for client in (first, second):
            made = await use(client, "blender_execute", code=SCENE)
            assert not made.is_error, text(made)
        yield first, second


# They draw as the previews of a mesh and of a scene do.
FURTHER = {"blender_object_preview", "blender_system_layout_preview"}


@pytest.mark.parametrize(
    ("tool", "arguments"),
    [
        pytest.param(*call, id=call[0][8:], marks=pytest.mark.whole if call[0] in FURTHER else ())
        for call in CALLS
    ],
)
async def test_is_answered_as_by_a_blender_of_its_own(
    both: tuple[Client, Client], tool: str, arguments: dict[str, Any]
) -> None:
    own, attached = [await use(client, tool, **arguments) for client in both]
    assert attached.is_error == own.is_error, text(attached)
    data = [
        {name for name in answer.structured_content or {} if name not in {"note", "checkpoint"}}
        for answer in (own, attached)
    ]
    assert data[0] == data[1]
    pictures = [
        [block.mime_type for block in answer.content if isinstance(block, ImageContent)]
        for answer in (own, attached)
    ]
    assert pictures[0] == pictures[1]
    for name in ("objects", "animation", "collections", "findings", "ok"):
        assert (attached.structured_content or {}).get(name) == (own.structured_content or {}).get(name)
