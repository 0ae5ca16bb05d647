"""Docstrings as Blender writes them: markup becomes meaning, and nothing that was said is lost."""

from __future__ import annotations

import json
import re
from textwrap import indent
from typing import TYPE_CHECKING

import pytest

from kb_build.blender.docstrings.calls import call_parameters
from kb_build.blender.docstrings.docstring import parse_docstring
from kb_build.symbols.records import Parameter

if TYPE_CHECKING:
    from pathlib import Path

FULL = """.. method:: lerp(other, factor=0.5)

Returns the interpolation of two :class:`Vector`\\ s.

:arg other: value to
   interpolate with.
:type other: :class:`Vector` | Sequence[float]
:arg factor: The *interpolation* value in [0.0, 1.0].
:type factor: float
:return: The interpolated vector.
:rtype: :class:`Vector`
"""


def test_a_full_docstring_is_taken_apart() -> None:
    parsed = parse_docstring(FULL)
    assert parsed.signature == "lerp(other, factor=0.5)"
    assert parsed.description == "Returns the interpolation of two `Vector`s."
    assert parsed.parameters == (
        Parameter("other", "Vector | Sequence[float]", "value to interpolate with.", required=True),
        Parameter("factor", "float", "The interpolation value in [0.0, 1.0].", default=0.5),
    )
    assert parsed.returns == (Parameter("", "Vector", "The interpolated vector."),)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ""),
        ("Plain.", "Plain."),
        ("Two\nlines.", "Two lines."),
        ("One.\n\nTwo.", "One.\n\nTwo."),
        (
            "See :func:`~bpy.utils.register_class` and :meth:`x <Y.x>`.",
            "See `bpy.utils.register_class` and `x`.",
        ),
        (
            "To :ref:`types-custom_properties`, :ref:`built-in-shaders`, :ref:`these <some-label>`, :ref:`rna_enum_x`.",
            "To custom properties, built in shaders, these, `rna_enum_x`.",
        ),
        ("``code`` and *emphasis* and **strong**", "`code` and emphasis and strong"),
        ("* one\n* two", "- one\n- two"),
        ("term\n   what it is", "**term**: what it is"),
        (".. note:: Take care.", "**Note:** Take care."),
        (".. warning::\n\n   Take care.", "**Warning:** Take care."),
        ("Like so::\n\n   x = 1\n   y = 2", "Like so:\n\n```python\nx = 1\ny = 2\n```"),
        (".. code-block:: python\n\n   x = 1", "```python\nx = 1\n```"),
        (">>> f(1)\n2", "```python\n>>> f(1)\n2\n```"),
        ("=== ===\nA   B\n=== ===\nC   D\n=== ===", "A | B\nC | D"),
        ("Before.\n\n.. include:: include__bmesh.rst\n\nAfter.", "Before.\n\nAfter."),
    ],
)
def test_markup_becomes_markdown(text: str, expected: str) -> None:
    assert parse_docstring(text).description == expected


@pytest.mark.parametrize(
    "text",
    ["*unclosed emphasis", "``unclosed", ":class:`unclosed", "|missing|", "a_ dangling_", ":unknown:`role`",
     ".. unknown:: directive words", ".. unknown::\n\n   its content",
     "Title\n==\nbody", "  indented\nthen not", "* a\n  * b\n c", ":type x:",
     ".. include:: /etc/passwd", ".. raw:: html\n\n   <b>raw words</b>", ":arg:", "\x00nul", "`x", "a" * 5_000],
)  # fmt: skip
def test_malformed_markup_loses_no_word_and_raises_nothing(text: str) -> None:
    parsed = parse_docstring(text)
    said = " ".join(
        [parsed.description, parsed.type, *(f"{p.name} {p.type} {p.description}" for p in parsed.parameters)]
    )
    assert "root:" not in said
    for word in re.findall(r"[A-Za-z]{3,}", text):
        if word not in {"class", "arg", "type"}:
            assert word in said, word


def test_a_directive_in_the_docstring_wins_over_inspection() -> None:
    assert parse_docstring(".. function:: f(a, b=2)\n\n   Text.", "(*args)").signature == "f(a, b=2)"
    assert parse_docstring("Text.", "(a, b=2)").signature == "(a, b=2)"


@pytest.mark.parametrize("keyword", ["arg", "param", "parameter", "argument", "key", "keyword"])
def test_every_usual_word_for_an_argument_is_understood(keyword: str) -> None:
    parsed = parse_docstring(f"Text.\n\n:{keyword} int size: How big.")
    assert parsed.parameters == (Parameter("size", "int", "How big."),)


