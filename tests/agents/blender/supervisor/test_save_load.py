"""``blender_save`` and ``blender_load``: what comes back elsewhere, and what is refused."""

from __future__ import annotations

import ast
import os
import resource
import shutil
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from live_session import LiveSession, no_docs

from agents.blender.files.checkpoints import KEPT
from agents.blender.files.run_folder import RunFolder
from agents.blender.files.saved_files import copy_from_workspace
from agents.blender.launch import make_launch
from agents.blender.supervisor import Supervisor
from agents.blender.tools.base import ToolContext
from agents.blender.tools.files import LOAD, SAVE
from simworlds.sandbox.blender_process import BlenderProcess
from simworlds.sandbox.confinement.confined_command import best_sandbox, default_limits
from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.hostile_ground import HostileGround
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.blender

# A cloth that falls on a cube, its cache in memory or on disk; MEASURE tells where its vertices are.
CLOTH = """
bpy.ops.mesh.primitive_cube_add(size=1)
bpy.context.object.modifiers.new("Collision", "COLLISION")
bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=2, location=(0, 0, 1))
bpy.context.object.name = "Sheet"
cache = bpy.context.object.modifiers.new("Cloth", "CLOTH").point_cache
cache.frame_end, cache.use_disk_cache = 12, ON_DISK
bpy.ops.ptcache.bake_all(bake=True)
"""
LIQUID = """
bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5)
flow = bpy.context.object.modifiers.new("Fluid", "FLUID")
flow.fluid_type = "FLOW"
flow.flow_settings.flow_type = "LIQUID"
bpy.ops.mesh.primitive_cube_add(size=2)
bpy.context.object.name = "Sheet"
modifier = bpy.context.object.modifiers.new("Fluid", "FLUID")
modifier.fluid_type = "DOMAIN"
domain = modifier.domain_settings
domain.domain_type, domain.resolution_max, domain.use_mesh = "LIQUID", 16, True
domain.cache_type, domain.cache_frame_end, domain.cache_directory = "ALL", 9, "//caches/Sheet"
bpy.ops.fluid.bake_all()
"""
MEASURE = """
bpy.context.scene.frame_set(8)
thing = bpy.data.objects["Sheet"]
mesh = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
points = [round(x, 5) for vertex in mesh.vertices for x in vertex.co]
(len(points), min(points), max(points), hash(tuple(points)))
"""
PICTURE = """
import os
os.makedirs("textures", exist_ok=True)
image = bpy.data.images.new("Wood", 4, 4)
image.pixels[:] = [0.25, 0.5, 0.75, 1.0] * 16
image.filepath_raw, image.file_format = "//textures/wood.png", "PNG"
image.save()
bpy.data.images.remove(image)
bpy.data.images.load("//textures/wood.png").use_fake_user = True
"""
COLOUR = "[round(x, 2) for x in bpy.data.images['wood.png'].pixels[:4]]"


@pytest.fixture(scope="module")
def _run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveSession]:
    made = LiveSession(tmp_path_factory.mktemp("saving") / "run")
    made.use(SAVE, name="empty", verify=False)
    yield made
    made.blender.close()


@pytest.fixture
def session(_run: LiveSession) -> LiveSession:
    """A run whose scene is empty, and in which nothing but that was saved."""
    root = _run.blender.folder.root
    for made in (*root.iterdir(), *(root / "workspace").iterdir()):
        if made.name in {
            "empty.blend",
            ".lock",
            "workspace",
            "checkpoints",
            "private",
            "lent",
            "scene.blend",
        }:
            continue
        if made.is_dir() and not made.is_symlink():
            shutil.rmtree(made)
        else:
            made.unlink()
    _run.use(LOAD, path="empty")
    return _run


@contextmanager
def session_for(root: Path, **launch: Any) -> Iterator[LiveSession]:
    """A run whose Blender is started otherwise."""
    folder = RunFolder.make(root)
    made = LiveSession.__new__(LiveSession)
    made.blender = Supervisor(make_launch(folder.workspace, **launch), folder)
    made.context = ToolContext(made.blender, no_docs)
    made.blender.start()
    yield made
    made.blender.close()


def refusal(session: LiveSession, tool: Any, **arguments: Any) -> str:
    with pytest.raises(Refusal) as refused:
        session.use(tool, **arguments)
    return str(refused.value)


