"""Every usual way to ask for Blender's version, or for a name, keeps what stands behind it from being an error."""

from __future__ import annotations

import ast
from textwrap import dedent, indent
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

# ``draw_type`` went in 2.80: each of these runs without an error.
GUARDS = {
    "version": "if bpy.app.version < (2, 80):\n    ob.draw_type",
    "imported version": "from bpy.app import version\nif version < (2, 80):\n    ob.draw_type",
    "version by another name": "from bpy.app import version as v\nif v < (2, 80):\n    ob.draw_type",
    "module in a name": "app = bpy.app\nif app.version < (2, 80):\n    ob.draw_type",
    "version in a name": "v = bpy.app.version\nif v < (2, 80):\n    ob.draw_type",
    "constant": "OLD = bpy.app.version < (2, 80)\nif OLD:\n    ob.draw_type",
    "constant in a function": "OLD = bpy.app.version < (2, 80)\ndef f():\n    if OLD:\n        ob.draw_type\nf()",
    "constant of a class": "class C:\n    OLD = bpy.app.version < (2, 80)\nif C.OLD:\n    ob.draw_type",
    "constant of its own class": """
        class C:
            OLD = bpy.app.version < (2, 80)
            def f(self):
                if self.OLD:
                    ob.draw_type
        C().f()
    """,
    "attribute of an instance": """
        class C:
            def __init__(self):
                self.old = bpy.app.version < (2, 80)
            def f(self):
                if self.old:
                    ob.draw_type
        C().f()
    """,
    "flag that is set": "OLD = False\nif bpy.app.version < (2, 80):\n    OLD = True\nif OLD:\n    ob.draw_type",
    "flag that is set both ways": """
        if bpy.app.version < (2, 80):
            OLD = True
        else:
            OLD = False
        if OLD:
            ob.draw_type
    """,
    "flag in a function": """
        OLD = False
        if bpy.app.version < (2, 80):
            OLD = True
        def f():
            if OLD:
                ob.draw_type
        f()
    """,
    "flag by a choice": "OLD = True if bpy.app.version < (2, 80) else False\nif OLD:\n    ob.draw_type",
    "flag that is compared": "NEW = bpy.app.version >= (2, 80)\nif NEW is False:\n    ob.draw_type",
    "bool": "if bool(bpy.app.version < (2, 80)):\n    ob.draw_type",
    "any": "if any([bpy.app.version < (2, 80)]):\n    ob.draw_type",
    "tuple": "if tuple(bpy.app.version) < (2, 80):\n    ob.draw_type",
    "list": "if list(bpy.app.version[:2]) < [2, 80]:\n    ob.draw_type",
    "index": "if bpy.app.version[0] < 3 and bpy.app.version[1] < 80:\n    ob.draw_type",
    "one number": "v = bpy.app.version\nV = v[0] * 100 + v[1]\nif V < 280:\n    ob.draw_type",
    "unpacked": "major, minor, _ = bpy.app.version\nif major * 100 + minor < 280:\n    ob.draw_type",
    "float of text": 'if float("%d.%d" % bpy.app.version[:2]) < 2.8:\n    ob.draw_type',
    "text begins": 'if bpy.app.version_string.startswith("2.7"):\n    ob.draw_type',
    "text is less": 'if bpy.app.version_string < "2.80":\n    ob.draw_type',
    "formatted": 'V = f"{bpy.app.version[0]}.{bpy.app.version[1]}"\nif V == "2.79":\n    ob.draw_type',
    "joined": 'V = ".".join(map(str, bpy.app.version))\nif V.startswith("2.7"):\n    ob.draw_type',
    "match": "match bpy.app.version:\n    case (2, 79, _):\n        ob.draw_type",
    "match in a function": """
        def f():
            match bpy.app.version[0]:
                case 2:
                    return ob.draw_type
        f()
    """,
    "assert": "try:\n    assert bpy.app.version < (2, 80)\n    ob.draw_type\nexcept AssertionError:\n    pass",
    "getattr of the version": 'if getattr(bpy.app, "version") < (2, 80):\n    ob.draw_type',
    "early return": "def f():\n    if bpy.app.version_string > '2.80':\n        return\n    ob.draw_type\nf()",
    "early continue": "for i in range(2):\n    if bpy.app.version_string > '2.80':\n        continue\n    ob.draw_type",
    "choice": "x = ob.draw_type if bpy.app.version_string < '2.80' else ob.display_type",
    "and": "x = bpy.app.version_string < '2.80' and ob.draw_type",
    "or": "x = bpy.app.version_string > '2.80' or ob.draw_type",
    "elif": "if not ob:\n    pass\nelif bpy.app.version_string < '2.80':\n    ob.draw_type",
    "while": "while bpy.app.version_string < '2.80':\n    ob.draw_type",
    "comprehension": "x = [o.draw_type for o in bpy.data.objects if bpy.app.version_string < '2.80']",
    "parameter": "def f(old):\n    if old:\n        ob.draw_type\nf(bpy.app.version < (2, 80))",
    "parameter's default": "def f(old=bpy.app.version < (2, 80)):\n    if old:\n        ob.draw_type\nf()",
    "dictionary": "IS = {'old': bpy.app.version < (2, 80)}\nif IS['old']:\n    ob.draw_type",
    "function that answers": """
        def is_old():
            major, minor = bpy.app.version[:2]
            return major * 100 + minor < 280
        if is_old():
            ob.draw_type
    """,
    "dir": 'if "draw_type" in dir(ob):\n    ob.draw_type',
    "dir in a name": 'has = "draw_type" in dir(ob)\nif has:\n    ob.draw_type',
    "getattr is not None": 'if getattr(ob, "draw_type", None) is not None:\n    ob.draw_type',
    "getattr in a name": 'kind = getattr(ob, "draw_type", None)\nif kind is not None:\n    ob.draw_type',
    "hasattr": 'if hasattr(ob, "draw_type"):\n    ob.draw_type',
    "name in a name": 'attr = "draw_type"\nif hasattr(ob, attr):\n    ob.draw_type',
    "hasattr of the class": 'OLD = hasattr(bpy.types.Object, "draw_type")\nif OLD:\n    ob.draw_type',
    "hasattr in a class": """
        class C:
            OLD = hasattr(bpy.types.Object, "draw_type")
        def f():
            if C.OLD:
                ob.draw_type
        f()
    """,
    "properties": 'P = bpy.types.Object.bl_rna.properties\nif "draw_type" in P:\n    ob.draw_type',
    "properties' keys": 'if "draw_type" in bpy.types.Object.bl_rna.properties.keys():\n    ob.draw_type',
    "properties' get": 'if bpy.types.Object.bl_rna.properties.get("draw_type"):\n    ob.draw_type',
    "early return by name": 'def f():\n    if "draw_type" not in dir(ob):\n        return\n    ob.draw_type\nf()',
    "except": "try:\n    ob.draw_type\nexcept AttributeError:\n    pass",
    "except a named tuple": "ERR = (AttributeError,)\ntry:\n    ob.draw_type\nexcept ERR:\n    pass",
    "except a parent": "try:\n    bpy.types.Object['x']\n    ob.draw_type\nexcept (LookupError, Exception):\n    pass",
    "suppress": "import contextlib\nwith contextlib.suppress(AttributeError):\n    ob.draw_type",
    "suppress by another name": """
        from contextlib import suppress as s
        with s(AttributeError):
            ob.draw_type
    """,
    "assertRaises": """
        import unittest
        class T(unittest.TestCase):
            def test(self):
                with self.assertRaises(AttributeError):
                    ob.draw_type
        T("test").test()
    """,
    "what the try told": """
        try:
            ob.draw_type
            OLD = True
        except AttributeError:
            OLD = False
        if OLD:
            ob.draw_type
    """,
}  # fmt: skip
# Not run: pytest is not in Blender.
PYTEST = "import pytest\nwith pytest.raises(AttributeError):\n    ob.draw_type"
NO_GUARDS = {
    "nothing": "ob.draw_type",
    "another condition": "if ob.name:\n    ob.draw_type",
    "this version": "if bpy.app.version >= (2, 80):\n    ob.draw_type",
    "behind it": "if bpy.app.version_string < '2.80':\n    pass\nob.draw_type",
    "another name": 'if "gone" in dir(ob):\n    ob.draw_type',
    "another error": "try:\n    ob.draw_type\nexcept ZeroDivisionError:\n    pass",
    "an error of its own": "class E(Exception):\n    pass\ntry:\n    ob.draw_type\nexcept E:\n    pass",
    "a name that was a flag": "OLD = bpy.app.version_string < '2.80'\nOLD = ob\nif OLD:\n    ob.draw_type",
    "beside the version": "if ob and bpy.app.version >= (4, 0):\n    pass\nelse:\n    ob.draw_type",
}
AROUND = "import bpy\nob = bpy.data.objects.new('x', None)\n"


