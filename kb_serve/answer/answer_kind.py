"""How well an answer meets its query."""

from __future__ import annotations

from typing import Literal

AnswerKind = Literal["schema", "page", "candidates", "none"]
