"""Where values of enumerations are taken: kept as data, and worded in one place."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from kb_build.symbols.lines import taken_text
from kb_build.symbols.taken import AT_TIMES, NEVER, Beside, Setting, Taken

if TYPE_CHECKING:
    from kb_build.blender.extract_reader import Extract

LIQUID = Setting("domain_type", ("LIQUID",))
CODECS = Setting("Video.codec", ("A", "B"), (("B", Setting("profile", ("C", "D"))),))
IN_VIDEO = Beside(Setting("format", ("V",)), Setting("Video.codec", ("x",)))
MANY = tuple(f"{letter} b" for letter in "cdefghij")


@pytest.mark.parametrize(
    ("where", "text", "said"),
    [
        (Taken("not", things=("sound strip",)), "not by sound strip", "not taken by a sound strip"),
        (
            Taken("only", things=("shader node tree", "geometry node tree")),
            "only by shader node tree, geometry node tree",
            "taken only by a shader or geometry node tree",
        ),
        (
            Taken("only", things=MANY),
            f"only by {', '.join(MANY)}",
            "taken only by a c, d, e, f, g, h, i or j b",  # a condition is not cut off …
        ),
        (
            Taken("only", things=(*MANY, *MANY, "last b")),
            f"only by {', '.join(MANY + MANY)}, …",
            "taken only by a c, d, e, f, g, h, i, j, c, d, e, f, g, h, i or j b, …",  # … but for very many
        ),
        (Taken("only", (LIQUID,)), "only with domain_type='LIQUID'", "taken only with domain_type='LIQUID'"),
        (Taken("not", (LIQUID,)), "not with domain_type='LIQUID'", "not taken with domain_type='LIQUID'"),
        (
            Taken("only", (Setting("kind", tuple("PQRSTUV")), LIQUID)),
            "only with kind='P'|'Q'|'R'|'S'|'T'|'U'|… or domain_type='LIQUID'",
            "taken only with kind='P'|'Q'|'R'|'S'|'T'|'U'|… or domain_type='LIQUID'",
        ),
        (
            Taken("only", (CODECS,), in_some_modes=True),
            "only in some modes, and only with Video.codec='A'|'B' (with profile='C'|'D')",
            "taken only in some modes, and only with Video.codec='A'|'B' (with profile='C'|'D')",
        ),
        (
            Taken("only", places=("GeometryNodeTree", "ShaderNodeTree")),
            "only in a GeometryNodeTree or a ShaderNodeTree",
            "taken only in a GeometryNodeTree or a ShaderNodeTree",
        ),
        (
            Taken("not", places=("T",), there=Taken("only", things=("float socket", "integer socket"))),
            "not in a T, and there only by float socket, integer socket",
            "not taken in a T, and there only by a float or integer socket",
        ),
        (
            Taken("only", (LIQUID,), ("FileOutput", "Viewer")),
            "by FileOutput, Viewer only with domain_type='LIQUID'",
            "taken by FileOutput, Viewer only with domain_type='LIQUID'",
        ),
        (
            Taken("only", (LIQUID,), beside=IN_VIDEO),
            "only with domain_type='LIQUID'; with format='V' only if Video.codec='x'",
            "taken only with domain_type='LIQUID'; with format='V' only if Video.codec='x'",
        ),
        (
            Taken("only", beside=IN_VIDEO),
            "only with format='V' if Video.codec='x'",
            "taken only with format='V' if Video.codec='x'",
        ),
        (
            Taken("not", beside=IN_VIDEO),
            "with format='V' only if Video.codec='x'",
            "taken with format='V' only if Video.codec='x'",
        ),
        (Taken("before", version="4.0"), "before Blender 4.0", "taken before Blender 4.0"),
        (NEVER, "by none that was tried", "taken by none that was tried"),
        (
            AT_TIMES,
            "where the machine or a setting allows it",
            "taken where the machine or a setting allows it",
        ),
    ],
)
def test_where_a_value_is_taken_is_plain_english_and_survives_json(
    where: Taken, text: str, said: str
) -> None:
    assert (where.text, taken_text(where)) == (text, said)
    assert Taken.of(json.loads(json.dumps(where))) == where


def test_no_two_conditions_of_blenders_own_are_worded_alike(extract: Extract) -> None:
    found = {
        item.where
        for symbol in extract.symbols
        for items in (symbol.enum_items, *(each.enum_items for each in symbol.parameters))
        for item in items
        if item.where
    }
    assert len(found) > 50
    assert len({where.text for where in found}) == len(found)


@pytest.mark.parametrize(
    ("where", "setting", "things"),
    [
        (Taken("only", (LIQUID,)), LIQUID, ()),
        (Taken("only", (LIQUID,), in_some_modes=True), None, ()),
        (Taken("only", (LIQUID, CODECS)), None, ()),
        (Taken("not", things=("lamp",)), None, ("lamp",)),
        (Taken("only", (LIQUID,), ("lamp",)), None, ()),
        (NEVER, None, ()),
    ],
)
def test_what_alone_decides_is_told_only_where_one_thing_does(
    where: Taken, setting: Setting | None, things: tuple[str, ...]
) -> None:
    assert (where.deciding_setting, where.deciding_things) == (setting, things)


def test_whether_a_setting_has_a_say_is_told() -> None:
    told = [
        (where.wants_a_setting, where.is_by_setting)
        for where in (
            Taken("only", (LIQUID,)),
            Taken("not", (LIQUID,)),
            Taken("only", beside=IN_VIDEO),
            Taken("only", (LIQUID,), ("lamp",)),
            Taken("only", places=("T",), there=Taken("not", (LIQUID,))),
            Taken("only", things=("lamp",)),
        )
    ]
    assert told == [(True, True), (False, True), (True, True), (False, True), (False, True), (False, False)]


def test_taken_only_so_and_taken_only_else_are_one_condition() -> None:
    assert Taken("not", (LIQUID,)).condition == Taken("only", (LIQUID,)).condition == Taken("only", (LIQUID,))
    assert AT_TIMES.condition == AT_TIMES
