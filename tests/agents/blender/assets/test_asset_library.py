"""``blender_assets``: a library of .blend assets, texture sets and HDRIs is catalogued once, and used."""

from __future__ import annotations

import shutil
from dataclasses import replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import pytest
from live_session import LiveSession
from mcp import Client
from serving import over_stdio

from agents.blender.assets.library import AssetLibrary, _Kept, find_assets
from agents.blender.assets.licence import NOTE_FILE, LicenceNote
from agents.blender.assets.replies import ReadAssets
from agents.blender.tools.assets import TOOL
from agents.blender.tools.base import Call
from simworlds.sandbox.blender_process import BlenderProcess
from simworlds.sandbox.errors import Refusal, TookTooLong

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from built_base import Built

    from agents.blender.tools.base import Result

pytestmark = pytest.mark.blender

# Marked assets of four kinds, an unmarked object, a texture set of six maps and an HDRI, in the workspace.
LIBRARY = """
import os
os.makedirs("library/wood", exist_ok=True)
def picture(path, colour, file_format, is_float=False):
    image = bpy.data.images.new("made", 16, 8, float_buffer=is_float)
    image.pixels = list(colour) * 128
    image.file_format = file_format
    image.save(filepath=os.path.abspath(path))
    bpy.data.images.remove(image)
for kind, colour in (("Color", (0.6, 0.3, 0.1, 1)), ("NormalDX", (0.5, 0.5, 1, 1)), ("Roughness", (0.4,) * 3 + (1,)),
                     ("Metalness", (0, 0, 0, 1)), ("Displacement", (0.5,) * 3 + (1,)), ("AmbientOcclusion", (1,) * 4)):
    picture(f"library/wood/Oak01_1K-PNG_{kind}.png", colour, "PNG")
picture("library/sunset.hdr", (40.0, 20.0, 5.0, 1.0), "HDR", is_float=True)
picture("library/portrait.png", (1, 1, 1, 1), "PNG")

bpy.ops.mesh.primitive_cube_add(size=0.5, location=(0, 0, 0.25))
chair = bpy.context.object
chair.name = "Chair"
bpy.ops.mesh.primitive_cube_add(size=0.1, location=(0, 0, 0.6))
bpy.context.object.name, bpy.context.object.parent = "Back", chair
bpy.ops.mesh.primitive_cube_add(size=1)
bpy.context.object.name = "Unmarked"
kit = bpy.data.collections.new("Kit")
for number in range(2):
    made = bpy.data.objects.new(f"Brick {number}", bpy.data.meshes.new("Brick"))
    kit.objects.link(made)
red = bpy.data.materials.new("Red paint")
evening = bpy.data.worlds.new("Evening")
for block in (chair, kit, red, evening):
    block.asset_mark()
chair.asset_data.description, chair.asset_data.author = "A plain stool", "Ada"
chair.asset_data.license = "CC0"
chair.asset_data.tags.new("furniture")
with bpy.context.temp_override(id=chair):
    bpy.ops.ed.lib_id_load_custom_preview(filepath=os.path.abspath("library/wood/Oak01_1K-PNG_Color.png"))
everything = {chair, kit, red, evening, bpy.data.objects["Unmarked"]}
bpy.data.libraries.write(os.path.abspath("library/things.blend"), everything)
"""


@pytest.fixture
def anyio_backend() -> str:
    """The only one that the server runs on."""
    return "asyncio"


class Shelf:
    """A session with a library, and where that keeps what it has read."""

    def __init__(self, session: LiveSession, root: Path, cache: Path) -> None:
        self.session, self.root, self.cache = session, root, cache
        self.library = self.again()

    def again(self) -> AssetLibrary:
        """The same library as another server would open it."""
        self.library = AssetLibrary(self.root, self.cache)
        self.session.context = replace(self.session.context, assets=self.library)
        return self.library

    def use(self, call: Call | None = None, **arguments: Any) -> Result:
        return self.session.use(TOOL, call, **arguments)


