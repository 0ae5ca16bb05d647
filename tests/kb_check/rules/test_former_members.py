"""Former members of values of which nothing says what they are: what holds them or what they are called says it."""

from __future__ import annotations

from textwrap import dedent
from typing import TYPE_CHECKING

import pytest
from other_versions import base_of, errors_in

from kb_check.checker import Checker

if TYPE_CHECKING:
    from pathlib import Path

_LACKS = "unknown-attribute"


def errors(checker: Checker, code: str) -> list[tuple[int, str]]:
    return [(one.span.line, one.rule) for one in checker.check(dedent(code)) if one.severity == "error"]


@pytest.mark.parametrize(
    "line",
    [
        "made.data.use_auto_smooth = True",
        "print(made.data.auto_smooth_angle)",
        "made.data.calc_normals_split()",
        "made.world.light_settings.use_ambient_occlusion = True",
        "made.cycles.diffuse_samples = 4",
        "file_node = made.find('CompositorNodeOutputFile')\n    file_node.file_slots.clear()",
        "made.output_node.file_slots.clear()  # of\n    made.find('CompositorNodeOutputFile')",
    ],
)
def test_a_former_member_is_known_by_what_holds_the_value_or_what_it_is_called(
    rule_checker: Checker, line: str
) -> None:
    code = f"import bpy\nfrom .making import make\n\ndef use():\n    made = make()\n    {line}\n"
    assert [rule for _, rule in errors(rule_checker, code)] == [_LACKS]


def test_either_of_two_that_a_value_may_be_is_enough(rule_checker: Checker) -> None:
    code = """
        import bpy
        def smooth(ref):
            if isinstance(ref, str):
                found = bpy.data.objects[ref]
            else:
                found = ref
            found.data.use_auto_smooth = True
    """
    assert errors(rule_checker, code) == [(8, _LACKS)]


@pytest.mark.parametrize(
    "line",
    [
        "made.use_auto_smooth = True",  # of what nothing speaks
        "made.settings.use_auto_smooth = True",
        "made.options.file_slots.clear()\n    made.find('CompositorNodeOutputFile')",
        "made.output_node.file_slots.clear()",  # the script speaks of no such node
        "made.data.layers_int = 2",  # nor had any data it
        "made.data.use_mirror_x = True",  # some class has it yet
        "if hasattr(made.data, 'use_auto_smooth'):\n        made.data.use_auto_smooth = True",
        "try:\n        made.data.use_auto_smooth = True\n    except AttributeError:\n        pass",
        "if bpy.app.version < (4, 1, 0):\n        made.data.use_auto_smooth = True",
    ],
)
def test_a_name_alone_says_nothing(rule_checker: Checker, line: str) -> None:
    code = f"import bpy\nfrom .making import make\n\ndef use():\n    made = make()\n    {line}\n"
    assert errors(rule_checker, code) == []


@pytest.mark.parametrize(
    "own",
    [
        "class Own:\n    use_auto_smooth: bool = False",
        "class Own:\n    def __init__(self):\n        self.use_auto_smooth = 1",
        "parser.add_argument('--use-auto-smooth')",
        "own = dict(use_auto_smooth=True)",
    ],
)
def test_what_the_script_itself_calls_so_is_its_own(rule_checker: Checker, own: str) -> None:
    code = f"import bpy\nfrom .making import make, parser\n\n{own}\nmake().data.use_auto_smooth = 1\n"
    assert errors(rule_checker, code) == []


def test_what_a_file_beside_it_calls_so_is_its_own(rule_checker: Checker) -> None:
    files = {
        "own/__init__.py": "",
        "own/data.py": "class Own:\n    use_auto_smooth = False\n",
        "own/use.py": "import bpy\nfrom other import make\nmake().data.use_auto_smooth = 1\n",
    }
    reads = rule_checker.read_files(files)
    assert not rule_checker.check(reads["own/use.py"], rule_checker.package(reads.values()))
    alone = rule_checker.check(files["own/use.py"])
    assert [(one.span.line, one.rule) for one in alone] == [(3, _LACKS)]


@pytest.mark.parametrize("dummy", ["from .making import Dummy", "class Dummy: pass"])
def test_nothing_is_known_where_blenders_module_may_be_a_stand_in(rule_checker: Checker, dummy: str) -> None:
    code = """
        from .making import make
        DUMMY
        try:
            import bpy
        except ImportError:
            bpy = Dummy()
        def use():
            made = make()
            if bpy.app.version < (4, 1, 0):
                made.data.use_auto_smooth = True
    """
    assert errors(rule_checker, code.replace("DUMMY", dummy)) == []


def test_what_blender_loses_without_an_error_is_a_warning(tmp_path: Path) -> None:
    """Before 5.0, a property group takes every name that is assigned."""
    lines = ["bpy.context.scene.cycles.diffuse_samples = 4", "bpy.context.object.data.use_auto_smooth = True"]
    assert [bool(error) for error in errors_in("4.2", tmp_path, lines)] == [False, True]
    code = "import bpy\nfrom .making import made\nmade.cycles.diffuse_samples = 4\nmade.data.use_auto_smooth = True\n"
    with Checker(base_of("4.2")) as checker:
        found = [(one.span.line, one.severity) for one in checker.check(code)]
    assert found == [(3, "warning"), (4, "error")]


_OF_A_NODE = """\
import bpy
def store(node: bpy.types.Node):
    node.base_path = "//frames"
    node.surely_no_member = 1
"""


def test_what_a_class_below_the_known_one_had_is_found(rule_checker: Checker) -> None:
    (found,) = rule_checker.check(_OF_A_NODE, rules=["unknown-attribute"])
    assert (found.span.line, found.symbol) == (3, "bpy.types.CompositorNodeOutputFile.base_path")


def test_a_name_that_the_script_gives_a_class_of_its_own_is_not(rule_checker: Checker) -> None:
    own = "class Own(bpy.types.Node):\n    bl_label = 'Own'\n    base_path: bpy.props.StringProperty()\n"
    assert rule_checker.check(f"{_OF_A_NODE}{own}", rules=["unknown-attribute"]) == []
