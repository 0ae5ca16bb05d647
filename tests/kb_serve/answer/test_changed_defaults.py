"""What new things had otherwise in older Blenders: a new one of this Blender has another value, and is told of."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

import bpy
import pytest

from kb_build.symbols.api_names import TYPES
from kb_serve.answer.known.changed_defaults import CHANGED_DEFAULTS, ChangedDefault
from kb_serve.answer.known.practice import Practice

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader

pytestmark = pytest.mark.blender

_HERE = bpy.app.version[:2]


def _new(changed: ChangedDefault) -> object:
    """The value of a new one of what a row is about."""
    above, _, member = changed.path.removeprefix(TYPES).partition(".")
    if above == "ShapeKey":
        thing = bpy.data.objects.new("o", bpy.data.meshes.new("m"))
        thing.shape_key_add(name="Basis")
        return thing.shape_key_add(name="Key").value
    if above == "ToolSettings":
        return getattr(bpy.data.scenes.new("s").tool_settings, member)
    if "(" in changed.path:
        name, _, parameter = changed.path.removeprefix("bpy.ops.").partition("(")
        module, _, operator = name.partition(".")
        rna = getattr(getattr(bpy.ops, module), operator).get_rna_type()
        return rna.properties[parameter.removesuffix(")")].default
    kind = "GeometryNodeTree" if above.startswith("Geometry") else "ShaderNodeTree"
    node = bpy.data.node_groups.new("t", kind).nodes.new(above)
    socket = member.partition('["')[2].removesuffix('"]')
    if not socket:
        return getattr(node, member)
    return next(one for one in node.inputs if one.name == socket).default_value


@pytest.mark.parametrize("changed", CHANGED_DEFAULTS, ids=lambda changed: f"{changed.path} {changed.since}")
def test_new_ones_have_another_value(changed: ChangedDefault, reader: BaseReader) -> None:
    value, former = _new(changed), ast.literal_eval(changed.former)
    is_former = value == pytest.approx(former) if isinstance(former, float) else value == former
    if changed.since <= _HERE:
        assert not is_former
    elif changed.last == _HERE:
        assert is_former
    path = changed.path.partition("(")[0]
    told = [one for one in Practice(reader).of(path, path) if f"it was {changed.former} in" in one]
    assert bool(told) == (changed.since <= _HERE)
