"""The name of a class, given to an enumeration: refused like any other value that it does not have."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_LINES = """\
import bpy
ob = bpy.data.objects['Cube']
action = bpy.data.actions.new('x')
action.slots.new('Object', 'x')
action.slots.new('OBJECT', 'x')
bpy.data.lights.new('x', 'Light')
bpy.data.curves.new('x', 'Curve')
bpy.data.curves.new('x', 'CURVE')
bpy.data.textures.new('x', 'Texture')
driver = ob.driver_add('location', 0).driver
target = driver.variables.new().targets[0]
target.id_type = 'Object'
bpy.ops.object.add(type='Mesh')
bpy.ops.object.parent_set(type='Object')
ob.data.attributes.new('v', 'FLOAT', 'Point')
keying = bpy.context.scene.keying_sets.new(name='k')
path = keying.paths.add(ob, 'location', group_method='NAMED')
path.id_type = 'Object'
path.id_type = 'OBJECT'
ob.rotation_mode = 'Mesh'
ob.display_type = 'Texture'
bpy.types.Object.made = bpy.props.FloatProperty(subtype='Object')
tree = bpy.data.node_groups.new('x', 'GeometryNodeTree')
tree.interface.new_socket('x', socket_type='NodeSocketGeometry')
tree.interface.new_socket('x', socket_type='NodeSocketFloat')
tree.interface.items_tree[1].socket_type = 'NodeSocketInt'
tree.nodes.new('GeometryNodeSwitch').input_type = 'OBJECT'
tree.nodes.new('GeometryNodeSwitch').input_type = 'Object'
area = bpy.data.screens[0].areas[0]
area.type = 'NODE_EDITOR'
area.ui_type = 'ShaderNodeTree'
area.ui_type = 'CompositorNodeTree'
bpy.context.scene.render.engine = 'Scene'
"""


def test_the_name_of_a_class_is_refused_where_blender_refuses_it(
    rule_checker: Checker, tmp_path: Path
) -> None:
    lines = _LINES.splitlines()
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = rule_checker.check(_LINES, rules=["unknown-value"])
    assert [one.span.line for one in found] == refused
    assert len(refused) == 14


_ENGINE = (
    "import bpy\nclass Own(bpy.types.RenderEngine):\n    bl_idname = 'OWN_RENDER'\n    bl_label = 'Own'\n"
)
_USED = """\
import bpy
render = bpy.context.scene.render
if render.engine != "OWN_RENDER":
    render.engine = "OWN_RENDER"
"""


def test_engines_of_a_package_are_values_in_all_its_files(rule_checker: Checker) -> None:
    rules = ["never-true", "unknown-value"]
    assert len(rule_checker.check(_USED, rules=rules)) == 2
    assert rule_checker.check(_ENGINE + _USED, rules=rules) == []
    reads = rule_checker.read_files({"addon/__init__.py": _ENGINE, "addon/panels.py": _USED})
    package = rule_checker.package(reads.values())
    assert rule_checker.check(reads["addon/panels.py"], package, rules) == []
