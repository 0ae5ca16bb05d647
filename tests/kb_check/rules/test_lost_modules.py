"""Modules that Blender, or the Python which it brings, has lost."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_build.flow.blender.facts import LOST_MODULES

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker


def test_they_are_found_where_python_refuses_them(rule_checker: Checker, tmp_path: Path) -> None:
    lines = [f"import {name}" for name in (*LOST_MODULES, "os", "json", "importlib")]
    lines += ["from cgi import escape", "import os, imp", "import xml.dom, imp as i"]
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    assert [one.span.line for one in rule_checker.check("\n".join(lines))] == refused
    assert len(refused) == len(LOST_MODULES) + 3


def test_those_of_blender_say_what_they_are_called(rule_checker: Checker, tmp_path: Path) -> None:
    lines = ["import rna_info, bpy_types", "from bl_ui_utils.layout import operator_context", "import bge"]
    lines += ["import _rna_info", "from _bl_ui_utils.layout import operator_context"]
    refused = {at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error}
    findings = rule_checker.check("\n".join(lines))
    assert {one.span.line for one in findings} == refused == {1, 2, 3}
    told = "\n".join(one.message for one in findings)
    assert all(part in told for part in ("`_rna_info`", "`_bl_ui_utils`", "`bpy.types`", "game engine"))


def test_modules_offer_classes_from_elsewhere(rule_checker: Checker, tmp_path: Path) -> None:
    lines = ["from bpy.utils.toolsystem import ToolDef", "from bpy.utils.toolsystem import ToolDefs"]
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    assert [one.span.line for one in rule_checker.check("\n".join(lines))] == refused == [2]


@pytest.mark.parametrize(
    "code",
    [
        "try:\n    import imp\nexcept ImportError:\n    imp = None\n",
        "import bpy\nif bpy.app.version < (5, 1, 0):\n    import imp\n",
        "import sys\nsys.path.append('lib')\nimport chunk\n",
        "from . import imp\n",
    ],
)
def test_what_may_be_there_is_no_finding(rule_checker: Checker, code: str) -> None:
    assert rule_checker.check(code) == []


def test_a_file_of_that_name_is_it(rule_checker: Checker) -> None:
    files = {"addon/chunk.py": "SIZE = 1\n", "addon/main.py": "import chunk\n"}
    reads = rule_checker.read_files(files)
    assert rule_checker.check(reads["addon/main.py"], rule_checker.package(reads.values())) == []
