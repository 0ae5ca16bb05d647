"""Custom properties where there are none: of operators, of preferences, and of what is registered."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from other_versions import base_of, errors_in
from statements_in_blender import run_statements

from kb_check.checker import Checker
from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from pathlib import Path

_OPERATOR = """\
class Count{at}(bpy.types.Operator):
    bl_idname = "object.count{at}"
    bl_label = "Count"
    number: bpy.props.IntProperty()

    def execute(self, context):
        {line}
        return {{'FINISHED'}}

bpy.utils.register_class(Count{at})
bpy.ops.object.count{at}()
"""
_LINES = [
    "self['number'] = 3",
    "print(self['number'])",
    "print('number' in self)",
    "print('number' not in self)",
    "self.keys()",
    "self.get('number')",
    "self.number = 3",
    "self.properties['number'] = 3",
    "print('number' in self.properties)",
    "self.properties.keys()",
]


def test_operators_have_none(rule_checker: Checker, tmp_path: Path) -> None:
    parts = [_OPERATOR.format(at=at, line=line) for at, line in enumerate(_LINES)]
    refused = [
        at for at, (error, *_) in enumerate(run_statements(tmp_path, ["import bpy", *parts])[1:]) if error
    ]
    found = [
        at
        for at, part in enumerate(parts)
        if rule_checker.check(f"import bpy\n{part}", rules=["no-custom-properties"])
    ]
    assert found == refused == [0, 1, 2, 3, 4, 5]


def test_what_a_class_answers_itself_is_no_finding(rule_checker: Checker) -> None:
    part = _OPERATOR.format(at="", line="self['number'] + self.get('x')")
    own = "    def __getitem__(self, key): return 1\n    def get(self, key): return 2\n"
    code = f"import bpy\n{part}".replace("    number", f"{own}    number", 1)
    assert rule_checker.check(code, rules=["no-custom-properties"]) == []


def test_a_key_that_is_a_property_is_written_as_one(rule_checker: Checker) -> None:
    code = "import bpy\n" + _OPERATOR.format(at="", line=_LINES[0])
    (found,) = rule_checker.check(code, rules=["no-custom-properties"])
    assert found.fix is not None
    assert (found.fix.sure, found.fix.edits[0].text) == (False, ".number")


_PREFERENCES: str = """\
import bpy
mine = bpy.context.preferences.addons['io_scene_gltf2'].preferences
mine.keys()
print('x' in mine)
mine['x'] = 3
mine.get('x')
mine.bl_idname
print(bpy.context.preferences.addons.keys())
print('x' in bpy.context.preferences.addons)
"""


def test_preferences_have_none(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _PREFERENCES.splitlines()
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = rule_checker.check(_PREFERENCES, rules=["no-custom-properties"])
    assert [one.span.line for one in found] == refused == [3, 4, 5, 6]


_REGISTERED: str = """\
import bpy
scene = bpy.context.scene
bpy.types.Scene.count = bpy.props.IntProperty()
bpy.types.Scene.own = bpy.props.IntProperty(get=lambda self: self["own"])
scene.count = 5
scene["count"] = 3
print(scene["count"])
print(scene.get("count"))
print("count" in scene)
scene["own"] = 3
scene["other"] = 3
bpy.context.object["count"] = 3
"""


def test_a_registered_property_is_no_custom_one(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _REGISTERED.splitlines()
    seen = run_statements(tmp_path, lines, {5: "scene.count", 6: "scene['count']"})
    # What is set in brackets changes nothing.
    assert (seen[5][1:], seen[6][1]) == (["5", "5"], "3")
    found = rule_checker.check(_REGISTERED, rules=["property-by-key"])
    assert [one.span.line for one in found] == [6, 7, 8, 9]
    assert all(one.severity == "warning" for one in found)
    assert [one.fix.edits[0].text for one in found if one.fix] == [".count", ".count"]


_OF_CYCLES: str = """\
import bpy
scene = bpy.context.scene
scene.cycles.samples = 5
scene["cycles"] = {"samples": 3}
scene["cycles"]["samples"] = 3
print("cycles" in scene)
scene["frames"] = 3
bpy.context.view_layer["cycles"]["use_denoising"] = False
"""


def test_what_cycles_registers_is_no_custom_property(rule_checker: Checker, tmp_path: Path) -> None:
    seen = run_statements(
        tmp_path, _OF_CYCLES.splitlines(), {4: "scene.cycles.samples", 5: "scene.cycles.samples"}
    )
    # What is set in brackets changes nothing.
    assert (seen[4][2], seen[5][2]) == ("5", "5")
    found = rule_checker.check(_OF_CYCLES, rules=["property-by-key"])
    assert [one.span.line for one in found] == [4, 5, 6, 8]
    # Nothing is assigned to the group itself.
    assert [one.fix.edits[0].text if one.fix else "" for one in found] == ["", ".cycles", "", ".cycles"]


_OF_GROUP: str = """\
import bpy
bpy.types.PropertyGroup.count = bpy.props.IntProperty()
class Own(bpy.types.PropertyGroup): count: bpy.props.IntProperty()
bpy.utils.register_class(Own)
bpy.types.Scene.own = bpy.props.PointerProperty(type=Own)
bpy.context.scene.own["count"] = 3
"""


def test_a_property_of_a_group_is_kept_in_its_dictionary(rule_checker: Checker, tmp_path: Path) -> None:
    seen = run_statements(tmp_path, _OF_GROUP.splitlines(), {5: "bpy.context.scene.own.count"})
    assert seen[5][2] == "3"
    assert rule_checker.check(_OF_GROUP, rules=["property-by-key"]) == []


@pytest.mark.parametrize(
    ("line", "refused"),
    [
        ("print(Own.__annotations__['count'][1])", True),
        ("print(Own.__annotations__['count'][0])", True),
        ("print(Own.__annotations__['count'].keywords)", False),
        ("print(Own.__annotations__['count'])", False),
        ("print({'x': (1, 2)}['x'][1])", False),
    ],
)
def test_a_declaration_has_no_items(
    rule_checker: Checker, tmp_path: Path, line: str, *, refused: bool
) -> None:
    start = ["import bpy", "class Own(bpy.types.PropertyGroup): count: bpy.props.IntProperty(default=1)"]
    seen = run_statements(tmp_path, [*start, line])
    found = rule_checker.check("\n".join([*start, line]), rules=["not-subscriptable"])
    assert (bool(seen[2][0]), bool(found)) == (refused, refused)


_OF_MODIFIER: str = """\
import bpy
modifier = bpy.data.objects["Cube"].modifiers.new("Nodes", "NODES")
modifier.node_group = group = bpy.data.node_groups.new("Group", "GeometryNodeTree")
size = group.interface.new_socket("Size", in_out="INPUT", socket_type="NodeSocketFloat")
assert size.identifier == "Socket_0"
modifier["Socket_0"] = 2.0
modifier[size.identifier] = 3.0
modifier["Socket_0_use_attribute"] = True
modifier[size.identifier + "_attribute_name"] = "size"
print(modifier.get("Socket_0"))
print("Socket_0" in modifier)
modifier.id_properties_ui("Socket_0")
modifier.properties["Socket_0"] = 2.0
modifier.properties.inputs["Socket_0"]
bpy.data.objects["Cube"]["Socket_0"] = 2.0
"""


@pytest.mark.blender
def test_geometry_nodes_modifiers_have_none_where_their_inputs_are_properties(tmp_path: Path) -> None:
    with Checker(base_of("5.2")) as checker:
        found = checker.check(_OF_MODIFIER, rules=["no-custom-properties"])
    errors = errors_in("5.2", tmp_path, _OF_MODIFIER.splitlines())
    refused = [at for at, error in enumerate(errors, 1) if error]
    assert [one.span.line for one in found] == refused == [6, 7, 8, 9, 10, 11, 12, 13]
    mended = {one.span.line: one.fix.edits[0].text for one in found if one.fix}
    lines = _OF_MODIFIER.splitlines()
    for at, text in mended.items():
        lines[at - 1] = f"{text} = {lines[at - 1].rpartition(' = ')[2]}"
    assert list(mended) == [6, 7, 9, 13]
    now = errors_in("5.2", tmp_path, lines)
    assert [at for at, error in enumerate(now, 1) if error] == [8, 10, 11, 12]


_IN_PATHS: str = """\
import bpy
ob = bpy.data.objects["Cube"]
modifier = ob.modifiers.new("Nodes", "NODES")
modifier.node_group = group = bpy.data.node_groups.new("Group", "GeometryNodeTree")
size = group.interface.new_socket("Size", in_out="INPUT", socket_type="NodeSocketFloat")
modifier.keyframe_insert('["Socket_0"]', frame=1)
modifier.keyframe_insert(data_path=f'["{size.identifier}"]', frame=1)
ob.keyframe_insert('modifiers["Nodes"]["Socket_0"]', frame=2)
ob.keyframe_insert(f'modifiers["{modifier.name}"]["{size.identifier}"]', frame=2)
ob.driver_add('modifiers["Nodes"]["Socket_0"]')
ob["own"] = 1.0
ob.keyframe_insert('["own"]', frame=1)
ob.keyframe_insert(f'["{"own"}"]', frame=1)
modifier.keyframe_insert("show_viewport", frame=1)
"""


@pytest.mark.blender
def test_paths_to_inputs_of_geometry_nodes_go_through_their_properties(tmp_path: Path) -> None:
    lines = _IN_PATHS.splitlines()
    with Checker(base_of("5.2")) as checker:
        found = checker.check(_IN_PATHS, rules=["refused-path"])
    errors = errors_in("5.2", tmp_path, lines)
    assert (
        [one.span.line for one in found]
        == [at for at, error in enumerate(errors, 1) if error]
        == [*range(6, 11)]
    )
    assert [bool(one.fix) for one in found] == [True, False, True, False, True]
    now = errors_in("5.2", tmp_path, apply_fixes(Source(_IN_PATHS), found).text.splitlines())
    assert [at for at, error in enumerate(now, 1) if error] == [7, 9]


def test_paths_to_inputs_of_geometry_nodes_are_keys_before(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _IN_PATHS.splitlines()
    assert not any(row[0] for row in run_statements(tmp_path, lines))
    assert not rule_checker.check(_IN_PATHS, rules=["refused-path"])


def test_geometry_nodes_modifiers_have_them_where_their_inputs_are_keys(
    rule_checker: Checker, tmp_path: Path
) -> None:
    lines = _OF_MODIFIER.splitlines()[:11]
    assert [error for error, *_ in run_statements(tmp_path, lines) if error] == []
    assert rule_checker.check("\n".join(lines), rules=["no-custom-properties"]) == []


_ARRAYS = {
    "scene['sizes'].append(3)": True,
    "sizes = scene['sizes']\nsizes.extend((3, 4))": True,
    "print(scene['color'].x)": True,
    "print(scene['made'].index_of)": True,
    "print(scene['sizes'].to_list(), scene['sizes'].typecode)": False,
    "scene['sizes'][0] = 4": False,
    "print(scene['names'].append('c'))": False,
    "scene['mixed'].append(3)": False,
    "held['sizes'].append(3)": False,
}
_KEPT = """\
import bpy
scene = bpy.context.scene
scene["sizes"] = [1, 2]
scene["color"] = (1.0, 0.5, 0.0)
scene["made"] = [one for one in range(3)]
scene["names"] = ["a", "b"]
scene["mixed"] = [1, 2]
scene["mixed"] = ["a"]
held = {}
held["sizes"] = [1]
"""


def test_the_numbers_of_a_list_are_kept_as_an_array(rule_checker: Checker, tmp_path: Path) -> None:
    done = run_statements(tmp_path, [f"{_KEPT}{line}" for line in _ARRAYS])
    found = [bool(rule_checker.check(f"{_KEPT}{line}\n", rules=["list-attribute"])) for line in _ARRAYS]
    assert found == [bool(error) for error, *_ in done] == [*_ARRAYS.values()]