def _errors(checker: Checker, lines: str) -> list[str]:
    findings = checker.check(AROUND + dedent(lines))
    return [finding.symbol for finding in findings if finding.severity == "error"]


@pytest.mark.parametrize("guard", [*GUARDS.values(), PYTEST], ids=[*GUARDS, "pytest.raises"])
def test_a_guarded_name_is_no_error(rule_checker: Checker, guard: str) -> None:
    assert _errors(rule_checker, guard) == []
    assert _errors(rule_checker, "def of_a_function():\n" + indent(dedent(guard), "    ")) == []


@pytest.mark.parametrize("code", NO_GUARDS.values(), ids=NO_GUARDS)
def test_what_is_not_guarded_is_found(rule_checker: Checker, code: str) -> None:
    assert _errors(rule_checker, code) == ["bpy.types.Object.draw_type"]


def test_the_guards_work(tmp_path: Path) -> None:
    done = run_statements(tmp_path, [AROUND + dedent(guard) for guard in GUARDS.values()])
    assert {name: row[0] for name, row in zip(GUARDS, done, strict=True) if row[0]} == {}


@pytest.mark.parametrize(
    "code",
    [
        "if {}:\n    def f():\n        ob.draw_type",
        "if {}:\n    class C:\n        def f(self):\n            return ob.draw_type",
        "if {}:\n    import bmesh\n    bmesh.ops.create_cube(bmesh.new())['faces']",
        "import bmesh\nx = {} and bmesh.ops.create_cube(bmesh.new())['faces']",
        "import bmesh\nx = [bmesh.ops.create_cube(bmesh.new())['faces'] for _ in range(3) if {}]",
        "if {}:\n    class Grow(bpy.types.Operator):\n        bl_label = ''\n        bl_idname = 'OBJECT_OT_growAll'",
    ],
)
def test_no_rule_finds_an_error_behind_an_open_question(rule_checker: Checker, code: str) -> None:
    assert _errors(rule_checker, code.format("bpy.app.version_string < '2.80'")) == []
    assert _errors(rule_checker, code.format("ob.name")) != []


