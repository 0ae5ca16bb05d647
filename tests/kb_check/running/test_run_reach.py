"""Which lines a run comes to, and which scripts may add to the API."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

import pytest

from kb_check.running.reach import RunReach, may_bring_names

if TYPE_CHECKING:
    from kb_check.checker import Checker

MARK = "here"


def comes_to(checker: Checker, code: str) -> bool:
    number, text = next((number, text) for number, text in enumerate(code.splitlines(), 1) if MARK in text)
    read = checker.read(code)
    return RunReach(read.tree, read.analysis).comes_to(number, text.index(MARK))


@pytest.mark.parametrize(
    "code",
    [
        "here",
        "if True:\n    here",
        "import bpy\nif bpy.app.version >= (2, 80):\n    here",
        "import bpy\nif bpy.app.version < (2, 80):\n    x\nelse:\n    here",
        "here and x",
        "x if here else y",
        "here < x < y",
        "for x in here: pass",
        "for x in range(3):\n    here",
        "COUNT = 3\nfor x in range(1, COUNT):\n    here",
        "for i, x in enumerate([1, 2]):\n    here\n    if x: continue",
        "[here for x in (1, 2)]",
        "while True:\n    here",
        "for x in y:\n    if x: break\nhere",
        "def f():\n    here\nf()",
        "def f():\n    here\ndef main():\n    f()\nif __name__ == '__main__':\n    main()",
        "def f(x=here):\n    pass",
        "class A:\n    x = here",
        "class A:\n    def __init__(self):\n        here\nA()",
        "class A:\n    def go(self):\n        here\na = A()\na.go()",
        "class A:\n    def go(self):\n        self.on()\n    def on(self):\n        here\nA().go()",
        "def f():\n    here\ntry:\n    f()\nfinally:\n    pass",
        "def f():\n    here\ntry:\n    x\nexcept E:\n    pass\nfinally:\n    f()",
        "def f():\n    def g():\n        here\n    g()\nf()",
        "with open(x):\n    here",
        "def f(): here\nf()",
        "if x:\n    raise E\nhere",
        "x = 'ä'; here",
    ],
)
def test_comes_to(checker: Checker, code: str) -> None:
    assert comes_to(checker, code)


@pytest.mark.parametrize(
    "code",
    [
        "if x:\n    here",
        "if len(x) > 10**6:\n    here",
        "DEBUG = False\nif DEBUG:\n    here",
        "if x:\n    pass\nelse:\n    here",
        "if x: pass\nelif here: pass",
        "x and here",
        "x or here",
        "here if x else y",
        "a < b < here",
        "lambda: here",
        "[here for x in y]",
        "[here for x in (1, 2) if x]",
        "(here for x in (1, 2))",
        "for x in y:\n    here",
        "for x in range(0):\n    here",
        "for x in range(n):\n    here",
        "for x in (1, 2):\n    if x: continue\n    here",
        "for x in y:\n    pass\nelse:\n    here",
        "while x:\n    here",
        "match x:\n    case 1: here",
        "try:\n    here\nexcept E:\n    pass",
        "try:\n    x\nexcept E:\n    here",
        "with x:\n    here",
        "import sys\nif x: sys.exit()\nhere",
        "def f():\n    if x: return\n    here\nf()",
        "def f():\n    for x in y:\n        return\n    here\nf()",
        "def f():\n    here",
        "def f():\n    here\nd = {'f': f}",
        "def f():\n    here\nif x:\n    f()",
        "def f():\n    yield here\nf()",
        "@x\ndef f():\n    here\nf()",
        "def f():\n    x\nf()\ndef f():\n    here",
        "def f():\n    here\ntry:\n    f()\nexcept Exception:\n    pass",
        "def f():\n    here\ntry:\n    pass\nexcept Exception:\n    f()",
        "import contextlib\ndef f():\n    here\nwith contextlib.suppress(Exception):\n    f()",
        "class A:\n    def execute(self, context):\n        here",
        "class A:\n    def go(self):\n        here\nclass B:\n    def go(self):\n        pass\nB().go()",
        "def f():\n    g()\ndef g():\n    here",
        "def f():\n    def g():\n        here\n    return 1\nf()",
        "if x:\n    x; here",
    ],
)
def test_does_not_surely_come_to(checker: Checker, code: str) -> None:
    assert not comes_to(checker, code)


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
    assert RunReach(ast.parse(code)).comes_to(9_999, 4)


def test_a_long_chain_of_conditions_is_read() -> None:
    code = "if False: pass\n" + "elif False: pass\n" * 3_000 + "else: here"
    assert RunReach(ast.parse(code)).comes_to(3_002, 6)
