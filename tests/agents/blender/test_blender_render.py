"""``blender_render``: stills, films, what is kept of them, and what becomes of them when something goes wrong."""

from __future__ import annotations

import io
import itertools
import os
import shutil
import signal
import threading
from contextlib import closing, suppress
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
from PIL import Image

from agents.blender.render.frame_cache import RenderedFrame
from agents.blender.render.image_checks import LARGEST_PREVIEW, image_faults, look_at
from agents.blender.render.render_budget import LEAST, RenderBudget
from agents.blender.render.render_loop import render_frames
from agents.blender.tools.base import Call, Result
from agents.blender.tools.render import TOOL
from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.pictures.picture_decoder import PictureDecoder

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from live_session import LiveSession

pytestmark = pytest.mark.blender

# A glowing red cube of 1 m before a camera that sees 8 × 8 m; it needs no light, and one sample shows it.
SCENE = """
scene = bpy.context.scene
bpy.ops.mesh.primitive_cube_add(size=1)
cube = bpy.context.object
material = bpy.data.materials.new("Red")
material.diffuse_color = (1, 0, 0, 1)
tree = material.node_tree
glow = tree.nodes.new("ShaderNodeEmission")
glow.inputs["Color"].default_value = (1, 0, 0, 1)
tree.links.new(glow.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
cube.data.materials.append(material)
camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
camera.data.type, camera.data.ortho_scale = "ORTHO", 8
camera.location, camera.rotation_euler = (0, -10, 0), (1.5707963, 0, 0)
scene.collection.objects.link(camera)
scene.camera = camera
scene.render.engine = "CYCLES"
scene.view_settings.view_transform = "Standard"
scene.frame_end = 5
"""
MOVING = (
    SCENE
    + """
for frame, x in ((1, -2), (5, 2)):
    cube.location.x = x
    cube.keyframe_insert("location", frame=frame)
for curve in cube.animation_data.action.layers[0].strips[0].channelbags[0].fcurves:
    for key in curve.keyframe_points:
        key.interpolation = "LINEAR"
"""
)
FALLING = (
    SCENE
    + """
cube.location.z = 3
bpy.ops.rigidbody.object_add()
scene.rigidbody_world.point_cache.frame_end = 20
scene.frame_end = 16
"""
)
SMALL: dict[str, Any] = {"engine": "cycles", "samples": 1, "denoise": False, "width": 64, "height": 64}
FILM: dict[str, Any] = {"kind": "animation", **SMALL}


def where(path: Path) -> tuple[float, float]:
    """The middle of what is red in a picture, in metres of SCENE's camera: right, up."""
    with Image.open(path) as picture:
        rgb = picture.convert("RGB")
    width, height = rgb.size
    red = [
        (x, y)
        for y in range(height)
        for x in range(width)
        if (pixel := rgb.getpixel((x, y))) and isinstance(pixel, tuple) and pixel[0] > 100 > pixel[1]
    ]
    assert red, f"nothing is red in {path}"
    right = sum(x for x, _ in red) / len(red) + 0.5
    down = sum(y for _, y in red) / len(red) + 0.5
    return right / width * 8 - 4, 4 - down / height * 8


def frame_files(session: LiveSession, name: str = "animation") -> dict[str, tuple[int, int]]:
    """The frames of a film: name → what tells whether the file is still the same."""
    folder = session.blender.folder.root / "frames" / name
    return {path.name: (path.stat().st_ino, path.stat().st_mtime_ns) for path in sorted(folder.glob("*.png"))}


def stopped_after(frames: int) -> Call:
    """A call that is given up when so many frames are done."""
    cancelled = threading.Event()

    def progress(done: float, total: float | None, text: str) -> None:
        del total, text
        if done >= frames:
            cancelled.set()

    return Call(progress, cancelled)


# Stills


UNCHANGED = "Not rendered again, since nothing that this still shows has changed since."
DROP = """
bpy.context.view_layer.objects.active = cube = bpy.data.objects['Cube']
bpy.ops.rigidbody.object_add()
bpy.context.scene.rigidbody_world.point_cache.frame_end = 6
bpy.ops.ptcache.bake_all(bake=True)
"""


