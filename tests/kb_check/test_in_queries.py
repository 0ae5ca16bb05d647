"""What answers say of the code in a query, beyond its names."""

from __future__ import annotations

import ast
import random
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from whole import examples

from kb_check.in_queries import notes_on_code

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase


@pytest.mark.parametrize(
    ("query", "told"),
    [
        ("obj.scale = 2", "`bpy.types.Object.scale` takes 3 floats, not the single number 2."),
        ("obj.location = (1, 2)", "`bpy.types.Object.location` takes 3 floats, not 2 items."),
        ("cam.data.lens = 'wide'", "`bpy.types.Camera.lens` takes a number, not 'wide'."),
        ("r = bmesh.ops.create_cube(bm, size=1)\nr['faces']", "gives `verts`, and no 'faces'."),
        ("obj.modifiers.new('Subdivision')", "also needs `type`"),
        ("me.from_pydata(verts, edges)", "also needs `faces`"),
        ("scene.collection.objects.link('Cube')", "takes an instance of `bpy.types.Object`, not a str."),
        ("obj.data.materials.append('Mat')", "takes an instance of `bpy.types.Material`, not a str."),
        ("blf.size(0, 20, 72)", "takes 2 arguments by place"),
        ("pb.rotation_euler = (0, 0)", "`bpy.types.PoseBone.rotation_euler` takes 3 floats"),
        ("nodes.new('ShaderNodeGlass')", "Closest: `ShaderNodeBsdfGlass`."),
        ("bpy.ops.object.mode_set(mode='EDIT_GPENCIL')", "write 'EDIT'."),
        ("bpy.context.mode == 'EDIT_GPENCIL'", "'EDIT_GREASE_PENCIL' has its label."),
        ("if obj.mode == 'EDIT_GPENCIL':", "the comparison never matches it."),
        ("Euler((1, 2, 3)).to_matrix() @ obj.matrix_world", "3 × 3 does not fit a matrix of 4 × 4."),
        # One class alone has such items, whatever the variable is called.
        ("sim_out.state_items.new('COLOR', 'x')", "'COLOR' is not a value of"),
        ("output.repeat_items.new('GEOMETRYS', 'x')", "Closest: `GEOMETRY`."),
        ("bpy.ops.object.constraint_add(type='COPY_POS')", "is no value of"),
        ("kd.find_n((0, 0, 0))", "also needs `n`"),
        ("v = Vector((1, 0, 0))\nobj.location = v.length", "takes 3 floats, not a float."),
        ("class P(bpy.types.PropertyGroup):\n    size = FloatProperty()", "Write `size: FloatProperty()`."),
        ("Is this right?\nobj.scale = 2", "takes 3 floats, not the single number 2."),
        ("obj.scale = 2\nWhy does that fail?", "takes 3 floats, not the single number 2."),
        ("why does `obj.scale = 2` fail", "takes 3 floats, not the single number 2."),
        ("What is wrong?\n```python\nobj.scale = 2\n```", "takes 3 floats, not the single number 2."),
    ],
)
def test_what_blender_refuses_of_code_is_told(query: str, told: str, kb: KnowledgeBase) -> None:
    (note,) = notes_on_code(kb.reader, query)
    assert told in note
    answer = kb.query(query)
    assert told in answer.notes[0]
    assert answer.text.startswith(f"> {answer.notes[0]}")


@pytest.mark.parametrize(
    ("line", "message", "told"),
    [
        ("obj.scale = 2", "TypeError: sequence expected at dimension 1, not 'int'", "takes 3 floats"),
        (
            "vg.add(0, 1.0, 'REPLACE')",
            "TypeError: VertexGroup.add(): sequence expected",
            "a sequence of ints",
        ),
    ],
)
def test_the_line_that_failed_is_taken_from_a_traceback(
    line: str, message: str, told: str, kb: KnowledgeBase
) -> None:
    frames = f'  File "/a.py", line 3, in <module>\n    f(1)\n  File "/a b.py", line 7, in f\n    {line}\n    ^^^^^'
    notes = kb.query(f"Traceback (most recent call last):\n{frames}\n{message}").notes
    assert notes[0].startswith(f"`{line}`: ")
    assert told in notes[0]


def test_a_sure_fix_is_written_out(kb: KnowledgeBase) -> None:
    (note,) = notes_on_code(kb.reader, "mat.diffuse_color = (1, 0, 0)")
    assert note.endswith("Write `mat.diffuse_color = (1, 0, 0, 1.0)`.")


def test_what_is_gone_comes_before_what_is_wrong_behind_it(kb: KnowledgeBase) -> None:
    """A line written out without it would fail the same way."""
    query = 'me.uv_textures.new("Old")'
    assert notes_on_code(kb.reader, query) == ()
    assert kb.query(query).notes[0].startswith("`bpy.types.Mesh.uv_textures` does not exist")


