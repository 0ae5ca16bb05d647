"""What operators want of the active object: kept as data, and worded in one place."""

from __future__ import annotations

import json
from dataclasses import asdict

import pytest

from kb_build.symbols.flags import operator_active, refused_nothing
from kb_build.symbols.lines import operator_needs
from kb_build.symbols.needs import Case, OperatorNeeds, Wanted
from kb_build.symbols.records import Symbol

MESH, EDIT, NOT_EDIT = Wanted(("MESH",)), Wanted(("EDIT",)), Wanted(("EDIT", "POSE"), is_others=True)


@pytest.mark.parametrize(
    ("needs", "text", "mode"),
    [
        (OperatorNeeds(), "", ""),
        (OperatorNeeds("active"), "an active object", ""),
        (OperatorNeeds("selected"), "an active and selected object", ""),
        (OperatorNeeds("any", modes=EDIT), "any active object or none in mode 'EDIT'", "EDIT"),
        (
            OperatorNeeds("any", modes=NOT_EDIT, modes_of_some=("SCULPT",)),
            "any active object or none, not in mode 'EDIT'|'POSE', and only some types in mode 'SCULPT'",
            "OBJECT",
        ),
        (
            OperatorNeeds("any", modes_of_some=("SCULPT", "EDIT")),
            "any active object or none, and only some types in mode 'SCULPT'|'EDIT'",
            "SCULPT",
        ),
        (OperatorNeeds("active", MESH, EDIT), "an active object of type 'MESH' in mode 'EDIT'", "EDIT"),
        (
            OperatorNeeds("active", Wanted(tuple("ABCDEFG"), is_others=True)),
            "an active object, not of type 'A'|'B'|'C'|'D'|'E'|'F'|…",
            "",
        ),
        (
            OperatorNeeds("active", MESH, in_some_modes=True),
            "an active object of type 'MESH' in some modes",
            "",
        ),
        (
            OperatorNeeds("active", cases=(Case(("MESH", "FONT"), NOT_EDIT), Case(("CURVES",)))),
            "an active object of type 'MESH'|'FONT' (not in mode 'EDIT'|'POSE') or 'CURVES'",
            "OBJECT",
        ),
        (OperatorNeeds("active", with_modifier=True), "an active object with a modifier", ""),
        (
            OperatorNeeds("active", modes=EDIT, calls=("a()", "b()")),
            "an active object in mode 'EDIT' with what `a()`, then `b()` adds",
            "EDIT",
        ),
        (OperatorNeeds(calls=("a()",)), "what `a()` adds", ""),
    ],
)
def test_what_an_operator_wants_is_plain_english_and_survives_json(
    needs: OperatorNeeds, text: str, mode: str
) -> None:
    assert (needs.text, needs.mode_to_enter) == (text, mode)
    assert OperatorNeeds.of(json.loads(json.dumps(asdict(needs)))) == needs


def test_what_is_left_out_is_not_wanted() -> None:
    assert OperatorNeeds.of({}) == OperatorNeeds()
    assert OperatorNeeds.of({"active": "any", "modes": None}) == OperatorNeeds("any")


def test_nothing_wanted_is_not_the_same_as_nothing_known() -> None:
    unknown, free = (
        Symbol("bpy.ops.a.b", "operator"),
        Symbol("bpy.ops.a.b", "operator", needs=OperatorNeeds()),
    )
    assert (refused_nothing(unknown), refused_nothing(free)) == (False, True)
    assert (operator_needs(unknown), operator_needs(free)) == ("", "")
    assert operator_active(unknown) == operator_active(free) == (None, None)


def test_types_are_known_beyond_those_that_are_named() -> None:
    wanted = Wanted(tuple("ABCDEFG"))
    operator = Symbol("bpy.ops.a.b", "operator", needs=OperatorNeeds("active", wanted))
    types, modes = operator_active(operator)
    assert (types, modes) == (wanted, None)
    assert (wanted.takes("G"), wanted.takes("H")) == (True, False)
    assert (NOT_EDIT.takes("EDIT"), NOT_EDIT.takes("OBJECT")) == (False, True)
