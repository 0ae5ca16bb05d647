"""Annotations say what a value should be: nobody checks them, and quoted ones are not even read."""

from __future__ import annotations

from textwrap import dedent
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_NAMES: str = """\
import bpy
def f(a: "bpy.types.NodeSocketInterface", *b: 'bpy.types.Objekt') -> "list[bpy.types.EffectSequence]": pass
x: "bpy.types.NodeSocketInterface" = None
y: bpy.types.NodeSocketInterface = None
def g(a: bpy.types.NodeSocketInterface): pass
def h(): a: bpy.types.NodeSocketInterface = None; h.x: bpy.types.NodeSocketInterface = None
h()
class C: a: bpy.types.NodeSocketInterface = None
def i(): exec("class D:  a: bpy.types.NodeSocketInterface = None")
"""


def test_a_quoted_annotation_is_not_read(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _NAMES.splitlines()
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    assert [one.span.line for one in rule_checker.check(_NAMES)] == refused == [4, 5, 8]


@pytest.mark.parametrize(
    ("quoted", "text"),
    [
        ("'bpy.types.Mesh'", "bpy.types.Mesh"),
        ('"""bpy.types.Mesh"""', "bpy.types.Mesh"),
        ("'list[\"bpy.types.Mesh\"]'", "bpy.types.Mesh"),
        ("('bpy.types'\n   '.Mesh')", "'bpy.types'\n   '.Mesh'"),
    ],
)
def test_what_a_quoted_annotation_says_stands_there(rule_checker: Checker, quoted: str, text: str) -> None:
    read = rule_checker.read(f"import bpy\n\n\ndef f(é: str, a: {quoted}): pass\n")
    script = rule_checker.script(read, rule_checker.package([read]))
    (row,) = [row for row in script.resolutions("attribute") if row.value == "Mesh"]
    assert script.text(script.span(row.node)) == text


_CALLED = """
import bpy
from typing import List, Optional

class Wrapper:
    def own(self):
        return 1

class Described(Wrapper, bpy.types.Operator):
    bl_idname = "object.described"
    bl_label = "Described"

def f(a: {annotation}):
    return {use}

f({given})
"""


def _found(checker: Checker, annotation: str, use: str, given: str) -> int:
    code = dedent(_CALLED).format(annotation=annotation, use=use, given=given)
    return len(checker.check(code, rules=["unknown-attribute"]))


@pytest.mark.parametrize(
    ("annotation", "use", "given"),
    [
        ("bpy.types.Object", "a.own()", "Wrapper()"),
        ("Optional[bpy.types.Object]", "a.own()", "Wrapper()"),
        ("bpy.types.Object", "a.own", "'text'"),
        ("List[bpy.types.Mesh]", "[each.matrix_world for each in a]", "[bpy.context.object]"),
        ("List[bpy.types.Mesh]", "[each.own() for each in a]", "[Wrapper()]"),
        ("tuple[bpy.types.Mesh, int]", "a[0].own()", "(Wrapper(), 1)"),
        ("dict[str, bpy.types.Mesh]", "a['x'].own()", "{'x': Wrapper()}"),
    ],
)
def test_an_annotation_that_callers_contradict_is_doubted(
    rule_checker: Checker, annotation: str, use: str, given: str
) -> None:
    assert _found(rule_checker, annotation, use, given) == 0


@pytest.mark.parametrize(
    ("annotation", "use", "given"),
    [
        ("bpy.types.Object", "a.zorn", "bpy.context.object"),
        ("bpy.types.Object", "a.zorn", "None"),
        ("bpy.types.Object", "a.zorn", "unknown()"),
        ("Optional[bpy.types.Object]", "a.zorn", "bpy.context.object"),
        ("List[bpy.types.Object]", "a[0].zorn", "bpy.context.selected_objects"),
        ("List[bpy.types.Object]", "a[0].zorn", "[bpy.context.object, None]"),
        ("bpy.types.ID", "a.zorn", "bpy.context.object"),
    ],
)
def test_an_annotation_that_callers_keep_to_is_trusted(
    rule_checker: Checker, annotation: str, use: str, given: str
) -> None:
    assert _found(rule_checker, annotation, use, given) == 1


def test_a_float_may_be_an_int(rule_checker: Checker, tmp_path: Path) -> None:
    """As type checkers have it: whoever annotates with ``float`` takes both."""
    code = "import bpy\ndef rate(value: float) -> None:\n    bpy.context.scene.render.fps = value\n"
    assert rule_checker.check(code) == []
    lines = ["import bpy", "bpy.context.scene.render.fps = 24", "bpy.context.scene.render.fps = 24.5"]
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    assert [one.span.line for one in rule_checker.check("\n".join(lines))] == refused == [3]


@pytest.mark.parametrize("annotation", ["trimesh.base.Trimesh", "'trimesh.Trimesh'", "Any"])
def test_what_is_annotated_with_another_librarys_class_is_not_guessed_by_its_name(
    rule_checker: Checker, annotation: str
) -> None:
    code = f"""\
import bpy
import trimesh
from typing import Any


def normals(mesh: {annotation}):
    return mesh.vertex_normals[0].mean(axis=1)
"""
    assert rule_checker.check(code) == []
    (finding,) = rule_checker.check(code.replace(f": {annotation}", ""))
    assert "MeshNormalValue" in finding.message


_CONFUSED = """
import bpy


def look(camera: {annotation}, place):
    {use}
"""


@pytest.mark.parametrize("annotation", ["bpy.types.Camera", "'bpy.types.Camera'", "bpy.types.Camera | None"])
@pytest.mark.parametrize(
    "use", ["camera.matrix_world = place", "return camera.location", "camera.keyframe_insert('location')"]
)
def test_the_object_of_what_is_annotated_as_its_data_is_a_doubt(
    rule_checker: Checker, annotation: str, use: str
) -> None:
    (finding,) = rule_checker.check(_CONFUSED.format(annotation=annotation, use=use))
    assert finding.severity == "warning"
    assert "`camera` is annotated as `bpy.types.Camera`" in finding.message
    assert finding.instead[0].startswith("bpy.types.Object.")


_RETURNED = """
import bpy


def found(camera, *others) -> {annotation}:
    return bpy.data.cameras.get(camera) if isinstance(camera, str) else camera


def look(camera, place):
    camera = found(camera)
    {use}
"""


@pytest.mark.parametrize("use", ["camera.matrix_world = place", "return found(place).location"])
def test_what_a_function_is_annotated_to_return_is_a_doubt(rule_checker: Checker, use: str) -> None:
    code = _RETURNED.format(annotation="bpy.types.Camera", use=use)
    (finding,) = rule_checker.check(code)
    assert finding.severity == "warning"
    assert "`found` is annotated to return `bpy.types.Camera`" in finding.message
    more = code.replace("camera = found(camera)", "camera = bpy.data.cameras[0]").replace(
        "found(place).", "camera."
    )
    (finding,) = rule_checker.check(more)
    assert finding.severity == "error"


def test_items_of_what_is_annotated_as_one_thing_are_a_doubt(rule_checker: Checker) -> None:
    code = "import bpy\ndef join(link: {annotation}):\n    return link[0]['node']\n"
    (finding,) = rule_checker.check(code.format(annotation="bpy.types.NodeLink"))
    assert (finding.rule, finding.severity) == ("not-subscriptable", "warning")
    assert (
        "`link` is annotated as `bpy.types.NodeLink`: the annotation or the use is wrong" in finding.message
    )
    assert not rule_checker.check(code.format(annotation="list"))


@pytest.mark.parametrize(
    ("annotation", "use"),
    [
        ("bpy.types.Object", "return camera.locaton"),  # a misspelling
        ("bpy.types.Camera", "camera.draw_size = 1"),  # a camera had it
        ("bpy.types.Camera", "camera = bpy.data.cameras['a']; return camera.location"),
        ("bpy.types.ID", "return camera.location if isinstance(camera, bpy.types.Camera) else None"),
        ("bpy.types.Object", "return camera.lens"),
    ],
)
def test_what_more_than_the_annotation_tells_is_an_error(
    rule_checker: Checker, annotation: str, use: str
) -> None:
    (finding,) = rule_checker.check(_CONFUSED.format(annotation=annotation, use=use))
    assert finding.severity == "error"


@pytest.mark.parametrize(
    ("annotation", "use"),
    [
        ("bpy.types.Camera", "return camera.zorn"),
        ("bpy.types.Camera", "camera.set_zorn(place)"),
        ("List[bpy.types.Camera]", "for each in camera: each.zorn()"),
        ("list[bpy.types.Camera]", "return [each.matrix_world for each in camera if each.name]"),
        ("List[List[bpy.types.Camera]]", "for some in camera:\n        for each in some: each.zorn()"),
        ("list[bpy.types.Camera]", "return camera[0].zorn"),
        ("bpy.types.Camera", "place.new(camera.zorn)"),
        ("bpy.types.Armature", "bpy.context.object.constraints.new('IK').target = camera"),
        ("bpy.types.Mesh", "bpy.context.collection.objects.link(camera)"),
        ("list[bpy.types.Mesh]", "for each in camera: bpy.context.collection.objects.link(each)"),
    ],
)
def test_what_an_annotation_alone_tells_is_a_doubt(rule_checker: Checker, annotation: str, use: str) -> None:
    code = "from typing import List\n" + _CONFUSED.format(annotation=annotation, use=use)
    (finding,) = rule_checker.check(code)
    assert finding.severity == "warning"
    assert "the annotation or the use is wrong" in finding.message


@pytest.mark.parametrize(
    "use",
    [
        "for camera in bpy.data.cameras: camera.zorn()",
        "camera = bpy.data.cameras[0]; return camera.zorn",
        "camera = bpy.data.cameras[0]; bpy.context.collection.objects.link(camera)",
    ],
)
def test_what_is_given_again_is_no_parameter(rule_checker: Checker, use: str) -> None:
    (finding,) = rule_checker.check(_CONFUSED.format(annotation="bpy.types.Camera", use=use))
    assert finding.severity == "error"


def test_a_member_that_went_from_kinds_of_data_is_told_where_the_kind_is_not_known(
    rule_checker: Checker,
) -> None:
    code = "import bpy\nlight = bpy.data.objects['Light'].data\nlight.use_contact_shadow = True\n"
    (finding,) = rule_checker.check(code)
    assert "Light.use_contact_shadow` does not exist in Blender 5.1: removed in 4.3" in finding.message
    (finding,) = rule_checker.check(code.replace("use_contact_shadow", "zorn"))
    assert "`bpy.types.ID` has no `zorn`" in finding.message
