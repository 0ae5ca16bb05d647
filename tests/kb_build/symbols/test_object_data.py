"""The classes of objects' data, as Blender itself makes objects of them."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

_ASKED = """
import bpy, json
made = {}
things = [bpy.data.curves.new("", kind) for kind in ("CURVE", "SURFACE", "FONT")]
things += [bpy.data.lights.new("", kind) for kind in ("POINT", "SUN", "SPOT", "AREA")]
things += [bpy.data.lightprobes.new("", "SPHERE")]
for name in bpy.data.bl_rna.properties.keys():
    try:
        things.append(getattr(bpy.data, name).new(""))
    except (AttributeError, TypeError):
        pass
for thing in things:
    try:
        made[type(thing).__name__] = bpy.data.objects.new("", thing).type
    except (TypeError, RuntimeError):
        made[type(thing).__name__] = ""
print(json.dumps(made))
"""


@pytest.fixture(scope="module")
def types_by_class() -> dict[str, str]:
    """What Blender makes new things of → the type of an object with such data; empty if it refuses that."""
    done = subprocess.run([sys.executable, "-c", _ASKED], capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def test_a_class_is_the_data_of_the_objects_that_blender_makes_of_it(
    kb: KnowledgeBase, types_by_class: dict[str, str]
) -> None:
    assert {"MetaBall", "SurfaceCurve", "TextCurve", "GreasePencil", "Material"} <= set(types_by_class)
    found = {name: kb.reader.object_type(f"bpy.types.{name}") for name in types_by_class}
    assert found == types_by_class
    assert set(kb.reader.object_data) == set(types_by_class.values()) - {""}


def test_a_class_of_another_module_is_no_data_of_objects(kb: KnowledgeBase) -> None:
    assert kb.reader.entry("freestyle.types.Curve")
    assert not kb.reader.is_object_data("freestyle.types.Curve")
