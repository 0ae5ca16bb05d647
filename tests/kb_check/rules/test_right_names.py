"""The fixes that write right names are sure only where the script then does what it was meant to."""

from __future__ import annotations

from textwrap import dedent
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.checker import Checker
    from kb_check.findings import Finding

_LOST = {"unknown-attribute", "unknown-operator", "unknown-keyword", "never-true", "unknown-value"}


def _fixes(checker: Checker, code: str) -> Iterator[tuple[Finding, list[str], bool]]:
    """(finding, what its fix writes, whether it is sure)."""
    for found in checker.check("import bpy\n" + dedent(code)):
        if found.rule in _LOST:
            texts = [edit.text for edit in found.fix.edits] if found.fix else []
            yield found, texts, bool(found.fix and found.fix.sure)


def _sure(checker: Checker, code: str) -> list[list[str]]:
    return [texts for _, texts, sure in _fixes(checker, code) if sure]


@pytest.mark.parametrize(
    ("code", "has_it", "told"),
    [
        ("scene.fps = 30", "RenderSettings.fps", "Its `.render` has it: `.render.fps`"),
        ("scene.samples = 8", "CyclesRenderSettings.samples", "Its `.cycles` has it"),
        ("light.energy = 100", "PointLight.energy", "Its `.data` has it"),
        ("cam.data.use_dof = True", "CameraDOFSettings.use_dof", "Its `.dof` has it"),
        ("cam.data.location = (1, 2, 3)", "Object.location", "The object that has such data has it: `obj.location`"),
        ("mesh.modifiers.new('x', 'ARRAY')", "Object.modifiers", "The object that has such data has it"),
        ("cloth.settings.use_self_collision = True", "ClothCollisionSettings.use_self_collision",
         "`.collision_settings`, which stands beside this `.settings`, has it"),
        ("scene.render.frame_start = 1", "Scene.frame_start", "`Scene` has it"),
    ],
)  # fmt: skip
def test_what_another_part_has_is_told(rule_checker: Checker, code: str, has_it: str, told: str) -> None:
    before = """\
import bpy
scene = bpy.context.scene
light = bpy.data.objects.new("l", bpy.data.lights.new("l", "POINT"))
cam = bpy.data.objects.new("c", bpy.data.cameras.new("c"))
mesh = bpy.data.meshes.new("m")
cloth = bpy.data.objects.new("m", mesh).modifiers.new("c", "CLOTH")
"""
    [found] = rule_checker.check(before + code, rules=["unknown-attribute"])
    assert told in found.message
    assert f"bpy.types.{has_it}" in found.instead


@pytest.mark.parametrize(
    ("code", "meant"),
    [
        ("bpy.context.object.keyframe_insert(data_path='loc')", "location"),
        ("bpy.context.object.loc = (0, 0, 1)", "location"),
        ("bpy.data.meshes[0].verts", "vertices"),
        ("bpy.context.scene.cam = bpy.context.object", "camera"),
        ("bpy.data.lights[0].col = (1, 0, 0)", "color"),
    ],
)
def test_the_name_that_is_shortened_is_told_first(rule_checker: Checker, code: str, meant: str) -> None:
    (found,) = rule_checker.check(f"import bpy\n{code}", rules=["unknown-attribute"])
    assert found.instead[0].endswith(f".{meant}")


def test_no_fix_of_a_comparison_is_sure(rule_checker: Checker) -> None:
    code = "if bpy.context.object.type == 'GPENCIL':\n    pass"
    assert [(texts, sure) for _, texts, sure in _fixes(rule_checker, code)] == [(["'GREASEPENCIL'"], False)]


def test_a_value_that_went_for_good_is_one_note_a_file(rule_checker: Checker) -> None:
    code = """
        class Rows(bpy.types.UIList):
            def draw_item(self, context, layout, data, item, icon, active_data, active_propname, index):
                if self.layout_type == 'GRID':
                    pass
                elif self.layout_type == 'GRID':
                    pass
    """
    ((found, texts, _),) = _fixes(rule_checker, code)
    assert (found.severity, found.span.line, texts) == ("note", 5, [])
    assert "1 more in this file" in found.message