# ``ShaderNodeTexMusgrave`` went in 4.1: a class by its name, which nodes.new takes.
ASKING = (
    "X in dir(bpy.types)", "hasattr(bpy.types, X)", "getattr(bpy.types, X, None)", "X in NAMES", "HAS",
    "bpy.types.Node.bl_rna_get_subclass_py(X)",
)  # fmt: skip
NODES = """\
import bpy
nodes = bpy.data.node_groups.new('x', 'ShaderNodeTree').nodes
NAMES = dir(bpy.types)
HAS = X in dir(bpy.types)
"""


def _with_node(code: str, asked: str) -> str:
    return (NODES + code.replace("ASKED", asked)).replace("X", "'ShaderNodeTexMusgrave'")


CHOICES = (
    "nodes.new(X) if ASKED else nodes.new('ShaderNodeTexNoise')",
    "nodes.new('ShaderNodeTexNoise') if not ASKED else nodes.new(X)",
    "ASKED and nodes.new(X)",
    "if ASKED:\n    nodes.new(X)",
    "def f():\n    if not ASKED:\n        return\n    nodes.new(X)\nf()",
)


def test_a_guarded_text_is_no_error(rule_checker: Checker, tmp_path: Path) -> None:
    texts = [_with_node(code, asked) for code in CHOICES for asked in ASKING]
    assert [error for error, *_ in run_statements(tmp_path, texts) if error] == []
    assert [text for text in texts if rule_checker.check(text)] == []