def test_a_still_is_kept_while_it_would_look_the_same(session: LiveSession) -> None:
    session.run(SCENE)

    def render(frame: int = 1, **more: Any) -> tuple[bool, list[bytes], str]:
        found = session.use(TOOL, None, **{**SMALL, "keep": True, "frame": frame, **more})
        return found.text.startswith(UNCHANGED), [one.png for one in found.pictures], found.text

    kept, first, told = render()
    assert not kept
    session.run(DROP)
    kept, again, told_again = render()
    assert kept, "a simulation shows nothing at its first frame"
    assert again == first
    assert told_again == f"{UNCHANGED} What was said of it then:\n{told}"
    assert not render(samples=2)[0]
    assert not render(6)[0]
    assert render(6)[0]
    session.run("bpy.data.objects['Cube'].rigid_body.mass = 3")
    assert not render(6)[0], "it may have fallen otherwise"
    assert not render()[0]
    assert not render(keep=False)[0], "whoever measures time wants it rendered"
    session.run("bpy.data.materials['Red'].node_tree.nodes['Emission'].inputs['Strength'].default_value = 2")
    assert not render()[0]
    session.run("bpy.data.objects['Cube'].location.x += 0.1")
    assert not render()[0]


def test_a_still_that_is_kept_tells_nothing_of_bakes_as_they_were(session: LiveSession) -> None:
    session.run(SCENE + DROP.replace("bpy.ops.ptcache.bake_all(bake=True)", ""))
    arguments = {**SMALL, "keep": True, "frame": 1}
    first = session.use(TOOL, None, **arguments)
    assert "Not baked, so stepped" in first.text
    session.run("bpy.ops.ptcache.bake_all(bake=True)")
    again = session.use(TOOL, None, **arguments)
    assert again.text.startswith(UNCHANGED)
    assert "Not baked" not in again.text
    assert again.data["unbaked"] == []


@pytest.mark.parametrize("engine", ["cycles", "workbench"])
def test_a_still_shows_what_the_camera_sees(session: LiveSession, engine: str) -> None:
    session.run(SCENE + "cube.location = (1, 0, -2)")
    workspace = session.blender.folder.workspace.mount
    before = {one.name for one in workspace.iterdir()}
    found = session.use(TOOL, None, **{**SMALL, "engine": engine}, name=engine)
    path = session.blender.folder.root / "renders" / f"{engine}.png"
    assert where(path) == pytest.approx((1, -2), abs=0.1)
    assert (found.data["path"], found.data["width"], found.data["height"]) == (str(path), 64, 64)
    assert [picture.path for picture in found.pictures] == [path]
    assert {one.name for one in workspace.iterdir()} - before <= {"scene.blend"}
    assert found.data["warnings"] == []
    assert any("diffuse_color" in note for note in found.data["notes"]) == (engine == "workbench")


_STATE = """
def read(thing, deep):
    told = {}
    for prop in thing.bl_rna.properties:
        if prop.type == "POINTER" and deep and prop.identifier in {"image_settings", "ffmpeg", "shading"}:
            told[prop.identifier] = read(getattr(thing, prop.identifier), False)
        elif prop.type not in {"POINTER", "COLLECTION"}:
            value = getattr(thing, prop.identifier)
            told[prop.identifier] = str(value[:] if getattr(prop, "is_array", False) else value)
    return told
s = bpy.context.scene
state = {
    "frame": (s.frame_current, s.frame_subframe), "camera": s.camera.name,
    "names": [(kind, sorted(one.name for one in getattr(bpy.data, kind)))
              for kind in ("scenes", "images", "objects", "cameras", "movieclips")],
    "markers": [(m.name, m.camera and m.camera.name) for m in s.timeline_markers],
    "handlers": [(n, len(getattr(bpy.app.handlers, n))) for n in ("render_stats", "render_post")],
    **{n: read(getattr(s, n), True) for n in ("render", "cycles", "display", "view_settings")},
}
repr(state)
"""


@pytest.mark.parametrize("kind", ["still", "animation"])
def test_rendering_leaves_the_scene_and_its_settings_as_they_were(session: LiveSession, kind: str) -> None:
    session.run(MOVING)
    session.run(
        "r = s = bpy.context.scene.render\nscene = bpy.context.scene\n"
        "r.engine = 'BLENDER_WORKBENCH'\nr.filepath = '//mine_####'\nr.resolution_percentage = 37\n"
        "r.image_settings.media_type = 'VIDEO'\nr.image_settings.file_format = 'FFMPEG'\n"
        "r.ffmpeg.format = 'MKV'\nscene.cycles.samples = 77\nscene.display.render_aa = '11'\n"
        "other = bpy.data.objects.new('Other', bpy.data.cameras.new('Other'))\n"
        "other.location = (0, -10, 3)\nother.rotation_euler.x = 1.57\nother.data.type = 'ORTHO'\n"
        "scene.collection.objects.link(other)\n"
        "scene.timeline_markers.new('cut', frame=1).camera = bpy.data.objects['Camera']\n"
        "scene.frame_set(3, subframe=0.25)"
    )
    before = session.run(_STATE)
    own: dict[str, Any] = {"frame": 2} if kind == "still" else {"frame_end": 2}
    found = session.use(TOOL, kind=kind, **SMALL, camera="Other", **own)
    assert not found.failed
    assert session.run(_STATE) == before