@pytest.fixture(scope="module")
def _shelf(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Shelf]:
    maker = LiveSession(tmp_path_factory.mktemp("maker"))
    maker.run(LIBRARY)
    root = tmp_path_factory.mktemp("assets")
    shutil.copytree(maker.blender.folder.root / "workspace" / "library", root, dirs_exist_ok=True)
    maker.blender.close()
    for path in (root, *root.rglob("*")):
        path.chmod(0o755)
    session = LiveSession(tmp_path_factory.mktemp("run"), read=(root,))
    yield Shelf(session, root, tmp_path_factory.mktemp("cache"))
    session.blender.close()


@pytest.fixture
def shelf(_shelf: Shelf) -> Shelf:
    """A library of assets, and a Blender with an empty scene."""
    _shelf.session.empty()
    return _shelf


def test_what_the_library_has_is_found_with_pictures(shelf: Shelf) -> None:
    answer = shelf.use()
    found = {asset["id"]: asset for asset in answer.data["assets"]}
    assert set(found) == {
        "sunset.hdr",
        "things.blend/collection/Kit",
        "things.blend/material/Red paint",
        "things.blend/object/Chair",
        "things.blend/world/Evening",
        "wood/Oak01/textures",
    }
    chair = found["things.blend/object/Chair"]
    assert (chair["author"], chair["license"], chair["tags"]) == ("Ada", "CC0", ["furniture"])
    assert found["sunset.hdr"]["size"] == [16, 8]
    assert set(found["wood/Oak01/textures"]["maps"]) == {
        "base_color",
        "normal_directx",
        "roughness",
        "metallic",
        "displacement",
        "ambient_occlusion",
    }
    pictured = {
        asset.id for asset in shelf.library.assets(shelf.session.blender) if asset.preview is not None
    }
    assert {"sunset.hdr", "wood/Oak01/textures", "things.blend/object/Chair"} <= pictured
    assert [image.png[:4] for image in answer.pictures] == [b"\x89PNG"]
    assert "CC0 by Ada" in answer.text


def test_searches_take_words_kinds_and_misspelt_ids(shelf: Shelf) -> None:
    assets = shelf.library.assets(shelf.session.blender)
    assert [asset.name for asset in find_assets(assets, "furniture", None)] == ["Chair"]
    assert [asset.name for asset in find_assets(assets, "plain CHAIR", None)] == ["Chair"]
    assert [asset.name for asset in find_assets(assets, "", "hdri")] == ["sunset"]
    assert find_assets(assets, "chair sofa", None) == []
    with pytest.raises(Refusal, match=r"Nearest: .*things.blend/object/Chair"):
        shelf.use(use="things.blend/object/Chiar")