@pytest.mark.parametrize(
    "asked",
    ["hasattr(bpy.types, X)", "X in dir(bpy.types)", "getattr(bpy.types, X, None)"],
)
def test_an_operator_may_be_asked_for_by_its_class(rule_checker: Checker, asked: str) -> None:
    """``bpy.ops.wm.collada_export`` went in 5.0, ``bpy.ops.gpencil`` in 4.3."""
    for name, path in (("WM_OT_collada_export", "wm.collada_export"), ("GPENCIL_OT_draw", "gpencil.draw")):
        call, condition = f"bpy.ops.{path}()", asked.replace("X", repr(name))
        for code in (f"{call} if {condition} else None", f"if {condition}:\n    {call}"):
            assert _errors(rule_checker, code) == []
            assert _errors(rule_checker, f"{code}\n{call}") == [f"bpy.ops.{path}"]
            assert _errors(rule_checker, code.replace(repr(name), "'OBJECT_OT_add'")) == [f"bpy.ops.{path}"]


@pytest.mark.parametrize("code", ["if ASKED:\n    pass\nnodes.new(X)", "if not nodes:\n    nodes.new(X)"])
def test_a_text_that_is_not_guarded_is_found(rule_checker: Checker, tmp_path: Path, code: str) -> None:
    text = _with_node(code, ASKING[0])
    assert run_statements(tmp_path, [text])[0][0]
    assert [finding.rule for finding in rule_checker.check(text)] == ["unknown-node"]


@pytest.mark.parametrize(
    ("compat", "code"),
    [
        ("OLD = bpy.app.version < (2, 80)", "from .compat import OLD\nif OLD:\n    ob.draw_type"),
        (
            "class V:\n    OLD = bpy.app.version < (2, 80)",
            "from .compat import V\nif V.OLD:\n    ob.draw_type",
        ),
        (
            "ERRORS = (AttributeError,)",
            "from . import compat\ntry:\n    ob.draw_type\nexcept compat.ERRORS:\n    pass",
        ),
        (
            "def has(x, name):\n    return x",
            "from .compat import has\nif has(ob, 'draw_type'):\n    ob.draw_type",
        ),
    ],
)
def test_another_file_may_ask(rule_checker: Checker, compat: str, code: str) -> None:
    files = {"addon/compat.py": f"import bpy\n{compat}", "addon/__init__.py": AROUND + code}
    read = rule_checker.read_files(files)["addon/__init__.py"]
    assert not [finding for finding in rule_checker.check(read) if finding.severity == "error"]


@pytest.mark.parametrize(
    ("first", "is_reached"), [("node.sky_type = 'NISHITA'", False), ("node.sky_type = 'HOSEK_WILKIE'", True)]
)
def test_behind_an_error_that_is_caught_nothing_is_reached(
    rule_checker: Checker, tmp_path: Path, first: str, is_reached: bool
) -> None:
    """A sky's ``NISHITA`` and its ``dust_density`` went in 5.0."""
    made = (
        "import bpy\nnode = bpy.data.node_groups.new('x', 'ShaderNodeTree').nodes.new('ShaderNodeTexSky')\n"
    )
    code = f"{made}try:\n    {first}\n    node.dust_density = 1\nexcept TypeError:\n    pass"
    assert bool(run_statements(tmp_path, [code])[0][0]) is is_reached
    assert bool(rule_checker.check(code)) is is_reached