@pytest.mark.parametrize(
    ("own", "used"),
    [(["HIGH", "ACCURATE"], ["BALANCED", "FAST"]), (["FAST", "ACCURATE"], ["FAST", "ACCURATE"])],
)
def test_a_processor_denoises_quickly(session: LiveSession, own: list[str], used: list[str]) -> None:
    session.run(
        SCENE + f"scene.cycles.denoising_quality, scene.cycles.denoising_prefilter = {own!r}\n"
        "def told():\n"
        "    cycles = bpy.context.scene.cycles\n"
        "    return [cycles.denoising_quality, cycles.denoising_prefilter]\n"
        "bpy.app.driver_namespace['told'] = told\n"
        "def note(scene, *_):\n"
        "    bpy.app.driver_namespace['used'] = bpy.app.driver_namespace['told']()\n"
        "bpy.app.handlers.render_init[:] = [note]"
    )
    session.use(TOOL, **{**SMALL, "denoise": True})
    assert session.run("bpy.app.driver_namespace['used']") == used
    assert session.run("bpy.app.driver_namespace['told']()") == own


def test_cameras_bound_to_markers_are_used_unless_one_is_named(session: LiveSession) -> None:
    session.run(
        SCENE + "high = bpy.data.objects.new('High', camera.data.copy())\n"
        "high.location, high.rotation_euler = (0, -10, 2), camera.rotation_euler\n"
        "scene.collection.objects.link(high)\n"
        "scene.timeline_markers.new('a', frame=1).camera = camera\n"
        "scene.timeline_markers.new('b', frame=4).camera = high"
    )
    still = session.blender.folder.root / "renders" / "still.png"
    session.use(TOOL, **SMALL, frame=5)
    assert where(still)[1] == pytest.approx(-2, abs=0.1)
    session.use(TOOL, **SMALL, frame=5, camera="Camera")
    assert where(still)[1] == pytest.approx(0, abs=0.1)


def test_without_a_camera_it_says_how_to_add_one(session: LiveSession) -> None:
    with pytest.raises(Refusal, match="no camera") as refused:
        session.use(TOOL)
    session.run(str(refused.value).split("\n", 1)[1])
    assert session.use(TOOL, **SMALL).data["camera"] == "Camera"


def test_wrong_camera_is_refused_with_existing_names(session: LiveSession) -> None:
    session.run(SCENE)
    with pytest.raises(Refusal, match=r"'Cube' is not a camera.*'Camera'"):
        session.use(TOOL, camera="Cube")
    with pytest.raises(Refusal, match=r"no camera 'Nobody'.*'Camera'"):
        session.use(TOOL, camera="Nobody")


def test_uses_the_only_camera_with_a_note(session: LiveSession) -> None:
    session.run(SCENE + "scene.camera = None")
    found = session.use(TOOL, **SMALL)
    assert any("'Camera', the only camera" in note for note in found.data["notes"])
    assert session.run("bpy.context.scene.camera is None") is True


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"frame_start": 3}, "kind='animation'"),
        ({"kind": "animation", "frame": 3}, "kind='still'"),
        ({"width": 100, "percentage": 50}, "percentage"),
        ({"name": "../../out"}, "name"),
        ({"name": "a/b"}, "name"),
        ({"width": 100_000}, "width"),
        ({"samples": 0}, "samples"),
        ({"kind": "animation", "frame_start": 9, "frame_end": 3}, "must not be smaller than"),
        ({"kind": "animation", "frame_start": 0, "frame_end": 900_000}, "more than"),
    ],
)
def test_what_does_not_fit_is_refused(session: LiveSession, given: dict[str, Any], told: str) -> None:
    session.run(SCENE)
    with pytest.raises(Refusal, match=told):
        session.use(TOOL, **given)


def test_size_follows_scene_and_arguments(session: LiveSession) -> None:
    session.run(SCENE + "scene.render.resolution_x, scene.render.resolution_y = 200, 100")

    def size(**given: int) -> tuple[int, int]:
        found = session.use(TOOL, None, engine="cycles", samples=1, denoise=False, **given)
        with Image.open(found.data["path"]) as picture:
            return picture.size

    assert size(percentage=10) == (20, 10)
    assert size(width=50) == (50, 25)
    assert size(height=30) == (60, 30)


