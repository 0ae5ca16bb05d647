"""Objects that are used before they are in a collection are found: each script is run, and fails or does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
layer = bpy.context.view_layer
objects = bpy.context.collection.objects
other = bpy.data.objects.new("other", None)
objects.link(other)
ob = bpy.data.objects.new("ob", None)
"""
_SELECT = "ob.select_set(True)"
_LINK = "objects.link(ob)\n"
_PROPS = 'props = bpy.data.collections.new("props")\n'
_IN_PROPS = f"{_PROPS}props.objects.link(ob)\n"
_LINK_PROPS = "bpy.context.scene.collection.children.link(props)\n"
_UNLINK = "for one in other.users_collection:\n    one.objects.unlink(other)\n"
_WRONG = {
    "selected": _SELECT,
    "selected by keyword": "ob.select_set(state=True)",
    "active": "bpy.context.view_layer.objects.active = ob",
    "active of a name": "layer.objects.active = ob",
    "hidden": "ob.hide_set(True)",
    "linked later": f"{_SELECT}\n{_LINK}",
    "set meanwhile": f"ob.location = (1, 2, 3)\nob.parent = other\nprint(len(ob.name))\n{_SELECT}",
    "pointed to": f"other.parent = ob\n{_SELECT}",
    "another is linked": f"new = bpy.data.objects.new('new', None)\nobjects.link(new)\n{_SELECT}",
    "copy": f"{_LINK}twin = ob.copy()\ntwin.select_set(True)",
    "in a function": "def f():\n    ob = bpy.data.objects.new('ob', None)\n    ob.select_set(True)\nf()",
}
_WRONG |= {
    "in a collection of no scene": f"{_IN_PROPS}{_SELECT}",
    "made before the object": f"{_PROPS}ob = bpy.data.objects.new('new', None)\nprops.objects.link(ob)\n{_SELECT}",
    "active, in a collection of no scene": f"{_IN_PROPS}layer.objects.active = ob",
    "the collection is linked later": f"{_IN_PROPS}{_SELECT}\n{_LINK_PROPS}",
    "unlinked": f"{_UNLINK}other.select_set(True)",
    "unlinked of a list": f"{_UNLINK.replace('other.users_collection', 'list(other.users_collection)')}"
    "layer.objects.active = other",
    "unlinked and linked to a collection of no scene": f"{_PROPS}{_UNLINK}props.objects.link(other)\n"
    "other.select_set(True)",
}
_SOUND = {
    "linked": f"{_LINK}{_SELECT}\nlayer.objects.active = ob",
    "not selected": "ob.select_set(False)\nob.hide_set(False)",
    "linked by a helper": f"def link(which):\n    objects.link(which)\nlink(ob)\n{_SELECT}",
    "linked out of sight": f"def link():\n    objects.link(ob)\nlink()\n{_SELECT}",
    "linked as one of all": "for one in bpy.data.objects:\n    if one != other:\n        objects.link(one)\n"
    f"{_SELECT}",
    "linked from a list": f"made = [ob]\nobjects.link(made[0])\n{_SELECT}",
    "linked as a parent": f"other.parent = ob\nup = other.parent\nobjects.link(up)\n{_SELECT}",
    "linked in a condition": f"if ob.name:\n    {_LINK}{_SELECT}",
    "caught": f"try:\n    {_SELECT}\nexcept RuntimeError:\n    pass",
    "another name": f"{_LINK}ob, new = other, bpy.data.objects.new('new', None)\n{_SELECT}",
    "in a collection of the scene": f"{_IN_PROPS}{_LINK_PROPS}{_SELECT}",
    "in one that the scene had": f"{_PROPS}{_LINK_PROPS}props.objects.link(ob)\n{_SELECT}",
    "in a collection within another": f"{_IN_PROPS}up = bpy.data.collections.new('up')\nup.children.link(props)\n"
    f"bpy.context.scene.collection.children.link(up)\n{_SELECT}",
    "in two": f"{_IN_PROPS}{_LINK}{_SELECT}",
    "its collection is linked by a helper": f"def show(which):\n    {_LINK_PROPS.replace('props', 'which')}"
    f"{_IN_PROPS}show(props)\n{_SELECT}",
    "its collection is linked by its name": f"{_IN_PROPS}"
    f"bpy.context.scene.collection.children.link(bpy.data.collections['props'])\n{_SELECT}",
    "linked and unlinked": f"{_UNLINK}objects.link(other)\nother.select_set(True)",
    "unlinked and linked out of sight": f"def find():\n    return bpy.data.objects['other']\nthis = find()\n{_UNLINK}"
    "objects.link(this)\nother.select_set(True)",
    "unlinked of some": "for one in other.users_collection:\n    if one.name == 'x':\n"
    "        one.objects.unlink(other)\nother.select_set(True)",
    "moved": f"{_PROPS}{_LINK_PROPS}{_UNLINK}props.objects.link(other)\nother.select_set(True)",
    "camera of the scene": "bpy.context.scene.camera = ob",
}


