"""Names that nothing binds are found: each script is run, and fails or does not."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Cell, Source

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_IMPORTED = {
    "Vector((0, 0, 1))": "from mathutils import Vector",
    "mathutils.Matrix.Rotation(math.pi, 4, 'X')": "import mathutils",
    "bmesh.new()": "import bmesh",
    "np.zeros(3)": "import numpy as np",
    "random.uniform(0, 1)": "import random",
    "class G(bpy.types.PropertyGroup):\n    size: FloatProperty()": "from bpy.props import FloatProperty",
    "class P(Panel):\n    bl_label = 'x'": "from bpy.types import Panel",
    "@persistent\ndef f(scene):\n    pass": "from bpy.app.handlers import persistent",
}
_WRONG = {
    "a misspelling": "location = 1\nprint(locaton)",
    "in a function that is called": "def f():\n    return nowhere\nf()",
    "in a condition": "if nowhere:\n    pass",
    "in another annotation": "def f(a: Nowhere):\n    pass",
    "another error is caught": "try:\n    nowhere\nexcept KeyError:\n    pass",
    "another name is asked for": "if 'other' in locals():\n    pass\nnowhere",
    "a module that lacks what is read": "random.intricate()",
    "another function binds it": "def f():\n    cube = 1\ndef g():\n    return cube\nf()\ng()",
    "a function within binds it": "def f():\n    def g():\n        cube = 1\n    g()\n    return cube\nf()",
    "the class binds it": "class A:\n    size = 1\n    def f(self):\n        return size\nA().f()",
    "a class's comprehension": "class A:\n    size = 1\n    all = [size for _ in range(2)]",
    "a comprehension binds it": "def f(one):\n    return 1\n[one for one in (1, 2)]\none",
}
_SOUND = {
    "bound": "from mathutils import Vector\nVector((0, 0, 1))",
    "bound further down": "def f():\n    return later\nlater = 1\nf()",
    "a function around binds it": "def f():\n    def g():\n        return cube\n    cube = 1\n    return g()\nf()",
    "of the function around": "def f():\n    n = 0\n    def g():\n        nonlocal n\n        n += 1\n    g()\nf()",
    "of a class's body": "class A:\n    size = 1\n    twice = size * 2\n    all = [one for one in range(size)]",
    "bound in a comprehension": "def f():\n    if any((last := one) > 1 for one in (1, 2)):\n        return last\nf()",
    "a default": "size = 1\ndef f(of=size, *, key=lambda one: one + size, **named):\n    return of, key(1), named\nf()",
    "caught or given": "import math as m\ntry:\n    m.nothing\nexcept AttributeError as error:\n    print(error)",
    "bound in a condition": "def g():\n    return late\nif True:\n    late = 1\ng()",
    "global": "def g():\n    global made\n    made = 1\ng()\nmade",
    "of a match": "match {'a': 1}:\n    case {'a': one, **rest}:\n        print(one, rest)",
    "caught": "try:\n    unicode_\nexcept NameError:\n    pass",
    "caught as any": "try:\n    nowhere\nexcept:\n    pass",
    "asked for": "if 'nowhere' in locals():\n    nowhere.x",
    "for another Blender": "if bpy.app.version < (2, 80, 0):\n    nowhere",
    "put into the namespace": "globals()['put'] = 1\nput",
    "run": "exec('ran = 1')\nran",
    "all of a module": "from math import *\ncos(pi)",
    "of the module": "__file__ = 'x'\n__name__, __file__",
    "of a class": "class A:\n    x = __qualname__\n    def f(self):\n        return __class__\nA().f()",
    "an annotation in a function": "def f():\n    a: Nowhere = 1\nf()",
    "annotations that are kept": "from __future__ import annotations\ndef f(a: Nowhere) -> Nowhere:\n    pass",
}


def test_names_that_nothing_binds_are_found(check: Check, tmp_path: Path) -> None:
    codes = {**_WRONG, **{code: code for code in _IMPORTED}}
    answers = run_statements(tmp_path, [f"import bpy\n{code}" for code in codes.values()])
    errors = {name: error.partition(":")[0] for name, (error, *_) in zip(codes, answers, strict=True)}
    assert errors == dict.fromkeys(codes, "NameError")
    found = {name: check("unbound-name", f"import bpy\n{code}") for name, code in codes.items()}
    assert [name for name, findings in found.items() if not findings] == []


def test_what_is_imported_runs(rule_checker: Checker, tmp_path: Path) -> None:
    mended: list[str] = []
    for code, line in _IMPORTED.items():
        text = f"import bpy\n{code}"
        while found := rule_checker.check(text, rules=["unbound-name"]):
            text = apply_fixes(Source(text), found).text
        assert line in text.splitlines()
        mended.append(text)
    assert [error for error, *_ in run_statements(tmp_path, mended) if error] == []


def test_what_runs_has_no_finding(check: Check, tmp_path: Path) -> None:
    codes = {name: code if "__future__" in code else f"import bpy\n{code}" for name, code in _SOUND.items()}
    answers = run_statements(tmp_path, list(codes.values()))
    assert [(name, error) for name, (error, *_) in zip(codes, answers, strict=True) if error] == []
    assert [name for name, code in codes.items() if check("unbound-name", code)] == []


@pytest.mark.parametrize(
    "code",
    [
        "v = Vector((0, 0, 1))",  # a piece of a script
        "import bmesh\nbpy.context, C.object, D.objects",  # Blender's text editor and console bind these
        "import bpy\npass\nnowhere",  # a line for IPython in a notebook
        "import bpy\nsize = __SIZE_2D__",  # filled in before it runs
    ],
)
def test_what_is_bound_elsewhere_has_no_finding(check: Check, code: str) -> None:
    assert check("unbound-name", code) == []


_PACKAGE = {
    "addon_in_parts/__init__.py": "from .tools import run\nrun(), tools.run, panels.draw",
    "addon_in_parts/tools.py": "from . import panels\ndef run():\n    return panels.draw",
    "addon_in_parts/panels.py": "draw = 1",
}


def test_modules_that_are_imported_are_bound_in_their_package(
    rule_checker: Checker, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for path, code in _PACKAGE.items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(code)
    monkeypatch.syspath_prepend(tmp_path)
    import_module("addon_in_parts")
    assert _unbound(rule_checker, _PACKAGE) == []
    wrong = {**_PACKAGE, "addon_in_parts/tools.py": "from .panels import draw\nrun = panels"}
    assert _unbound(rule_checker, wrong) == ["addon_in_parts/tools.py"]
    assert _unbound(rule_checker, {**_PACKAGE, "addon_in_parts/__init__.py": "import bpy\nparts.draw"})


def test_code_without_a_place_may_be_a_package(check: Check) -> None:
    assert check("unbound-name", "from .tools import run\ntools.run") == []
    assert check("unbound-name", "from ..tools import run\ntools.run")


def _unbound(checker: Checker, files: dict[str, str]) -> list[str]:
    """The files that name what nothing binds."""
    reads = checker.read_files(files)
    package = checker.package(reads.values())
    return [path for path, read in reads.items() if checker.check(read, package, ["unbound-name"])]


def test_the_closest_name_is_told(check: Check) -> None:
    (found,) = check("unbound-name", "import bpy\nlocation = 1\nprint(locaton)")
    assert "`location`" in found.message


def test_cells_of_a_notebook_are_one_script(check: Check) -> None:
    source = Source("import bpy\nsize = 1\nprint(size)\n", cells=(Cell(1, 1), Cell(2, 3)))
    assert check("unbound-name", source.text) == []


def test_who_binds_a_name_is_told(check: Check) -> None:
    code = "import bpy\ndef make():\n    cube = 1\ndef paint():\n    return cube\n"
    (found,) = check("unbound-name", code)
    assert (
        "`cube` is bound in `make` alone, and unknown here: NameError. Give it as an argument."
        in found.message
    )
    (found,) = check(
        "unbound-name", "import bpy\nclass A:\n    size = 1\n    def f(self):\n        return size\n"
    )
    assert "Read it of the class, `self.size`." in found.message
