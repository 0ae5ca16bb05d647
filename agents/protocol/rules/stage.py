"""W3 to W5: lights, cameras and fields (paper, appendix "Scene Protocol and Verifier Ruleset")."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.protocol.rule import Rule, Subject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.protocol.findings import Finding
    from agents.protocol.measures.measure import Measures

DIM = 1e-3  # a world that shines less lights nothing


def _objects_are_only_objects(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    for thing in subject.structure.things:
        for one in (*thing.meshes, *thing.others, *thing.roots):
            what = (
                "light"
                if one.type == "LIGHT"
                else "camera"
                if one.type == "CAMERA"
                else "force field"
                if one.force_field
                else ""
            )
            if what:
                yield W3.finding(
                    (one.name, thing.name), f"The {what} {one.name!r} is inside the object {thing.name!r}."
                )


def _has_a_camera(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    if not any(one.type == "CAMERA" for one in subject.facts.objects):
        yield W4.finding((), "The scene has no camera.", measured=0.0)


def _has_light(subject: Subject, _measures: Measures) -> Iterator[Finding]:
    lit = any(one.light and one.energy > 0 and one.rendered for one in subject.facts.objects)
    if not lit and subject.facts.world_light <= DIM:
        yield W5.finding(
            (), "The scene has neither a light nor a world that shines.", measured=subject.facts.world_light
        )


W3 = Rule(
    "W3",
    "only its own",
    "soft",
    "No light, camera or force field is inside an object (L3).",
    "They would move, hide and be copied with the object, and are looked for in systems of their own.",
    "Move it into a system of its own: lighting, cameras or physics.",
    _objects_are_only_objects,
)
W4 = Rule(
    "W4",
    "a camera",
    "soft",
    "The scene has a camera.",
    "Without one nothing can be rendered.",
    "Add a camera, and make it the scene's (scene.camera).",
    _has_a_camera,
)
W5 = Rule(
    "W5",
    "light",
    "soft",
    "The scene has a light, or a world that shines.",
    "Without light the render is black.",
    "Add a light, or give the world's background a strength.",
    _has_light,
)
RULES = (W3, W4, W5)