def test_fields_in_any_order_and_a_star_before_the_name() -> None:
    text = ".. function:: f(a, *, b=None, **more)\n\n:type b: str\n:arg more: Rest.\n:arg b: The b.\n:arg a: The a."
    assert parse_docstring(text).parameters == (
        Parameter("a", "", "The a.", required=True),
        Parameter("b", "str", "The b.", required=False),
        Parameter("more", "", "Rest."),
    )


def test_an_attribute_says_its_type() -> None:
    assert parse_docstring("The length.\n\n:type: float").type == "float"
    assert parse_docstring("The length.\n\n:rtype: float").type == "float"
    parsed = parse_docstring(".. function:: f()\n\n:rtype: float")
    assert (parsed.type, parsed.returns) == ("", (Parameter("", "float"),))


def test_other_fields_are_kept_as_text() -> None:
    assert "ValueError" in parse_docstring("Text.\n\n:raises ValueError: When empty.").description


def test_a_bmesh_operator_tells_its_slots() -> None:
    text = (
        "BMeshOpFunc bmesh.ops.create_cube(bmesh, size=0, matrix=Matrix(), calc_uvs=False)"
        "\n\nCreates a cube.\n\n-> dict(verts=[], geom_cut=[], vert_map={})"
    )
    parsed = parse_docstring(text)
    assert parsed.signature == "bmesh.ops.create_cube(bmesh, /, *, size=0, matrix=Matrix(), calc_uvs=False)"
    assert [parameter.name for parameter in parsed.parameters][:2] == ["bmesh", "size"]
    assert [(result.name, result.type, result.default) for result in parsed.returns] == [
        ("verts", "list[BMVert]", None),
        ("geom_cut", "list[BMVert | BMEdge | BMFace]", None),
        ("vert_map", "dict", None),
    ]


def test_a_bmesh_operator_without_keywords_still_takes_the_mesh_by_position() -> None:
    parsed = parse_docstring("BMeshOpFunc bmesh.ops.x(bmesh)\n  -> dict()")
    assert (parsed.signature, parsed.returns) == ("bmesh.ops.x(bmesh, /)", ())


@pytest.mark.parametrize(
    ("kind", "words", "expected_type", "values"),
    [
        ("Literal['A', 'B']", "", "enum", ["A", "B"]),
        ("set[Literal['A', 'B']] | None", "", "set[enum] | None", ["A", "B"]),
        ("Literal['A'] | Literal['B']", "", "Literal['A'] | Literal['B']", []),
        ("Literal[0, 1]", "", "Literal[0, 1]", []),
        ("Literal[A]", "", "Literal[A]", []),
        ("str", "string in ['B', 'A'].", "str", ["B", "A"]),
        ("enum in {'X', 'Y'}", "", "enum in {'X', 'Y'}", ["X", "Y"]),
        ("float", "A value in [0.0, 1.0].", "float", []),
        ("str", "string in [a, b]", "str", []),
        ("str", "Either 'A' or 'B'.", "str", []),
    ],
)  # fmt: skip
def test_listed_strings_are_the_values_of_an_argument(
    kind: str, words: str, expected_type: str, values: list[str]
) -> None:
    (parameter,) = parse_docstring(f".. function:: f(a)\n\n   :arg a: {words}\n   :type a: {kind}").parameters
    assert (parameter.type, [item.identifier for item in parameter.enum_items]) == (expected_type, values)


def test_the_values_of_a_result_are_listed() -> None:
    (result,) = parse_docstring(".. function:: f()\n\n   :rtype: Literal['A', 'B']").returns
    assert (result.type, [item.identifier for item in result.enum_items]) == ("enum", ["A", "B"])


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        (":arg a: A.\n:type x: int\n:arg b: B.", [("a", "int"), ("b", "")]),
        (":arg a: A.\n:type a: int\n:arg b: B.\n:type a: str", [("a", "int"), ("b", "str")]),
        (":type x: int\n:arg a: A.", [("a", ""), ("b", "")]),
        (":type b: int\n:type a: str", [("a", "str"), ("b", "int")]),
        (":arg c: C.\n:type c: int", [("a", ""), ("b", ""), ("c", "int")]),
        (":arg a: A.\n:arg c: C.\n:type c: int", [("a", ""), ("b", "int")]),
    ],
)
def test_a_type_under_a_wrong_name_makes_no_argument(fields: str, expected: list[tuple[str, str]]) -> None:
    parsed = parse_docstring(f".. function:: f(a, b)\n\n{fields}")
    assert [(parameter.name, parameter.type) for parameter in parsed.parameters] == expected


