"""Frames of a .blend as its camera sees the clip, of a video, of a picture: five of a clip, one of a static scene."""

from __future__ import annotations

import shutil
from fractions import Fraction
from typing import TYPE_CHECKING

import av
import numpy
import pytest
from in_blender import run
from PIL import Image

from bench.audit.untrusted_blend import NotScored
from bench.frames import video
from bench.frames.clip_frames import RenderQuality, frames_of, take_frames

if TYPE_CHECKING:
    from pathlib import Path

    from bench.frames.clip_frames import FrameSet

RED, GREEN, BLUE = (255, 0, 0), (0, 255, 0), (0, 0, 255)
SMALL = RenderQuality(pixels=64 * 36, samples=1)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("frames")
    run("frame_scenes.py", place)
    return place


def taken(name: str, files: Path, folder: Path, *, static: bool = False) -> FrameSet:
    """The frames of a file; nothing is written beside it."""
    before = sorted(files.iterdir())
    found = take_frames(files / f"{name}.blend", static, folder, SMALL)
    assert sorted(files.iterdir()) == before
    return found


def colour(path: Path, x: float = 0.5, y: float = 0.5) -> tuple[int, int, int]:
    """The nearest pure colour at a place of a picture."""
    with Image.open(path) as image:
        pixel = image.convert("RGB").getpixel((int(x * image.width), int(y * image.height)))
    assert isinstance(pixel, tuple)
    red, green, blue = (255 * round(value / 255) for value in pixel)
    return red, green, blue


