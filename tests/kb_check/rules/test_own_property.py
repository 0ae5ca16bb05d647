"""What a script does with properties that it declares itself: Blender refuses what is found, and nothing else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

pytestmark = pytest.mark.blender

_RULES = ["own-property", "wrong-type", "unknown-attribute", "unknown-keyword", "unknown-value"]
_CLASSES: str = """\
import bpy
KINDS = [("FIRST", "First", ""), ("SECOND", "Second", "")]
class Part(bpy.types.PropertyGroup):
    size: bpy.props.FloatProperty()
class Settings(bpy.types.PropertyGroup):
    parts: bpy.props.CollectionProperty(type=Part)
    one: bpy.props.PointerProperty(type=Part)
    kind: bpy.props.EnumProperty(items=KINDS)
    several: bpy.props.EnumProperty(items=KINDS, options={"ENUM_FLAG"})
    computed: bpy.props.EnumProperty(items=lambda self, context: KINDS)
    is_on: bpy.props.BoolProperty()
    count: bpy.props.IntProperty(min=0, max=3)
    size: bpy.props.FloatProperty()
    title: bpy.props.StringProperty()
    raw: bpy.props.StringProperty(subtype="BYTE_STRING")
    offset: bpy.props.FloatVectorProperty()
    pair: bpy.props.IntVectorProperty(size=2)
    flags: bpy.props.BoolVectorProperty(size=3)
    matrix: bpy.props.FloatVectorProperty(size=(4, 4), subtype="MATRIX")
    turn: bpy.props.FloatVectorProperty(size=4, subtype="QUATERNION")
    target: bpy.props.PointerProperty(type=bpy.types.Object)
    total: bpy.props.IntProperty(get=lambda self: 1)
    kept: bpy.props.IntProperty(get=lambda self: 1, set=lambda self, value: None)
    def doubled(self):
        return self.count * 2
class OBJECT_OT_grow(bpy.types.Operator):
    bl_idname = "object.grow"
    bl_label = "Grow"
    amount: bpy.props.IntProperty()
    kind: bpy.props.EnumProperty(items=KINDS)
    def execute(self, context):
        return {"FINISHED"}
class Alike(bpy.types.PropertyGroup):
    def __getattr__(self, name):
        return 1
for cls in (Part, Settings, OBJECT_OT_grow, Alike):
    bpy.utils.register_class(cls)
