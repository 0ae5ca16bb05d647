"""Ends of ranges that Blender does not keep to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_START = """\
import bpy
scene = bpy.context.scene
ob = bpy.data.objects['Cube']
bpy.context.view_layer.objects.active = ob
bpy.ops.rigidbody.object_add()
body = ob.rigid_body
empty = bpy.data.objects.new('Empty', None)
scene.collection.objects.link(empty)
bpy.context.view_layer.objects.active = empty
bpy.ops.rigidbody.constraint_add()
hinge = empty.rigid_body_constraint
camera = bpy.data.cameras.new('Camera')
particles = bpy.data.particles.new('Hair')
cloth = ob.modifiers.new('Cloth', 'CLOTH').settings
""".splitlines()
# Each with what it sets.
_LINES = {
    f"{target} = {value}": target
    for target, value in (
        ("body.mass", -1),
        ("body.mass", 0.0005),
        ("body.friction", -1),
        ("body.restitution", -1),
        ("body.collision_margin", -1),
        ("body.linear_damping", 2),
        ("body.angular_damping", -1),
        ("hinge.breaking_threshold", -1),
        ("hinge.solver_iterations", 5000),
        ("hinge.spring_stiffness_x", -1),
        ("particles.hair_length", -1),
        ("scene.frame_current", 2000000),
        ("cloth.tension_stiffness", 20000),
        # These have a range that is kept, or one end of it.
        ("body.use_margin", True),
        ("camera.lens", 0),
        ("camera.dof.aperture_ratio", 0),
        ("particles.count", -5),
        ("cloth.mass", -1),
        ("cloth.quality", 500),
        ("cloth.sewing_force_max", -1),
    )
}


def test_only_what_changes_is_found_beyond_ranges(rule_checker: Checker, tmp_path: Path) -> None:
    lines = [*_START, *_LINES]
    watched = {len(_START) + place: target for place, target in enumerate(_LINES.values())}
    answers = run_statements(tmp_path, lines, watched)
    assert [error for error, *_ in answers if error] == []
    changed = [
        line
        for line, (_, _, after) in zip(_LINES, answers[len(_START) :], strict=True)
        if float(eval(after)) != pytest.approx(float(eval(line.partition(" = ")[2])))
    ]
    assert changed
    found = rule_checker.check("\n".join(lines), rules=["out-of-range"])
    assert [lines[finding.span.line - 1] for finding in found] == changed
