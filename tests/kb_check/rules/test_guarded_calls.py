"""Functions that only another Blender's branch calls are no findings; what else may come to them, is."""

from __future__ import annotations

from textwrap import dedent
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_check.checker import Checker

_OLD = """
import bpy

def old_copy(editor):
    return editor.sequences

"""
_ONLY_FOR_OTHERS = {
    "in the branch": """
        if bpy.app.version < (4, 0):
            old_copy(bpy.context.scene.sequence_editor)
    """,
    "in the other branch": """
        def copy(editor):
            if bpy.app.version >= (4, 0):
                return editor.strips
            else:
                return old_copy(editor)
    """,
    "behind the way out": """
        def copy(editor):
            if bpy.app.version >= (4, 0):
                return editor.strips
            return old_copy(editor)
    """,
    "as a choice": """
        strips = bpy.data if bpy.app.version >= (4, 0) else old_copy(bpy.context.scene.sequence_editor)
    """,
    "as a side": """
        strips = bpy.app.version < (4, 0) and old_copy(bpy.context.scene.sequence_editor)
    """,
    "as a value": """
        copy = old_copy if bpy.app.version < (4, 0) else print
    """,
    "through one more": """
        def older(editor):
            old_copy(editor)

        if bpy.app.version < (4, 0):
            older(bpy.context.scene.sequence_editor)
    """,
    "through a method": """
        class Copier:
            def older(self, editor):
                old_copy(editor)

            def copy(self, editor):
                return self.older(editor) if bpy.app.version < (4, 0) else editor.strips
    """,
    "behind a function that answers by the version": """
        def is_new():
            return bpy.app.version >= (4, 0)

        def copy(editor):
            return editor.strips if is_new() else old_copy(editor)
    """,
    "behind a flag": """
        NEW = bpy.app.version >= (4, 0)
        if not NEW:
            old_copy(bpy.context.scene.sequence_editor)
    """,
    "and by itself": """
        def older(editor):
            old_copy(editor)
            older(editor)

        if bpy.app.version < (4, 0):
            older(bpy.context.scene.sequence_editor)
    """,
}  # fmt: skip
_FOR_THIS_ONE = {
    "no use": "",
    "also in the open": """
        if bpy.app.version < (4, 0):
            old_copy(bpy.context.scene.sequence_editor)
        old_copy(bpy.context.scene.sequence_editor)
    """,
    "also by its text": """
        if bpy.app.version < (4, 0):
            old_copy(bpy.context.scene.sequence_editor)
        getattr(bpy, "old_copy")
    """,
    "in the branch for this one": """
        if bpy.app.version >= (4, 0):
            old_copy(bpy.context.scene.sequence_editor)
    """,
    "behind another condition": """
        if bpy.app.background:
            old_copy(bpy.context.scene.sequence_editor)
    """,
    "through one that is called in the open": """
        def older(editor):
            old_copy(editor)

        if bpy.app.version < (4, 0):
            older(bpy.context.scene.sequence_editor)
        older(bpy.context.scene.sequence_editor)
    """,
    "through a method that Blender calls": """
        class Copier(bpy.types.Operator):
            bl_idname = "object.copier"
            bl_label = "Copy"

            def execute(self, context):
                old_copy(context.scene.sequence_editor)
                return {'FINISHED'}

        if bpy.app.version < (4, 0):
            Copier.execute(None, bpy.context)
        bpy.utils.register_class(Copier)
    """,
    "behind a plain way out": """
        def copy(editor):
            return editor.strips
            old_copy(editor)
    """,
}  # fmt: skip


def _found(checker: Checker, lines: str) -> set[str]:
    return {
        one.symbol
        for one in checker.check(
            _OLD.replace("(editor)", "(editor: bpy.types.SequenceEditor)", 1) + dedent(lines)
        )
    }


@pytest.mark.parametrize("place", _ONLY_FOR_OTHERS)
def test_what_only_another_blender_calls_is_no_finding(rule_checker: Checker, place: str) -> None:
    assert _found(rule_checker, _ONLY_FOR_OTHERS[place]) == set()


@pytest.mark.parametrize("place", _FOR_THIS_ONE)
def test_what_may_be_called_in_this_one_is_found(rule_checker: Checker, place: str) -> None:
    assert _found(rule_checker, _FOR_THIS_ONE[place]) == {"bpy.types.SequenceEditor.sequences"}


def test_a_use_in_another_file_counts(rule_checker: Checker) -> None:
    old = "def old_copy(editor: 'bpy.types.SequenceEditor'):\n    return editor.sequences\n"
    files = {"addon/__init__.py": "", "addon/old.py": f"import bpy\n\n{old}"}
    guarded = "if bpy.app.version < (4, 0):\n    old.old_copy(bpy.context.scene.sequence_editor)\n"
    plain = "old.old_copy(bpy.context.scene.sequence_editor)\n"
    for use, count in ((guarded, 0), (guarded + plain, 1)):
        files["addon/main.py"] = f"import bpy\nfrom . import old\n\n{use}"
        reads = rule_checker.read_files(files)
        package = rule_checker.package(reads.values())
        assert len(rule_checker.check(reads["addon/old.py"], package)) == count


def test_a_function_that_only_it_uses_itself_is_not_used_by_others(rule_checker: Checker) -> None:
    code = """
        def again(editor):
            if bpy.app.version < (4, 0):
                again(editor)
            old_copy(editor)
    """
    assert _found(rule_checker, code) == {"bpy.types.SequenceEditor.sequences"}