bpy.types.Scene.settings = bpy.props.PointerProperty(type=Settings)
bpy.types.Scene.alike = bpy.props.PointerProperty(type=Alike)
bpy.types.Object.weight = bpy.props.FloatProperty()
bpy.types.Object.rank = bpy.props.EnumProperty(items=KINDS)
s = bpy.context.scene.settings
ob = bpy.context.object
part = s.parts.add()
op = bpy.context.window_manager.operator_properties_last("object.grow")
"""
_LINES: list[str] = [
    "s.kind = 'THIRD'",
    "s.kind = 'SECOND'",
    "s.kind = 1",
    "s.kind = {'FIRST'}",
    "s.several = {'THIRD'}",
    "s.several = {'FIRST', 'SECOND'}",
    "s.several = 'FIRST'",
    "s.computed = 'SECOND'",
    "s.is_on = 'yes'",
    "s.is_on = True",
    "s.count = 1.5",
    "s.count = '1'",
    "s.count = 7",
    "s.size = '1'",
    "s.size = 1",
    "s.title = 1",
    "s.title = 'a'",
    "s.title = None",
    "s.raw = 'a'",
    "s.raw = b'a'",
    "s.offset = (1, 2)",
    "s.offset = (1, 2, 3)",
    "s.offset = 1",
    "s.pair = (1.5, 2)",
    "s.pair = (1, 2)",
    "s.flags = (True, False, True)",
    "s.flags = (1, 0, 1)",
    "s.matrix = [[1.0] * 4] * 4",
    "s.turn.to_euler()",
    "s.turn.to_axis()",
    "ob.matrix_world.to_3x3().rotate(s.turn)",
    "ob.matrix_world.to_3x3().rotate(s.offset)",
    "s.target = ob",
    "s.target = None",
    "s.target = bpy.data.meshes['Cube']",
    "s.target = 'Cube'",
    "s.one = s.one",
    "s.one.size = 2",
    "s.one.size = 'large'",
    "s.parts.append(part)",
    "s.parts.add().size = 1",
    "s.parts.add().size = 'x'",
    "s.parts[0].size = (1, 2)",
    "s.total = 2",
    "s.kept = 'any'",
    "s.modes",
    "s.doubled()",
    "s.bl_rna.identifier",
    "s.name",
    "s.id_data.name",
    "bpy.context.scene.settings = None",
    "bpy.context.scene.alike.anything",
    "ob.weight = 'heavy'",
    "ob.weight = 3",
    "ob.rank = 'THIRD'",
    "bpy.context.scene.settings.kind = 'FOURTH'",
    "bpy.ops.object.grow(count=3)",
    "bpy.ops.object.grow(amount=3)",
    "bpy.ops.object.grow('EXEC_DEFAULT', amount=3, kind='SECOND')",
    "bpy.ops.object.grow(amount=1.5)",
    "bpy.ops.object.grow(kind='THIRD')",
    "op.amount = 2",
    "op.count = 2",
    "op.count",
    "op.kind = 'THIRD'",
    "op.amount = 'x'",
]


def test_what_blender_refuses_is_found_and_nothing_else(rule_checker: Checker, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [_CLASSES, *_LINES])
    assert not answers[0][0]
    refused = {line: answer[0] for line, answer in zip(_LINES, answers[1:], strict=True) if answer[0]}
    refused.pop("s.kept = 'any'")  # told by its type alone, before its own function is asked
    found = rule_checker.check(_CLASSES + "\n".join(_LINES), rules=_RULES)
    start = _CLASSES.count("\n") + 1
    told = {_LINES[finding.span.line - start] for finding in found if finding.severity == "error"}
    assert told == set(refused)
    assert len(refused) > len(_LINES) // 2


def test_a_collection_is_not_assigned_to(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [_CLASSES, "s.parts = []"])
    assert "read-only" in answers[1][0]
    (found,) = check("own-property", f"{_CLASSES}s.parts = []\n")
    assert found.message == "`Settings.parts` is read-only: `add`, `remove` and `clear` change it."


def test_what_is_kept_nowhere_is_lost(check: Check, tmp_path: Path) -> None:
    lost = "bpy.context.scene.settings.last = 3"
    answers = run_statements(tmp_path, [_CLASSES, lost, "bpy.context.scene.settings.last"])
    assert [answer[0].partition(":")[0] for answer in answers] == ["", "", "AttributeError"]
    (found,) = check("own-property", f"{_CLASSES}{lost}\n")
    assert (found.severity, "lost when it is read again" in found.message) == ("warning", True)
    assert check("own-property", f"{_CLASSES}s.last = 3\nprint(s.last)\n") == []


@pytest.mark.parametrize(
    ("line", "count"),
    [
        ("s.kind == 'THIRD'", 1),
        ("s.kind in {'THIRD', 'FIRST'}", 1),
        ("s.kind == 'FIRST'", 0),
        ("s.kind == ''", 0),
        ("s.computed == 'THIRD'", 0),
    ],
)
def test_comparisons_that_never_hold_are_warned_of(check: Check, line: str, count: int) -> None:
    found = check("own-property", f"{_CLASSES}{line}\n")
    assert [finding.severity for finding in found] == ["warning"] * count


@pytest.mark.parametrize(
    "change",
    [
        "Settings.__annotations__['modes'] = bpy.props.IntProperty()",
        "setattr(Settings, 'mo' + 'des', 1)",
        "Settings.modes = bpy.props.IntProperty()",
        "hasattr(s, 'modes')",
        "def fill(one):\n    one.modes = 3",
        "KINDS.append(('THIRD', 'Third', ''))",
    ],
)
def test_what_is_declared_out_of_sight_is_no_finding(check: Check, change: str) -> None:
    line = "s.kind = 'THIRD'" if "KINDS" in change else "s.modes"
    assert check("own-property", f"{_CLASSES}{line}\n")
    assert check("own-property", f"{_CLASSES}{change}\n{line}\n") == []


_PANEL = """\
class VIEW3D_PT_grow(bpy.types.Panel):
    bl_label, bl_space_type, bl_region_type = "Grow", "VIEW_3D", "UI"
    def draw(self, context):
        {}
bpy.utils.register_class(VIEW3D_PT_grow)
"""


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('self.layout.operator("object.grow").count = 3', "takes no `count`. It declares `amount`, `kind`."),
        ('self.layout.operator(OBJECT_OT_grow.bl_idname).count = 3', "takes no `count`"),
        ('self.layout.operator(OBJECT_OT_grow.bl_idname).kind = "THIRD"', "none of the items"),
        ('self.layout.operator(OBJECT_OT_grow.bl_idname).amount = 3', ""),
        ('self.layout.prop(context.scene.settings, "modes")', "`Settings` has no `modes`"),
        ('self.layout.prop(context.scene.settings, "kind")', ""),
        ('self.layout.template_list("UI_UL_list", "", s, "part", s, "count")', "Closest: `parts`"),
        ('self.layout.template_list("UI_UL_list", "", s, "parts", s, "count")', ""),
        ('self.layout.prop_search(s, "kind", s, "part")', "Closest: `parts`"),
        ('self.layout.prop_search(s, "kind", s, "parts")', ""),
        ('self.label(text="x")', "`VIEW3D_PT_grow` has no `label`. The layout has it: `layout.label`."),
        ('self.bl_label', ""),
    ],
)  # fmt: skip
def test_what_a_panel_shows_is_read(check: Check, line: str, message: str) -> None:
    found = check("own-property", _CLASSES + _PANEL.format(line))
    assert len(found) == bool(message)
    assert all(message in finding.message for finding in found)


def test_a_module_that_the_script_makes_is_known(check: Check, tmp_path: Path) -> None:
    classes = _CLASSES.replace("object.grow", "garden.grow")
    answers = run_statements(tmp_path, [classes, "bpy.ops.garden.grow()", "bpy.ops.garden.mow()"])
    assert [bool(answer[0]) for answer in answers] == [False, False, True]
    (found,) = check("own-property", f"{classes}bpy.ops.garden.grow()\nbpy.ops.garden.mow()\n")
    assert found.message == "`bpy.ops.garden` has no `mow`: this script makes `bpy.ops.garden.grow`."


def test_preferences_are_drawn_with_a_layout(check: Check) -> None:
    preferences = """\
