"""Values that RNA lists and that stand for nothing, and those that it lists as far as this machine has them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_BODY = """\
import bpy
bpy.context.view_layer.objects.active = bpy.data.objects['Cube']
bpy.data.objects['Cube'].select_set(True)
bpy.ops.rigidbody.object_add()
""".splitlines()
_CYCLES = ["import bpy", "cycles = bpy.context.scene.cycles"]


def _compared(checker: Checker, folder: Path, rule: str, start: Sequence[str], lines: list[str]) -> list[str]:
    """The lines that Blender refuses, which are those that a rule finds."""
    answers = run_statements(folder, [*start, *lines])
    assert not any(error for error, *_ in answers[: len(start)])
    refused = [line for line, (error, *_) in zip(lines, answers[len(start) :], strict=True) if error]
    found = checker.check("\n".join([*start, *lines]), rules=[rule])
    assert [lines[finding.span.line - 1 - len(start)] for finding in found] == refused
    return refused


def test_a_default_that_an_operator_refuses_is_found(rule_checker: Checker, tmp_path: Path) -> None:
    lines = [
        "bpy.ops.rigidbody.mass_calculate()",
        "bpy.ops.rigidbody.mass_calculate(material='DEFAULT')",
        "bpy.ops.rigidbody.mass_calculate(material='DEFAULT', density=1)",
        "bpy.ops.rigidbody.mass_calculate(material='Custom', density=2)",
        "bpy.ops.rigidbody.mass_calculate(material='Steel')",
    ]
    assert len(_compared(rule_checker, tmp_path, "refused-value", _BODY, lines)) == 2


def test_values_of_add_ons_that_no_machine_has_are_found(rule_checker: Checker, tmp_path: Path) -> None:
    lines = [
        "cycles.denoiser = 'NLM'",
        "cycles.denoiser = 'OPENIMAGEDENOISE'",
        "cycles.preview_denoiser = 'NLM'",
        "cycles.preview_denoiser = 'AUTO'",
        "cycles.sampling_pattern = 'CORRELATED_MUTI_JITTER'",
        "cycles.sampling_pattern = 'TABULATED_SOBOL'",
    ]
    assert len(_compared(rule_checker, tmp_path, "unknown-value", _CYCLES, lines)) == 3


@pytest.mark.parametrize("value", ["OPTIX", "OPENIMAGEDENOISE"])
def test_values_of_other_machines_are_no_finding(check: Check, value: str) -> None:
    assert check("unknown-value", f"import bpy\nbpy.context.scene.cycles.denoiser = {value!r}\n") == []
