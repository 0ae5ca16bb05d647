"""Where a run stands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agents.plan.part import Stage

START = "start"  # stands for a closed stage before there is one


@dataclass(slots=True)
class Position:
    """``stage`` is being built, in its ``attempt``; ``closed`` was closed last.

    ``is_changed``: whether the scene is another since that was closed.
    """

    stage: Stage | None = None
    attempt: int | None = None
    closed: str = START
    is_changed: bool = False

    def close(self, name: str) -> None:
        """The scene as it is now is saved as ``name``."""
        self.closed, self.is_changed = name, False
