"""Identifiers of sockets as keys: found where Blender raises KeyError, and nowhere else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_build.symbols.records import Symbol
from kb_check.nodes.socket_modes import is_internal

if TYPE_CHECKING:
    from conftest import Check

    from kb_check.checker import Checker

# For each node in each of its modes: how it is made, and what its identifiers that are not names give as keys.
_ASK = """
import json, sys
import bpy

INHERITED = set(bpy.types.Node.bl_rna.properties.keys())

def modes(node):
    yield "", ""
    for prop in node.bl_rna.properties:
        if prop.type == 'ENUM' and prop.identifier not in INHERITED and not prop.is_readonly and not prop.is_enum_flag:
            yield from ((prop.identifier, item.identifier) for item in prop.enum_items_static)

def keys(node):
    for side in ("inputs", "outputs"):
        sockets = getattr(node, side)
        names = {socket.name for socket in sockets}
        for identifier in dict.fromkeys(socket.identifier for socket in sockets):
            if identifier not in names:
                try:
                    sockets[identifier]
                except KeyError:
                    yield side, identifier, False
                else:
                    yield side, identifier, True

rows = []
for kind in ("ShaderNodeTree", "GeometryNodeTree", "CompositorNodeTree", "TextureNodeTree"):
    tree = bpy.data.node_groups.new("tree", kind)
    for name in sorted(dir(bpy.types)):
        cls = getattr(bpy.types, name)
        if not isinstance(cls, type) or not issubclass(cls, bpy.types.Node):
            continue
        try:
            node = tree.nodes.new(name)
        except RuntimeError:
            continue
        for mode, choice in modes(node):
            before = getattr(node, mode) if mode else None
            try:
                if mode:
                    setattr(node, mode, choice)
            except TypeError:
                continue
            rows.append([kind, name, mode, choice, list(keys(node))])
            if mode:
                setattr(node, mode, before)
        tree.nodes.remove(node)
open(sys.argv[-1], "w").write(json.dumps(rows))
"""
# What a script cannot tell beforehand: their sockets are made by what is done to them.
_OWN = ("Group", "Switch", "Input", "Output", "Bake", "CaptureAttribute", "Format", "List", "Grid")


@pytest.fixture(scope="module")
def rows(
    tmp_path_factory: pytest.TempPathFactory,
) -> list[tuple[str, str, str, str, list[tuple[str, str, bool]]]]:
    return told_by_blender(_ASK, tmp_path_factory.mktemp("keys"), seconds=240)


def test_keys_that_blender_takes_are_no_finding_and_those_that_it_refuses_are(
    rule_checker: Checker, rows: list[tuple[str, str, str, str, list[tuple[str, str, bool]]]]
) -> None:
    wrong: list[str] = []
    missed: list[str] = []
    taken = refused = 0
    for kind, name, mode, choice, keys in rows:
        if not keys:
            continue
        made = f"import bpy\nnode = bpy.data.node_groups.new('tree', {kind!r}).nodes.new({name!r})\n"
        made += f"node.{mode} = {choice!r}\n" if mode else ""
        start = made.count("\n") + 1
        code = made + "".join(f"node.{side}[{key!r}]\n" for side, key, _ in keys)
        found = {
            one.span.line
            for one in rule_checker.check(code, rules=["unknown-socket", "hidden-socket"])
            if one.span.line >= start
        }
        for line, (side, key, works) in enumerate(keys, start):
            text = f"{name}({mode}={choice}).{side}[{key!r}]"
            if works:
                taken += 1
                wrong += [text] if line in found else []
            elif not mode:  # which modes it is refused in is not what these rules look at
                refused += 1
                missed += [text] if line not in found and not name.endswith(_OWN) else []
    assert taken > 165
    assert refused > 45
    assert wrong == []
    assert missed == []


@pytest.mark.parametrize(
    ("node", "name", "internal"),
    [("ShaderNodeBackground", "Weight", True), ("CompositorNodeRLayers", "Depth", False)],
)
def test_what_a_node_shows_of_a_scene_is_not_said_to_be_never_there(
    rule_checker: Checker, node: str, name: str, internal: bool
) -> None:
    owner = f"bpy.types.{node}"
    flags = (f"identifier:{name}", "hidden-by-default")
    socket = Symbol(f'{owner}.outputs["{name}"]', "socket", owner, name, flags=flags)
    assert is_internal(rule_checker.api, socket) is internal


def test_a_former_output_is_not_taken_for_an_input_of_that_name(check: Check) -> None:
    code = (
        "import bpy\n"
        "tree = bpy.data.node_groups.new('t', 'CompositorNodeTree')\n"
        "node = tree.nodes.new('ShaderNodeMapRange')\n"
        "tree.links.new(node.outputs['Value'], tree.nodes.new('CompositorNodeBlur').inputs['Image'])\n"
    )
    (found,) = check("unknown-socket", code)
    assert '`bpy.types.ShaderNodeMapRange.outputs["Result"]`' in found.message
    assert check("unknown-socket", code.replace("'Value'", "'Result'")) == []
