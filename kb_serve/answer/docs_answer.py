"""Answers as their caller gets them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from simworlds.schemas.value_class import value_class

if TYPE_CHECKING:
    from kb_serve.answer.hits import Hit

# How well an answer meets its query.
AnswerKind = Literal["schema", "page", "candidates", "none"]


@value_class
class DocsAnswer:
    """What ``blender_docs`` returns. ``text`` is Markdown: what fits of the ``parts``, from ``part`` on, within the
    token budget; ``next_part`` is the one to go on with, 0 at the end.
    """

    kind: AnswerKind
    text: str
    hits: tuple[Hit, ...] = ()
    notes: tuple[str, ...] = ()
    part: int = 1
    parts: int = 1
    next_part: int = 0
