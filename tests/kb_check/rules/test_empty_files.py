"""What an empty file lacks is found where a script surely has one, and nowhere else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_EMPTYING = "import bpy\nbpy.ops.wm.read_factory_settings(use_empty=True)\n"
_DELETING = "import bpy\nbpy.ops.object.select_all(action='SELECT')\nbpy.ops.object.delete()\n"
_READING = """\
bpy.context.scene.world.color = (0, 0, 0)
bpy.context.scene.world.node_tree
bpy.context.scene.camera.location.x = 1
bpy.data.scenes[0].world.name
bpy.data.objects['Cube'].location.x = 1
bpy.data.objects['Camera'].data.lens = 20
bpy.data.objects['Light'].data.energy
bpy.data.meshes['Cube'].name
bpy.data.cameras['Camera'].lens
bpy.data.lights['Light'].energy
bpy.data.materials['Material'].roughness
bpy.data.worlds['World'].color
bpy.data.collections['Collection'].name
bpy.context.scene.compositing_node_group.nodes
bpy.data.scenes[0].compositing_node_group.interface
bpy.context.scene.rigidbody_world.time_scale = 2
bpy.context.scene.render.fps = 25
bpy.context.scene.collection.name
bpy.context.view_layer.name
bpy.data.scenes['Scene'].frame_end
bpy.context.scene.world
bpy.context.scene.eevee.taa_samples
bpy.context.scene.view_settings.exposure
""".splitlines()


def is_found(checker: Checker, text: str) -> bool:
    return bool(checker.check(text, rules=["empty-file"]))


def test_what_blender_refuses_in_an_empty_file_is_found(rule_checker: Checker, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [_EMPTYING, *_READING])[1:]
    refused = [line for line, (error, *_) in zip(_READING, answers, strict=True) if error]
    found = [line for line in _READING if is_found(rule_checker, f"{_EMPTYING}{line}\n")]
    assert found == refused
    assert len(refused) == 16


@pytest.mark.parametrize(
    ("before", "severity"),
    [
        ("bpy.ops.wm.read_factory_settings()", "warning"),
        ("bpy.ops.wm.read_factory_settings(use_empty=False)", "warning"),
        ("bpy.ops.wm.read_homefile()", "note"),
        ("bpy.context.scene.frame_end = 20", "note"),
    ],
)
def test_what_a_new_file_lacks_is_sure_behind_the_factory_settings(
    rule_checker: Checker, tmp_path: Path, before: str, severity: str
) -> None:
    line = "bpy.context.scene.rigidbody_world.time_scale = 2"
    *_, (error, _, _) = run_statements(tmp_path, ["import bpy", before, line])
    assert error.startswith("AttributeError")
    found = rule_checker.check(f"import bpy\n{before}\n{line}\n", rules=["empty-file"])
    assert [one.severity for one in found] == [severity]
    filled = f"import bpy\n{before}\nbpy.ops.rigidbody.world_add()\n{line}\n"
    assert rule_checker.check(filled, rules=["empty-file"]) == []


def test_what_a_new_file_lacks_is_noted_where_none_is_emptied(rule_checker: Checker, tmp_path: Path) -> None:
    lines = [line for line in _READING if "bpy.data" not in line or "scenes[0]" in line]
    answers = run_statements(tmp_path, ["import bpy", *lines])[1:]
    refused = [line for line, (error, *_) in zip(lines, answers, strict=True) if error]
    found = {
        line: rule_checker.check(f"import bpy\n{line}\nprint()\n", rules=["empty-file"]) for line in lines
    }
    assert [line for line in lines if found[line]] == refused
    assert {finding.severity for findings in found.values() for finding in findings} == {"note"}
    assert len(refused) == 3


@pytest.mark.parametrize(
    "text",
    [
        "def register():\n    pass\nbpy.context.scene.rigidbody_world.time_scale = 2",
        "class A:\n    bpy.context.scene.rigidbody_world.time_scale = 2\nprint(A)",
        "bpy.ops.rigidbody.object_add()\nbpy.context.scene.rigidbody_world.time_scale = 2",
        "bpy.ops.wm.open_mainfile(filepath='a.blend')\nbpy.context.scene.compositing_node_group.nodes",
        "if bpy.context.scene.rigidbody_world:\n    bpy.context.scene.rigidbody_world.time_scale = 2\nprint()",
        "try:\n    bpy.context.scene.rigidbody_world.time_scale = 2\nexcept AttributeError:\n    pass\nprint()",
    ],
)
def test_what_may_be_another_file_is_no_finding(rule_checker: Checker, text: str) -> None:
    assert not is_found(rule_checker, f"import bpy\n{text}\n")


@pytest.mark.parametrize(
    "text",
    [
        f"{_EMPTYING}bpy.context.scene.world = bpy.data.worlds.new('World')\nbpy.context.scene.world.color = (0, 0, 0)",
        f"{_EMPTYING}bpy.data.worlds.new('World')\nbpy.data.worlds['World'].color = (0, 0, 0)",
        f"{_EMPTYING}tree = bpy.data.node_groups.new('x', 'CompositorNodeTree')\nscene = bpy.context.scene\n"
        "scene.compositing_node_group = tree\nscene.compositing_node_group.nodes",
        f"{_EMPTYING}bpy.ops.node.new_compositing_node_group()\nbpy.context.scene.compositing_node_group.nodes",
        f"{_EMPTYING}if bpy.context.scene.world:\n    bpy.context.scene.world.color = (0, 0, 0)",
        f"{_EMPTYING}world = bpy.context.scene.world\nif world is not None:\n    world.color = (0, 0, 0)",
        f"{_EMPTYING}try:\n    bpy.context.scene.world.name\nexcept AttributeError:\n    pass",
        f"{_EMPTYING}bpy.ops.import_scene.gltf(filepath='a.glb')\nbpy.context.scene.world.name",
        f"{_EMPTYING}bpy.ops.wm.open_mainfile(filepath='a.blend')\nbpy.context.scene.world.name",
        f"{_EMPTYING}bpy.ops.mesh.primitive_cube_add()\nbpy.context.object.location.x = 1",
        f"{_EMPTYING}bpy.ops.mesh.primitive_cube_add()\nbpy.data.objects['Cube'].location.x = 1",
        f"{_EMPTYING}bpy.ops.object.camera_add()\nbpy.context.scene.camera = bpy.context.object\n"
        "bpy.context.scene.camera.location.x = 1",
        f"{_EMPTYING}bpy.ops.object.camera_add()\nbpy.context.scene.camera = bpy.context.object\n"
        "bpy.ops.render.render()",
        f"{_EMPTYING}with bpy.context.temp_override(area=bpy.context.screen.areas[0]):\n"
        "    bpy.ops.object.camera_add()\nbpy.ops.render.render()",
        f"{_EMPTYING}bpy.context.scene.sequence_editor_create()\nbpy.ops.render.render()",
        f"{_EMPTYING}bpy.ops.render.render(scene='Other')",
        f"{_DELETING}bpy.ops.mesh.primitive_cube_add()\nbpy.data.objects['Cube'].location.x = 1",
        f"{_DELETING}bpy.context.scene.world.color = (0, 0, 0)\nbpy.data.meshes['Cube'].name",
        f"{_DELETING}bpy.ops.object.light_add()\nbpy.data.objects['Light'].location.x = 1",
        "import bpy\nbpy.ops.object.select_all(action='DESELECT')\nbpy.ops.object.delete()\n"
        "bpy.data.objects['Camera'].location.x = 1",
        f"{_EMPTYING}import scenery\nscenery.make()\nbpy.context.scene.world.name",
        f"{_EMPTYING}setattr(bpy.context.scene, 'wor' + 'ld', bpy.data.worlds.new('a'))\nbpy.context.scene.world.name",
        f"{_EMPTYING}bpy.data.objects.new('Cube', None)\nbpy.data.objects['Cube'].location.x = 1",
        f"{_EMPTYING}with bpy.data.libraries.load('a.blend') as (known, wanted):\n    wanted.objects = known.objects\n"
        "bpy.data.objects['Cube'].location.x = 1",
        "import bpy\nbpy.context.scene.world.name\nbpy.ops.wm.read_factory_settings(use_empty=True)",
        "import bpy\nbpy.ops.wm.read_factory_settings()\nbpy.context.scene.world.name",
        "import bpy\nif bpy.app.background:\n    bpy.ops.wm.read_homefile(use_empty=True)\n"
        "bpy.context.scene.world.name",
        "import bpy\ndef empty():\n    return\n    bpy.ops.wm.read_homefile(use_empty=True)\nempty()\n"
        "bpy.context.scene.world.name",
        "import bpy\ndef light():\n    bpy.context.scene.world.name\nlight()\n"
        "bpy.ops.wm.read_homefile(use_empty=True)\nlight()",
    ],
)
def test_what_may_be_there_is_left_alone(rule_checker: Checker, text: str) -> None:
    assert not is_found(rule_checker, text)


@pytest.mark.parametrize(
    "text",
    [
        "import bpy\nbpy.ops.wm.read_homefile(use_empty=True)\nbpy.ops.mesh.primitive_cube_add()\n"
        "bpy.context.scene.world.name",
        "import bpy\ndef empty():\n    bpy.ops.wm.read_homefile(use_empty=True)\ndef light(scene):\n"
        "    world = scene.world\n    world.color = (0, 0, 0)\ndef main():\n    empty()\n"
        "    light(bpy.context.scene)\nif __name__ == '__main__':\n    main()",
        f"{_EMPTYING}for number in range(3):\n    bpy.context.scene.camera.location.x = number",
        f"{_EMPTYING}bpy.ops.object.camera_add()\nbpy.context.scene.camera.location.x = 1",
        f"{_EMPTYING}bpy.ops.object.camera_add()\nbpy.ops.render.render(write_still=True)",
        f"{_DELETING}bpy.ops.mesh.primitive_plane_add()\nbpy.data.objects['Camera'].location.x = 1",
        f"{_DELETING}bpy.context.scene.camera.location.x = 1",
        f"{_DELETING}bpy.ops.object.light_add()\nbpy.ops.render.render()",
        "import bpy\nfor ob in bpy.data.objects:\n    bpy.data.objects.remove(ob)\nbpy.data.objects['Cube'].name",
    ],
)
def test_functions_and_blocks_behind_it_are_looked_at(rule_checker: Checker, text: str) -> None:
    assert is_found(rule_checker, text)


def test_calls_of_calls_are_followed_however_many(rule_checker: Checker) -> None:
    reading = "def f0():\n    bpy.data.objects['Cube'].location.x = 1\n"
    chain = "".join(f"def f{n + 1}():\n    f{n}()\n" for n in range(1200))
    assert is_found(rule_checker, f"{_EMPTYING}{reading}{chain}f1200()\n")
    fan = "".join(f"def f{n + 1}():\n    f{n}()\n    f{n}()\n" for n in range(40))
    assert is_found(rule_checker, f"{_EMPTYING}{reading}{fan}f40()\n")
    assert not is_found(rule_checker, f"{reading}{fan}f40()\n{_EMPTYING}f40()\n")
    assert not is_found(rule_checker, f"{_EMPTYING}def f0():\n    f0()\n    bpy.data.objects['Cube'].name\n")