def test_files_are_read_once_however_often_the_library_is_opened(
    shelf: Shelf, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = shelf.again().assets(shelf.session.blender)

    def no_second(*_: Any) -> Any:
        raise AssertionError("a second Blender was started")

    monkeypatch.setattr("agents.blender.assets.library.second_blender", no_second)
    assert shelf.again().assets(shelf.session.blender) == before
    # The same contents elsewhere are known too.
    (shelf.root / "copy").mkdir()
    shutil.copy(shelf.root / "sunset.hdr", shelf.root / "copy" / "dawn.hdr")
    names = {asset.id for asset in shelf.library.assets(shelf.session.blender)}
    shutil.rmtree(shelf.root / "copy")
    assert "copy/dawn.hdr" in names
    assert "copy/dawn.hdr" not in {asset.id for asset in shelf.library.assets(shelf.session.blender)}


def test_long_cataloguing_is_told(shelf: Shelf, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("agents.blender.assets.library._QUIET_SECONDS", 0.0)
    told: list[tuple[float, float | None, str]] = []
    shelf.again()
    shelf.use(Call(lambda done, total, text: told.append((done, total, text))))
    assert told
    assert {total for _, total, _ in told} == {3}
    assert all(text.startswith("cataloguing ") for _, _, text in told)


def test_objects_and_collections_are_appended_at_a_place(shelf: Shelf) -> None:
    shelf.use(use="things.blend/object/Chair", location=[1, 2, 3])
    where = (
        "{o.name: tuple(round(v, 3) for v in o.matrix_world.translation) for o in bpy.context.scene.objects}"
    )
    shelf.session.run("bpy.context.view_layer.update()")
    assert shelf.session.run(where) == {"Chair": (1, 2, 3.25)}
    assert shelf.session.run("[o.library for o in bpy.data.objects]") == [None]
    shelf.use(use="things.blend/collection/Kit")
    assert shelf.session.run("sorted(bpy.context.scene.collection.children.keys())") == ["Kit"]


def test_materials_and_worlds_are_put_to_use(shelf: Shelf) -> None:
    shelf.session.run("bpy.ops.mesh.primitive_cube_add()")
    assert shelf.use(use="things.blend/material/Red paint", objects=["Cube"]).data["assigned"] == ["Cube"]
    assert shelf.session.run("bpy.data.objects['Cube'].active_material.name") == "Red paint"
    shelf.use(use="things.blend/world/Evening")
    assert shelf.session.run("bpy.context.scene.world.name") == "Evening"
    with pytest.raises(Refusal, match="Nearest: 'Cube'"):
        shelf.use(use="things.blend/material/Red paint", objects=["Cubb"])


def test_all_maps_of_a_set_are_connected_and_packed(shelf: Shelf) -> None:
    shelf.session.run("bpy.ops.mesh.primitive_cube_add()")
    answer = shelf.use(use="wood/Oak01/textures", objects=["Cube"], repeat=3)
    assert answer.data["connected"] == {
        "ambient_occlusion": "Base Color",
        "base_color": "Base Color",
        "roughness": "Roughness",
        "metallic": "Metallic",
        "normal": "Normal",
        "displacement": "Displacement",
    }
    read = """
tree = bpy.data.objects["Cube"].active_material.node_tree
shader = next(n for n in tree.nodes if n.type == "BSDF_PRINCIPLED")
output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
spaces = {n.image.name.split("_")[-1]: n.image.colorspace_settings.is_data for n in tree.nodes if n.type == "TEX_IMAGE"}
packed = all(i.packed_file for i in bpy.data.images if i.source == "FILE")
[sorted(s.name for s in shader.inputs if s.is_linked), output.inputs["Displacement"].is_linked, spaces, packed]
"""
    inputs, displaced, spaces, packed = shelf.session.run(read)
    assert inputs == ["Base Color", "Metallic", "Normal", "Roughness"]
    assert displaced
    assert packed
    assert spaces["Color.png"] is False
    assert all(data for name, data in spaces.items() if name != "Color.png")


def test_an_hdri_becomes_the_packed_world(shelf: Shelf) -> None:
    shelf.use(use="sunset.hdr", strength=2, rotation=90)
    read = """
world = bpy.context.scene.world
node = next(n for n in world.node_tree.nodes if n.type == "TEX_ENVIRONMENT")
light = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
[bool(node.image.packed_file), node.outputs[0].is_linked, light.inputs["Strength"].default_value]
"""
    assert shelf.session.run(read) == [True, True, 2.0]


def test_damaged_files_are_named_and_the_others_found(shelf: Shelf) -> None:
    (shelf.root / "broken.blend").write_bytes(b"BLENDER-v300" + b"\xff" * 300)
    (shelf.root / "broken.hdr").write_bytes(b"nothing")
    try:
        answer = shelf.use()
        assert {fault.split(":")[0] for fault in answer.data["faults"]} == {"broken.blend", "broken.hdr"}
        assert answer.data["found"] == 6
    finally:
        (shelf.root / "broken.blend").unlink()
        (shelf.root / "broken.hdr").unlink()


def test_what_one_blender_could_not_read_another_version_is_asked_for(
    shelf: Shelf, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The real one refuses the file; that of another version is played by one that reads everything."""
    broken = shelf.root / "broken.hdr"
    broken.write_bytes(b"nothing")
    try:
        shelf.again().assets(shelf.session.blender)
        assert len(shelf.library.faults) == 1
        monkeypatch.setattr(AssetLibrary, "_read", lambda *_: readable())
        shelf.again().assets(shelf.session.blender)
        assert len(shelf.library.faults) == 1
        launch = shelf.session.blender.launch
        other = replace(launch, runtime=replace(launch.runtime, version="3.0.0"))
        shelf.again().assets(cast("Any", SimpleNamespace(launch=other, pictures=None)))
        assert shelf.library.faults == []
    finally:
        broken.unlink()


def test_a_file_that_ended_a_blender_once_is_tried_again(
    shelf: Shelf, monkeypatch: pytest.MonkeyPatch
) -> None:
    evening = shelf.root / "evening.hdr"
    evening.write_bytes((shelf.root / "sunset.hdr").read_bytes() + b"\n")
    calls: list[str] = []

    def too_long(_process: object, tool: str, *_: Any, **_more: Any) -> Any:
        calls.append(tool)
        raise TookTooLong("it took more than 120 s")

    try:
        with monkeypatch.context() as busy:
            busy.setattr(BlenderProcess, "call", too_long)
            for _ in range(2):  # in one library, it is not tried again because another file has changed
                shelf.library.assets(shelf.session.blender)
                (shelf.root / "sunset.hdr").touch()
            assert calls == ["read_assets"]
            assert "it ends the Blender that reads it: it took more than 120 s" in shelf.library.faults[0]
        assert "evening.hdr" in {asset.id for asset in shelf.again().assets(shelf.session.blender)}
        assert shelf.library.faults == []
    finally:
        evening.unlink()


def readable() -> _Kept:
    return _Kept(read=ReadAssets(assets=[], size=(1, 1), picture="", fault=""))


def test_the_licence_of_what_was_fetched_is_told(shelf: Shelf) -> None:
    folder = shelf.root / "poly_haven" / "textures" / "oak_1k"
    folder.mkdir(parents=True)
    note = LicenceNote(
        source="Poly Haven",
        page="https://polyhaven.com/a/oak",
        license="CC0",
        author="Ada",
        name="Oak",
        tags=["bark"],
    )
    try:
        shutil.copy(shelf.root / "wood" / "Oak01_1K-PNG_Color.png", folder / "oak_diffuse_1k.png")
        (folder / NOTE_FILE).write_text(note.model_dump_json())
        (found,) = shelf.use(query="bark").data["assets"]
        used = shelf.use(use=found["id"])
    finally:
        shutil.rmtree(shelf.root / "poly_haven")
    assert (found["license"], found["author"], found["tags"]) == ("CC0", "Ada", ["bark"])
    assert "licence: CC0; author: Ada" in used.text


def test_without_a_library_the_tool_says_what_is_missing(session: LiveSession) -> None:
    with pytest.raises(Refusal, match="without --assets"):
        session.use(TOOL)


@pytest.mark.anyio
async def test_the_server_lists_the_tool_only_with_a_library(shelf: Shelf, built_once: Built) -> None:
    """What it lists without one, the tests of the server say name by name."""
    async with Client(over_stdio(built_once.home, "--assets", str(shelf.root))) as client:
        listed = {tool.name for tool in (await client.list_tools()).tools}
        answer = await client.call_tool(TOOL.name, {"query": "sunset"})
        assert client.instructions is not None
        assert TOOL.name in client.instructions
    assert TOOL.name in listed
    assert answer.structured_content is not None
    assert [asset["id"] for asset in answer.structured_content["assets"]] == ["sunset.hdr"]
