"""What add-ons register that Blender brings is known: it is there where a script enables them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_USES = {
    "rigify": (
        "bpy.ops.object.armature_human_metarig_add.get_rna_type()",
        "bpy.ops.pose.rigify_generate.get_rna_type()",
        "bpy.data.armatures.new('x').rigify_colors_lock = True",
    ),
    "node_wrangler": ("bpy.ops.node.nw_reset_nodes.get_rna_type()", "bpy.types.NODE_OT_nw_reset_nodes"),
}
_CASES = [(addon, use) for addon, uses in _USES.items() for use in uses]


@pytest.mark.parametrize(
    "enabling",
    ["import addon_utils; addon_utils.enable({!r}, default_set=True)",
     "bpy.ops.preferences.addon_enable(module={!r})"],
)  # fmt: skip
def test_an_addon_that_is_enabled_has_what_it_registers(
    rule_checker: Checker, tmp_path: Path, enabling: str
) -> None:
    for addon, uses in _USES.items():
        lines = ["import bpy", enabling.format(addon), *uses]
        assert [error for error, *_ in run_statements(tmp_path, lines) if error] == []
        assert rule_checker.check("\n".join(lines)) == []
        (finding,) = rule_checker.check("\n".join([*lines, "bpy.ops.object.no_such_operator()"]))
        assert finding.severity == "error"


@pytest.mark.parametrize(("addon", "use"), _CASES)
def test_an_addon_that_nothing_enables_is_named(
    rule_checker: Checker, tmp_path: Path, addon: str, use: str
) -> None:
    lines = ["import bpy", use]
    assert run_statements(tmp_path, lines)[1][0]
    (finding,) = rule_checker.check("\n".join(lines))
    assert (finding.severity, finding.fix) == ("warning", None)
    assert f"addon_utils.enable('{addon}', default_set=True)" in finding.message


def test_another_file_may_enable_it(rule_checker: Checker) -> None:
    files = {
        "rig/__init__.py": "import addon_utils\naddon_utils.enable('rigify')\n",
        "rig/make.py": "import bpy\nbpy.ops.pose.rigify_generate()\nimport rigify\n",
    }
    reads = rule_checker.read_files(files)
    assert rule_checker.check(reads["rig/make.py"], rule_checker.package(reads.values())) == []


def test_what_nobody_has_leaves_addons_aside(rule_checker: Checker) -> None:
    code = "import bpy\nbpy.ops.mesh.ant_landscape_never_was()\nbpy.context.object.zorn\n"
    of_operator, of_object = rule_checker.check(code)
    assert "(add-ons aside)" in of_operator.message
    assert "(add-ons and custom properties aside)" in of_object.message
