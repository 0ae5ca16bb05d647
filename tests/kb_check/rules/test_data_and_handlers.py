"""Data of objects whose type nobody says, lists of handlers, and items of collections that are assigned to."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_LINES = """\
import bpy
cam = bpy.data.objects['Camera']
data = cam.data
bpy.context.scene.camera = cam.data
bpy.context.scene.camera = data
bpy.context.scene.camera = cam
bpy.context.scene.world = data
cam.parent = bpy.data.objects['Cube'].data
cam.data = data
data.sensor_fit = 'AUTOMATIC'
data.sensor_fit = 'AUTO'
data.type = 'PANORAMIC'
cam.data.type = 'PANO'
bpy.data.objects['Light'].data.type = 'SUN'
bpy.app.handlers.frame_change_pre.add(print)
bpy.app.handlers.frame_change_pre.append(print)
handlers = bpy.app.handlers.frame_change_pre
handlers.discard(print)
handlers.remove(print)
bpy.app.handlers.frame_change_pre = []
bpy.app.handlers.frame_change_pre[:] = []
bpy.app.debug = False
mesh = bpy.data.meshes['Cube']
mesh.materials[0] = 'Glow'
mesh.materials[0] = 3
mesh.materials[0] = None
mesh.materials[0] = bpy.data.materials[0]
mesh.materials['Material'] = None
del mesh.materials[0]
mesh['own'] = 'text'
del mesh['own']
modifier = bpy.data.objects['Cube'].modifiers.new('x', 'BOOLEAN')
bpy.data.objects['Cube'].modifiers[0].operation = 'UNITE'
bpy.data.objects['Cube'].modifiers[0].operation = 'UNION'
bpy.data.objects['Cube'].modifiers[0] = None
"""
_RULES = ["wrong-type", "unknown-value", "list-attribute", "read-only", "not-subscriptable"]


def test_what_is_found_is_what_blender_refuses(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _LINES.splitlines()
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = rule_checker.check(_LINES, rules=_RULES)
    assert [one.span.line for one in found] == refused
    assert len(refused) == 15


def test_items_are_found_by_what_blender_names_them_by(rule_checker: Checker, tmp_path: Path) -> None:
    code = """\
import bpy
notes = bpy.data.annotations.new('notes')
notes.layers.new('Lines')
notes.layers['Lines'].annotation_hide = True
keys = bpy.context.scene.keying_sets.new()
keys.paths.add(bpy.context.scene, 'frame_start')
keys.paths['frame_start'].array_index
notes.layers['Lines'].frames.new(1)
notes.layers['Lines'].frames['1']
"""
    errors = [error for error, *_ in run_statements(tmp_path, code.splitlines())]
    assert [at for at, error in enumerate(errors, 1) if error] == [9]
    assert [one.span.line for one in rule_checker.check(code, rules=["not-subscriptable"])] == [9]


def test_properties_that_a_package_registers_may_have_any_value(rule_checker: Checker) -> None:
    own = "import bpy\nbpy.types.Mesh.sensor_fit = bpy.props.StringProperty()\n"
    use = "bpy.data.objects['a'].data.sensor_fit = 'MINE'\n"
    assert rule_checker.check(own + use, rules=["unknown-value"]) == []
    files = {"addon/__init__.py": own, "addon/use.py": f"import bpy\n{use}"}
    reads = rule_checker.read_files(files)
    package = rule_checker.package()
    for read in reads.values():
        package.add(read.analysis)
    assert [one.rule for one in rule_checker.check(reads["addon/use.py"], package)] == []
    assert len(rule_checker.check(f"import bpy\n{use}", rules=["unknown-value"])) == 1


_TUPLES = """\
import bpy
cube = bpy.data.objects['Cube']
cube.children.append(bpy.data.objects['Light'])
cube.users_collection.remove(bpy.data.collections[0])
cube.children.index(cube) if cube.children else 0
children = [*cube.children]
children.append(cube)
"""


def test_what_a_tuple_is_not_added_to_is_told(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _TUPLES.splitlines()
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = rule_checker.check(_TUPLES)
    assert [one.span.line for one in found] == refused == [3, 4]
    assert [one.message.partition(". ")[2] for one in found] == [
        "A child is given its parent: `child.parent = obj`.",
        "A collection lets go of an object: `collection.objects.unlink(obj)`.",
    ]
