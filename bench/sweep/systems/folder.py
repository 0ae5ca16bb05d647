"""The system ``folder=DIR``: existing files, one .blend for each scene.

``DIR/<scene id>.blend``, or the one .blend in ``DIR/<scene id>/`` (of several: ``<scene id>.blend`` or
``scene.blend``). A video beside it (a picture of a static scene) of the same name, or called ``video`` or ``still``,
is shown to the judge; without one, the .blend is rendered. A ``made.json`` beside it, or ``<scene id>.json``, may
state model, cost and time: ``{"model": "…", "cost": 1.2, "minutes": 30}``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, NonNegativeFloat, ValidationError

from bench.frames.video import PICTURES, VIDEOS
from bench.scenes.spec import FOLDER
from bench.sweep.content_hash import digests, files_below
from bench.sweep.systems.system import SystemNotReady, SystemOutput

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from bench.scenes.spec import Spec
    from bench.sweep.records import SystemInfo

_CACHES = "blendcache_"


class MadeInfo(BaseModel):
    """The contents of a ``made.json``. Other fields are ignored."""

    model_config = ConfigDict(frozen=True)

    model: str = ""
    cost: NonNegativeFloat | None = None
    minutes: NonNegativeFloat | None = None


@dataclass(frozen=True)
class FolderSystem:
    """Files in ``source``."""

    info: SystemInfo
    source: Path

    def ready(self) -> None:
        """Raises SystemNotReady."""
        if not self.source.is_dir():
            raise SystemNotReady(f"{self.source} is not a folder.")
        names = _scene_ids()
        if not any(entry.stem in names for entry in self.source.iterdir()):
            raise SystemNotReady(
                f"{self.source} has no file or folder of any scene. A file is called as its scene's id, "
                f"{min(names)}.blend; 'simworlds bench list' lists them."
            )

    def is_for(self, spec: Spec) -> bool:
        """True: a scene whose file is missing is counted as missing."""
        del spec
        return True

    def depends_on(self, spec: Spec) -> dict[str, str]:
        """The content of its files."""
        return digests(self.source, self.files(spec))

    def files(self, spec: Spec) -> list[Path]:
        """All files in the scene's folder; in the common folder, all but those named after other scenes."""
        if not (self.source / f"{spec.id}.blend").is_file():
            own = self.source / spec.id
            return files_below(own) if own.is_dir() else []
        others = _scene_ids() - {spec.id}
        return [
            path
            for entry in sorted(self.source.iterdir())
            if entry.name.removeprefix(_CACHES).partition(".")[0] not in others
            for path in (files_below(entry) if entry.is_dir() else [entry])
        ]

    def produce(self, spec: Spec, place: Path, tell: Callable[[str], object]) -> SystemOutput:
        """Takes the existing files."""
        del place, tell
        try:
            blend = self._blend(spec)
        except ValueError as error:
            return SystemOutput("missing", spec.prompt, str(error))
        if blend is None:
            return SystemOutput("missing", spec.prompt, "no file")
        info = _made_info((blend.with_name("made.json"), blend.with_name(f"{spec.id}.json")))
        models = {"model": info.model} if info.model else {}
        kinds = PICTURES if spec.category == "static" else VIDEOS
        video = _first(
            blend.with_name(f"{stem}{kind}") for stem in _stems(blend, spec) for kind in (*VIDEOS, *kinds)
        )
        return SystemOutput("taken", spec.prompt, "", blend, video, models, info.cost, info.minutes)

    def _blend(self, spec: Spec) -> Path | None:
        """The scene's file, or None. Raises ValueError if several are possible."""
        own = self.source / spec.id
        named = (self.source / f"{spec.id}.blend", own / f"{spec.id}.blend", own / "scene.blend")
        if (path := _first(named)) is not None:
            return path
        several = sorted(path for path in own.glob("*.blend") if path.is_file())
        if len(several) > 1:
            raise ValueError(f"several .blend files, none of them called {spec.id}.blend or scene.blend")
        return several[0] if several else None


def _stems(blend: Path, spec: Spec) -> tuple[str, ...]:
    return (blend.stem, spec.id, *(("video", "still") if blend.parent.name == spec.id else ()))


def _first(paths: Iterable[Path]) -> Path | None:
    return next((path for path in paths if path.is_file()), None)


def _made_info(paths: Iterable[Path]) -> MadeInfo:
    path = _first(paths)
    try:
        return MadeInfo.model_validate_json(path.read_bytes()) if path is not None else MadeInfo()
    except (OSError, ValidationError):
        return MadeInfo()


def _scene_ids() -> set[str]:
    """The benchmark's scenes, whose specifications are not read for that."""
    return {path.stem for path in FOLDER.glob("*.yaml")}