def test_a_black_picture_is_told(session: LiveSession) -> None:
    session.run(SCENE + "cube.hide_render = True")
    assert "black" in session.use(TOOL, **SMALL).data["warnings"][0]


# Films


def test_video_moves_and_can_be_read_back(session: LiveSession) -> None:
    session.run(MOVING + "scene.render.fps = 12")
    progress: list[tuple[float, float | None]] = []
    call = Call(lambda done, total, text: progress.append((done, total)))
    found = session.use(TOOL, call, **FILM)
    frames = session.blender.folder.root / "frames" / "animation"
    seen = [where(frames / f"{frame:04d}.png")[0] for frame in range(1, 6)]
    assert seen == pytest.approx([-2, -1, 0, 1, 2], abs=0.1)
    video = found.data["video"]
    assert (video["frames"], video["width"], video["height"], video["fps"]) == (5, 64, 64, 12)
    assert [(done, 5) for done in range(1, 6)] == [one for one in progress if one[0] % 1 == 0 and one[0]]
    assert len(found.pictures) == 3
    # H.264 in MP4 that starts at its first frame, with the colours of the pictures.
    film = session.blender.folder.root / "animation.mp4"
    data = film.read_bytes()
    assert data[4:8] == b"ftyp"
    assert b"avc1" in data
    shutil.copyfile(film, session.blender.folder.workspace.mount / "look.mp4")
    colour = session.run(
        "import os\nimage = bpy.data.images.load(os.path.abspath('look.mp4'))\n"
        "p = list(image.pixels)\nbpy.data.images.remove(image)\nos.remove('look.mp4')\n"
        "at = (32 * 64 + 16) * 4\n[round(v, 2) for v in p[at:at + 3]]"
    )
    assert colour == pytest.approx([1, 0, 0], abs=0.06)


def test_skipped_frames_are_repeated_in_the_video(session: LiveSession) -> None:
    session.run(MOVING)
    found = session.use(TOOL, **FILM, name="held", step=2)
    assert [*frame_files(session, "held")] == ["0001.png", "0003.png", "0005.png"]
    assert found.data["video"]["frames"] == 5


def test_frames_are_reused_until_scene_or_settings_change(session: LiveSession) -> None:
    session.run(MOVING)
    session.use(TOOL, **FILM, frame_end=2, video=False)
    first = frame_files(session)
    session.run("bpy.context.scene.frame_set(4)\nbpy.data.objects['Cube'].select_set(False)")
    found = session.use(TOOL, **FILM, frame_end=3, video=False)
    assert (found.data["kept"], found.data["made"]) == (2, 1)
    assert {name: stamp for name, stamp in frame_files(session).items() if name in first} == first
    session.run(
        "bpy.data.materials['Red'].node_tree.nodes['Emission'].inputs['Strength'].default_value = 0.5"
    )
    found = session.use(TOOL, **FILM, frame_end=2, video=False)
    assert found.data["discarded"] == {"frames": 3, "why": "Material Red changed"}
    assert "earlier state" in found.text
    assert [*frame_files(session)] == ["0001.png", "0002.png"]
    found = session.use(TOOL, None, **{**FILM, "samples": 2}, frame_end=1, video=False)
    assert found.data["discarded"]["why"] == "samples 1 → 2"


def test_incomplete_frames_are_rendered_again(session: LiveSession) -> None:
    session.run(MOVING)
    session.use(TOOL, **FILM, name="torn", frame_end=2, video=False)
    torn = session.blender.folder.root / "frames" / "torn" / "0001.png"
    whole = torn.read_bytes()
    torn.write_bytes(whole[:-20])
    found = session.use(TOOL, **FILM, name="torn", frame_end=2, video=False)
    assert (found.data["kept"], found.data["made"]) == (1, 1)
    assert where(torn)[0] == pytest.approx(-2, abs=0.1)


def test_cancelled_render_stops_between_frames_and_can_continue(session: LiveSession) -> None:
    session.run(MOVING)
    process = session.blender.pid
    found = session.use(TOOL, stopped_after(2), **FILM, name="cancelled")
    assert found.failed
    assert "Not finished" in found.text
    there = frame_files(session, "cancelled")
    assert [*there] == ["0001.png", "0002.png"]
    assert session.blender.pid == process
    found = session.use(TOOL, **FILM, name="cancelled")
    assert (found.data["kept"], found.data["made"], found.failed) == (2, 3, False)
    assert frame_files(session, "cancelled").items() >= there.items()