def test_a_type_counts_where_the_call_takes_any_keyword() -> None:
    parsed = parse_docstring(".. function:: f(**more)\n\n:type size: int")
    assert [(parameter.name, parameter.type) for parameter in parsed.parameters] == [
        ("more", ""),
        ("size", "int"),
    ]


def test_fields_that_are_indented_too_far_count() -> None:
    text = ".. function:: f(a)\n\n   Text.\n\n   :arg a: The a.\n   :type a: int\n   :rtype: str\n\n.. note:: After."
    parsed = parse_docstring(text)
    assert parsed.parameters == (Parameter("a", "int", "The a.", required=True),)
    assert parsed.returns == (Parameter("", "str"),)
    assert "Text." in parsed.description


def test_overloads_and_continued_lines_of_a_function() -> None:
    text = ".. function:: f(a)\n              f(a, \\\n                b=2)\n\n   Text."
    parsed = parse_docstring(text.replace("\\\n                ", ""))
    assert (parsed.signature, parsed.description) == ("f(a, b=2)", "Text.\n\nAlso `f(a)`.")
    parsed = parse_docstring(".. function:: f(a, \\\n      b=2)\n\n   Text.")
    assert (parsed.signature, parsed.description) == ("f(a, b=2)", "Text.")


@pytest.mark.parametrize(
    ("signature", "types", "result"),
    [
        ("(a: int, b: 'Vector' = None) -> 'Matrix'", ["int", "Vector"], "Matrix"),
        ("(a: bpy.types.Action | None) -> None", ["bpy.types.Action | None"], None),
        ("(a) -> <class 'x'>", [""], None),
    ],
)
def test_annotations_give_types(signature: str, types: list[str], result: str | None) -> None:
    parsed = parse_docstring("Text.", signature)
    assert [parameter.type for parameter in parsed.parameters] == types
    assert [returned.type for returned in parsed.returns] == ([result] if result else [])


def test_fields_within_an_argument_are_a_list() -> None:
    text = ".. function:: f(a)\n\n:arg a: One of:\n\n   :b: The first\n      one.\n   :c: The last."
    (parameter,) = parse_docstring(text).parameters
    assert parameter.description == "One of:\n\n- **b**: The first one.\n- **c**: The last."


def test_an_argument_that_is_said_to_be_optional_is_not_required() -> None:
    parsed = parse_docstring(
        ".. function:: f(a, b, c, /)\n\n:arg a: What.\n:arg b: How (optional when a is 2).\n:arg c: Optional."
    )
    assert [parameter.required for parameter in parsed.parameters] == [True, False, False]


def test_a_described_result_wins_over_the_annotation() -> None:
    assert parse_docstring("Text.\n\n:rtype: float", "() -> int").returns == (Parameter("", "float"),)


@pytest.mark.parametrize(
    ("signature", "names"),
    [
        ("f(a, b=1)", ["a", "b"]), ("(self, a)", ["a"]), ("f(a, /, b, *, c=2)", ["a", "b", "c"]),
        ("f(*args, **kw)", ["args", "kw"]), ("f() -> dict(a=1)", []), ("f(a: int = 3) -> str", ["a"]),
        ("no call", []), ("f(a, [b])", []), ("f(a=<object>)", []), ("f(", []), ("", []), ("f(a=1, b)", []),
    ],
)  # fmt: skip
def test_the_arguments_of_a_call_are_read_where_it_is_python(signature: str, names: list[str]) -> None:
    assert [parameter.name for parameter in call_parameters(signature)] == names


def test_literal_defaults_are_values_and_others_are_left_to_the_signature() -> None:
    found = {p.name: p for p in call_parameters("f(a, b=(1, 2.5), c='x', d=None, e=Matrix(), g=-1)")}
    assert found["a"].required
    assert not any(found[name].required for name in "bcdeg")
    assert [found[name].default for name in "bcdeg"] == [[1, 2.5], "x", None, None, -1]


CLASS = """Class that smooths.

.. method:: __init__(a=1, \\
      b=2.5)
            __init__(other)

   Builds one.

   :arg a: The a.
   :type a: int

.. classmethod:: shade(stroke)

   Smooths the stroke.

   :arg stroke: A stroke.
   :type stroke: :class:`x.Stroke`
   :return: Whether it did.
   :rtype: bool

.. attribute:: size

   How big.

   :type: float

After all.
"""