def elsewhere(path: Path, room: Path, code: str) -> Any:
    """What ``code`` finds in a process that has nothing but the file and its caches, moved to another folder."""
    room.mkdir()
    for one in (path, path.with_name(f"blendcache_{path.stem}")):
        if one.exists():
            shutil.move(one, room / one.name)
    launch = make_launch(HostileGround(room))
    process = BlenderProcess(launch)
    try:
        process.call("inspect", {"path": str(room / path.name)}, unread, timeout=60)
        found = process.call("execute", {"code": code}, unread, timeout=60).value
        assert found["error"] is None, found["error"]["traceback"]
        return ast.literal_eval(found["value"])
    finally:
        process.kill()
        launch.clean()


# What comes back


@pytest.mark.parametrize(
    ("recipe", "label", "files"),
    [
        pytest.param(CLOTH.replace("ON_DISK", "False"), "cloth of 'Sheet'", 0, marks=pytest.mark.whole),
        (CLOTH.replace("ON_DISK", "True"), "cloth of 'Sheet'", 12),
        (LIQUID, "liquid of 'Sheet'", 27),
    ],
    ids=["cloth in memory", "cloth on disk", "liquid"],
)
def test_a_baked_cache_opens_elsewhere_and_here_again(
    session: LiveSession, tmp_path: Path, recipe: str, label: str, files: int
) -> None:
    session.run(recipe)
    before = session.run(MEASURE)
    found = session.use(SAVE, name="saves/tower")
    assert not found.failed, found.text
    assert (found.data["beside"] or {"files": 0})["files"] == files
    assert [(one["label"], one["baked"]) for one in found.data["opened"]["caches"]] == [(label, True)]
    assert found.data["external"] == []
    assert session.run(MEASURE) == before, "saving has changed the scene that was saved"
    path = Path(found.data["path"])
    assert path == session.blender.folder.root / "saves" / "tower.blend"

    session.run("bpy.ops.wm.read_homefile(use_empty=True)")
    shutil.rmtree(session.blender.folder.workspace.mount / "caches", ignore_errors=True)
    session.use(LOAD, path="saves/tower")
    assert session.run(MEASURE) == before
    assert not (session.blender.folder.workspace.mount / ".loading").exists()

    assert elsewhere(path, tmp_path / "elsewhere", MEASURE) == before
    assert before[0] > 100


def test_packs_images_only_into_the_copy(session: LiveSession, tmp_path: Path) -> None:
    session.run(PICTURE)
    found = session.use(SAVE, name="tower", verify=False)
    assert found.data["packed"] == ["wood.png"]
    assert found.data["external"] == []
    state = "image = bpy.data.images['wood.png']\n(image.packed_file is None, image.filepath)"
    assert session.run(state) == (True, "//textures/wood.png")
    assert elsewhere(Path(found.data["path"]), tmp_path / "elsewhere", COLOUR) == [0.25, 0.5, 0.75, 1.0]


def test_saves_paths_of_unpacked_images(session: LiveSession) -> None:
    session.run(PICTURE)
    found = session.use(SAVE, name="saves/tower", verify=False, pack=False)
    lies = str(session.blender.folder.workspace.mount / "textures" / "wood.png")
    assert [(one["path"], one["missing"]) for one in found.data["external"]] == [(lies, False)]
    assert lies in found.text
    session.run("bpy.ops.wm.read_homefile(use_empty=True)")
    session.use(LOAD, path="saves/tower")
    assert session.run(COLOUR) == [0.25, 0.5, 0.75, 1.0]


def test_pixels_that_no_file_holds_are_saved(session: LiveSession, tmp_path: Path) -> None:
    session.run(
        "image = bpy.data.images.new('wood.png', 2, 2)\nimage.pixels[:] = [1, 0, 1, 1] * 4\nimage.use_fake_user = True"
    )
    found = session.use(SAVE, name="tower", verify=False, pack=False)
    assert found.data["rescued"] == ["wood.png"]
    assert elsewhere(Path(found.data["path"]), tmp_path / "elsewhere", COLOUR) == [1, 0, 1, 1]


def test_saves_despite_missing_files_and_names_them(session: LiveSession) -> None:
    session.run(PICTURE + "\nos.remove('textures/wood.png')")
    found = session.use(SAVE, name="tower", verify=False)
    assert found.data["packed"] == []
    assert [one["missing"] for one in found.data["external"]] == [True]
    assert "(missing)" in found.text