# Simulations


def test_unbaked_physics_is_stepped_and_reported(session: LiveSession) -> None:
    session.run(FALLING)
    still = session.blender.folder.root / "renders" / "still.png"
    found = session.use(TOOL, **SMALL, frame=16)
    assert found.data["unbaked"] == ["the rigid-body world"]
    assert "stepped from the first frame" in found.text
    # Free fall for 15 frames at 24 a second.
    assert where(still)[1] == pytest.approx(3 - 9.81 / 2 * (15 / 24) ** 2, abs=0.15)


def test_earlier_jumps_do_not_spoil_a_simulation(session: LiveSession) -> None:
    session.run(
        SCENE + "scene.render.engine = 'BLENDER_EEVEE'\ncube.hide_render = True\n"
        "bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=2, location=(0, 0, 3))\n"
        "cloth = bpy.context.object\ncloth.data.materials.append(material)\n"
        "cloth.rotation_euler.x = 0.5\ncloth.modifiers.new('Cloth', 'CLOTH')\nscene.frame_end = 13"
    )
    jumped: dict[str, Any] = {**FILM, "step": 6, "video": False, "width": 512, "height": 512}
    session.run("for frame in (1, 5, 1, 9):\n    bpy.context.scene.frame_set(frame)")
    session.use(TOOL, None, **jumped, name="jumped")
    assert session.run("bpy.context.scene.frame_current") == 9
    session.run("bpy.ops.ptcache.bake_all(bake=True)")
    baked = session.use(TOOL, None, **jumped, name="baked")
    assert baked.data["unbaked"] == []
    frames = session.blender.folder.root / "frames"
    for frame in ("0001.png", "0007.png", "0013.png"):
        with Image.open(frames / "jumped" / frame) as one, Image.open(frames / "baked" / frame) as other:
            assert one.tobytes() == other.tobytes(), frame
    assert where(frames / "jumped" / "0013.png")[1] < where(frames / "jumped" / "0001.png")[1] - 0.5


# What goes wrong


def test_survives_a_lost_blender_with_the_same_frames(
    own_session: LiveSession,
) -> None:
    own_session.run(FALLING)
    whole = own_session.use(TOOL, **FILM, name="whole", frame_end=6, video=False)
    # Handlers are not written to checkpoints: Blender ends only the first time.
    own_session.run(
        "import os, signal\n"
        "def end(scene, *_):\n"
        "    if scene.frame_current == 4:\n"
        "        os.kill(os.getpid(), signal.SIGKILL)\n"
        "bpy.app.handlers.render_pre.append(end)"
    )
    found = own_session.use(TOOL, **FILM, name="broken", frame_end=6, video=False)
    assert (found.failed, found.data["made"]) == (False, 6)
    assert any("lost during frame 4" in note for note in found.data["notes"])
    frames = own_session.blender.folder.root / "frames"
    heights = [where(frames / "broken" / f"{frame:04d}.png")[1] for frame in range(1, 7)]
    assert heights == [where(frames / "whole" / f"{frame:04d}.png")[1] for frame in range(1, 7)]
    assert heights[-1] < heights[0]
    assert whole.data["made"] == 6
    assert own_session.run("bpy.context.scene.frame_current") == 1


@pytest.mark.whole
def test_repeated_crashes_keep_finished_frames(own_session: LiveSession) -> None:
    own_session.run(MOVING)
    over = threading.Event()

    def kill() -> None:
        with suppress(ProcessLookupError):
            if own_session.blender.pid is not None:
                os.kill(own_session.blender.pid, signal.SIGKILL)

    def keep_killing() -> None:
        while not over.wait(0.005):
            kill()

    killer = threading.Thread(target=keep_killing)

    def progress(done: float, total: float | None, text: str) -> None:
        del total, text
        if done == 2:
            kill()
            killer.start()

    try:
        found: Result = own_session.use(TOOL, Call(progress), **FILM)
    finally:
        over.set()
        killer.join()
    made = found.data["made"]
    assert found.failed
    assert 2 <= made < 5
    assert "again with the same arguments" in found.text
    there = frame_files(own_session)
    found = own_session.use(TOOL, **FILM)
    assert (found.failed, found.data["kept"], found.data["made"]) == (False, made, 5 - made)
    assert frame_files(own_session).items() >= there.items()
    assert found.data["video"]["frames"] == 5