def test_what_is_in_no_collection_is_found(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _WRONG.values()])
    errors = {name: error.partition(":")[0] for name, (error, *_) in zip(_WRONG, answers, strict=True)}
    assert errors == dict.fromkeys(_WRONG, "RuntimeError")
    found = {name: check("unlinked-object", f"{_START}{code}") for name, code in _WRONG.items()}
    assert [name for name, findings in found.items() if len(findings) != 1] == []


def test_what_runs_has_no_finding(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _SOUND.values()])
    assert [(name, error) for name, (error, *_) in zip(_SOUND, answers, strict=True) if error] == []
    assert [name for name, code in _SOUND.items() if check("unlinked-object", f"{_START}{code}")] == []


_SHOWN = "ob.name in bpy.context.scene.objects"
_NEVER = {
    "never linked": _IN_PROPS,
    "of a function": "def make(name):\n"
    "    rest = bpy.data.collections.new(name)\n    ob = bpy.data.objects.new(name, None)\n    rest.objects.link(ob)\n"
    "make('ob')",
    "named": f"{_IN_PROPS}props.name = 'a'\nprint(props.name)",
}
_SHOWING = {
    "linked": f"{_IN_PROPS}{_LINK_PROPS}",
    "linked by its name": f"{_IN_PROPS}bpy.context.scene.collection.children.link(bpy.data.collections['props'])",
    "linked as one of all": f"{_IN_PROPS}for one in bpy.data.collections:\n"
    "    if one.name == 'props':\n        bpy.context.scene.collection.children.link(one)",
    "linked by a helper": f"def show(which):\n    {_LINK_PROPS.replace('props', 'which')}{_IN_PROPS}show(props)",
    "in the active one before": f"bpy.ops.mesh.primitive_cube_add()\nob = bpy.context.object\n{_IN_PROPS}",
    "in both": f"{_PROPS}objects.link(ob)\nbpy.context.scene.rigidbody_world and props.name",
}


def test_a_collection_that_is_never_linked_is_found(check: Check, tmp_path: Path) -> None:
    shown = [f"{_START}{code}\nassert {_SHOWN}" for code in _SHOWING.values()]
    hidden = [f"{_START}{code}\nassert not {_SHOWN}" for code in _NEVER.values()]
    answers = [error for error, *_ in run_statements(tmp_path, [*shown, *hidden])]
    assert [(name, error) for name, error in zip([*_SHOWING, *_NEVER], answers, strict=True) if error] == []
    found = {name: check("unlinked-object", f"{_START}{code}\n") for name, code in _NEVER.items()}
    severities = [[finding.severity for finding in findings] for findings in found.values()]
    assert severities == [["warning"]] * len(_NEVER)
    assert [name for name, code in _SHOWING.items() if check("unlinked-object", f"{_START}{code}\n")] == []


@pytest.mark.parametrize(
    "code",
    [
        f"{_IN_PROPS}other.instance_type = 'COLLECTION'\nother.instance_collection = props",
        f"{_IN_PROPS}props.asset_mark()",
        f"{_IN_PROPS}bpy.context.scene.rigidbody_world.collection = props",
        f"{_IN_PROPS}bpy.ops.object.collection_instance_add(collection='props')",
        f"{_IN_PROPS}kept = [props]",
        _PROPS,
    ],
)
def test_a_collection_that_is_used_otherwise_has_no_finding(check: Check, code: str) -> None:
    assert check("unlinked-object", f"{_START}{code}\n") == []
