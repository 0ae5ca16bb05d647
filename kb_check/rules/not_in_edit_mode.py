"""Bones that are made, or removed, in a new armature by a script that never enters edit mode.

An armature has ``edit_bones`` to change only while its object is in edit mode.

```python
armature = bpy.data.armatures.new("Armature")


def add_bone(name):
    armature.edit_bones.new(name)  # noted: bpy.ops.object.mode_set(mode='EDIT') comes before
```

Where the statements around make it certain, bones-by-mode finds it.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_check.calls.resolved import callee_path
from kb_check.findings import Finding
from kb_check.modes.edit_bones import CHANGING, edited_outside
from kb_check.rule import Rule
from kb_check.running.out_of_sight import knows_all
from kb_check.scene.made_here import is_new
from kb_check.syntax.words import named_words

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_ENTERING = re.compile(r"mode_set|mode_toggle|editmode")


def _check(script: Script) -> Iterator[Finding]:
    if not knows_all(script) or any(map(_ENTERING.search, named_words(script))):
        return
    for node in script.all(ast.Call):
        match node:
            case ast.Call(func=ast.Attribute(value=ast.Attribute(attr="edit_bones", value=armature))):
                if (
                    callee_path(script, node) in CHANGING
                    and is_new(script, armature)
                    and node not in edited_outside(script)
                ):
                    yield Finding(
                        RULE.id, "note", script.span(node.func),
                        "An armature has bones to edit only in edit mode, which this script never enters: "
                        "`bpy.ops.object.mode_set(mode='EDIT')` does, with the armature's object active.",
                        callee_path(script, node),
                    )  # fmt: skip
            case _:
                pass


RULE = Rule("not-in-edit-mode", "note", "Bones that are edited outside of edit mode", _check)
