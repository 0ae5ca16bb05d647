"""Baking with an engine that cannot is found: each script is run, and fails or does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = "import bpy\nbpy.ops.wm.read_factory_settings()\n"
_BAKE = "bpy.ops.object.bake(type='DIFFUSE')"
_ENGINE = "bpy.context.scene.render.engine = "
_WRONG = {
    "a new file's": (_BAKE, "note"),
    "workbench": (f"{_ENGINE}'BLENDER_WORKBENCH'\n{_BAKE}", "error"),
    "of a name": (
        f"render = bpy.context.scene.render\nrender.engine = 'BLENDER_WORKBENCH'\n{_BAKE}",
        "error",
    ),
    "of a constant": (f"ENGINE = 'BLENDER_WORKBENCH'\n{_ENGINE}ENGINE\n{_BAKE}", "error"),
    "in a function": (f"def bake():\n    {_BAKE}\n{_ENGINE}'BLENDER_WORKBENCH'\nbake()", "error"),
}
_SOUND = {
    "Cycles": f"{_ENGINE}'CYCLES'\n{_BAKE}",
    "Cycles at last": f"{_ENGINE}'BLENDER_WORKBENCH'\n{_ENGINE}'CYCLES'\n{_BAKE}",
    "chosen": f"for engine in ('CYCLES',):\n    {_ENGINE}engine\n{_BAKE}",
    "set by its name": f"setattr(bpy.context.scene.render, 'engine', 'CYCLES')\n{_BAKE}",
    "caught": f"try:\n    {_BAKE}\nexcept RuntimeError:\n    pass",
    "asked": f"if bpy.context.scene.render.engine == 'CYCLES':\n    {_BAKE}",
    "never called": f"def bake():\n    {_BAKE}\nprint()",
}


def test_baking_without_cycles_is_found(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code, _ in _WRONG.values()])
    assert [name for name, (error, *_) in zip(_WRONG, answers, strict=True) if "baking" not in error] == []
    found = {name: check("wrong-engine", f"{_START}{code}\n") for name, (code, _) in _WRONG.items()}
    severities = {name: [finding.severity for finding in findings] for name, findings in found.items()}
    assert severities == {name: [severity] for name, (_, severity) in _WRONG.items()}


def test_what_bakes_or_does_not_run_has_no_finding(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _SOUND.values()])
    assert [(name, error) for name, (error, *_) in zip(_SOUND, answers, strict=True) if error] == []
    assert [name for name, code in _SOUND.items() if check("wrong-engine", f"{_START}{code}\n")] == []
