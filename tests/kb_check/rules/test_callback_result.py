"""Results are reported that Blender refuses, and no others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from classes_in_blender import found_parts, parts_of, refused_parts

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_OPERATOR = """\
class X(Operator):
    bl_idname = "test._x_"
    bl_label = "label"
    def execute(self, context):
        """
_BODIES = """\
pass

return

return None

return "FINISHED"

return {"FINISHED"}

return {"DONE"}

return {"FINISHED", "PASS_THROUGH"}

return {}

return set()

return ["FINISHED"]

return ("FINISHED",)

return frozenset({"FINISHED"})

return True

return 1 == 1

return context.window_manager.modal_handler_add(self)

return {"FINISHED"} if context else None

return {"FINISHED"} if context else {"CANCELLED"}

yield {"FINISHED"}

self.report({"INFO"}, "done")

if context:
    return {"FINISHED"}

if context:
    return {"FINISHED"}
self.report({"INFO"}, "done")

for number in range(3):
    self.number = number

while True:
    return {"CANCELLED"}

try:
    return {"FINISHED"}
finally:
    self.report({"INFO"}, "done")

def inner():
    return None
return {"FINISHED"}
"""


def test_what_is_refused_is_reported_and_nothing_else(check: Check, tmp_path: Path) -> None:
    bodies = _BODIES.strip().split("\n\n")
    parts = parts_of("\n\n".join(_OPERATOR + body.replace("\n", "\n        ") for body in bodies))
    refused = refused_parts(tmp_path, parts, "bpy.ops.test._x_()")
    # What only some paths have wrong is reported although the one that is taken here is right.
    sometimes = {
        part for part in parts if "else None" in part or ("}\n        self" in part and "if context" in part)
    }
    assert found_parts(check, "callback-result", parts) == refused | sometimes
    assert len(refused) > 10


@pytest.mark.parametrize(
    ("body", "is_found"),
    [
        ("return None", True),
        ("pass", True),
        ("return", True),
        ("return context.object", False),
        ("raise NotImplementedError", False),
    ],
)
def test_a_poll_without_a_value_is_a_warning(check: Check, body: str, is_found: bool) -> None:
    poll = f"    @classmethod\n    def poll(cls, context):\n        {body}\n"
    found = check("callback-result", f"import bpy\nclass Grow(bpy.types.Operator):\n{poll}")
    assert [finding.severity for finding in found] == ["warning"] * is_found


@pytest.mark.parametrize(
    "code",
    [
        "class Base(bpy.types.Operator):\n    def execute(self, context):\n        pass\n",
        'class Grow(bpy.types.Operator):\n    bl_idname = "test.grow"\n    bl_label = ""\n'
        "    def execute(self, context):\n        sys.exit(0)\n",
        'class Grow(bpy.types.Operator):\n    bl_idname = "test.grow"\n    bl_label = ""\n'
        "    def execute(self, context):\n        self.number = 1\n"
        '    def invoke(self, context, event):\n        self.execute(context)\n        return {"FINISHED"}\n',
    ],
)
def test_functions_that_blender_may_not_call_are_left_alone(check: Check, code: str) -> None:
    assert not check("callback-result", f"import bpy, sys\n{code}")
