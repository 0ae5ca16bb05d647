"""What a property is set to, or a function is called with, rules out those that refuse it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import pytest

from kb_serve.recognise.chains.chains import find_chains
from kb_serve.recognise.chains.refusals import keywords, refuses, refuses_call

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

T = "bpy.types."
VALUES = [
    "256", "1", "0", "True", "1.5", "-2", "None", "(1, 2, 3)", "(1, 2, 3, 4)", "(0.5, 0.5,)", "'A'", "'XYZ'",
]  # fmt: skip
PROPERTIES = ["hide_render", "pass_index", "empty_display_size", "location", "color", "rotation_mode", "name"]


@pytest.mark.parametrize("name", PROPERTIES)
@pytest.mark.parametrize("value", VALUES)
def test_blender_refuses_what_is_said_to_be_refused(reader: BaseReader, name: str, value: str) -> None:
    member = reader.member_of(f"{T}Object", name)
    symbol = reader.symbol(member.path) if member else None
    assert symbol is not None
    ob = bpy.data.objects.new("o", None)
    try:
        setattr(ob, name, eval(value))
        is_taken = True
    except (TypeError, ValueError):
        is_taken = False
    (chain,) = find_chains(f"ob.{name} = {value}")[:1]
    assert refuses(symbol, chain) is not is_taken


@pytest.mark.parametrize(
    ("written", "literal"),
    [
        ("x.a = 256", "256"), ("x.a = -1.5e-3", "-1.5e-3"), ("x.a = True", "True"), ("x.a = (1, 2, 3)", "(1, 2, 3)"),
        ("x.a = None", "None"), ("x.a = 2 y.b = 3", "2"), ("x.a = 2 * y", ""), ("x.a = 2, 3", ""),
        ("x.a == 2", ""), ("x.a += 2", ""), ("x.a = 1.2.3", ""), ("x.a = f(2)", ""), ("x.a = True if y else False", ""),
        ("x.a = (1, y)", ""), ("x.a = 'text'", ""),
    ],
)  # fmt: skip
def test_only_a_whole_literal_is_read(written: str, literal: str) -> None:
    assert find_chains(written)[0].literal == literal


@pytest.mark.parametrize(
    ("path", "written", "refused"),
    [
        ('ShaderNodeEeveeSpecular.inputs["Specular"]', "x.inputs['Specular'].default_value = 0.6", True),
        (
            'ShaderNodeEeveeSpecular.inputs["Specular"]',
            "x.inputs['Specular'].default_value = (1, 1, 1, 1)",
            False,
        ),
        ('ShaderNodeEeveeSpecular.inputs["Specular"]', "x.inputs['Specular'].hide = True", False),
        ("Object.matrix_world", "x.matrix_world = (1, 2, 3)", False),
        ("Object.location", "x.location", False),
        ("Object.pass_index", "x.pass_index = 007", False),
    ],
)
def test_what_is_not_certain_is_not_refused(
    reader: BaseReader, path: str, written: str, refused: bool
) -> None:
    symbol = reader.symbol(T + path)
    assert symbol is not None
    assert refuses(symbol, find_chains(written)[0]) is refused


def test_the_keywords_tell_the_function(kb: KnowledgeBase, reader: BaseReader) -> None:
    written = 't2.strips.new(name="Spin", start=10.0, action=spin)'
    (chain,) = find_chains(written)[:1]
    assert keywords(chain) == {"name", "start", "action"}
    other, meant = (reader.symbol(f"{T}{cls}.new") for cls in ("ActionStrips", "NlaStrips"))
    assert other is not None
    assert refuses_call(other, chain)
    assert meant is not None
    assert not refuses_call(meant, chain)
    answer = kb.query(written)
    assert answer.hits[0].id == f"{T}NlaStrips.new"
    assert answer.notes[0] == "`start` of `bpy.types.NlaStrips.new` is a whole number: `10.0` is refused."


@pytest.mark.parametrize(
    "written",
    [
        "adj.modifiers.new('CB', 'COLOR_BALANCE')",
        "adj.modifiers.new(name='CB', type='COLOR_BALANCE')",
        "adj.modifiers.new(name, 'COLOR_BALANCE')",
    ],
)
def test_a_text_that_is_given_tells_the_function(kb: KnowledgeBase, written: str) -> None:
    answer = kb.query(written)
    assert answer.hits[0].id == f"{T}StripModifiers.new"
    assert not [note for note in answer.notes if "may also stand" in note]


def test_a_text_that_nothing_takes_tells_none(kb: KnowledgeBase) -> None:
    answer = kb.query("thing.modifiers.new('CB', 'NO_SUCH_THING')")
    assert answer.hits[0].id == f"{T}ObjectModifiers.new"


def test_more_arguments_than_a_function_takes_are_refused(reader: BaseReader) -> None:
    (chain,) = find_chains("a.new(b, c)")[:1]
    one, two = (reader.symbol(f"{T}{cls}.new") for cls in ("FCurveModifiers", "ObjectModifiers"))
    assert one is not None
    assert refuses_call(one, chain)
    assert two is not None
    assert not refuses_call(two, chain)