# A time budget


def test_a_time_budget_lowers_samples_and_such_frames_are_made_again_without_it(session: LiveSession) -> None:
    session.run(MOVING + "cube.scale = (9, 1, 9)")
    asked: dict[str, Any] = {**FILM, "samples": 60_000, "name": "hurried", "frame_end": 2}
    found = session.use(TOOL, **asked, time_budget=2)
    assert LEAST <= found.data["samples"] < 60_000
    assert "samples instead of 60000" in found.text
    assert found.data["video"]["frames"] == 2
    found = session.use(TOOL, **asked, time_budget=2)
    assert found.data["kept"] + found.data["made"] + found.data["dropped_count"] == 2
    assert found.data["kept"] >= 1
    call = Call()
    call.cancelled.set()
    found = session.use(TOOL, call, **asked)
    assert (found.data["kept"], found.data["missing_count"]) == (0, 2)


class Clock:
    """Time that passes as it is told to; frames take ``fixed`` seconds and ``seconds_per_frame`` for a sample."""

    def __init__(self, fixed: float, each: float) -> None:
        self.now = 0.0
        self._fixed, self._each = fixed, each

    def __call__(self) -> float:
        """Seconds."""
        return self.now

    def set(self, fixed: float, each: float) -> None:
        """From now on frames take this time."""
        self._fixed, self._each = fixed, each

    def render(self, samples: int | None) -> float:
        """Lets the time pass that a frame takes; returns it."""
        seconds = self._fixed + self._each * (samples or 0)
        self.now += seconds
        return seconds


def paced(clock: Clock, budget: float, samples: int | None, frames: int) -> list[int | None]:
    """The samples of the frames that are made within a budget."""
    budget = RenderBudget(budget, samples, clock)
    while (few := budget.next_trial(frames)) is not None:
        budget.add_trial(few, clock.render(few))
    made: list[int | None] = []
    dropped = 0
    while frames:
        budget.fit_samples(frames + dropped)
        wanted, frames = frames, budget.affordable(frames)
        dropped += wanted - frames
        if not frames:
            break
        budget.add_frame(budget.samples, clock.render(budget.samples))
        made.append(budget.samples)
        frames -= 1
    return made


def test_with_enough_time_nothing_is_lowered() -> None:
    assert paced(Clock(0.5, 0.01), 200, 128, 20) == [128] * 20


def test_a_first_frame_that_waited_does_not_make_samples_free() -> None:
    budget = RenderBudget(10, 60_000, Clock(0, 0))
    budget.add_trial(LEAST, 3.0)
    budget.add_trial(16, 0.8)
    budget.fit_samples(2)
    assert LEAST <= (budget.samples or 0) <= 100


def test_all_frames_get_the_same_lowered_samples() -> None:
    clock = Clock(0.5, 0.05)
    made = paced(clock, 60, 256, 20)
    assert made == [made[0]] * 20
    assert 32 <= (made[0] or 0) <= 50
    assert 45 < clock.now <= 63


def test_frames_are_dropped_only_at_the_least_samples() -> None:
    clock = Clock(2.0, 0.1)
    made = paced(clock, 30, 256, 24)
    assert set(made) == {LEAST}
    assert 6 <= len(made) <= 12
    assert clock.now <= 33


def test_samples_that_take_little_of_the_time_are_kept_where_frames_are_dropped_anyway() -> None:
    clock = Clock(2.0, 0.01)
    made = paced(clock, 30, 32, 24)
    assert set(made) == {32}
    assert 10 <= len(made) <= 13
    assert clock.now <= 33


def test_samples_are_raised_again_where_later_frames_take_half_the_time() -> None:
    clock = Clock(1.0, 1.0)
    budget = RenderBudget(600, 12, clock)
    budget.add_trial(LEAST, clock.render(LEAST))
    budget.add_trial(12, clock.render(12))
    made: list[int] = []
    for left in range(60, 0, -1):
        if left == 50:  # other programs have ended
            clock.set(0.4, 0.4)
        budget.fit_samples(left)
        assert budget.samples is not None
        made.append(budget.samples)
        budget.add_frame(budget.samples, clock.render(budget.samples))
    assert made[0] < 10
    assert made[-1] == 12
    assert clock.now <= 600
    assert len({*made}) <= 5


def test_frames_of_an_engine_without_samples_are_left_out() -> None:
    clock = Clock(1.0, 0.0)
    made = paced(clock, 10, None, 30)
    assert 5 <= len(made) <= 10
    assert clock.now <= 11


