"""Functions that Blender is given to call: each is given to one, which tells of those that it cannot call."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_HANDLERS = {
    "lambda: None": False,
    "lambda scene: None": True,
    "lambda scene, depsgraph: None": True,
    "lambda scene, depsgraph=None: None": True,
    "lambda scene, depsgraph, more=1: None": True,
    "lambda scene, depsgraph, more: None": False,
    "lambda *all: None": True,
    "lambda *, more=1: None": False,
    "len('x')": False,
    "'len'": False,
}
_LISTS = ("frame_change_post", "save_pre")
_RUN = """
import sys, bpy
bpy.app.handlers.{name}.append({function})
bpy.context.scene.frame_set(7)
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[-1])
"""
_TIMER = "def tick():\n    return 1.0\ndef stop():\n    pass\ndef late(self):\n    pass\n"
_REFUSED = ["bpy.app.timers.register(tick())", "bpy.app.timers.register(stop(), first_interval=1)"]
_TAKEN = [
    "bpy.app.timers.register(tick)",
    "bpy.app.timers.register(lambda: late(1))",
    "import functools\nbpy.app.timers.register(functools.partial(late, 1))",
    "def make():\n    return stop\nbpy.app.timers.register(make())",
    "class Clock:\n    def tick(self):\n        pass\nbpy.app.timers.register(Clock().tick)",
]


_FACTORY = """
import bpy
tell = bpy.app.handlers.persistent(lambda *given: print("given", given, flush=True))
bpy.app.handlers.load_factory_startup_post.append(tell)
bpy.ops.wm.read_factory_settings()
"""


def test_handlers_whose_reference_has_no_arguments_get_some(rule_checker: Checker) -> None:
    done = subprocess.run([sys.executable, "-P", "-c", _FACTORY], capture_output=True, text=True, check=True)
    assert "given (None, None)" in done.stdout
    symbol = rule_checker.api.symbols.symbol("bpy.app.handlers.load_factory_startup_post")
    assert symbol is not None
    assert "Callable[[]," not in symbol.type
    assert "Callable[[None, None], None]" in symbol.type


def test_handlers_that_cannot_be_called_are_found(check: Check, tmp_path: Path) -> None:
    for name in _LISTS:
        codes = {code: f"import bpy\nbpy.app.handlers.{name}.append({code})" for code in _HANDLERS}
        assert {code: not check("given-callback", text) for code, text in codes.items()} == _HANDLERS
    for code, works in _HANDLERS.items():
        text = "".join(_RUN.format(name=name, function=code) for name in _LISTS)
        done = subprocess.run(
            [sys.executable, "-P", "-c", text, str(tmp_path / "file.blend")],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert (done.stdout + done.stderr).count("TypeError") == (0 if works else 3), code


def test_a_result_in_the_place_of_a_timer_is_found_and_mended(check: Check, tmp_path: Path) -> None:
    wrong = [f"import bpy\n{_TIMER}{code}" for code in _REFUSED]
    assert [error[:9] for error, *_ in run_statements(tmp_path, wrong)] == ["TypeError"] * len(wrong)
    for code in wrong:
        (found,) = check("given-callback", code)
        assert found.fix is not None
        assert found.fix.sure
        assert [edit.text for edit in found.fix.edits] == [""]
    right = [f"import bpy\n{_TIMER}{code}" for code in _TAKEN]
    assert [error for error, *_ in run_statements(tmp_path, right) if error] == []
    assert [code for code in right if check("given-callback", code)] == []


def test_a_timer_that_wants_arguments_is_found(check: Check) -> None:
    assert len(check("given-callback", f"import bpy\n{_TIMER}bpy.app.timers.register(late)")) == 1


def test_what_only_looks_for_a_timer_takes_any_function(check: Check) -> None:
    looking = "bpy.app.timers.is_registered(late) and bpy.app.timers.unregister(late)"
    assert not check("given-callback", f"import bpy\n{_TIMER}{looking}")


def test_what_decorators_may_have_changed_is_left_alone(check: Check) -> None:
    add = "bpy.app.handlers.load_post.append(f)"
    assert not check("given-callback", f"import bpy\nfrom x import wrap\n@wrap\ndef f():\n    pass\n{add}")
    kept = "import bpy\nfrom bpy.app.handlers import persistent\n@persistent\ndef f():\n    pass\n"
    assert len(check("given-callback", f"{kept}{add}")) == 1
