"""How the work of topics is done, as ``blender_docs`` tells it, and which names belong to a topic."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.answer.budget import tokens
from kb_serve.answer.steps.order import numbered
from kb_serve.answer.topic.overview import Topics
from kb_serve.packs.section import fitting

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_serve.reader import BaseReader

# What scenes are made of, by the names of the manual's chapters. Their order is that of most use; those that a
# version's manual lacks are passed over.
USUAL_TOPICS = (
    "materials", "modifiers", "rigid body", "keyframes", "lights", "camera", "cloth", "collections", "fluid",
    "geometry nodes", "soft body", "render", "particles", "shape keys", "constraints", "armatures", "uv", "curves",
    "force fields", "compositing", "world", "drivers", "text", "grease pencil", "dynamic paint", "video editing",
    "sculpting", "hair", "motion tracking", "freestyle",
)  # fmt: skip
_ROOM = 1_500  # tokens, for a few topics with all their settings
_CALLS = 4


class TopicLines:
    """The topics of a base."""

    def __init__(self, reader: BaseReader) -> None:
        self._topics = Topics(reader)

    def find(self, topic: str) -> str:
        """The page of a topic; empty if the base has none."""
        return self._topics.find(topic)

    def steps(self, budget: int) -> list[str]:
        """How the usual topics are done, one after the other, as many as fit; in a small budget only the calls."""
        told: list[str] = []
        is_brief = budget < _ROOM
        shown: set[str] = set()
        for topic in USUAL_TOPICS:
            slug = self.find(topic)
            if not slug or slug in shown:
                continue
            shown.add(slug)
            steps = self._topics.steps(slug)
            entry = _brief(topic, steps) if is_brief else _whole(topic, steps)
            if entry and tokens(entry) <= budget:
                budget -= tokens(entry + "\n")
                told.append(entry)
        return told

    def overview(self, slug: str, budget: int) -> list[str]:
        """The whole overview of one topic, as far as it fits."""
        blocks = self._topics.overview(slug).blocks
        lines = [line for block in blocks for line in (*block.text.split("\n"), "")]
        return fitting(lines[1:], budget)

    def names(self, slug: str) -> frozenset[str]:
        """The classes and operators of a topic."""
        return self._topics.members(slug)


def _whole(topic: str, steps: Sequence[str]) -> str:
    """All steps below the topic; empty for none."""
    lines = "\n".join(numbered(steps))
    return f"### {topic.capitalize()}\n\n{lines}\n" if steps else ""


def _brief(topic: str, steps: Sequence[str]) -> str:
    """The first calls, without what is set, on one line; empty for none."""
    calls = [step for step in steps if step.startswith("`")]
    return f"- {topic}: " + "; ".join(map(_plain, calls[:_CALLS])) if calls else ""


def _plain(call: str) -> str:
    """A call without what is said about it, and the types that it can make beside the usual one."""
    return call.partition("; also")[0].partition(" — ")[0]