# What is in a `try`, with a handler that lets the error pass or not.
TRIED = {
    "operator": "bpy.ops.import_mesh.ply(filepath='x')",
    "attribute": "bpy.data.scenes[0].node_tree",
    "stored": "ob.draw_type = 'WIRE'",
    "read-only": "ob.type = 'MESH'",
    "value": "bpy.data.scenes[0].render.engine = 'BLENDER_EEVEE_NEXT'",
    "value of an operator": "bpy.ops.object.mode_set(mode='PAINT_GPENCIL')",
    "type": "ob.name = 1",
    "keyword": "ob.select_set(True, view=None)",
    "node": "bpy.data.node_groups.new('x', 'CompositorNodeTree').nodes.new('CompositorNodeComposite')",
    "socket": """
        tree = bpy.data.node_groups.new('x', 'ShaderNodeTree')
        tree.nodes.new('ShaderNodeBsdfPrincipled').inputs['Specular']
    """,
    "module": "from bpy_extras import keyconfig_utils",
    "icons": "ob.constraints.new(type='TRACK')",
}
HANDLERS = (
    "except AttributeError: pass", "except RuntimeError: pass", "except TypeError: pass", "except KeyError: pass",
    "except (KeyError, IndexError): pass", "except LookupError: pass", "except ImportError: pass",
    "except Exception: pass", "except OSError: pass", "except: pass", "except Exception: print(ob); raise",
    "except Exception as error: raise ValueError('x') from error", "finally: pass",
    "except RuntimeError: pass\nexcept AttributeError: raise",
)  # fmt: skip


def _tried(code: str, handler: str) -> str:
    return f"try:\n{indent(dedent(code), '    ')}\n{handler}"


def test_a_handler_lets_pass_what_it_catches(rule_checker: Checker, tmp_path: Path) -> None:
    tried = [_tried(code, handler) for code in TRIED.values() for handler in HANDLERS]
    tried += [_tried(one, "except Exception: pass") for one in tried[: len(HANDLERS)]]
    tried += [_tried(one, "except KeyError: pass") for one in tried[: len(HANDLERS) - 4]]
    done = run_statements(tmp_path, [AROUND + one for one in tried])
    raised = [one for one, row in zip(tried, done, strict=True) if row[0]]
    assert len(tried) / 3 < len(raised) < len(tried)
    assert [one for one in tried if _errors(rule_checker, one)] == raised


_OF_DATA: str = """\
import bpy
light = bpy.data.lamps.new("L", "SUN") if hasattr(bpy.data, "lamps") else bpy.data.lights.new("L", "SUN")
light.energi
if hasattr(bpy.data, "lamps"):
    bpy.data.lamps.new("L", "SUN")
else:
    bpy.data.lights.new("L", "SUN").use_sphere
hasattr(bpy.data, "own") and bpy.data.own
"""


def test_what_the_data_surely_lack_decides_which_way_is_taken(rule_checker: Checker, tmp_path: Path) -> None:
    lines = ["import bpy", *_statements(_OF_DATA)]
    errors = [error for error, *_ in run_statements(tmp_path, lines) if error]
    assert len(errors) == 2
    found = rule_checker.check(_OF_DATA, rules=["unknown-attribute"])
    assert [one.span.line for one in found] == [3, 7]


def _statements(code: str) -> list[str]:
    """The statements of a script behind its first line, each as it is written."""
    return [ast.get_source_segment(code, node) or "" for node in ast.parse(code).body[1:]]
