"""Classes that are registered again, or unregistered before: each script is run, and fails or does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy
class Part(bpy.types.PropertyGroup):
    size: bpy.props.FloatProperty()
class OBJECT_OT_grow(bpy.types.Operator):
    bl_idname = "object.grow"
    bl_label = "Grow"
classes = (Part, OBJECT_OT_grow)
"""
_EACH = "    for cls in {}:\n        bpy.utils.{}(cls)\n"
_REGISTER = "def register():\n" + _EACH.format("classes", "register_class")
_RUN = "register()\nunregister()\n"
_ONE = "def register():\n    bpy.utils.register_class(Part)\n"
_AGAIN = {
    "one class": f"{_ONE}def unregister():\n    bpy.utils.register_class(Part)\n{_RUN}",
    "out of a list": f"{_REGISTER}def unregister():\n{_EACH.format('classes', 'register_class')}{_RUN}",
    "backwards": f"{_REGISTER}def unregister():\n{_EACH.format('reversed(classes)', 'register_class')}{_RUN}",
}
_NEVER = {
    "never registered": "class Other(bpy.types.PropertyGroup):\n    pass\nbpy.utils.unregister_class(Other)",
    "in a function": "class Other(bpy.types.Panel):\n    bl_label = 'x'\n"
    "def unregister():\n    bpy.utils.unregister_class(Other)\nunregister()",
}
_SOUND = {
    "right": f"{_REGISTER}def unregister():\n{_EACH.format('reversed(classes)', 'unregister_class')}{_RUN}",
    "others in its place": f"{_REGISTER}class Other(bpy.types.PropertyGroup):\n    pass\n"
    f"def unregister():\n    bpy.utils.register_class(Other)\n{_RUN}bpy.utils.unregister_class(Other)\n"
    + _EACH.format("classes", "unregister_class").replace("    for", "for").replace("        bpy", "    bpy"),
    "anew": f"{_ONE}def unregister():\n    bpy.utils.unregister_class(Part)\n    bpy.utils.register_class(Part)\n"
    f"{_RUN}bpy.utils.unregister_class(Part)",
    "caught": f"{_ONE}def unregister():\n    try:\n        bpy.utils.register_class(Part)\n"
    f"    except ValueError:\n        pass\n{_RUN}bpy.utils.unregister_class(Part)",
    "never, and caught": "class Other(bpy.types.PropertyGroup):\n    pass\n"
    "try:\n    bpy.utils.unregister_class(Other)\nexcept RuntimeError:\n    pass",
    "by itself": "class Other(bpy.types.PropertyGroup):\n    pass\n"
    "bpy.utils.register_class(bpy.types.PropertyGroup.__subclasses__()[-1])\nbpy.utils.unregister_class(Other)",
    "by a helper": "class Other(bpy.types.PropertyGroup):\n    pass\ndef put(cls):\n    bpy.utils.register_class(cls)\n"
    "put(Other)\nbpy.utils.unregister_class(Other)",
}


def test_what_blender_refuses_is_found(check: Check, tmp_path: Path) -> None:
    for codes, kind in ((_AGAIN, "ValueError"), (_NEVER, "RuntimeError")):
        answers = run_statements(tmp_path, [f"{_START}{code}" for code in codes.values()])
        errors = {name: error.partition(":")[0] for name, (error, *_) in zip(codes, answers, strict=True)}
        assert errors == dict.fromkeys(codes, kind)
        found = {name: check("wrong-unregister", f"{_START}{code}") for name, code in codes.items()}
        assert [name for name, findings in found.items() if len(findings) != 1] == []


def test_what_is_mended_runs(check: Check, tmp_path: Path) -> None:
    mended: list[str] = []
    for code in _AGAIN.values():
        text = f"{_START}{code}"
        mended.append(apply_fixes(Source(text), check("wrong-unregister", text)).text)
    assert [error for error, *_ in run_statements(tmp_path, mended) if error] == []


def test_what_runs_has_no_finding(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [f"{_START}{code}" for code in _SOUND.values()])
    assert [(name, error) for name, (error, *_) in zip(_SOUND, answers, strict=True) if error] == []
    assert [name for name, code in _SOUND.items() if check("wrong-unregister", f"{_START}{code}")] == []
