"""The steps of properties that scripts make themselves on anything: custom properties, which no class has."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import STRUCT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.answer.steps.names.topic_names import TopicNames
    from kb_serve.reader import BaseReader

_LIMITS = f"{STRUCT}.id_properties_ui"
_STEPS = (
    '`obj["strength"] = 1.0` — makes the property, or changes its value: of an object, material, bone, scene, …',
    '`obj.id_properties_ui("strength").update(min=0.0, max=2.0, description="How much")` — its limits and tooltip in '
    "Blender's panels, which scripts need not keep",
    '`obj["mode"] = 0`; `obj.id_properties_ui("mode").update(items=[("A", "First", ""), ("B", "Second", "")])` — a '
    "whole number with named choices",
    "`obj.keyframe_insert('[\"strength\"]', frame=1)` — its path in animations and drivers has brackets and quotes",
)


def made_by_subscript(names: TopicNames, reader: BaseReader) -> Iterator[str]:
    """How custom properties are made, where a page explains those of everything."""
    if STRUCT in names.explained and reader.entry(_LIMITS):
        yield from _STEPS