def test_saves_geometry_nodes_bakes(session: LiveSession, tmp_path: Path) -> None:
    session.run("""
bpy.ops.mesh.primitive_cube_add()
bpy.context.object.name = "Sheet"
tree = bpy.data.node_groups.new("Rise", "GeometryNodeTree")
for way in ("INPUT", "OUTPUT"):
    tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
make = tree.nodes.new
enter, leave, move = make("NodeGroupInput"), make("NodeGroupOutput"), make("GeometryNodeSetPosition")
begin, end = make("GeometryNodeSimulationInput"), make("GeometryNodeSimulationOutput")
begin.pair_with_output(end)
move.inputs["Offset"].default_value = (0, 0, 0.1)
for one, other in ((enter, begin), (begin, move), (move, end), (end, leave)):
    source = next(socket for socket in one.outputs if socket.type == "GEOMETRY")
    tree.links.new(source, next(socket for socket in other.inputs if socket.type == "GEOMETRY"))
modifier = bpy.context.object.modifiers.new("Rise", "NODES")
modifier.node_group, modifier.bake_target, modifier.bake_directory = tree, "DISK", "//caches/rise"
bpy.context.scene.frame_end = 9
bpy.ops.object.simulation_nodes_cache_bake(selected=True)
""")
    before = session.run(MEASURE)
    found = session.use(SAVE, name="tower", verify=False)
    assert found.data["beside"]["files"] == 18
    assert elsewhere(Path(found.data["path"]), tmp_path / "elsewhere", MEASURE) == before
    assert before[2] == pytest.approx(1.8)


def test_replaces_caches_of_an_older_save(session: LiveSession) -> None:
    session.run(CLOTH.replace("ON_DISK", "True"))
    beside = Path(session.use(SAVE, name="tower", verify=False).data["beside"]["path"])
    assert len(list(beside.iterdir())) == 12
    session.run("bpy.data.objects.remove(bpy.data.objects['Sheet'])")
    assert session.use(SAVE, name="tower", verify=False).data["beside"] is None
    assert not beside.exists()


def test_reports_baked_caches_with_missing_files(session: LiveSession) -> None:
    session.run(LIQUID + "\nimport shutil\nshutil.rmtree('caches')")
    found = session.use(SAVE, name="tower", verify=False)
    assert found.failed
    assert "liquid of 'Sheet' is marked as baked, but 9 of its frames are missing" in found.text
    assert (session.blender.folder.root / "tower.blend").exists()


def test_opens_a_file_of_another_folder_with_caches_and_images(session: LiveSession, tmp_path: Path) -> None:
    session.run(CLOTH.replace("ON_DISK", "True") + PICTURE)
    before = session.run(MEASURE)
    saved = Path(session.use(SAVE, name="tower", verify=False).data["path"])
    assets = tmp_path / "assets"
    shutil.move(saved.parent / "workspace" / "textures", assets / "textures")
    for one in (saved, saved.with_name("blendcache_tower")):
        shutil.move(one, assets / one.name)
    with session_for(tmp_path / "other", read=(assets,)) as other:
        files = {path: path.read_bytes() for path in assets.rglob("*") if path.is_file()}
        assert other.use(LOAD, path=str(assets / "tower.blend")).data["objects"] == 2
        assert other.run(MEASURE) == before
        assert other.run(COLOUR) == [0.25, 0.5, 0.75, 1.0]
        other.run("bpy.ops.ptcache.free_bake_all()")
        assert {path: path.read_bytes() for path in assets.rglob("*") if path.is_file()} == files
        (assets / "link.blend").symlink_to(assets / "tower.blend")
        assert "it is a link" in refusal(other, LOAD, path=str(assets / "link.blend"))
        assert "may not be opened" in refusal(other, LOAD, path=str(tmp_path / "empty.blend"))


def test_saves_a_run_that_lies_in_a_folder_that_blender_may_read(tmp_path: Path) -> None:
    """As where an edited file lies beside the run, or a run is made in the folder of its textures."""
    tmp_path.chmod(0o755)
    with session_for(tmp_path / "assets" / "run", read=(tmp_path / "assets",)) as run:
        saved = run.use(SAVE, name="here")
    assert "A second Blender opens it" in saved.text


# Checkpoints


def test_a_save_without_a_name_is_a_checkpoint_to_go_back_to(session: LiveSession) -> None:
    session.run("bpy.ops.mesh.primitive_cube_add()")
    number = session.use(SAVE).data["checkpoint"]
    assert not session.use(SAVE).data["new"]
    session.run("bpy.data.objects.remove(bpy.data.objects['Cube'])")
    assert number in session.use(LOAD).data["checkpoints"]
    found = session.use(LOAD, checkpoint=number)
    assert f"back at checkpoint {number}" in found.text
    assert session.run("[one.name for one in bpy.data.objects]") == ["Cube"]
    assert found.data["checkpoint"] > number
    session.blender.kill()
    assert session.run("[one.name for one in bpy.data.objects]") == ["Cube"], (
        "the last checkpoint is another one"
    )


