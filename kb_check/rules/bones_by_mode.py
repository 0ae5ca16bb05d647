"""An edit bone that is used after Edit Mode was left, or a bone that is looked up before it is.

```python
armature = bpy.data.armatures.new("Rig")
rig = bpy.data.objects.new("Rig", armature)
bpy.context.collection.objects.link(rig)
bpy.context.view_layer.objects.active = rig
bpy.ops.object.mode_set(mode="EDIT")
shin = armature.edit_bones.new("shin")
shin.tail = (0, 0, 1)
rig.pose.bones["shin"]  # reported: there is none before Edit Mode is left
bpy.ops.object.mode_set(mode="OBJECT")
shin.roll = 0.5  # reported: edit bones are gone now; armature.bones["shin"], rig.pose.bones["shin"]
armature.edit_bones.new("foot")  # reported: `mode_set(mode="EDIT")` comes before
```

Blender frees all edit bones when it leaves Edit Mode: what is set is lost, what is read may be anything, and often
Blender ends. They stay gone when Edit Mode is entered again.

Not reported: modes that are entered or left elsewhere than in the statements around the bone (in a condition, a loop, a
function that they call); bones in lists; bones looked up in armatures that these statements do not make; and what
stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.findings import Finding
from kb_check.modes.edit_bones import EDIT_BONE, Bones, edited_outside, names_edit_bones, surely_run
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.syntax.bodies import bodies

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

# What may be asked of an edit bone that is gone: it is of the armature, or of the class.
_KEPT = frozenset({"id_data", "bl_rna", "rna_type", "as_pointer"})


def _check(script: Script) -> Iterator[Finding]:
    for node in edited_outside(script):
        if not is_tried(script, node):
            yield Finding(
                RULE.id, "error", script.span(node.func if isinstance(node, ast.Call) else node),
                "An armature has edit bones only in Edit Mode, in which it surely is not here: "
                "`bpy.ops.object.mode_set(mode='EDIT')` comes before, with the armature's object active.",
                EDIT_BONE,
            )  # fmt: skip
    if not names_edit_bones(script):
        return
    for body in bodies(script):
        bones = Bones(script)
        for statement in body:
            yield from _used(script, statement, bones)
            bones.pass_by(statement)


def _used(script: Script, statement: ast.stmt, bones: Bones) -> Iterator[Finding]:
    for node in surely_run(statement):
        match node:
            case ast.Attribute(value=ast.Name(id=name)) | ast.Subscript(value=ast.Name(id=name)) if (
                name in bones.gone
            ):
                is_kept = isinstance(node, ast.Attribute) and node.attr in _KEPT
                if not is_kept and not is_tried(script, node):
                    bones.gone.discard(name)  # once is enough
                    yield Finding(
                        RULE.id, "error", script.span(node),
                        f"`{name}` is an edit bone of before Edit Mode was left, and those are gone: use it before, or "
                        "get the bone from `.bones` of the armature or of the object's `.pose`.",
                        EDIT_BONE,
                    )  # fmt: skip
            case ast.Subscript(value=collection, slice=key) if bones.is_unmade(node) and not is_tried(
                script, node
            ):
                yield Finding(
                    RULE.id, "error", script.span(node),
                    f"`{ast.unparse(collection)}` has no {ast.unparse(key)} yet: an edit bone becomes a bone when "
                    "Edit Mode is left. `bpy.ops.object.mode_set(mode='OBJECT')` comes before.",
                    EDIT_BONE,
                )  # fmt: skip
            case _:
                pass


RULE = Rule("bones-by-mode", "error", "A bone in a mode in which there is none of its kind", _check)
