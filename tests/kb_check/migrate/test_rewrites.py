"""Every rewrite: what it makes of old code, and that Blenders agree on both."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING

import pytest
from rewrite_cases import CASES, HEAD, Case

from kb_check.migrate.place import version_of
from kb_check.migrate.plan import Migrator
from kb_check.migrate.rewrite import all_rewrites
from kb_check.migrate.trial import run_in, runtime_at_hand

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker
    from simworlds.sandbox.runtime import Runtime

# Runs every script by itself, in a fresh scene, and raises at the end with what each of them raised.
_RUNNER = """
import bpy, json
codes = json.loads({codes!r})
raised = []
for code in codes:
    bpy.ops.wm.read_factory_settings()
    try:
        exec(compile(code, "case", "exec"), {{"__name__": "case"}})
        raised.append("")
    except Exception as error:
        raised.append(f"{{type(error).__name__}}: {{error}}"[:60])
with open({out!r}, "w") as file:
    json.dump(raised, file)
"""


def raised(codes: list[str], runtime: Runtime, folder: Path) -> list[str]:
    """What each of some scripts raises in a Blender; empty for those that run through."""
    script, out = folder / "runner.py", folder / "raised.json"
    script.write_text(_RUNNER.format(codes=json.dumps(codes), out=str(out)))
    ending = run_in(runtime, script)
    assert not ending.error, ending.error
    found = json.loads(out.read_text())
    assert len(found) == len(codes)
    return found


def migrator(checker: Checker, case: Case) -> Migrator:
    return Migrator(checker, written_for=version_of(case.written_for))


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_old_code_becomes_new_code(case: Case, checker: Checker) -> None:
    (file,) = migrator(checker, case).migrate({"script.py": case.old})
    lines = [line for line in file.new.splitlines() if line != "from bpy_extras import anim_utils"]
    assert lines == case.new.splitlines()
    assert case.rewrite in {change.rule for change in file.changes}
    assert not [one for one in file.decisions if one.severity == "error"]


def test_every_rewrite_has_a_case() -> None:
    assert {rewrite.id for rewrite in all_rewrites()} <= {case.rewrite for case in CASES}


def test_blender_refuses_the_old_code_and_runs_the_new(checker: Checker, base: Path, tmp_path: Path) -> None:
    runtime = runtime_at_hand(checker.names.version, base.parent.parent)
    assert runtime is not None
    # What ``*`` means changed without an error for some, and nothing is drawn without a window.
    old = [case for case in CASES if case.rewrite not in {"split-factor", "matrix-product"}]
    new = [migrator(checker, case).migrate({"script.py": case.old})[0].new for case in CASES]
    found = raised([case.old for case in old] + new, runtime, tmp_path)
    refused, ran = found[: len(old)], found[len(old) :]
    assert [case.name for case, error in zip(old, refused, strict=True) if not error] == []
    assert [(case.name, error) for case, error in zip(CASES, ran, strict=True) if error] == []


def test_an_older_blender_runs_the_old_code(base: Path, tmp_path: Path) -> None:
    if shutil.which("blender") is None or (runtime := runtime_at_hand("3.4", base.parent.parent)) is None:
        pytest.skip("Blender 3.4 is not installed")
    old = [case for case in CASES if case.written_for == "3.4"]
    errors = raised([case.old for case in old], runtime, tmp_path)
    assert [(case.name, error) for case, error in zip(old, errors, strict=True) if error] == []


@pytest.mark.parametrize(
    "code",
    [
        "thing.select = True\n",  # nothing is known of it
        "bpy.context.object.data.polygons[0].select = True\n",  # faces still have it
        "v = Vector() * 2\nw = Vector() * Vector()\n",  # what is meant since 2.80
        "class Plain:\n    size = bpy.props.FloatProperty()\n",
        "bpy.ops.mesh.primitive_uv_sphere_add(radius=1)\n",
        "bpy.ops.object.shade_smooth('EXEC_DEFAULT')\n",
        "if hasattr(ob, 'select'):\n    ob.select = True\n",
        "if bpy.app.version < (2, 80, 0):\n    ob.select = True\nelse:\n    ob.select_set(True)\n",
        "m = bpy.data.materials.new('M')\nm.specular_color = (1, 1, 1)\n",
    ],
)
def test_code_that_is_right_stays(code: str, checker: Checker) -> None:
    (file,) = Migrator(checker).migrate({"script.py": HEAD + code})
    assert file.new == file.old
    assert not file.changes


_BY_PLACE = """\
import bpy
tree = bpy.data.materials.new("m").node_tree
principled = tree.nodes.new("ShaderNodeBsdfPrincipled")
principled.inputs[9].default_value = 0.3
principled.inputs[0].default_value = (1, 0, 0, 1)
principled.inputs[4].default_value = 1.4
principled.inputs[19].default_value = (1, 1, 1, 1)
"""


def test_a_place_tells_nothing_where_nobody_says_what_it_was_written_for(checker: Checker) -> None:
    (file,) = Migrator(checker).migrate({"script.py": _BY_PLACE})
    assert file.new == _BY_PLACE
    assert [one.line for one in file.decisions if one.rule == "moved-socket"] == [4, 6, 7]


def test_only_what_has_a_name_is_written_by_it(checker: Checker) -> None:
    (file,) = Migrator(checker, written_for=(3, 4)).migrate({"script.py": _BY_PLACE})
    # The index of refraction of the subsurface is hidden, and the emission has a strength of its own.
    assert [done.line for done in file.changes] == [4]
    assert 'inputs["Roughness"]' in file.new
    assert [one.line for one in file.decisions if one.rule == "moved-socket"] == [6, 7]
