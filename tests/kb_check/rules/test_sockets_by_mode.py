"""Sockets that Blender gives in some mode of a node, and the values that they have there, are no finding.

`make test` takes every third mode.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from told_by_blender import told_by_blender
from whole import IS_WHOLE

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

# Writes a script for each mode of each node: its sockets by name and by index, each given the value that it has.
_WRITE = """
import json, sys
import bpy

INHERITED = set(bpy.types.Node.bl_rna.properties.keys())

def modes(node):
    yield "", ""
    for prop in node.bl_rna.properties:
        if prop.type == 'ENUM' and prop.identifier not in INHERITED and not prop.is_readonly and not prop.is_enum_flag:
            yield from ((prop.identifier, item.identifier) for item in prop.enum_items_static)

def value(socket):
    held = getattr(socket, "default_value", None)
    if held is None or isinstance(held, bpy.types.bpy_struct):
        return ""
    return f".default_value = {tuple(held) if hasattr(held, '__len__') and not isinstance(held, str) else held!r}"

def lines(node):
    for side, sockets in (("inputs", node.inputs), ("outputs", node.outputs)):
        for place, socket in enumerate(sockets):
            if not socket.enabled or socket.is_unavailable:
                continue
            yield f"node.{side}[{place}]{value(socket)}"
            if socket.name in sockets and sockets[socket.name] == socket:
                yield f"node.{side}[{socket.name!r}]{value(socket)}"

def scripts():
    for kind in ("ShaderNodeTree", "GeometryNodeTree", "CompositorNodeTree", "TextureNodeTree"):
        tree = bpy.data.node_groups.new("tree", kind)
        for name in sorted(dir(bpy.types)):
            cls = getattr(bpy.types, name)
            if not isinstance(cls, type) or not issubclass(cls, bpy.types.Node):
                continue
            try:
                first = tree.nodes.new(name)
            except RuntimeError:
                continue
            for mode, choice in [*modes(first)]:
                node = tree.nodes.new(name)  # a mode may change others, and leave them so
                try:
                    if mode:
                        setattr(node, mode, choice)
                except TypeError:
                    continue
                made = f"tree = bpy.data.node_groups.new('tree', {kind!r})", f"node = tree.nodes.new({name!r})"
                mode_set = f"node.{mode} = {choice!r}" if mode else ""
                yield "\\n".join(["import bpy", *made, mode_set, *lines(node)])
            tree.nodes.clear()

open(sys.argv[-1], "w").write(json.dumps(list(scripts())))
"""


_BY_PLACE = "moved-socket"  # they are asked for by their places, where older Blenders may have others


def test_sockets_of_every_mode_are_no_finding(rule_checker: Checker, tmp_path: Path) -> None:
    scripts: list[str] = told_by_blender(_WRITE, tmp_path, seconds=240)
    assert sum(script.count("\n") for script in scripts) > 15_000
    if not IS_WHOLE:
        scripts = scripts[::3]
    flagged: list[tuple[str, ...]] = []
    for script in scripts:
        lines = script.split("\n")
        flagged += [
            (lines[2], lines[3], lines[finding.span.line - 1], finding.message)
            for finding in rule_checker.check(script)
            if finding.severity != "note" and finding.rule != _BY_PLACE
        ]
    assert flagged == []
