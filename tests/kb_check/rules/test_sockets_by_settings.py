"""Sockets that a node's settings hide are found where Blender refuses their names or indices, and nowhere else.

`make test` takes every fourth node.
"""

from __future__ import annotations

from textwrap import dedent
from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender
from whole import IS_WHOLE

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

# Of each node: which of all its keys are refused in the states that one or two of its settings make.
_ASK = """
import itertools, json, sys
import bpy

INHERITED = set(bpy.types.Node.bl_rna.properties.keys())
MOST_PAIRS = 150

def settings(node):
    for prop in node.bl_rna.properties:
        if prop.type == 'ENUM' and prop.identifier not in INHERITED and not prop.is_readonly and not prop.is_enum_flag:
            yield [(prop.identifier, item.identifier) for item in prop.enum_items]

def in_state(tree, name, state):
    node = tree.nodes.new(name)
    try:
        for setting, value in state:
            setattr(node, setting, value)
    except TypeError:
        tree.nodes.remove(node)
        return None
    return node

def is_given(sockets, key):
    try:
        sockets[key]
    except (KeyError, IndexError):
        return False
    return True

def rows(tree, name):
    node = tree.nodes.new(name)
    each = list(settings(node))
    states = [()] + [(one,) for values in each for one in values]
    for first, second in itertools.permutations(each, 2):
        if len(first) * len(second) <= MOST_PAIRS:
            states += itertools.product(first, second)
    tree.nodes.remove(node)
    keys = {}
    for state in states:
        if node := in_state(tree, name, state):
            for side in ("inputs", "outputs"):
                for place, socket in enumerate(getattr(node, side)):
                    keys.update({(side, key): None for key in (place, socket.name, socket.identifier)})
            tree.nodes.remove(node)
    for state in states:
        if node := in_state(tree, name, state):
            yield state, [(side, key, is_given(getattr(node, side), key)) for side, key in keys if key != ""]
            tree.nodes.remove(node)

found = []
for kind in ("ShaderNodeTree", "GeometryNodeTree", "CompositorNodeTree"):
    tree = bpy.data.node_groups.new("tree", kind)
    for name in sorted(dir(bpy.types)):
        cls = getattr(bpy.types, name)
        if isinstance(cls, type) and issubclass(cls, bpy.types.Node):
            try:
                tree.nodes.remove(tree.nodes.new(name))
            except RuntimeError:
                continue
            found.append([kind, name, list(rows(tree, name))])
open(sys.argv[-1], "w").write(json.dumps(found))
"""


def test_what_settings_hide_is_found_and_what_they_show_is_not(rule_checker: Checker, tmp_path: Path) -> None:
    nodes: list[tuple[str, str, list[tuple[list[tuple[str, str]], list[tuple[str, str | int, bool]]]]]]
    nodes = told_by_blender(_ASK, tmp_path, seconds=240)
    false: list[str] = []
    refused = found = 0
    for kind, name, states in nodes if IS_WHOLE else nodes[::4]:
        lines = ["import bpy", f"tree = bpy.data.node_groups.new('tree', {kind!r})"]
        given: dict[int, bool] = {}
        for number, (state, keys) in enumerate(states):
            lines.append(f"node_{number} = tree.nodes.new({name!r})")
            lines += [f"node_{number}.{setting} = {value!r}" for setting, value in state]
            for side, key, is_given in keys:
                lines.append(f"node_{number}.{side}[{key!r}]")
                given[len(lines)] = is_given
        told = {
            one.span.line: one.message
            for one in rule_checker.check("\n".join(lines))
            if one.severity == "error"
        }
        false += [f"{lines[line - 1]} {message}" for line, message in told.items() if given.get(line, True)]
        refused += sum(not is_given for is_given in given.values())
        found += sum(not is_given and line in told for line, is_given in given.items())
    assert false == []
    assert refused > 2_500
    assert found >= 0.99 * refused


_NODE = """
    import bpy
    tree = bpy.data.node_groups.new("tree", "GeometryNodeTree")
    node = tree.nodes.new("ShaderNodeVectorMath")
"""


_OF_ANY_KIND = """\
import bpy
def stretch(tree, kind, factor):
    node = tree.nodes.new("ShaderNodeTexNoise")
    if kind:
        node = tree.nodes.new(kind)
    node.inputs["Scale"].default_value = factor
stretch(bpy.data.materials.new("m").node_tree, input(), (1, 2, 3))
"""


def test_a_node_that_may_be_any_has_sockets_of_any_type(check: Check) -> None:
    assert not check("wrong-type", _OF_ANY_KIND)
    assert check(
        "wrong-type", _OF_ANY_KIND.replace("    if kind:\n        node = tree.nodes.new(kind)\n", "")
    )


@pytest.mark.parametrize(
    ("code", "line"),
    [
        # The last one that surely ran counts, in whatever body.
        ("node.operation = 'DOT_PRODUCT'\nnode.operation = 'ADD'\nnode.outputs['Value']", 3),
        ("node.operation = 'ADD'\nnode.operation = 'DOT_PRODUCT'\nnode.outputs['Value']", None),
        ("node.outputs['Value']\nnode.operation = 'DOT_PRODUCT'", 1),
        ("if tree.users:\n    node.operation = 'LENGTH'\n    node.outputs['Vector']", 3),
        ("if tree.users:\n    node.operation = 'LENGTH'\nnode.outputs['Vector']", None),
        # What stands below comes before in a loop, and where a function is called.
        ("for _ in range(2):\n    node.outputs['Value']\n    node.operation = 'LENGTH'", None),
        ("def ask():\n    node.outputs['Value']\nnode.operation = 'LENGTH'\nask()", None),
        (
            "node.operation = 'ADD'\ndef ask():\n    node.outputs['Value']\nnode.operation = 'LENGTH'\nask()",
            None,
        ),
        # Values of which nothing is known, and those that Blender does not take.
        ("node.operation = tree.name\nnode.outputs['Value']", None),
        ("node.operation = 'SUM'\nnode.outputs['Value']", None),
    ],
)
def test_the_state_is_that_of_the_place(rule_checker: Checker, code: str, line: int | None) -> None:
    script = dedent(_NODE) + code
    before = dedent(_NODE).count("\n")
    found = [one.span.line - before for one in rule_checker.check(script, rules=["hidden-socket"])]
    assert found == ([] if line is None else [line])
