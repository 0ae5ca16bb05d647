"""What Blender says to scripts, and how findings are compared with it."""

from __future__ import annotations

import pytest

from kb_check.findings import Edit, Finding, Span
from kb_check.text.edits import Text
from measurements.check_truth import Counts, judge
from measurements.scripts.truth import Truth, read_truth, run, scripts

SCRIPT = """\
import bpy
ob = bpy.context.object
ob.draw_type = 'WIRE'
def f(thing):
    thing.nowhere = 1
    return thing.name
f(ob)
bpy.ops.mesh.primitive_cube_add(radius=2)
bpy.data.objects["Nobody"].hide_render = True
print(nobody.name)
late = bpy.context.nothing_of_the_kind
late.name
if bpy.app.background is None:
    ob.never_executed = 1
"""


def finding(line: int) -> Finding:
    return Finding("unknown-attribute", "error", Span(line, 0, line, 1), "wrong")


@pytest.mark.blender
def test_a_script_tells_every_error_and_goes_on() -> None:
    truth = run(SCRIPT, "one")
    assert truth.ended
    assert {(error.line, error.kind) for error in truth.errors} == {
        (3, "api"), (5, "api"), (8, "api"), (9, "run"), (10, "consequence"), (11, "api"), (12, "consequence"),
    }  # fmt: skip
    assert {6, 7} <= set(truth.ran)
    assert 14 not in truth.ran

    counts = Counts()
    judge(counts, "one", SCRIPT, [finding(line) for line in (3, 5, 6, 14)], truth)
    assert (counts.errors, counts.found, counts.right, counts.unjudged) == (4, 2, 2, 1)
    assert len(counts.wrong) == 1
    assert len(counts.missed) == 2


def test_edits_are_made_from_the_end() -> None:
    edits = [Edit(Span(1, 0, 1, 1), "long"), Edit(Span(1, 4, 1, 5), "b"), Edit(Span(2, 0, 2, 3), "")]
    assert Text.original("x = y\nold()\n").edited(edits).code == "long = b\n()\n"


def test_every_script_has_its_truth() -> None:
    truths = read_truth()
    assert {path.parent.name + "/" + path.name for path in scripts()} == set(truths)
    assert all(isinstance(truth, Truth) and (truth.ran or truth.errors) for truth in truths.values())