@pytest.mark.parametrize(
    "given",
    [
        "mat.transparency_method = kind",
        "mat.transparency_method = 'MASK' if kind else 'RAYTRACE'",
        "print(mat.transparency_method == 'MASK')",
        "print('MASK' != mat.transparency_method)",
        "print(mat.transparency_method in {'MASK', 'RAYTRACE'})",
    ],
)
def test_a_name_is_not_sure_where_its_values_went_too(rule_checker: Checker, given: str) -> None:
    code = f"def f(kind):\n    mat = bpy.data.materials.new('x')\n    {given}\n"
    found = list(_fixes(rule_checker, code))
    assert ["surface_render_method"] in [texts for _, texts, _ in found]
    assert not any(sure for *_, sure in found)


@pytest.mark.parametrize(
    "code",
    [
        "mat = bpy.data.materials.new('x')\nmat.transparency_method = 'Z_TRANSPARENCY'",
        "tex = bpy.data.materials.new('x').node_tree.nodes.new('ShaderNodeTexVoronoi')\ntex.coloring = 'CELLS'",
        "con = bpy.context.object.constraints.new('ARMATURE')\ncon.target = bpy.context.object",
        "group = bpy.data.node_groups.new('x', 'CompositorNodeTree')\n"
        "out = group.nodes.new('CompositorNodeOutputFile')\n"
        "out.file_slots[0].path = 'a'",
    ],
)
def test_a_name_that_refuses_what_is_given_is_not_written(rule_checker: Checker, code: str) -> None:
    found = rule_checker.check(f"import bpy\n{code}\n")
    assert any(finding.severity == "error" for finding in found)
    assert [finding.fix for finding in found if finding.severity == "error"] == [None] * len(found)


@pytest.mark.parametrize(
    "given", ["ob.draw_type = 'WIRE'", "ob.draw_type = kind", "print(ob.draw_type == 'WIRE')"]
)
def test_a_name_is_sure_where_its_values_stay(rule_checker: Checker, given: str) -> None:
    code = f"def f(kind):\n    ob = bpy.data.objects['x']\n    {given}\n"
    assert _sure(rule_checker, code) == [["display_type"]]


@pytest.mark.parametrize(
    "read",
    [
        "node.file_slots.values()[0].path = 'x'",
        "slots = node.file_slots\nslots[0].path = 'x'",
        "for slot in node.file_slots:\n    slot.path = 'x'",
        "print([slot.path for slot in node.file_slots])",
    ],
)
def test_what_is_read_from_a_lost_name_is_not_fixed_alone(rule_checker: Checker, read: str) -> None:
    code = """\
tree = bpy.data.node_groups.new('c', 'CompositorNodeTree')
node = tree.nodes.new('CompositorNodeOutputFile')
"""
    assert sorted((one.symbol, sure) for one, _, sure in _fixes(rule_checker, code + read)) == [
        ("bpy.types.CompositorNodeOutputFile.file_slots", False),
        ("bpy.types.NodeOutputFileSlotFile.path", False),
    ]


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("ob = bpy.context.scene.objects.active\nob.show_x_ray = True", "bpy.types.Object.show_x_ray"),
        ("for curve in action.fcurves:\n    curve.keyframe_pionts", "bpy.types.FCurve.keyframe_pionts"),
        ("action.fcurves.new('x', action_group='x')", "bpy.types.ActionFCurves.new(action_group)"),
        ("action.groups[0].colour_set = 'THEME01'", "bpy.types.ActionGroup.colour_set"),
    ],
)
def test_what_is_read_from_a_lost_name_has_the_type_that_it_had(
    rule_checker: Checker, code: str, told: str
) -> None:
    found = rule_checker.check(f"import bpy\naction = bpy.data.actions.new('x')\n{code}\n")
    assert [one.symbol for one in found][1:] == [told]


