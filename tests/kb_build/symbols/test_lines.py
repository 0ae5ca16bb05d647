"""How a class lists its members: one line each, short whatever Blender puts into them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from kb_build.symbols.flags import new_subscript
from kb_build.symbols.lines import (
    default_text,
    first_sentence,
    leaves_out_values,
    literal,
    member_line,
    type_text,
    written,
)
from kb_build.symbols.records import Deprecation, EnumItem, NewValue, Parameter, Symbol
from kb_build.symbols.taken import NEVER, Setting, Taken

if TYPE_CHECKING:
    from kb_build.blender.extract_reader import Extract

OWNER = "bpy.types.A"


def line(kind: str = "property", **fields: object) -> str:
    return member_line(Symbol(f"{OWNER}.x", kind, OWNER, **fields))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ({}, "`x`"),
        ({"type": "int", "default": 5}, "`x` int = 5 (RNA's)"),
        ({"type": "int", "default": 5, "flags": ("compared",)}, "`x` int = 5"),
        ({"type": "int", "default": 5, "flags": ("readonly",)}, "`x` int read-only"),
        ({"type": "float", "array": (2,), "subtype": "MATRIX", "default": [0, 0]}, "`x` float[2]"),
        ({"type": "enum", "default": "A", "enum_items": (EnumItem("B"),)}, "`x` enum (B)"),
        ({"type": "float", "default": 0}, "`x` float = 0 (RNA's)"),
        ({"type": "boolean", "default": False}, "`x` boolean = False (RNA's)"),
        ({"type": "float", "array": (3,), "default": [0, 1, 0.5]}, "`x` float[3] = (0, 1, 0.5) (RNA's)"),
        ({"type": "float", "array": (4, 4)}, "`x` float[4][4]"),
        ({"type": "string", "default": "a'b"}, "`x` string = \"a'b\" (RNA's)"),
        ({"type": "pointer", "target": "Mesh"}, "`x` pointer → Mesh"),
        ({"type": "collection", "target": "Modifier"}, "`x` collection of Modifier"),
        ({"type": "int", "flags": ("readonly",)}, "`x` int read-only"),
        (
            {
                "type": "enum",
                "flags": ("enum-flag",),
                "default": ["A"],
                "enum_items": (EnumItem("A"), EnumItem("B")),
            },
            "`x` set of enum items = {'A'} (RNA's) (A|B)",
        ),
        ({"type": "enum", "flags": ("enum-flag",), "default": ["A"]}, "`x` set of enum items"),
        ({"type": "int", "deprecation": Deprecation("Unused.")}, "`x` int deprecated"),
        ({"type": "int", "description": "One. Two."}, "`x` int — One"),
        ({"type": "int", "label": "Ex"}, "`x` int — Ex"),
        ({"type": "int", "label": "x"}, "`x` int"),
        ({"type": "int", "modes": ("m=A|B", "n=C")}, "`x` int when m=A|B and n=C"),
        ({"kind": "function", "signature": "x(a, b=1)", "description": "Does."}, "`x(a, b=1)` — Does"),
        ({"kind": "function"}, "`x()`"),
        ({"kind": "operator", "signature": "bpy.ops.m.x(a=(1, 2))"}, "`x(a=(1, 2))`"),
    ],
)
def test_a_line_says_type_default_and_use(fields: dict[str, object], expected: str) -> None:
    assert line(**fields) == expected


def test_of_many_enum_items_the_first_are_shown() -> None:
    items = tuple(EnumItem(f"I{n}") for n in range(9))
    assert line(type="enum", enum_items=items[:8]).endswith("(I0|I1|I2|I3|I4|I5|I6|I7)")
    assert line(type="enum", enum_items=items).endswith("|I7|…)")


def test_a_socket_is_listed_as_python_reaches_it() -> None:
    symbol = Symbol(f'{OWNER}.inputs["B c"]', "socket", OWNER, type="value", default=0.5)
    assert member_line(symbol) == '`inputs["B c"]` · value = 0.5'


def test_a_socket_whose_name_another_has_is_listed_by_its_place() -> None:
    flags = ("identifier:A_Color", "name-when-shown", "hidden-by-default")
    symbol = Symbol(
        f'{OWNER}.inputs["A_Color"]', "socket", OWNER, label="A", flags=flags, subscripts=("inputs[6]",)
    )
    assert member_line(symbol).startswith(
        '`inputs[6]`, `inputs["A"]` while it is shown, identifier `A_Color`'
    )


def test_a_socket_that_a_new_node_shows_is_reached_by_its_name() -> None:
    flags, subscripts = ("identifier:A_Float", "name-when-shown"), ("inputs[2]",)
    symbol = Symbol(f'{OWNER}.inputs["A"]', "socket", OWNER, label="A", flags=flags, subscripts=subscripts)
    assert new_subscript(symbol) == 'inputs["A"]'
    assert new_subscript(replace(symbol, flags=(*flags, "hidden-by-default"))) == "inputs[2]"
    assert new_subscript(replace(symbol, flags=(), subscripts=())) == ""
    # What always works stands first, in every line.
    assert member_line(symbol) == '`inputs[2]`, `inputs["A"]` while it is shown, identifier `A_Float`'


def test_a_line_shows_what_a_new_one_has_and_what_a_mode_changes() -> None:
    of_some = NewValue(True, ("action constraint",), "mix_mode='BEFORE'")
    values = (NewValue(False), NewValue(True, (), "domain_type='LIQUID'"), of_some)
    assert line(type="boolean", default=True, new_values=values, flags=("compared",)) == (
        "`x` boolean = False (True with domain_type='LIQUID')"
    )


def test_a_line_names_the_choices_together_that_change_it_alike() -> None:
    values = tuple(NewValue(True, (), f"export={choice!r}") for choice in ("FOAM", "BUBBLES"))
    assert line(type="boolean", default=False, new_values=values, flags=("compared",)) == (
        "`x` boolean = False (True with export='FOAM' or 'BUBBLES')"
    )


def test_a_line_says_which_pointers_are_none_and_what_makes_them() -> None:
    pointer = {"type": "pointer", "target": "T", "new_values": (NewValue(None),)}
    assert line(**pointer) == "`x` pointer → T = None"
    assert line(**pointer, flags=("filled-by:a.b()",)) == "`x` pointer → T = None (made by `a.b()`)"
    assert line(**{**pointer, "new_values": (NewValue(None, ("empty object",)),)}) == "`x` pointer → T"


def test_items_that_no_instance_takes_are_not_listed() -> None:
    items = (
        EnumItem("A"),
        EnumItem("B", where=NEVER),
        EnumItem("C", where=Taken("only", (Setting("m", ("X",)),))),
    )
    assert line(type="enum", enum_items=items) == "`x` enum (A|C)"


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ({"default": 5}, "`5` (RNA's; no new one was compared)"),
        ({"default": 5, "flags": ("readonly",)}, ""),
        ({"default": 5, "flags": ("readonly", "compared")}, "`5`"),
        ({"default": [0, 0], "subtype": "MATRIX"}, ""),
        ({"default": "A", "enum_items": (EnumItem("A", where=NEVER), EnumItem("B"))}, ""),
        ({"default": ["A"], "enum_items": (EnumItem("B"),)}, ""),
        ({"default": 5, "flags": ("compared",)}, "`5`"),
        ({"default": 1, "new_values": (NewValue(0, ("cloth modifier",)),)},
         "`0` (new cloth modifier); RNA says `1`"),
        ({"default": 0, "new_values": (NewValue(250),)}, "`250` (new A); RNA says `0`"),
        ({"default": 10, "new_values": (NewValue(10), NewValue(1, ("sun", "star")))},
         "`10` (new A), `1` (new sun, star)"),
        ({"default": 0, "new_values": (NewValue(0), NewValue(1, tuple("abcde")))},
         "`0` (new A), `1` (new a, b, c and 2 more)"),
        ({"default": 4, "new_values": (NewValue(4, by="bpy.data.as.new()"), NewValue(5, ("start-up a",)))},
         "`4` (made by `bpy.data.as.new()`); `5` in the startup file (a)"),
        ({"default": 0, "new_values": (NewValue(5, ("start-up a",)),)}, "`5` in the startup file; RNA says `0`"),
        ({"default": 5, "new_values": (NewValue(1, ("factory preferences",)),)},
         "`1` in the factory preferences; RNA says `5`"),
        ({"default": 0, "new_values": (NewValue(1, (), "m='X'"),)}, "`0`; with `m='X'`: `1`"),
        ({"default": 0, "new_values": (NewValue(1, ("a",), "m='X'"),)}, "`0`; with `m='X'`: `1` (a)"),
        ({"default": 0, "new_values": tuple(NewValue(1, (), f"m={choice!r}") for choice in "XYZ")},
         "`0`; with `m='X', 'Y' or 'Z'`: `1`"),
        ({"default": "NONE", "enum_items": (EnumItem("None"),), "new_values": (NewValue("None"),)},
         "`'None'` (new A)"),
        ({"default": None}, ""),
        ({"type": "pointer", "flags": ("compared",)}, ""),
        ({"type": "pointer", "new_values": (NewValue(None),)}, "`None` on a new A"),
        ({"type": "pointer", "new_values": (NewValue(None, ("empty object",)),)}, "`None` on a new empty object"),
        ({"type": "pointer", "new_values": (NewValue(None),), "flags": ("filled-on:a b", "filled-by:a.b() then c()")},
         "`None` on a new A (but a new a b has one); made by `a.b()`, then `c()`"),
    ],
)  # fmt: skip
def test_a_default_tells_whose_it_is(fields: dict[str, object], expected: str) -> None:
    given = {"flags": ("compared",), **fields} if "new_values" in fields else fields
    assert default_text(Symbol(f"{OWNER}.x", "property", OWNER, **given)) == expected  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "None"),
        ("a", "'a'"),
        ([1, [2]], "(1, (2,))"),
        (["b"], "{'b'}"),
        ([], "set()"),
        (list(range(17)), None),
    ],
)
def test_a_literal_is_python_and_short(value: object, text: str | None) -> None:
    shown = literal(value)
    assert shown == text if text else shown.endswith("15, …)")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", ""),
        ("One.", "One"),
        ("One\ntwo. Three.", "One two"),
        ("v1.5 is new. Then", "v1.5 is new"),
        (". x", ". x"),
        ("One, two, ...", "One, two, ..."),
    ],
)
def test_the_first_sentence_ends_at_a_full_stop_before_a_blank(text: str, sentence: str) -> None:
    assert first_sentence(text) == sentence


def test_every_symbol_of_blender_has_a_line_of_its_own(extract: Extract) -> None:
    for symbol in extract.symbols:
        text = member_line(symbol)
        assert "\n" not in text, symbol.path
        assert text.startswith("`"), symbol.path
        assert type_text(symbol) in text or not symbol.type
        if symbol.kind == "property":
            assert f"`{symbol.name}`" in text


def test_a_socket_that_its_identifier_never_gives_is_written_by_its_place() -> None:
    path = f'{OWNER}.inputs["A_Color"]'
    flags = ("identifier:A_Color", "identifier-never")
    assert (
        written(Symbol(path, "socket", OWNER, flags=flags, subscripts=("inputs[6]",))) == f"{OWNER}.inputs[6]"
    )
    assert written(Symbol(path, "socket", OWNER, flags=flags[:1], subscripts=("inputs[6]",))) == path
    assert written(Symbol(f"{OWNER}.x", "property", OWNER)) == f"{OWNER}.x"


@pytest.mark.parametrize(
    ("kind", "fields", "left_out"),
    [
        ("function", {"parameters": (Parameter("name", default=()),)}, True),
        ("function", {}, False),
        ("property", {"enum_items": tuple(EnumItem(name) for name in "ABCDEFGHIJ")}, True),
        ("property", {"enum_items": (EnumItem("A"), EnumItem("B"))}, False),
        ("property", {"enum_items": tuple(map(EnumItem, "ABCDEFGHIJ")), "flags": ("readonly",)}, False),
        ("class", {}, False),
    ],
)
def test_a_line_tells_few_values_and_no_arguments(
    kind: str, fields: dict[str, object], left_out: bool
) -> None:
    symbol = Symbol(f"{OWNER}.x", kind, OWNER, **fields)  # type: ignore[arg-type]
    assert leaves_out_values(symbol) is left_out