class Waiting:
    """Renders no picture: its first frames take long, as where other programs were busy, the later ones a second."""

    def __init__(self, clock: Clock, slow: int, samples: int | None = None) -> None:
        self._clock, self._slow = clock, slow
        self.shot = SimpleNamespace(samples=samples)
        self.told: list[tuple[int | None, float, float]] = []  # samples, and what they fill of the progress

    def render(
        self, number: int, samples: int | None, path: Path, span: tuple[float, float], total: int
    ) -> float:
        """Lets the time pass."""
        del number, total
        self.told.append((samples, *span))
        path.write_bytes(b"a picture")
        seconds = 10.0 if span[0] < self._slow else 1.0
        self._clock.now += seconds
        return seconds


class Kept(dict[int, RenderedFrame]):
    """Frames in a folder."""

    def __init__(self, folder: Path) -> None:
        super().__init__()
        self._folder = folder

    def path(self, number: int) -> Path:
        """Where a frame goes."""
        return self._folder / f"{number}.png"

    def add(self, number: int, frame: RenderedFrame) -> None:
        """Notes a frame."""
        self[number] = frame


@pytest.mark.parametrize(("seconds", "made"), [(45, 25), (80, 48), (130, 48)])
def test_frames_that_were_dropped_are_made_where_there_turns_out_to_be_time(
    tmp_path: Path, seconds: float, made: int
) -> None:
    clock = Clock(0, 0)
    budget = RenderBudget(seconds, None, clock)
    frames = list(range(1, 49))
    outcome = render_frames(Waiting(clock, 2), Kept(tmp_path), frames, Call(), budget)  # type: ignore[arg-type]
    assert made <= len(outcome.available) == 48 - len(outcome.dropped)
    assert clock.now <= seconds * 1.05
    assert made == 48 or clock.now >= seconds * 0.85  # the time is used


@pytest.mark.parametrize(("seconds", "slow"), [(45, 2), (20, 0), (12, 0)])
def test_frames_that_tell_what_happens_are_left_out_last(tmp_path: Path, seconds: float, slow: int) -> None:
    clock = Clock(0, 0)
    telling = [1, 18, 19, 40]
    outcome = render_frames(
        Waiting(clock, slow),  # type: ignore[arg-type]
        Kept(tmp_path),  # type: ignore[arg-type]
        list(range(1, 49)),
        Call(),
        RenderBudget(seconds, None, clock),
        telling=telling,
    )
    assert outcome.dropped
    assert {*telling} <= {*outcome.available}


def test_a_little_too_little_time_costs_a_few_frames_evenly_apart(tmp_path: Path) -> None:
    clock = Clock(0, 0)
    frames = list(range(1, 145))
    budget = RenderBudget(120, None, clock)
    outcome = render_frames(Waiting(clock, 0), Kept(tmp_path), frames, Call(), budget)  # type: ignore[arg-type]
    assert 115 <= len(outcome.available) <= 126
    assert max(after - before for before, after in itertools.pairwise(outcome.available)) <= 3
    assert outcome.available[0] == 1


def test_progress_of_a_still_goes_on_after_its_trials(tmp_path: Path) -> None:
    clock = Clock(0, 0)
    renderer = Waiting(clock, 1, samples=4096)
    render_frames(renderer, Kept(tmp_path), [1], Call(), RenderBudget(200, 4096, clock))  # type: ignore[arg-type]
    *trials, (_, begins, ends) = renderer.told
    assert trials
    assert all(end <= 0.1 for _, _, end in trials)
    assert begins == trials[-1][2]
    assert ends > 0.9


def test_one_frame_is_made_however_short_the_time(session: LiveSession) -> None:
    session.run(MOVING)
    big: dict[str, Any] = {**FILM, "engine": "cycles", "samples": 4000, "width": 400, "height": 400}
    found = session.use(TOOL, None, **big, name="short", time_budget=1)
    there = [*frame_files(session, "short")]
    assert there[0] == "0001.png"
    assert len(there) + found.data["dropped_count"] == 5
    assert found.data["samples"] < 4000
    assert found.data["video"]["frames"] == 5