def test_the_oldest_checkpoint_can_be_gone_back_to(session: LiveSession) -> None:
    for number in range(14):
        session.run(f"bpy.data.objects.new('{number}', None).use_fake_user = True")
    session.use(LOAD, checkpoint=session.use(LOAD).data["checkpoints"][-1])
    assert session.run("len(bpy.data.objects)") == 14 - (KEPT - 1)


def test_unknown_checkpoint_is_refused_with_the_available_ones(session: LiveSession) -> None:
    kept = session.use(LOAD).data["checkpoints"]
    assert f"Available: {kept[-1]}, " in refusal(session, LOAD, checkpoint=9999)
    assert "not both" in refusal(session, LOAD, checkpoint=1, path="tower")


# What is refused


@pytest.mark.parametrize(
    "name",
    ["../out", "/tmp/out", "..", ".", "", "a/../../out", "workspace/in", "Checkpoints/000001", "a\0b", "a\nb", "~/x*",
     "a/" * 20 + "b", "x" * 300],
)  # fmt: skip
def test_a_name_that_leads_elsewhere_is_refused(session: LiveSession, name: str) -> None:
    before = sorted(session.blender.folder.root.rglob("*"))
    assert refusal(session, SAVE, name=name)
    assert sorted(session.blender.folder.root.rglob("*")) == before


def test_refuses_a_folder_as_a_file(session: LiveSession) -> None:
    (session.blender.folder.root / "folder.blend").mkdir()
    assert "is a folder" in refusal(session, SAVE, name="folder")
    assert "not a regular file" in refusal(session, LOAD, path="folder.blend")


def test_a_link_out_of_the_runs_folder_is_not_followed(session: LiveSession, tmp_path: Path) -> None:
    (session.blender.folder.root / "out").symlink_to(tmp_path)
    assert "leads out" in refusal(session, SAVE, name="out/tower")
    assert list(tmp_path.iterdir()) == []


def test_links_that_code_leaves_where_files_are_written_are_not_followed(
    session: LiveSession, tmp_path: Path
) -> None:
    victim = tmp_path / "victim"
    victim.mkdir()
    (victim / "kept").write_text("kept")
    session.run(LIQUID)
    session.run(f"""
import os, shutil
shutil.rmtree("caches/Sheet/mesh")
os.symlink({str(victim)!r}, "caches/Sheet/mesh")
os.symlink({str(victim / "kept")!r}, "caches/Sheet/data/stolen.vdb")
os.symlink({str(victim / "kept")!r}, ".saved.blend")
os.symlink({str(victim)!r}, ".loading")
""")
    assert "not a regular file" in refusal(session, SAVE, name="tower")
    assert not (session.blender.folder.root / "tower.blend").exists()
    session.run("import os\nfor link in ('data/stolen.vdb', 'mesh'): os.remove(f'caches/Sheet/{link}')")
    session.use(SAVE, name="tower", verify=False)
    session.use(LOAD, path="tower")
    assert [(one.name, one.read_text()) for one in victim.iterdir()] == [("kept", "kept")]
    assert [one.name for one in session.blender.folder.root.glob(".saving-*")] == []


@pytest.mark.parametrize("below", ["../out", "/tmp/out", "", "a/../../out", "a\0b"])
def test_reply_cannot_name_a_path_outside(session: LiveSession, tmp_path: Path, below: str) -> None:
    (session.blender.folder.workspace.mount / "made").write_text("made")
    with pytest.raises(Refusal, match="not a valid path for a cache file"):
        copy_from_workspace(session.blender.folder, [("made", below)], tmp_path / "caches")
    assert not list(tmp_path.iterdir())


HOSTILE = {
    "nothing.blend": (None, "There is no nothing.blend. Saved in this run: empty.blend."),
    "../other.blend": (None, "give a path without '..'"),
    "/etc/passwd": (None, "may not be opened"),
    "void.blend": (b"", "is empty"),
    "text.blend": (b"hello, I am a scene", "is not a .blend file"),
    "head.blend": (b"BLENDER17-01v0501", "cannot be opened"),
    "squeezed.blend": (b"\x28\xb5\x2f\xfd" + bytes(range(256)) * 8, "cannot be opened"),
    "checkpoints/NEWEST": (None, "go back to it with checkpoint="),
    "a\0b": (None, "is not a valid path"),
}


