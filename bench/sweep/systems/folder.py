"""The system ``folder=DIR``: files that anybody made, one .blend a scene.

``DIR/<scene id>.blend``, or the one .blend in ``DIR/<scene id>/`` (of several: ``<scene id>.blend`` or
``scene.blend``). A video beside it (a picture of a static scene) of the same name, or called ``video`` or ``still``,
is what the judge sees; without one, the .blend is rendered. A ``made.json`` beside it, or ``<scene id>.json``, may tell
what the scene took: ``{"model": "…", "cost": 1.2, "minutes": 30}``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, NonNegativeFloat, ValidationError

from bench.frames.video import PICTURES, VIDEOS
from bench.scenes.spec import FOLDER
from bench.sweep.content_hash import digests, files_below
from bench.sweep.systems.system import Made, NotReady

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from bench.scenes.spec import Spec
    from bench.sweep.records import SystemInfo

_CACHES = "blendcache_"


class Told(BaseModel):
    """What a ``made.json`` may tell. Other fields are passed over."""

    model_config = ConfigDict(frozen=True)

    model: str = ""
    cost: NonNegativeFloat | None = None
    minutes: NonNegativeFloat | None = None


@dataclass(frozen=True)
class Folder:
    """Files in ``source``."""

    info: SystemInfo
    source: Path

    def ready(self) -> None:
        """Raises NotReady."""
        if not self.source.is_dir():
            raise NotReady(f"{self.source} is not a folder.")

    def is_for(self, spec: Spec) -> bool:
        """Any scene: one whose file is missing is counted as such."""
        del spec
        return True

    def depends_on(self, spec: Spec) -> dict[str, str]:
        """The content of its files."""
        return digests(self.source, self.files(spec))

    def files(self, spec: Spec) -> list[Path]:
        """All in its own folder; of a file in the common one, all there but what is another scene's by its name."""
        if not (self.source / f"{spec.id}.blend").is_file():
            own = self.source / spec.id
            return files_below(own) if own.is_dir() else []
        others = {path.stem for path in FOLDER.glob("*.yaml")} - {spec.id}
        return [
            path
            for entry in sorted(self.source.iterdir())
            if entry.name.removeprefix(_CACHES).partition(".")[0] not in others
            for path in (files_below(entry) if entry.is_dir() else [entry])
        ]

    def produce(self, spec: Spec, place: Path, tell: Callable[[str], object]) -> Made:
        """Takes what is there."""
        del place, tell
        try:
            blend = self._blend(spec)
        except ValueError as error:
            return Made("missing", spec.prompt, str(error))
        if blend is None:
            return Made("missing", spec.prompt, "no file")
        told = _told((blend.with_name("made.json"), blend.with_name(f"{spec.id}.json")))
        models = {"model": told.model} if told.model else {}
        kinds = PICTURES if spec.category == "static" else VIDEOS
        video = _first(
            blend.with_name(f"{stem}{kind}") for stem in _stems(blend, spec) for kind in (*VIDEOS, *kinds)
        )
        return Made("taken", spec.prompt, "", blend, video, models, told.cost, told.minutes)

    def _blend(self, spec: Spec) -> Path | None:
        """Raises ValueError where several might be meant."""
        own = self.source / spec.id
        named = (self.source / f"{spec.id}.blend", own / f"{spec.id}.blend", own / "scene.blend")
        if (found := _first(named)) is not None:
            return found
        several = sorted(path for path in own.glob("*.blend") if path.is_file())
        if len(several) > 1:
            raise ValueError(f"several .blend files, and none is called {spec.id}.blend or scene.blend")
        return several[0] if several else None


def _stems(blend: Path, spec: Spec) -> tuple[str, ...]:
    return (blend.stem, spec.id, *(("video", "still") if blend.parent.name == spec.id else ()))


def _first(paths: Iterable[Path]) -> Path | None:
    return next((path for path in paths if path.is_file()), None)


def _told(paths: Iterable[Path]) -> Told:
    path = _first(paths)
    try:
        return Told.model_validate_json(path.read_bytes()) if path is not None else Told()
    except (OSError, ValidationError):
        return Told()
