"""Files as a system leaves them, and the commands that sweep over them as processes of their own."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

HERE = Path(__file__).parent
# What makes scenes in Blender, and the judges' server.
sys.path += [str(HERE.parent), str(HERE.parent / "judge")]

from in_blender import run  # noqa: E402
from made_once import made_once  # noqa: E402
from PIL import Image  # noqa: E402
from sweeping import Command  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a system made: a cloth, keys instead of one, nothing, something that is no .blend, and a still room."""
    return made_once(tmp_path_factory, "swept", _make)


def _make(top: Path) -> Path:
    place, folder = top / "scenes", top / "made"
    for each in (place, folder):
        each.mkdir()
    run("frame_scenes.py", place)
    shutil.copy(place / "baked.blend", folder / "cloth_D1_01.blend")
    (folder / "cloth_D1_02").mkdir()
    shutil.copy(place / "keyed.blend", folder / "cloth_D1_02" / "anything.blend")
    (folder / "cloth_D1_02" / "made.json").write_text('{"model": "a-model", "cost": 0.5, "minutes": 3}')
    (folder / "rigid_D1_01.blend").write_bytes(b"PK\x03\x04 a zip")
    shutil.copy(place / "square.blend", folder / "static_D1_01.blend")
    Image.new("RGB", (64, 36), (200, 100, 50)).save(folder / "static_D1_01.png")
    return folder


@pytest.fixture
def command(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[..., Command]]:
    """Starts ``simworlds bench``; nothing of it outlives the test."""
    home = tmp_path_factory.mktemp("home")
    started: list[Command] = []

    def start(*words: object, **environment: str) -> Command:
        started.append(Command(home, *words, **environment))
        return started[-1]

    yield start
    for one in started:
        one.kill()
