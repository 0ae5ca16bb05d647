"""A line of an answer names the arguments and values that the question speaks of."""

from __future__ import annotations

from kb_build.symbols.records import EnumItem, Parameter, Symbol
from kb_build.symbols.taken import NEVER
from kb_serve.answer.facts.asked_values import asked_values, asked_words

_EFFECT = Symbol(
    "bpy.types.StripsTopLevel.new_effect", "function", label="New Effect",
    parameters=(
        Parameter("name", "string"),
        Parameter("type", "enum", enum_items=(
            EnumItem("CROSS", "Crossfade"), EnumItem("GAMMA_CROSS", "Gamma Crossfade"), EnumItem("TEXT", "Text"),
            EnumItem("OLD", "Speed", where=NEVER),
        )),
        Parameter("use_selection", "boolean", label="Selected Objects"),
    ),
)  # fmt: skip


def _asked(query: str) -> list[str]:
    return [value.text for value in asked_values(_EFFECT, asked_words(query))]


def test_values_are_named_by_what_they_are_called_and_the_fullest_first() -> None:
    assert _asked("crossfade two strips") == ["type='CROSS'"]
    assert _asked("gamma crossfade between strips") == ["type='GAMMA_CROSS'", "type='CROSS'"]
    assert _asked("add text over the film") == ["type='TEXT'"]


def test_an_argument_is_named_by_its_label_too() -> None:
    assert _asked("only the selected objects") == ["use_selection"]


def test_what_every_function_has_what_blender_refuses_and_the_symbol_itself_are_not_named() -> None:
    assert not _asked("give it a name and a type")
    assert not _asked("speed up the film")
    assert not _asked("new effect")
    assert not _asked("")


def test_what_is_not_wanted_is_not_named() -> None:
    assert _asked("crossfade not gamma crossfade") == ["type='CROSS'"]
    assert not _asked("strips without a crossfade")
    assert _asked("no text, crossfade") == ["type='CROSS'"]


def test_of_two_with_the_same_words_the_one_in_the_order_of_the_question_comes_first() -> None:
    items = (
        EnumItem("GEOMETRY_ORIGIN", "Geometry to Origin"),
        EnumItem("ORIGIN_GEOMETRY", "Origin to Geometry"),
    )
    operator = Symbol(
        "bpy.ops.object.place", "operator", parameters=(Parameter("type", "enum", enum_items=items),)
    )
    found = [value.text for value in asked_values(operator, asked_words("set the origin to the geometry"))]
    assert found == ["type='ORIGIN_GEOMETRY'", "type='GEOMETRY_ORIGIN'"]
