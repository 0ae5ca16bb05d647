"""The interface of systems that make .blend files of prompts."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from bench.scenes.spec import Spec
    from bench.sweep.records import Outcome, SystemInfo


class SystemNotReady(Exception):  # noqa: N818 - reads as the state it names
    """A system that cannot be run here; the message says why, and what to do."""


@dataclass(frozen=True, slots=True)
class SystemOutput:
    """A system's result for a prompt: see ``bench.sweep.records.Produced``. ``prompt``: as the system got it."""

    outcome: Outcome
    prompt: str
    why: str = ""
    blend: Path | None = None
    video: Path | None = None
    models: dict[str, str] = field(default_factory=dict[str, str])
    cost: float | None = None
    minutes: float | None = None
    tokens: dict[str, int] = field(default_factory=dict[str, int])


class SceneSystem(Protocol):
    """A system as a sweep uses it. Plain data: it is sent to other processes."""

    @property
    def info(self) -> SystemInfo:
        """Its name, kind and settings, as stored with results."""
        ...

    @property
    def source(self) -> Path | None:
        """The folder that files are taken from; None for a system that makes its own files."""
        ...

    def ready(self) -> None:
        """Raises SystemNotReady."""
        ...

    def is_for(self, spec: Spec) -> bool:
        """Whether the scene is among the system's default scenes."""
        ...

    def depends_on(self, spec: Spec) -> Any:
        """What the result depends on besides the settings, as JSON: the result is kept while this is unchanged."""
        ...

    def files(self, spec: Spec) -> list[Path]:
        """The files of ``source`` that belong to the scene."""
        ...

    def produce(self, spec: Spec, place: Path, tell: Callable[[str], object]) -> SystemOutput:
        """Makes the scene in the folder ``place``, or resumes what was begun there. Raises OSError.

        On KeyboardInterrupt, all processes that it started end.
        """
        ...