@pytest.mark.parametrize(
    "query",
    [
        "cloth",
        "set the size of a cube (in metres)",
        "what does scale = 2 mean?",
        "obj.scale = (2, 2, 2)",
        "obj.data.lens",
        "ob.matrix_world = mat",  # a value's name tells nothing
        "light.color = (1, 1, 1, 1)",  # an object has four, a light three
        "cam.lens = 'wide'",  # of the name, answers tell
        "obj.keyframe_insert('rotation')",
        "bpy.ops.mesh.subdivide()",
        "obj.type == 'MESH'",
        "data = np.empty(3)",  # a word that only one class has tells none
        "Menu.draw_preset(self, context)",  # a class's own name is no instance of it
        "nodes.new('MyAddonNode')",
        "node.inputs.new('MyAddonSocket', 'x')",
        "def scale(obj):\n    obj.scale = 2",  # whatever it is called with
        "obj.location.x = 1; obj[",
        "x = " + "(" * 5_000,
    ],
)
def test_nothing_is_said_of_words_of_right_code_and_of_what_is_not_sure(
    query: str, kb: KnowledgeBase
) -> None:
    assert notes_on_code(kb.reader, query) == ()


def test_what_answers_say_anyway_is_not_said_twice(kb: KnowledgeBase) -> None:
    text = kb.query("blf.size(0, 20, 72)").text
    assert text.count("takes 2 arguments by place") == 1


@pytest.mark.parametrize(
    "query",
    [
        "obj.display_type = 'WIREFRAME'",
        "obj.modifiers.new('c', 'CLOTHS')",
        "scene.render.engine = 'BLENDER_RENDER'",
    ],
)
def test_a_value_that_is_none_is_told_once(query: str, kb: KnowledgeBase) -> None:
    assert len(kb.query(query).notes) == 1


def test_few_of_many_are_told(kb: KnowledgeBase) -> None:
    notes = notes_on_code(kb.reader, "\n".join(f"obj.scale = {number}" for number in range(9)))
    assert len(notes) == 5
    assert notes[-1] == "5 more: `blender_check` lists them."


def test_statements_of_blenders_own_scripts_are_left_alone(kb: KnowledgeBase) -> None:
    import bpy

    folder = Path(bpy.utils.system_resource("SCRIPTS"))
    statements = sorted(
        {
            text
            for file in sorted(folder.rglob("*.py"))
            for node in ast.walk(ast.parse(file.read_text()))
            if isinstance(node, ast.Assign | ast.AugAssign | ast.Return | ast.Expr)
            if len(text := ast.unparse(node)) < 250
        }
    )
    chosen = random.Random(5).sample(statements, examples(4_000))
    assert [(text, notes) for text in chosen if (notes := notes_on_code(kb.reader, text))] == []


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ('layout.prop(context.object, "locaton")', "Closest: `location`."),
        ('layout.operator("object.delet")', "Closest: `object`, `object.delete`."),
        ("class A(bpy.types.Panel):\n    bl_region_type = 'SIDEBAR'", "'SIDEBAR' is not a value of"),
        ("class A(bpy.types.Operator):\n    bl_options = {'UNDO_PUSH'}", "'UNDO_PUSH' is not a value of"),
    ],
)
def test_misspelt_texts_and_values_of_class_attributes_are_told(
    kb: KnowledgeBase, code: str, told: str
) -> None:
    assert any(told in note for note in kb.query(code).notes)


@pytest.mark.parametrize(
    "code",
    [
        "layout.prop(context.scene, 'my_prop')",
        "layout.operator('object.my_thing')",
        "layout.operator('my.thing')",
    ],
)
def test_what_an_add_on_may_register_is_not_denied(kb: KnowledgeBase, code: str) -> None:
    assert kb.query(code).notes == ()


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("ob.select = True", "`bpy.types.Object.select` does not exist"),
        ("context.scene.objects.link(ob)", "`bpy.types.SceneObjects.link` does not exist"),
        ('bpy.ops.object.lamp_add(type="SUN")', "`bpy.ops.object.lamp_add` does not exist"),
        ("bpy.app.timers.register(f, interval=1)", "takes no `interval`"),
        ("mesh.calc_normals()", "`bpy.types.Mesh.calc_normals` does not exist"),
    ],
)
@pytest.mark.parametrize("before", [0, 5, 20])
def test_what_is_gone_is_told_at_any_length(kb: KnowledgeBase, line: str, told: str, before: int) -> None:
    code = "\n".join([*(f"value_{number} = compute({number})" for number in range(before)), line])
    notes = [note for note in kb.query(code).notes if told in note]
    assert len(notes) == 1