@pytest.mark.parametrize(
    "path",
    [pytest.param(path, marks=pytest.mark.whole if path == "squeezed.blend" else ()) for path in HOSTILE],
)
def test_refuses_files_that_are_not_blend_files(session: LiveSession, path: str) -> None:
    session.run("bpy.ops.mesh.primitive_cube_add()")
    content, because = HOSTILE[path]
    root = session.blender.folder.root
    if content is not None:
        (root / path).write_bytes(content)
    path = path.replace("NEWEST", max(one.name for one in (root / "checkpoints").glob("*.blend")))
    assert because in refusal(session, LOAD, path=path)
    assert session.run("[one.name for one in bpy.data.objects]") == ["Cube"]


def test_a_torn_or_newer_file_is_refused_and_the_scene_stays(session: LiveSession) -> None:
    session.run("bpy.ops.mesh.primitive_cube_add()")
    session.run(
        "bpy.ops.wm.save_as_mainfile(filepath=bpy.path.abspath('//plain.blend'), copy=True, compress=False)"
    )
    whole = (session.blender.folder.workspace.mount / "plain.blend").read_bytes()
    root = session.blender.folder.root
    (root / "torn.blend").write_bytes(whole[: len(whole) // 2])
    version = whole[12:17]
    assert version == b"v0501"
    (root / "newer.blend").write_bytes(whole.replace(version, b"v0777", 1))
    session.run("bpy.data.objects['Cube'].location.x = 3")
    assert "torn.blend cannot be opened" in refusal(session, LOAD, path="torn")
    told = refusal(session, LOAD, path="newer.blend")
    assert "saved by Blender 7.77" in told
    assert "The scene is unchanged, at checkpoint" in told
    assert session.run("[(one.name, one.location.x) for one in bpy.data.objects]") == [("Cube", 3.0)]
    (root / "plain.blend").write_bytes(whole)
    assert session.use(LOAD, path="plain").data["objects"] == 1
    assert session.run("bpy.data.objects['Cube'].location.x") == 0.0


def test_scripts_in_a_file_do_not_run(session: LiveSession) -> None:
    session.run(
        "text = bpy.data.texts.new('start.py')\n"
        "text.write(\"import bpy\\nbpy.data.objects.new('Ran', None)\")\n"
        "text.use_module = True\n"
        "bpy.ops.mesh.primitive_cube_add()"
    )
    session.use(SAVE, name="tower", verify=False)
    found = session.use(LOAD, path="tower")
    assert found.data["scripts"]
    assert "they do not run" in found.text
    assert session.run("[one.name for one in bpy.data.objects]") == ["Cube"]


# Full disks


def test_a_file_too_large_for_the_sandbox_leaves_the_old_one_whole(tmp_path: Path) -> None:
    sandbox = best_sandbox(limits=replace(default_limits(), file_size=2_000_000))
    with session_for(tmp_path / "small", sandbox=sandbox) as small:
        root = small.blender.folder.root
        small.use(SAVE, name="tower", verify=False)
        before = (root / "tower.blend").read_bytes()
        code = (
            "import random\nimage = bpy.data.images.new('Noise', 1024, 1024, float_buffer=True)\n"
            "image.pixels.foreach_set([random.random() for _ in range(4 * 1024 * 1024)])\n"
            "image.use_fake_user = True"
        )
        assert small.blender.call("execute", {"code": code}, unread, timeout=60).value["error"] is None
        told = refusal(small, SAVE, name="tower")
        assert "tower.blend was not saved" in told
        assert "The older file of that name is unchanged" in told
        assert (root / "tower.blend").read_bytes() == before
        assert not (root / "workspace" / ".saved.blend").exists()


def test_a_full_disk_leaves_the_old_file_and_its_caches_whole(session: LiveSession) -> None:
    session.run(CLOTH.replace("ON_DISK", "True"))
    session.use(SAVE, name="tower", verify=False)
    root = session.blender.folder.root
    before = {path: path.read_bytes() for path in root.glob("*tower*/*")} | {
        root / "tower.blend": (root / "tower.blend").read_bytes()
    }
    assert len(before) == 13
    session.run("bpy.data.objects['Sheet'].scale.x = 2")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        told = refusal(session, SAVE, name="tower", verify=False)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert os.strerror(27) in told
    assert "The older file of that name is unchanged" in told
    assert {path: path.read_bytes() for path in before} == before
    assert [path.name for path in root.iterdir() if path.name.startswith(".saving")] == []
