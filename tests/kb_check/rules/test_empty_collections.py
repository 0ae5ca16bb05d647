"""Elements of collections that new things have empty."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_MADE = """\
import bpy
mesh = bpy.data.meshes.new('m')
ob = bpy.data.objects.new('o', mesh)
scene = bpy.data.scenes.new('s')
curve = bpy.data.curves.new('c', 'CURVE')
tree = bpy.data.node_groups.new('g', 'GeometryNodeTree')
action = bpy.data.actions.new('a')
armature = bpy.data.armatures.new('r')
group = bpy.data.collections.new('k')
pencil = bpy.data.grease_pencils.new('p')
camera = bpy.data.cameras.new('c')
material = bpy.data.materials.new('m')
world = bpy.data.worlds.new('w')
lattice = bpy.data.lattices.new('l')
compositor = bpy.data.node_groups.new('c', 'CompositorNodeTree')
scene.compositing_node_group = compositor
bpy.context.scene.collection.objects.link(ob)
ob.select_set(True)
"""
_LINES = """\
mesh.materials[0] = material
ob.data.materials[0].name = 'x'
ob.material_slots[0].material = material
ob.modifiers['Cloth'].settings.quality = 5
ob.constraints['Track To'].influence = 0.5
ob.vertex_groups['Pin'].name = 'x'
ob.vertex_groups[-1].name = 'x'
ob.particle_systems[0].name = 'x'
mesh.vertices[0].co = (0, 0, 0)
mesh.polygons[0].use_smooth = True
mesh.uv_layers[0].name = 'x'
mesh.attributes['x'].name = 'y'
mesh.color_attributes[0].name = 'y'
curve.splines[0].use_cyclic_u = True
tree.nodes['Group Input'].location = (0, 0)
tree.links[0].is_valid
compositor.nodes['Composite'].location = (0, 0)
tree.interface.items_tree['Geometry'].name = 'x'
action.slots[0].name_display
action.layers[0].strips
armature.bones['Bone'].use_deform = True
armature.collections['Arm'].name = 'x'
group.objects['x'].name = 'y'
group.children[0].name = 'y'
pencil.layers['Lines'].hide = True
scene.timeline_markers['x'].frame = 4
scene.objects['Cube'].name = 'y'
camera.background_images[0].alpha = 0.5
scene.view_layers[0].name = 'x'
scene.render.views[0].name
lattice.points[0].co
material.node_tree.nodes['Principled BSDF'].location = (0, 0)
material.node_tree.nodes[0].location = (0, 0)
bpy.data.objects['o'].name
mesh.vertices[:]
ob.modifiers.get('Cloth')
"""


def found(checker: Checker, line: str, before: str = "") -> bool:
    return bool(checker.check(f"{_MADE}{before}{line}\n", rules=["empty-collection"]))


def test_elements_that_new_things_do_not_have_are_found(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _LINES.splitlines()
    outcomes = run_statements(tmp_path, [*_MADE.splitlines(), *lines])[-len(lines) :]
    refused = [line for line, (error, *_) in zip(lines, outcomes, strict=True) if error]
    assert [line for line in lines if found(rule_checker, line)] == refused
    assert len(refused) == 28


@pytest.mark.parametrize(
    ("line", "before"),
    [
        ("mesh.materials[0].name", "mesh.materials.append(material)\n"),
        ("mesh.materials[0].name", "ob.active_material = material\n"),
        ("mesh.materials[0].name", "ob.data = bpy.data.meshes['x']\nob.data.materials.append(material)\n"),
        ("ob.material_slots[0].name", "mesh.materials.append(material)\n"),
        ("ob.particle_systems[0].name", "ob.modifiers.new('p', 'PARTICLE_SYSTEM')\n"),
        ("mesh.vertices[0].co", "mesh.from_pydata([(0, 0, 0)], [], [])\n"),
        ("mesh.vertices[0].co", "import bmesh\nbm = bmesh.new()\nbm.to_mesh(mesh)\n"),
        ("mesh.vertices[0].co", "def fill(it):\n    it.from_pydata([(0, 0, 0)], [], [])\nfill(mesh)\n"),
        ("mesh.vertices[0].co", "bpy.ops.object.editmode_toggle()\n"),
        ("ob.modifiers['Cloth'].name", "import rigging\n"),
        ("ob.modifiers['Cloth'].name", "setattr(ob, 'x', 1)\n"),
        ("ob.modifiers['Cloth'].name", "if ob.modifiers:\n    pass\n"),
        ("ob.modifiers['Cloth'].name", "path = 'modifiers'\n"),
        ("action.layers[0].strips", "ob.animation_data_create().action = action\n"),
        ("scene.objects['Cube'].name", "scene.collection.objects.link(ob)\n"),
    ],
)
def test_what_may_have_been_filled_is_left_alone(rule_checker: Checker, line: str, before: str) -> None:
    assert found(rule_checker, line)
    assert not found(rule_checker, line, before)


def test_what_is_tried_or_was_there_is_left_alone(rule_checker: Checker) -> None:
    assert not found(rule_checker, "try:\n    mesh.materials[0]\nexcept IndexError:\n    pass")
    assert not found(rule_checker, "bpy.context.object.material_slots[0].material")


def test_what_an_object_has_of_its_older_data_is_left_alone(rule_checker: Checker) -> None:
    older = "bpy.data.objects.new('p', bpy.data.meshes['x']).{}[0].name"
    assert not found(rule_checker, older.format("material_slots"))
    assert not found(rule_checker, older.format("vertex_groups"))


# What the operators make

_MADE_BY_OPERATOR = """\
import bpy
bpy.ops.mesh.primitive_cube_add()
ob = bpy.context.active_object
mesh = ob.data
"""
# Each leaves what was there before with as much as it had.
_PLAIN = """\
bpy.ops.object.light_add(type='AREA', location=(0, 0, 4))
bpy.ops.object.camera_add(location=(7, -7, 5))
bpy.ops.object.empty_add()
bpy.ops.object.text_add()
bpy.ops.object.armature_add()
bpy.ops.object.metaball_add()
bpy.ops.object.volume_add()
bpy.ops.object.speaker_add()
bpy.ops.object.lightprobe_add(type='SPHERE')
bpy.ops.object.grease_pencil_add(type='STROKE')
bpy.ops.object.effector_add(type='FORCE')
bpy.ops.curve.primitive_bezier_circle_add()
bpy.ops.surface.primitive_nurbs_surface_torus_add()
bpy.ops.mesh.primitive_monkey_add()
bpy.ops.mesh.primitive_torus_add()
ob.select_set(True)
bpy.ops.object.shade_flat()
bpy.ops.object.shade_smooth()
bpy.ops.object.parent_clear()
bpy.ops.object.origin_set(type='ORIGIN_GEOMETRY')
bpy.ops.transform.translate(value=(0, 0, 1))
bpy.ops.transform.rotate(value=1.0)
bpy.ops.transform.resize(value=(2, 2, 2))
bpy.ops.wm.save_as_mainfile(filepath='plain.blend')
"""
_OF_PRIMITIVES = """\
ob.material_slots[0].material = None
ob.data.materials[0] = None
mesh.materials[0].name
ob.modifiers[0].name = 'x'
ob.constraints['Track To'].influence = 0.5
ob.vertex_groups['Pin'].name = 'x'
ob.particle_systems[0].name = 'x'
mesh.color_attributes[0].name = 'x'
mesh.uv_layers[0].name = 'x'
mesh.vertices[0].co = (0, 0, 0)
mesh.polygons[0].use_smooth = True
mesh.edges[0].use_seam = True
"""


def test_what_operators_make_has_no_elements_either(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _OF_PRIMITIVES.splitlines()
    before = f"{_MADE_BY_OPERATOR}{_PLAIN}"
    outcomes = run_statements(tmp_path, [*before.splitlines(), *lines])
    assert not any(error for error, *_ in outcomes[: -len(lines)])
    refused = [line for line, (error, *_) in zip(lines, outcomes[-len(lines) :], strict=True) if error]
    told = [line for line in lines if rule_checker.check(f"{before}{line}\n", rules=["empty-collection"])]
    assert told == refused
    assert len(refused) == 8


@pytest.mark.parametrize(
    "before",
    [
        "bpy.ops.object.shade_auto_smooth()\n",
        "bpy.ops.object.modifier_add(type='SUBSURF')\n",
        "bpy.ops.object.quick_fur()\n",
        "bpy.context.view_layer.objects.active = bpy.data.objects['Cube']\n",
        "if ob.modifiers:\n    pass\n",
    ],
)
def test_what_may_fill_what_an_operator_made_is_heeded(rule_checker: Checker, before: str) -> None:
    def told(script: str) -> bool:
        return bool(rule_checker.check(script, rules=["empty-collection"]))

    made = "import bpy\nbpy.ops.mesh.primitive_cube_add()\n"
    read = "bpy.context.object.modifiers[0].name\n"
    assert told(f"{made}ob = bpy.context.object\n{read}")
    assert not told(f"{made}ob = bpy.context.object\n{before}{read}")


def test_an_active_object_of_another_kind_is_left_alone(rule_checker: Checker) -> None:
    made = "import bpy\nbpy.ops.mesh.primitive_cube_add()\nbpy.ops.object.grease_pencil_add(type='STROKE')\n"
    read = "bpy.context.object.material_slots[0].name\n"
    assert not rule_checker.check(f"{made}{read}", rules=["empty-collection"])
    posed = made.replace("grease_pencil_add(type='STROKE')", "armature_add()")
    assert not rule_checker.check(f"{posed}bpy.context.object.pose.bones\n", rules=["empty-pointer"])
