"""Scripts that cannot be read, or not to their end: the analysis says so, and ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_build.flow import analysis as analysis_module
from kb_build.flow.analysis import analyse
from kb_build.flow.state.scopes import Scope, State

if TYPE_CHECKING:
    from collections.abc import Callable

    from kb_build.flow.blender.api import Api


@pytest.mark.parametrize(
    "code",
    [
        "def f(:",
        "print 'two'",
        "x = '\0'",
        "(" * 5_000,
        "\tif x:\n  y",
        "a" * 5_000_000,
    ],
)
def test_what_cannot_be_parsed_says_why(api: Api, code: str) -> None:
    found = analyse(code, api)
    assert found.tree is None
    assert found.error is not None
    assert str(found.error)
    assert not found.resolutions


@pytest.mark.parametrize(
    "code",
    [
        "import bpy\nx = " + "+".join(["bpy.context.object.location.x"] * 500),
        "import bpy\n" + "".join(f"{' ' * n}if x:\n" for n in range(90)) + " " * 90 + "bpy.data",
        "def f(x):\n    return g(x)\ndef g(x):\n    return f(x)\nf(1)",
        "class A(A): pass\nclass B(C): pass\nclass C(B): pass\nB().x\nA().y",
        "x = x\nx.y = x.y\nfor x in x: x = x(x)[x]",
        "def f(x):\n    f([x])\nf(1)",
        "x = " + "[" * 150 + "]" * 150,
        "x = 1\n" + "x = (x, x)\n" * 200,
        "x = []\n" + "x.append(x)\n" * 50 + "while x:\n    x = [x, {'a': x}]",
        "import bpy\nob = None\n" + "ob = bpy.data.objects.new('x', ob)\n" * 300,
        "x = lambda: x()\nx()",
        "\n".join(f"class C{n}:\n def m(self): return self.q" for n in range(2_000)),
        "import bpy\nx = 1" + "\nif bpy.app.version < x:\n  x = [x]\nelif x:\n  x = x.y(x)" * 300,
        "import bpy\n" + "\n".join(f"def f{n}(x): return f{n + 1}(x)" for n in range(400)) + "\nf0(bpy)",
        "global x\nimport bpy.nothing\nfrom bpy import *\nfrom . import a\ndel x, x.y, x[0]",
        "match 1:\n    case {'a': x, **rest}: x\n    case [1, *others] | None: others\n    case _: pass",
        "async def f():\n    async with a as b:\n        await b\n    async for c in d: yield c",
        "try:\n    pass\nexcept* ValueError as e:\n    e\nwhile True:\n    break\nelse:\n    1",
        "",
        "\ufeffimport bpy",
    ],
)
def test_strange_code_is_read_to_its_end(api: Api, code: str) -> None:
    found = analyse(code, api)
    assert found.error is None
    assert found.tree is not None
    assert found.complete


def test_what_takes_too_much_work_is_left(api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(analysis_module, "MOST_STEPS", 500)
    found = analyse("import bpy\n" + "bpy.context.object.location\n" * 1_000, api)
    assert not found.complete
    assert len(found.resolutions) > 100


_MANY, _STEPS = 1_000, 3_000
_NAMES = "".join(f"a{n} = 1\n" for n in range(_MANY))


def counted(
    monkeypatch: pytest.MonkeyPatch, cls: type, method: str, work_of: Callable[..., int]
) -> Callable[[], int]:
    """Has the calls of a method counted, each with the work that it is for what it is called with; gives the sum."""
    plain, works = getattr(cls, method), [0]

    def count(*given: object) -> object:
        works.append(work_of(*given))
        return plain(*given)

    monkeypatch.setattr(cls, method, count)
    return lambda: sum(works)


@pytest.mark.parametrize(
    "line",
    [
        "if q: pass",
        "1 if q else 2",
        "q or z",
        "assert q or z",
        "[1 for one in q]",
        "for one in q: pass",
        "for one in ('a', 'b'): pass",
        "try: pass\nexcept E: pass",
        "match q:\n    case 1: pass",
    ],
)
def test_what_each_branch_copies_is_work(api: Api, monkeypatch: pytest.MonkeyPatch, line: str) -> None:
    """Many names and many branches: each copies all names."""

    def names(state: State) -> int:
        return len(state.names)

    monkeypatch.setattr(analysis_module, "MOST_STEPS", _STEPS)
    copied = counted(monkeypatch, State, "copy", names)
    found = analyse(_NAMES + f"{line}\n" * _MANY, api)
    assert not found.complete
    assert _MANY < copied() < 64 * _STEPS


@pytest.mark.parametrize("line", ["held.append(1)", "bpy.ops.object.convert()"])
@pytest.mark.parametrize("names", [_NAMES, "a = 1\n" * _MANY])
def test_what_all_names_are_looked_at_for_is_work(
    api: Api, monkeypatch: pytest.MonkeyPatch, line: str, names: str
) -> None:
    """It is read to its end where the same number of expressions has but one name."""
    monkeypatch.setattr(analysis_module, "MOST_STEPS", 3 * _STEPS)
    found = analyse(f"import bpy\nheld = []\n{names}" + f"{line}\n" * _MANY, api)
    assert found.complete is (names is not _NAMES)


def test_what_many_chains_are_sought_in_is_work(api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    def chains(scope: Scope, _name: str) -> int:
        return len(scope.state.chains)

    monkeypatch.setattr(analysis_module, "MOST_STEPS", 3 * _STEPS)
    sought = counted(monkeypatch, Scope, "forget", chains)
    known = "".join(f"assert hasattr(bpy.context.object, 'x{n}')\n" for n in range(300))
    found = analyse(f"import bpy\n{known}" + "a = 1\n" * 6_000, api)
    assert not found.complete
    assert _MANY < sought() < 64 * 3 * _STEPS


def test_many_names_and_branches_of_a_usual_script_are_read(api: Api) -> None:
    names = "".join(f"setting_{n} = {n}\n" for n in range(500))
    assert analyse(names + "if setting_1 > 3:\n    setting_2 = setting_3\n" * 500, api).complete


@pytest.mark.parametrize(
    "code",
    [
        "import bpy\nx = bpy" + ".context" * 600,
        "import bpy\nif x: pass\n" + "elif x: bpy.data\n" * 3_000,
        "import bpy\ndef f():\n    if x: pass\n" + "    elif x: bpy.data\n" * 3_000,
        "import bpy\nx = " + "-" * 180 + "bpy.data",
        "import bpy\nx = " + "(bpy.data, " * 170 + "1" + ")" * 170,
    ],
)
def test_what_is_too_deep_is_told(api: Api, code: str) -> None:
    found = analyse(code + "\nbpy.context.object.draw_type", api)
    assert found.error is None
    assert not found.complete
    row = next(row for row in found.resolutions.values() if row.value == "draw_type")
    assert row.missing
    assert not row.guarded


@pytest.mark.parametrize(
    "code",
    [
        "x = " + "{'a': " * 80 + "1" + "}" * 80,
        "x = " + "{'a': [" * 60 + "1" + "]}" * 60,
        "x = {'a': 1}\n" + "x = {'a': x, 'b': x}\n" * 80,
    ],
)
def test_dictionaries_in_each_other_take_no_more_work_than_others(api: Api, code: str) -> None:
    """Each knows what it holds twice, by its keys and at all: of eighty in each other nobody would see the end."""
    assert analyse(f"{code}\nimport bpy\nbpy.context.object.location", api).error is None
