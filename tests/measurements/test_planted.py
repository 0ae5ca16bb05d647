"""Mistakes that are planted: they are where they are said to be, and are mistakes in the running Blender."""

from __future__ import annotations

import ast
from collections import Counter
from contextlib import closing
from textwrap import dedent
from typing import TYPE_CHECKING

import pytest

from kb_build.flow.blender.symbols import BaseSymbols
from kb_check.checker import Checker
from measurements.planted import KINDS, found, plant
from measurements.planted_places import Places

if TYPE_CHECKING:
    from pathlib import Path

SCRIPT = """
import bpy


class OBJECT_OT_example(bpy.types.Operator):
    bl_idname = "object.example"
    bl_label = "Example"

    def execute(self, context):
        scene = context.scene
        scene.render.engine = 'CYCLES'
        bpy.ops.mesh.primitive_cube_add(size=2.0, align='WORLD')
        for ob in bpy.data.objects:
            ob.hide_render = True
        tree = something()
        node = tree.nodes.new("ShaderNodeBsdfPrincipled")
        node.inputs["Base Color"].default_value = (1, 1, 1, 1)
        row = self.layout.row()
        row.label(text="Ä")
        row.prop(scene, "frame_start", icon='NONE')
        return {'FINISHED'}

    def other(self, thing):
        if hasattr(thing, "x"):
            bpy.context.scene.frame_start
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    templates = tmp_path / "templates_py"
    templates.mkdir()
    (templates / "example.py").write_text(SCRIPT, encoding="utf-8")
    (templates / "broken.py").write_text("def f(:", encoding="utf-8")
    return tmp_path


def test_one_mistake_of_each_kind_is_planted_and_found(base: Path, folder: Path) -> None:
    mistakes = list(plant(base, folder, 70))
    assert set(Counter(mistake.kind for mistake in mistakes)) == set(KINDS)
    before = SCRIPT.splitlines()
    with Checker(base) as checker:
        for mistake in mistakes:
            after = mistake.code.splitlines()
            assert after[mistake.line - 1] != before[mistake.line - 1]
            ast.parse(mistake.code)
        assert [one for one in mistakes if not found(checker, one, Counter())] == []


def test_what_is_planted_is_the_same_for_a_seed(base: Path, folder: Path) -> None:
    first, again, other = (list(plant(base, folder, 21, seed)) for seed in (1, 1, 2))
    assert first == again
    assert first != other


def test_a_finding_that_was_there_before_does_not_count(base: Path, folder: Path) -> None:
    mistake = next(one for one in plant(base, folder, 7) if one.kind == "operator")
    with Checker(base) as checker:
        findings = checker.check(mistake.code)
        assert found(checker, mistake, Counter())
        assert not found(checker, mistake, Counter((one.rule, one.message) for one in findings))


def test_places_are_told_without_the_checker(base: Path) -> None:
    with closing(BaseSymbols(base)) as symbols:
        rows = {(place.kind, place.symbol.path) for place in Places(symbols).of(ast.parse(dedent(SCRIPT)))}
    assert ("attribute", "bpy.types.Object.hide_render") in rows
    assert ("value", "bpy.types.RenderSettings.engine") in rows
    assert ("keyword", "bpy.ops.mesh.primitive_cube_add") in rows
    assert ("socket", 'bpy.types.ShaderNodeBsdfPrincipled.inputs["Base Color"]') in rows
    assert ("call", "bpy.types.UILayout.label") in rows
    assert ("attribute", "bpy.types.Scene.frame_start") not in rows  # beside hasattr
