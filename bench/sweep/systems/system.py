"""Systems that make .blend files of prompts, and the three that a sweep knows."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from bench.scenes.spec import Spec
    from bench.sweep.records import Outcome, SystemInfo


class NotReady(Exception):  # noqa: N818 - reads as the state it names
    """A system that cannot be run here; the message says why, and what to do."""


@dataclass(frozen=True, slots=True)
class Made:
    """What a system made of a prompt: see ``bench.sweep.records.Produced``. ``prompt``: what it was given."""

    outcome: Outcome
    prompt: str
    why: str = ""
    blend: Path | None = None
    video: Path | None = None
    models: dict[str, str] = field(default_factory=dict[str, str])
    cost: float | None = None
    minutes: float | None = None
    tokens: dict[str, int] = field(default_factory=dict[str, int])


class System(Protocol):
    """What a sweep asks of a system. It is sent to other processes, and so is plain data."""

    @property
    def info(self) -> SystemInfo:
        """What the results are known by."""
        ...

    @property
    def source(self) -> Path | None:
        """The folder that files are taken from; None for a system that makes its own."""
        ...

    def ready(self) -> None:
        """Raises NotReady."""
        ...

    def is_for(self, spec: Spec) -> bool:
        """Whether the system is asked for this scene when nobody says which."""
        ...

    def depends_on(self, spec: Spec) -> Any:
        """What the result for a scene depends on besides the settings, as JSON: while it stays, so does the result."""
        ...

    def files(self, spec: Spec) -> list[Path]:
        """The files of ``source`` that are this scene's."""
        ...

    def produce(self, spec: Spec, place: Path, tell: Callable[[str], object]) -> Made:
        """Makes the scene in the folder ``place``, or goes on with what was begun there. Raises OSError.

        When it is interrupted (KeyboardInterrupt), nothing that it started goes on.
        """
        ...
