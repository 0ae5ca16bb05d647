"""Scenes of two Blenders side by side."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

import pytest

from kb_check.migrate.trial import Ending, compare, run_in, runtime_at_hand, try_out

if TYPE_CHECKING:
    from pathlib import Path

    from simworlds.sandbox.runtime import Runtime

SCENE = """
import bpy
bpy.ops.mesh.primitive_uv_sphere_add(radius=1, location=(0, 0, {height}))
bpy.context.object.modifiers.new("Smooth", 'SUBSURF')
bpy.context.object.keyframe_insert("location", frame=1)
"""


@pytest.fixture
def runtime(base: Path) -> Runtime:
    found = runtime_at_hand(".".join(base.stem.split("-")[1].split(".")[:2]), base.parent.parent)
    assert found is not None
    return found


def script(folder: Path, name: str, code: str) -> Path:
    path = folder / name
    path.write_text(code)
    return path


def test_the_same_script_leaves_the_same_scene(runtime: Runtime, tmp_path: Path) -> None:
    path = script(tmp_path, "a.py", SCENE.format(height=3))
    trial = try_out("a.py", path, path, runtime, runtime)
    assert trial.differences == ()
    assert "alike" in trial.verdict


def test_what_differs_is_named(runtime: Runtime, tmp_path: Path) -> None:
    old = script(tmp_path, "a.py", SCENE.format(height=3))
    new = script(tmp_path, "b.py", SCENE.format(height=4) + "bpy.context.object.modifiers.clear()\n")
    trial = try_out("a.py", old, new, runtime, runtime)
    assert any(line.startswith("objects.Sphere.place:") for line in trial.differences)
    assert any(line.startswith("objects.Sphere.modifiers:") for line in trial.differences)
    assert len(trial.differences) == 2


def test_an_error_ends_the_comparison(runtime: Runtime, tmp_path: Path) -> None:
    good = script(tmp_path, "a.py", SCENE.format(height=3))
    bad = script(tmp_path, "b.py", "import bpy\nbpy.context.object.select = True\n")
    trial = try_out("a.py", good, bad, runtime, runtime)
    assert "AttributeError" in trial.after.error
    assert trial.after.error.endswith("(b.py:2)")
    assert trial.differences == ()


def test_two_blenders_agree_on_a_plain_scene(runtime: Runtime, base: Path, tmp_path: Path) -> None:
    old = runtime_at_hand("3.4", base.parent.parent) if shutil.which("blender") else None
    if old is None:
        pytest.skip("Blender 3.4 is not installed")
    path = script(tmp_path, "a.py", SCENE.format(height=3))
    assert try_out("a.py", path, path, old, runtime).differences == ()


def test_a_script_that_ends_blender_is_told(runtime: Runtime, tmp_path: Path) -> None:
    ending = run_in(runtime, script(tmp_path, "a.py", "import os\nos._exit(5)\n"))
    assert ending.error


def test_what_a_script_writes_in_place_of_the_facts_is_told(runtime: Runtime, tmp_path: Path) -> None:
    code = "import sys, os\nopen(sys._getframe(2).f_locals['out'], 'w').write('[]')\nos._exit(0)\n"
    assert "no account" in run_in(runtime, script(tmp_path, "a.py", code)).error


def test_numbers_that_are_as_good_as_equal_do_not_differ() -> None:
    old = Ending("4.2", "", {"a": [1.0, 2.0], "b": {"c": 1}})
    new = Ending("5.1", "", {"a": [1.0004, 2.0], "b": {"c": 2}, "d": 1})
    assert compare(old, new) == ("b.c: 1 → 2", "d: new")


def test_an_addon_may_ask_for_its_preferences_and_leave_classes_behind(
    runtime: Runtime, tmp_path: Path
) -> None:
    folder = tmp_path / "asking"
    folder.mkdir()
    (folder / "__init__.py").write_text(
        """
import bpy
class Wanted(bpy.types.AddonPreferences):
    bl_idname = __name__
    size: bpy.props.IntProperty(default=3)
def register():
    bpy.utils.register_class(Wanted)
    assert bpy.context.preferences.addons[__name__].preferences.size == 3
def unregister():
    pass
"""
    )
    assert run_in(runtime, folder).error == ""
