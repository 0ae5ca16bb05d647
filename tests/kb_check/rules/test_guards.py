"""Code that is for other Blenders is no finding in this one, and only that code."""

from __future__ import annotations

from textwrap import dedent, indent
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_check.checker import Checker

# ``editor.sequences`` went in 5.0; ``lines`` are for it and for what took its place.
GUARDED = {
    "hasattr, as a choice": "strips = editor.strips if hasattr(editor, 'strips') else editor.sequences",
    "hasattr, with its way out": """
        if not hasattr(editor, "strips"):
            return editor.sequences
        return editor.strips
    """,
    "hasattr of what went": """
        if hasattr(editor, "active_strip_of_old"):
            editor.sequences
    """,
    "getattr with a default": """
        strips = getattr(editor, "strips", None)
        if strips is None:
            strips = editor.sequences
    """,
    "getattr with a default, and its way out": """
        strips = getattr(editor, "strips", None)
        if strips:
            return strips
        return editor.sequences
    """,
    "getattr as a condition": """
        if not getattr(editor, "strips", None):
            editor.sequences
    """,
    "a constant of hasattr": """
        if HAS_OLD:
            bpy.types.EffectSequence
        if not HAS_NEW:
            editor.sequences
    """,
    "a class that is defined behind a guard": """
        if HAS_OLD:
            class Settings:
                kind = bpy.types.EffectSequence
    """,
    "a name of hasattr": """
        has_new = hasattr(old, "strips")
        if not has_new:
            old.sequences
    """,
    "the handler of AttributeError": """
        try:
            strips = editor.strips
        except AttributeError:
            strips = editor.sequences
    """,
    "a constant made of the version": """
        if not NEW:
            editor.sequences
    """,
    "a part of the version": """
        if bpy.app.version[0] < 5:
            editor.sequences
    """,
    "a version and more": """
        if bpy.app.version < (5, 0, 0) and editor.sequences:
            pass
        elif old and bpy.app.version[:2] == (4, 5):
            editor.sequences
    """,
    "a function that answers by the version": """
        if is_new():
            return editor.strips
        return editor.sequences
    """,
    "a function that compares with the version": """
        if compared(5, 0) < 0:
            return editor.sequences
        editor.strips
    """,
    "the list of properties": """
        if "sequences" in bpy.types.SequenceEditor.bl_rna.properties:
            return editor.sequences
        if "strips" not in editor.bl_rna.properties:
            editor.sequences
    """,
    "the list of names": """
        if "Strip" not in dir(bpy.types):
            editor.sequences
    """,
}  # fmt: skip
UNGUARDED = {
    "hasattr of another": """
        if not hasattr(old, "strips"):
            editor.sequences
    """,
    "behind the guard": """
        if not hasattr(old, "strips"):
            pass
        editor.sequences
    """,
    "in the way that is for this Blender": """
        if bpy.app.version[0] >= 5:
            editor.sequences
    """,
    "beside the version": """
        if old and bpy.app.version >= (4, 0, 0):
            pass
        else:
            editor.sequences
    """,
    "where the property is": """
        if "strips" in editor.bl_rna.properties:
            editor.sequences
    """,
    "a name of hasattr that holds something else by then": """
        has_new = hasattr(bpy.types, "EffectSequence")
        has_new = old
        if has_new:
            editor.sequences
    """,
    "behind both ways": """
        if compared(5, 0) < 0:
            pass
        else:
            pass
        editor.sequences
    """,
}  # fmt: skip
AROUND = """
import bpy
NEW = bpy.app.version >= (5, 0, 0)
HAS_OLD = hasattr(bpy.types, "EffectSequence")
HAS_NEW = hasattr(bpy.types, "EffectStrip")

def is_new():
    return bpy.app.version >= (5, 0, 0)

def compared(major, minor):
    if bpy.app.version[0] > major:
        return 1
    return 0 if tuple(bpy.app.version[:2]) == (major, minor) else -1

def read(old):
    editor = bpy.context.scene.sequence_editor
"""


def _found(checker: Checker, lines: str) -> set[str]:
    code = AROUND + indent(dedent(lines), "    ")
    return {finding.symbol for finding in checker.check(code) if finding.severity == "error"}


@pytest.mark.parametrize("guard", GUARDED)
def test_code_for_other_blenders_is_no_finding(rule_checker: Checker, guard: str) -> None:
    assert _found(rule_checker, GUARDED[guard]) == set()


@pytest.mark.parametrize("place", UNGUARDED)
def test_what_no_guard_covers_is_found(rule_checker: Checker, place: str) -> None:
    assert _found(rule_checker, UNGUARDED[place]) == {"bpy.types.SequenceEditor.sequences"}