@pytest.mark.parametrize(
    "code",
    [
        "if hasattr(action, 'fcurves'):\n    action.{lost}",
        "if hasattr(bpy.types.Action, 'fcurves'):\n    action.{lost}",
        "if bpy.app.version < (5, 0, 0):\n    action.{lost}",
        "try:\n    action.{lost}\nexcept AttributeError:\n    pass",
        "curves = action.fcurves if hasattr(action, 'fcurves') else None\nif curves:\n    {lost}",
        "curves = getattr(action, 'fcurves', None)\nif curves:\n    {lost}",
        "try:\n    curves = action.fcurves\nexcept AttributeError:\n    curves = None\nif curves:\n    {lost}",
    ],
)
def test_what_is_read_from_a_lost_name_for_another_blender_is_not_judged(
    rule_checker: Checker, code: str
) -> None:
    lost = "fcurves.new('x', action_group='x')" if "action.{" in code else "curves.new('x', action_group='x')"
    text = f"import bpy\naction = bpy.data.actions.new('x')\n{code.format(lost=lost)}\n"
    assert rule_checker.check(text) == []


def test_an_operator_is_fixed_with_its_keywords(rule_checker: Checker) -> None:
    code = "bpy.ops.export_scene.obj(filepath='/tmp/x.obj', use_selection=True)"
    assert _sure(rule_checker, code) == [["wm.obj_export"], ["export_selected_objects"]]


@pytest.mark.parametrize("more", ["axis_forward='-Z'", "use_selection='yes'", "no_such_thing=1"])
def test_or_neither_is_sure(rule_checker: Checker, more: str) -> None:
    code = f"bpy.ops.export_scene.obj(filepath='/tmp/x.obj', use_mesh_modifiers=True, {more})"
    assert _sure(rule_checker, code) == []


def test_an_operator_of_a_lost_module_is_fixed(rule_checker: Checker) -> None:
    assert _sure(rule_checker, "bpy.ops.group.create(name='x')") == [["collection.create"]]
    assert _sure(rule_checker, "ops = bpy.ops\nops.group.create()") == [["collection.create"]]
    assert _sure(rule_checker, "ops = bpy.ops.group\nops.create()") == []


def test_nodes_of_a_tree_by_a_lost_name_are_looked_at(rule_checker: Checker) -> None:
    code = """\
import bpy
tree = bpy.context.scene.node_tree
tree.nodes.new('CompositorNodeSepRGBA')
tree.nodes.new('CompositorNodeComposite')
tree.nodes.new('CompositorNodeBlur')
tree.nodes.new('ShaderNodeMath')
"""
    found = [(one.rule, one.span.line) for one in rule_checker.check(code)]
    assert found == [("unknown-attribute", 2), ("unknown-node", 3), ("unknown-node", 4)]


def test_a_former_mode_that_a_name_holds_is_a_warning(rule_checker: Checker) -> None:
    code = """\
import bpy
mode = 'OBJECT'
if bpy.context.object.type == 'MESH':
    mode = 'EDIT_GPENCIL'
other = 'EDIT_GPENCIL'
bpy.ops.object.mode_set(mode=mode)
"""
    code += "bpy.ops.object.mode_set(mode='EDIT' if other else 'EDIT_GPENCIL')\n"
    held, chosen = rule_checker.check(code, rules=["wrong-mode"])
    assert (held.severity, held.span.line, chosen.severity, chosen.span.line) == ("warning", 4, "warning", 7)
    assert "write 'EDIT'" in held.message


@pytest.mark.parametrize(("given", "is_mended"), [("flag", False), ("kind", True), ("True", False)])
def test_a_new_name_is_not_written_where_it_takes_no_value_of_that_type(
    rule_checker: Checker, given: str, is_mended: bool
) -> None:
    code = f"""\
import bpy


def save(path: str, flag: bool = True, kind: str = "NONE"):
    bpy.ops.export_scene.gltf(filepath=path, export_colors={given})
"""
    (finding,) = rule_checker.check(code)
    assert finding.instead == ("bpy.ops.export_scene.gltf(export_vertex_color)",)
    assert (finding.fix is not None) is is_mended
