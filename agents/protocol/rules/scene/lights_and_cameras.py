"""W3 to W5: lights, cameras and force fields (paper, appendix "Scene Protocol and Verifier Ruleset")."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.rule import Rule, RuleContext

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.facts import ObjectFacts
    from agents.protocol.findings import Finding
    from agents.protocol.measures.requests import Measures

_DARK = 1e-3  # a world with less light than this lights nothing


def _misplaced(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    for obj in context.structure.logical_objects:
        for item in obj.members:
            if kind := _kind(item):
                yield W3.finding(
                    (item.name, obj.name), f"The {kind} {item.name!r} is inside the object {obj.name!r}."
                )


def _kind(item: ObjectFacts) -> str:
    """What an object is, if it does not belong into an L3."""
    kinds = {"LIGHT": "light", "CAMERA": "camera"}
    return kinds.get(item.type, "force field" if item.force_field else "")


def _no_camera(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    if not any(item.type == "CAMERA" for item in context.facts.objects):
        yield W4.finding((), "The scene has no camera.", measured=0.0)


def _no_light(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    lit = any(item.light and item.energy > 0 and item.rendered for item in context.facts.objects)
    world = context.facts.world_light
    if not lit and world <= _DARK:
        yield W5.finding((), "The scene has no light, and its world emits none.", measured=world)


W3 = Rule(
    "W3",
    "meshes and Empties only",
    "soft",
    "No light, camera or force field is inside an object (L3).",
    "It would move, hide and be copied with the object, and be missing from the system it belongs to.",
    "Move it into a system of its own: lighting, cameras or physics.",
    _misplaced,
)
W4 = Rule(
    "W4",
    "camera",
    "soft",
    "The scene has a camera.",
    "Without a camera, nothing can be rendered.",
    "Add a camera, and make it the scene's (scene.camera).",
    _no_camera,
)
W5 = Rule(
    "W5",
    "light",
    "soft",
    "The scene has a light, or its world emits light.",
    "Without light, the render is black.",
    "Add a light, or give the world's background a strength.",
    _no_light,
)
RULES = (W3, W4, W5)