def test_methods_within_the_docstring_of_a_class_are_members_of_it() -> None:
    parsed = parse_docstring(CLASS)
    assert parsed.description == "Class that smooths.\n\nAfter all."
    assert [(member.kind, member.name) for member in parsed.members] == [
        ("method", "__init__"),
        ("classmethod", "shade"),
        ("attribute", "size"),
    ]
    made, shade, size = (member.docstring for member in parsed.members)
    assert made.signature == "__init__(a=1, b=2.5)"
    assert made.description == "Builds one.\n\nAlso `__init__(other)`."
    assert (made.parameters[0].type, made.parameters[0].default, made.parameters[1].default) == (
        "int",
        1,
        2.5,
    )
    assert shade.description == "Smooths the stroke."
    assert (shade.parameters[0].type, shade.returns[0].type) == ("x.Stroke", "bool")
    assert (size.type, size.description) == ("float", "How big.")


def test_a_class_is_called_as_its_constructor_is() -> None:
    parsed = parse_docstring(CLASS)
    assert parsed.signature == "__init__(a=1, b=2.5)"
    assert [parameter.name for parameter in parsed.parameters] == ["a", "b"]
    assert parse_docstring(".. class:: Vector(seq)\n\n" + CLASS).signature == "Vector(seq)"
    named_alone = ".. class:: Thing\n\n" + indent(CLASS, "   ")
    assert parse_docstring(named_alone).signature == "__init__(a=1, b=2.5)"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (".. seealso:: `Determinant <https://x.org/D>`__ on X.", "**See also:** Determinant on X."),
        (".. seealso::\n\n   :class:`Y`", "**See also:** `Y`"),
        (".. versionadded:: 4.2", "**Added in:** 4.2"),
        (".. deprecated:: 5.0\n   Use more.", "**Deprecated since:** 5.0 Use more."),
        (
            "Plain.\n\n.. note::\n   Inside.\n\n   .. seealso:: That.",
            "Plain.\n\n**Note:** Inside.\n\n**See also:** That.",
        ),
    ],
)
def test_remarks_that_only_sphinx_knows_are_kept(text: str, expected: str) -> None:
    assert parse_docstring(text).description == expected


MARKUP = re.compile(
    r":ref:`[^`]*`|\bLiteral(?=\[)|^\s*\.\. include:: \S+\.rst$"
    r"|^\s*\.\. (\|\w+\| replace:: .*|[\w-]+:: ?(python|glsl)?)|^\s*:(arg|param|type|returns?|rtype)\b"
    r"|:\w+:(?=`)|<https?:[^>]*>|https?:\S+|^BMeshOpFunc |-> dict",
    re.MULTILINE,
)


def test_no_docstring_of_blender_loses_a_word(base: Path) -> None:
    """Every word that Blender wrote, markup's own aside, stands somewhere in what was read."""
    lines = next((base.parent.parent / "extracts").glob("*.jsonl")).read_text("utf-8").splitlines()
    rows = [json.loads(line) for line in lines if '"docstring":' in line]
    assert len(rows) > 1_500
    lost = [
        (row["path"], word)
        for row in rows
        for said in [repr(parse_docstring(row["docstring"], row.get("signature", "")))]
        for word in set(re.findall(r"[A-Za-z]{3,}", MARKUP.sub(" ", row["docstring"])))
        if word not in said
    ]
    # One docstring gives an argument's type under another name, which is left out.
    assert len({path for path, _ in lost}) <= 1, lost


def test_a_function_written_in_python_takes_what_its_signature_says() -> None:
    text = """.. method:: load(name, filepath, filetype, again=False)

    Loads a preview.

    :arg name: The name.
    :arg filepath: The file.
    :type filepath: str
    :arg filetype: Its type.
    :arg again: Once more.
    """
    call = "(name, path, path_type, again=False)"
    parsed = parse_docstring(text, call, is_python=True)
    assert parsed.signature == call
    assert [(one.name, one.type, one.description, one.required) for one in parsed.parameters] == [
        ("name", "", "The name.", True),
        ("path", "str", "The file.", True),
        ("path_type", "", "Its type.", True),
        ("again", "", "Once more.", False),
    ]
    # What C calls its arguments only the docstring knows.
    assert parse_docstring(text, "(object, /)").signature == "load(name, filepath, filetype, again=False)"


@pytest.mark.parametrize(
    ("call", "names"),
    [
        ("(*args, **kwargs)", ["name", "path"]),  # which tells nothing
        ("(name, path)", ["name", "path"]),
        ("(name, *, path)", ["name", "path"]),
        ("(name)", ["name"]),
    ],
)
def test_an_open_signature_leaves_the_call_to_the_docstring(call: str, names: list[str]) -> None:
    text = ".. function:: f(name, path)\n\n:arg name: N.\n:arg path: P.\n"
    parsed = parse_docstring(text, call, is_python=True)
    assert [one.name for one in parsed.parameters] == names
    assert parsed.signature == ("f(name, path)" if call in {"(*args, **kwargs)", "(name, path)"} else call)
