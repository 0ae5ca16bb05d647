"""Rendered frames of one name on disk, with what they were made of, so that later calls reuse those still valid."""

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
_PARTS = ("settings", "frames", "scene")


@dataclass(frozen=True, slots=True)
class RenderedFrame:
    """How a frame was made: ``samples`` (None if the engine has none), ``seconds``, ``bytes`` of its file.

    ``trial``: rendered only to measure the time.
    """

    samples: int | None
    seconds: float
    bytes: int
    trial: bool = False


class FrameCache:
    """Frames in ``folder`` as 0001.png. ``scene`` is a digest of each data-block, ``settings`` describes the shot.

    Frames made of another scene or with other settings are removed at once; ``removed`` counts them, ``why`` explains.
    """

    def __init__(self, folder: Path, scene: dict[str, str], settings: dict[str, Any]) -> None:
        self.folder = folder
        self.removed = 0
        self._scene = scene
        self._settings = settings
        self._frames: dict[int, RenderedFrame] = {}
        folder.mkdir(parents=True, exist_ok=True)
        notes = _read(folder / NOTES)
        self.why = _difference(notes, scene, settings)
        if not self.why:
            self._frames = {
                number: frame for number, frame in _frames(notes) if self._is_whole(number, frame)
            }
        for path in folder.glob("*.png"):
            match = _FRAME.fullmatch(path.name)
            if match and int(match[1]) not in self._frames:
                path.unlink(missing_ok=True)
                self.removed += 1
        self._write()

    def path(self, number: int) -> Path:
        """The file of a frame."""
        return self.folder / f"{number:04d}.png"

    def get(self, number: int) -> RenderedFrame | None:
        """How a frame was made; None if it is not here."""
        return self._frames.get(number)

    def add(self, number: int, frame: RenderedFrame) -> None:
        """Notes that a frame's file has been written."""
        self._frames[number] = frame
        self._write()

    def _is_whole(self, number: int, frame: RenderedFrame) -> bool:
        path = self.path(number)
        try:
            if path.stat().st_size != frame.bytes:
                return False
            with path.open("rb") as file:
                file.seek(-len(_PNG_END), 2)
                return file.read() == _PNG_END
        except OSError:
            return False

    def _write(self) -> None:
        notes = {
            "settings": self._settings,
            "frames": {str(number): asdict(frame) for number, frame in sorted(self._frames.items())},
            "scene": self._scene,
        }
        write_whole(self.folder / NOTES, json.dumps(notes, indent=0), durable=False)


def _read(path: Path) -> dict[str, Any]:
    """The notes; empty where they are of another shape than those that are written."""
    try:
        notes = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    is_whole = isinstance(notes, dict) and all(isinstance(notes.get(part), dict) for part in _PARTS)
    return notes if is_whole else {}


def _frames(notes: dict[str, Any]) -> Iterator[tuple[int, RenderedFrame]]:
    frames: dict[str, dict[str, Any]] = notes.get("frames", {})
    for number, frame in frames.items():
        try:
            yield int(number), RenderedFrame(**frame)
        except (TypeError, ValueError):
            continue


def _difference(notes: dict[str, Any], scene: dict[str, str], settings: dict[str, Any]) -> str:
    """What has changed since the frames were made, in words; "" if nothing has."""
    if not notes:
        return "it is not recorded what they were made of"
    settings_before: dict[str, Any] = notes.get("settings", {})
    changed = [
        f"{name} {settings_before.get(name)} → {settings.get(name)}"
        for name in sorted({*settings, *settings_before})
        if settings_before.get(name) != settings.get(name)
    ]
    scene_before: dict[str, str] = notes.get("scene", {})
    # Changed settings also show in the scene data-block's own digest.
    skipped = "Scene " if changed else None
    for key in sorted({*scene, *scene_before}):
        if scene_before.get(key) == scene.get(key) or (skipped and key.startswith(skipped)):
            continue
        word = "changed" if key in scene and key in scene_before else "is new" if key in scene else "is gone"
        changed.append(f"{key} {word}")
    more = f" and {len(changed) - _NAMED} more" if len(changed) > _NAMED else ""
    return ", ".join(changed[:_NAMED]) + more
