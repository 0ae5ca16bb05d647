"""The rendered frames of one name, and beside them what they were made of: which of them may stand for new ones."""

from __future__ import annotations

import json
import re
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from simworlds.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

NOTES = "made_of.json"
_FRAME = re.compile(r"(-?\d{3,})\.png")
_PNG_END = b"IEND\xaeB`\x82"
_NAMED = 6


@dataclass(frozen=True, slots=True)
class Made:
    """How a frame was made: ``samples`` (None where the engine has none), ``seconds``, ``bytes`` of its file.

    ``trial``: only to see how long it takes.
    """

    samples: int | None
    seconds: float
    bytes: int
    trial: bool = False


class Reel:
    """``folder`` with frames as 0001.png. ``scene`` tells each data-block's state, ``settings`` the shot's.

    Frames of another state or with other settings are removed at once; ``stale`` tells how many, and ``why``.
    """

    def __init__(self, folder: Path, scene: dict[str, str], settings: dict[str, Any]) -> None:
        self.folder = folder
        self.stale = 0
        self.why = ""
        self._scene = scene
        self._settings = settings
        self._made: dict[int, Made] = {}
        folder.mkdir(parents=True, exist_ok=True)
        before = _read(folder / NOTES)
        self.why = _difference(before, scene, settings)
        if not self.why:
            self._made = {frame: made for frame, made in _frames(before) if self._is_whole(frame, made)}
        for path in folder.glob("*.png"):
            found = _FRAME.fullmatch(path.name)
            if found and int(found[1]) not in self._made:
                path.unlink(missing_ok=True)
                self.stale += 1
        self._write()

    def path(self, frame: int) -> Path:
        """Where a frame lies."""
        return self.folder / f"{frame:04d}.png"

    def made(self, frame: int) -> Made | None:
        """How a frame was made; None if it is not there."""
        return self._made.get(frame)

    def frames(self) -> list[int]:
        """All that are there."""
        return sorted(self._made)

    def add(self, frame: int, made: Made) -> None:
        """A frame has been put to its place."""
        self._made[frame] = made
        self._write()

    def _is_whole(self, frame: int, made: Made) -> bool:
        path = self.path(frame)
        try:
            if path.stat().st_size != made.bytes:
                return False
            with path.open("rb") as file:
                file.seek(-len(_PNG_END), 2)
                return file.read() == _PNG_END
        except OSError:
            return False

    def _write(self) -> None:
        notes = {
            "settings": self._settings,
            "frames": {str(frame): asdict(made) for frame, made in sorted(self._made.items())},
            "scene": self._scene,
        }
        write_whole(self.folder / NOTES, json.dumps(notes, indent=0), durable=False)


def _read(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text())
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _frames(notes: dict[str, Any]) -> Iterator[tuple[int, Made]]:
    frames: dict[str, dict[str, Any]] = notes.get("frames", {})
    for frame, made in frames.items():
        try:
            yield int(frame), Made(**made)
        except (TypeError, ValueError):
            continue


def _difference(before: dict[str, Any], scene: dict[str, str], settings: dict[str, Any]) -> str:
    """In words, what is not as it was; "" if all is."""
    if not before:
        return "nothing tells what they were made of"
    settings_before: dict[str, Any] = before.get("settings", {})
    changed = [
        f"{name} {settings_before.get(name)} → {settings.get(name)}"
        for name in sorted({*settings, *settings_before})
        if settings_before.get(name) != settings.get(name)
    ]
    scene_before: dict[str, str] = before.get("scene", {})
    # Other settings show in the scene's own state, too.
    skipped = "Scene " if changed else None
    for key in sorted({*scene, *scene_before}):
        if scene_before.get(key) == scene.get(key) or (skipped and key.startswith(skipped)):
            continue
        word = "changed" if key in scene and key in scene_before else "is new" if key in scene else "is gone"
        changed.append(f"{key} {word}")
    more = f" and {len(changed) - _NAMED} more" if len(changed) > _NAMED else ""
    return ", ".join(changed[:_NAMED]) + more
