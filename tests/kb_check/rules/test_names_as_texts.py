"""Attributes that ``setattr`` and ``getattr`` name as texts: lacking where Blender raises, and nowhere else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

BEFORE = "import bpy, contextlib\nrender = bpy.context.scene.render\n"
# What Blender refuses → (the rule that finds it, the text that it is found at).
REFUSED = {
    "setattr(render, 'resolution_q', 1)": ("unknown-attribute", "'resolution_q'"),
    "name = 'resolution_q'\nsetattr(render, name, 1)": ("unknown-attribute", "name"),
    "setattr(render, 'engine', 'BLENDER_EEVEE_NEXT')": ("unknown-value", "'BLENDER_EEVEE_NEXT'"),
    "print(getattr(render, 'resolution_q'))": ("unknown-attribute", "'resolution_q'"),
    "print(getattr(bpy.data, 'sprites'))": ("unknown-attribute", "'sprites'"),
    "for k, v in {'fps': 24, 'resolution_q': 1}.items():\n    setattr(render, k, v)": (
        "unknown-attribute",
        "k",
    ),
    "for k, v in (('fps', 24), ('resolution_q', 3)):\n    setattr(render, k, v)": ("unknown-attribute", "k"),
    "for k in ['fps', 'resolution_q']:\n    print(getattr(render, k))": ("unknown-attribute", "k"),
    "made = {'engine': 'BLENDER_EEVEE_NEXT', 'fps': 24}\nfor k in made:\n    setattr(render, k, made[k])": (
        "unknown-value",
        "made[k]",
    ),
}
LOOP = "for k, v in {'fps': 24, 'resolution_q': 3}.items():\n"
RUNNING = [
    "setattr(render, 'resolution_x', 64)",
    "setattr(render, 'engine', 'CYCLES')",
    "print(getattr(render, 'resolution_q', 3))",
    "bpy.types.Scene.mine = bpy.props.IntProperty()\nsetattr(bpy.context.scene, 'mine', 3)",
    f"{LOOP}    if hasattr(render, k):\n        setattr(render, k, v)",
    f"{LOOP}    if not hasattr(render, k):\n        continue\n    setattr(render, k, v)",
    f"{LOOP}    if getattr(render, k, None) is not None:\n        setattr(render, k, v)",
    f"{LOOP}    if k in dir(render):\n        setattr(render, k, v)",
    f"{LOOP}    if k in render.bl_rna.properties:\n        setattr(render, k, v)",
    f"{LOOP}    if k in render.bl_rna.properties.keys():\n        print(getattr(render, k))",
    f"{LOOP}    if k.startswith('f'):\n        setattr(render, k, v)",
    f"{LOOP}    if k == 'fps':\n        setattr(render, k, v)",
    f"{LOOP}    try:\n        setattr(render, k, v)\n    except Exception as error:\n        print(error)",
    f"{LOOP}    with contextlib.suppress(AttributeError):\n        setattr(render, k, v)",
    "print([getattr(render, k) for k in ('fps', 'resolution_q') if hasattr(render, k)])",
    "print({k: getattr(render, k) for k in ('fps', 'resolution_q') if k in dir(render)})",
    "def put(thing, k, v):\n    if hasattr(thing, k):\n        setattr(thing, k, v)\nput(render, 'resolution_q', 3)",
    "def put(thing, k, v):\n    try:\n        setattr(thing, k, v)\n    except AttributeError:\n        pass\n"
    "put(render, 'resolution_q', 3)",
    "for k, old in (('fps', 'resolution_q'),):\n    if not hasattr(render, k):\n        k = old\n"
    "    setattr(render, k, 2)",
    "for k in ['resolution_q'] if bpy.app.version < (3, 0, 0) else ['fps']:\n    setattr(render, k, 3)",
    "for p in render.bl_rna.properties:\n    print(getattr(render, p.identifier))",
    "print(getattr(bpy.types, 'Nothing', None), getattr(bpy.ops.mesh, 'no_such'))",
]


def test_names_that_blender_refuses_are_found(rule_checker: Checker, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [BEFORE, *REFUSED])[1:]
    assert [error for error, *_ in answers if not error] == []
    for code, (rule, text) in REFUSED.items():
        lines = (BEFORE + code).splitlines()
        [finding] = rule_checker.check(BEFORE + code)
        assert finding.rule == rule, code
        span = finding.span
        assert lines[span.line - 1][span.column : span.end_column] == text


@pytest.mark.parametrize("code", RUNNING)
def test_names_that_a_script_is_ready_for_are_no_finding(
    rule_checker: Checker, tmp_path: Path, code: str
) -> None:
    [(error, *_)] = run_statements(tmp_path, [BEFORE, code])[1:]
    assert error == ""
    assert rule_checker.check(BEFORE + code) == []