def written(path: Path, count: int, size: tuple[int, int] = (64, 36)) -> Path:
    """A video whose frames get brighter, evenly."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=Fraction(24))
        stream.width, stream.height, stream.pix_fmt = *size, "yuv420p"
        for number in range(count):
            grey = numpy.full((size[1], size[0], 3), round(255 * number / max(1, count - 1)), numpy.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(grey, format="rgb24")))
        container.mux(stream.encode())
    return path


def brightness(paths: tuple[Path, ...]) -> list[float]:
    return [round(float(numpy.asarray(Image.open(path)).mean()) / 255, 1) for path in paths]


# Of a .blend


@pytest.mark.blender
def test_five_frames_are_taken_evenly_from_the_first_to_the_last(files: Path, tmp_path: Path) -> None:
    found = taken("keyed", files, tmp_path)
    assert [path.name for path in found.paths] == ["000.png", "025.png", "050.png", "075.png", "100.png"]
    for place, path in enumerate(found.paths):
        where = [0.02 + 0.24 * share for share in range(5)]
        assert [colour(path, x) == RED for x in where] == [share == place for share in range(5)]
    assert found.notes == ()


@pytest.mark.blender
def test_each_frame_is_told_while_it_is_rendered(files: Path, tmp_path: Path) -> None:
    told: list[str] = []
    take_frames(files / "keyed.blend", False, tmp_path, SMALL, tell=told.append)
    assert told == [f"rendering frame {number} of 5" for number in range(1, 6)]


@pytest.mark.blender
def test_a_static_scene_has_one_frame_and_older_frames_are_deleted(files: Path, tmp_path: Path) -> None:
    (tmp_path / "100.png").touch()
    found = taken("square", files, tmp_path, static=True)
    assert [path.name for path in found.paths] == ["000.png"]
    assert sorted(tmp_path.iterdir()) == list(found.paths)
    with Image.open(found.paths[0]) as image:
        assert image.size == (48, 48)
    assert {colour(found.paths[0], *place) for place in ((0.05, 0.05), (0.9, 0.9))} == {RED}


@pytest.mark.blender
def test_unbaked_physics_is_simulated_while_rendering_and_noted(files: Path, tmp_path: Path) -> None:
    found = taken("unbaked", files, tmp_path / "unbaked")
    seen = [colour(path) for path in found.paths]
    assert (seen[0], seen[-1]) == (GREEN, BLUE)
    assert seen == [colour(path) for path in taken("baked", files, tmp_path / "baked").paths]
    assert found.notes == ("not baked, simulated while rendering: cloth of Cloth",)


@pytest.mark.blender
def test_physics_that_takes_too_long_is_left_out_and_noted(files: Path, tmp_path: Path) -> None:
    found = taken("endless", files, tmp_path)
    assert {colour(path) for path in found.paths} == {GREEN}
    (note,) = found.notes
    assert note.startswith("rendered without unbaked physics, after a first try failed (9,000 frames")


@pytest.mark.blender
def test_a_missing_camera_is_added_so_that_it_sees_all_but_the_ground(files: Path, tmp_path: Path) -> None:
    found = taken("no_camera", files, tmp_path, static=True)
    assert found.notes == ("the scene has no camera; one that sees all of it was added",)
    with Image.open(found.paths[0]) as image:
        pixels = numpy.asarray(image.convert("RGB")).astype(int)
    for dominant in (0, 1):
        others = numpy.delete(pixels, dominant, axis=2).max(axis=2)
        tile = numpy.argwhere((pixels[..., dominant] > 200) & (others < 60))
        assert len(tile) > 30
        assert tile.min() > 0
    edge = numpy.concatenate([pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]])
    assert (edge[:, 2] > edge[:, 0]).all()


@pytest.mark.blender
def test_sequencer_strips_do_not_cover_the_scene(files: Path, tmp_path: Path) -> None:
    assert colour(taken("strips", files, tmp_path, static=True).paths[0]) == RED


def test_a_file_that_is_not_a_blend_has_no_frames(tmp_path: Path) -> None:
    (tmp_path / "scene.blend").write_bytes(b"PK\x03\x04 a zip")
    with pytest.raises(NotScored, match=r"not a \.blend"):
        frames_of(tmp_path / "scene.blend", False, tmp_path / "frames")
    assert not (tmp_path / "frames").exists()


# Of a video or a picture


@pytest.mark.parametrize(
    ("count", "wanted"), [(25, [0, 0.2, 0.5, 0.8, 1]), (1, [0] * 5), (5, [0, 0.2, 0.5, 0.8, 1])]
)
def test_frames_of_a_video_are_counted_not_guessed(count: int, wanted: list[float], tmp_path: Path) -> None:
    found = take_frames(written(tmp_path / "clip.mp4", count), False, tmp_path / "frames")
    assert found.source == "video"
    assert brightness(found.paths) == pytest.approx(wanted, abs=0.11)


def test_frames_of_a_large_video_are_shrunk(tmp_path: Path) -> None:
    paths = frames_of(written(tmp_path / "clip.mp4", 2, (1920, 1080)), True, tmp_path / "frames")
    with Image.open(paths[0]) as image:
        assert image.size == (1280, 720)


def test_a_picture_is_accepted_for_a_static_scene_only(tmp_path: Path) -> None:
    Image.new("RGB", (40, 20), RED).save(tmp_path / "still.png")
    (only,) = frames_of(tmp_path / "still.png", True, tmp_path / "frames")
    assert colour(only) == RED
    with pytest.raises(NotScored, match="a picture has one frame only"):
        frames_of(tmp_path / "still.png", False, tmp_path / "frames")


@pytest.mark.parametrize("name", ["noise.mp4", "noise.png", "half.mp4", "tune.mkv"])
def test_a_file_that_cannot_be_decoded_is_reported(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(b"\x00\x00\x00\x18ftypmp42 and then nothing that anybody could read" * 9)
    if name == "half.mp4":
        whole = written(tmp_path / "whole.mp4", 25).read_bytes()
        path.write_bytes(whole[: len(whole) // 2])
    if name == "tune.mkv":
        with av.open(str(path), "w") as container:
            stream = container.add_stream("pcm_s16le", rate=8000, layout="mono")
            sound = av.AudioFrame.from_ndarray(numpy.zeros((1, 800), numpy.int16), layout="mono")
            sound.sample_rate = 8000
            container.mux(stream.encode(sound))
    with pytest.raises(NotScored, match="cannot be decoded"):
        frames_of(path, name == "noise.png", tmp_path / "frames")


def test_a_decoder_reads_nothing_but_the_file_and_writes_nothing_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A decoder that has been taken over, which is what the confinement is for."""
    secret, source = tmp_path / "secret", tmp_path / "clip" / "clip.mp4"
    secret.write_text("a key")
    source.parent.mkdir()
    source.write_bytes(b"video")
    taken_over = tmp_path / "script" / "decode.py"
    taken_over.parent.mkdir()
    taken_over.write_text(
        "import os, socket, sys\n"
        "done = []\n"
        f"for act in (lambda: open({str(secret)!r}).read(), lambda: open({str(source)!r}, 'ab').close(),\n"
        "            lambda: socket.socket(), lambda: os.fork()):\n"
        "    try:\n"
        "        act()\n"
        "        done.append(act.__code__.co_firstlineno)\n"
        "    except OSError:\n"
        "        pass\n"
        "os.symlink('/etc/passwd', sys.argv[2] + '/0.png')\n"
        "sys.exit(f'did {done}' if done else 0)\n"
    )
    monkeypatch.setattr(video, "_SCRIPT", taken_over)
    with pytest.raises(NotScored, match="a decoded frame is not a picture"):
        frames_of(source, True, tmp_path / "frames")


def test_frames_of_a_moved_file_are_not_those_of_another(tmp_path: Path) -> None:
    path = written(tmp_path / "clip.mp4", 3)
    shutil.move(path, tmp_path / "other.mp4")
    with pytest.raises(NotScored, match=r"there is no file clip\.mp4"):
        frames_of(path, False, tmp_path / "frames")