class Preferences(bpy.types.AddonPreferences):
    bl_idname = __name__
    size: bpy.props.IntProperty()
    def draw(self, context):
        self.layout.prop(self, "size")
bpy.utils.register_class(Preferences)
"""
    assert check("own-property", _CLASSES + preferences) == []
    (found,) = check("own-property", _CLASSES + preferences.replace('"size")', '"size", text=self.sizes)'))
    assert "`Preferences` has no `sizes`" in found.message


def test_a_macro_takes_what_its_operators_do(check: Check, tmp_path: Path) -> None:
    macro = """\
class OBJECT_OT_both(bpy.types.Macro):
    bl_idname = "object.both"
    bl_label = "Both"
bpy.utils.register_class(OBJECT_OT_both)
OBJECT_OT_both.define("OBJECT_OT_grow")
bpy.ops.object.both(OBJECT_OT_grow={"amount": 2})
"""
    (answer,) = run_statements(tmp_path, [_CLASSES + macro])
    assert not answer[0]
    assert check("own-property", _CLASSES + macro) == []


def test_what_is_set_on_another_thing_is_no_proof(check: Check) -> None:
    more = "part.modes = 1\nprint('modes')\n"
    rows = check("own-property", f"{_CLASSES}{more}s.modes\n")
    assert "`Settings` has no `modes`." in " ".join(finding.message for finding in rows)


def test_errors_that_are_caught_are_no_finding(check: Check) -> None:
    ready = "try:\n    s.kind = 'THIRD'\n    s.modes\n    s.count = 'x'\nexcept Exception:\n    pass\n"
    assert check("own-property", _CLASSES + ready) == check("wrong-type", _CLASSES + ready) == []


def test_the_name_that_is_near_is_told(check: Check) -> None:
    (found,) = check("own-property", f"{_CLASSES}bpy.ops.object.grow(amuont=3)\n")
    assert (
        found.message
        == "`bpy.ops.object.grow`, which this script makes, takes no `amuont`. Closest: `amount`."
    )
    assert found.fix
    assert [edit.text for edit in found.fix.edits] == ["amount"]


def test_a_property_takes_the_place_of_an_inherited_one(check: Check, tmp_path: Path) -> None:
    start = "bpy.types.Object.tag = bpy.props.StringProperty()\n"
    lines = [
        "ob.tag = 'a'",
        "ob.tag = 3",
        "bpy.data.meshes['Cube'].tag = 'a'",
        "bpy.data.meshes['Cube'].tag = True",
    ]
    answers = run_statements(tmp_path, [_CLASSES + start, *lines])
    refused = [line for line, answer in zip(lines, answers[1:], strict=True) if answer[0]]
    found = check("wrong-type", _CLASSES + start + "\n".join(lines))
    first = (_CLASSES + start).count("\n") + 1
    assert [lines[finding.span.line - first] for finding in found] == refused == lines[1:3]


def test_a_button_for_a_custom_property_of_an_own_group_is_no_finding(check: Check) -> None:
    panel = """
class VIEW3D_PT_parts(bpy.types.Panel):
    bl_label = "Parts"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Parts"
    def draw(self, context):
        self.layout.prop(s, '["extra"]')
        self.layout.prop(s, "extra")
"""
    (found,) = check("own-property", _CLASSES + panel)
    assert "`extra`" in found.message


def test_what_is_given_to_an_own_group_doubts_nothing_else(rule_checker: Checker) -> None:
    code = f"{_CLASSES}bpy.context.object.foo = 3\ns.one.unknown = 2\nbpy.ops.mesh.primitive_cube_add(radius=1)\n"
    found = [(one.rule, one.span.line - code.count("\n")) for one in rule_checker.check(code)]
    assert found == [("unknown-attribute", -2), ("own-property", -1), ("unknown-keyword", 0)]