def test_a_still_is_told_in_numbers(session: LiveSession) -> None:
    session.run(
        SCENE
        + "bpy.ops.mesh.primitive_cube_add(size=.5, location=(0, 3, 0)); bpy.context.object.name = 'Hidden'"
    )
    found = session.use(TOOL, None, **SMALL)
    (picture,) = found.data["pictures"]
    assert picture["frame"] == 1
    assert picture["black"] == pytest.approx(63 / 64, abs=0.01)  # the cube is 1 m in a view of 8 × 8 m
    assert picture["burnt_out"] == picture["middle"] == 0
    assert picture["bright"] == pytest.approx(0, abs=0.01)
    subjects = {one["name"]: one for one in found.data["subjects"]}
    assert subjects["Cube"]["share"] == pytest.approx(1 / 64, abs=0.003)
    assert subjects["Cube"]["brightness"] == pytest.approx(0.3, abs=0.05)  # of pure red
    assert subjects["Hidden"]["share"] == 0
    assert "shows nothing of Hidden" in found.text
    assert "98 % black" in found.text


def test_what_is_burnt_out_is_told(session: LiveSession) -> None:
    session.run(SCENE + "glow.inputs['Color'].default_value = (9, 9, 9, 1); cube.scale = (4, 1, 8)")
    found = session.use(TOOL, None, **SMALL)
    assert found.data["pictures"][0]["burnt_out"] == pytest.approx(0.5, abs=0.03)
    assert found.data["subjects"][0]["brightness"] == pytest.approx(1, abs=0.02)


def test_what_is_seen_through_glass_is_not_said_to_be_hidden(session: LiveSession) -> None:
    session.run(
        SCENE
        + """
bpy.ops.mesh.primitive_cube_add(size=.2)
bpy.context.object.name = "Inside"
glass = bpy.data.materials.new("Glass")
glass.use_nodes = True
glass.node_tree.nodes["Principled BSDF"].inputs["Transmission Weight"].default_value = 1.0
cube.data.materials.clear()
cube.data.materials.append(glass)
"""
    )
    found = session.use(TOOL, None, **SMALL)
    assert "shows nothing of Inside, but for what is seen through Cube" in found.text


def test_subjects_are_the_objects_of_the_protocol(session: LiveSession) -> None:
    session.run(
        SCENE + "bpy.ops.mesh.primitive_cube_add(size=1, location=(2, 0, 0))\n"
        "pair = bpy.data.collections.new('Pair'); pair['protocol_role'] = 'object'\n"
        "scene.collection.children.link(pair)\n"
        "for one in (cube, bpy.context.object):\n"
        "    for old in list(one.users_collection): old.objects.unlink(one)\n"
        "    pair.objects.link(one)"
    )
    found = session.use(TOOL, None, **SMALL)
    assert [one["name"] for one in found.data["subjects"]] == ["Pair"]
    assert found.data["subjects"][0]["share"] == pytest.approx(2 / 64, abs=0.005)


def test_a_film_is_told_in_numbers_at_its_start_middle_and_end(session: LiveSession) -> None:
    session.run(MOVING)
    found = session.use(TOOL, None, **FILM)
    assert [one["frame"] for one in found.data["pictures"]] == [1, 3, 5]
    assert found.data["subjects_frame"] == 5


# Pictures for a model


@pytest.fixture(scope="module")
def decoder() -> Iterator[PictureDecoder]:
    with closing(PictureDecoder(best_sandbox())) as opened:
        yield opened


def test_large_pictures_are_shown_smaller(tmp_path: Path, decoder: PictureDecoder) -> None:
    for width, shown in ((1600, LARGEST_PREVIEW), (160, 160)):
        Image.new("RGB", (width, width // 4), (10, 90, 30)).save(tmp_path / "made.png")
        with Image.open(io.BytesIO(look_at(decoder, tmp_path / "made.png").png)) as picture:
            assert picture.size == (shown, shown // 4)
            assert picture.getpixel((5, 5)) == (10, 90, 30)


def test_reports_empty_or_unchanging_images(tmp_path: Path, decoder: PictureDecoder) -> None:
    scene = Image.linear_gradient("L")
    for name, picture in (
        ("plain", Image.new("RGB", (20, 20), (90, 90, 90))),
        ("dark", Image.new("RGB", (20, 20), (3, 6, 0))),
        ("scene", scene),
        ("again", scene),
        ("other", scene.rotate(90)),
    ):
        picture.save(tmp_path / f"{name}.png")
    seen = {path.stem: look_at(decoder, path) for path in tmp_path.glob("*.png")}
    assert "plain.png is one colour" in image_faults([seen["plain"]])[0]
    assert "dark.png is black" in image_faults([seen["dark"]])[0]
    assert "identical" in image_faults([seen["scene"], seen["again"]])[0]
    assert image_faults([seen["scene"], seen["again"], seen["other"]]) == []
    assert image_faults([seen["scene"]]) == []
