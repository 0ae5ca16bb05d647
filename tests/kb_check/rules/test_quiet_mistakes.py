"""Rules about what Blender lets pass: clamped numbers, statements that do nothing, what runs in no window."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

SETTING = """\
import bpy, mathutils
scene = bpy.context.scene
mesh = bpy.data.meshes.new("mesh")
mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
ob = bpy.data.objects.new("object", mesh)
scene.collection.objects.link(ob)
material = bpy.data.materials.new("material")
light = bpy.data.lights.new("light", 'SPOT')
ob.location = (3, 4, 5)
ob.rotation_euler = (1, 0, 0)
tree = bpy.data.node_groups.new("tree", 'ShaderNodeTree')
principled = tree.nodes.new('ShaderNodeBsdfPrincipled')
""".splitlines()

CLAMPED = {
    "material.roughness = 5": "material.roughness",
    "material.roughness = -5": "material.roughness",
    "light.spot_size = 45": "light.spot_size",
    "scene.render.resolution_percentage = 0": "scene.render.resolution_percentage",
    "scene.frame_step = -1": "scene.frame_step",
    "light.color = (2, -1, 0)": "light.color[1]",
    "bpy.ops.mesh.primitive_circle_add(vertices=1)": "len(bpy.context.object.data.vertices)",
}
KEPT = {
    "material.roughness = 0.5": "material.roughness",
    "material.roughness = 1": "material.roughness",
    "light.color = (2, 1, 0)": "light.color[0]",
    "principled.inputs['Metallic'].default_value = 5": "principled.inputs['Metallic'].default_value",
    "principled.inputs['IOR'].default_value = -5": "principled.inputs['IOR'].default_value",
}
IDLE = {
    "ob.location.normalized()": "ob.location",
    "ob.matrix_world.inverted()": "ob.matrix_world",
    "ob.location.copy()": "ob.location",
    "ob.name.replace('o', 'a')": "ob.name",
    "ob.location.xy.x = 9": "ob.location",
    "ob.location.copy().x += 9": "ob.location",
    "ob.rotation_euler.to_matrix()[0][0] = 9": "ob.rotation_euler",
    "ob.matrix_world.to_translation().x = 9": "ob.matrix_world",
    "bpy.context.selected_objects.append(ob)": "bpy.context.selected_objects",
    "scene.tool_settings.snap_elements.add('VERTEX')": "scene.tool_settings.snap_elements",
    "scene.render.resolution_x == 5": "scene.render.resolution_x",
    "bpy.context.view_layer.objects.active == ob": "bpy.context.view_layer.objects.active",
    "mesh.vertices.foreach_set('normal', [1, 0, 0] * 3)": "mesh.vertices[0].normal",
    "mesh.polygons.foreach_set('loop_total', [2])": "mesh.polygons[0].loop_total",
}
WORKING = {
    "ob.location.normalize()": "ob.location",
    "ob.matrix_world.invert()": "ob.matrix_world",
    "ob.location.x = 9": "ob.location",
    "ob.location.xy = (8, 9)": "ob.location",
    "ob.location[0] = 7": "ob.location",
    "ob.matrix_world.translation.x = 9": "ob.matrix_world",
    "ob.matrix_world.col[3].y = 9": "ob.matrix_world",
    "ob.matrix_world[0][3] = 5": "ob.matrix_world",
    "ob.scale *= 2": "ob.scale",
    "ob.name = ob.name.replace('o', 'a')": "ob.name",
    "scene.tool_settings.snap_elements = {'VERTEX'}": "scene.tool_settings.snap_elements",
    "mesh.vertices.foreach_set('co', [1, 0, 0] * 3)": "mesh.vertices[0].co",
}


def lines_of(checker: Checker, rule: str, lines: list[str]) -> list[str]:
    findings = checker.check("\n".join([*SETTING, *lines]), rules=[rule])
    return [lines[finding.span.line - 1 - len(SETTING)] for finding in findings]


def test_clamped_numbers_are_what_blender_makes_of_them(rule_checker: Checker, tmp_path: Path) -> None:
    lines = list(CLAMPED)
    watched = {place + len(SETTING): value for place, value in enumerate(CLAMPED.values())}
    answers = run_statements(tmp_path, [*SETTING, *lines], watched)[len(SETTING) :]
    findings = rule_checker.check("\n".join([*SETTING, *lines]), rules=["out-of-range"])
    assert [finding.span.line - 1 - len(SETTING) for finding in findings] == list(range(len(lines)))
    for finding, (error, _, after) in zip(findings, answers, strict=True):
        assert not error
        kept = finding.message.partition("becomes ")[2].partition(" ")[0].rstrip(".")
        assert float(kept) == pytest.approx(float(after), rel=1e-4)
    assert "math.radians(45)" in findings[2].message


def test_large_integers_are_written_whole(rule_checker: Checker) -> None:
    (found,) = rule_checker.check("import bpy\nbpy.ops.mesh.primitive_circle_add(vertices=123456789)")
    assert "holds 3 … 10000000: 123456789 becomes 10000000." in found.message
    assert found.fix is not None
    assert found.fix.edits[0].text == "10000000"


def test_numbers_that_are_kept_are_no_finding(rule_checker: Checker, tmp_path: Path) -> None:
    lines = list(KEPT)
    watched = {place + len(SETTING): value for place, value in enumerate(KEPT.values())}
    answers = run_statements(tmp_path, [*SETTING, *lines], watched)[len(SETTING) :]
    for line, (error, _, after) in zip(lines, answers, strict=True):
        given = ast.literal_eval(line.partition(" = ")[2])
        assert not error
        assert float(after) == (given[0] if isinstance(given, tuple) else given)
    assert lines_of(rule_checker, "out-of-range", lines) == []


@pytest.mark.parametrize("statements", [IDLE, WORKING])
def test_what_does_nothing_in_blender_is_found(
    rule_checker: Checker, tmp_path: Path, statements: dict[str, str]
) -> None:
    lines = list(statements)
    watched = {place + len(SETTING): value for place, value in enumerate(statements.values())}
    answers = run_statements(tmp_path, [*SETTING, *lines], watched)[len(SETTING) :]
    assert [line for line, (error, *_) in zip(lines, answers, strict=True) if error] == []
    idle = [line for line, (_, before, after) in zip(lines, answers, strict=True) if before == after]
    assert idle == (lines if statements is IDLE else [])
    assert lines_of(rule_checker, "no-effect", lines) == idle


MADE = """\
import bpy
camera = bpy.data.cameras.new("camera")
ob = bpy.data.objects.new("camera", camera)
bpy.context.scene.collection.objects.link(ob)
light = bpy.data.lights.new("light", 'SPOT')
bpy.ops.mesh.primitive_cube_add()
cube = bpy.context.object
bpy.ops.rigidbody.object_add()
cloth = bpy.data.objects.new("cloth", bpy.data.meshes.new("cloth")).modifiers.new("Cloth", 'CLOTH')
""".splitlines()
# What is set → the switch that is off.
SWITCHED_OFF = {
    "camera.dof.focus_distance = 3": "camera.dof.use_dof",
    "ob.data.dof.aperture_fstop = 1.2": "camera.dof.use_dof",
    "light.cutoff_distance = 2": "light.use_custom_distance",
    "cube.rigid_body.use_start_deactivated = True": "cube.rigid_body.use_deactivation",
    "cloth.settings.uniform_pressure_force = 5": "cloth.settings.use_pressure",
}


# What is set on something new → the choice with which panels show it.
NOT_SHOWN = {
    'bpy.data.lights.new("a", "AREA").size_y = 2': "`shape` is 'ELLIPSE' or 'RECTANGLE'",
    'bpy.data.particles.new("a").instance_object = bpy.data.objects.new("a", None)': "`render_type` is 'OBJECT'",
    'bpy.data.objects.new("a", None).rotation_quaternion = (0, 1, 0, 0)': "`rotation_mode` is 'QUATERNION'",
    'bpy.data.objects.new("a", None).rotation_euler = (0, 1, 0)': "",
    'ob = bpy.data.objects.new("a", None)\nob.rotation_mode = "QUATERNION"\nob.rotation_quaternion = (0, 1, 0, 0)': "",
    'bpy.data.worlds.new("a").mist_settings.falloff = "LINEAR"': "",
    'bpy.data.lights.new("a", "AREA").size = 2': "",
    'lamp = bpy.data.lights.new("a", "AREA")\nlamp.shape = "RECTANGLE"\nlamp.size_y = 2': "",
    'bpy.data.lights["a"].size_y = 2': "",
}


@pytest.mark.parametrize(("code", "told"), NOT_SHOWN.items())
def test_settings_that_panels_show_with_another_choice_are_found(check: Check, code: str, told: str) -> None:
    found = check("switched-off", f"import bpy\n{code}\n")
    assert [one.message.partition(" only if ")[2].partition(". ")[0] for one in found] == (
        [told] if told else []
    )


def test_settings_whose_switch_is_off_are_found(rule_checker: Checker, tmp_path: Path) -> None:
    lines = list(SWITCHED_OFF)
    watched = {place + len(MADE): switch for place, switch in enumerate(SWITCHED_OFF.values())}
    answers = run_statements(tmp_path, [*MADE, *lines], watched)[len(MADE) :]
    assert [(error, after) for error, _, after in answers] == [("", "False")] * len(lines)
    found = rule_checker.check("\n".join([*MADE, *lines]), rules=["switched-off"])
    assert [finding.span.line - 1 - len(MADE) for finding in found] == list(range(len(lines)))
    for finding, switch in zip(found, SWITCHED_OFF.values(), strict=True):
        assert f"unless `{switch.rpartition('.')[2]}` is on" in finding.message


CUBE = """\
import bpy
bpy.ops.mesh.primitive_cube_add()
cube = bpy.context.object
other = bpy.data.objects.new("other", cube.data.copy())
other.location = 0.3, 0.4, 0.9
some = bpy.data.collections.new("some")
some.objects.link(other)
bpy.context.scene.collection.children.link(some)
""".splitlines()
SHAPE = "[tuple(v.co) for v in cube.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices]"
# A modifier, a setting that has no effect on a new one, what gives it one, and another value.
IDLE_SETTINGS = [
    ("ARRAY", "constant_offset_displace = (0, 0, 3)", "use_constant_offset = True",
     "constant_offset_displace = (0, 0, 5)"),
    ("ARRAY", "constant_offset_displace.z = 3", "use_constant_offset = True", "constant_offset_displace.z = 5"),
    ("ARRAY", "constant_offset_displace[2] = 3", "use_constant_offset = True", "constant_offset_displace[2] = 5"),
    ("ARRAY", "fit_length = 8", "fit_type = 'FIT_LENGTH'", "fit_length = 12"),
    ("DECIMATE", "angle_limit = 0.5", "decimate_type = 'DISSOLVE'", "angle_limit = 2"),
    ("REMESH", "octree_depth = 2", "mode = 'BLOCKS'", "octree_depth = 4"),
    ("CAST", "size = 3", "use_radius_as_size = False", "size = 5"),
    ("BOOLEAN", "collection = bpy.data.collections['some']", "operand_type = 'COLLECTION'", "collection = None"),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "setting", "switch", "again"), IDLE_SETTINGS)
def test_settings_of_modifiers_without_an_effect_are_found(
    rule_checker: Checker, tmp_path: Path, kind: str, setting: str, switch: str, again: str
) -> None:
    made = [*CUBE, f"modifier = cube.modifiers.new('new', '{kind}')"]
    lines = [*made, f"modifier.{setting}", f"modifier.{switch}", f"modifier.{again}"]
    idle, _, working = run_statements(tmp_path, lines, dict.fromkeys(range(len(made), len(lines)), SHAPE))[
        len(made) :
    ]
    assert (idle[0], working[0]) == ("", "")
    assert idle[1] == idle[2]
    assert working[1] != working[2]
    [finding] = rule_checker.check("\n".join(lines[: len(made) + 1]), rules=["switched-off"])
    assert finding.span.line == len(made) + 1
    name, _, value = switch.partition(" = ")
    assert f"has no effect unless `{name}` is" in finding.message
    assert value in finding.message.replace(" on.", " True.").replace(" off.", " False.")
    assert rule_checker.check("\n".join(lines), rules=["switched-off"]) == []


def test_what_another_setting_changes_is_as_usual_without_that(check: Check) -> None:
    code = "import bpy\nglass = bpy.data.materials.new('Glass')\nglass.use_raytrace_refraction = True\n"
    assert check("switched-off", code) == []


@pytest.mark.parametrize(
    "code",
    [
        # Turned on, somewhere or in some other way.
        "camera.dof.use_dof = True\ncamera.dof.focus_distance = 3",
        "camera.dof.focus_distance = 3\nfor c in bpy.data.cameras:\n    c.dof.use_dof = True",
        "camera.dof.focus_distance = 3\ncamera.dof.keyframe_insert('use_dof')",
        "camera.dof.focus_distance = 3\nsetattr(camera.dof, 'use' + '_dof', True)",
        "camera.dof.focus_distance = 3\nfrom .setup import finish",
        "from studio import finish\ncamera.dof.focus_distance = 3\nfinish(camera)",
        # Not made here, or perhaps not.
        "bpy.data.cameras['Camera'].dof.focus_distance = 3",
        "bpy.context.scene.camera.data.dof.focus_distance = 3",
        "other = bpy.data.objects.new('x', bpy.data.cameras[0])\nother.data.dof.focus_distance = 3",
        "camera = bpy.data.cameras[0]\ncamera.dof.focus_distance = 3",
        "for camera in bpy.data.cameras:\n    camera.dof.focus_distance = 3",
        "def f(camera):\n    camera.dof.focus_distance = 3",
        # What a new one has; no switch; one that is on.
        "camera.dof.focus_distance = 10.0",
        "camera.lens = 35",
        "light = bpy.data.lights.new('x', 'SPOT')\nlight.shadow_filter_radius = 3",
    ],
)
def test_settings_that_may_be_switched_on_are_no_finding(check: Check, code: str) -> None:
    assert check("switched-off", f"import bpy\ncamera = bpy.data.cameras.new('x')\n{code}\n") == []


def test_in_place_twin_is_offered(check: Check) -> None:
    [finding] = check("no-effect", "import mathutils\nv = mathutils.Vector()\nv.normalized()\n")
    assert finding.instead == ("mathutils.Vector.normalize",)
    assert finding.fix is not None
    assert not finding.fix.sure


def test_a_deprecated_property_without_successor_is_told_once(check: Check) -> None:
    code = "import bpy\nfor material in bpy.data.materials:\n    material.use_nodes = True\n"
    [finding] = check("deprecated", f"{code}    print(material.use_nodes)\n")
    assert "The same holds for 1 more in this file." in finding.message


def test_deprecated_property_names_its_successor(check: Check, rule_checker: Checker) -> None:
    code = "import bpy\nfor strip in bpy.context.scene.sequence_editor.strips:\n    print(strip.frame_final_start)\n"
    symbol = rule_checker.api.symbols.symbol("bpy.types.Strip.frame_final_start")
    if symbol is None or symbol.deprecation is None:
        pytest.skip("this Blender does not mark it")
    [finding] = check("deprecated", code)
    assert finding.severity == "warning"
    assert finding.instead == ("bpy.types.Strip.left_handle",)
    assert finding.fix is not None
    assert finding.fix.edits[0].text == "left_handle"
    assert check("deprecated", code.replace("frame_final_start", "name")) == []


HEADLESS = [
    "bpy.ops.view3d.view_selected()",
    "bpy.ops.text.new()",
    "bpy.ops.outliner.orphans_purge()",
    "bpy.ops.node.add_node(type='ShaderNodeMath')",
    "bpy.ops.mesh.primitive_cube_add()",
    "bpy.ops.console.clear()",
    "bpy.ops.screen.screen_full_area()",
    "bpy.context.area.tag_redraw()",
    "bpy.context.region.width",
    "bpy.context.space_data.shading.type = 'SOLID'",
    "bpy.context.region_data.view_distance",
    "bpy.context.window.screen.areas",
    "bpy.context.screen.areas[0].tag_redraw()",
]


def test_contexts_are_those_that_a_blender_without_window_lacks(
    rule_checker: Checker, tmp_path: Path
) -> None:
    answers = run_statements(tmp_path, ["import bpy", *HEADLESS])[1:]
    refused = [line for line, (error, *_) in zip(HEADLESS, answers, strict=True) if error]
    assert len(refused) > 7
    found = rule_checker.check("\n".join(["import bpy", *HEADLESS]), rules=["needs-context"])
    assert [HEADLESS[finding.span.line - 2] for finding in found] == refused


@pytest.mark.parametrize(
    "code",
    [
        "with bpy.context.temp_override(area=area):\n    bpy.ops.view3d.view_selected()",
        "if not bpy.app.background:\n    bpy.ops.view3d.view_selected()",
        "if bpy.ops.view3d.view_selected.poll():\n    bpy.ops.view3d.view_selected()",
        "def register():\n    bpy.ops.view3d.view_selected()",
        "class A(bpy.types.Operator):\n    def execute(self, _):\n        bpy.ops.view3d.view_all()\nprint(A)",
        "def show():\n    bpy.ops.view3d.view_selected()",
        "def show():\n    bpy.ops.view3d.view_selected()\n\ndef draw():\n    show()\n\nprint(draw)",
        "if bpy.context.area:\n    bpy.context.area.tag_redraw()",
        "def show(context):\n    context.area.tag_redraw()\n\nshow(bpy.context)",
    ],
)
def test_given_contexts_are_no_finding(check: Check, code: str) -> None:
    assert check("needs-context", f"import bpy\n{code}\n") == []


def test_what_can_be_given_instead_of_an_area_is_told(check: Check) -> None:
    [finding] = check("needs-context", "import bpy\nbpy.ops.ed.lib_id_generate_preview()\n")
    assert "temp_override(id=…)" in finding.message
    [finding] = check("needs-context", "import bpy\nbpy.ops.ptcache.bake(bake=True)\n")
    assert "temp_override(point_cache=…)" in finding.message
    [finding] = check("needs-context", "import bpy\nbpy.ops.text.select_all()\n")  # would end Blender
    assert "area=…" in finding.message


def test_handlers_that_add_up_are_found(check: Check) -> None:
    code = "import bpy\ndef follow(scene):\n    pass\nbpy.app.handlers.frame_change_pre.append(follow)\n"
    [finding] = check("runs-twice", code)
    assert (finding.severity, finding.span.line) == ("note", 4)
    assert len(check("runs-twice", "import bpy\nbpy.types.VIEW3D_MT_add.append(print)\n")) == 1


def test_a_guard_that_asks_for_a_function_of_this_run_is_in_vain(check: Check) -> None:
    code = """
    import bpy
    def follow(scene):
        pass
    if follow not in bpy.app.handlers.frame_change_pre:
        bpy.app.handlers.frame_change_pre.append(follow)
    """
    [finding] = check("runs-twice", code)
    assert "`follow not in bpy.app.handlers.frame_change_pre` is true each time" in finding.message
    looked_into = code + "print(len(bpy.app.handlers.frame_change_pre))\n"
    assert check("runs-twice", looked_into.replace("print", "    print")) == []


@pytest.mark.parametrize(
    "code",
    [
        "bpy.app.handlers.load_post.clear()\nbpy.app.handlers.load_post.append(print)",
        "if print not in bpy.app.handlers.load_post:\n    bpy.app.handlers.load_post.append(print)",
        "def register():\n    bpy.app.handlers.load_post.append(print)",
        "rows = []\nrows.append(print)",
    ],
)
def test_lists_that_are_looked_after_are_no_finding(check: Check, code: str) -> None:
    assert check("runs-twice", f"import bpy\n{code}\n") == []


@pytest.mark.parametrize("rule", ["out-of-range", "no-effect", "deprecated", "needs-context", "runs-twice"])
def test_values_that_are_not_sure_are_no_finding(check: Check, rule: str) -> None:
    code = """
    import bpy
    def f(thing, x):
        thing.roughness = 5
        thing.normalized()
        thing.xy.x = 1
        thing.frame_final_start
        thing.append(x)
        thing == x
    """
    assert check(rule, code) == []
