"""What goes on between two rows of a journal, which the journal does not have yet."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping


@dataclass(frozen=True, slots=True)
class ToolProgress:
    """How far a tool has got."""

    done: float
    total: float | None
    text: str


@dataclass(frozen=True, slots=True)
class Now:
    """What goes on between two rows: ``seconds`` of work in all, words by role, progress by tool, the run's folder."""

    seconds: float
    words: Mapping[str, str] = field(default_factory=dict[str, str])
    progress: Mapping[str, ToolProgress] = field(default_factory=dict[str, ToolProgress])
    folder: str = ""
