"""A question is read without what it wants to do without, and only then."""

from __future__ import annotations

import pytest

from kb_serve.recognise.unwanted import Wanted, without_unwanted


@pytest.mark.parametrize(
    ("query", "text", "operators"),
    [
        ("delete object without ops", "delete object python", False),
        ("delete object without bpy.ops", "delete object python", False),
        ("convert curve to mesh no operator", "convert curve to mesh python", False),
        ("convert curve to mesh, no operators.", "convert curve to mesh. python", False),
        ("select objects without using operators in a loop", "select objects in a loop python", False),
        ("join meshes (without any operator)", "join meshes python", False),
        ("add a cube not using bpy.ops", "add a cube python", False),
        ("apply a modifier instead of operators", "apply a modifier python", False),
        ("bevel without operators or context override", "bevel python", False),
        ("apply modifier without context override", "apply modifier python", True),
        ("bpy.ops.object.join without overriding", "bpy.ops.object.join python", True),
        ("bake the cache of cloth in background mode", "bake the cache of cloth python", True),
        ("bake a fluid headless, without operators", "bake a fluid python", False),
        ("add a light without UI to the scene", "add a light to the scene python", True),
        ("hide an object without deleting it", "hide an object python", True),
    ],
)
def test_what_is_not_wanted_is_left_out(query: str, text: str, operators: bool) -> None:
    assert without_unwanted(query) == (text, operators, "")


@pytest.mark.parametrize(
    ("query", "text", "without"),
    [
        (
            "point the camera at an object without a constraint",
            "point the camera at an object python",
            "constraint",
        ),
        ("move a cube without using keyframes, by script", "move a cube, by script python", "keyfram"),
        ("mirror a mesh without modifiers", "mirror a mesh python", "modifi"),
    ],
)
def test_other_means_are_asked_for(query: str, text: str, without: str) -> None:
    assert without_unwanted(query) == (text, True, without)


@pytest.mark.parametrize(
    "query",
    [
        "what to use instead of bpy.ops.mesh.primitive_cube_add",
        "use bpy.ops.wm.obj_import instead of bpy.ops.import_scene.obj",
        "bpy.ops.import_scene.obj gone, what instead of bpy.ops.import_scene.obj",
        "Error: there is no operator bpy.ops.import_scene.obj",
        "there is no operator called mesh.primitive_cube_add",
        "why is there no operator for metaballs",
        "run with no context.active_object",
        "why has it no operator",
        "run blender in background mode",
        "render headless",
        "set an image in the background of the view",
        "AttributeError: 'NoneType' object has no operator",
        "render without denoising",
        "cloth without self collision",
        "operator without undo",
        "panel without operator buttons",
        "export an fbx without modifiers",
        "render without shadows",
        "curve without driver variables",
    ],
)
def test_what_is_asked_for_stays(query: str) -> None:
    assert without_unwanted(query) == Wanted(query)


def test_a_long_question_is_read_once() -> None:
    query = f"delete {'  ' * 200_000} without object"
    assert without_unwanted(query) == Wanted(query)
