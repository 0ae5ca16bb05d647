"""The task of scoring one scene by one system. Plain data: it is sent to other processes, on other machines too."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from bench.audit.untrusted_blend import BlenderOptions
from bench.frames.clip_frames import RenderQuality

if TYPE_CHECKING:
    from pathlib import Path

    from bench.scenes.spec import Spec
    from bench.sweep.records import File
    from bench.sweep.systems.system import SceneSystem

Tell: TypeAlias = Callable[[str], None]
STEP_NAMES = ("produce", "audit", "frames")


@dataclass(frozen=True)
class SceneTask:
    """Scores one scene by one system.

    ``folder`` is the scene's in the results. ``steps``: names of those that may be done. ``from_video``: frames are
    those of the system's own video, where it brought one.
    """

    spec: Spec
    system: SceneSystem
    folder: Path
    means: BlenderOptions = field(default_factory=BlenderOptions)
    look: RenderQuality = field(default_factory=RenderQuality)
    steps: tuple[str, ...] = STEP_NAMES
    from_video: bool = True

    @property
    def is_static(self) -> bool:
        """Whether one frame shows all."""
        return self.spec.category == "static"

    def path(self, file: File) -> Path:
        """Where a file of the record lies."""
        return ((self.system.source if file.source else None) or self.folder) / file.path
