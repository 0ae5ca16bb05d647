"""Which lines a run comes to, and which scripts may add to the API."""

from __future__ import annotations

import ast

import pytest

from kb_check.run_reach import RunReach, may_bring_names

MARK = "here"


def comes_to(code: str) -> bool:
    line = next(number for number, text in enumerate(code.splitlines(), 1) if MARK in text)
    return RunReach(ast.parse(code)).comes_to(line)


@pytest.mark.parametrize(
    "code",
    [
        "here",
        "if x:\n    here",
        "def f():\n    here\nf()",
        "def f():\n    here\ndef main():\n    f()\nif __name__ == '__main__':\n    main()",
        "def f(x=here):\n    pass",
        "class A:\n    x = here",
        "class A:\n    def __init__(self):\n        here\nA()",
        "class A:\n    def go(self):\n        here\na = A()\na.go()",
        "def f():\n    here\ntry:\n    pass\nexcept Exception:\n    f()",
        "def f():\n    here\ntry:\n    f()\nfinally:\n    pass",
        "def f():\n    def g():\n        here\n    g()\nf()",
        "with open(x):\n    here",
        "def f(): here\nf()",
    ],
)
def test_comes_to(code: str) -> None:
    assert comes_to(code)


@pytest.mark.parametrize(
    "code",
    [
        "def f():\n    here",
        "def f():\n    here\ntry:\n    f()\nexcept Exception:\n    pass",
        "import contextlib\ndef f():\n    here\nwith contextlib.suppress(Exception):\n    f()",
        "class A:\n    def execute(self, context):\n        here",
        "def f():\n    g()\ndef g():\n    here",
        "def f():\n    def g():\n        here\n    return 1\nf()",
    ],
)
def test_does_not_come_to(code: str) -> None:
    assert not comes_to(code)


@pytest.mark.parametrize(
    ("code", "brings"),
    [
        ("import bpy\nbpy.ops.mesh.primitive_cube_add()", False),
        ("import math, numpy as np\nfrom mathutils import Vector", False),
        ("import addon_utils", True),
        ("from bpy.utils import load_scripts", True),
        ("bpy.ops.preferences.addon_enable(module='x')", True),
        ("exec(text)", True),
        ("setattr(bpy.types.Scene, name, value)", True),
        ("import my_helpers", True),
        ("from . import helpers", True),
        ("A = type('A', (bpy.types.Operator,), {})", True),
        ("type(x)", False),
        ("class A(bpy.types.Operator):\n    bl_idname = 'my.op'", False),
        ("class A(bpy.types.Operator):\n    bl_idname = PREFIX + '.op'", True),
    ],
)
def test_may_bring_names(code: str, brings: bool) -> None:
    known = {"bpy", "mathutils"}
    assert may_bring_names(ast.parse(code), known.__contains__) is brings


def test_a_script_of_many_functions_is_read_in_one_go() -> None:
    code = "\n".join(f"def f{number}():\n    f{number + 1}()" for number in range(5_000)) + "\nf0()"
    assert RunReach(ast.parse(code)).comes_to(9_999)
