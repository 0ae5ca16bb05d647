"""``blender_import`` with files that mean harm, or are damaged: the server goes on, and nothing outside is read."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from live_session import LiveSession
from sandboxes import sandbox_of, skip_unless_it_works

from agents.blender.tools.export_file import TOOL as EXPORT
from agents.blender.tools.import_file import TOOL as IMPORT
from simworlds.sandbox.errors import BlenderError, Lost, Refusal

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.blender

_WHOLE = pytest.mark.whole
_SECRET = "kept from everyone"
_TRIANGLE = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
_PNG = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC"
)


def gltf(**more: Any) -> dict[str, Any]:
    """A triangle; ``more`` replaces parts of it."""
    data = "data:application/octet-stream;base64," + base64.b64encode(_TRIANGLE).decode()
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 3,
                "type": "VEC3",
                "min": [0, 0, 0],
                "max": [1, 1, 0],
            }
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": data}],
        **more,
    }


def with_texture(uri: str) -> dict[str, Any]:
    return gltf(
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        textures=[{"source": 0}],
        images=[{"uri": uri}],
    )


# Behind Landlock the files are there, and only forbidden; bubblewrap has none of them.
@pytest.fixture(scope="module", params=["landlock", pytest.param("bubblewrap", marks=pytest.mark.whole)])
def reader(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveSession]:
    """A Blender that may read the folder ``assets``, beside which lies ``secret.png``."""
    folder = tmp_path_factory.mktemp("outside")
    folder.chmod(0o755)
    (folder / "assets").mkdir()
    (folder / "secret.png").write_bytes(_PNG)
    (folder / "secret.bin").write_bytes(_TRIANGLE)
    (folder / "secret.mtl").write_text(f"newmtl {_SECRET.replace(' ', '_')}\n")
    session = LiveSession(
        tmp_path_factory.mktemp("run"),
        sandbox=sandbox_of(skip_unless_it_works(request.param)),
        read=((folder / "assets").resolve(),),
    )
    yield session
    session.blender.close()


def assets(session: LiveSession) -> Path:
    return session.blender.launch.read[0]


def put(session: LiveSession, name: str, content: bytes | str | dict[str, Any]) -> str:
    path = assets(session) / name
    if isinstance(content, dict):
        content = json.dumps(content)
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return str(path)


def refused(session: LiveSession, path: str, **more: Any) -> str:
    with pytest.raises(Refusal) as refusal:
        session.use(IMPORT, path=path, **more)
    assert "Traceback" not in str(refusal.value)
    return str(refusal.value)


def outcome(session: LiveSession, path: str) -> str:
    """What the tool says of a file that may or may not come in."""
    try:
        return session.use(IMPORT, path=path, timeout=60.0).text
    except BlenderError as error:
        return str(error)


def test_an_honest_file_comes_in(reader: LiveSession) -> None:
    reader.empty()
    put(reader, "own.png", _PNG)
    came = reader.use(IMPORT, path=put(reader, "fine.gltf", with_texture("own.png")))
    assert came.data["triangles"] == 1
    assert came.data["missing"] == []
    assert [image["packed"] for entry in came.data["materials"] for image in entry["images"]] == [True]


_OUTSIDE = ("../secret", "%2e%2e/secret", "{outside}/secret", "link/secret")
_REFERRING = ("image.gltf", "buffer.gltf", "library.obj", "texture.obj")


@pytest.mark.parametrize(
    ("how", "file"),
    [
        pytest.param(how, file, marks=() if _OUTSIDE.index(how) == _REFERRING.index(file) else _WHOLE)
        for how in _OUTSIDE
        for file in _REFERRING
    ],
)
def test_names_that_lead_outside_are_refused_before_anything_is_read(
    reader: LiveSession, how: str, file: str
) -> None:
    reader.empty()
    link = assets(reader) / "link"
    if not link.is_symlink():
        link.symlink_to(assets(reader).parent)
    name = how.format(outside=assets(reader).parent)
    plain = name.replace("%2e", ".")
    files = {
        "image.gltf": with_texture(f"{name}.png"),
        "buffer.gltf": gltf(buffers=[{"byteLength": 36, "uri": f"{name}.bin"}]),
        "library.obj": f"mtllib {plain}.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    }
    put(reader, "texture.mtl", f"newmtl plain\nmap_Kd -s 1 1 1 {plain}.png\n")
    files["texture.obj"] = "mtllib texture.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl plain\nf 1 2 3\n"
    path = put(reader, file, files[file])
    assert "names files outside of the folder that may be read" in refused(reader, path)
    assert reader.run("[m.name for m in bpy.data.meshes] + [i.name for i in bpy.data.images]") == []


def test_a_usd_layer_outside_is_not_read(reader: LiveSession) -> None:
    reader.empty()
    outside = assets(reader).parent / "secret.usda"
    outside.write_text('#usda 1.0\ndef Mesh "Secret" {\n point3f[] points = [(0,0,0),(1,0,0),(0,1,0)]\n'
                       " int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0,1,2]\n}\n")  # fmt: skip
    path = put(
        reader, "refers.usda", '#usda 1.0\ndef "Inside" (references = @../secret.usda@</Secret>) {\n}\n'
    )
    outcome(reader, path)
    assert reader.run("[m.name for m in bpy.data.meshes if len(m.vertices)]") == []


def test_a_missing_texture_is_told(reader: LiveSession) -> None:
    reader.empty()
    put(reader, "lost.mtl", "newmtl plain\nmap_Kd gone.png\n")
    path = put(reader, "lost.obj", "mtllib lost.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl plain\nf 1 2 3\n")
    came = reader.use(IMPORT, path=path)
    assert came.data["missing"] == ["gone.png"]
    assert "missing image files: gone.png" in came.text


@pytest.mark.parametrize(
    ("name", "content", "why"),
    [
        ("empty.glb", b"", "is empty"),
        ("noise.glb", b"\xff" * 500, "is damaged"),
        ("short.glb", b"glTF" + struct.pack("<4I", 2, 9000, 8000, 0x4E4F534A) + b"{}", "cut off"),
        pytest.param("list.gltf", b"[]", "not a glTF file", marks=_WHOLE),
        pytest.param("deep.gltf", b"[" * 200_000, "is damaged", marks=_WHOLE),
        ("counts.gltf", gltf(accessors=[{"componentType": 5126, "count": 10**15, "type": "VEC3"}]), "claims"),
        pytest.param(
            "cycle.gltf",
            gltf(nodes=[{"children": [1]}, {"children": [0]}]),
            "do not form a tree",
            marks=_WHOLE,
        ),
        (
            "laughs.gltf",
            gltf(nodes=[{"children": [n + 1, n + 1]} for n in range(60)] + [{"mesh": 0}]),
            "do not form a tree",
        ),
        pytest.param(
            "none.gltf", gltf(scenes=[{"nodes": []}], nodes=[]), "cannot read|Nothing came in", marks=_WHOLE
        ),
        (
            "huge.stl",
            b"\0" * 80 + struct.pack("<I", 2**32 - 1) + b"\0" * 50,
            "claims 4,294,967,295 triangles",
        ),
        pytest.param("tiny.stl", b"abc", "too short", marks=_WHOLE),
        ("noise.fbx", b"Kaydara FBX Binary  \0\x1a\0" + b"\xff" * 200, "cannot read|Nothing came in|crashed"),
        pytest.param(
            "noise.abc",
            b"Ogawa\xff\0\x01" + b"\xff" * 200,
            "cannot read|Nothing came in|crashed",
            marks=_WHOLE,
        ),
        ("noise.usdc", b"PXR-USDC" + b"\xff" * 200, "cannot read|Nothing came in|crashed"),
        pytest.param(
            "noise.usdz", b"PK\x03\x04" + b"\xff" * 200, "cannot read|Nothing came in|crashed", marks=_WHOLE
        ),
        pytest.param("noise.obj", b"\xff\0" * 200, "cannot read|Nothing came in|crashed", marks=_WHOLE),
    ],
)
def test_damaged_files_are_refused_and_leave_the_scene(
    session: LiveSession, name: str, content: bytes | dict[str, Any], why: str
) -> None:
    session.run("bpy.ops.mesh.primitive_cube_add()")
    data = content if isinstance(content, bytes) else json.dumps(content).encode()
    (session.blender.folder.root / name).write_bytes(data)
    with pytest.raises(BlenderError, match=why) as error:
        session.use(IMPORT, path=name)
    if not isinstance(error.value, Lost) and data:
        assert name.split(".")[0] in str(error.value)
    assert session.run("[o.name for o in bpy.data.objects]") == ["Cube"]


_ENDINGS = ("glb", "usdc", "fbx", "obj", "abc", "stl")
_PARTS = (0.1, 0.5, 0.9, 0.999)


@pytest.mark.parametrize(
    ("ending", "part"),
    [
        pytest.param(ending, part, marks=() if (row + column) % 4 == 0 else _WHOLE)
        for row, ending in enumerate(_ENDINGS)
        for column, part in enumerate(_PARTS)
    ],
)
def test_files_that_are_cut_off_anywhere_do_not_end_the_server(
    session: LiveSession, ending: str, part: float
) -> None:
    session.run("bpy.ops.mesh.primitive_uv_sphere_add()")
    path = session.use(EXPORT, name=f"whole.{ending}", verify=False).data["path"]
    whole = Path(path).read_bytes()
    session.empty()
    cut = session.blender.folder.root / f"cut.{ending}"
    cut.write_bytes(whole[: int(len(whole) * part)])
    said = outcome(session, cut.name)
    assert "Traceback" not in said
    assert session.run("1 + 1") == 2


def test_a_usd_that_multiplies_ends_at_a_deadline_or_a_limit(session: LiveSession) -> None:
    layers = ['#usda 1.0\ndef Xform "L0" {\n def Cube "C" {}\n}\n']
    for number in range(1, 30):
        children = "".join(f' def "C{n}" (references = </L{number - 1}>) {{}}\n' for n in range(8))
        layers.append(f'def Xform "L{number}" {{\n{children}}}\n')
    session.run("bpy.ops.mesh.primitive_cube_add()")
    (session.blender.folder.root / "laughs.usda").write_text("".join(layers))
    with pytest.raises(Lost) as lost:
        session.use(IMPORT, path="laughs.usda", timeout=3.0)
    assert "importing laughs.usda" in str(lost.value).lower()
    assert session.run("[o.name for o in bpy.data.objects]") == ["Cube"]


@pytest.mark.parametrize(
    ("path", "why"),
    [
        ("gone.glb", "There is no gone.glb"),
        ("../up.glb", "without '..'"),
        ("/etc/passwd.glb", "may not be opened"),
        ("private/x.glb", "There is no|reserved"),
        ("scene.blend", "blender_load opens .blend files"),
    ],
)
def test_paths_outside_are_refused(session: LiveSession, path: str, why: str) -> None:
    with pytest.raises(Refusal, match=why):
        session.use(IMPORT, path=path)


def test_a_file_that_is_a_link_is_refused(session: LiveSession, tmp_path: Path) -> None:
    (tmp_path / "real.stl").write_bytes(b"solid\n")
    (session.blender.folder.root / "link.stl").symlink_to(tmp_path / "real.stl")
    with pytest.raises(Refusal, match="is a link"):
        session.use(IMPORT, path="link.stl")


def test_a_file_brings_its_neighbours_from_the_runs_root_by_name_only(session: LiveSession) -> None:
    root = session.blender.folder.root
    (root / "pair.obj").write_text("mtllib pair.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n")
    (root / "pair.mtl").write_text("newmtl red\nmap_Kd other.png\n")
    (root / "other.png").write_bytes(_PNG)
    came = session.use(IMPORT, path="pair.obj")
    assert [entry["name"] for entry in came.data["materials"]] == ["red"]
    assert came.data["missing"] == ["other.png"]
