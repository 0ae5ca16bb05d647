"""Questions of several parts, and those that only look so."""

from __future__ import annotations

import pytest

from kb_serve.recognise.several import parts_of


@pytest.mark.parametrize(
    ("query", "parts"),
    [
        ("make a cube fall, bake it and render a film", ("make a cube fall", "bake it", "render a film")),
        (
            "How do I import a mesh and then keyframe its rotation?",
            ("How do I import a mesh", "keyframe its rotation"),
        ),
        ("add a floor; give it a texture.", ("add a floor", "give it a texture")),
        (
            "create a node group with input and output sockets, then save the file",
            ("create a node group with input and output sockets", "save the file"),
        ),
        ("scale the bones and location of a rig", ()),
        ("add and remove vertex group", ()),
        ("how to enable and disable an addon from python", ()),
        ("list with add and remove buttons in panel", ()),
        ("make a cube move and render a film", ("make a cube move", "render a film")),
        ("add fire and smoke", ()),
        ("set the render and bake settings", ()),
        ("add an array and mirror modifier", ()),
        ("set it up, then render frames 1 to 5", ("set it up", "render frames 1 to 5")),
        ("shear and bending stiffness", ()),
        ("hide an object at frame 20 and show it at frame 40", ()),
        ("hide the cube and show the sphere", ("hide the cube", "show the sphere")),
        ("my cloth falls and then goes through the floor", ()),
        ("how to make a body start animated and then become dynamic", ()),
        ("obj.select_set(True); delete the object", ()),
        ("RuntimeError: Operator failed, add an object and select it", ()),
        ("new material and assign it to the slot", ("new material", "assign it to the slot")),
        ("voxel remesh modifier and apply it", ("voxel remesh modifier", "apply it")),
        ("I made the arm bones, copy them to the right", ()),
        ("pip install bpy and use it outside the application", ()),
        ("add bones and", ()),
        ("", ()),
        (", and then ;", ()),
        ("and ".join(["add a cube "] * 9), ()),
    ],
)
def test_actions_are_taken_apart_and_their_objects_are_not(query: str, parts: tuple[str, ...]) -> None:
    assert tuple(part.text for part in parts_of(query)) == parts


def test_later_parts_are_about_the_thing_that_the_first_names() -> None:
    assert [part.about for part in parts_of("bevel modifier and apply it")] == ["", "bevel modifier"]


def test_later_parts_are_about_the_object_of_the_first() -> None:
    parts = parts_of("how do I add a sun lamp, make it warm and render the scene")
    assert [part.about for part in parts] == ["", "a sun lamp", "a sun lamp"]


@pytest.mark.parametrize(
    ("query", "topics"),
    [
        ("create an action and assign it", ["create an action", ""]),
        ("make a cube fall and bake it", ["make a cube fall", "bake a cube fall"]),
        ("create a material and assign it to the cube", ["create a material", "assign it to the cube"]),
        ("simulate smoke and bake it", ["simulate smoke", "bake smoke"]),
        ("make a curve and animate it", ["make a curve", ""]),
    ],
)
def test_a_bare_verb_of_what_the_first_part_is_about_is_no_topic(query: str, topics: list[str]) -> None:
    assert [part.topic for part in parts_of(query)] == topics
