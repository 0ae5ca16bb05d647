"""A script that enables an add-on which nobody can look into may use whatever that one registers."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from kb_build.flow.blender.facts import ADDONS

if TYPE_CHECKING:
    from kb_check.checker import Checker

_USE = """\
import addon_utils
import bpy
{enabling}
ob = bpy.context.object
bpy.ops.stranger_things.add()
bpy.ops.object.stranger()
ob.stranger.kind = "WET"
bpy.context.scene.stranger.count = 1
bpy.types.STRANGER_PT_panel
"""
# Whatever is enabled.
_WRONG = """\
ob.locaton = (1, 2, 3)
ob.draw_type = "WIRE"
bpy.ops.object.lamp_add()
bpy.context.scene.render.stranger = 1
bpy.context.stranger
"""
_ENABLING = 'bpy.ops.preferences.addon_enable(module="stranger")'


def _severities(checker: Checker, code: str) -> list[str]:
    return [one.severity for one in checker.check(code)]


@pytest.mark.parametrize(
    "enabling",
    [
        _ENABLING,
        'bpy.ops.preferences.addon_enable(module="bl_ext.user_default.stranger")',
        'NAME = "stranger"\nbpy.ops.wm.addon_enable(module=NAME) if bpy.app.version < (2, 80) else None\n'
        "bpy.ops.preferences.addon_enable(module=NAME)",
        'addon_utils.enable("stranger", default_set=True)',
        'addon_utils.enable(module_name="stranger")',
        'for name in ("rigify", "stranger"):\n    addon_utils.enable(name)',
        'bpy.ops.extensions.package_install(repo_index=0, pkg_id="stranger")',
        'print("stranger" in bpy.context.preferences.addons)',
        'print("stranger" not in bpy.context.preferences.addons.keys())',
        'stranger = bpy.context.preferences.addons.get("stranger")',
        'is_on, is_loaded = addon_utils.check("stranger")',
    ],
)
def test_what_a_foreign_addon_may_register_is_no_error(rule_checker: Checker, enabling: str) -> None:
    found = rule_checker.check(_USE.format(enabling=enabling))
    assert [one.severity for one in found] == ["note"] * 5
    assert all("`" in one.message and "may register it" in one.message for one in found)


@pytest.mark.parametrize(
    "enabling", ["", "addon_utils.enable(__package__)", 'def turn_on(settings):\n    settings.enable("stranger")']
    + [f'bpy.ops.preferences.addon_enable(module="{name}")' for name in ("rigify", "io_scene_fbx")],
)  # fmt: skip
def test_without_one_nothing_may(rule_checker: Checker, enabling: str) -> None:
    assert _severities(rule_checker, _USE.format(enabling=enabling)) == ["error"] * 5


@pytest.mark.parametrize(
    "enabling",
    [
        "def turn_on(name: str):\n    bpy.ops.preferences.addon_enable(module=name)",
        "import sys\naddon_utils.enable(sys.argv[-1])",
    ],
)
def test_operators_may_be_those_of_an_addon_with_a_computed_name(
    rule_checker: Checker, enabling: str
) -> None:
    found = rule_checker.check(_USE.format(enabling=enabling))
    assert [one.severity for one in found] == ["note"] * 2 + ["error"] * 3
    assert all("by a name that is computed, may register it" in one.message for one in found[:2])


def test_what_blender_had_or_a_misspelling_stays_an_error(rule_checker: Checker) -> None:
    assert _severities(rule_checker, _USE.format(enabling=_ENABLING) + _WRONG) == ["note"] * 5 + ["error"] * 5


def test_an_addon_that_is_checked_with_the_script_can_be_looked_into(rule_checker: Checker) -> None:
    files = {
        "stranger/__init__.py": "import bpy\nbpy.types.Object.stranger = bpy.props.StringProperty()\n",
        "stranger/tests/try_it.py": f"import bpy\n{_ENABLING}\nbpy.context.object.strangr = 'a'\n",
    }
    reads = rule_checker.read_files(files)
    package = rule_checker.package(reads.values())
    (finding,) = rule_checker.check(reads["stranger/tests/try_it.py"], package)
    assert finding.severity == "error"


def test_the_addons_of_blender_are_known() -> None:
    code = "import addon_utils\nprint(*(module.__name__ for module in addon_utils.modules()))"
    done = subprocess.run(
        [sys.executable, "-c", f"import bpy\n{code}"], capture_output=True, check=True, text=True, timeout=60
    )
    # What Blender says of its start, as of another folder of colours, stands before.
    brought = {name for name in done.stdout.splitlines()[-1].split() if name.isidentifier()}
    assert {"cycles", "rigify"} <= brought <= ADDONS


@pytest.mark.parametrize(
    ("enabling", "engine", "severity"),
    [
        ('addon_utils.enable("hydra_storm")', "HYDRA_STORM", "note"),
        (_ENABLING, "STRANGE_ENGINE", "note"),
        ('addon_utils.enable("rigify")', "STRANGE_ENGINE", "error"),
        (_ENABLING, "CYCELS", "error"),
        (_ENABLING, "BLENDER_EEVEE_NEXT", "error"),
    ],
)
def test_an_engine_may_be_one_of_an_addon_that_is_enabled(
    rule_checker: Checker, enabling: str, engine: str, severity: str
) -> None:
    code = f"import addon_utils\nimport bpy\n{enabling}\nbpy.context.scene.render.engine = {engine!r}\n"
    assert _severities(rule_checker, code) == [severity]


def test_operators_of_what_became_an_extension_are_a_note_where_it_is_asked_for(
    rule_checker: Checker,
) -> None:
    use = 'bpy.ops.import_scene.x3d(filepath="a.x3d")\n'
    asked = 'if "io_scene_x3d" in bpy.context.preferences.addons:\n    '
    assert _severities(rule_checker, f"import bpy\n{use}") == ["error"]
    assert _severities(rule_checker, f"import bpy\n{asked}{use}") == ["note"]
    assert _severities(rule_checker, f"import bpy\n{asked}bpy.ops.object.lamp_add()\n") == ["error"]
